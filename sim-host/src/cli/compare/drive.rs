//! A drive and the recording of it: how near the table came, and the entry of `[[runs]]` that the recording makes.

use super::super::output::{fingerprints, print, tell};
use super::super::places::file_name;
use super::super::{Failure, histories, indices, present};
use super::{Args, Asked};
use crate::motion::Motion;
use crate::motion::metrics::{Played, Recorded, played};
use crate::motion::spectrum::{periods, response_spectrum};
use crate::plant::sensors::GRAVITY;
use crate::recording::Channel;
use crate::recording::propose::{Look, look};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Reference and drive further apart than this are not the same, RMS over RMS.
const SAME: f64 = 0.02;

/// Finds the drive in the recording and shows how near the table came.
pub(super) fn run(args: &Args, recording: &Path, asked: Asked) -> Result<(), Failure> {
    let seen = seen(args, recording)?;
    let signals = Signals::of(&seen, recording)?;
    let found = played(&asked.motion, &signals.recorded())
        .map_err(|e| Failure::Input(format!("{}: {e}", recording.display())))?;
    let inputs = vec![args.first.clone(), args.second.clone()];
    let entry = entry(args, recording, &found, &signals, &inputs)?;
    args.outputs.write_json(as_json(&found, &signals, &asked, &entry), &inputs)?;
    let page = page(args, &asked, &found, &signals, &seen, &entry)?;
    if !args.outputs.quiet() {
        print(&format!("{}\n\n", page.lead));
        page.details.iter().for_each(present::print_section);
        for line in &page.advice {
            print(&format!("{line}\n"));
        }
        print(&format!("\n{entry}"));
    }
    args.outputs.write_report(&mut { page }, &inputs)
}

/// The recording's columns as channels.
fn seen(args: &Args, recording: &Path) -> Result<Look, Failure> {
    let stated = [
        (Channel::Displacement, &args.displacement),
        (Channel::Acceleration, &args.acceleration),
        (Channel::Reference, &args.reference),
    ];
    let stated: Vec<(Channel, String)> =
        stated.into_iter().filter_map(|(channel, name)| Some((channel, name.clone()?))).collect();
    let seen = look(recording, &args.text.stated(), &stated).map_err(|e| Failure::Input(e.to_string()))?;
    for note in &seen.notes {
        tell(&format!("note: {}: {note}", recording.display()));
    }
    Ok(seen)
}

/// The channels of a recording.
pub(super) fn signals(args: &Args, recording: &Path) -> Result<Signals, Failure> {
    Signals::of(&seen(args, recording)?, recording)
}

/// A motion found in a recording.
pub(super) fn found(args: &Args, recording: &Path, motion: &Motion) -> Result<Played, Failure> {
    let signals = signals(args, recording)?;
    played(motion, &signals.recorded()).map_err(|e| Failure::Input(format!("{}: {e}", recording.display())))
}

/// The channels of the recording, in SI.
pub(super) struct Signals {
    pub(super) dt: f64,
    pub(super) displacement: Vec<f64>,
    acceleration: Option<Vec<f64>>,
    reference: Option<Vec<f64>>,
}

impl Signals {
    fn of(seen: &Look, path: &Path) -> Result<Self, Failure> {
        let names: Vec<&str> = seen.facts.iter().map(|f| f.heading.name.as_str()).take(30).collect();
        let missing = |what: &str, option: &str| {
            Failure::Input(format!(
                "{}: no column could be named as {what}{option}; columns: {}",
                path.display(),
                names.join(", ")
            ))
        };
        let dt = seen.step().ok_or_else(|| missing("the time, rising evenly", ""))?;
        let displacement = seen
            .channel(Channel::Displacement)
            .ok_or_else(|| missing("the table's displacement", ": name it with --displacement COLUMN"))?;
        let certain = |channel| {
            let choice = seen.choices.iter().find(|c| c.channel == channel)?;
            (!choice.doubtful).then(|| seen.channel(channel)).flatten()
        };
        Ok(Self {
            dt,
            displacement,
            acceleration: certain(Channel::Acceleration),
            reference: seen.channel(Channel::Reference),
        })
    }

    fn recorded(&self) -> Recorded<'_> {
        Recorded {
            dt: self.dt,
            displacement: &self.displacement,
            acceleration: self.acceleration.as_deref(),
            reference: self.reference.as_deref(),
        }
    }
}

