//! The open loop of a design, on the model and in the corners of its uncertainty: Bode and Nyquist.

use crate::closed_loop::design::{Corner, Design, DesignError, Spread, Table, open_loops};
use crate::closed_loop::margin::Point;
use crate::report::{Axis, Item, Plot, Section, Series, Style};
use std::f64::consts::TAU;

/// Farthest from the origin that a Nyquist diagram shows, 1: beyond, nothing is near -1.
const FARTHEST: f64 = 3.0;

/// The figures of the loop.
pub(super) fn section(found: &Design, table: &Table, spread: &Spread) -> Result<Section, DesignError> {
    let loops = open_loops(table, &found.settings, spread)?;
    let gain = |point: &Point| 20.0 * point.open.norm().log10();
    let items = vec![
        over_frequency(
            "Gain of the open loop",
            "gain [dB]",
            &loops,
            &|points| points.iter().map(gain).collect(),
            ("0 dB", 0.0),
        ),
        over_frequency("Phase of the open loop", "phase [degrees]", &loops, &unwrapped, ("-180 degrees", -180.0)),
        nyquist(&loops),
    ];
    Ok(Section { heading: "The open loop, from the valve's command around to it".into(), items })
}

/// Phase, degrees, without jumps by a whole turn.
fn unwrapped(points: &[Point]) -> Vec<f64> {
    let mut last = None;
    let mut turns = 0.0;
    let follow = |point: &Point| {
        let phase = point.open.arg().to_degrees();
        let jump: f64 = last.map_or(0.0, |last: f64| phase - last);
        turns -= (jump / 360.0).round();
        last = Some(phase);
        phase + 360.0 * turns
    };
    points.iter().map(follow).collect()
}

/// One part of the loop over frequency: the model's, and between which lines every corner's lies.
fn over_frequency(
    title: &str,
    label: &str,
    loops: &[(Corner, Vec<Point>)],
    part: &dyn Fn(&[Point]) -> Vec<f64>,
    (named, critical): (&str, f64),
) -> Item {
    let parts: Vec<Vec<f64>> = loops.iter().map(|(_, points)| part(points)).collect();
    let x: Vec<f64> = loops.first().map_or_else(Vec::new, |(_, points)| points.iter().map(|p| p.frequency).collect());
    let end = |pick: fn(f64, f64) -> f64| -> Vec<f64> {
        let at = |k: usize| parts.iter().filter_map(|part| part.get(k)).copied().reduce(pick).unwrap_or(f64::NAN);
        (0..x.len()).map(at).collect()
    };
    let series = |name: &str, y: Vec<f64>, style| Series { name: name.into(), x: x.clone(), y, style };
    Item::Plot(Plot {
        title: title.into(),
        x: Axis { label: "frequency [Hz]".into(), log: true },
        y: Axis { label: label.into(), log: false },
        series: vec![
            series("least of the corners", end(f64::min), Style::Faint),
            series("most of the corners", end(f64::max), Style::Faint),
            series("on the model", parts.first().cloned().unwrap_or_default(), Style::Line),
            series(named, vec![critical; x.len()], Style::Dashed),
        ],
        group: Some("loop".into()),
        ..Plot::default()
    })
}

/// The loop as a curve in the plane: how near any corner comes to -1.
fn nyquist(loops: &[(Corner, Vec<Point>)]) -> Item {
    let plane = |name: &str, curves: &[(Corner, Vec<Point>)], style| {
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for (_, points) in curves {
            for point in points {
                let inside = point.open.norm() <= FARTHEST;
                // A gap has a place all the same.
                x.push(if inside { point.open.re } else { 0.0 });
                y.push(if inside { point.open.im } else { f64::NAN });
            }
            x.push(0.0);
            y.push(f64::NAN);
        }
        Series { name: name.into(), x, y, style }
    };
    let (im, re) = (0..=240).map(|k| (TAU * f64::from(k) / 240.0).sin_cos()).unzip();
    // A cross, for a single point is lost on the circle.
    let (cross_x, cross_y) = (vec![-1.04, -0.96, 0.0, -1.0, -1.0], vec![0.0, 0.0, f64::NAN, -0.15, 0.15]);
    let (model, corners) = loops.split_at(loops.len().min(1));
    Item::Plot(Plot {
        title: "Nyquist diagram".into(),
        x: Axis { label: "real part [1]".into(), log: false },
        y: Axis { label: "imaginary part [1]".into(), log: false },
        series: vec![
            plane("every corner", corners, Style::Faint),
            plane("on the model", model, Style::Line),
            Series { name: "gain 1".into(), x: re, y: im, style: Style::Dashed },
            Series { name: "critical point, -1".into(), x: cross_x, y: cross_y, style: Style::Line },
        ],
        ..Plot::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::design::{Demand, design};

    #[test]
    fn phase_goes_on_beyond_half_a_turn() {
        // An integrator behind a dead time of 10 ms.
        let at = |k: u32| {
            let frequency = f64::from(k);
            let open = nalgebra::Complex::from_polar(1.0 / frequency, -TAU * (0.25 + 0.01 * frequency));
            Point { frequency, open }
        };
        let phase = unwrapped(&(1..150).map(at).collect::<Vec<_>>());
        for (k, found) in (1..150).zip(phase) {
            assert!((found + 90.0 + 3.6 * f64::from(k)).abs() < 1e-9, "{found} at {k} Hz");
        }
    }

    #[test]
    fn the_figures_show_the_margins_that_the_table_states() {
        let (table, demand) = (Table::default(), Demand { spread: Spread::all(0.3), ..Demand::default() });
        let found = design(&table, &demand, |_, _| ()).unwrap();
        let section = section(&found, &table, &demand.spread).unwrap();
        let [Item::Plot(gain), Item::Plot(phase), Item::Plot(plane)] = &section.items[..] else {
            panic!("three plots")
        };
        let model = |plot: &Plot| plot.series[2].clone();
        let (gain, phase) = (model(gain), model(phase));
        let last = gain.y.iter().rposition(|g| *g > 0.0).unwrap();
        assert!((gain.x[last + 1] / found.nominal.crossover_hz - 1.0).abs() < 1e-9);
        let margin = 180.0 + phase.y[last];
        assert!((margin - found.nominal.phase_degrees).abs() < 3.0, "{margin} {:?}", found.nominal);
        // No corner comes nearer to -1 than the largest sensitivity allows.
        let all = &plane.series[0];
        let shown = all.x.iter().zip(&all.y).filter(|(_, im)| im.is_finite());
        let near = shown.map(|(re, im)| (re + 1.0).hypot(*im)).fold(f64::INFINITY, f64::min);
        assert!((near * found.worst.peak_sensitivity - 1.0).abs() < 1e-6, "{near} {:?}", found.worst);
    }
}
