//! The report: before and after in time, spectra, what was given up and where.

use super::super::Failure;
use super::super::histories::strong_motion;
use super::super::indices;
use super::missed;
use crate::motion::fit::Norm;
use crate::motion::fit::answer::{Answer, Compared, Errors};
use crate::motion::fit::certificate::Stretch;
use crate::motion::fit::method::Method;
use crate::motion::metrics::RelativeError;
use crate::motion::spectrum::{periods, response_spectrum};
use crate::motion::{Motion, STANDARD_GRAVITY, peak};
use crate::report::{Axis, Band, Item, Page, Plot, Section, Series, Style, Table};
use std::fmt::Write as _;

/// The whole page.
pub(super) fn page(answer: &Answer) -> Result<Page, Failure> {
    let compared = &answer.compared;
    let mut lead = format!(
        "{} fitted to {:.3} m/s and {:.3} m ({}): acceleration error E_a {:.3}, where clipping leaves {:.3}.",
        answer.name,
        answer.limits.velocity,
        answer.limits.stroke.unwrap_or(f64::INFINITY),
        answer.method_name(),
        compared.fitted.e_a.ratio,
        compared.clipped.e_a.ratio,
    );
    if let Some(far) = beyond(answer) {
        let _ = write!(lead, " It goes {far:.3} m far, beyond the stroke.");
    }
    Ok(Page {
        title: format!("{} fitted", answer.name),
        lead,
        key: key(answer),
        advice: advice(answer),
        sections: vec![in_time(answer), spectra(answer)?, given_up(answer)],
        details: vec![summary(answer)],
        provenance: vec![("conditioning".into(), answer.conditioning.clone())],
    })
}

/// The figures that matter most.
fn key(answer: &Answer) -> Vec<(String, String)> {
    let (far, fast) = answer.modified.motion.peaks_between();
    let mut key = vec![("E_a of the fit".to_owned(), format!("{:.3}", answer.compared.fitted.e_a.ratio))];
    key.extend(proven(answer).map(|bound| {
        (format!("E_a by steps of velocity; proven: none below {bound:.4}"), format!("{:.4}", answer.compared.steps))
    }));
    key.push((format!("speed, of {} m/s", answer.limits.velocity), format!("{fast:.4} m/s")));
    if let Some(stroke) = answer.limits.stroke {
        key.push((format!("farthest, of {stroke} m"), format!("{far:.4} m")));
    }
    let peak = peak(&answer.modified.motion.acceleration);
    key.push(("peak acceleration".into(), format!("{:.3} g", peak / STANDARD_GRAVITY)));
    key
}

/// The bound, where it is on E_a by steps of velocity and no other norm.
fn proven(answer: &Answer) -> Option<f64> {
    let squares = matches!(answer.method, Method::Taut | Method::Convex(Norm::Two));
    answer.modified.bound.filter(|_| squares)
}

/// How far the motion goes, m, where that is beyond the stroke: some methods do not look at it.
fn beyond(answer: &Answer) -> Option<f64> {
    let (far, _) = answer.modified.motion.peaks_between();
    answer.limits.stroke.filter(|stroke| far > stroke * 1.001).map(|_| far)
}

/// What to do next.
fn advice(answer: &Answer) -> Vec<String> {
    if beyond(answer).is_some() {
        return vec!["Do not play it: the table ends before the motion does. Fit with `--method convex`, which keeps the stroke too.".into()];
    }
    let mut advice = Vec::new();
    match answer.drive.iter().find(|(key, _)| key == "file") {
        Some((_, file)) => advice.push(format!(
            "Rehearse it, `shakedown run --record {file}`, then play it: `shakedown device run {file}`."
        )),
        None => advice.push("Write the drive with `--out drive.csv`.".into()),
    }
    if !answer.stretches().is_empty() {
        advice.push("If the error is too large, ask what it would take with `--target E_A`, or keep the response spectrum instead of the \
                     waveform with `--objective spectrum`.".into());
    }
    advice
}

