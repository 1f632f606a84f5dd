//! A motion that was held against a standard: the page with verdict, margin, spectra and every rule, and the JSON.

use super::histories::strong_motion;
use crate::motion::STANDARD_GRAVITY as G;
use crate::motion::qualify::{Ordinate, Required, Rule, ScoredModel, Standard};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use serde_json::{Value, json};

/// What came out.
pub(crate) struct Answer {
    /// The motion's name.
    pub(crate) name: String,
    pub(crate) standard: Standard,
    pub(crate) required: Required,
    pub(crate) judged: ScoredModel,
    /// m/s2, every `dt` s.
    pub(crate) acceleration: Vec<f64>,
    pub(crate) dt: f64,
    /// The lowest frequency that is judged, Hz.
    pub(crate) lowest: f64,
}

/// The whole page.
pub(crate) fn page(answer: &Answer) -> Page {
    let against = if answer.standard.is_own() { answer.standard.title } else { answer.standard.id };
    Page {
        title: format!("{} against {against}", answer.name),
        lead: lead(answer),
        key: key(answer),
        advice: advice(answer),
        sections: vec![spectra(answer), rules(answer), history(answer)],
        details: vec![points(answer)],
        provenance: vec![
            ("standard".into(), answer.standard.title.into()),
            ("status of the rules".into(), answer.standard.status.into()),
            (
                "judged".into(),
                format!(
                    "{:.2} to {:.2} Hz, damping {:.0} %",
                    answer.lowest,
                    answer.standard.band.1,
                    100.0 * answer.required.damping
                ),
            ),
        ],
    }
}

/// The figures that matter most.
fn key(answer: &Answer) -> Vec<(String, String)> {
    let judged = &answer.judged;
    let asked = answer.required.zero_period() / G;
    // Of a spectrum alone the last value is no acceleration of the table's.
    let of = if answer.standard.is_own() { String::new() } else { format!(", of {asked:.3} g") };
    vec![
        ("margin: reached over required, least".into(), format!("{:.3}", judged.margin)),
        ("where".into(), format!("{:.2} Hz", judged.worst_hz)),
        (format!("zero-period acceleration{of}"), format!("{:.3} g", judged.zero_period / G)),
        ("strong motion".into(), format!("{:.1} s", judged.intensity.d5_95)),
    ]
}

/// The verdict in a sentence.
fn lead(answer: &Answer) -> String {
    let broken: Vec<&str> = answer.judged.broken().map(|rule| rule.name).collect();
    if answer.standard.is_own() {
        let verdict = if broken.is_empty() { "reaches" } else { "does not reach" };
        return format!("The motion {verdict} the required spectrum: the margin is {:.3}.", answer.judged.margin);
    }
    let verdict = if broken.is_empty() {
        format!(
            "The motion satisfies the rules of {} as they are stated here, with a margin of {:.3}.",
            answer.standard.title, answer.judged.margin
        )
    } else {
        format!("The motion does not satisfy {}: {}.", answer.standard.title, broken.join(", "))
    };
    let alone = if answer.judged.axes > 1 {
        " Spectrum, peak and duration are judged of the first axis alone; of the others only how independent each two are. Judge each other \
         axis in a run of its own, against its own spectrum."
    } else {
        ""
    };
    format!(
        "{verdict}{alone} This is an analysis and no certificate; rules marked so were not checked against the standard's text."
    )
}

fn advice(answer: &Answer) -> Vec<String> {
    let say = |rule: &Rule| match rule.name {
        "envelope" => format!(
            "Raise the motion about {:.2} Hz by {:.1} %: {}.",
            answer.judged.worst_hz,
            100.0 * (1.0 / answer.judged.margin - 1.0),
            rule.place
        ),
        "zero-period acceleration" => "Raise the motion's content above 20 Hz: its peak is too small.".into(),
        "duration" | "strong motion" | "strong-part ratio" => {
            format!("Make the motion longer: {} {:.2} {} of {:.2}.", rule.name, rule.found, rule.unit, rule.bound)
        }
        "stationarity" => format!("Keep the strength even: {}.", rule.place),
        _ => format!(
            "Drive the axes with independent motions, other seeds: {} {:.2}, {}.",
            rule.name, rule.found, rule.place
        ),
    };
    let advised = answer.judged.rules.iter().filter(|rule| rule.advised && !rule.holds);
    let mut advice: Vec<String> = answer.judged.broken().map(say).collect();
    advice.extend(advised.map(|rule| {
        format!(
            "Advised, not required: stay below {:.2} times the required spectrum; {:.2}, {}.",
            rule.bound, rule.found, rule.place
        )
    }));
    if advice.is_empty() && !answer.standard.is_own() {
        advice.push("Have the rules that were not checked held against the standard's text before the figures go into a report.".into());
    }
    advice
}

