//! A page with one of everything a report can hold, made from plain formulas.

use shakedown::blocks::report::{Axis, Band, Item, Matrix, Page, Plot, Section, Series, Style, Table};
use std::f64::consts::TAU;

/// A string that breaks out of anything that does not escape it.
pub const NASTY: &str = "</script><!-- <img src=x onerror=alert(1)> & \"quoted\" 'too' \u{2028} 5 ` wide";

/// Every kind of item, every style, gaps, bands, logarithmic axes, a loop, curves on different abscissae.
pub fn page() -> Page {
    Page {
        title: "A near-field pulse on the table".into(),
        lead: "The table reached its velocity limit in two stretches. With the record fitted first, the error fell \
               from 0.64 to 0.40; what is left is the limit itself."
            .into(),
        sections: vec![overview(), histories(), spectra(), clouds(), names()],
        provenance: vec![
            ("version".into(), "0.1.0".into()),
            ("seed".into(), "7".into()),
            ("records/pulse.AT2".into(), "3f2a".repeat(16)),
        ],
        ..Page::default()
    }
}

fn strings<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(String::from).to_vec()
}

fn pair(label: &str, value: &str) -> (String, String) {
    (label.into(), value.into())
}

fn axis(label: &str, log: bool) -> Axis {
    Axis { label: label.into(), log }
}

fn curve(name: &str, style: Style, x: Vec<f64>, f: impl Fn(f64) -> f64) -> Series {
    let y = x.iter().map(|&x| f(x)).collect();
    Series { name: name.into(), x, y, style }
}

fn times(rate: f64, seconds: f64) -> Vec<f64> {
    (0..(rate * seconds) as usize).map(|i| i as f64 / rate).collect()
}

fn frequencies() -> Vec<f64> {
    (0..200).map(|i| 0.1 * 10_f64.powf(f64::from(i) / 80.0)).collect()
}

/// Reference velocity, m/s.
fn wanted(t: f64) -> f64 {
    let pulse = 0.42 * (-((t - 8.0) / 1.6).powi(2)).exp() * (TAU * 0.8 * (t - 8.0)).sin();
    pulse + 0.05 * (-(t - 12.0).abs() / 6.0).exp() * (TAU * 2.7 * t).sin()
}

fn overview() -> Section {
    let tiles = vec![
        pair("acceleration error E_a, unsquared", "0.401"),
        pair("peak acceleration", "0.506 g"),
        pair("saturated", "1.32 s"),
        pair("delay", "21 ms"),
        pair("verdict", "consistent"),
    ];
    let table = Table {
        caption: "Table 1, Kobe, beside the paper's figures".into(),
        columns: strings(["controller", "E_a [1]", "paper [1]", "E_d [1]", "peak [m/s2]", "remark"]),
        rows: vec![
            strings(["current", "0.298", "0.304", "0.291", "4.96", "the gains in use"]),
            strings(["strong", "0.274", "0.281", "0.169", "8.83", "spikes at the limiter's corner"]),
            strings(["velo-disp-acc", "0.312", "–", "0.184", "6.21", "the paper gives no row"]),
            strings(["modified", "0.401", "0.397", "0.052", "5.12", "record fitted first"]),
        ],
    };
    let words = "Run `shakedown table1 --json -` for the same figures as JSON.\n\nE_a is taken from the true motion with \
                 sensors off, over the whole record.";
    Section {
        heading: "At a glance".into(),
        items: vec![
            Item::Tiles(tiles),
            Item::Text(words.into()),
            Item::Table(table),
            Item::Note("Sensor noise alone costs 0.071 of E_a: compare only figures taken the same way.".into()),
        ],
    }
}

fn histories() -> Section {
    let limit = 0.242;
    let bands = [(6.9, 7.35), (7.6, 8.05), (8.9, 9.1)];
    let bands = bands.map(|(from, to)| Band { from, to, label: "velocity at its limit".into() }).to_vec();
    let velocity = Plot {
        title: "Velocity".into(),
        x: axis("time [s]", false),
        y: axis("velocity [m/s]", false),
        series: vec![
            curve("reference", Style::Dashed, times(1000.0, 20.0), wanted),
            curve("table", Style::Line, times(1000.0, 20.0), |t| wanted(t - 0.02).clamp(-limit, limit)),
        ],
        bands: bands.clone(),
        group: Some("time".into()),
        ..Plot::default()
    };
    let noise = |t: f64| 0.4 * (TAU * 50.0 * t).sin() * (1.0 + (137.0 * t).sin());
    let gap = |t: f64| if (13.0..13.6).contains(&t) { f64::NAN } else { 0.0 };
    let slope = |t: f64| (wanted(t + 5e-4) - wanted(t - 5e-4)) / 1e-3;
    let acceleration = Plot {
        title: "Acceleration".into(),
        x: axis("time [s]", false),
        y: axis("acceleration [m/s2]", false),
        series: vec![
            curve("accelerometer", Style::Faint, times(1000.0, 20.0), move |t| slope(t) + noise(t) + gap(t)),
            curve("model", Style::Line, times(200.0, 20.0), slope),
        ],
        bands,
        group: Some("time".into()),
        ..Plot::default()
    };
    Section { heading: "Time histories".into(), items: vec![Item::Plot(velocity), Item::Plot(acceleration)] }
}

