//! How far the forms of the truth are from the library's own equations: what the library's best fit leaves of each without
//! noise, the true effect given.

use super::super::campaign::Plan;
use super::super::record::Record;
use super::outcome::left;
use super::strata::quantile;
use crate::report::Table;
use serde::Serialize;
use std::collections::BTreeMap;

/// One form.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Form {
    /// Effect.
    pub effect: String,
    /// Its form.
    pub form: String,
    /// Cases.
    pub cases: usize,
    /// Median share of the excess that is left (1).
    pub left: f64,
}

/// All forms.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Independence {
    /// The campaign.
    pub plan: Plan,
    /// Forms.
    pub forms: Vec<Form>,
    /// Median over the forms; none where none was fitted.
    pub median: Option<f64>,
    /// Cases whose fit failed.
    pub failed: usize,
}

/// Sums up the single effects among the records.
pub fn independence(plan: &Plan, records: &[Record]) -> Independence {
    let mut groups: BTreeMap<(String, String), Vec<f64>> = BTreeMap::new();
    let mut failed = 0;
    for record in records.iter().filter(|r| r.truth.effects.len() == 1 && r.truth.unlisted.is_none()) {
        let flaw = &record.truth.effects[0];
        match left(record) {
            Some(share) => groups.entry((flaw.id.clone(), flaw.form.clone())).or_default().push(share),
            None => failed += 1,
        }
    }
    let of = |((effect, form), shares): ((String, String), Vec<f64>)| Form {
        effect,
        form,
        cases: shares.len(),
        left: quantile(shares, 0.5).unwrap_or(f64::NAN),
    };
    let forms: Vec<Form> = groups.into_iter().map(of).collect();
    let median = quantile(forms.iter().map(|form| form.left).collect(), 0.5);
    Independence { plan: plan.clone(), forms, median, failed }
}

/// As a table.
pub fn table(independence: &Independence) -> Table {
    let row = |f: &Form| vec![f.effect.clone(), f.form.clone(), f.cases.to_string(), format!("{:.1}", 100.0 * f.left)];
    let median = independence.median.map_or("\u{2013}".into(), |m| format!("{:.1} %", 100.0 * m));
    Table {
        columns: ["Effect", "Form of the truth", "Cases", "Left [%]"].map(String::from).to_vec(),
        rows: independence.forms.iter().map(row).collect(),
        caption: format!("Median over the forms: {median}. {} fits failed.", independence.failed),
    }
}
