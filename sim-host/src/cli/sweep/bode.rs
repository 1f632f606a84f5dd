//! Bode diagrams at several amplitudes (Figs. 4, 5, 10).

use super::super::present::Part;
use super::super::{Failure, progress};
use crate::closed_loop::bode::{Curve, Grid, displacement_loop, settles};
use crate::closed_loop::frequency::linear;
use crate::digits;
use crate::plant::paper::Paper;
use crate::report::{Axis, Item, Plot, Section, Series, Style, Table};
use serde_json::json;

/// Control rate of the sweep, Hz.
pub(super) const RATE: f64 = 1000.0;

/// Amplitudes, frequencies and gains.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Amplitudes of the reference, mm.
    #[arg(long, value_name = "MM,...", value_delimiter = ',', default_values_t = [1.0, 5.0, 10.0, 20.0, 50.0, 75.0, 100.0, 120.0])]
    pub(super) amplitudes: Vec<f64>,
    /// Lowest frequency and step between frequencies, Hz.
    #[arg(long, value_name = "HZ", default_value_t = 0.1)]
    pub(super) step: f64,
    /// Highest frequency, Hz.
    #[arg(long, value_name = "HZ", default_value_t = 6.0)]
    pub(super) to: f64,
    /// Gains Kp,Ki (1, 1/s) of the displacement loop; may stand several times.
    #[arg(long, value_name = "KP,KI", value_parser = gains, default_values = ["1,0", "3.70205,0.61701", "10,1"])]
    gains: Vec<(f64, f64)>,
}

/// Reads `Kp,Ki`.
fn gains(text: &str) -> Result<(f64, f64), String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
    match numbers[..] {
        [kp, ki] if kp.is_finite() && ki.is_finite() => Ok((kp, ki)),
        _ => Err("expected two numbers Kp,Ki, for instance 3.7,0.6".into()),
    }
}

impl Args {
    /// The grid asked for.
    pub(super) fn grid(&self) -> Result<Grid, Failure> {
        let wrong = |what: &str| Err(Failure::Input(format!("sweep: {what}")));
        if !(self.step > 0.0 && self.to >= self.step && self.to <= RATE / 20.0) {
            return wrong("--step and --to: expected 0 < step <= to <= 50 Hz, for instance --step 0.1 --to 6");
        }
        if self.to / self.step > 10_000.0 {
            return wrong("--step: more than 10,000 frequencies; take a wider step");
        }
        if self.amplitudes.is_empty() || self.amplitudes.iter().any(|a| !(*a > 0.0 && *a <= 1000.0)) {
            return wrong("--amplitudes: expected amplitudes between 0 and 1000 mm, for instance --amplitudes 1,10,50");
        }
        let steps = (self.to / self.step + 1e-9).floor() as u32;
        Ok(Grid {
            amplitudes: self.amplitudes.iter().map(|mm| mm * 1e-3).collect(),
            frequencies: (1..=steps).map(|i| f64::from(i) * self.step).collect(),
        })
    }
}

impl Args {
    /// Refuses gains at which the linear loop does not settle: its response to a sine would be a number without meaning.
    pub(super) fn stable(&self) -> Result<(), Failure> {
        for &(kp, ki) in &self.gains {
            if !settles((kp, ki)) {
                let text = format!(
                    "--gains {kp},{ki}: the loop is not stable with them; expected Kp above zero, Ki zero or more"
                );
                return Err(Failure::Input(text));
            }
        }
        Ok(())
    }
}