fn spectra(answer: &Answer) -> Section {
    let ordinates = &answer.judged.ordinates;
    let x: Vec<f64> = ordinates.iter().map(|o| o.frequency).collect();
    let curve = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: x.clone(), y, style };
    let required: Vec<f64> = ordinates.iter().map(|o| o.required / G).collect();
    let mut series = vec![
        curve("test response spectrum", ordinates.iter().map(|o| o.reached / G).collect(), Style::Line),
        curve("required response spectrum", required.clone(), Style::Dashed),
    ];
    if let Some((most, up_to)) = answer.standard.ceiling {
        let y = ordinates.iter().zip(&required).map(|(o, r)| if o.frequency <= up_to { most * r } else { f64::NAN });
        series.push(curve("advised not to exceed", y.collect(), Style::Faint));
    }
    let below = ordinates.iter().map(|o| if o.ratio() < 1.0 { o.reached / G } else { f64::NAN }).collect::<Vec<_>>();
    if below.iter().any(|y| y.is_finite()) {
        series.push(curve("below the required", below, Style::Points));
    }
    let plot = Plot {
        title: format!("Response spectra, {:.0} % damping", 100.0 * answer.required.damping),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: "S_a [g]".into(), log: true },
        series,
        ..Plot::default()
    };
    Section { heading: "Spectra".into(), items: vec![Item::Plot(plot)] }
}

/// Every rule, which the terminal shows too.
pub(crate) fn rules(answer: &Answer) -> Section {
    let g = |rule: &Rule, x: f64| {
        if rule.unit == "m/s2" { format!("{:.3} g", x / G) } else { format!("{x:.3} {}", rule.unit).trim().to_owned() }
    };
    let source = |rule: &Rule| match rule.checked {
        _ if answer.standard.is_own() => "your own",
        true => "public code",
        false => "not checked against the text",
    };
    let rows = answer.judged.rules.iter().map(|rule| {
        vec![
            rule.name.into(),
            g(rule, rule.found),
            format!("{} {}", if rule.at_least { "at least" } else { "at most" }, g(rule, rule.bound)),
            match (rule.holds, rule.advised) {
                (true, _) => "kept",
                (false, true) => "advised only",
                (false, false) => "BROKEN",
            }
            .into(),
            source(rule).into(),
            rule.place.clone(),
        ]
    });
    let table = Table {
        caption: "Every rule, as it is stated here".into(),
        columns: ["rule", "found", "asked", "verdict", "source of the rule", "where"].map(String::from).into(),
        rows: rows.collect(),
    };
    Section { heading: "Rules".into(), items: vec![Item::Table(table)] }
}

fn history(answer: &Answer) -> Section {
    let y: Vec<f64> = answer.acceleration.iter().map(|a| a / G).collect();
    let plot = Plot {
        title: "Acceleration".into(),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: "acceleration [g]".into(), log: false },
        series: vec![Series {
            name: answer.name.clone(),
            x: (0..y.len()).map(|k| k as f64 * answer.dt).collect(),
            y,
            style: Style::Line,
        }],
        open: strong_motion(&answer.acceleration, answer.dt),
        ..Plot::default()
    };
    Section { heading: "The motion".into(), items: vec![Item::Plot(plot)] }
}

fn points(answer: &Answer) -> Section {
    let rows = answer.judged.ordinates.iter().map(|o| {
        vec![
            format!("{:.3}", o.frequency),
            format!("{:.4}", o.required / G),
            format!("{:.4}", o.reached / G),
            format!("{:.3}", o.ratio()),
        ]
    });
    let table = Table {
        caption: format!("Points {} an octave, the grid that serves the motion best", answer.standard.per_octave),
        columns: ["frequency [Hz]", "required [g]", "reached [g]", "ratio"].map(String::from).into(),
        rows: rows.collect(),
    };
    Section { heading: "Point by point".into(), items: vec![Item::Table(table)] }
}

/// The verdict for other tools.
pub(crate) fn value(answer: &Answer) -> Value {
    let judged = &answer.judged;
    let rule = |rule: &Rule| {
        json!({"name": rule.name, "found": rule.found, "bound": rule.bound, "at_least": rule.at_least, "unit": rule.unit,
               "holds": rule.holds, "advised": rule.advised, "checked_against_text": rule.checked, "place": rule.place})
    };
    let ordinate = |o: &Ordinate| json!({"frequency_hz": o.frequency, "required": o.required, "reached": o.reached});
    json!({
        "schema": "shakedown.qualification/1",
        "standard": answer.standard.id, "title": answer.standard.title, "status": answer.standard.status,
        "motion": answer.name, "complies": judged.complies(), "margin": judged.margin, "margin_at_hz": judged.worst_hz,
        "zero_period": judged.zero_period, "required_zero_period": answer.required.zero_period(),
        "damping": answer.required.damping, "from_hz": answer.lowest, "to_hz": answer.standard.band.1,
        "strong_motion_s": judged.intensity.d5_95,
        "rules": judged.rules.iter().map(rule).collect::<Vec<_>>(),
        "spectrum": judged.ordinates.iter().map(ordinate).collect::<Vec<_>>(),
    })
}
