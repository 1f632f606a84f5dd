//! A test's histories over time, saturated stretches shaded, opened at its strong motion.

use crate::closed_loop::trial::{ScoredSignal, Trial, TrialError};
use crate::motion::metrics::intensity;
use crate::plant::sensors::GRAVITY;
use crate::report::{Axis, Band, Item, Plot, Series, Style};

/// One curve over a test's time.
pub(crate) struct History<'a> {
    /// Name in the legend.
    pub(crate) name: &'a str,
    /// Values in SI.
    pub(crate) values: &'a [f64],
    /// What they are multiplied by for display.
    pub(crate) scale: f64,
    /// How it is drawn.
    pub(crate) style: Style,
}

/// The stretch that holds 5 to 95 % of the Arias intensity of an acceleration, and a second to each side; none where that is
/// nearly all of it.
pub(crate) fn strong_motion(acceleration: &[f64], dt: f64) -> Option<(f64, f64)> {
    let found = intensity(acceleration, dt);
    let (from, to) = ((found.start - 1.0).max(0.0), found.start + found.d5_95 + 1.0);
    let whole = acceleration.len() as f64 * dt;
    (found.d5_95 > 0.0 && to - from < 0.8 * whole).then_some((from, to.min(whole)))
}

/// A figure of several curves over time, the test's saturated stretches shaded. The page thins them and keeps every spike.
pub(crate) fn plot(trial: &Trial, group: &str, title: &str, label: &str, curves: &[History]) -> Plot {
    let dt = trial.trace.dt;
    let series = |c: &History| Series {
        name: c.name.into(),
        x: (0..c.values.len()).map(|k| k as f64 * dt).collect(),
        y: c.values.iter().map(|v| v * c.scale).collect(),
        style: c.style,
    };
    let band = |(from, to)| Band { from, to, label: "velocity at its limit".into() };
    Plot {
        title: title.into(),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: label.into(), log: false },
        series: curves.iter().map(series).collect(),
        bands: trial.trace.saturated_stretches(0.02).into_iter().map(band).collect(),
        group: Some(group.into()),
        open: strong_motion(&trial.wanted.acceleration, dt),
    }
}

/// What a valve's command is shown in.
#[derive(Debug, Clone)]
pub(crate) struct Opening {
    /// `%`, `V` or `mA`.
    pub(crate) unit: String,
    /// The steady command that opens the valve fully, m.
    pub(crate) full: f64,
    /// The same in the unit.
    pub(crate) shown: f64,
}

/// Acceleration, its error, displacement, velocity and valve of a test; `group` ties their zoom.
pub(crate) fn all(trial: &Trial, group: &str, opening: &Opening) -> Result<Vec<Item>, TrialError> {
    let trace = &trial.trace;
    let modified = trial.commanded();
    let curve = |name, values, scale, style| History { name, values, scale, style };
    let g = 1.0 / GRAVITY;
    let response = trial.response(ScoredSignal::Truly)?;
    let wanted = trial.wanted_response()?;
    let error: Vec<f64> = response.acceleration.iter().zip(&wanted.acceleration).map(|(y, a)| y - a).collect();
    let accelerations = [
        curve("accelerometer", trace.measured_acceleration.as_slice(), g, Style::Faint),
        curve("reference", &trial.wanted.acceleration, g, Style::Dashed),
        curve("table", &trace.acceleration, g, Style::Line),
    ];
    let errors = [curve("table less reference, both below 15 Hz", error.as_slice(), g, Style::Line)];
    let mut displacements = vec![
        curve("reference", trial.wanted.displacement.as_slice(), 1e3, Style::Dashed),
        curve("table", &trace.displacement, 1e3, Style::Line),
    ];
    if modified.displacement != trial.wanted.displacement {
        displacements.push(curve("after modification", &modified.displacement, 1e3, Style::Faint));
    }
    let velocities = [
        curve("reference", trial.wanted.velocity.as_slice(), 1.0, Style::Dashed),
        curve("table", &trace.velocity, 1.0, Style::Line),
    ];
    let commands = [curve("valve", trace.command.as_slice(), opening.shown / opening.full, Style::Line)];
    let valve = format!("Valve, {} {} fully open", opening.shown, opening.unit);
    Ok([
        plot(trial, group, "Acceleration", "acceleration [g]", &accelerations),
        plot(trial, group, "Error of the acceleration", "error [g]", &errors),
        plot(trial, group, "Displacement", "displacement [mm]", &displacements),
        plot(trial, group, "Velocity", "velocity [m/s]", &velocities),
        plot(trial, group, &valve, &format!("valve [{}]", opening.unit), &commands),
    ]
    .map(Item::Plot)
    .to_vec())
}