/// Measures the diagram at every pair of gains.
pub(super) fn run(args: &Args) -> Result<Part, Failure> {
    let grid = args.grid()?;
    let mut items = vec![Item::Text(
        "Sine by sine, each from rest: gain and phase of the displacement's fundamental over the reference, once the \
         transient has died out. Dashed: the linear loop H G / (1 + H G)."
            .into(),
    )];
    let (mut json, mut follows) = (Vec::new(), Vec::new());
    let bar = progress::bar((grid.len() * args.gains.len()) as u64, "Bode points");
    for &pair in &args.gains {
        let curves =
            displacement_loop(pair, RATE, &grid, || bar.inc(1)).map_err(|e| Failure::Input(format!("sweep: {e}")))?;
        items.push(Item::Table(table(pair, &curves)));
        items.extend(plots(pair, &curves).map(Item::Plot));
        let reach = curves.first().and_then(Curve::bandwidth);
        follows.push(reach.map_or_else(|| format!("beyond {} Hz", args.to), |hz| format!("{hz:.2} Hz")));
        json.push(json!({"kp": pair.0, "ki": pair.1, "curves": curves.iter().map(Curve::json).collect::<Vec<_>>()}));
    }
    bar.finish_and_clear();
    let at: Vec<String> =
        args.gains.iter().zip(&follows).map(|(pair, hz)| format!("{hz} with Kp = {}", pair.0)).collect();
    let least = digits::stated(args.amplitudes[0]);
    let found = format!("The displacement follows to {} (-3 dB at {least} mm).", at.join(", "));
    let figure = (format!("-3 dB at {least} mm, Kp = {}", args.gains[0].0), follows.swap_remove(0));
    let section = Section { heading: "Bode diagrams by amplitude (Figs. 4, 5, 10)".into(), items };
    Ok(Part { key: "bode", json: json.into(), found, figure, section, inputs: Vec::new() })
}

fn table((kp, ki): (f64, f64), curves: &[Curve]) -> Table {
    let or_none = |hz: Option<f64>| hz.map_or("-".into(), |hz| format!("{hz:.2}"));
    let row = |curve: &Curve| {
        let last = curve.points.last();
        vec![
            digits::stated(curve.amplitude * 1e3),
            or_none(curve.bandwidth()),
            or_none(curve.saturates_from()),
            last.map_or(String::new(), |p| format!("{:.1}", p.decibels())),
            curve.unwrapped_degrees().last().map_or(String::new(), |d| format!("{d:.0}")),
        ]
    };
    let top = curves.iter().find_map(|c| c.points.last()).map_or(0.0, |p| p.frequency);
    Table {
        caption: format!("Kp = {kp}, Ki = {ki} 1/s"),
        columns: vec![
            "amplitude [mm]".into(),
            "-3 dB at [Hz]".into(),
            "saturates from [Hz]".into(),
            format!("gain at {top:.1} Hz [dB]"),
            format!("phase at {top:.1} Hz [deg]"),
        ],
        rows: curves.iter().map(row).collect(),
    }
}

/// Gain and phase over frequency, the linear loop dashed.
fn plots((kp, ki): (f64, f64), curves: &[Curve]) -> [Plot; 2] {
    let frequencies: Vec<f64> = curves.first().map_or(Vec::new(), |c| c.points.iter().map(|p| p.frequency).collect());
    let exact: Vec<_> = frequencies.iter().map(|&f| linear(&Paper::default(), (kp, ki), f)).collect();
    let plot = |what: &str, unit: &str, line: Vec<f64>, of: &dyn Fn(&Curve) -> Vec<f64>| {
        let series = |c: &Curve| Series {
            name: format!("{} mm", digits::stated(c.amplitude * 1e3)),
            x: frequencies.clone(),
            y: of(c),
            style: Style::Line,
        };
        let linear = Series { name: "linear".into(), x: frequencies.clone(), y: line, style: Style::Dashed };
        Plot {
            title: format!("{what}, Kp = {kp}, Ki = {ki} 1/s"),
            x: Axis { label: "frequency [Hz]".into(), log: true },
            y: Axis { label: format!("{} [{unit}]", what.to_lowercase()), log: false },
            series: curves.iter().map(series).chain([linear]).collect(),
            bands: Vec::new(),
            group: Some(format!("bode-{kp}-{ki}")),
            ..Plot::default()
        }
    };
    let gain = exact.iter().map(|h| 20.0 * h.norm().log10()).collect();
    let phase = exact.iter().map(|h| h.arg().to_degrees()).collect();
    [
        plot("Gain", "dB", gain, &|c| c.points.iter().map(crate::closed_loop::frequency::Point::decibels).collect()),
        plot("Phase", "deg", phase, &Curve::unwrapped_degrees),
    ]
}
