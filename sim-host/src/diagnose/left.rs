//! Faults of the set-up by what a model that explains the recordings leaves of them.
//!
//! Before anything is explained, physics and faults of a sensor lie on top of each other, and only a gross fault shows. Beneath an
//! accepted model the small ones show too: the noise of each channel, hum, a saw-tooth, single samples wrong, a sensor that lags. They are
//! said and not corrected: whatever matters to the names is a hypothesis beside the physics and has been weighed before.

mod hum;
mod lag;
mod noise;
mod rows;
mod saw_tooth;
mod spikes;

use super::residual::judged_channels;
use super::structure::{Structure, of_channel};
use super::verdict::Conclusion;
use crate::identify::data::Channel;
use crate::identify::judge::score;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
use crate::recording::{Experiment, SetUpFinding};
use rows::{Look, noise_of};

/// Adds what is found to the findings, in the place of what was thought of the noise before anything was explained.
pub(super) fn report(
    experiment: &Experiment,
    whole: &Prepared,
    conclusion: &Conclusion,
    findings: &mut Vec<SetUpFinding>,
) -> Result<(), SimulateError> {
    let fitted = score(&conclusion.accepted.fit.model, &whole.fit)?;
    let mut looks: Vec<Look> = whole.fit.iter().zip(&fitted.predicted).collect();
    if conclusion.held_out {
        looks.extend(conclusion.judging.iter().zip(&conclusion.accepted.hold.predicted));
    }
    let mut channels: Vec<Channel> = whole.fit.iter().flat_map(judged_channels).collect();
    channels.sort_unstable();
    channels.dedup();
    channels.retain(|channel| *channel != Channel::SupplyPressure);
    let open = conclusion.unlisted || conclusion.more_missing;
    let follows = |channel| of_channel(looks.iter().copied(), channel).is_some_and(Structure::is_certain);
    for &channel in &channels {
        let Some(noise) = noise_of(whole, channel) else { continue };
        noise::report(experiment, &looks, (channel, noise), || open || follows(channel), findings);
        saw_tooth::report(&looks, (channel, noise), findings);
        if !open {
            hum::report(&looks, (channel, noise), &conclusion.accepted.fit.model, findings);
            spikes::report(&looks, channel, &channels, findings);
        }
    }
    if !open {
        lag::report(whole, conclusion, findings)?;
    }
    Ok(())
}
