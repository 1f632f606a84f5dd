//! Bad data: recordings that no model should be judged by.

use super::sheet::Sheets;
use crate::answer::Fault;
use crate::rng::Stream;

/// What is done to the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corruption {
    /// The numbers are in another unit than the one stated.
    WrongUnit,
    /// The sign is turned round.
    Inverted,
    /// Displacement and acceleration have changed places.
    Swapped,
    /// A channel holds one value for a third of the run or more.
    Stuck,
    /// A channel holds nothing but one value.
    Dead,
    /// A channel is of another run.
    Foreign,
}

impl Corruption {
    /// All kinds.
    pub const ALL: [Self; 6] = [Self::WrongUnit, Self::Inverted, Self::Swapped, Self::Stuck, Self::Dead, Self::Foreign];

    /// A name.
    pub fn name(self) -> &'static str {
        match self {
            Self::WrongUnit => "wrong unit",
            Self::Inverted => "inverted",
            Self::Swapped => "swapped",
            Self::Stuck => "stuck",
            Self::Dead => "dead",
            Self::Foreign => "of another run",
        }
    }

    /// Does it to every run, so that no run is left to tell it by; none where the experiment has not the channels for it.
    pub fn spoil(self, experiment: &mut Sheets, rng: &mut Stream) -> Option<Fault> {
        let place = |channel: &str| experiment.columns.iter().position(|c| c.channel == channel);
        let (displacement, acceleration) = (place("displacement")?, place("acceleration")?);
        let on_acceleration = rng.chance(0.5);
        let (i, channel) =
            if on_acceleration { (acceleration, "acceleration") } else { (displacement, "displacement") };
        let factor = if experiment.columns[i].factor == 1.0 { 1e3 } else { 1e-3 };
        // An accelerometer is read in g as often as not.
        let factor = if on_acceleration { if rng.chance(0.5) { 1.0 / 9.80665 } else { 9.80665 } } else { factor };
        if self == Self::Foreign && experiment.sheets.len() < 2 {
            return None;
        }
        let others: Vec<Vec<f64>> = experiment.sheets.iter().map(|sheet| sheet.values[i].clone()).collect();
        for (k, sheet) in experiment.sheets.iter_mut().enumerate() {
            let values = &mut sheet.values;
            match self {
                Self::WrongUnit => values[i].iter_mut().for_each(|v| *v *= factor),
                Self::Inverted => values[i].iter_mut().for_each(|v| *v = -*v),
                Self::Swapped => values.swap(displacement, acceleration),
                Self::Stuck => {
                    let rows = values[i].len();
                    let from = (rng.uniform(0.1, 0.5) * rows as f64) as usize;
                    let to = (from + (rng.uniform(0.34, 0.6) * rows as f64) as usize).min(rows);
                    let held = values[i][from];
                    values[i][from..to].fill(held);
                }
                Self::Dead => values[i].fill(0.0),
                Self::Foreign => {
                    let other = &others[(k + 1) % others.len()];
                    let rows = values[i].len();
                    values[i] = (0..rows).map(|row| other[row % other.len()]).collect();
                }
            }
        }
        let channel = if self == Self::Swapped { "" } else { channel };
        Some(Fault { problem: self.name(), channel, run: None })
    }
}
