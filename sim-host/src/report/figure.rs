//! A plot as the data block its script reads, and as words for those who cannot see it.

use super::curve::{Abscissa, Curve, Logs};
use super::escape;
use super::{Plot, Style};
use serde::Serialize;
use std::fmt::Write as _;

#[derive(Serialize)]
struct Figure<'a> {
    x: Axis,
    y: Axis,
    #[serde(skip_serializing_if = "Option::is_none")]
    group: Option<&'a str>,
    abscissae: Vec<Abscissa>,
    series: Vec<Series<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    open: Option<(f64, f64)>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bands: Vec<Band<'a>>,
}

#[derive(Serialize)]
struct Axis {
    name: String,
    unit: String,
    log: bool,
}

#[derive(Serialize)]
struct Series<'a> {
    name: &'a str,
    style: &'static str,
    /// Which of the abscissae.
    x: usize,
    y: Vec<Option<f64>>,
}

#[derive(Serialize)]
struct Band<'a> {
    from: f64,
    to: f64,
    label: &'a str,
}

/// A plot made ready for the page.
pub(crate) struct Drawing {
    /// The data block, safe inside a `<script>` element.
    pub(crate) data: String,
    /// What it shows, in words, not yet escaped.
    pub(crate) words: String,
    /// The most samples one of its curves was thinned from.
    pub(crate) thinned_from: Option<usize>,
}

/// Writes a plot as data and as words.
pub(crate) fn draw(plot: &Plot) -> Drawing {
    let logs = Logs { x: plot.x.log, y: plot.y.log };
    let curves: Vec<Curve> = plot.series.iter().map(|s| Curve::new(&s.x, &s.y, logs)).collect();
    let words = describe(plot, &curves);
    let thinned_from = curves.iter().filter_map(|c| c.thinned_from).max();
    let mut abscissae: Vec<Abscissa> = Vec::new();
    let series = std::iter::zip(&plot.series, curves).map(|(series, curve)| {
        let known = abscissae.iter().position(|x| *x == curve.x);
        let x = known.unwrap_or_else(|| {
            abscissae.push(curve.x);
            abscissae.len() - 1
        });
        Series { name: &series.name, style: name_of(series.style), x, y: curve.y }
    });
    let figure = Figure {
        series: series.collect(),
        x: axis(&plot.x),
        y: axis(&plot.y),
        group: plot.group.as_deref(),
        open: plot.open.filter(|(from, to)| from.is_finite() && to.is_finite() && from < to),
        abscissae,
        bands: bands(plot),
    };
    // A struct of strings and numbers cannot fail to serialise; an empty block would show as an empty figure.
    let data = serde_json::to_string(&figure).unwrap_or_default();
    Drawing { data: escape::json(&data), words, thinned_from }
}

fn bands(plot: &Plot) -> Vec<Band<'_>> {
    let finite = plot.bands.iter().filter(|b| b.from.is_finite() && b.to.is_finite());
    finite.map(|b| Band { from: b.from, to: b.to, label: &b.label }).collect()
}

fn name_of(style: Style) -> &'static str {
    match style {
        Style::Line => "line",
        Style::Dashed => "dashed",
        Style::Points => "points",
        Style::Faint => "faint",
    }
}

/// Splits `time [s]` into its name and its unit.
fn axis(axis: &super::Axis) -> Axis {
    let label = escape::units(&axis.label);
    let (name, unit) = match label.rsplit_once('[') {
        Some((name, rest)) => (name.trim(), rest.trim_end().trim_end_matches(']')),
        None => (label.trim(), ""),
    };
    Axis { name: name.into(), unit: if unit == "1" { String::new() } else { unit.into() }, log: axis.log }
}

/// What a figure shows, in one sentence for each curve.
fn describe(plot: &Plot, curves: &[Curve]) -> String {
    let mut words = format!("Chart: {}; {} over {}.", plot.title, plot.y.label, plot.x.label);
    for (series, curve) in plot.series.iter().zip(curves) {
        let _ = match curve.range() {
            Some((low, high)) => write!(words, " {}: {low} to {high}.", series.name),
            None => write!(words, " {}: no data.", series.name),
        };
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_share_an_abscissa_that_is_the_same() {
        let x = vec![0.0, 0.1, 0.2, 0.3];
        let series = |name: &str, y: f64| super::super::Series {
            name: name.into(),
            x: x.clone(),
            y: vec![y; 4],
            style: Style::Line,
        };
        let plot = Plot { series: vec![series("a", 1.0), series("b", 2.0)], ..Plot::default() };
        let figure: serde_json::Value = serde_json::from_str(&draw(&plot).data).unwrap();
        assert_eq!(figure["abscissae"].as_array().unwrap().len(), 1);
        assert_eq!(figure["abscissae"][0]["step"], 0.1);
        assert_eq!(figure["series"][1]["x"], 0);
    }

    #[test]
    fn an_axis_knows_its_unit() {
        let of = |label: &str| {
            let a = axis(&super::super::Axis { label: label.into(), log: false });
            (a.name, a.unit)
        };
        assert_eq!(of("acceleration [m/s2]"), ("acceleration".into(), "m/s²".into()));
        assert_eq!(of("ratio [1]"), ("ratio".into(), String::new()));
        assert_eq!(of("count"), ("count".into(), String::new()));
    }

    #[test]
    fn words_name_every_curve_and_its_range() {
        let series =
            super::super::Series { name: "table".into(), x: vec![0.0, 1.0], y: vec![-1.0, 2.5], style: Style::Line };
        let plot = Plot { title: "Response".into(), series: vec![series], ..Plot::default() };
        assert!(draw(&plot).words.contains("table: -1 to 2.5"), "{}", draw(&plot).words);
    }
}
