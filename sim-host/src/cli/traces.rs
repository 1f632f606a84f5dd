//! Measured channels beside what models make of them: the same figures for every command that compares the two.

use crate::diagnose::locate::{Location, StateShare};
use crate::digits;
use crate::identify::data::{Measured, Run};
use crate::identify::spectra;
use crate::recording::check::Finding;
use crate::report::{Axis, Item, Plot, Series, Style, Table};

/// One figure over time: a run's channel and curves of it, each with its name and style.
pub(crate) fn over_time(run: &Run, measured: &Measured, more: &str, curves: Vec<(&str, Vec<f64>, Style)>) -> Item {
    let time: Vec<f64> = (0..run.len()).map(|k| run.from + k as f64 * run.dt).collect();
    let channel = words(measured);
    let series = curves.into_iter().map(|(name, y, style)| Series { name: name.into(), x: time.clone(), y, style });
    Item::Plot(Plot {
        title: format!("{}: {channel}{more}", run.name),
        x: Axis { label: "time [s]".into(), ..Axis::default() },
        y: Axis { label: format!("{channel} [{}]", measured.channel.unit()), ..Axis::default() },
        series: series.collect(),
        group: Some(run.name.clone()),
        ..Plot::default()
    })
}

/// One figure over frequency: the power of a run's channel, of what models leave of it, and of the noise.
pub(crate) fn over_frequency(run: &Run, measured: &Measured, models: &[(&str, &[f64], Style)]) -> Item {
    let mut series = Vec::new();
    for (i, &(name, model, style)) in models.iter().enumerate() {
        let rest = spectra::leftover(run, measured, model);
        let of = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: rest.frequency.clone(), y, style };
        if i == 0 {
            series.push(of("measured", rest.measured.clone(), Style::Faint));
            series.push(of("noise floor", vec![rest.floor; rest.frequency.len()], Style::Dashed));
        }
        series.push(of(name, rest.residual.clone(), style));
    }
    Item::Plot(Plot {
        title: format!("{}: spectrum of {} and of what is left", run.name, words(measured)),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: format!("power density [{}/Hz]", squared(measured.channel.unit())), log: true },
        series,
        group: Some(format!("{} frequency", run.name)),
        ..Plot::default()
    })
}

/// A unit's square.
fn squared(unit: &str) -> String {
    if unit.chars().all(char::is_alphabetic) { format!("{unit}2") } else { format!("({unit})2") }
}

/// What a model leaves of a channel.
pub(crate) fn left(measured: &Measured, model: &[f64]) -> Vec<f64> {
    measured.values.iter().zip(model).map(|(y, m)| y - m).collect()
}

/// A channel's name in words.
pub(crate) fn words(measured: &Measured) -> String {
    measured.channel.name().replace('_', " ")
}

/// What the recordings themselves show.
pub(crate) fn findings(findings: &[Finding]) -> Table {
    let rows = findings.iter().map(|f| {
        let [from, to] = [format!("{:.2}", f.from_s), format!("{:.2}", f.to_s)];
        vec![f.run.clone(), f.channel.to_owned(), f.problem.clone(), from, to, f.remedy.clone()]
    });
    table(&["run", "channel", "problem", "from [s]", "to [s]", "remedy"], rows.collect(), "What the recordings show")
}

/// Where a residual lies: in time, in frequency, along a quantity, as far as any of it was seen.
pub(crate) fn location(location: &Location) -> Vec<Table> {
    let share = |part: f64| format!("{:.0}", 100.0 * part);
    let time = location
        .time
        .iter()
        .map(|s| vec![s.run.clone(), format!("{:.2}", s.from_s), format!("{:.2}", s.to_s), share(s.share)]);
    let bands = location
        .frequency
        .iter()
        .map(|b| vec![format!("{:.2}", b.from_hz), format!("{:.2}", b.to_hz), digits::three(b.ratio)]);
    // Where an effect's window is all that is known of a quantity, no share was seen along it.
    let seen = |s: &StateShare| if s.profile.is_empty() { "\u{2013}".into() } else { share(s.strength) };
    let state = location.state.iter().map(|s| vec![s.variable.to_owned(), s.place.clone(), seen(s)]);
    let all = [
        table(
            &["run", "from [s]", "to [s]", "share of excess [%]"],
            time.collect(),
            "When: stretches with most of the excess",
        ),
        table(&["from [Hz]", "to [Hz]", "residual over noise power [1]"], bands.collect(), "At which frequencies"),
        table(
            &["quantity", "where", "share explained [%]"],
            state.collect(),
            "Along which quantity, cross-validated; the window of an effect first",
        ),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// A table.
pub(crate) fn table(columns: &[&str], rows: Vec<Vec<String>>, caption: &str) -> Table {
    Table { columns: columns.iter().map(|&c| c.to_owned()).collect(), rows, caption: caption.into() }
}
