//! Dry friction in five forms. Forces are per table mass (m/s2), positive against positive motion.

mod dahl;
mod karnopp;
mod leuven;
mod lugre;
mod maxwell_slip;

use super::{ANY, Dial, Form, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;
pub use dahl::Dahl;
pub use karnopp::Karnopp;
pub use leuven::Leuven;
pub use lugre::LuGre;
pub use maxwell_slip::MaxwellSlip;

/// Levels of a sliding contact: Coulomb, break-away, and the velocity about which one turns into the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Sliding (m/s2).
    pub sliding: f64,
    /// Break-away (m/s2).
    pub breakaway: f64,
    /// Stribeck velocity (m/s).
    pub stribeck: f64,
    /// Exponent of the Stribeck curve (1).
    pub exponent: f64,
}

impl Levels {
    /// Force at which the contact slides at `v` (m/s): m/s2, positive.
    pub fn at(&self, v: f64) -> f64 {
        let falling = (-(v.abs() / self.stribeck).powf(self.exponent)).exp();
        self.sliding + (self.breakaway - self.sliding) * falling
    }
}

const MOST: f64 = 3.0;

fn levels(dial: &Dial, stribeck: bool) -> (Levels, Parameters) {
    let sliding = MOST * dial.s;
    let ratio = if stribeck { dial.draw.between(0, 1.3, 2.2) } else { 1.0 + 0.04 * dial.draw.u[0] };
    let velocity = dial.draw.log_between(1, 0.01, 0.06) * dial.scales.velocity;
    let exponent = dial.draw.between(3, 0.8, 2.0);
    let levels = Levels { sliding, breakaway: ratio * sliding, stribeck: velocity, exponent };
    let mass = dial.scales.mass;
    let mut parameters = vec![("force", sliding * mass)];
    if stribeck {
        parameters.extend([("static", levels.breakaway * mass), ("velocity", velocity)]);
    }
    (levels, parameters)
}

/// Deflection before sliding (m).
fn presliding(dial: &Dial) -> f64 {
    dial.draw.log_between(2, 2e-6, 3e-5)
}

fn with(plant: &mut Plant, dial: &Dial, stribeck: bool, kind: Kind) -> Parameters {
    let (levels, parameters) = levels(dial, stribeck);
    let z = presliding(dial);
    match kind {
        Kind::LuGre => plant.add(Place::Force, LuGre::new(levels, z)),
        Kind::MaxwellSlip => plant.add(Place::Force, MaxwellSlip::new(levels, z)),
        Kind::Karnopp => plant.add(Place::Force, Karnopp::new(levels, 0.002 * dial.scales.velocity)),
        Kind::Leuven => plant.add(Place::Force, Leuven::new(levels, z)),
        Kind::Dahl => plant.add(Place::Force, Dahl::new(levels, z)),
    }
    parameters
}

#[derive(Clone, Copy)]
enum Kind {
    LuGre,
    MaxwellSlip,
    Karnopp,
    Leuven,
    Dahl,
}

const LUGRE: &str = "Canudas de Wit, Olsson, Astrom, Lischinsky 1995";
const GMS: &str = "Al-Bender, Lampaert, Swevers 2005";
const KARNOPP: &str = "Karnopp 1985";
const LEUVEN: &str = "Swevers, Al-Bender, Ganseman, Projogo 2000";
const DAHL: &str = "Dahl 1968, exponent other than one";

const fn form(
    effect: &'static str,
    name: &'static str,
    source: &'static str,
    build: fn(&mut Plant, &Dial) -> Parameters,
) -> Form {
    Form { effect, name, source, build, needs: ANY }
}

