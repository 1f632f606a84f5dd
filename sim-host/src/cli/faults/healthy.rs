//! `shakedown faults --healthy N`: tests with nothing wrong, which must not trip.

use super::super::{Failure, present, progress};
use super::Args;
use crate::faults::Motions;
use crate::faults::healthy::{Healthy, run};
use crate::prove::bounds::upper;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;

/// A tenth or so of the frequencies of the sines, Hz: from, to.
const BANDS: [(f64, f64); 5] = [(0.1, 0.3), (0.3, 1.0), (1.0, 5.0), (5.0, 15.0), (15.0, 30.0)];

/// Runs and shows them.
pub(super) fn healthy(args: &Args, runs: u64, motions: &Motions) -> Result<(), Failure> {
    let bar = progress::bar(runs, "tests");
    let all = run(args.seed, runs, motions, &|n| bar.inc(n)).map_err(|e| Failure::Work(e.to_string()))?;
    bar.finish_and_clear();
    let (beyond, all): (Vec<Healthy>, Vec<Healthy>) = all.into_iter().partition(|one| one.beyond);
    let tripped: Vec<&Healthy> = all.iter().filter(|one| one.tripped.is_some()).collect();
    let bound = upper(tripped.len(), all.len());
    let sections = vec![section(&all, &tripped, (bound, beyond.len()))];
    if !args.outputs.quiet() {
        sections.iter().for_each(present::print_section);
    }
    let json = json!({
        "schema": "shakedown.healthy/1", "seed": args.seed, "runs": all.len(), "trips": tripped.len(), "bound_95": bound,
        "tripped": tripped, "beyond_envelope": beyond,
    });
    args.outputs.write_json(json, &motions.files)?;
    let lead = format!("{} tests with nothing wrong, {} of them tripped.", all.len(), tripped.len());
    let provenance = vec![("seed".into(), args.seed.to_string())];
    let mut page = Page { title: "Healthy tests".into(), lead, sections, provenance, ..Page::default() };
    args.outputs.write_report(&mut page, &motions.files)?;
    match tripped.first() {
        None => Ok(()),
        Some(first) => {
            Err(Failure::Work(format!("{} healthy tests tripped; the first: run {}", tripped.len(), first.run)))
        }
    }
}

fn section(all: &[Healthy], tripped: &[&Healthy], (bound, beyond): (f64, usize)) -> Section {
    let tile = |name: &str, value: String| (name.to_owned(), value);
    let tiles = vec![
        tile("tests", all.len().to_string()),
        tile("trips", tripped.len().to_string()),
        tile("95 % bound [%]", format!("{:.3}", 100.0 * bound)),
        tile("left their envelope, not counted", beyond.to_string()),
    ];
    let mut rows = Vec::new();
    for mode in ["guard", "modifier", "controller", "tracking"] {
        let of = |one: &&Healthy| one.mode == mode;
        rows.push(row(format!("{mode}, record"), all.iter().filter(of).filter(|one| one.sine_hz.is_none())));
        for (low, high) in BANDS {
            let within = |one: &&Healthy| one.sine_hz.is_some_and(|f| f >= low && f < high);
            rows.push(row(format!("{mode}, sine of {low} to {high} Hz"), all.iter().filter(of).filter(within)));
        }
    }
    let columns = ["test", "tests", "trips", "largest acceleration [m/s2]", "farthest [mm]"].map(String::from).to_vec();
    let mut items =
        vec![Item::Tiles(tiles), Item::Table(Table { columns, rows, caption: "By mode and motion".into() })];
    if !tripped.is_empty() {
        let columns = ["run", "mode", "sine [Hz]", "tripped"].map(String::from).to_vec();
        let sine = |one: &Healthy| one.sine_hz.map_or_else(String::new, |f| format!("{f:.2}"));
        let row = |one: &&Healthy| {
            vec![one.run.to_string(), one.mode.to_owned(), sine(one), one.tripped.clone().unwrap_or_default()]
        };
        let rows = tripped.iter().take(100).map(row).collect();
        items.push(Item::Table(Table { columns, rows, caption: "Tests that tripped".into() }));
    }
    Section { heading: "Healthy tests".into(), items }
}

fn row<'a>(name: String, of: impl Iterator<Item = &'a Healthy>) -> Vec<String> {
    let (mut count, mut trips, mut acceleration, mut farthest) = (0, 0, 0.0_f64, 0.0_f64);
    for one in of {
        count += 1;
        trips += u32::from(one.tripped.is_some());
        acceleration = acceleration.max(one.acceleration);
        farthest = farthest.max(one.farthest_m);
    }
    vec![name, count.to_string(), trips.to_string(), format!("{acceleration:.1}"), format!("{:.1}", 1e3 * farthest)]
}
