//! A case from seed and number: experiment, flaws at their strengths, recordings, sealed answer.

use super::answer::{Answer, Sealed};
use super::choose::Chosen;
use super::corrupt::Corruption;
use super::engine::simulate;
use super::flaw::{Flawed, flaw, weighed};
use super::measure::Frame;
use super::plan::{Stratum, stratum, turn};
use super::plant::Plant;
use super::region::quantiles;
use super::scene::{Kind, Scene, Wish};
use super::sheet::{Pressures, Rows, Sheets};
use super::ties;
use crate::answer::Fault;
use crate::closed_loop::Traces;
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

const ATTEMPTS: u64 = 8;

/// The lock of the grammar while the diagnosis is developed; a campaign draws another one when it is frozen.
pub const DEVELOPMENT: u64 = 0;

/// Case `number` of `seed` with the grammar's kinds of the development: always the same.
pub fn case(seed: u64, number: u64) -> Case {
    locked(seed, number, DEVELOPMENT)
}

/// Case `number` of `seed` with the grammar's kinds of `lock`: always the same.
pub fn locked(seed: u64, number: u64, lock: u64) -> Case {
    let what = stratum(seed, number);
    let dealt = if what == Stratum::Confounded { ties::deal(seed, number) } else { flawed(seed, number, lock) };
    let (scene, flawed) = dealt.unwrap_or_else(|| plain(seed, number));
    finish((seed, number, lock), what, &scene, flawed)
}

/// An experiment with the flaws of its stratum, as near to what was asked for as a few attempts came.
fn flawed(seed: u64, number: u64, lock: u64) -> Option<(Scene, Flawed)> {
    let mut nearest: Option<(Scene, Flawed)> = None;
    for attempt in 0..ATTEMPTS {
        let mut rng = Stream::new(seed, number, 0x6c61_6263_6173 + attempt);
        let chosen = Chosen::draw((seed, number), lock, &mut rng);
        let Some(scene) = Scene::draw(chosen.wish(&mut rng), (seed, number), &mut rng) else { continue };
        let frame = Frame::new(&scene);
        if let Some(flawed) = flaw(&scene, &frame, &chosen, &mut rng) {
            let each: Vec<f64> = flawed.effects.iter().chain(&flawed.unlisted).map(|p| p.excess).collect();
            let met = chosen.suits(flawed.excess, &each);
            nearest = Some((scene, flawed));
            if met {
                break;
            }
        }
    }
    nearest.map(|(scene, flawed)| weighed(scene, flawed))
}

/// An experiment in which nothing is missing, when everything else failed.
fn plain(seed: u64, number: u64) -> (Scene, Flawed) {
    let wish = Wish {
        kind: Kind::Servo,
        saturating: false,
        accelerometer: true,
        damping_known: false,
        perfect: true,
        test: None,
    };
    let mut attempt = 0;
    loop {
        let mut rng = Stream::new(seed, number, 0x6c61_626e_756c + attempt);
        attempt += 1;
        if let Some(scene) = Scene::draw(wish, (seed, number), &mut rng) {
            let plant = Plant::baseline(scene.truth);
            return (scene, Flawed::none(plant));
        }
    }
}

fn finish((seed, number, lock): (u64, u64, u64), what: Stratum, scene: &Scene, flawed: Flawed) -> Case {
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
    let mut experiment = sheets(false);
    let clean = sheets(true);
    let fault = if what == Stratum::BadData { spoil(&mut experiment, turn(seed, number), &mut rng) } else { None };
    let mut salt = [0; 32];
    for chunk in salt.chunks_mut(8) {
        chunk.copy_from_slice(&rng.bits().to_le_bytes());
    }
    let answer = Answer { fault, ..answer((seed, number, lock), what, scene, flawed) };
    Case { number, name, experiment, sealed: Sealed::new(answer, clean, salt) }
}

/// Spoils a sound experiment in the way whose turn it is, or in the next that it has the channels for.
fn spoil(experiment: &mut Sheets, turn: usize, rng: &mut Stream) -> Option<Fault> {
    let n = Corruption::ALL.len();
    (turn..turn + n).find_map(|i| Corruption::ALL[i % n].spoil(experiment, rng))
}

fn pressures(scene: &Scene, plant: &Plant, rng: &mut Stream) -> Pressures {
    let (load, supply) = scene.says.pressures;
    let size = scene.scales.acceleration;
    let scale = rng.log_uniform(0.5, 3.0) / size;
    let load = (load && !plant.parts_table())
        .then(|| (scale, rng.uniform(-0.05, 0.05) * size, rng.uniform(0.01, 0.05) * size));
    Pressures { load, supply: supply.then(|| (10.0 * rng.uniform(14.0, 28.0)).round() / 10.0) }
}

fn answer((seed, number, lock): (u64, u64, u64), what: Stratum, scene: &Scene, flawed: Flawed) -> Answer {
    let empty = flawed.effects.is_empty() && flawed.unlisted.is_empty();
    let mut tolerated: Vec<&'static str> = scene.misstated.iter().flat_map(|m| m.tolerated.iter().copied()).collect();
    tolerated.extend(flawed.effects.iter().chain(&flawed.unlisted).flat_map(|p| p.tolerated.iter().copied()));
    tolerated.sort_unstable();
    tolerated.dedup();
    Answer {
        quantiles: quantiles(scene, flawed.effects.iter().find_map(|p| p.gate)),
        case: (seed, number),
        lock,
        stratum: match what {
            Stratum::BadData => what.name(),
            _ if empty => "null",
            Stratum::Confounded if flawed.groups.is_empty() => "single",
            _ => what.name(),
        },
        fault: None,
        machine: match scene.kind {
            Kind::Servo => "servo",
            Kind::Rigid => "rigid",
            Kind::Axis => "axis",
        },
        model: scene.truth.parameters(),
        effects: flawed.effects,
        unlisted: flawed.unlisted,
        groups: flawed.groups,
        tolerated,
        perfect: scene.misstated.iter().all(|m| m.kind == "noise estimated"),
        misstated: scene.misstated.clone(),
        noise: (scene.sigma.displacement, scene.sigma.acceleration),
        alike: flawed.alike,
        tie: flawed.tie,
        baseline_chi2: 1.0 + flawed.excess,
    }
}
