//! The diagram with 5 t more on the table (Fig. 4).

use super::super::present::Part;
use super::super::{Failure, progress};
use super::bode::{self, RATE};
use crate::closed_loop::bode::{Curve, Grid, farthest_apart, survey};
use crate::closed_loop::published::PublishedGains;
use crate::closed_loop::{Clock, ClosedLoopError, named};
use crate::plant::oil_column::{Column, Loaded};
use crate::plant::paper::Paper;
use crate::report::{Axis, Item, Plot, Section, Series, Style};
use serde_json::json;
use shakedown_core::Controller;

/// The paper's amplitude with the test mass, m.
const AMPLITUDE: f64 = 0.05;

/// Measures the diagram at 5 t and at 10 t.
pub(super) fn run(args: &bode::Args) -> Result<Part, Failure> {
    let grid = Grid { amplitudes: vec![AMPLITUDE], ..args.grid()? };
    let bar = progress::bar(2 * grid.len() as u64, "Bode points");
    let measure = |mass: f64| measure(mass, &grid, || bar.inc(1)).map_err(|e| Failure::Input(format!("sweep: {e}")));
    let (empty, loaded) = (measure(5_000.0)?, measure(10_000.0)?);
    bar.finish_and_clear();
    let (decibels, degrees) = farthest_apart(&empty, &loaded);
    let frequency = |mass: f64| Column::usual(mass).natural_frequency();
    let items = vec![
        Item::Text(format!(
            "50 mm at unity gain, the flow driving the table through its oil column: {:.0} Hz at 5 t, {:.0} Hz at 10 t \
             (240 cm2, 0.3 m of oil of 1 GPa; only the area is the paper's). With a rigid column, as in Eq. 7, the mass \
             does not enter at all.",
            frequency(5_000.0),
            frequency(10_000.0)
        )),
        Item::Tiles(vec![
            ("gain, farthest apart".into(), format!("{decibels:.2} dB")),
            ("phase, farthest apart".into(), format!("{degrees:.1} deg")),
        ]),
        Item::Plot(plot(&empty, &loaded)),
    ];
    let json = json!({"difference_db": decibels, "difference_deg": degrees,
                      "empty": empty.json(), "loaded": loaded.json()});
    let figure = ("gain, 10 t against 5 t, at most".to_owned(), format!("{decibels:.2} dB"));
    let found =
        format!("5 t more on the table change the gain by at most {decibels:.2} dB and the phase by {degrees:.1} deg.");
    let section = Section { heading: "5 t on the table (Fig. 4)".into(), items };
    Ok(Part { key: "mass", json, found, figure, section, inputs: Vec::new() })
}

fn measure(mass: f64, grid: &Grid, done: impl Fn() + Sync) -> Result<Curve, ClosedLoopError> {
    let clock = Clock::new(RATE, 10)?;
    let unity = PublishedGains { displacement: (1.0, 0.0), acceleration: (0.0, 0.0), velocity: (0.0, 0.0) };
    let settings = named::settings(unity, RATE);
    let column = Column::usual(mass);
    let make = || Ok((Loaded::new(Paper::default(), column, clock.plant_step())?, Controller::new(&settings)?));
    let mut curves = survey(grid, clock, make, done)?;
    Ok(curves.pop().unwrap_or(Curve { amplitude: AMPLITUDE, points: Vec::new() }))
}

fn plot(empty: &Curve, loaded: &Curve) -> Plot {
    let series = |name: &str, curve: &Curve, style| Series {
        name: name.into(),
        x: curve.points.iter().map(|p| p.frequency).collect(),
        y: curve.points.iter().map(crate::closed_loop::frequency::Point::decibels).collect(),
        style,
    };
    Plot {
        title: "Gain at 50 mm, with and without the test mass".into(),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: "gain [dB]".into(), log: false },
        series: vec![series("5 t", empty, Style::Line), series("10 t", loaded, Style::Dashed)],
        ..Plot::default()
    }
}
