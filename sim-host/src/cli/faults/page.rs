//! What a campaign of faults, or one run of it, looks like.

use crate::faults::case::Case;
use crate::faults::rig::{Pair, TruthSample};
use crate::faults::summary::Row;
use crate::faults::watcher::{MARGIN, Outcome, STROKE, Violation};
use crate::faults::{Beside, Summary};
use crate::report::{Axis, Band, Item, Page, Plot, Section, Series, Style, Table};
use shakedown_core::OperatorRequest;

fn millis(seconds: f64) -> String {
    format!("{:.0}", 1e3 * seconds)
}

fn millimetres(metres: f64) -> String {
    format!("{:.1}", 1e3 * metres)
}

/// The aid beside the guard, in words.
pub(super) const fn beside_words(beside: Beside) -> &'static str {
    match beside {
        Beside::LimitSwitches => "with limit switches",
        Beside::SecondSensor => "with a second displacement sensor and without limit switches",
        Beside::Nothing => "the guard alone",
    }
}

/// The tables, for terminal and page.
pub(super) fn sections(summary: &Summary, beside: Beside) -> Vec<Section> {
    let count = |how: Violation| summary.broken(how).to_string();
    let tiles = [
        ("runs", summary.runs.to_string()),
        ("excursions", count(Violation::Excursion)),
        ("unreported", count(Violation::Unreported)),
        ("late", count(Violation::Late)),
        ("moving after a trip", count(Violation::Moving)),
        ("too rough", count(Violation::Rough)),
        ("trips without a fault", count(Violation::Alarm)),
        ("ended by the envelope before the fault", summary.ended.to_string()),
    ];
    let tiles = tiles.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
    let tables = match beside {
        Beside::LimitSwitches => "The tables have the limit switches that docs/commissioning.md asks for.",
        Beside::SecondSensor => "The tables have a second displacement sensor, and no limit switches.",
        Beside::Nothing => "The guard is alone: an LVDT that creeps carries some of the tables out.",
    };
    let room = 1e3 * (STROKE - MARGIN);
    let note = format!(
        "An excursion is a table more than {room:.0} mm from the middle, the stroke less the margin, whether promised or not. {tables} A fault shows in a run once it reaches a signal or the table; a class with a promised time must then be reported within it, any other may pass unreported as long as what the hazard table promises of the table holds."
    );
    let mut items = vec![Item::Tiles(tiles), Item::Note(note), Item::Table(classes(summary))];
    if !summary.failed.is_empty() {
        items.push(Item::Table(failed(summary)));
    }
    vec![Section { heading: "Faults".into(), items }]
}

/// The class without a fault, of which nothing has to be reported.
const NONE: &str = "none";

fn classes(summary: &Summary) -> Table {
    let columns = [
        "class",
        "runs",
        "shows in",
        "reported",
        "promised [ms]",
        "median [ms]",
        "95 % [ms]",
        "99 % [ms]",
        "largest [ms]",
        "outside",
        "farthest [mm]",
        "undetected deviation [mm]",
        "largest acceleration [m/s2]",
        "broken",
    ];
    Table {
        columns: columns.map(String::from).to_vec(),
        rows: summary.rows.iter().map(cells).collect(),
        caption: "By class: latencies from where there was something to see".into(),
    }
}

fn cells(row: &Row) -> Vec<String> {
    let latency = row.latency_s.map_or_else(|| vec![String::new(); 4], |all| all.map(millis).to_vec());
    let broken: Vec<String> = row.broken.iter().map(|(how, n)| format!("{n} {}", word(*how))).collect();
    let front = vec![
        row.class.to_owned(),
        row.runs.to_string(),
        if row.class == NONE { String::new() } else { row.visible.to_string() },
        row.reported.to_string(),
        row.bound_s.map(millis).unwrap_or_default(),
    ];
    let back = vec![
        row.outside.to_string(),
        millimetres(row.farthest_m),
        millimetres(row.deviation_m),
        format!("{:.1}", row.acceleration_m_s2),
        broken.join(", "),
    ];
    [front, latency, back].concat()
}

fn word(how: Violation) -> &'static str {
    match how {
        Violation::Excursion => "excursions",
        Violation::Unreported => "unreported",
        Violation::Late => "late",
        Violation::Moving => "moving",
        Violation::Rough => "rough",
        Violation::Alarm => "alarms",
    }
}

fn failed(summary: &Summary) -> Table {
    let row = |o: &Outcome| {
        let broken: Vec<&str> = o.broken.iter().map(|how| word(*how)).collect();
        vec![
            o.run.to_string(),
            o.class.clone(),
            o.mode.clone(),
            broken.join(", "),
            o.reported.clone().unwrap_or_default(),
            o.latency_s.map(millis).unwrap_or_default(),
            millimetres(o.farthest_m),
        ]
    };
    let columns = ["run", "class", "mode", "broken", "reported", "latency [ms]", "farthest [mm]"];
    Table {
        columns: columns.map(String::from).to_vec(),
        rows: summary.failed.iter().take(100).map(row).collect(),
        caption: "Runs that broke a promise; --run NUMBER shows one".into(),
    }
}

