//! The rows of fitted records as a table and as JSON.

use crate::closed_loop::table1::Case;
use crate::closed_loop::table1::fitted::{FittedRow, SPIKE};
use crate::plant::sensors::GRAVITY;
use crate::report::Table;
use serde_json::{Value, json};

fn name(row: &FittedRow) -> String {
    match row.fit {
        None => "as it is".into(),
        // The string is the best for the speed alone, wherever that takes the table.
        Some("taut") => "taut (any stroke)".into(),
        Some(fit) => fit.into(),
    }
}

/// The rows of one record.
pub(super) fn table(case: &Case, rows: &[FittedRow]) -> Table {
    let cells = |row: &FittedRow| {
        let score = &row.whole.against_wanted;
        vec![
            name(row),
            format!("{:.3}", score.e_a.squared()),
            format!("{:.3}", score.e_a.ratio),
            format!("{:.3}", score.e_d.ratio),
            format!("{:.3}", score.response_peak / GRAVITY),
            format!("{:.3}", row.spike),
            format!("{:.2}", row.whole.saturated_s),
            format!("{:.3}", row.reached.0),
            format!("{:.1}", 1e3 * row.reached.1),
            row.holds().map_or("", |holds| if holds { "holds" } else { "does not hold" }).into(),
        ]
    };
    let columns = [
        "record fitted by",
        "E_a squared [1]",
        "E_a [1]",
        "E_d [1]",
        "peak [g]",
        "spike [1]",
        "at the limit [s]",
        "farthest [m]",
        "end [mm]",
        "",
    ];
    Table {
        caption: format!(
            "Strong on the record fitted to 0.242 m/s and 0.12 m beforehand, against the record before it was fitted. \
             Spike is the table's peak acceleration over the reference's, unfiltered: at most {SPIKE} where the fit keeps \
             the limits"
        ),
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().filter(|row| row.event == case.event).map(cells).collect(),
    }
}

/// One row.
pub(super) fn json(row: &FittedRow) -> Value {
    let score = &row.whole.against_wanted;
    json!({
        "record": row.event.name(), "controller": "Strong", "fit": row.fit, "e_a": score.e_a.ratio,
        "e_a_squared": score.e_a.squared(), "e_d": score.e_d.ratio, "peak_g": score.response_peak / GRAVITY,
        "spike": row.spike, "saturated_s": row.whole.saturated_s, "farthest_m": row.reached.0, "end_m": row.reached.1,
        "holds": row.holds(),
    })
}
