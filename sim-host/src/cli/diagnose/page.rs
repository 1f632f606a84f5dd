//! The page of a diagnosis: what differs, where, what it is, how much better the model with it predicts.

use super::super::traces::{self, left, over_frequency, over_time};
use super::{change, next, place, set_up, term, ties, unfit};
use crate::diagnose::remainder::ResidualCurve;
use crate::diagnose::result::{NamedEffect, Verdict};
use crate::diagnose::{Diagnosis, Examined};
use crate::digits;
use crate::identify::quantity::Quantity;
use crate::recording::Severity;
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use std::collections::BTreeMap;

/// The page.
pub(super) fn page(name: &str, examined: &Examined) -> Page {
    let diagnosis = &examined.diagnosis;
    if diagnosis.verdict == Verdict::BadData {
        return Page {
            title: format!("Diagnosis: {name}"),
            lead: lead(diagnosis),
            key: key(diagnosis),
            advice: advice(diagnosis),
            sections: std::iter::once(findings(diagnosis)).chain(set_up::section(diagnosis)).collect(),
            details: vec![unfit::recorded(examined)],
            ..Page::default()
        };
    }
    let mut sections = vec![verdict(examined)];
    let mut details = Vec::new();
    if !diagnosis.findings.is_empty() {
        sections.push(findings(diagnosis));
    }
    sections.extend(set_up::section(diagnosis));
    if let Some(term) = &diagnosis.term {
        sections.push(term::section(term, quantities(&term.parameters, "Parameters of the equation")));
    }
    if let Some(remainder) = &diagnosis.remainder {
        sections.push(curve(remainder));
    }
    sections.extend(diagnosis.change.as_ref().map(change::section));
    if diagnosis.verdict == Verdict::Mismatch {
        sections.push(place::section(examined));
        details.push(candidates(diagnosis));
    }
    details.push(predicted(examined));
    if let Some(test) = &diagnosis.next_test {
        details.push(next::section(test));
    }
    Page {
        title: format!("Diagnosis: {name}"),
        lead: lead(diagnosis),
        key: key(diagnosis),
        advice: advice(diagnosis),
        sections,
        details,
        ..Page::default()
    }
}

/// The figures that matter most.
fn key(diagnosis: &Diagnosis) -> Vec<(String, String)> {
    let (before, after) = (&diagnosis.judged.before, &diagnosis.judged.after);
    if diagnosis.verdict == Verdict::BadData {
        return vec![("faults found in the recordings".into(), diagnosis.findings.len().to_string())];
    }
    let mut key: Vec<(String, String)> = diagnosis
        .effects
        .iter()
        .map(|e| (format!("probability of {}", e.id), format!("{:.2}", e.probability)))
        .collect();
    key.push(("residual over noise, stated model".into(), digits::three(before.chi2.sqrt())));
    if diagnosis.verdict == Verdict::Mismatch {
        key.push(("with what was found; 1 is noise alone".into(), digits::three(after.chi2.sqrt())));
    }
    if !diagnosis.set_up.is_empty() {
        key.push(("of the set-up found otherwise than stated".into(), diagnosis.set_up.len().to_string()));
    }
    key
}

/// What to do, in the order of its use.
fn advice(diagnosis: &Diagnosis) -> Vec<String> {
    let grave = diagnosis.findings.iter().filter(|f| f.severity == Severity::BadData);
    let mut advice: Vec<String> = grave.take(3).map(|f| format!("{}, {}: {}.", f.run, f.channel, f.remedy)).collect();
    if diagnosis.verdict == Verdict::BadData {
        return advice;
    }
    advice.extend(
        diagnosis
            .set_up
            .iter()
            .filter(|s| s.corrected && s.stated.is_some_and(|stated| stated != 0.0))
            .take(3)
            .map(|s| format!("Correct the experiment: {}.", s.sentence())),
    );
    let modelled = diagnosis.remainder.is_some() || diagnosis.term.is_some();
    let found = modelled || diagnosis.effects.iter().any(|effect| effect.id != "unlisted");
    if diagnosis.verdict == Verdict::Mismatch && found {
        let write = "Write the model with what was found, `shakedown diagnose EXPERIMENT.toml --model table.toml`";
        // Without a loop there is nothing to fit a record to.
        let fit = ", and fit records and gains to it: `shakedown modify RECORD --table table.toml`, `shakedown design table.toml`";
        advice.push(format!("{write}{}.", if diagnosis.model.contains_key("b0") { fit } else { "" }));
    }
    if let Some(test) = &diagnosis.next_test {
        advice.push(format!("Next test: {}; {}.", test.record, test.why));
    }
    advice.extend(set_up::instead(diagnosis));
    advice.extend(diagnosis.no_test.as_ref().map(|why| format!("{why}.")));
    if diagnosis.verdict == Verdict::Consistent && advice.is_empty() {
        advice.push("Use the model as it is stated; another recording at larger amplitude would try it harder.".into());
    }
    advice
}

