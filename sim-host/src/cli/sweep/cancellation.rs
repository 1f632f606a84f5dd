//! Both verification tests of the feedforward cancellation (Fig. 2).

use super::super::present::Part;
use super::super::{Failure, progress};
use crate::closed_loop::feedforward::{inside_and_outside, track_zero};
use crate::closed_loop::named::RATE;
use crate::closed_loop::published::Named;
use crate::closed_loop::trial::table1_motion;
use crate::closed_loop::{Clock, ClosedLoopError, Trace};
use crate::motion::generate::RECIPES;
use crate::plant::sensors::SensorModel;
use crate::report::{Axis, Item, Plot, Section, Series, Style, Table};
use serde_json::json;

/// Where the first test starts, m.
const START: f64 = 0.05;

/// Runs both tests with ideal sensors and with the laboratory's.
pub(super) fn run() -> Result<Part, Failure> {
    let wrong = |e: ClosedLoopError| Failure::Work(format!("sweep: cancellation: {e}"));
    let clock = Clock::new(RATE, 10).map_err(|e| wrong(e.into()))?;
    let gains = Named::Current.gains();
    let bar = progress::bar(2 + RECIPES.len() as u64, "tests");
    let zero = |sensors| track_zero(gains, clock, START, sensors).inspect(|_| bar.inc(1)).map_err(wrong);
    let (ideal, laboratory) = (zero(SensorModel::default())?, zero(SensorModel::laboratory(1))?);
    let mut same = Vec::new();
    for recipe in RECIPES {
        let failed = |e: String| Failure::Work(format!("sweep: {}: {e}", recipe.name));
        let record = recipe.generate(1).map_err(|e| failed(e.to_string()))?;
        let motion = table1_motion(&record, RATE).map_err(|e| failed(e.to_string()))?;
        let (inside, outside) =
            inside_and_outside(gains, clock, &motion.displacement, &SensorModel::default()).map_err(wrong)?;
        same.push((recipe.name, apart(&inside, &outside)));
        bar.inc(1);
    }
    bar.finish_and_clear();
    let left = |trace: &Trace| largest(trace.displacement.iter().rev().take(RATE as usize).copied());
    let items = vec![
        Item::Text(
            "The table's own controller stays in the loop and is cancelled by adding the LVDT's reading to what it is \
             sent; the control core stands outside, at the gains in use."
                .into(),
        ),
        Item::Tiles(vec![
            ("test 1: told to stand at zero from 50 mm, left after 30 s, ideal LVDT".into(), micrometres(left(&ideal))),
            ("the same with a 40 um LVDT, hum and noise".into(), micrometres(left(&laboratory))),
        ]),
        Item::Table(table(&same)),
        Item::Plot(plot(&ideal, &laboratory)),
    ];
    let json = json!({
        "zero": {"start_m": START, "left_m": left(&ideal), "left_with_sensors_m": left(&laboratory)},
        "same_response": same.iter().map(|(name, d)| json!({"record": name, "difference": d})).collect::<Vec<_>>(),
    });
    let farthest = 100.0 * same.iter().map(|(_, apart)| *apart).fold(0.0, f64::max);
    let figure = ("left of 50 mm after 30 s".to_owned(), micrometres(left(&laboratory)));
    let found = format!("Cancelled from outside, the loop answers within {farthest:.2} % of the same loop inside.");
    let section = Section { heading: "Feedforward cancellation (Fig. 2)".into(), items };
    Ok(Part { key: "cancellation", json, found, figure, section, inputs: Vec::new() })
}

fn micrometres(x: f64) -> String {
    format!("{:.1} um", x * 1e6)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |m, v| m.max(v.abs()))
}

/// The farthest two responses lie apart, over the largest displacement.
fn apart(a: &Trace, b: &Trace) -> f64 {
    largest(a.displacement.iter().zip(&b.displacement).map(|(a, b)| a - b)) / largest(a.displacement.iter().copied())
}

fn table(same: &[(&str, f64)]) -> Table {
    Table {
        caption: "Test 2: the same gains inside and outside".into(),
        columns: vec!["record".into(), "responses apart, share of the largest displacement [%]".into()],
        rows: same.iter().map(|(name, d)| vec![(*name).into(), format!("{:.3}", 100.0 * d)]).collect(),
    }
}

fn plot(ideal: &Trace, laboratory: &Trace) -> Plot {
    let series = |name: &str, trace: &Trace, style| Series {
        name: name.into(),
        x: (0..5000).step_by(5).map(|k| f64::from(k) * trace.dt).collect(),
        y: trace.displacement.iter().take(5000).step_by(5).map(|x| x * 1e3).collect(),
        style,
    };
    Plot {
        title: "Told to stand at zero from 50 mm".into(),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: "displacement [mm]".into(), log: false },
        series: vec![
            series("ideal sensors", ideal, Style::Line),
            series("laboratory sensors", laboratory, Style::Dashed),
        ],
        ..Plot::default()
    }
}
