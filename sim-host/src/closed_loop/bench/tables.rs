//! The tables of the benchmark.

use super::super::design::{Corner, DesignError, Table, TableError};
use super::yielding::YieldingPayload;
use crate::plant::effects::{Effect, payload_resonance};
use crate::plant::sensors::SensorModel;
use crate::plant::simulate::EffectParameters;
use crate::plant::stepped::Stepped;
use std::f64::consts::TAU;

/// What is mounted on a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Payload {
    /// Nothing.
    None,
    /// A structure of half the table's mass at 3 Hz, damped 3 %.
    Elastic,
    /// The same, yielding at 5 mm of drift to a tenth of its stiffness.
    Yielding,
}

/// A table of the benchmark: what it is, and what a controller is told of it.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    /// Name in tables and files.
    pub name: &'static str,
    /// What is special about it.
    pub about: &'static str,
    /// What identification would have found: every contender is tuned on this.
    pub table: Table,
    /// What is mounted on it; nobody is told.
    pub payload: Payload,
    /// Its sensors.
    pub sensors: SensorModel,
    /// Speed that records are fitted to, m/s: what the table can do, less a fortieth for the loop to work with.
    pub usable: f64,
}

/// Names, in order.
pub(crate) const TABLES: [&str; 7] = ["paper", "soft-orifice", "oil", "payload", "yielding", "droop", "noisy"];

/// Share of its limit that a table is asked for.
pub(crate) const ASKED: f64 = crate::motion::fit::named::ASKED;

/// Mass of the structure over the table's, 1; Hz; damping ratio, 1.
const STRUCTURE: [f64; 4] = [0.5, 3.0, 0.03, 0.0];

impl Bench {
    /// The table of this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        let paper = Table::default();
        let oil = Some((12.0, 0.05));
        let bench = |table: Table, about| {
            let name = TABLES.into_iter().find(|known| *known == name)?;
            let (payload, sensors) = (Payload::None, SensorModel::laboratory(1));
            Some(Self { name, about, table, payload, sensors, usable: ASKED * table.slower_limit() })
        };
        let loaded = Table { oil: Some((20.0, 0.08)), ..paper };
        match name {
            "paper" => bench(paper, "Eq. 7 and a hard limit of 0.242 m/s"),
            "soft-orifice" => {
                let found = bench(Table { sharpness: 3.0, ..paper }, "the flow softens toward its limit, exponent 3")?;
                // At nine tenths of the limit the valve is open 1.4 times as far as a linear one.
                Some(Self { usable: 0.9 * paper.velocity_limit, ..found })
            }
            "oil" => bench(Table { oil, ..paper }, "the table's mass on an oil column of 12 Hz, damped 5 %"),
            "payload" => {
                let found = bench(loaded, "oil at 20 Hz; a structure of half the mass at 3 Hz that nobody is told of")?;
                Some(Self { payload: Payload::Elastic, ..found })
            }
            "yielding" => {
                let found = bench(loaded, "the same structure, yielding at 5 mm of drift")?;
                Some(Self { payload: Payload::Yielding, ..found })
            }
            "droop" => {
                let table = Table { droop: (0.3, 3.0), ..paper };
                let found = bench(table, "the supply loses up to 30 % of its pressure and takes 3 s to recover")?;
                Some(Self { usable: ASKED * paper.velocity_limit * 0.7_f64.sqrt(), ..found })
            }
            "noisy" => {
                let found = bench(paper, "the paper's table; LVDT and accelerometer three times as coarse")?;
                Some(Self { sensors: coarse(3.0), ..found })
            }
            _ => None,
        }
    }

    /// The oil-resonance table with a drooping supply: the hardest of the robustness figures.
    pub(crate) fn oil_with_droop() -> Self {
        let table = Table { oil: Some((12.0, 0.05)), droop: (0.3, 3.0), ..Table::default() };
        Self {
            name: "oil with droop",
            about: "oil at 12 Hz, damped 5 %; the supply loses up to 30 %",
            table,
            payload: Payload::None,
            sensors: SensorModel::laboratory(1),
            // What is left with the supply 30 % low and drooping.
            usable: ASKED * table.velocity_limit * (0.7_f64 * 0.7).sqrt(),
        }
    }

    /// The plant at a corner of its uncertainty.
    pub(crate) fn plant(&self, corner: &Corner, dt: f64) -> Result<Stepped, DesignError> {
        let [mass_ratio, frequency, damping, _] = STRUCTURE;
        let placed = EffectParameters { id: payload_resonance::ENTRY.id, parameters: STRUCTURE.to_vec() };
        let others: Vec<Box<dyn Effect<f64>>> = vec![Box::new(YieldingPayload {
            mass_ratio,
            frequency: TAU * frequency,
            damping,
            drift: 0.005,
            left: 0.1,
        })];
        let plant = match self.payload {
            Payload::None => self.table.plant_with(corner, Vec::new(), Vec::new(), dt),
            Payload::Elastic => self.table.plant_with(corner, vec![placed], Vec::new(), dt),
            Payload::Yielding => self.table.plant_with(corner, Vec::new(), others, dt),
        };
        plant.map_err(|e: TableError| e.into())
    }
}

/// The paper's laboratory, so many times as coarse.
fn coarse(factor: f64) -> SensorModel {
    let mut model = SensorModel::laboratory(1);
    model.displacement_step *= factor;
    model.acceleration_noise *= factor;
    for line in model.displacement_lines.iter_mut().chain(&mut model.acceleration_lines) {
        line.amplitude *= factor;
    }
    model
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    #[test]
    fn every_name_is_a_table_that_moves() {
        for name in TABLES {
            let bench = Bench::named(name).unwrap();
            let mut plant = bench.plant(&Corner::default(), 5e-4).unwrap();
            plant.advance(0.01, 400);
            assert!(plant.displacement() > 5e-4, "{name}: {}", plant.displacement());
        }
        assert!(Bench::named("steel").is_none());
    }

    /// Driven slowly far beyond its yield drift the structure pushes back with its yield force and what is left of its
    /// stiffness; an elastic one with all of it.
    #[test]
    fn the_structure_yields() {
        use crate::plant::effects::Instant;
        let structure = YieldingPayload { mass_ratio: 1.0, frequency: 10.0, damping: 0.0, drift: 0.005, left: 0.1 };
        let mut state = [0.0, 0.0, 0.0];
        let mut force = 0.0;
        for k in 0..20_000 {
            let displacement = 1e-6 * f64::from(k);
            let at = Instant { time: 0.0, displacement, velocity: 0.01, sensed_velocity: 0.0, velocity_limit: 1.0 };
            let mut rate = [0.0; 3];
            force = structure.force(&at, &state, &mut rate);
            // The structure's own mass is held: only the drift counts here.
            state[2] += 1e-4 * rate[2];
        }
        let expected = 100.0 * (0.1 * 0.02 + 0.9 * 0.005);
        assert!((force / expected - 1.0).abs() < 0.02, "{force} {expected}");
    }
}
