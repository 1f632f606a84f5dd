//! The page of an identification: parameters with intervals, both sides in time and frequency, what is left over.

use super::super::traces::{self, left, over_frequency, over_time, table, words};
use crate::diagnose::locate::leftover;
use crate::digits;
use crate::identify::data::{Measured, Run};
use crate::identify::frequency::{Point, Response};
use crate::identify::judge::Score;
use crate::identify::outcome::Identified;
use crate::identify::spectra;
use crate::plant::model::Kind;
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};

/// Coherence below which a point of a measured response is not shown.
const COHERENT: f64 = 0.5;

/// The page.
pub(super) fn page(name: &str, found: &Identified) -> Page {
    let prepared = &found.prepared;
    let mut first = Vec::new();
    if !found.quantities.is_empty() {
        first.push(Item::Table(parameters(found)));
        first.push(Item::Text(equations(found.fit.model.kind).into()));
    }
    first.extend(found.doubts().into_iter().chain(prepared.remarks()).map(Item::Note));
    let mut sections = vec![Section { heading: "What was found".into(), items: first }];
    if !found.findings.is_empty() {
        let items = vec![Item::Table(traces::findings(&found.findings))];
        sections.push(Section { heading: "The recordings".into(), items });
    }
    let mut standing = vec![Item::Table(standings(found))];
    let tables = traces::location(&leftover(prepared.judging(), &found.held_back.predicted)).into_iter();
    standing.extend(tables.filter(|t| !t.rows.is_empty()).map(Item::Table));
    sections.push(Section { heading: "What stays unexplained, and where".into(), items: standing });
    sections.extend(found.transfer.as_ref().map(super::transfer::section));
    let mut details = Vec::new();
    if !prepared.holdout.is_empty() {
        details.push(runs("The hold-out runs", &prepared.holdout, &found.held_back));
    }
    details.push(runs("The runs fitted", &prepared.fit, &found.fitted));
    Page {
        title: format!("Identification: {name}"),
        lead: lead(found),
        key: tiles(found),
        advice: advice(found),
        sections,
        details,
        ..Page::default()
    }
}

/// chi2 up to which a model counts as predicting everything but noise.
const NOISE_ALONE: f64 = 1.2;

/// What came out, in words first.
pub(super) fn lead(found: &Identified) -> String {
    let (fitted, judged) = (found.fit.chi2(), found.held_back.chi2);
    let on = if found.prepared.holdout.is_empty() {
        "the runs it was fitted to (none was held out)"
    } else {
        "the hold-out runs"
    };
    let verdict = if judged <= NOISE_ALONE {
        format!("The fitted model explains {on} down to the noise")
    } else {
        format!("The fitted model leaves {} times the noise unexplained on {on}", digits::three(judged.sqrt()))
    };
    format!(
        "{verdict}: chi2 {} there, {} on the runs fitted; 1 is the noise floor.",
        digits::three(judged),
        digits::three(fitted)
    )
}

/// What to do next.
fn advice(found: &Identified) -> Vec<String> {
    vec![if found.held_back.chi2 <= NOISE_ALONE {
        "Keep the model, `--out table.toml`, and design and fit with it: `shakedown design table.toml`, `shakedown modify RECORD --table \
         table.toml`."
            .into()
    } else {
        "Look for what the model lacks before it is used: `shakedown diagnose EXPERIMENT.toml`.".into()
    }]
}

/// The equations whose parameters the table lists.
fn equations(kind: Kind) -> &'static str {
    match kind {
        Kind::Servo => {
            "The model: z' = -a1 z + (b0 - b1 a1) u, table velocity = z + b1 u held within the velocity limit; u is the \
             command. From u to displacement that is (b1 s + b0) / (s2 + a1 s)."
        }
        Kind::RigidMass => "The model: mass x'' + viscous x' = gain u; u is the command.",
        Kind::ForceBalance => {
            "The model: pressure difference(t) = scale (x'' + viscous x' + forces)(t + lead), driven by the measured motion; \
             lead is how long before the motion it belongs to the pressure was recorded."
        }
    }
}

fn tiles(found: &Identified) -> Vec<(String, String)> {
    let mut tiles = vec![
        ("chi2, fitted [1]".into(), digits::three(found.fit.chi2())),
        ("chi2, held out [1]".into(), digits::three(found.held_back.chi2)),
    ];
    let judged =
        |channel| found.prepared.fit.iter().flat_map(|r| &r.measured).any(|m| m.channel == channel && m.judged);
    for (channel, nrmse) in found.held_back.nrmse.iter().filter(|(channel, _)| judged(*channel)) {
        tiles.push((
            format!("R2 of {}, held out [1]", channel.name().replace('_', " ")),
            digits::r2(1.0 - nrmse * nrmse),
        ));
    }
    tiles
}

