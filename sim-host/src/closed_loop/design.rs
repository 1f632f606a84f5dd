//! Gains from a model and its uncertainty, margins first.
//!
//! The law's feedback follows from two frequencies. A pair is safe when on the model, and on every corner of its
//! uncertainty, the loop is stable with at least the margins asked for (`margin`: the very law, run). Wide feedback
//! undoes what the model has wrong and lets the sensors' noise through, so of the safe pairs the one is taken with the
//! least of both: the share of a motion that the uncertainty leaves in the worst corner, and the share that noise adds. A
//! model known well gets a quiet law. Where no pair is safe, nothing is written and the nearest is named.

pub mod answer;
mod corner;
mod noise;
mod table;

pub use corner::{Corner, Spread};
pub use table::{Table, TableError};

use super::margin::{Margins, Point, margins_with, open_loop_with};
use super::{Clock, ClosedLoopError, pressure_by_settings};
use crate::plant::sensors::SensorModel;
use crate::plant::stepped::Stepped;
use rayon::prelude::*;
use shakedown_core::settings::TrackingSettings;
use shakedown_core::{Controller, Settings};

/// What a design must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Demand {
    /// Gain margin, dB, and phase margin, degrees, in every corner.
    pub margins: (f64, f64),
    /// Uncertainty of the model.
    pub spread: Spread,
    /// Control rate, Hz.
    pub rate: f64,
}

impl Default for Demand {
    fn default() -> Self {
        Self { margins: (6.0, 30.0), spread: Spread::default(), rate: 1000.0 }
    }
}

/// A design, and what it has to spare.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// The settings.
    pub settings: Settings,
    /// On the model.
    pub nominal: Margins,
    /// In the worst corner, each figure for itself.
    pub worst: Margins,
    /// How many corners were looked at.
    pub corners: usize,
    /// Of the motion's acceleration, what the uncertainty leaves in the worst corner, and what the sensors' noise adds below
    /// 15 Hz, 1.
    pub expected: [f64; 2],
}

impl Design {
    /// Both errors together, 1.
    fn error(&self) -> f64 {
        self.expected[0].hypot(self.expected[1])
    }
}