/// The figures of the fit, as the terminal shows them too.
pub(super) fn summary(answer: &Answer) -> Section {
    let Compared { fitted, clipped, indices: found, .. } = &answer.compared;
    let none = RelativeError { ratio: 0.0, delay: 0.0 };
    let rows = [
        ("asked for", &answer.motion, &Errors { e_a: none, e_d: none }),
        ("fitted", &answer.modified.motion, fitted),
        ("clipped (Eq. 10)", &answer.clipped, clipped),
    ];
    let mut table = Table {
        columns: ["motion", "E_a", "E_d", "peak [g]", "peak [m/s]", "farthest [m]", "end [mm]"].map(Into::into).into(),
        rows: Vec::new(),
        caption: "E_a and E_d unsquared and without shift, against what was asked for.".into(),
    };
    for (name, motion, against) in rows {
        let (x, v, a) = motion.peaks();
        let end = motion.displacement.last().copied().unwrap_or(0.0);
        table.rows.push(vec![
            name.into(),
            format!("{:.4}", against.e_a.ratio),
            format!("{:.4}", against.e_d.ratio),
            format!("{:.3}", a / STANDARD_GRAVITY),
            format!("{v:.4}"),
            format!("{x:.4}"),
            // A zero has no sign.
            format!("{:.3}", (1e6 * end).round() / 1e3 + 0.0),
        ]);
    }
    let mut items = vec![
        Item::Text(format!("Method: {}. Conditioning: {}.", answer.method_name(), answer.conditioning)),
        Item::Table(table),
    ];
    if let Some(bound) = proven(answer) {
        items.push(Item::Text(format!(
            "Proven: no motion within these limits has an E_a below {bound:.4} by steps of velocity from sample to sample; this one has \
             {:.4}. The E_a of the table is of samples of the acceleration, whose slopes are smoother.",
            answer.compared.steps
        )));
    } else if let Some(bound) = answer.modified.bound {
        items.push(Item::Text(format!(
            "Proven: no motion within these limits has a relative acceleration error below {bound:.4} in the norm that was \
             made small."
        )));
    }
    if matches!(answer.method, Method::Clip | Method::Taut) {
        items.push(Item::Note("This method does not look at the stroke: see how far the motion goes.".into()));
    }
    items.extend(target(answer));
    items.extend(indices::tables(&[("fit", found)]));
    Section { heading: format!("{} fitted to the table", answer.name), items }
}

/// What it would take to meet the target.
fn target(answer: &Answer) -> Vec<Item> {
    let Some(target) = answer.target else { return Vec::new() };
    if answer.relaxations.is_empty() {
        return vec![Item::Text(format!("The target, E_a {target}, is met within the limits."))];
    }
    let rows = answer
        .relaxations
        .iter()
        .map(|r| {
            vec![
                r.relaxed.name().into(),
                format!("{:.3}", r.met_at),
                format!("{:.4}", r.error),
                format!("{:.3}", r.missed_at),
                format!("{:.4}", r.bound),
            ]
        })
        .collect();
    vec![Item::Table(Table {
        columns: ["relaxed", "enough: times", "E_a reached", "not enough: times", "E_a at least"]
            .map(Into::into)
            .into(),
        rows,
        caption: format!("What E_a {target} takes: smallest factors, proven from both sides."),
    })]
}

pub(super) fn given_up(answer: &Answer) -> Section {
    let stretches = answer.stretches();
    let rows: Vec<Vec<String>> = stretches
        .iter()
        .take(12)
        .map(|s| {
            vec![
                format!("{:.2}", s.from),
                format!("{:.2}", s.to),
                format!("{:.1}", 100.0 * s.share),
                format!("{:.3}", s.peak / STANDARD_GRAVITY),
                touched(s),
            ]
        })
        .collect();
    let mut items = Vec::new();
    if rows.is_empty() {
        items.push(Item::Text("Nothing was given up: the record keeps within the limits.".into()));
    } else {
        items.push(Item::Table(Table {
            columns: ["from [s]", "to [s]", "share [%]", "largest error [g]", "limits touched"].map(Into::into).into(),
            rows,
            caption: format!("Stretches by their share of the squared acceleration error; {} in all.", stretches.len()),
        }));
    }
    items.extend(missed::periods(answer));
    Section { heading: "What was given up, and where".into(), items }
}

/// The limits that a stretch touches, in words.
fn touched(stretch: &Stretch) -> String {
    if stretch.limits.is_empty() { "none: recovering".into() } else { stretch.limits.join(", ") }
}

