//! `shakedown faults --adversary RUNS`: the worst case of every class that a search finds.

use super::super::{Failure, present, progress};
use super::Args;
use crate::faults::adversary::{GENERATION, Search, search};
use crate::faults::{Beside, CLASSES, Case, Class, Motions};
use crate::files::json;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;
use std::path::Path;

/// Searches and shows what was found.
pub(super) fn adversary(args: &Args, runs: u64, motions: &Motions) -> Result<(), Failure> {
    let runs = runs.next_multiple_of(GENERATION);
    let only = args.class.as_deref().and_then(Class::named);
    let wanted = CLASSES.iter().skip(1).filter(|class| only.is_none_or(|only| only.id == class.id));
    // A shard takes every so manyeth class.
    let mine = |k: &usize| *k as u64 % args.shard.of == args.shard.number - 1;
    let classes: Vec<&'static Class> = wanted.enumerate().filter(|(k, _)| mine(k)).map(|(_, class)| class).collect();
    if let Some(folder) = &args.out {
        std::fs::create_dir_all(folder).map_err(|e| Failure::Input(format!("--out {}: {e}", folder.display())))?;
    }
    let bar = progress::bar(runs * classes.len() as u64, "runs");
    let mut found = Vec::new();
    for class in classes {
        let begin = Search::new(class, args.seed, args.beside());
        let done = search(begin, class, runs, args.out.as_deref(), motions, &|n| bar.inc(n));
        found.push((class, done.map_err(|e| Failure::Work(e.to_string()))?));
    }
    bar.finish_and_clear();
    let sections = vec![section(&found, args.beside())];
    if !args.outputs.quiet() {
        sections.iter().for_each(present::print_section);
    }
    let searches: Vec<&Search> = found.iter().map(|(_, search)| search).collect();
    let json = json!({"schema": "shakedown.adversary/1", "seed": args.seed, "beside": args.beside(),
                      "searches": searches});
    args.outputs.write_json(json, &motions.files)?;
    let broken: u64 = searches.iter().map(|search| search.broken).sum();
    let total: u64 = searches.iter().map(|search| search.runs).sum();
    let lead = format!("{total} runs dealt by a search for the worst; {broken} broke a promise.");
    let provenance = vec![("seed".into(), args.seed.to_string())];
    let mut page = Page { title: "Adversarial search".into(), lead, sections, provenance, ..Page::default() };
    args.outputs.write_report(&mut page, &motions.files)?;
    if broken > 0 {
        let first = searches.iter().find_map(|search| Some((search, search.breaks.first()?)));
        let which = first.map(|(search, first)| {
            let (class, run, broken) = (&search.class, first.outcome.run, &first.outcome.broken);
            format!("; the first: {class}, run {run}, {broken:?}")
        });
        return Err(Failure::Work(format!("{broken} of {total} runs broke a promise{}", which.unwrap_or_default())));
    }
    Ok(())
}

/// A case that a search kept in its file: the one of this number, or the worst.
pub(super) fn case(file: &Path, run: Option<u64>, motions: &Motions) -> Result<Case, Failure> {
    let search: Search = json::read(file).map_err(|e| Failure::Input(e.to_string()))?;
    let not = |what: String| Failure::Input(format!("{}: {what}", file.display()));
    let class = Class::named(&search.class).ok_or_else(|| not(format!("there is no class {}", search.class)))?;
    let found = search.kept(run).ok_or_else(|| {
        let kept: Vec<String> = search.worst.iter().chain(&search.breaks).map(|f| f.outcome.run.to_string()).collect();
        not(format!("that run was not kept; kept are {}", kept.join(", ")))
    })?;
    Ok(search.deal(class, &found.numbers, found.outcome.run, motions))
}

fn section(found: &[(&'static Class, Search)], beside: Beside) -> Section {
    let row = |(class, search): &(&'static Class, Search)| {
        let mut cells = vec![class.id.to_owned(), class.promise.to_string(), search.runs.to_string()];
        cells.push(search.broken.to_string());
        cells.extend(search.worst.as_ref().map_or_else(
            || vec![String::new(); 4],
            |worst| {
                vec![
                    format!("{:.2}", worst.used),
                    worst.outcome.mode.clone(),
                    format!("{:.1}", 1e3 * worst.outcome.farthest_m),
                    worst.outcome.reported.clone().unwrap_or_else(|| "no".into()),
                ]
            },
        ));
        cells
    };
    let columns = ["class", "promised", "runs", "broken", "promise used", "mode", "farthest [mm]", "reported"];
    let switches = super::page::beside_words(beside);
    let table = Table {
        columns: columns.map(String::from).to_vec(),
        rows: found.iter().map(row).collect(),
        caption: format!(
            "The worst case found of each class, {switches}; what is used of a promise is the largest share of a way, a time or an \
             acceleration. Above 1 it is broken, but for times below 1 kHz, which may be some ticks longer: see the column `broken`"
        ),
    };
    Section { heading: "Adversarial search".into(), items: vec![Item::Table(table)] }
}
