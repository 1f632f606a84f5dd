//! A case from seed and number: experiment, flaws at their strengths, recordings, sealed answer.

use super::answer::{Answer, Present, Sealed};
use super::engine::simulate;
use super::forms::{self, Dial, Form};
use super::law::Place;
use super::measure::{Frame, seek};
use super::plan::{Stratum, stratum, target};
use super::plant::Plant;
use super::scene::{Kind, Scene, Wish};
use super::sheet::{Pressures, Rows, Sheets};
use crate::closed_loop::Traces;
use crate::effect::Draw;
use crate::plan::Strength;
use crate::rng::Stream;
use std::path::Path;

/// One concealed case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its number within the seed.
    pub number: u64,
    /// A name that tells nothing.
    pub name: String,
    /// The experiment as its author hands it over.
    pub experiment: Sheets,
    /// The answer.
    pub sealed: Sealed,
}

impl Case {
    /// Writes the experiment into `folder`, nothing of the answer.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        self.experiment.write(folder)
    }
}

/// The first `count` cases of a seed, made one after another as they are asked for.
pub fn cases(seed: u64, count: u64) -> impl Iterator<Item = Case> {
    (0..count).map(move |number| case(seed, number))
}

/// A plant with its flaws, and what the answer says of them.
struct Flawed {
    plant: Plant,
    effects: Vec<Present>,
    unlisted: Vec<Present>,
    alike: Option<f64>,
    excess: f64,
}

const ATTEMPTS: u64 = 8;

/// Case `number` of `seed`: always the same.
pub fn case(seed: u64, number: u64) -> Case {
    let what = stratum(seed, number);
    let mut nearest: Option<(Scene, Flawed)> = None;
    for attempt in 0..ATTEMPTS {
        let mut rng = Stream::new(seed, number, 0x6c61_6263_6173 + attempt);
        let chosen = Chosen::draw(what, number, &mut rng);
        let Some(scene) = Scene::draw(chosen.wish(&mut rng), (seed, number), &mut rng) else { continue };
        let frame = Frame::new(&scene);
        if let Some(flawed) = flaw(&scene, &frame, &chosen, &mut rng) {
            let met = chosen.suits(&flawed);
            nearest = Some((scene, flawed));
            if met {
                break;
            }
        }
    }
    let (scene, flawed) = nearest.unwrap_or_else(|| plain(seed, number));
    finish(seed, number, what, &scene, flawed)
}

/// What a case is to hold.
struct Chosen {
    what: Stratum,
    forms: Vec<Form>,
}

impl Chosen {
    fn draw(what: Stratum, number: u64, rng: &mut Stream) -> Self {
        let forms = match what {
            Stratum::Null { .. } => Vec::new(),
            Stratum::Single(effect, _) => {
                let ids = forms::effects();
                let all = forms::of(ids[effect % ids.len()]);
                // Forms take turns from cycle to cycle and from strength to strength.
                let turn = (number / super::plan::cycle()) as usize + rng.below(all.len());
                vec![all[turn % all.len()]]
            }
        };
        Self { what, forms }
    }

    fn wish(&self, rng: &mut Stream) -> Wish {
        let any = |f: fn(&Form) -> bool| self.forms.iter().any(f);
        let kind = if any(|f| f.needs.servo) || rng.chance(0.8) {
            Kind::Servo
        } else if rng.chance(0.5) {
            Kind::Rigid
        } else {
            Kind::Axis
        };
        Wish {
            kind,
            saturating: any(|f| f.needs.saturation),
            accelerometer: any(|f| f.needs.accelerometer),
            damping_known: any(|f| f.needs.damping_known),
            perfect: match self.what {
                Stratum::Null { perfect } => perfect,
                Stratum::Single(..) => rng.chance(0.1),
            },
        }
    }

    fn suits(&self, flawed: &Flawed) -> bool {
        match self.what {
            Stratum::Null { .. } => true,
            Stratum::Single(_, strength) => Strength::of(1.0 + flawed.excess) == strength && flawed.excess > 5e-3,
        }
    }
}

fn flaw(scene: &Scene, frame: &Frame, chosen: &Chosen, rng: &mut Stream) -> Option<Flawed> {
    let baseline = Plant::baseline(scene.truth);
    match chosen.what {
        Stratum::Null { .. } => {
            Some(Flawed { plant: baseline, effects: Vec::new(), unlisted: Vec::new(), alike: None, excess: 0.0 })
        }
        Stratum::Single(_, strength) => {
            let form = chosen.forms.first()?;
            let dial = Dial { s: 0.0, draw: Draw::new(rng), scales: scene.scales };
            let target = target(strength, rng);
            let build = |s: f64| {
                let mut plant = baseline.clone();
                (form.build)(&mut plant, &Dial { s, ..dial });
                plant
            };
            let (s, visible) = seek(frame, target, &build)?;
            let mut plant = baseline.clone();
            let parameters = (form.build)(&mut plant, &Dial { s, ..dial });
            let excess = frame.refitted(&frame.deviation(&plant)?);
            let effect = Present {
                id: form.effect.into(),
                form: form.name.into(),
                source: form.source.into(),
                parameters,
                block: block(&plant, &baseline),
                gate: None,
                excess: visible.excess,
                sigma: visible.sigma,
            };
            Some(Flawed { plant, effects: vec![effect], unlisted: Vec::new(), alike: None, excess })
        }
    }
}

