//! The periods at which a fit could not keep the spectrum.

use crate::motion::STANDARD_GRAVITY;
use crate::motion::fit::answer::Answer;
use crate::motion::fit::method::Method;
use crate::report::{Item, Table};

/// Periods whose ordinate could not be kept.
pub(super) fn periods(answer: &Answer) -> Option<Item> {
    let (Some(found), Method::Spectrum(band)) = (&answer.modified.spectrum, answer.method) else { return None };
    let missed: Vec<_> = found.ordinates.iter().filter(|o| o.deviation().abs() > band.tolerance).collect();
    if missed.is_empty() {
        let kept = format!("S_a is kept within {:.1} % at every period of the band.", 100.0 * found.deviation);
        return Some(Item::Text(kept));
    }
    let rows = missed
        .iter()
        .map(|o| {
            vec![
                format!("{:.3}", o.period),
                format!("{:.3}", o.asked / STANDARD_GRAVITY),
                format!("{:.3}", o.got / STANDARD_GRAVITY),
                format!("{:+.1}", 100.0 * o.deviation()),
                format!("{:.3}", o.velocity_factor(band.tolerance)),
            ]
        })
        .collect();
    Some(Item::Table(Table {
        columns: ["period [s]", "asked [g]", "got [g]", "deviation [%]", "velocity limit: times at least"]
            .map(Into::into)
            .into(),
        rows,
        caption: format!(
            "Periods that miss {:.1} %. The smallest tolerance met is {:.1} %{}; the last column is the factor on the \
             velocity limit without which no motion at all reaches that period alone.",
            100.0 * band.tolerance,
            100.0 * found.deviation,
            found.bound.map_or_else(String::new, |bound| format!(
                ", and with the spectrum's peaks where this motion has them none under {:.1} % can be",
                100.0 * bound
            ))
        ),
    }))
}
