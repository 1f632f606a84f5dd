//! A recording in which nothing moves: whatever a model says of it is right.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;

/// One finding where every channel repeats one value from end to end.
pub(super) fn check(run: &Run) -> Option<Finding> {
    let constant = |samples: &[f64]| {
        let mut known = samples.iter().filter(|x| x.is_finite());
        let first = known.next();
        first.is_some() && known.all(|x| Some(x) == first)
    };
    let mut channels = run.channels.iter();
    let (first, _) = channels.next()?;
    let still = run.channels.iter().all(|(_, samples)| constant(samples));
    let about = if run.channel(Channel::Displacement).is_some() { Channel::Displacement } else { first };
    still.then(|| {
        Finding::whole(run, about, Fault::Still, Severity::BadData).saying(
            "every channel repeats one value from end to end: nothing moves, and any model explains that".into(),
            "name a recording in which the table moves, and check that its columns were recorded at all",
        )
    })
}
