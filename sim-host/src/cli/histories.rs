//! A test's histories over time, saturated stretches shaded.

use shakedown::closed_loop::trial::Trial;
use shakedown::plant::sensors::GRAVITY;
use shakedown::report::{Axis, Band, Item, Plot, Series, Style};

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
    }
}

/// Acceleration, displacement, velocity and command of a test; `group` ties their zoom.
pub(crate) fn all(trial: &Trial, group: &str) -> Vec<Item> {
    let trace = &trial.trace;
    let modified = trial.commanded();
    let curve = |name, values, scale, style| History { name, values, scale, style };
    let g = 1.0 / GRAVITY;
    let accelerations = [
        curve("accelerometer", trace.measured_acceleration.as_slice(), g, Style::Faint),
        curve("reference", &trial.wanted.acceleration, g, Style::Dashed),
        curve("table", &trace.acceleration, g, Style::Line),
    ];
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
    let commands = [curve("valve command", trace.command.as_slice(), 1e3, Style::Line)];
    [
        plot(trial, group, "Acceleration", "acceleration [g]", &accelerations),
        plot(trial, group, "Displacement", "displacement [mm]", &displacements),
        plot(trial, group, "Velocity", "velocity [m/s]", &velocities),
        plot(trial, group, "Valve command", "command [mm]", &commands),
    ]
    .map(Item::Plot)
    .to_vec()
}
