//! The report's text, to the letter, less the library and the data blocks' bulk.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown::blocks::report::{Axis, Band, Item, Matrix, Page, Plot, Section, Series, Style, Table};
use std::path::Path;

fn strings<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

fn small_page() -> Page {
    let series = |name: &str, style, y: &[f64]| Series {
        name: name.into(),
        x: (0..y.len()).map(|i| i as f64 * 0.005).collect(),
        y: y.to_vec(),
        style,
    };
    let plot = Plot {
        title: "Velocity".into(),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: "velocity [m/s]".into(), log: false },
        series: vec![
            series("reference", Style::Dashed, &[0.0, 0.1, 0.2, 0.3]),
            series("table", Style::Line, &[0.0, 0.098_765_432_1, f64::NAN, 0.242]),
        ],
        bands: vec![Band { from: 0.01, to: 0.015, label: "at its limit".into() }],
        group: Some("time".into()),
        open: Some((0.0, 0.01)),
    };
    let table = Table {
        columns: strings(["controller", "E_a [1]", "peak [m/s2]"]),
        rows: vec![strings(["current", "0.304", "4.96"]), strings(["<strong>", "–", "8.8"])],
        caption: "Two controllers".into(),
    };
    let matrix = Matrix {
        caption: "Answers".into(),
        rows_are: "truth".into(),
        columns_are: "answer".into(),
        columns: strings(["a", "b"]),
        rows: vec![("a".into(), vec![3.0, 1.0]), ("b".into(), vec![0.0, f64::NAN])],
        ..Matrix::default()
    };
    let items = vec![
        Item::Text("One.\n\nTwo, with `code`.".into()),
        Item::Tiles(vec![("peak [m/s2]".into(), "4.96 m/s2".into())]),
        Item::Note("A caveat.".into()),
        Item::Table(table),
        Item::Plot(plot),
        Item::Matrix(matrix),
    ];
    Page {
        title: "A & B".into(),
        lead: "What came out.".into(),
        key: vec![("E_a [1]".into(), "0.304".into())],
        advice: vec!["Fit the record: `modify`.".into()],
        sections: vec![Section { heading: "Only".into(), items }],
        details: vec![Section { heading: "More".into(), items: vec![Item::Text("Folded.".into())] }],
        provenance: vec![("version".into(), "0.1.0".into())],
    }
}

/// The page without its style and scripts, whose text is their own.
fn without_assets(html: &str) -> String {
    let mut page = html.to_owned();
    for (open, close) in [("<style>\n", "</style>"), ("<script>\n", "</script>")] {
        while let Some((before, rest)) = page.split_once(open) {
            let after = rest.split_once(close).map_or("", |(_, after)| after);
            page = format!("{before}{}...{close}{after}", open.trim_end());
        }
    }
    page
}

#[test]
fn a_small_page_is_written_to_the_letter() {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/report.html");
    let written = without_assets(&small_page().html());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&golden, &written).expect("the golden file can be written");
    }
    let expected = std::fs::read_to_string(&golden).expect("tests/golden/report.html");
    assert!(written == expected, "UPDATE_GOLDEN=1 renews {}; now:\n{written}", golden.display());
}

#[test]
fn the_page_names_nothing_it_would_fetch() {
    let html = shakedown_tests::sample::page().html();
    for fetched in ["src=\"", "@import", "url(", "<link rel=\"stylesheet", "fetch(", "XMLHttpRequest", "import("] {
        assert!(!html.contains(fetched), "the page holds {fetched}");
    }
    assert!(html.contains("default-src 'none'"));
}

#[test]
fn a_long_test_stays_a_small_file() {
    let x: Vec<f64> = (0..600_000).map(|i| f64::from(i) * 1e-3).collect();
    let series = |name: &str, w: f64| Series {
        name: name.into(),
        x: x.clone(),
        y: x.iter().map(|t| (w * t).sin() * 0.123_456_789).collect(),
        style: Style::Line,
    };
    let plot = Plot { series: vec![series("a", 3.0), series("b", 50.0), series("c", 7.1)], ..Plot::default() };
    let section = Section { items: vec![Item::Plot(plot)], ..Section::default() };
    let bytes = Page { sections: vec![section], ..Page::default() }.html().len();
    assert!(bytes < 500_000, "ten minutes at 1 kHz, three curves: {bytes} bytes");
}