/// One or two sentences that say what came out.
pub(in super::super) fn lead(diagnosis: &Diagnosis) -> String {
    format!("{}{}", set_up::values(diagnosis), answer(diagnosis))
}

/// What the diagnosis says of the physics.
fn answer(diagnosis: &Diagnosis) -> String {
    let names: Vec<&str> = diagnosis.effects.iter().map(|e| e.id).collect();
    match diagnosis.verdict {
        Verdict::Consistent => {
            let shared = shared(diagnosis, "hardly determine its values");
            format!("The model explains the recordings to within their noise; nothing is missing.{shared}")
        }
        Verdict::BadData => "The recordings cannot be believed as they are; the findings say why.".into(),
        Verdict::Mismatch if names == ["unlisted"] => {
            let nearest =
                diagnosis.part_explained.as_ref().filter(|part| part.share > 0.0 || diagnosis.refusal.is_some());
            let part = nearest.map_or(String::new(), |part| {
                let ids = part.ids.join(" with ");
                diagnosis.refusal.map_or_else(
                    || format!(" The nearest it holds, {ids}, explains {:.0} % of the excess.", 100.0 * part.share),
                    |refusal| format!(" The nearest it holds, {ids}, fails on the runs that judge: {refusal}."),
                )
            });
            let curve = match (&diagnosis.term, &diagnosis.remainder) {
                (Some(term), _) => format!(" {}", term::sentence(term)),
                (None, Some(r)) => {
                    format!(" A curve through what is left, {}, brings that to {:.0} %.", r.equation, 100.0 * r.share)
                }
                (None, None) => String::new(),
            };
            format!("The model lacks physics that the library does not hold.{part}{curve}")
        }
        Verdict::Mismatch => {
            let left = diagnosis.judged.after.chi2;
            let says = if diagnosis.more_missing { "More is missing" } else { "What is named leaves a rest" };
            let more = if diagnosis.more_missing || left > 1.5 {
                let (left, share) = (digits::three(left), share(diagnosis.share_left));
                format!(" {says}: chi2 {left}; {share} % of the initial misfit remains.")
            } else {
                String::new()
            };
            let shared = shared(diagnosis, "do not show it");
            format!("The model lacks {}.{more}{shared}", names.join(" and "))
        }
    }
}

/// Why half of what was held out was fitted too; nothing where it was not.
fn shared(diagnosis: &Diagnosis, why: &str) -> String {
    let half = "half of the stretches of the hold-out runs were fitted too, and the others judged";
    if diagnosis.held_out_shared { format!(" The runs fitted {why}: {half}.") } else { String::new() }
}

/// A share in per cent; not 0.0 where something is left.
fn share(share: f64) -> String {
    let percent = 100.0 * share;
    if percent > 0.0 && percent < 0.05 { "less than 0.1".into() } else { format!("{percent:.1}") }
}

fn verdict(examined: &Examined) -> Section {
    let diagnosis = &examined.diagnosis;
    let (before, after) = (&diagnosis.judged.before, &diagnosis.judged.after);
    let mut items = vec![Item::Tiles(vec![
        ("chi2 held out, before".into(), digits::three(before.chi2)),
        ("chi2 held out, after".into(), digits::three(after.chi2)),
        ("noise floor".into(), "1".into()),
    ])];
    for effect in &diagnosis.effects {
        items.push(Item::Text(format!("{}: {}", effect.id, effect.equation)));
        items.extend(parameters(effect).map(Item::Table));
    }
    for tie in ties::ties(diagnosis) {
        items.push(Item::Note(format!("These runs cannot tell {tie}.")));
    }
    let own = refitted(examined);
    if !own.is_empty() {
        items.push(Item::Table(quantities(&own, "The model's own values, refitted")));
    }
    if let Some(lead) = diagnosis.model.get("lead") {
        let way = if lead.value < 0.0 { "after" } else { "before" };
        let by = 1e3 * lead.value.abs();
        items.push(Item::Note(format!(
            "The pressure was recorded {by:.2} ms {way} the motion it belongs to; the model's lead allows for that."
        )));
    }
    items.extend(examined.prepared.remarks().into_iter().map(Item::Note));
    Section { heading: "What is missing".into(), items }
}

/// An effect's parameters with their intervals; none where it has none.
pub(in super::super) fn parameters(effect: &NamedEffect) -> Option<Table> {
    let caption = format!("{}, probability {:.2}", effect.id, effect.probability);
    let told = effect.told();
    (!told.is_empty()).then(|| quantities(&told, &caption))
}

