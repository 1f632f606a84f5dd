//! What a test shows: its figures, and its histories over time.

use super::super::Failure;
use super::super::histories;
use super::Outcome;
use shakedown::closed_loop::scenario::Scenario;
use shakedown::closed_loop::trial::{Scores, Seen, Setup};
use shakedown::motion::spectrum::{periods, response_spectrum};
use shakedown::plant::sensors::GRAVITY;
use shakedown::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};

/// The page around the sections.
pub(super) fn page(outcome: &Outcome, scenario: &Scenario, sections: Vec<Section>) -> Page {
    let score = &outcome.truth.against_wanted;
    Page {
        title: format!("{}: {}", scenario.name, outcome.played.name),
        lead: format!(
            "The table follows with E_a {:.3} and E_d {:.3}, peaks at {:.3} g of {:.3} g, and spends {:.2} s at its \
             velocity limit.",
            score.e_a.ratio,
            score.e_d.ratio,
            score.response_peak / GRAVITY,
            score.reference_peak / GRAVITY,
            outcome.truth.saturated_s
        ),
        sections,
        provenance: [
            vec![
                ("sensor seed".into(), scenario.sensors.seed.to_string()),
                ("conditioning".into(), outcome.played.conditioning.clone()),
            ],
            outcome.played.drive.iter().map(|(key, value)| (format!("drive: {key}"), value.clone())).collect(),
        ]
        .concat(),
    }
}

/// Figures, histories and spectra.
pub(super) fn sections(outcome: &Outcome, setup: &Setup) -> Result<Vec<Section>, Failure> {
    let trial = &outcome.sensed;
    let items = vec![Item::Text(motion_text(outcome, setup)), Item::Table(figures(outcome))];
    let sampled = format!("Simulated at {:.0} times real time.", outcome.times_real_time);
    let figures = Section { heading: "Figures".into(), items: [items, vec![Item::Text(sampled)]].concat() };
    let histories = Section { heading: "Over time".into(), items: histories::all(trial, "run") };
    Ok(vec![figures, histories, Section { heading: "Spectra".into(), items: vec![Item::Plot(spectra(outcome)?)] }])
}

fn motion_text(outcome: &Outcome, setup: &Setup) -> String {
    let peaks = |(x, v, a): (f64, f64, f64)| format!("{:.3} g, {v:.3} m/s, {x:.3} m", a / GRAVITY);
    let original = peaks(outcome.played.original.peaks());
    let mut text = format!(
        "{}, {:.1} s: peaks {original}. The table's limit is {:.3} m/s.",
        outcome.played.name,
        outcome.played.original.duration(),
        setup.table.velocity_limit()
    );
    text += &format!(" Conditioning: {}.", outcome.played.conditioning);
    if outcome.played.fitted != outcome.played.original {
        text += &format!(" Fitted beforehand to {}.", peaks(outcome.played.fitted.peaks()));
    }
    text
}

fn figures(outcome: &Outcome) -> Table {
    let row =
        |name: &str, of: &dyn Fn(&Scores) -> String| vec![name.into(), of(&outcome.truth), of(&outcome.with_sensors)];
    let three = |x: f64| format!("{x:.3}");
    let rows = vec![
        row("E_a [1]", &|s| three(s.against_wanted.e_a.ratio)),
        row("E_a squared, the paper's reading [1]", &|s| three(s.against_wanted.e_a.squared())),
        row("E_a against the commanded record [1]", &|s| three(s.against_commanded.e_a.ratio)),
        row("E_d [1]", &|s| three(s.against_wanted.e_d.ratio)),
        row("E_d against the commanded record [1]", &|s| three(s.against_commanded.e_d.ratio)),
        row("peak of the reference [g]", &|s| three(s.against_wanted.reference_peak / GRAVITY)),
        row("peak of the table [g]", &|s| three(s.against_wanted.response_peak / GRAVITY)),
        row("peak over reference [1]", &|s| format!("{:.2}", s.against_wanted.spike_ratio())),
        row("delay [ms]", &|s| format!("{:.0}", s.against_wanted.e_a.delay * 1e3)),
        row("time at the velocity limit [s]", &|s| format!("{:.2}", s.saturated_s)),
    ];
    Table {
        caption: "True motion with ideal sensors, and what the sensors show with theirs. Accelerations low-passed at \
                  15 Hz, which those drawn below are not"
            .into(),
        columns: vec!["figure".into(), "true motion".into(), "with sensors".into()],
        rows,
    }
}

/// 5 % response spectra of reference and table.
fn spectra(outcome: &Outcome) -> Result<Plot, Failure> {
    let failed = |e: String| Failure::Work(format!("run: spectra: {e}"));
    let periods = periods(0.05, 5.0, 80);
    let response = outcome.ideal.response(Seen::Truly).map_err(|e| failed(e.to_string()))?;
    let spectrum = |a: &[f64]| {
        response_spectrum(a, response.dt, 0.05, &periods).map(|s| s.s_a_in_g()).map_err(|e| failed(e.to_string()))
    };
    let series = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: periods.clone(), y, style };
    Ok(Plot {
        title: "Response spectra, 5 % damping".into(),
        x: Axis { label: "period [s]".into(), log: true },
        y: Axis { label: "S_a [g]".into(), log: false },
        series: vec![
            series("reference", spectrum(&outcome.ideal.wanted.acceleration)?, Style::Dashed),
            series("table", spectrum(&response.acceleration)?, Style::Line),
        ],
        ..Plot::default()
    })
}
