//! Two recordings of one motion: whether the table with its specimen answers as it did, or a drive learnt before is stale.

use super::super::Failure;
use super::super::output::{print, print_table};
use super::{Args, drive};
use crate::closed_loop::learning::stale::{Staleness, stale};
use crate::motion::metrics::{Recorded, played};
use crate::motion::{Motion, central_difference};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Table};
use serde_json::json;

/// Finds the first recording's motion in the second and holds the two against each other.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let answer = answered(args)?;
    let inputs = vec![args.first.clone(), args.second.clone()];
    let by: Vec<_> = answer
        .by_frequency
        .iter()
        .map(|(f, change, ratio)| json!({ "frequency_hz": f, "change": change, "over_noise": ratio }))
        .collect();
    args.outputs.write_json(
        json!({ "schema": "shakedown.staleness/1", "stale": answer.stale, "change": answer.change,
                "frequency_hz": answer.frequency, "gain": answer.gain, "delay_s": answer.delay, "by_frequency": by }),
        &inputs,
    )?;
    let (lead, table) = (lead(&answer), table(&answer));
    if !args.outputs.quiet() {
        print_table(&table);
        print(&format!("\n{lead}\n"));
    }
    let curve = Plot {
        title: "Change of the answer that no gain and no delay explains".into(),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: "change [%]".into(), log: false },
        series: vec![Series {
            name: "change".into(),
            x: answer.by_frequency.iter().map(|b| b.0).collect(),
            y: answer.by_frequency.iter().map(|b| 100.0 * b.1).collect(),
            ..Series::default()
        }],
        ..Plot::default()
    };
    let sections = vec![Section { heading: "By frequency".into(), items: vec![Item::Plot(curve)] }];
    let details = vec![Section { heading: "Numbers".into(), items: vec![Item::Table(table)] }];
    let title = format!("{} and {}", args.first.display(), args.second.display());
    let key = vec![
        ("largest change".to_owned(), format!("{:.1} %", 100.0 * answer.change)),
        ("gain".into(), format!("{:+.2} %", 100.0 * answer.gain)),
    ];
    args.outputs.write_report(&mut Page { title, lead, key, sections, details, ..Page::default() }, &inputs)
}

/// The motion of the first recording, found in the second, and how the two answers differ.
pub(super) fn answered(args: &Args) -> Result<Staleness, Failure> {
    let (before, now) = (drive::signals(args, &args.first)?, drive::signals(args, &args.second)?);
    let velocity = central_difference(&before.displacement, before.dt);
    let acceleration = central_difference(&velocity, before.dt);
    let motion = Motion { dt: before.dt, displacement: before.displacement, velocity, acceleration };
    let recorded = Recorded { dt: now.dt, displacement: &now.displacement, acceleration: None, reference: None };
    let refuse = |e: &dyn std::fmt::Display| {
        Failure::Input(format!("{} and {}: {e}", args.first.display(), args.second.display()))
    };
    let found = played(&motion, &recorded).map_err(|e| refuse(&e))?;
    stale(&found.wanted.displacement, &found.achieved.displacement, now.dt).map_err(|e| refuse(&e))
}

fn lead(answer: &Staleness) -> String {
    if answer.stale {
        return format!(
            "The answer has changed by {:.1} % about {:.1} Hz, which no gain and no delay explains: the specimen or the table is not what it \
             was. A drive learnt before is stale: learn it again before it is played.",
            100.0 * answer.change,
            answer.frequency
        );
    }
    format!(
        "The table answers as it did, but for {:+.2} % of gain and noise: a drive learnt before holds.",
        100.0 * answer.gain
    )
}

fn table(answer: &Staleness) -> Table {
    let row = |(f, change, ratio): &(f64, f64, f64)| {
        vec![format!("{f:.2}"), format!("{:.2}", 100.0 * change), format!("{ratio:.1}")]
    };
    Table {
        caption: "By sixths of an octave; what a gain, a delay and two slowly varying terms explain is taken out"
            .into(),
        columns: ["frequency [Hz]", "change [%]", "power over noise"].map(String::from).into(),
        rows: answer.by_frequency.iter().map(row).collect(),
    }
}