/// The campaign's page.
pub(super) fn page(summary: &Summary, seed: u64, sections: Vec<Section>) -> Page {
    Page {
        title: "Fault campaign".into(),
        lead: match summary.failed.len() {
            0 => format!("Every promise of the hazard table held in {} runs.", summary.runs),
            broken => format!("{broken} of {} runs broke a promise of the hazard table.", summary.runs),
        },
        advice: summary
            .failed
            .iter()
            .take(5)
            .map(|o| {
                format!("Look at run {}: `shakedown faults --seed {seed} --run {} --report run.html`.", o.run, o.run)
            })
            .collect(),
        sections,
        provenance: vec![("seed".into(), seed.to_string())],
        ..Page::default()
    }
}

/// What one run was and came to.
pub(super) fn facts(case: &Case, outcome: &Outcome, record: &str) -> Table {
    let broken: Vec<&str> = outcome.broken.iter().map(|how| word(*how)).collect();
    let rows = [
        ("class", case.class.id.to_owned()),
        ("what happens", case.class.what.to_owned()),
        ("fault", case.fault.to_string()),
        ("second fault", case.second.map(|(fault, _)| fault.to_string()).unwrap_or_default()),
        ("rate [1/s]", format!("{:.0}", case.rate())),
        ("modification", format!("{:?}", case.settings.modification)),
        ("orders [s]", orders(case)),
        ("mode", case.mode().to_owned()),
        ("record", record.to_owned()),
        ("table", case.table.to_string()),
        ("fault begins [s]", format!("{:.3}", outcome.onset_s)),
        ("promised", case.class.promise.to_string()),
        ("reported", outcome.reported.clone().unwrap_or_else(|| "no".into())),
        ("latency [ms]", outcome.latency_s.map(millis).unwrap_or_default()),
        ("limit switches [mm]", case.limit_switches.map_or_else(|| "none".into(), millimetres)),
        ("farthest [mm]", millimetres(outcome.farthest_m)),
        ("undetected deviation [mm]", millimetres(outcome.deviation_m)),
        ("broken", broken.join(", ")),
    ];
    Table {
        columns: vec![String::new(), format!("run {}", case.number)],
        rows: rows.into_iter().map(|(name, value)| vec![name.into(), value]).collect(),
        caption: "One run".into(),
    }
}

/// What the operator asks for and when.
fn orders(case: &Case) -> String {
    let order = |(tick, order): &(usize, OperatorRequest)| format!("{order:?} {:.2}", *tick as f64 / case.rate());
    case.orders.iter().map(order).collect::<Vec<_>>().join(", ")
}

/// One run, drawn.
pub(super) fn run_page(case: &Case, pair: &Pair, table: Table) -> Page {
    let seen = &pair.seen;
    let time: Vec<f64> = seen.iter().map(|s| s.time).collect();
    let onset = time.get(case.onset).copied().unwrap_or(0.0);
    let end = time.last().copied().unwrap_or(0.0);
    let series = |name: &str, style, of: &dyn Fn(&TruthSample) -> f64| Series {
        name: name.into(),
        x: time.clone(),
        y: seen.iter().map(of).collect(),
        style,
    };
    let plot = |title: &str, label: &str, series: Vec<Series>| {
        Item::Plot(Plot {
            title: title.into(),
            x: Axis { label: "time [s]".into(), ..Axis::default() },
            y: Axis { label: label.into(), ..Axis::default() },
            series,
            bands: vec![Band { from: onset, to: end, label: "fault".into() }],
            group: Some("run".into()),
            ..Plot::default()
        })
    };
    let twin = Series {
        name: "without the fault".into(),
        x: time.clone(),
        y: pair.without.iter().map(|x| 1e3 * x).collect(),
        style: Style::Faint,
    };
    let items = vec![
        Item::Table(table),
        plot(
            "Displacement",
            "displacement [mm]",
            vec![
                series("table", Style::Line, &|s| 1e3 * s.x),
                series("LVDT", Style::Faint, &|s| 1e3 * s.measured),
                series("reference after modification", Style::Dashed, &|s| 1e3 * s.reference),
                twin,
            ],
        ),
        plot("Output", "output [mm]", vec![series("output", Style::Line, &|s| 1e3 * s.output)]),
    ];
    let sections = vec![Section { heading: "Run".into(), items }];
    let lead = format!("{}, from {onset:.3} s on.", case.class.what);
    Page { title: format!("Faulted run {}", case.number), lead, sections, ..Page::default() }
}