fn in_time(answer: &Answer) -> Section {
    let (before, after) = (&answer.motion, &answer.modified.motion);
    let bands: Vec<Band> = answer
        .stretches()
        .iter()
        .filter(|s| s.share > 0.01)
        .map(|s| Band { from: s.from, to: s.to, label: touched(s) })
        .collect();
    let error: Vec<f64> =
        before.acceleration.iter().zip(&after.acceleration).map(|(a, b)| (b - a) / STANDARD_GRAVITY).collect();
    let g = |m: &Motion| m.acceleration.iter().map(|a| a / STANDARD_GRAVITY).collect::<Vec<_>>();
    let plot = |title: &str, unit: &str, series: Vec<Series>| {
        Item::Plot(Plot {
            title: title.into(),
            x: Axis { label: "time [s]".into(), log: false },
            y: Axis { label: format!("{} [{unit}]", title.to_lowercase()), log: false },
            series,
            bands: bands.clone(),
            group: Some("time".into()),
            open: strong_motion(&before.acceleration, before.dt),
        })
    };
    let dt = before.dt;
    let curve = |name: &str, y: &[f64], style| curve(name, y, dt, style);
    let (last, v, x) = (before.duration(), answer.limits.velocity, answer.limits.stroke);
    let mut speed = vec![
        curve("clipped", &answer.clipped.velocity, Style::Faint),
        curve("asked for", &before.velocity, Style::Dashed),
        curve("fitted", &after.velocity, Style::Line),
    ];
    speed.extend(walls(Some(v), last));
    let mut travel = vec![
        curve("clipped", &answer.clipped.displacement, Style::Faint),
        curve("asked for", &before.displacement, Style::Dashed),
        curve("fitted", &after.displacement, Style::Line),
    ];
    travel.extend(walls(x, last));
    let shaken = vec![curve("asked for", &g(before), Style::Dashed), curve("fitted", &g(after), Style::Line)];
    Section {
        heading: "In time".into(),
        items: vec![
            plot("Acceleration", "g", shaken),
            plot("Acceleration error", "g", vec![curve("fitted less asked for", &error, Style::Line)]),
            plot("Velocity", "m/s", speed),
            plot("Displacement", "m", travel),
        ],
    }
}

/// A limit as two dashed lines.
fn walls(limit: Option<f64>, last: f64) -> Vec<Series> {
    let line =
        |name: &str, y: f64| Series { name: name.into(), x: vec![0.0, last], y: vec![y, y], style: Style::Dashed };
    limit.map_or_else(Vec::new, |l| vec![line("limit", l), line("limit below", -l)])
}

/// A curve over time.
fn curve(name: &str, y: &[f64], dt: f64, style: Style) -> Series {
    Series { name: name.into(), x: (0..y.len()).map(|k| k as f64 * dt).collect(), y: y.to_vec(), style }
}

fn spectra(answer: &Answer) -> Result<Section, Failure> {
    let at = periods(0.03, 5.0, 160);
    let of = |motion: &Motion| {
        response_spectrum(&motion.acceleration, motion.dt, 0.05, &at)
            .map(|s| s.s_a_in_g())
            .map_err(|e| Failure::Work(format!("modify: {e}")))
    };
    let curves = [
        ("clipped", &answer.clipped, Style::Faint),
        ("asked for", &answer.motion, Style::Dashed),
        ("fitted", &answer.modified.motion, Style::Line),
    ];
    let mut series = Vec::new();
    for (name, motion, style) in curves {
        series.push(Series { name: name.into(), x: at.clone(), y: of(motion)?, style });
    }
    let mut bands = Vec::new();
    if let Method::Spectrum(band) = answer.method {
        bands.push(Band { from: band.shortest, to: band.longest, label: "kept".into() });
    }
    Ok(Section {
        heading: "Response spectrum".into(),
        items: vec![Item::Plot(Plot {
            title: "Spectral acceleration, 5 % damping".into(),
            x: Axis { label: "period [s]".into(), log: true },
            y: Axis { label: "S_a [g]".into(), log: false },
            series,
            bands,
            group: None,
            ..Plot::default()
        })],
    })
}
