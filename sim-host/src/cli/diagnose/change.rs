//! What the physics that was found changes for who runs the table.

use super::super::traces;
use crate::diagnose::change::{CUSTOMARY, Change, GainMargins};
use crate::report::{Item, Section};

/// The section.
pub(super) fn section(change: &Change) -> Section {
    let mut items = Vec::new();
    if let Some(gains) = &change.gains {
        items.push(if gains.stand { Item::Text(stand(gains)) } else { Item::Note(stand(gains)) });
    }
    if !change.tracking.is_empty() {
        let mm = |m: f64| format!("{:.3}", 1e3 * m);
        let rows = change.tracking.iter().map(|t| vec![t.run.clone(), mm(t.measured), mm(t.stated), mm(t.found)]);
        let columns = ["run", "recorded [mm]", "stated model [mm]", "with what was found [mm]"];
        items.push(Item::Table(traces::table(&columns, rows.collect(), "Reference less displacement, RMS")));
    }
    if let Some(reach) = &change.reach {
        let row = |side: &str, i: usize| {
            vec![format!("{side}{:.4}", reach.command), speed(reach.stated[i]), speed(reach.found[i])]
        };
        let columns = ["command held [unit of u]", "stated model [m/s]", "with what was found [m/s]"];
        let caption = "Greatest speed within the travel seen, at the largest command these runs need";
        items.push(Item::Table(traces::table(&columns, vec![row("+", 0), row("-", 1)], caption)));
    }
    Section { heading: "What it changes".into(), items }
}

fn speed(speed: f64) -> String {
    format!("{speed:.4}")
}

/// The gain margin, in a sentence or two.
pub(super) fn stand(gains: &GainMargins) -> String {
    let stated = gains.stated.map_or("at every one".into(), |factor| format!("up to {factor:.2}"));
    let known = format!("by the stated model it settles {stated}");
    if gains.stated.is_none() && gains.found.is_none() {
        return "Gain margin above 10 (factor), with what was found and without it.".into();
    }
    match gains.found {
        None => format!("Gain margin above 10 (factor); {known}."),
        Some(factor) if gains.stand => {
            format!("Gain margin {factor:.2} (factor): the loop settles after a step up to there; {known}.")
        }
        Some(factor) if factor >= 1.0 => format!(
            "The gains are high: the loop settles after a step only up to {factor:.2} times what they are; {known}. \
             {:.2} times them would leave the customary factor of {CUSTOMARY}.",
            factor / CUSTOMARY
        ),
        Some(factor) => format!(
            "Gain margin {factor:.2} (factor), below 1: after a small step the loop does not come to rest at the present gains; \
             {known}."
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_is_said_in_words() {
        let said = |stated, found: Option<f64>| {
            stand(&GainMargins { stated, found, stand: found.is_none_or(|factor| factor >= CUSTOMARY) })
        };
        assert!(
            said(None, Some(3.1)).starts_with("Gain margin 3.10 (factor): the loop settles after a step up to there")
        );
        assert!(
            said(Some(4.0), Some(1.5)).contains("only up to 1.50") && said(Some(4.0), Some(1.5)).contains("0.75 times")
        );
        assert!(said(Some(4.0), Some(0.6)).starts_with("Gain margin 0.60 (factor), below 1"));
        assert!(said(Some(4.0), None).contains("by the stated model it settles up to 4.00"));
    }
}
