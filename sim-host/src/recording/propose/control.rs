//! The controller that reproduces the recorded command, where one of the plain laws does.

use super::columns::{Choice, Facts};
use crate::recording::channel::Channel;
use crate::recording::check::fitted_gains;

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
    let candidates = [
        fits.proportional_integral
            .map(|(gains, error)| (format!("{{ kp = {:.5}, ki = {:.5} }}", gains[0], gains[1]), error)),
        fits.cascade.filter(|(gains, _)| gains[1] != 0.0).map(|([both, kv], error)| {
            (format!("{{ kind = \"cascade\", kp = {:.5}, kv = {kv:.5} }}", both / kv), error)
        }),
    ];
    candidates
        .into_iter()
        .flatten()
        .map(|(text, error)| Loop { text, error })
        .filter(|l| l.error < BELIEVED)
        .min_by(|a, b| a.error.total_cmp(&b.error))
}
