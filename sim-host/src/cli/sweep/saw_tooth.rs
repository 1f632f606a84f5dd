//! The saw-tooth of a sine beyond the velocity limit (Fig. 6).

use super::super::Failure;
use super::super::present::Part;
use super::bode::RATE;
use crate::closed_loop::published::Named;
use crate::closed_loop::saw_tooth::SawTooth;
use crate::closed_loop::{Clock, ClosedLoopError, Trace, run as run_loop};
use crate::plant::paper::{FixedStep, Paper};
use crate::plant::sensors::{GRAVITY, SensorModel, Sensors};
use crate::report::{Axis, Band, Item, Plot, Section, Series, Style, Table};
use serde_json::json;
use shakedown_core::Controller;
use std::f64::consts::TAU;

/// 75 mm at 2 Hz, as in Fig. 6.
const SINE: (f64, f64) = (0.075, 2.0);
/// Driven and shown, s.
const SECONDS: f64 = 6.0;
const SHOWN: f64 = 2.0;

/// Drives the loop at the gains in use and at the strong ones.
pub(super) fn run() -> Result<Part, Failure> {
    let mut items = vec![Item::Text(format!(
        "{:.0} mm at {:.0} Hz commands {:.2} m/s; the table cannot pass 0.242 m/s. Its velocity is constant between the \
         turns, its acceleration zero there, and a spike at every turn.",
        SINE.0 * 1e3,
        SINE.1,
        SINE.0 * TAU * SINE.1
    ))];
    let mut table = Table {
        caption: "The second half of 6 s".into(),
        columns: [
            "controller",
            "steepest slope [m/s]",
            "peak displacement [mm]",
            "time at the limit [%]",
            "peak acceleration over commanded [1]",
        ]
        .map(String::from)
        .to_vec(),
        rows: Vec::new(),
    };
    let mut json = serde_json::Map::new();
    let (mut traces, mut steepest) = (Vec::new(), 0.0_f64);
    for named in [Named::Current, Named::Strong] {
        let trace = drive(named).map_err(|e| Failure::Work(format!("sweep: {e}")))?;
        let seen = SawTooth::of(&trace, SINE);
        steepest = steepest.max(seen.slope);
        table.rows.push(vec![
            named.title().into(),
            format!("{:.4}", seen.slope),
            format!("{:.1}", seen.peak * 1e3),
            format!("{:.0}", 100.0 * seen.saturated),
            format!("{:.2}", seen.spike_ratio),
        ]);
        json.insert(
            named.name().into(),
            json!({"slope_m_per_s": seen.slope, "peak_m": seen.peak, "saturated": seen.saturated,
                   "spike_ratio": seen.spike_ratio}),
        );
        traces.push((named, trace));
    }
    items.push(Item::Table(table));
    items.push(Item::Note(
        "The caption of Fig. 6 says that 75 mm at 2 Hz commands 0.2425 m/s; it commands 0.94 m/s.".into(),
    ));
    items.push(plot("Displacement [mm]", &traces, true, |t| t.displacement.iter().map(|x| x * 1e3).collect()));
    items.push(plot("Acceleration [g]", &traces, false, |t| t.acceleration.iter().map(|a| a / GRAVITY).collect()));
    let figure = ("steepest slope of the saw-tooth".to_owned(), format!("{steepest:.3} m/s"));
    let found = format!(
        "Asked for {:.2} m/s, the table answers with a saw-tooth of {steepest:.3} m/s, whatever the gains.",
        SINE.0 * TAU * SINE.1
    );
    let section = Section { heading: "Saw-tooth (Fig. 6)".into(), items };
    Ok(Part { key: "saw_tooth", json: json.into(), found, figure, section, inputs: Vec::new() })
}

fn drive(named: Named) -> Result<Trace, ClosedLoopError> {
    let clock = Clock::new(RATE, 10)?;
    let reference: Vec<f64> =
        (0..(SECONDS * RATE) as usize).map(|k| SINE.0 * (TAU * SINE.1 * k as f64 / RATE).sin()).collect();
    let mut plant = FixedStep::new(Paper::default(), clock.plant_step(), 0.0)?;
    let mut law = Controller::new(&named.settings(RATE))?;
    Ok(run_loop(&mut plant, &mut law, &mut Sensors::new(SensorModel::default()), &reference, clock))
}

/// The last stretch of each trace, saturated parts of the first shaded.
fn plot(label: &str, traces: &[(Named, Trace)], reference: bool, of: impl Fn(&Trace) -> Vec<f64>) -> Item {
    let from = ((SECONDS - SHOWN) * RATE) as usize;
    let time: Vec<f64> = (0..(SHOWN * RATE) as usize).map(|k| k as f64 / RATE).collect();
    let cut = |values: &[f64]| values.get(from..).unwrap_or_default().to_vec();
    let series = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: time.clone(), y, style };
    let mut curves: Vec<Series> =
        traces.iter().map(|(named, trace)| series(named.title(), cut(&of(trace)), Style::Line)).collect();
    let mut bands = Vec::new();
    if let Some((_, trace)) = traces.first() {
        if reference {
            let mm: Vec<f64> = trace.reference.iter().map(|x| x * 1e3).collect();
            curves.push(series("reference", cut(&mm), Style::Dashed));
        }
        let label = String::from("current gains: at the velocity limit");
        let shift = SECONDS - SHOWN;
        let shown = |&(_, to): &(f64, f64)| to > shift;
        let band = |(a, b): (f64, f64)| Band { from: (a - shift).max(0.0), to: b - shift, label: label.clone() };
        bands = trace.saturated_stretches(0.0).into_iter().filter(shown).map(band).collect();
    }
    let (title, _) = label.split_once(" [").unwrap_or((label, ""));
    Item::Plot(Plot {
        title: format!("{title}, 75 mm at 2 Hz"),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: label.to_lowercase(), log: false },
        series: curves,
        bands,
        group: Some("saw-tooth".into()),
        ..Plot::default()
    })
}
