//! The controller that reproduces the recorded command: one of the plain laws where it does, else the inner loop of an existing
//! controller with its gains, feed-forward, delay and lag.

use super::columns::{Choice, Facts};
use crate::recording::channel::Channel;
use crate::recording::check::fitted_gains;
use crate::recording::inner_loop::{Closure, InnerLoop, Log, Term, identify};

/// A law and how well it does.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// As `[[runs]]` writes it.
    pub text: String,
    /// RMS of what it misses over RMS of the command.
    pub error: f64,
}

/// A law that misses more is not proposed.
const BELIEVED: f64 = 0.05;

/// The inner loop, identified from reference, command and motion without a law stated; none where that misses more than a law that is
/// believed may.
pub(super) fn inner(choices: &[Choice], facts: &[Facts]) -> Option<InnerLoop> {
    let si = |channel: Channel| -> Option<Vec<f64>> {
        let choice = choices.iter().find(|c| c.channel == channel)?;
        let factor = choice.unit?.factor;
        Some(facts[choice.column].samples.iter().map(|x| x * factor).collect())
    };
    let time = choices.iter().find(|c| c.channel == Channel::Time)?;
    let certain = choices.iter().any(|c| c.channel == Channel::Acceleration && !c.doubtful);
    let log = Log {
        dt: facts[time.column].step? * time.unit?.factor,
        reference: si(Channel::Reference)?,
        command: si(Channel::Command)?,
        displacement: si(Channel::Displacement)?,
        acceleration: si(Channel::Acceleration).filter(|_| certain),
        pressure: si(Channel::PressureDifference),
    };
    identify(&[log]).ok().filter(|found| found.misses < BELIEVED)
}

/// An inner loop as `[[runs]]` writes it; none where its terms are more than an experiment can state, and then the recorded command
/// drives the model.
pub(super) fn stated(found: &InnerLoop) -> Option<Loop> {
    let sparse = [Term::Acceleration, Term::ReferenceAcceleration].iter().all(|term| found.gain(*term) == 0.0);
    if found.closure == Closure::Hardwired || !sparse || found.lag > 0.0 {
        return None;
    }
    let [kp, ki, kvf, kv, kdp] =
        [Term::Error, Term::Integral, Term::ReferenceRate, Term::Velocity, Term::Pressure].map(|term| found.gain(term));
    let more =
        |name: &str, value: f64| if value == 0.0 { String::new() } else { format!(", {name} = {}", written(value)) };
    let around = more("kvf", kvf) + &more("kdp", kdp);
    let text = if kv == 0.0 {
        format!("{{ kp = {}, ki = {}{around} }}", written(kp), written(ki))
    } else if ki == 0.0 {
        format!("{{ kind = \"cascade\", kp = {}, kv = {}{around} }}", written(kp / kv), written(kv))
    } else {
        return None;
    };
    Some(Loop { text, error: found.misses })
}

/// Tries the plain laws on the proposed channels.
pub(super) fn find(choices: &[Choice], facts: &[Facts]) -> Option<Loop> {
    let si = |channel: Channel| -> Option<Vec<f64>> {
        let choice = choices.iter().find(|c| c.channel == channel)?;
        let factor = choice.unit?.factor;
        Some(facts[choice.column].samples.iter().map(|x| x * factor).collect())
    };
    let (reference, displacement, command) =
        (si(Channel::Reference)?, si(Channel::Displacement)?, si(Channel::Command)?);
    let time = choices.iter().find(|c| c.channel == Channel::Time)?;
    let dt = facts[time.column].step? * time.unit?.factor;
    let fits = fitted_gains(&reference, &displacement, &command, dt);
    let believed = |law: &Loop| law.error < BELIEVED;
    let plain = fits.proportional_integral.map(|([kp, ki], error)| {
        // What the rounding of the command leaves of an integral gain that is none.
        let ki = if ki.abs() < NO_GAIN * kp.abs() { 0.0 } else { ki };
        Loop { text: format!("{{ kp = {}, ki = {} }}", written(kp), written(ki)), error }
    });
    let cascade = fits.cascade.filter(|(gains, _)| gains[1] != 0.0).map(|([both, kv], error)| Loop {
        text: format!("{{ kind = \"cascade\", kp = {}, kv = {} }}", written(both / kv), written(kv)),
        error,
    });
    let plain = plain.filter(believed);
    // One velocity more always misses less, if only by the rounding of what was recorded.
    let better = |law: &Loop| plain.as_ref().is_none_or(|p| p.error > EXACT && law.error < FAR_BETTER * p.error);
    let cascade = cascade.filter(|law| believed(law) && better(law));
    cascade.or(plain)
}

/// What a law may miss that reproduces a command but for the rounding of what was recorded.
const EXACT: f64 = 1e-3;
/// Share of what the plain law misses that one with an inner velocity loop may miss to be what ran.
const FAR_BETTER: f64 = 0.5;

/// Integral gain (1/s) per proportional one below which there is none: it would take hours to matter.
const NO_GAIN: f64 = 1e-4;

/// A gain as an experiment states it.
fn written(gain: f64) -> String {
    if gain == 0.0 || gain.abs() >= 0.01 { format!("{gain:.5}") } else { format!("{gain:.4e}") }
}