/// What `[[runs]]` says of the recording.
fn entry(
    args: &Args,
    recording: &Path,
    found: &Played,
    signals: &Signals,
    inputs: &[PathBuf],
) -> Result<String, Failure> {
    let drive = if recording == args.first { &args.second } else { &args.first };
    let prints = fingerprints(inputs)?;
    let hash = prints.get(drive.display().to_string()).and_then(|v| v.as_str()).unwrap_or_default().to_owned();
    let name = toml_string(&file_name(recording));
    let (from, to) = (found.samples.start as f64 * signals.dt, found.samples.end as f64 * signals.dt);
    Ok(format!(
        "[[runs]]\nfile = {name}\n# drive: {}, SHA-256 {hash}, from {:.3} s after the first row\n# from_s = {from:.4}   to_s = {to:.4}   \
         # after the first row; only the stretch of the drive\n",
        drive.display(),
        found.start,
    ))
}

/// A string as TOML writes it.
fn toml_string(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn as_json(found: &Played, signals: &Signals, asked: &Asked, entry: &str) -> serde_json::Value {
    let c = &found.comparison;
    json!({
        "schema": "shakedown.played/1",
        "start_s": found.start, "covered": found.covered, "offset": found.offset, "rate_hz": 1.0 / signals.dt,
        "reference_error": found.reference_error,
        "delay_s": found.reference_error.map(|_| found.indices.delay),
        "acceleration": if signals.acceleration.is_some() { "measured" } else { "second derivative of the displacement" },
        "metrics": { "e_a": c.e_a.ratio, "e_d": c.e_d.ratio, "peak_g": c.response_peak / GRAVITY,
                     "reference_peak_g": c.reference_peak / GRAVITY },
        "indices": indices::value(&found.indices),
        "drive": asked.facts.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "runs_entry": entry,
    })
}

fn page(
    args: &Args,
    asked: &Asked,
    found: &Played,
    signals: &Signals,
    seen: &Look,
    entry: &str,
) -> Result<Page, Failure> {
    let c = &found.comparison;
    let mut key = vec![
        ("E_a".to_owned(), format!("{:.3}", c.e_a.ratio)),
        ("E_d".into(), format!("{:.3}", c.e_d.ratio)),
        (
            format!("peak; the {}'s is {:.3} g", asked.what, c.reference_peak / GRAVITY),
            format!("{:.3} g", c.response_peak / GRAVITY),
        ),
    ];
    let known = found.reference_error.is_some();
    key.extend(indices::tiles(&found.indices).into_iter().filter(|(name, _)| known || name != "delay"));
    let mut tables = indices::tables(&[("table", &found.indices)]);
    if !known {
        tables.insert(0, Item::Note("The recording holds no reference: the start is the motion's own, and the delay of 0 below says nothing.".into()));
    }
    let channels = seen.choices.iter().filter(|choice| {
        [Channel::Time, Channel::Displacement, Channel::Acceleration, Channel::Reference].contains(&choice.channel)
    });
    let rows = channels.map(|choice| {
        let unit = choice.unit.map_or("unknown", |u| u.symbol);
        let name = seen.facts[choice.column].heading.name.clone();
        vec![choice.channel.name().into(), name, unit.into(), choice.evidence.join("; ")]
    });
    tables.push(Item::Table(Table {
        caption: "Columns of the recording".into(),
        columns: ["channel", "column", "unit", "what speaks for it"].map(String::from).into(),
        rows: rows.collect(),
    }));
    let sections = vec![
        Section { heading: "Over time".into(), items: over_time(found) },
        Section { heading: "Spectra".into(), items: vec![Item::Plot(spectra(found)?)] },
        Section { heading: "Entry of the experiment".into(), items: vec![Item::Text(entry.to_owned())] },
    ];
    let provenance = asked.facts.iter().map(|(k, v)| (format!("{}: {k}", asked.what), v.clone())).collect();
    Ok(Page {
        title: format!("{} and {}", args.first.display(), args.second.display()),
        lead: lead(asked, found),
        key,
        advice: advice(found, signals),
        sections,
        details: vec![Section { heading: "Indices".into(), items: tables }],
        provenance,
    })
}

fn lead(asked: &Asked, found: &Played) -> String {
    let late = |_| format!(", {:.1} ms late", 1e3 * found.indices.delay);
    let delay = found.reference_error.map(late).unwrap_or_default();
    format!(
        "The table followed the {} with E_a {:.3} and E_d {:.3}{delay}; the recording holds {:.0} % of it, from {:.3} s on.",
        asked.what,
        found.comparison.e_a.ratio,
        found.comparison.e_d.ratio,
        100.0 * found.covered,
        found.start
    )
}

fn advice(found: &Played, signals: &Signals) -> Vec<String> {
    let mut advice = Vec::new();
    if let Some(error) = found.reference_error.filter(|error| *error > SAME) {
        advice.push(format!(
            "The recorded reference is {:.1} % from this drive: the controller scaled or filtered it, or another drive was played.",
            100.0 * error
        ));
    }
    if found.covered < 0.98 {
        advice.push(format!(
            "Only {:.0} % of the drive was recorded: the indices are of that part.",
            100.0 * found.covered
        ));
    }
    if signals.acceleration.is_none() {
        advice.push(
            "No column is certain to be the table's acceleration: the second derivative of the displacement stands in; name one with \
             --acceleration COLUMN."
                .into(),
        );
    }
    if found.comparison.e_a.ratio > 0.1 {
        advice
            .push("Look for missing physics with `shakedown diagnose`: the entry below is for the experiment.".into());
    }
    advice
}

fn over_time(found: &Played) -> Vec<Item> {
    let (wanted, achieved) = (&found.wanted, &found.achieved);
    let time: Vec<f64> = (0..wanted.len()).map(|k| k as f64 * wanted.dt).collect();
    let open = histories::strong_motion(&wanted.acceleration, wanted.dt);
    let figure = |title: &str, label: &str, curves: Vec<(&str, Vec<f64>, Style)>| {
        let of = |(name, y, style): (&str, Vec<f64>, Style)| Series { name: name.into(), x: time.clone(), y, style };
        Item::Plot(Plot {
            title: title.into(),
            x: Axis { label: "time from the start of the drive [s]".into(), log: false },
            y: Axis { label: label.into(), log: false },
            series: curves.into_iter().map(of).collect(),
            group: Some("played".into()),
            open,
            ..Plot::default()
        })
    };
    let scaled = |x: &[f64], by: f64| x.iter().map(|x| x * by).collect::<Vec<f64>>();
    let error = |a: &[f64], b: &[f64], by: f64| a.iter().zip(b).map(|(a, b)| by * (a - b)).collect::<Vec<f64>>();
    let (x, y, g) = (&wanted.acceleration, &achieved.acceleration, 1.0 / GRAVITY);
    vec![
        figure(
            "Acceleration below 15 Hz",
            "acceleration [g]",
            vec![("asked for", scaled(x, g), Style::Dashed), ("table", scaled(y, g), Style::Line)],
        ),
        figure("Error of the acceleration", "error [g]", vec![("table less asked for", error(y, x, g), Style::Line)]),
        figure(
            "Displacement, the sensor's offset taken off",
            "displacement [mm]",
            vec![
                ("asked for", scaled(&wanted.displacement, 1e3), Style::Dashed),
                ("table", scaled(&achieved.displacement, 1e3), Style::Line),
            ],
        ),
        figure(
            "Error of the displacement",
            "error [mm]",
            vec![("table less asked for", error(&achieved.displacement, &wanted.displacement, 1e3), Style::Line)],
        ),
    ]
}

/// 5 % response spectra of both.
fn spectra(found: &Played) -> Result<Plot, Failure> {
    let periods = periods(0.05, 5.0, 80);
    let dt = found.wanted.dt;
    let of = |name: &str, a: &[f64], style| {
        response_spectrum(a, dt, 0.05, &periods)
            .map(|s| Series { name: name.into(), x: periods.clone(), y: s.s_a_in_g(), style })
            .map_err(|e| Failure::Work(format!("compare: spectra: {e}")))
    };
    let wanted = of("asked for", &found.wanted.acceleration, Style::Dashed)?;
    let table = of("table", &found.achieved.acceleration, Style::Line)?;
    Ok(Plot {
        title: "Response spectra, 5 % damping".into(),
        x: Axis { label: "period [s]".into(), log: true },
        y: Axis { label: "S_a [g]".into(), log: false },
        series: vec![wanted, table],
        ..Plot::default()
    })
}
