//! The test that would settle what is open: of a catalogue of short runs, the one that is predicted to hold the accepted
//! model and its closest rival furthest apart, the rival's values free to follow as far as the runs at hand let them.

mod catalogue;

use super::remainder::Modelled;
use super::result::NextTest;
use super::verdict::Conclusion;
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, predict};
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::plant::effects::{entry, remainder};
use crate::plant::simulate::SimulateError;
use catalogue::{Gains, Reach, Shape};
use rayon::prelude::*;

/// Tests named beside the best one.
const NAMED: usize = 4;

/// Two models that a test is to tell apart.
struct Rivals<'a> {
    accepted: &'a Fit,
    rival: &'a Fit,
}

/// A test with the distance it is predicted to make, in standard deviations.
struct Foreseen {
    shape: Shape,
    gains: Gains,
    distance: f64,
}

/// Proposes a test; none where nothing is open.
pub(super) fn next_test(
    prepared: &Prepared,
    conclusion: &Conclusion,
    modelled: Option<&Modelled>,
) -> Result<Option<NextTest>, SimulateError> {
    let Some(rivals) = rivals(conclusion, modelled) else { return Ok(None) };
    let Some(pattern) = prepared.fit.first() else { return Ok(None) };
    if pattern.motion.is_some() || !pattern.law.simulates_reference() {
        return Ok(by_the_book(&rivals));
    }
    let reach = Reach::of(prepared, &rivals.accepted.model);
    let as_it_ran = foresee(&rivals, pattern, &reach, &catalogue::shapes(pattern, &reach), Gains::AsTheyWere)?;
    let best: Vec<Shape> = as_it_ran.iter().take(NAMED).map(|f| f.shape).collect();
    let mut all = foresee(&rivals, pattern, &reach, &best, Gains::Halved)?;
    all.extend(as_it_ran);
    all.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    Ok(all.first().map(|best| NextTest {
        why: why(&rivals, best.distance),
        record: catalogue::in_words(best.shape, best.gains, &reach),
        separation: Some(best.distance),
        others: all
            .iter()
            .skip(1)
            .take(NAMED)
            .map(|f| (catalogue::in_words(f.shape, f.gains, &reach), f.distance))
            .collect(),
    }))
}

/// The accepted model and the one that comes closest to it with as many effects; curves, where the library holds neither.
fn rivals<'a>(conclusion: &'a Conclusion, modelled: Option<&'a Modelled>) -> Option<Rivals<'a>> {
    if conclusion.consistent() {
        return None;
    }
    if conclusion.unlisted {
        let modelled = modelled?;
        return Some(Rivals { accepted: &modelled.judged.fit, rival: modelled.rival.as_ref()? });
    }
    // Both as fitted to the training, so that their squares compare.
    let accepted = &conclusion.decision.after;
    let other = |c: &&super::judged::Judged| c.added.len() == accepted.added.len() && c.added != accepted.added;
    let rival = conclusion.decision.candidates.iter().find(other)?;
    Some(Rivals { accepted: &accepted.fit, rival: &rival.fit })
}

/// What the library says of a pair that cannot be simulated from a reference.
fn by_the_book(rivals: &Rivals) -> Option<NextTest> {
    let id = differ(&rivals.accepted.model, &rivals.rival.model).into_iter().next()?;
    let why = format!("{}; its size was not predicted, for these runs are driven by what was measured", aim(rivals));
    Some(NextTest { why, record: entry(id)?.test.to_owned(), separation: None, others: Vec::new() })
}

fn foresee(
    rivals: &Rivals,
    pattern: &Run,
    reach: &Reach,
    shapes: &[Shape],
    gains: Gains,
) -> Result<Vec<Foreseen>, SimulateError> {
    let distance = |&shape: &Shape| -> Result<Foreseen, SimulateError> {
        let mut run = catalogue::run(pattern, shape, gains, reach);
        let model = &rivals.accepted.model;
        let seen = predict(model, &run, &Local::start(model, &run))?;
        for (measured, values) in run.measured.iter_mut().zip(seen.channels) {
            measured.judged &= values.iter().all(|v| v.is_finite());
            measured.values = values;
        }
        Ok(Foreseen { shape, gains, distance: rivals.rival.parted_by(&run)?.sqrt() })
    };
    let mut all = shapes.par_iter().map(distance).collect::<Result<Vec<_>, _>>()?;
    all.retain(|f| f.distance.is_finite());
    all.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    Ok(all)
}

/// Effects of the first model that the second has not.
fn differ(model: &Model, other: &Model) -> Vec<&'static str> {
    let others = other.ids();
    model.ids().into_iter().filter(|id| !others.contains(id)).collect()
}

fn aim(rivals: &Rivals) -> String {
    let side = |model: &Model, other: &Model| {
        let ids = differ(model, other);
        if ids.is_empty() { "the rest of the model".to_owned() } else { ids.join(" with ") }
    };
    let (accepted, rival) = (&rivals.accepted.model, &rivals.rival.model);
    let curve = remainder::entries().any(|e| accepted.ids().contains(&e.id));
    let what = if curve { "to tell what the unlisted part follows, " } else { "to part " };
    format!("{what}{} from {}", side(accepted, rival), side(rival, accepted))
}

fn why(rivals: &Rivals, distance: f64) -> String {
    let at_hand = (rivals.rival.squares - rivals.accepted.squares).max(0.0).sqrt();
    format!(
        "{}: predicted to hold them {distance:.1} standard deviations of the noise apart; the runs fitted hold them \
         {at_hand:.1} apart",
        aim(rivals)
    )
}
