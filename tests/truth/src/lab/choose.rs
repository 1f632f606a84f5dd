//! What a case is to hold: listed forms and unlisted kinds, how visible each is to be, and where it acts.

use super::forms::{self, Dial, Form, Needs, Parameters, Scales};
use super::law::{Gate, Variable};
use super::plan::{Stratum, stratum, target, turn};
use super::plant::Plant;
use super::scene::{Kind, Wish};
use super::unlisted::grammar::Built;
use super::unlisted::{BUILT, Kind as Named, NAMED};
use crate::plan::Strength;
use crate::rng::Stream;

/// Something to put into a plant.
#[derive(Debug, Clone, Copy)]
pub enum Ingredient {
    /// A form of a listed effect.
    Listed(Form),
    /// An unlisted kind with a name.
    Named(Named),
    /// An unlisted kind of the grammar.
    Built(Built),
}

impl Ingredient {
    /// Identifier, or the unlisted kind.
    pub fn id(&self) -> String {
        match self {
            Self::Listed(form) => form.effect.into(),
            Self::Named(kind) => kind.name.into(),
            Self::Built(built) => built.name(),
        }
    }

    /// Name of the form, and where it comes from.
    pub fn form(&self) -> (String, String) {
        match self {
            Self::Listed(form) => (form.name.into(), form.source.into()),
            Self::Named(kind) => (kind.name.into(), "named".into()),
            Self::Built(built) => (built.name(), "grammar".into()),
        }
    }

    /// Whether the library holds it.
    pub fn listed(&self) -> bool {
        matches!(self, Self::Listed(_))
    }

    /// What it asks for.
    pub fn needs(&self) -> Needs {
        match self {
            Self::Listed(form) => form.needs,
            Self::Named(kind) => kind.needs,
            Self::Built(built) => built.needs(),
        }
    }

    /// Listed effects that are truly part of it.
    pub fn tolerated(&self) -> &'static [&'static str] {
        if let Self::Named(kind) = self { kind.tolerated } else { &[] }
    }

    /// Puts it into a plant; its parameters, where it is listed.
    pub fn build(&self, plant: &mut Plant, dial: &Dial) -> Parameters {
        match self {
            Self::Listed(form) => (form.build)(plant, dial),
            Self::Named(kind) => {
                (kind.build)(plant, dial);
                Vec::new()
            }
            Self::Built(built) => {
                built.build(plant, dial);
                Vec::new()
            }
        }
    }
}

/// Flaws of case `number` of `seed` that every attempt at it holds: all but those of pairs, triples and ties, and the listed
/// one beside an unlisted one.
pub fn kinds(seed: u64, number: u64, lock: u64) -> Vec<String> {
    let what = stratum(seed, number);
    if matches!(what, Stratum::Pair | Stratum::Triple) {
        return Vec::new();
    }
    let chosen = Chosen::draw((seed, number), lock, &mut Stream::new(seed, number, 0));
    let fixed = |i: &Ingredient| what != Stratum::Mixed || !i.listed();
    chosen.list.iter().filter(|(i, _)| fixed(i)).map(|(i, _)| i.id()).collect()
}

/// Whether two listed effects act at one place or look alike.
pub fn one_family(a: &str, b: &str) -> bool {
    FAMILIES.iter().any(|family| family.contains(&a) && family.contains(&b))
}

/// The effects that act at one place with `effect` or look like it.
pub fn mates(effect: &str) -> Vec<&'static str> {
    let families = FAMILIES.iter().filter(|family| family.contains(&effect));
    let mut out: Vec<&str> = families.flat_map(|family| family.iter().copied()).filter(|id| *id != effect).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// What a case is to hold.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Stratum.
    pub what: Stratum,
    /// Ingredients, each with what it is to add to chi2 by itself.
    pub list: Vec<(Ingredient, f64)>,
}

/// Effects that act at one place or look alike.
const FAMILIES: [&[&str]; 7] = [
    &["command_delay", "valve_lag", "displacement_lag", "acceleration_lag", "leakage", "oil_compliance"],
    &["valve_deadband", "coulomb_friction", "stribeck_friction", "viscous_friction", "payload_resonance"],
    &["flow_softening", "asymmetric_limit", "supply_droop", "load_dependent_flow", "valve_rate_limit"],
    &["displacement_nonlinearity", "gain_drift", "acceleration_gain", "asymmetric_gain", "null_bias"],
    &["spring", "end_stop", "payload_resonance", "leakage", "oil_compliance"],
    &["base_compliance", "payload_resonance", "oil_compliance", "backlash", "acceleration_lag"],
    &["acceleration_bias", "tilt_coupling", "mains_hum", "acceleration_gain", "acceleration_lag"],
];

/// Listed effects that make sense in a part of a run or in a region of state.
const LOCATED: [&str; 10] = [
    "coulomb_friction",
    "stribeck_friction",
    "viscous_friction",
    "valve_deadband",
    "asymmetric_gain",
    "null_bias",
    "acceleration_gain",
    "mains_hum",
    "leakage",
    "spring",
];

fn form(effect: &str, rng: &mut Stream) -> Ingredient {
    let all = forms::of(effect);
    Ingredient::Listed(all[rng.below(all.len())])
}