fn block(plant: &Plant, before: &Plant) -> &'static str {
    plant
        .places_since(before)
        .first()
        .map_or(if plant.delay.0 > 0.0 { "command" } else { "actuator" }, |p: &Place| p.block())
}

/// An experiment in which nothing is missing, when everything else failed.
fn plain(seed: u64, number: u64) -> (Scene, Flawed) {
    let wish = Wish { kind: Kind::Servo, saturating: false, accelerometer: true, damping_known: false, perfect: true };
    let mut attempt = 0;
    loop {
        let mut rng = Stream::new(seed, number, 0x6c61_626e_756c + attempt);
        attempt += 1;
        if let Some(scene) = Scene::draw(wish, (seed, number), &mut rng) {
            let plant = Plant::baseline(scene.truth);
            return (scene, Flawed { plant, effects: Vec::new(), unlisted: Vec::new(), alike: None, excess: 0.0 });
        }
    }
}

fn finish(seed: u64, number: u64, what: Stratum, scene: &Scene, flawed: Flawed) -> Case {
    let mut rng = Stream::new(seed, number, 0x6c61_6266_696e);
    let name = format!("case-{number:04}");
    let pressures = pressures(scene, &flawed.plant, &mut rng);
    let traces = |noisy: bool| -> Vec<Traces> {
        let sensor = noisy.then_some(&scene.sensor);
        scene.runs.iter().map(|run| simulate(&flawed.plant, run, sensor).unwrap_or_default()).collect()
    };
    let mut sheets = |clean: bool| {
        let rows = Rows { scene, pressures, clean };
        let columns = rows.columns();
        let made = traces(!clean);
        Sheets {
            name: name.clone(),
            machine: scene.stated,
            fit: scene.fit.clone(),
            effects: if clean { flawed.effects.iter().map(|e| e.id.clone()).collect() } else { Vec::new() },
            sheets: made.iter().enumerate().map(|(i, t)| rows.sheet(i, &columns, t, &mut rng)).collect(),
            columns,
        }
    };
    let experiment = sheets(false);
    let clean = sheets(true);
    let mut salt = [0; 32];
    for chunk in salt.chunks_mut(8) {
        chunk.copy_from_slice(&rng.bits().to_le_bytes());
    }
    let answer = answer(seed, number, what, scene, flawed);
    Case { number, name, experiment, sealed: Sealed::new(answer, clean, salt) }
}

fn pressures(scene: &Scene, plant: &Plant, rng: &mut Stream) -> Pressures {
    let (load, supply) = scene.says.pressures;
    let size = scene.scales.acceleration;
    let scale = rng.log_uniform(0.5, 3.0) / size;
    let load = (load && !plant.parts_table())
        .then(|| (scale, rng.uniform(-0.05, 0.05) * size, rng.uniform(0.01, 0.05) * size));
    Pressures { load, supply: supply.then(|| (10.0 * rng.uniform(14.0, 28.0)).round() / 10.0) }
}

fn answer(seed: u64, number: u64, what: Stratum, scene: &Scene, flawed: Flawed) -> Answer {
    let empty = flawed.effects.is_empty() && flawed.unlisted.is_empty();
    let mut tolerated: Vec<&'static str> = scene.misstated.iter().flat_map(|m| m.tolerated.iter().copied()).collect();
    tolerated.sort_unstable();
    tolerated.dedup();
    Answer {
        case: (seed, number),
        stratum: if empty { "null" } else { what.name() },
        machine: match scene.kind {
            Kind::Servo => "servo",
            Kind::Rigid => "rigid",
            Kind::Axis => "axis",
        },
        model: scene.truth.parameters(),
        effects: flawed.effects,
        unlisted: flawed.unlisted,
        groups: Vec::new(),
        tolerated,
        perfect: scene.misstated.iter().all(|m| m.kind == "noise estimated"),
        misstated: scene.misstated.clone(),
        noise: (scene.sigma.displacement, scene.sigma.acceleration),
        alike: flawed.alike,
        baseline_chi2: 1.0 + flawed.excess,
    }
}