fn spectra() -> Section {
    let gain = |f: f64, limit: f64| 1.0 / (1.0 + (f / limit).powi(2)).sqrt();
    let limits = [("2 mm", 9.0), ("5 mm", 5.0), ("10 mm", 2.6), ("20 mm", 1.3)];
    let magnitude = Plot {
        title: "Frequency response at four amplitudes".into(),
        x: axis("frequency [Hz]", true),
        y: axis("magnitude [1]", true),
        series: limits.map(|(name, limit)| curve(name, Style::Line, frequencies(), move |f| gain(f, limit))).to_vec(),
        group: Some("frequency".into()),
        ..Plot::default()
    };
    let phase = Plot {
        title: "Phase".into(),
        x: axis("frequency [Hz]", true),
        y: axis("phase [deg]", false),
        series: limits
            .map(|(name, limit)| curve(name, Style::Line, frequencies(), move |f| -(f / limit).atan().to_degrees()))
            .to_vec(),
        group: Some("frequency".into()),
        ..Plot::default()
    };
    Section { heading: "Frequency response".into(), items: vec![Item::Plot(magnitude), Item::Plot(phase)] }
}

fn clouds() -> Section {
    let at = |i: u32| TAU * f64::from(i) / 400.0;
    let cloud = (0..1200).map(at).map(|a| (a.sin() * (1.0 + 0.1 * (31.0 * a).cos()), a.cos().signum() * 0.2));
    let (x, y): (Vec<f64>, Vec<f64>) = cloud.map(|(v, f)| (0.24 * v, f + 0.05 * (57.0 * v).sin() + 0.1 * v)).unzip();
    let residual = Series { name: "residual".into(), x, y, style: Style::Points };
    let (x, y) = (0..=400).map(at).map(|a| (0.24 * a.sin(), 0.2 * (8.0 * a.cos()).tanh())).unzip();
    let model = Series { name: "Coulomb friction".into(), x, y, style: Style::Line };
    let plot = Plot {
        title: "What the model leaves over, over velocity".into(),
        x: axis("velocity [m/s]", false),
        y: axis("force per table mass [m/s2]", false),
        series: vec![residual, model],
        ..Plot::default()
    };
    let matrix = Matrix {
        caption: "Truth and answer over 60 cases".into(),
        rows_are: "truth".into(),
        columns_are: "answer".into(),
        columns: strings(["consistent", "coulomb_friction", "valve_deadband", "unlisted"]),
        rows: vec![
            ("consistent".into(), vec![20.0, 0.0, 0.0, 0.0]),
            ("coulomb_friction".into(), vec![1.0, 17.0, 2.0, 0.0]),
            ("valve_deadband".into(), vec![0.0, 3.0, 15.0, f64::NAN]),
        ],
        ..Matrix::default()
    };
    Section { heading: "Where it comes from".into(), items: vec![Item::Plot(plot), Item::Matrix(matrix)] }
}

/// Strings from files and users, hostile ones included, and a figure without data.
fn names() -> Section {
    let plot = Plot {
        title: NASTY.into(),
        x: axis(NASTY, false),
        y: axis("\u{0}[m/s2", false),
        series: vec![curve(NASTY, Style::Line, times(10.0, 3.0), f64::sin)],
        bands: vec![Band { from: 1.0, to: 2.0, label: NASTY.into() }],
        group: Some(NASTY.into()),
        ..Plot::default()
    };
    let empty = Plot { title: "Nothing measured".into(), series: vec![Series::default()], ..Plot::default() };
    let table = Table { columns: strings([NASTY]), rows: vec![strings([NASTY])], caption: NASTY.into() };
    let items = vec![Item::Text(NASTY.into()), Item::Table(table), Item::Plot(plot), Item::Plot(empty)];
    Section { heading: "Names as they come".into(), items }
}
