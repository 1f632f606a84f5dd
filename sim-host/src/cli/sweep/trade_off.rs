//! Tracking against saturation over the gain (Fig. 11).

use super::super::present::Part;
use super::super::source::Source;
use super::super::{Failure, progress};
use crate::closed_loop::named::RATE;
use crate::closed_loop::trade_off::{GAINS, Point, trade_off};
use crate::closed_loop::trial::table1_motion;
use crate::report::{Axis, Item, Plot, Section, Series, Style, Table};
use serde_json::json;

/// Plays the record at every gain.
pub(super) fn run(source: &Source) -> Result<Part, Failure> {
    let record = source.load()?;
    let place = source.record.as_ref().map_or_else(|| record.name.clone(), |path| path.display().to_string());
    let motion = table1_motion(&record, RATE).map_err(|e| Failure::Input(format!("{place}: {e}")))?;
    let bar = progress::bar(GAINS.len() as u64, "gains");
    let points = trade_off(&motion, || bar.inc(1)).map_err(|e| Failure::Work(format!("{place}: {e}")))?;
    bar.finish_and_clear();
    let items = vec![
        Item::Text(format!(
            "{}, conditioned as for Table 1; Ki = Kp / 10. A higher gain tracks the weak stretch better, and pays for it \
             on the strong one in time at the limit and in spikes.",
            record.name
        )),
        Item::Table(table(&points)),
        Item::Plot(errors(&points)),
        Item::Plot(spikes(&points)),
    ];
    let json = points.iter().map(|p| {
        json!({"kp": p.gain, "weak_e_a": p.weak_e_a, "strong_e_a": p.strong_e_a, "spike_ratio": p.spike_ratio,
               "saturated_s": p.saturated_s})
    });
    let ends = points.first().zip(points.last());
    let found = ends.map_or_else(String::new, |(low, high)| {
        format!(
            "From Kp = {} to {} the E_a of the weak stretch goes from {:.2} to {:.2}, of the strong one from {:.2} to {:.2}.",
            low.gain, high.gain, low.weak_e_a, high.weak_e_a, low.strong_e_a, high.strong_e_a
        )
    });
    let best = points.iter().min_by(|a, b| a.strong_e_a.total_cmp(&b.strong_e_a));
    let best = best.map_or_else(String::new, |p| format!("{:.2} at Kp = {}", p.strong_e_a, p.gain));
    let figure = ("least E_a of the strong stretch".to_owned(), best);
    let section = Section { heading: "Gain trade-off (Fig. 11)".into(), items };
    Ok(Part { key: "trade_off", json: json.collect(), found, figure, section, inputs: source.inputs() })
}

fn table(points: &[Point]) -> Table {
    let row = |p: &Point| {
        vec![
            format!("{}", p.gain),
            format!("{:.3}", p.weak_e_a),
            format!("{:.3}", p.strong_e_a),
            format!("{:.2}", p.spike_ratio),
            format!("{:.2}", p.saturated_s),
        ]
    };
    let columns = ["Kp [1]", "E_a weak [1]", "E_a strong [1]", "peak over reference [1]", "at the limit [s]"];
    Table {
        caption: "Over the proportional gain".into(),
        columns: columns.map(String::from).to_vec(),
        rows: points.iter().map(row).collect(),
    }
}

fn plot(points: &[Point], title: &str, label: &str, curves: &[(&str, fn(&Point) -> f64)]) -> Plot {
    let series = |&(name, of): &(&str, fn(&Point) -> f64)| Series {
        name: name.into(),
        x: points.iter().map(|p| p.gain).collect(),
        y: points.iter().map(of).collect(),
        style: Style::Line,
    };
    Plot {
        title: title.into(),
        x: Axis { label: "Kp [1]".into(), log: true },
        y: Axis { label: label.into(), log: false },
        series: curves.iter().map(series).collect(),
        group: Some("trade-off".into()),
        ..Plot::default()
    }
}

fn errors(points: &[Point]) -> Plot {
    let curves: [(&str, fn(&Point) -> f64); 2] =
        [("weak stretch", |p| p.weak_e_a), ("strong stretch", |p| p.strong_e_a)];
    plot(points, "Acceleration error over the gain", "E_a [1]", &curves)
}

fn spikes(points: &[Point]) -> Plot {
    let curves: [(&str, fn(&Point) -> f64); 2] =
        [("peak over reference [1]", |p| p.spike_ratio), ("time at the limit [s]", |p| p.saturated_s)];
    plot(points, "What saturation costs over the gain", "ratio [1], time [s]", &curves)
}