pub(super) const FORMS: &[Form] = &[
    form("coulomb_friction", "LuGre", LUGRE, |p, d| with(p, d, false, Kind::LuGre)),
    form("coulomb_friction", "generalised Maxwell slip", GMS, |p, d| with(p, d, false, Kind::MaxwellSlip)),
    form("coulomb_friction", "Karnopp", KARNOPP, |p, d| with(p, d, false, Kind::Karnopp)),
    form("coulomb_friction", "Leuven", LEUVEN, |p, d| with(p, d, false, Kind::Leuven)),
    form("coulomb_friction", "Dahl", DAHL, |p, d| with(p, d, false, Kind::Dahl)),
    form("stribeck_friction", "LuGre", LUGRE, |p, d| with(p, d, true, Kind::LuGre)),
    form("stribeck_friction", "generalised Maxwell slip", GMS, |p, d| with(p, d, true, Kind::MaxwellSlip)),
    form("stribeck_friction", "Karnopp", KARNOPP, |p, d| with(p, d, true, Kind::Karnopp)),
    form("stribeck_friction", "Leuven", LEUVEN, |p, d| with(p, d, true, Kind::Leuven)),
];

#[cfg(test)]
mod tests {
    use super::{Dahl, Karnopp, Leuven, Levels, LuGre, MaxwellSlip};
    use crate::lab::law::{Law, Now};

    const LEVELS: Levels = Levels { sliding: 0.3, breakaway: 0.5, stribeck: 0.01, exponent: 2.0 };

    /// Force after `seconds` at constant velocity `v` (m/s).
    fn steady(law: &dyn Law, v: f64, seconds: f64) -> f64 {
        let mut m = vec![0.0; law.memories()];
        let now = Now { v, drive: 10.0 * v.signum(), ..Now::default() };
        let h = 1e-4;
        for _ in 0..(seconds / h) as usize {
            law.remember(&now, 0.0, h, &mut m);
        }
        law.out(&now, 0.0, &[], &m)
    }

    #[test]
    fn every_contact_slides_at_its_stribeck_curve() {
        let laws: [(&str, Box<dyn Law>); 4] = [
            ("LuGre", Box::new(LuGre::new(LEVELS, 1e-5))),
            ("Maxwell slip", Box::new(MaxwellSlip::new(LEVELS, 1e-5))),
            ("Karnopp", Box::new(Karnopp::new(LEVELS, 1e-4))),
            ("Leuven", Box::new(Leuven::new(LEVELS, 1e-5))),
        ];
        for (name, law) in laws {
            for v in [0.003, -0.005, 0.02, -0.2] {
                let (force, curve) = (steady(law.as_ref(), v, 1.0), f64::signum(v) * LEVELS.at(v));
                assert!((force / curve - 1.0).abs() < 0.02, "{name} at {v} m/s: {force} for {curve}");
            }
        }
    }

    #[test]
    fn dahls_contact_slides_at_the_coulomb_level_at_any_speed() {
        let law = Dahl::new(Levels { breakaway: 0.3, ..LEVELS }, 1e-5);
        for v in [0.002, -0.05, 0.3] {
            assert!((steady(&law, v, 1.0) - 0.3 * f64::signum(v)).abs() < 3e-3);
        }
    }

    #[test]
    fn a_contact_bends_before_it_slides_and_turns_back_along_another_line() {
        let bends: [(&str, Box<dyn Law>); 4] = [
            ("LuGre", Box::new(LuGre::new(LEVELS, 1e-5))),
            ("Maxwell slip", Box::new(MaxwellSlip::new(LEVELS, 1e-5))),
            ("Leuven", Box::new(Leuven::new(LEVELS, 1e-5))),
            ("Dahl", Box::new(Dahl::new(LEVELS, 1e-5))),
        ];
        for (name, law) in bends {
            let mut m = vec![0.0; law.memories()];
            let mut travel = |v: f64, seconds: f64| {
                let now = Now { v, ..Now::default() };
                for _ in 0..(seconds / 1e-5) as usize {
                    law.remember(&now, 0.0, 1e-5, &mut m);
                }
                law.out(&now, 0.0, &[], &m)
            };
            let there = travel(1e-3, 3e-3);
            let half_back = travel(-1e-3, 1.5e-3);
            assert!(there > 0.02 && there < 0.3 && half_back < 0.7 * there, "{name}: {there}, then {half_back}");
        }
    }
}
