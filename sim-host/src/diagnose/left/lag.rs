//! Sensors that lag by too little to matter to the names.
//!
//! A lag too small to be a hypothesis of its own still shows over all samples. It is said where the model with it explains most of what
//! is left on the runs fitted, and as much on those held out, and nothing that delays as well does nearly as much.

use crate::diagnose::calibration::CALIBRATION;
use crate::diagnose::verdict::Conclusion;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::score;
use crate::identify::model::ModelEffect;
use crate::identify::prepare::Prepared;
use crate::plant::effects::{Entry, acceleration_lag, command_delay, displacement_lag, valve_lag};
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

/// How far a model with one more is fitted: from the accepted one it is a step or two.
const EFFORT: Effort = Effort { steps: 8, tolerance: 1e-7 };
/// Time that a lag starts from, as a share of a sample: one that is far shorter shows nothing that could be followed to another.
const START: f64 = 0.25;
/// Squares that a lag must lower on the runs fitted: five standard deviations.
const CERTAIN: f64 = 25.0;
/// Standard deviations of its time, as the residuals' colour widens them, by which it is no chance.
const DEVIATIONS: f64 = 4.0;
/// Share of what the runs fitted gain a sample that those held out must gain too.
const ALIKE: f64 = 0.4;
/// Share of its gain that another delay may reach, for it to be this one's.
const RIVALS: f64 = 0.8;
/// Share of what is left beyond the noise that it must explain, where that is more than noise that is not known better.
const MOST: f64 = 0.5;
/// Shortest lag that is worth a word, s: a filter of 800 Hz.
const WORTH: f64 = 2e-4;

/// A sensor's lag, the channel that it is of, and what delays much as it does.
struct Lag {
    entry: &'static Entry,
    channel: &'static str,
    rivals: &'static [&'static Entry],
}

const LAGS: [Lag; 2] = [
    Lag { entry: &acceleration_lag::ENTRY, channel: "acceleration", rivals: &[] },
    Lag {
        entry: &displacement_lag::ENTRY,
        channel: "displacement",
        rivals: &[&command_delay::ENTRY, &valve_lag::ENTRY],
    },
];

/// Adds the lags that the accepted model leaves.
pub(super) fn report(
    whole: &Prepared,
    conclusion: &Conclusion,
    findings: &mut Vec<SetUpFinding>,
) -> Result<(), SimulateError> {
    let accepted = &conclusion.accepted.fit;
    let known = accepted.model.ids();
    for lag in LAGS.iter().filter(|lag| !known.contains(&lag.entry.id)) {
        let Some(fit) = with(lag.entry, whole, accepted)? else { continue };
        let Some((time, std)) = time_of(&fit, lag.entry) else { continue };
        let gain = accepted.squares - fit.squares;
        let rows = accepted.rows as f64;
        let left = accepted.squares - rows;
        let explains = gain > MOST * left || left - gain < CALIBRATION.negligible * rows;
        if !explains || gain < CERTAIN || time < WORTH.max(DEVIATIONS * std) {
            continue;
        }
        if conclusion.held_out && !holds(gain / fit.rows as f64, accepted, &fit, &conclusion.judging)? {
            continue;
        }
        let mut others = lag.rivals.iter().filter(|rival| !known.contains(&rival.id));
        let other = others.try_fold(0.0_f64, |most, rival| {
            let fit = with(rival, whole, accepted)?;
            Ok::<f64, SimulateError>(fit.map_or(most, |fit| most.max(accepted.squares - fit.squares)))
        })?;
        if other < RIVALS * gain {
            findings.push(SetUpFinding::sensor_lag(lag.channel, time, std));
        }
    }
    Ok(())
}

/// The accepted model with one more effect, fitted on; none where it cannot have it.
fn with(entry: &'static Entry, whole: &Prepared, accepted: &Fit) -> Result<Option<Fit>, SimulateError> {
    if !accepted.model.candidates().iter().any(|candidate| candidate.id == entry.id) {
        return Ok(None);
    }
    let Some(mut start) = ModelEffect::start(entry, 0, &whole.signal_scales) else { return Ok(None) };
    if let Some(time) = start.values.first_mut().filter(|_| entry.parameters[0].key == "time") {
        time.value = whole.fit.first().map_or(time.value, |run| (START * run.dt).max(WORTH));
    }
    let mut fit = Fit::resume(accepted.model.with(start), accepted.locals.clone(), &whole.fit)?;
    fit.improve(&whole.fit, EFFORT)?;
    Ok(Some(fit))
}

/// The time of a lag in a model, and its standard deviation.
fn time_of(fit: &Fit, entry: &Entry) -> Option<(f64, f64)> {
    let name = format!("{}.{}", entry.id, entry.parameters[0].key);
    let place = fit.model.names().iter().position(|known| *known == name)?;
    Some((fit.model.values().nth(place)?.value, *fit.deviations().get(place)?))
}

/// Whether the runs held out gain as much a sample as those fitted did.
fn holds(gain: f64, accepted: &Fit, lagged: &Fit, held: &[Run]) -> Result<bool, SimulateError> {
    let (before, after) = (score(&accepted.model, held)?, score(&lagged.model, held)?);
    Ok((before.squares() - after.squares()) / before.rows as f64 > ALIKE * gain)
}
