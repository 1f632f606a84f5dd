//! The report as a reader sees it: headless Chromium opens the page, zooms, hides a curve, turns the light off.
//! Without Chromium these tests say so and end; `cargo xtask test` installs it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::Value;
use shakedown::blocks::report::Page;
use shakedown_tests::browser::{Browser, chromium};
use shakedown_tests::sample::page;

/// Distinct colours on each canvas: a figure that drew nothing has one.
const COLOURS: &str = "[...document.querySelectorAll('figure canvas')].map(canvas => {
    const { width, height } = canvas;
    const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, width, height).data.buffer);
    return new Set(pixels).size;
})";
/// Pixels of one curve's colour on the first canvas, exactly that colour.
const CURVE_PIXELS: &str = "(() => {
    const canvas = document.querySelector('figure canvas');
    const probe = document.createElement('canvas').getContext('2d');
    probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--curve-0');
    probe.fillRect(0, 0, 1, 1);
    const [wanted] = new Uint32Array(probe.getImageData(0, 0, 1, 1).data.buffer);
    const { width, height } = canvas;
    const pixels = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, width, height).data.buffer);
    return pixels.reduce((sum, pixel) => sum + (pixel === wanted), 0);
})()";
/// Middle of the first figure's plotting area, and its width, in page pixels.
const PLACE: &str = "(() => {
    const figure = document.querySelector('figure');
    figure.scrollIntoView({ block: 'center', behavior: 'instant' });
    const { left, top, width, height } = figure.querySelector('.u-over').getBoundingClientRect();
    return [left + width / 2, top + height / 2, width];
})()";
/// How many figures of the page are zoomed.
const ZOOMED: &str = "document.querySelectorAll('figure.zoomed').length";

/// Opens `page` in a browser, or says why not.
fn open(page: &Page) -> Option<(Browser, String, tempfile::TempDir)> {
    let program = chromium()?;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("report.html");
    page.write(&path).expect("the page is written");
    let mut browser = Browser::start(program, 1200, 900).expect("Chromium starts");
    browser.open(&path).expect("the page opens");
    Some((browser, format!("file://{}", path.display()), folder))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn every_figure_is_drawn_and_nothing_leaves_the_page() {
    let Some((mut browser, address, _folder)) = open(&page()) else { return };
    let colours = browser.value(COLOURS).expect("canvases");
    let colours: Vec<f64> = colours.as_array().expect("a list").iter().map(number).collect();
    assert_eq!(colours.len(), 6, "one canvas a figure with data");
    assert!(colours.iter().all(|&n| n > 5.0), "colours on each canvas: {colours:?}");
    let text = browser.value("document.body.innerText").expect("text").to_string();
    assert!(text.contains("No data to draw"), "a figure without data says so");
    assert_eq!(browser.requests(), [address], "requests");
    assert_eq!(browser.complaints(), [""; 0], "console");
    let images = browser.value("document.querySelectorAll('img').length").expect("images");
    assert_eq!(images, 0, "a name became markup");
}

#[test]
fn a_broken_page_would_be_noticed() {
    let Some(program) = chromium() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("report.html");
    let html = page().html().replace("default-src 'none'; ", "").replace("const figures = (", "const figured = (");
    let html = html.replace("</main>", "<img src=\"picture.png\"></main>");
    std::fs::write(&path, html).expect("the page is written");
    let mut browser = Browser::start(program, 1200, 900).expect("Chromium starts");
    browser.open(&path).expect("the page opens");
    assert!(browser.complaints().iter().any(|c| c.contains("figures is not defined")), "{:?}", browser.complaints());
    assert!(browser.requests().iter().any(|r| r.ends_with("picture.png")), "{:?}", browser.requests());
    assert_eq!(browser.value(COLOURS).expect("canvases"), serde_json::json!([]));
}

#[test]
fn a_group_zooms_together_and_comes_back() {
    let Some((mut browser, ..)) = open(&page()) else { return };
    let place = browser.value(PLACE).expect("a place");
    let [x, y, width] = [0, 1, 2].map(|i| number(&place[i]));
    browser.mouse("mouseMoved", x, y, 0).expect("moved");
    browser.settle().expect("settled");
    let readout = browser.value("document.querySelector('figure .place').textContent").expect("a readout");
    assert!(readout.as_str().is_some_and(|r| r.starts_with("time ") && r.ends_with(" s")), "{readout}");
    let value = browser.value("document.querySelector('figure .legend .value').textContent").expect("a value");
    assert!(value.as_str().is_some_and(|v| v.ends_with(" m/s")), "{value}");
    for (kind, at) in [("mousePressed", x), ("mouseMoved", x + width / 8.0), ("mouseReleased", x + width / 8.0)] {
        browser.mouse(kind, at, y, 1).expect(kind);
    }
    browser.settle().expect("settled");
    assert_eq!(browser.value(ZOOMED).expect("figures"), 2, "both time histories zoom, nothing else");
    for clicks in [1, 2] {
        browser.mouse("mousePressed", x, y, clicks).expect("pressed");
        browser.mouse("mouseReleased", x, y, clicks).expect("released");
    }
    browser.settle().expect("settled");
    assert_eq!(browser.value(ZOOMED).expect("figures"), 0, "a double click shows all again");
    assert_eq!(browser.complaints(), [""; 0], "console");
}

#[test]
fn a_legend_hides_its_curve_and_the_dark_page_is_dark() {
    let Some((mut browser, ..)) = open(&page()) else { return };
    let drawn = number(&browser.value(CURVE_PIXELS).expect("pixels"));
    assert!(drawn > 100.0, "{drawn} pixels of the first curve");
    browser
        .value("[...document.querySelectorAll('figure .legend button')].find(b => b.innerText == 'table').click()")
        .expect("a click");
    browser.settle().expect("settled");
    assert_eq!(browser.value(CURVE_PIXELS).expect("pixels"), 0, "the curve is gone");
    browser.scheme("dark").expect("a dark page");
    let paper = browser.value("getComputedStyle(document.body).backgroundColor").expect("a colour");
    assert_eq!(paper, "rgb(20, 23, 27)");
    browser
        .value("[...document.querySelectorAll('figure .legend button')].find(b => b.innerText == 'table').click()")
        .expect("a click");
    browser.settle().expect("settled");
    assert!(number(&browser.value(CURVE_PIXELS).expect("pixels")) > 100.0, "drawn in the dark page's colour");
}

#[test]
fn a_table_sorts_by_number() {
    let Some((mut browser, ..)) = open(&page()) else { return };
    let first = "document.querySelector('tbody tr').cells[0].textContent";
    let click = "[...document.querySelectorAll('th button')].find(b => b.innerText.startsWith('peak')).click()";
    assert_eq!(browser.value(first).expect("a cell"), "current");
    browser.value(click).expect("a click");
    assert_eq!(browser.value(first).expect("a cell"), "strong", "largest first");
    browser.value(click).expect("a click");
    assert_eq!(browser.value(first).expect("a cell"), "current", "smallest first");
}

#[test]
fn a_narrow_page_needs_no_sideways_scrolling() {
    let Some((mut browser, ..)) = open(&page()) else { return };
    for width in [360, 700] {
        browser.resize(width, 800).expect("resized");
        let wide = browser.value("document.documentElement.scrollWidth").expect("a width");
        assert!(number(&wide) <= f64::from(width), "{wide} pixels wide in a window of {width}");
    }
}
