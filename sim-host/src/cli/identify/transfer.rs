//! The transfer function from command to motion on the page of an identification.

use super::super::traces::table;
use crate::digits;
use crate::identify::frequency::transfer::{Order, Trial};
use crate::identify::frequency::{Point, Response};
use crate::identify::transfer::Transfer;
use crate::report::{Axis, Item, Plot, Section, Series, Style};

/// Orders that are listed.
const LISTED: usize = 8;

/// The section: what was chosen, among what, and how it runs through the measured points.
pub(super) fn section(transfer: &Transfer) -> Section {
    let output = transfer.output.name();
    let judged = if transfer.by_runs { "the hold-out runs" } else { "the second halves of the runs" };
    let mut items = Vec::new();
    if let Some(chosen) = transfer.trials.first() {
        items.push(Item::Text(format!(
            "From the command to the {output}, straight from the records and without the model above: G(s) = {}. The order \
             is the lowest whose error on {judged} lies within one standard error of the best. A delay or a lag that is \
             here and not in the model is missing physics.",
            chosen.fit.function
        )));
    }
    let rows = transfer.trials.iter().take(LISTED).map(row).collect();
    let columns = ["numerator degree", "poles", "delay [ms]", "chi2, fitted [1]", "chi2, held out [1]"];
    items.push(Item::Table(table(&columns, rows, "Orders tried, the chosen one first")));
    items.push(plot(transfer, "gain", "dB", &|r| r.points.iter().map(Point::decibels).collect()));
    items.push(plot(transfer, "phase", "deg", &Response::unwrapped_degrees));
    Section { heading: "A transfer function straight from the records".into(), items }
}

fn row(trial: &Trial) -> Vec<String> {
    let Order { numerator, denominator, integrators, longest_delay } = trial.order;
    let delay = if longest_delay > 0.0 { format!("{:.2}", 1e3 * trial.fit.function.delay) } else { "none".into() };
    let poles =
        if integrators > 0 { format!("{denominator}, and {integrators} at zero") } else { denominator.to_string() };
    vec![numerator.to_string(), poles, delay, digits::three(trial.fit.chi2), digits::three(trial.held_back)]
}

fn plot(transfer: &Transfer, what: &str, unit: &str, of: &dyn Fn(&Response) -> Vec<f64>) -> Item {
    let series = |name: &str, response: &Response, style| Series {
        name: name.into(),
        x: response.points.iter().map(|p| p.frequency).collect(),
        y: of(response),
        style,
    };
    let mut all = vec![
        series("runs fitted", &transfer.response, Style::Line),
        series("held out", &transfer.held_back, Style::Faint),
    ];
    if let Some(chosen) = transfer.trials.first() {
        let value = |p: &Point| Point { value: chosen.fit.function.at(p.frequency), ..*p };
        let fitted = Response { points: transfer.response.points.iter().map(value).collect() };
        all.push(series("transfer function", &fitted, Style::Dashed));
    }
    Item::Plot(Plot {
        title: format!("{what} from command to {}", transfer.output.name()),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: format!("{what} [{unit}]"), log: false },
        series: all,
        group: Some("transfer function".into()),
        ..Plot::default()
    })
}