impl Chosen {
    /// Draws what case `number` of `seed` holds; unlisted kinds of the grammar follow from `lock`.
    pub fn draw((seed, number): (u64, u64), lock: u64, rng: &mut Stream) -> Self {
        let what = stratum(seed, number);
        let ids = forms::effects();
        let turn = turn(seed, number);
        let visible = |rng: &mut Stream| rng.log_uniform(4.0, 300.0);
        let list = match what {
            // What a tie holds is drawn with its test.
            Stratum::Null { .. } | Stratum::BadData | Stratum::Confounded => Vec::new(),
            Stratum::Single(effect, strength) => vec![(form(ids[effect % ids.len()], rng), target(strength, rng))],
            Stratum::Located => vec![(form(LOCATED[turn % LOCATED.len()], rng), visible(rng))],
            Stratum::Pair => pair(&ids, rng),
            Stratum::Triple => {
                let mut three = ids.clone();
                rng.shuffle(&mut three);
                three.iter().take(3).map(|id| (form(id, rng), rng.log_uniform(5.0, 150.0))).collect()
            }
            Stratum::Unlisted => vec![(unlisted(turn, lock), visible(rng))],
            Stratum::TwoUnlisted => {
                vec![(unlisted(2 * turn, lock), visible(rng)), (unlisted(2 * turn + 7, lock), visible(rng))]
            }
            Stratum::Mixed => {
                vec![(form(ids[rng.below(ids.len())], rng), visible(rng)), (unlisted(turn + 3, lock), visible(rng))]
            }
        };
        Self { what, list }
    }

    /// What it asks of the experiment.
    pub fn wish(&self, rng: &mut Stream) -> Wish {
        let any = |f: fn(&Needs) -> bool| self.list.iter().any(|(i, _)| f(&i.needs()));
        let kind = if any(|n| n.servo) || rng.chance(0.8) {
            Kind::Servo
        } else if rng.chance(0.5) {
            Kind::Rigid
        } else {
            Kind::Axis
        };
        Wish {
            kind,
            saturating: any(|n| n.saturation),
            accelerometer: any(|n| n.accelerometer) || self.what == Stratum::BadData,
            damping_known: any(|n| n.damping_known),
            perfect: match self.what {
                Stratum::Null { perfect } => perfect,
                // What is to be found there is one fault.
                Stratum::BadData => true,
                _ => rng.chance(0.1),
            },
            test: None,
        }
    }

    /// Whether the flaws came out as visible as was asked for: chi2 added in all, and by each beside the others.
    pub fn suits(&self, excess: f64, each: &[f64]) -> bool {
        match self.what {
            Stratum::Null { .. } | Stratum::BadData | Stratum::Confounded => true,
            Stratum::Single(_, strength) => Strength::of(1.0 + excess) == strength && excess > 5e-3,
            _ => excess > 1.0 && each.iter().all(|e| *e > 0.05),
        }
    }

    /// Where the one located flaw acts.
    pub fn gate(&self, scales: &Scales, rng: &mut Stream) -> Option<Gate> {
        (self.what == Stratum::Located).then(|| {
            if rng.chance(0.5) {
                let length = rng.uniform(0.15, 0.5) * scales.duration;
                let from = rng.uniform(0.1 * scales.duration, 0.95 * scales.duration - length);
                return Gate::Time { run: None, from, to: from + length };
            }
            let (variable, size) = match rng.below(4) {
                0 => (Variable::Displacement, scales.stroke),
                1 => (Variable::Velocity, scales.velocity),
                2 => (Variable::Command, scales.command),
                _ => (Variable::Speed, scales.velocity),
            };
            let (low, high) = if variable == Variable::Speed {
                if rng.chance(0.5) {
                    (-size, rng.uniform(0.15, 0.4) * size)
                } else {
                    (rng.uniform(0.25, 0.5) * size, 9.0 * size)
                }
            } else {
                match rng.below(4) {
                    0 => (rng.uniform(0.0, 0.3) * size, 9.0 * size),
                    1 => (-9.0 * size, rng.uniform(-0.3, 0.0) * size),
                    _ => {
                        let middle = rng.uniform(-0.3, 0.3) * size;
                        (middle - 0.2 * size, middle + 0.2 * size)
                    }
                }
            };
            Gate::State { variable, low, high, edge: 0.05 * size }
        })
    }
}

fn unlisted(turn: usize, lock: u64) -> Ingredient {
    let all = NAMED.len() + BUILT;
    // Every third is of the grammar, so that few cases hold both sorts.
    let index = turn * 13 % all;
    if index < NAMED.len() {
        Ingredient::Named(NAMED[index])
    } else {
        Ingredient::Built(Built::draw(lock, index - NAMED.len()))
    }
}

/// Any two: friction with payload, one family, a faint one beside a clear one, or just two.
fn pair(ids: &[&'static str], rng: &mut Stream) -> Vec<(Ingredient, f64)> {
    let sort = rng.unit();
    let (a, b) = if sort < 0.12 {
        (rng.pick(["coulomb_friction", "stribeck_friction", "viscous_friction"]), "payload_resonance")
    } else {
        let pool: &[&'static str] = if sort < 0.55 { FAMILIES[rng.below(FAMILIES.len())] } else { ids };
        let first = rng.below(pool.len());
        let second = (first + 1 + rng.below(pool.len() - 1)) % pool.len();
        (pool[first], pool[second])
    };
    let faint_beside_clear = rng.chance(0.3);
    let one = rng.log_uniform(5.0, 300.0);
    let other = if faint_beside_clear { rng.log_uniform(0.1, 4.0) } else { rng.log_uniform(5.0, 300.0) };
    vec![(form(a, rng), one), (form(b, rng), other)]
}
