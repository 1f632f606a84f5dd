//! What a test shows: its figures, and its histories over time.

use super::super::Failure;
use super::super::histories::{self, Opening};
use super::super::indices;
use super::Outcome;
use crate::closed_loop::scenario::Scenario;
use crate::closed_loop::trial::{ScoredSignal, Scores, Setup, TrialError};
use crate::motion::spectrum::{periods, response_spectrum};
use crate::plant::sensors::GRAVITY;
use crate::recording::Described;
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};

/// The page: verdict, key figures, what to do; histories at the strong motion; tables folded.
pub(super) fn page(
    outcome: &Outcome,
    scenario: &Scenario,
    setup: &Setup,
    described: &Described,
) -> Result<Page, Failure> {
    let score = &outcome.truth.against_wanted;
    let (unit, shown) = described.valve.clone().unwrap_or_else(|| ("%".to_owned(), 100.0));
    let opening = Opening { unit, full: setup.table.full_opening(), shown };
    let failed = |e: TrialError| Failure::Work(format!("run: {e}"));
    let histories = histories::all(&outcome.sensed, "run", &opening).map_err(failed)?;
    let mut key = vec![
        ("E_a".to_owned(), format!("{:.3}", score.e_a.ratio)),
        ("E_d".into(), format!("{:.3}", score.e_d.ratio)),
        (
            format!("peak; the reference's is {:.3} g", score.reference_peak / GRAVITY),
            format!("{:.3} g", score.response_peak / GRAVITY),
        ),
    ];
    key.extend(indices::tiles(&outcome.indices));
    key.push(("at the velocity limit".into(), format!("{:.2} s", outcome.truth.saturated_s)));
    Ok(Page {
        title: format!("{}: {}", scenario.name, outcome.played.name),
        lead: lead(outcome, scenario),
        key,
        advice: advice(outcome),
        sections: vec![
            Section { heading: "Over time".into(), items: histories },
            Section { heading: "Spectra".into(), items: vec![Item::Plot(spectra(outcome)?)] },
        ],
        details: vec![figures_section(outcome, setup)],
        provenance: provenance(outcome, scenario),
    })
}

/// The verdict in a sentence, and what was tested.
fn lead(outcome: &Outcome, scenario: &Scenario) -> String {
    let (score, limit) = (&outcome.truth.against_wanted, outcome.truth.saturated_s);
    let follows = match score.e_a.ratio {
        e if e < 0.1 => "The table follows the record",
        e if e < 0.3 => "The table follows the record with visible errors",
        _ => "The table does not reproduce the record",
    };
    let saturated = if limit > 0.0 {
        format!(", and is at its velocity limit for {limit:.2} s")
    } else {
        " and never reaches its velocity limit".into()
    };
    let controller = controller(scenario);
    format!(
        "{follows}: E_a {:.3}, E_d {:.3}{saturated}. Controller {controller}; {}.",
        score.e_a.ratio,
        score.e_d.ratio,
        fit(outcome, scenario)
    )
}

pub(super) fn controller(scenario: &Scenario) -> &str {
    scenario.controller.as_deref().unwrap_or(if scenario.settings.is_some() { "settings" } else { "current" })
}

fn fit(outcome: &Outcome, scenario: &Scenario) -> String {
    match scenario.fit {
        _ if !outcome.played.drive.is_empty() => "played as it is, a drive".into(),
        None => "played without a fit to the table".into(),
        Some(fit) => format!("fitted beforehand by {}", fit.name()),
    }
}

/// What to do next, from what limits the test.
fn advice(outcome: &Outcome) -> Vec<String> {
    let score = &outcome.truth.against_wanted;
    let mut advice = Vec::new();
    if outcome.truth.saturated_s > 0.0 {
        let how = if outcome.played.drive.is_empty() {
            "Fit the record to the table before it is played: `shakedown modify RECORD --out drive.csv`, or this run with `--fit convex`"
        } else {
            "The drive asks for more than the table's speed: fit it again with `shakedown modify RECORD --velocity` below the limit"
        };
        advice.push(format!("{how}. Without that the table is at its limit for {:.2} s.", outcome.truth.saturated_s));
    }
    let late = 1e3 * score.e_a.delay;
    if late > 30.0 {
        advice.push(format!(
            "The table answers {late:.0} ms late. For the specimen that is no error; for a hybrid test it is: raise the gains within \
             their margins (`shakedown design TABLE.toml`), or take `--controller tracking`."
        ));
    }
    if outcome.truth.saturated_s == 0.0 && score.e_a.ratio > 0.1 {
        advice.push(
            "No limit explains the error: learn the drive on this table (`shakedown learn`), or look for missing physics in a recording \
             (`shakedown diagnose`)."
                .into(),
        );
    }
    if advice.is_empty() {
        advice.push("Nothing stands against this test: write the drive with `shakedown modify` and play it with `shakedown device run`.".into());
    }
    advice
}

fn provenance(outcome: &Outcome, scenario: &Scenario) -> Vec<(String, String)> {
    let stated = [
        ("controller", controller(scenario).to_owned()),
        ("fit", fit(outcome, scenario)),
        ("table", scenario.table.as_ref().map_or_else(|| "the paper's".into(), |path| path.display().to_string())),
        ("conditioning", outcome.played.conditioning.clone()),
        ("sensor seed", scenario.sensors.seed.to_string()),
    ];
    let drive = outcome.played.drive.iter().map(|(key, value)| (format!("drive: {key}"), value.clone()));
    stated.map(|(key, value)| (key.to_owned(), value)).into_iter().chain(drive).collect()
}

/// The tables of the test, which the terminal shows too.
pub(super) fn figures_section(outcome: &Outcome, setup: &Setup) -> Section {
    let mut items = vec![Item::Text(motion_text(outcome, setup)), Item::Table(figures(outcome))];
    items.extend(indices::tables(&[("table", &outcome.indices)]));
    items.push(Item::Text(format!("Simulated at {:.0} times real time.", outcome.times_real_time)));
    Section { heading: "Figures".into(), items }
}

fn motion_text(outcome: &Outcome, setup: &Setup) -> String {
    let peaks = |(x, v, a): (f64, f64, f64)| format!("{:.3} g, {v:.3} m/s, {x:.3} m", a / GRAVITY);
    let original = peaks(outcome.played.original.peaks());
    let limit = setup.table.velocity_limit();
    let limit = if limit.is_finite() {
        format!("The table's limit is {limit:.3} m/s.")
    } else {
        "The table's file states no velocity_limit: it is as fast as it is asked to be.".to_owned()
    };
    let mut text =
        format!("{}, {:.1} s: peaks {original}. {limit}", outcome.played.name, outcome.played.original.duration());
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
    let response = outcome.ideal.response(ScoredSignal::Truly).map_err(|e| failed(e.to_string()))?;
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