/// Why there is no design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// No pair of frequencies keeps the margins in every corner.
    #[error(
        "no gains are safe: the mildest tried, feedback of {bandwidth} Hz with {disturbance} Hz of disturbance \
         observer, {found}, where {gain_db} dB and {phase_degrees} degrees are asked for in every corner: narrow the \
         model's intervals, or ask for less"
    )]
    Unsafe {
        /// Bandwidth of the mildest pair, Hz.
        bandwidth: f64,
        /// Its disturbance observer, Hz.
        disturbance: f64,
        /// What was wrong with it.
        found: String,
        /// Gain margin asked for, dB.
        gain_db: f64,
        /// Phase margin asked for, degrees.
        phase_degrees: f64,
    },
    /// The model cannot be designed for.
    #[error("model: {0}")]
    Table(#[from] TableError),
    /// The loop could not be set up.
    #[error(transparent)]
    Loop(#[from] ClosedLoopError),
}

/// Root mean square of the acceleration that noise is held against, m/s2: a moderate record's over its length.
const MOTION: f64 = 0.5;

/// Disturbance observers tried, as shares of the rate, from the widest, and feedback as shares of the observer. Wider feedback
/// leaves less of nothing and lets the LVDT's step shake the table: at half the observer half as much again.
const OBSERVERS: [f64; 7] = [0.05, 0.04, 0.03, 0.02, 0.012, 0.007, 0.004];
const FEEDBACK: [f64; 2] = [0.12, 0.2];

/// The settings for a pair of frequencies (Hz), everything else from the model.
pub fn settings(table: &Table, rate: f64, (bandwidth, disturbance): (f64, f64)) -> Settings {
    let mut settings = table.settings(rate);
    if let Some(tracking) = &mut settings.tracking {
        (tracking.bandwidth, tracking.disturbance) = (bandwidth as f32, disturbance as f32);
    }
    settings
}

/// The loop's margins at one corner; what is not linear near rest is taken out of plant and law alike.
pub fn at_corner(table: &Table, settings: &Settings, corner: &Corner) -> Result<Option<Margins>, DesignError> {
    looped(table, settings, corner, margins_with)
}

/// The open loop on the model and in every corner, with the same taken out; a loop that is not stable has no points.
pub fn open_loops(
    table: &Table,
    settings: &Settings,
    spread: &Spread,
) -> Result<Vec<(Corner, Vec<Point>)>, DesignError> {
    let corners: Vec<Corner> = std::iter::once(Corner::default()).chain(spread.corners()).collect();
    let points = |corner: Corner| {
        let found = looped(table, settings, &corner, open_loop_with)?;
        Ok((corner, found.unwrap_or_default()))
    };
    corners.into_par_iter().map(points).collect()
}

fn looped<T>(
    table: &Table,
    settings: &Settings,
    corner: &Corner,
    seen: impl Fn(&mut Stepped, &mut Controller, SensorModel, Clock) -> T,
) -> Result<T, DesignError> {
    let clock = Clock::new(f64::from(settings.rate), 2).map_err(ClosedLoopError::from)?;
    let mut law = Controller::new(&smooth(settings)).map_err(ClosedLoopError::from)?;
    let mut plant = table.linear(corner, clock.plant_step())?;
    let sensors = pressure_by_settings(&SensorModel::default(), settings);
    Ok(seen(&mut plant, &mut law, sensors, clock))
}

fn smooth(settings: &Settings) -> Settings {
    let of = |mut tracking: TrackingSettings| {
        (tracking.friction.deadband, tracking.friction.coulomb) = (0.0, 0.0);
        tracking
    };
    Settings { tracking: settings.tracking.map(of), ..*settings }
}

/// The margins on the model and the worst over all corners, or the first thing that is short of `demand`.
pub fn judge(table: &Table, settings: &Settings, demand: &Demand) -> Result<Result<[Margins; 2], String>, DesignError> {
    let corners = demand.spread.corners();
    let short = |found: Option<Margins>, corner: &Corner| match found {
        None => Err(format!("is not stable at {corner}")),
        Some(m) if !m.reach(demand.margins) => {
            Err(format!("has {:.1} dB and {:.0} degrees at {corner}", m.gain_db, m.phase_degrees))
        }
        Some(m) => Ok(m),
    };
    let nominal = match short(at_corner(table, settings, &Corner::default())?, &Corner::default()) {
        Ok(found) => found,
        Err(why) => return Ok(Err(why)),
    };
    let all: Vec<_> = corners.par_iter().map(|corner| (corner, at_corner(table, settings, corner))).collect();
    let mut worst = nominal;
    for (corner, found) in all {
        match short(found?, corner) {
            Ok(found) => worst = worst.worse(found),
            Err(why) => return Ok(Err(why)),
        }
    }
    Ok(Ok([nominal, worst]))
}

/// Finds the gains for `table`; `tried` is told of every pair (Hz) before it is looked at.
pub fn design(table: &Table, demand: &Demand, mut tried: impl FnMut(f64, f64)) -> Result<Design, DesignError> {
    let mut best: Option<Design> = None;
    let mut last = (0.0, 0.0, String::new());
    'observers: for observer in OBSERVERS.map(|share| share * demand.rate) {
        for share in FEEDBACK {
            let pair = (share * observer, observer);
            tried(pair.0, pair.1);
            let settings = settings(table, demand.rate, pair);
            match judge(table, &settings, demand)? {
                Err(why) => last = (pair.0, pair.1, why),
                Ok([nominal, worst]) => {
                    let noise = noise::shaken(table, &smooth(&settings))? / MOTION;
                    let expected = [demand.spread.largest() * worst.left, noise];
                    let corners = demand.spread.corners().len() + 1;
                    let found = Design { settings, nominal, worst, corners, expected };
                    // A slower observer leaves more.
                    if best.as_ref().is_some_and(|best| expected[0] > best.error()) {
                        break 'observers;
                    }
                    if best.as_ref().is_none_or(|best| found.error() < best.error()) {
                        best = Some(found);
                    }
                }
            }
        }
    }
    if let Some(best) = best {
        return Ok(best);
    }
    let (bandwidth, disturbance, found) = last;
    let (gain_db, phase_degrees) = demand.margins;
    Err(DesignError::Unsafe { bandwidth, disturbance, found, gain_db, phase_degrees })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shakedown_core::settings::PressureSettings;

    fn oil() -> Table {
        Table { oil: Some((12.0, 0.05)), ..Table::default() }
    }

    #[test]
    fn the_oil_resonance_gets_a_design_that_keeps_what_it_promises() {
        let demand = Demand { spread: Spread::all(0.3), ..Demand::default() };
        let found = design(&oil(), &demand, |_, _| ()).unwrap();
        assert_eq!(found.corners, 17);
        assert!(found.worst.reach(demand.margins) && found.nominal.reach(found_of(&found)), "{found:?}");
        // Judged again, it is the same.
        let again = judge(&oil(), &found.settings, &demand).unwrap().unwrap();
        assert_eq!(again, [found.nominal, found.worst]);
    }

    /// A law that takes the oil for stiff swings up on a column of 12 Hz; damped by the pressure difference it has margins.
    #[test]
    fn pressure_difference_damps_what_the_law_does_not_know() {
        let with_area = |area: f32, gain: f32| {
            let mut settings = settings(&Table::default(), 1000.0, (4.0, 0.0));
            let pressure = PressureSettings { area_per_mass: area, gain, corner: 0.5 };
            settings.tracking = settings.tracking.map(|t| TrackingSettings { pressure: Some(pressure), ..t });
            at_corner(&oil(), &settings, &Corner::default()).unwrap()
        };
        let with = |gain: f32| with_area(0.024 / 5000.0, gain);
        assert_eq!(with(0.0), None);
        // A table of another size: 20 cm2 on 150 kg. What its sensor shows is its own, and so is the damping.
        let apart = with_area(0.002 / 150.0, 0.015).unwrap().gain_db - with(0.015).unwrap().gain_db;
        assert!(apart.abs() < 0.1, "{apart} dB");
        assert!(with(0.015).unwrap().reach((6.0, 30.0)), "{:?}", with(0.015));
    }

    /// What is known well needs little feedback, and little feedback lets little noise through.
    #[test]
    fn a_model_known_well_gets_a_quiet_law() {
        let of = |spread: f64| {
            let demand = Demand { spread: Spread::all(spread), ..Demand::default() };
            let found = design(&Table::default(), &demand, |_, _| ()).unwrap();
            (found.settings.tracking.unwrap().disturbance, found.expected)
        };
        let (unsure, sure) = (of(0.3), of(0.05));
        assert!(sure.0 < 0.5 * unsure.0, "{sure:?} {unsure:?}");
        assert!(sure.1[1] < unsure.1[1] && sure.1[0] < unsure.1[0], "{sure:?} {unsure:?}");
    }

    fn found_of(design: &Design) -> (f64, f64) {
        (design.worst.gain_db, design.worst.phase_degrees)
    }

    #[test]
    fn what_cannot_be_safe_is_refused_with_the_corner() {
        let demand = Demand { spread: Spread::all(0.95), margins: (12.0, 50.0), ..Demand::default() };
        let refused = design(&oil(), &demand, |_, _| ()).unwrap_err().to_string();
        assert!(refused.starts_with("no gains are safe") && refused.contains("gain"), "{refused}");
    }
}
