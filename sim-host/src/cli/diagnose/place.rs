//! Where a mismatch is: what the stated model leaves of the runs fitted, along time, frequency and what explains it.

use super::super::traces::{self, left, over_frequency, words};
use crate::diagnose::Examined;
use crate::diagnose::locate::{StateShare, Stretch};
use crate::identify::data::{Measured, Run};
use crate::identify::evaluate::predict;
use crate::plant::effects::entry;
use crate::recording::signal::rms;
use crate::report::{Axis, Band, Item, Plot, Section, Series, Style};

/// Length of the blocks that one point of the picture over time stands for, s.
const BLOCK: f64 = 0.25;
/// Runs and quantities that are drawn, the most telling first.
const DRAWN: usize = 2;

/// The section.
pub(super) fn section(examined: &Examined) -> Section {
    let location = &examined.diagnosis.location;
    let mut items = Vec::new();
    let mut blocks: Vec<&str> =
        examined.diagnosis.effects.iter().filter_map(|e| entry(e.id)).map(|entry| entry.stage.name()).collect();
    blocks.dedup();
    if !blocks.is_empty() {
        items.push(Item::Text(format!("In the signal path: {}.", blocks.join(", "))));
    }
    items.extend(traces::location(location).into_iter().map(Item::Table));
    let fit = &examined.conclusion.stated.fit;
    let runs = &examined.prepared.fit;
    for name in most_telling(&location.time, runs) {
        let Some((run, local)) = runs.iter().zip(&fit.locals).find(|(run, _)| run.name == name) else { continue };
        let Ok(stated) = predict(&fit.model, run, local) else { continue };
        let judged = || run.measured.iter().zip(&stated.channels).filter(|(measured, _)| measured.judged);
        items.push(along_time(run, judged(), &location.time));
        for (measured, model) in judged() {
            items.push(over_frequency(run, measured, &[("stated model leaves", model, Style::Line)]));
        }
    }
    let seen = location.state.iter().filter(|share| !share.profile.is_empty());
    items.extend(seen.take(DRAWN).map(along));
    Section { heading: "Where it is".into(), items }
}

/// Names of the runs with most of the excess; of the first where no stretch stands out.
fn most_telling<'a>(stretches: &'a [Stretch], runs: &'a [Run]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in stretches.iter().map(|s| s.run.as_str()).chain(runs.iter().map(|r| r.name.as_str())) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.truncate(if stretches.is_empty() { 1 } else { DRAWN });
    names
}

/// RMS of what the stated model leaves, block by block, over the noise.
fn along_time<'a>(
    run: &Run,
    judged: impl Iterator<Item = (&'a Measured, &'a Vec<f64>)>,
    stretches: &[Stretch],
) -> Item {
    let block = ((BLOCK / run.dt).round() as usize).max(1);
    let at = |i: usize| run.from + (i as f64 + 0.5) * block as f64 * run.dt;
    let mut series: Vec<Series> = judged
        .map(|(measured, model)| {
            let y: Vec<f64> =
                left(measured, model).chunks(block).map(|part| rms(part.iter().copied()) / measured.noise).collect();
            Series { name: words(measured), x: (0..y.len()).map(at).collect(), y, style: Style::Line }
        })
        .collect();
    let ends = vec![run.from, run.from + run.len() as f64 * run.dt];
    series.push(Series { name: "noise floor".into(), x: ends, y: vec![1.0; 2], style: Style::Dashed });
    let own = stretches.iter().filter(|s| s.run == run.name);
    let bands =
        own.map(|s| Band { from: s.from_s, to: s.to_s, label: format!("{:.0} % of the excess", 100.0 * s.share) });
    Item::Plot(Plot {
        title: format!("{}: what the stated model leaves, each {BLOCK} s", run.name),
        x: Axis { label: "time [s]".into(), ..Axis::default() },
        y: Axis { label: "RMS of measured less stated model [noise]".into(), log: true },
        series,
        bands: bands.collect(),
        ..Plot::default()
    })
}

/// What is left on average along a quantity that explains it.
fn along(share: &StateShare) -> Item {
    let quantity = share.variable.replace('_', " ");
    let (x, y) = share.profile.iter().map(|&[x, y]| (x, y)).unzip();
    Item::Plot(Plot {
        title: format!("Residual versus {quantity}, {:.0} % of it", 100.0 * share.strength),
        x: Axis { label: format!("{quantity} [{}]", unit(share.variable)), ..Axis::default() },
        y: Axis { label: "mean of measured less stated model [noise]".into(), ..Axis::default() },
        // Between the two signs there is nothing to draw a line through.
        series: vec![Series {
            name: "stated model leaves".into(),
            x,
            y,
            style: if share.variable == "velocity_sign" { Style::Points } else { Style::Line },
        }],
        ..Plot::default()
    })
}

/// Unit of a quantity that a residual is looked at along.
fn unit(variable: &str) -> &'static str {
    match variable {
        "displacement" | "reference" | "path" => "m",
        "velocity" | "speed" => "m/s",
        "acceleration" => "m/s2",
        "command" => "unit of u",
        "pressure" => "unit of p",
        "time" => "s",
        _ => "1",
    }
}
