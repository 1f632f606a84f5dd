//! The equation found for physics that the library does not hold, as a report shows it.

use crate::diagnose::term::report::{Curve, Term};
use crate::report::{Axis, Item, Plot, Section, Series, Style, Table};

/// What it is and how much it explains, in a sentence or two.
pub(super) fn sentence(term: &Term) -> String {
    format!("An equation was found for it: {} It removes {:.0} % of the misfit.", term.words, 100.0 * term.share)
}

/// Equation, words, parameters with intervals, and how to keep it.
pub(super) fn section(term: &Term, parameters: Table) -> Section {
    let beside = match term.beside.as_slice() {
        [] => String::new(),
        names => format!(" It stands beside {}.", names.join(" and ")),
    };
    let text = format!("{}: {}. {}{beside}", term.place, term.expression, sentence(term));
    let stable = format!(
        "Regressed on random halves of the training data, {:.0} % choose a term at this place. It is a description found by \
         regression over a grammar of terms: another form with the same values over what these runs reach is as good. \
         `--model FILE` saves it as an [[effect]], which is known from then on by the name {}.",
        100.0 * term.stability,
        term.id
    );
    let mut items = vec![Item::Text(text), Item::Table(parameters)];
    items.extend(term.curves.iter().map(|curve| Item::Plot(plot(curve))));
    items.push(Item::Note(stable));
    Section { heading: "What is left, as an equation".into(), items }
}

/// A term along what it follows with its 90 % interval.
fn plot(curve: &Curve) -> Plot {
    let column = |i: usize| curve.points.iter().map(|p| p[i]).collect::<Vec<f64>>();
    let line = |name: &str, i: usize, style| Series { name: name.into(), x: column(0), y: column(i), style };
    let known = curve.points.iter().all(|p| p[2].is_finite() && p[3].is_finite());
    let mut series = vec![line("the term", 1, Style::Line)];
    if known {
        series.extend([line("90 % from", 2, Style::Faint), line("90 % to", 3, Style::Faint)]);
    }
    Plot {
        title: format!("The term along {}, over what the runs reach", curve.state),
        x: Axis { label: format!("{} [{}]", curve.state, curve.unit), ..Axis::default() },
        y: Axis { label: "the term, in the unit of its place".into(), ..Axis::default() },
        series,
        ..Plot::default()
    }
}