/// Fitted parameters with their intervals.
pub(super) fn parameters(found: &Identified) -> Table {
    let rows = found.quantities.iter().map(|(name, q)| {
        let size = q.std.unwrap_or(f64::NAN);
        let number = |x: Option<f64>| x.map_or("not determined".into(), |x| digits::to(x, size));
        let unit = if q.unit == "1" { "" } else { q.unit };
        vec![
            name.clone(),
            digits::fitted(q.value, q.std),
            number(q.std),
            number(q.low),
            number(q.high),
            unit.to_owned(),
        ]
    });
    table(&["parameter", "value", "std", "90 % from", "90 % to", "unit"], rows.collect(), "Fitted parameters")
}

fn standings(found: &Identified) -> Table {
    let of = |score: &Score, channel| {
        score.nrmse.iter().find(|(c, _)| *c == channel).map_or(String::new(), |(_, e)| format!("{:.3}", 100.0 * e))
    };
    let mut rows = Vec::new();
    for (channel, _) in &found.fitted.nrmse {
        let measured = || found.prepared.fit.iter().flat_map(|r| &r.measured).filter(|m| m.channel == *channel);
        let Some(first) = measured().next() else { continue };
        rows.push(vec![
            words(first),
            if measured().any(|m| m.judged) { "yes" } else { "no" }.into(),
            format!("{:.3e} {}", first.noise, channel.unit()),
            of(&found.fitted, *channel),
            of(&found.held_back, *channel),
        ]);
    }
    let columns = ["channel", "fitted to", "noise floor", "error, fitted [%]", "error, held out [%]"];
    table(&columns, rows, "RMS of what is left over RMS of the measurement about its mean")
}

fn runs(heading: &str, runs: &[Run], score: &Score) -> Section {
    let mut items = Vec::new();
    for (run, predicted) in runs.iter().zip(&score.predicted) {
        for (measured, model) in run.measured.iter().zip(&predicted.channels) {
            if model.iter().all(|v| v.is_nan()) {
                continue;
            }
            let curves =
                vec![("measured", measured.values.clone(), Style::Line), ("model", model.clone(), Style::Dashed)];
            let rest = vec![("measured less model", left(measured, model), Style::Line)];
            items.push(over_time(run, measured, "", curves));
            items.push(over_time(run, measured, ", measured less model", rest));
            if measured.judged {
                items.extend(by_frequency(run, measured, model));
            }
        }
    }
    Section { heading: heading.into(), items }
}

/// Gain and phase from the run's input, and the spectrum of what is left.
fn by_frequency(run: &Run, measured: &Measured, model: &[f64]) -> Vec<Item> {
    let mut items = Vec::new();
    let channel = words(measured);
    let input = if run.law.simulates_reference() { "reference" } else { "command" };
    if run.motion.is_none()
        && let Ok(both) = spectra::responses(run, measured, model)
    {
        let measured = both.measured.within(0.0, f64::INFINITY, COHERENT);
        let shown = |p: &&Point| measured.points.iter().any(|m| m.frequency == p.frequency);
        let model = Response { points: both.model.points.iter().filter(shown).copied().collect() };
        let plot = |what: &str, unit: &str, of: &dyn Fn(&Response) -> Vec<f64>| {
            let series = |name: &str, response: &Response, style| {
                let (x, y) = with_gaps(response, of(response));
                Series { name: name.into(), x, y, style }
            };
            Item::Plot(Plot {
                title: format!("{}: {what} from {input} to {channel}", run.name),
                x: Axis { label: "frequency [Hz]".into(), log: true },
                y: Axis { label: format!("{what} [{unit}]"), log: false },
                series: vec![series("measured", &measured, Style::Line), series("model", &model, Style::Dashed)],
                group: Some(format!("{} frequency", run.name)),
                ..Plot::default()
            })
        };
        if measured.points.len() > 2 {
            items.push(plot("gain", "dB", &|r| r.points.iter().map(Point::decibels).collect()));
            items.push(plot("phase", "deg", &Response::unwrapped_degrees));
        }
    }
    items.push(over_frequency(run, measured, &[("measured less model", model, Style::Line)]));
    items
}

/// Abscissa and ordinate with a hole where neighbouring frequencies were left out, so that no line bridges it.
fn with_gaps(response: &Response, values: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let frequencies: Vec<f64> = response.points.iter().map(|p| p.frequency).collect();
    let spacing = frequencies.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (k, (&frequency, value)) in frequencies.iter().zip(values).enumerate() {
        if let Some(before) =
            k.checked_sub(1).map(|k| frequencies[k]).filter(|before| frequency - before > 3.5 * spacing)
        {
            x.push(0.5 * (before + frequency));
            y.push(f64::NAN);
        }
        x.push(frequency);
        y.push(value);
    }
    (x, y)
}
