//! What `learn` shows: the page and the JSON of the runs.

use crate::closed_loop::learning::stale::Staleness;
use crate::closed_loop::learning::{Iteration, Learned, Peaks};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Table};
use serde_json::json;

/// The page: what was gained, what to do, the runs.
pub(super) fn page(learned: &Learned, record: &str, section: Section, checked: Option<&Staleness>) -> Page {
    let e_a: Vec<f64> = learned.rounds.iter().map(|r| r.score.e_a.ratio).collect();
    let lead = match e_a[..] {
        [] => "Nothing was run: what is asked for is predicted to pass a limit of the table.".to_owned(),
        [only] => format!(
            "One run, E_a {only:.3}; the next is predicted to pass a limit and was refused, or was not asked for."
        ),
        [first, .., last] => {
            format!("Learning took E_a from {first:.3} to {last:.3} in {} runs, within the table's limits.", e_a.len())
        }
    };
    let runs: Vec<f64> = (1..=e_a.len()).map(|k| k as f64).collect();
    let curve = |name: &str, y: Vec<f64>| Series { name: name.into(), x: runs.clone(), y, ..Series::default() };
    let e_d = learned.rounds.iter().map(|r| r.score.e_d.ratio).collect();
    let plot = Plot {
        title: "Error run by run".into(),
        x: Axis { label: "run".into(), log: false },
        y: Axis { label: "relative error".into(), log: true },
        series: vec![curve("E_a", e_a.clone()), curve("E_d", e_d)],
        ..Plot::default()
    };
    let mut sections: Vec<Section> = Vec::new();
    if e_a.len() > 1 {
        sections.push(Section { heading: "What was gained".into(), items: vec![Item::Plot(plot)] });
    }
    sections.push(section);
    let advice = match learned.refused {
        Some(refusal) => vec![format!(
            "{refusal}: give the record more room, by a smaller `--velocity` or `--stroke` or a smaller scale."
        )],
        None => vec![
            "Play the drive (`--out`) with the controller it was learnt with. A specimen that has softened makes it stale: record the check \
             motion (`--check`) now and again before it is played, and hold the two against each other with `shakedown compare`."
                .into(),
        ],
    };
    let since =
        checked.map(|found| ("gain since the drive was learnt".to_owned(), format!("{:+.2} %", 100.0 * found.gain)));
    let key = e_a
        .last()
        .map(|e| vec![("E_a of the last run".to_owned(), format!("{e:.3}")), ("runs".into(), e_a.len().to_string())]);
    Page {
        title: format!("Learning {record}"),
        lead,
        key: key.unwrap_or_default().into_iter().chain(since).collect(),
        advice,
        sections,
        ..Page::default()
    }
}

pub(super) fn section(learned: &Learned, record: &str) -> Section {
    let pair = |predicted: Option<f64>, found: f64| match predicted {
        Some(predicted) => format!("{predicted:.3} / {found:.3}"),
        None => format!("- / {found:.3}"),
    };
    let row = |(i, r): (usize, &Iteration)| {
        let of = |get: fn(&Peaks) -> f64| pair(r.predicted.as_ref().map(get), get(&r.peaks));
        vec![
            (i + 1).to_string(),
            format!("{:.3}", r.score.e_a.ratio),
            format!("{:.4}", r.score.e_d.ratio),
            of(|p| p.displacement),
            of(|p| p.velocity),
            of(|p| p.acceleration),
        ]
    };
    let columns = ["run", "E_a [1]", "E_d [1]", "displacement [m]", "velocity [m/s]", "acceleration [m/s2]"];
    let table = Table {
        caption: "Run by run; peaks predicted / found, within the band learned".into(),
        columns: columns.map(String::from).to_vec(),
        rows: learned.rounds.iter().enumerate().map(row).collect(),
    };
    let mut items: Vec<Item> = (!learned.rounds.is_empty()).then_some(Item::Table(table)).into_iter().collect();
    items.extend(learned.refused.map(|refusal| Item::Note(refusal.to_string())));
    if learned.rounds.is_empty() {
        items.push(Item::Note("Nothing was run. Fitted to the table first (--fit), the record may be learned.".into()));
    }
    Section { heading: format!("Learning {record}"), items }
}

pub(super) fn peaks(p: &Peaks) -> serde_json::Value {
    json!({"displacement": p.displacement, "velocity": p.velocity, "acceleration": p.acceleration})
}

/// What two check runs said.
pub(super) fn checked(c: &Staleness) -> serde_json::Value {
    json!({"stale": c.stale, "change": c.change, "gain": c.gain, "delay_s": c.delay})
}

pub(super) fn json(learned: &Learned, found: Option<&Staleness>) -> serde_json::Value {
    let round = |r: &Iteration| {
        json!({"e_a": r.score.e_a.ratio, "e_d": r.score.e_d.ratio, "peaks": peaks(&r.peaks),
               "predicted": r.predicted.as_ref().map(peaks)})
    };
    json!({"runs": learned.rounds.iter().map(round).collect::<Vec<_>>(),
           "refused": learned.refused.map(|r| r.to_string()), "checked": found.map(checked)})
}