/// The model's own values that were fitted.
fn refitted(examined: &Examined) -> BTreeMap<String, Quantity> {
    let model = &examined.conclusion.accepted.fit.model;
    let free = |key: &str| model.kind.parameters().iter().zip(&model.own).any(|(p, v)| p.key == key && v.free);
    examined.diagnosis.model.iter().filter(|(key, _)| free(key)).map(|(key, q)| (key.clone(), q.clone())).collect()
}

/// Values with their intervals.
fn quantities(values: &BTreeMap<String, Quantity>, caption: &str) -> Table {
    let rows = values.iter().map(|(key, q)| {
        let size = q.std.unwrap_or(f64::NAN);
        let number = |x: Option<f64>| x.map_or("not determined".into(), |x| digits::to(x, size));
        let unit = if q.unit == "1" { "" } else { q.unit };
        vec![key.clone(), digits::fitted(q.value, q.std), number(q.std), number(q.low), number(q.high), unit.to_owned()]
    });
    traces::table(&["parameter", "value", "std", "90 % from", "90 % to", "unit"], rows.collect(), caption)
}

fn findings(diagnosis: &Diagnosis) -> Section {
    let table = traces::findings(&diagnosis.findings);
    Section { heading: "The recordings".into(), items: vec![Item::Table(table)] }
}

/// The curve that stands for what the library does not hold.
fn curve(remainder: &ResidualCurve) -> Section {
    let beside = if remainder.beside.is_empty() {
        String::new()
    } else {
        format!(", beside {}", remainder.beside.join(" and "))
    };
    let (x, y): (Vec<f64>, Vec<f64>) = remainder.knots.iter().copied().unzip();
    let text = format!(
        "{}{beside}. With it {:.0} % of the stated model's excess over the noise is gone on the hold-out runs. It is a \
         description, not a cause: its shape says what to look for, and it holds only within what the runs reach.",
        remainder.equation,
        100.0 * remainder.share
    );
    let plot = Plot {
        title: "What the library leaves".into(),
        x: Axis { label: format!("coordinate [{}]", remainder.place_unit), ..Axis::default() },
        y: Axis { label: format!("height [{}]", remainder.height_unit), ..Axis::default() },
        series: vec![Series { name: remainder.equation.clone(), x, y, style: Style::Line }],
        ..Plot::default()
    };
    Section { heading: "What is left, as a curve".into(), items: vec![Item::Text(text), Item::Plot(plot)] }
}

fn candidates(diagnosis: &Diagnosis) -> Section {
    let rows = diagnosis.candidates.iter().take(14).map(|c| {
        let ids = if c.ids.is_empty() { "stated model".into() } else { c.ids.join(" + ") };
        vec![ids, format!("{:.3}", c.probability), c.holdout_chi2.map_or(String::new(), digits::three)]
    });
    let table = Table {
        columns: ["model", "probability [1]", "chi2 held out [1]"].map(String::from).into(),
        rows: rows.collect(),
        caption: "What else was weighed".into(),
    };
    Section { heading: "Alternatives".into(), items: vec![Item::Table(table)] }
}

/// Held-out traces over each other, and what each model leaves.
pub(in super::super) fn predicted(examined: &Examined) -> Section {
    let mut items = Vec::new();
    for (i, run) in examined.judging_runs().iter().enumerate() {
        for (j, measured) in run.measured.iter().enumerate() {
            let of = |judged: &crate::diagnose::judged::ScoredModel| judged.hold.predicted[i].channels[j].clone();
            let (before, after) = (of(&examined.conclusion.stated), of(&examined.conclusion.accepted));
            if before.iter().all(|v| v.is_nan()) {
                continue;
            }
            let mut spectra = vec![("stated model leaves", before.as_slice(), Style::Dashed)];
            if examined.changed() && measured.judged {
                spectra.push(("model with what was found leaves", after.as_slice(), Style::Line));
            }
            let spectra = over_frequency(run, measured, &spectra);
            let mut residuals = vec![("stated model leaves", left(measured, &before), Style::Faint)];
            let mut curves =
                vec![("measured", measured.values.clone(), Style::Line), ("stated model", before, Style::Dashed)];
            if examined.changed() {
                residuals.push(("model with what was found leaves", left(measured, &after), Style::Line));
                curves.push(("model with what was found", after, Style::Line));
            }
            items.push(over_time(run, measured, "", curves));
            items.push(over_time(run, measured, ", measured less model", residuals));
            items.extend(measured.judged.then_some(spectra));
        }
    }
    Section { heading: "Prediction of the hold-out runs".into(), items }
}
