//! A case from seed and number: scene, flaw at its strength, recordings, sealed answer.

use crate::answer::{Answer, Fault, Sealed, TrueEffect};
use crate::closed_loop::{Traces, simulate};
use crate::confounded;
use crate::corrupt::Corruption;
use crate::effect::{Draw, Effect};
use crate::noise::Noise;
use crate::plan::{Stratum, Strength, stratum, turn};
use crate::plant::Physics;
use crate::rng::Stream;
use crate::scene::{Kind, Scene, Size, Wish};
use crate::sheet::{Layout, Sheet, Sheets};
use crate::strength::{Sized, measure, seek};
use crate::unlisted::Unlisted;
use std::path::Path;

/// One concealed case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Its number within the seed.
    pub number: u64,
    /// A name that tells nothing: `case-0042`.
    pub name: String,
    /// The experiment as its author hands it over.
    pub experiment: Sheets,
    /// The answer.
    pub sealed: Sealed,
}

impl Case {
    /// Writes the experiment into `folder`: `experiment.toml` and the recordings, nothing of the answer.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        self.experiment.write(folder)
    }
}

/// The first `count` cases of a seed, made one after another as they are asked for.
pub fn cases(seed: u64, count: u64) -> impl Iterator<Item = Case> {
    (0..count).map(move |number| case(seed, number))
}

/// A flaw found at its strength.
struct Flawed {
    physics: Physics,
    sized: Sized,
    effects: Vec<TrueEffect>,
    unlisted: Option<Unlisted>,
    group: Vec<&'static str>,
}

/// Case `number` of `seed`: always the same.
pub fn case(seed: u64, number: u64) -> Case {
    let what = stratum(seed, number);
    let mut nearest: Option<(Scene, Flawed)> = None;
    for attempt in 0..ATTEMPTS {
        let mut rng = Stream::new(seed, number, 0x6361_7365 + attempt);
        let unlisted =
            (what == Stratum::Unlisted).then(|| Unlisted::ALL[turn(seed, number) as usize % Unlisted::ALL.len()]);
        let (wish, pair) = wish(what, unlisted, &mut rng);
        let scene = Scene::draw(wish, number, &mut rng);
        if let Some(flawed) = flaw(&scene, what, pair, unlisted, &mut rng) {
            let met = suits(what, &flawed);
            nearest = Some((scene, flawed));
            if met {
                break;
            }
        }
    }
    let (scene, flawed) = nearest.unwrap_or_else(|| plain_null(seed, number));
    finish(seed, number, what, &scene, flawed)
}

const ATTEMPTS: u64 = 8;

/// A scene in which nothing is missing always works, whatever else failed to.
fn plain_null(seed: u64, number: u64) -> (Scene, Flawed) {
    let mut rng = Stream::new(seed, number, 0x6e75_6c6c);
    let scene = Scene::draw(Wish::plain(Kind::Servo), number, &mut rng);
    let physics = Physics::baseline(scene.truth);
    let traces = vec![Traces::default(); scene.runs.len()];
    let refit = crate::refit::Refit { machine: scene.truth, offset: 0.0 };
    let sized = measure(&scene, &physics).unwrap_or(Sized { traces, refit, excess: 0.0 });
    (scene, Flawed { physics, sized, effects: Vec::new(), unlisted: None, group: Vec::new() })
}

fn kind(suits_rigid: bool, suits_axis: bool, share: f64, rng: &mut Stream) -> Kind {
    if suits_rigid && rng.chance(share) {
        return if suits_axis && rng.chance(0.5) { Kind::Axis } else { Kind::Rigid };
    }
    Kind::Servo
}

fn size(saturating: bool) -> Size {
    if saturating { Size::Saturating } else { Size::Any }
}

fn wish(what: Stratum, unlisted: Option<Unlisted>, rng: &mut Stream) -> (Wish, Option<(Effect, Effect)>) {
    match what {
        Stratum::Null => (Wish::plain(kind(true, true, 0.25, rng)), None),
        Stratum::Single(effect, strength) => {
            let axis = !matches!(effect, Effect::ValveLag | Effect::CommandDelay | Effect::DisplacementLag);
            let wish = Wish {
                kind: kind(effect.suits_rigid(), axis, 0.15, rng),
                size: size(effect.needs_saturation()),
                accelerometer: effect.needs_accelerometer(),
                damping_known: effect == Effect::ViscousFriction,
                quiet: strength != Strength::Faint && effect.needs_accelerometer(),
            };
            (wish, None)
        }
        Stratum::Pair => {
            let pair = pair(rng);
            let any = |f: fn(Effect) -> bool| f(pair.0) || f(pair.1);
            let wish = Wish {
                size: size(any(Effect::needs_saturation)),
                damping_known: any(|e| e == Effect::ViscousFriction),
                ..Wish::plain(Kind::Servo)
            };
            (wish, Some(pair))
        }
        Stratum::Unlisted => {
            let flaw = unlisted.unwrap_or(Unlisted::QuadraticDrag);
            let rigid = matches!(flaw, Unlisted::RoughPatch | Unlisted::RipplePerDistance | Unlisted::QuadraticDrag);
            let wish = Wish {
                size: size(flaw.needs_saturation()),
                quiet: flaw.needs_accelerometer(),
                ..Wish::plain(kind(rigid, false, 0.2, rng))
            };
            (wish, None)
        }
        Stratum::Confounded => (Wish { size: Size::Slow, ..Wish::plain(Kind::Servo) }, None),
        Stratum::BadData => (Wish::plain(Kind::Servo), None),
    }
}

/// Two effects that do not act at the same place.
fn pair(rng: &mut Stream) -> (Effect, Effect) {
    const ALIKE: [&[Effect]; 4] = [
        &[
            Effect::CommandDelay,
            Effect::ValveLag,
            Effect::DisplacementLag,
            Effect::AccelerationLag,
            Effect::Leakage,
            Effect::OilCompliance,
        ],
        &[Effect::ValveDeadband, Effect::CoulombFriction, Effect::StribeckFriction],
        &[
            Effect::FlowSoftening,
            Effect::AsymmetricLimit,
            Effect::SupplyDroop,
            Effect::LoadDependentFlow,
            Effect::ValveRateLimit,
        ],
        &[Effect::DisplacementNonlinearity, Effect::GainDrift, Effect::AccelerationGain],
    ];
    loop {
        let a = Effect::ALL[rng.below(Effect::ALL.len())];
        let b = Effect::ALL[rng.below(Effect::ALL.len())];
        let alike = ALIKE.iter().any(|family| family.contains(&a) && family.contains(&b));
        if a != b && !alike && !(a.acts_at_actuator() && b.acts_at_actuator()) {
            return (a, b);
        }
    }
}

fn flaw(
    scene: &Scene,
    what: Stratum,
    pair: Option<(Effect, Effect)>,
    unlisted: Option<Unlisted>,
    rng: &mut Stream,
) -> Option<Flawed> {
    let draw = Draw::new(rng);
    match (what, pair, unlisted) {
        (Stratum::Single(effect, strength), ..) => single(scene, effect, &draw, strength.target(rng)),
        (Stratum::Pair, Some((a, b)), _) => double(scene, a, b, rng),
        (Stratum::Unlisted, _, Some(kind)) => {
            let target = rng.log_uniform(6.0, 400.0);
            let apply = |s: f64, physics: &mut Physics| kind.apply(s, &draw, &scene.scales, physics);
            let (strength, sized) = seek(scene, target, &apply)?;
            let mut physics = Physics::baseline(scene.truth);
            apply(strength, &mut physics);
            Some(Flawed { physics, sized, effects: Vec::new(), unlisted: Some(kind), group: Vec::new() })
        }
        (Stratum::Confounded, ..) => {
            let found = confounded::find(scene, &draw, rng)?;
            let mut physics = Physics::baseline(scene.truth);
            let parameters = found.effect.apply(found.strength, &draw, &scene.scales, &mut physics);
            let effects = vec![TrueEffect { id: found.effect.id(), parameters }];
            let group = found.members.iter().map(|e| e.id()).collect();
            Some(Flawed { physics, sized: found.sized, effects, unlisted: None, group })
        }
        _ => {
            let physics = Physics::baseline(scene.truth);
            let sized = measure(scene, &physics)?;
            Some(Flawed { physics, sized, effects: Vec::new(), unlisted: None, group: Vec::new() })
        }
    }
}

fn single(scene: &Scene, effect: Effect, draw: &Draw, target: f64) -> Option<Flawed> {
    let apply = |s: f64, physics: &mut Physics| {
        effect.apply(s, draw, &scene.scales, physics);
    };
    let (strength, sized) = seek(scene, target, &apply)?;
    let mut physics = Physics::baseline(scene.truth);
    let parameters = effect.apply(strength, draw, &scene.scales, &mut physics);
    let effects = vec![TrueEffect { id: effect.id(), parameters }];
    Some(Flawed { physics, sized, effects, unlisted: None, group: Vec::new() })
}

/// Each effect at a strength that is clear by itself, then both at once.
fn double(scene: &Scene, a: Effect, b: Effect, rng: &mut Stream) -> Option<Flawed> {
    let mut physics = Physics::baseline(scene.truth);
    let mut effects = Vec::new();
    for effect in [a, b] {
        let draw = Draw::new(rng);
        let target = rng.log_uniform(8.0, 80.0);
        let alone = |s: f64, physics: &mut Physics| {
            effect.apply(s, &draw, &scene.scales, physics);
        };
        let (strength, sized) = seek(scene, target, &alone)?;
        if sized.excess < 4.0 {
            return None;
        }
        let parameters = effect.apply(strength, &draw, &scene.scales, &mut physics);
        effects.push(TrueEffect { id: effect.id(), parameters });
    }
    let sized = measure(scene, &physics)?;
    Some(Flawed { physics, sized, effects, unlisted: None, group: Vec::new() })
}

/// Whether the flaw came out as visible as was asked for.
fn suits(what: Stratum, flawed: &Flawed) -> bool {
    let excess = flawed.sized.excess;
    match what {
        Stratum::Single(_, strength) => Strength::of(1.0 + excess) == strength && excess > 0.01,
        Stratum::Unlisted => excess > 5.0,
        _ => true,
    }
}

fn finish(seed: u64, number: u64, what: Stratum, scene: &Scene, flawed: Flawed) -> Case {
    let mut rng = Stream::new(seed, number, 0x6669_6e69);
    let name = format!("case-{number:04}");
    let layout = layout(scene, &flawed, &mut rng);
    let columns = layout.columns();
    let noisy: Vec<Traces> = scene
        .runs
        .iter()
        .zip(&flawed.sized.traces)
        .map(|(run, clean)| simulate(&flawed.physics, run, Some(&scene.noise)).unwrap_or_else(|| clean.clone()))
        .collect();
    let mut experiment = sheets(&name, scene, &layout, &columns, &noisy, || rng.normal());
    let mut clean = sheets(&name, scene, &layout, &columns, &flawed.sized.traces, || 0.0);
    clean.effects = flawed.effects.iter().map(|e| e.id).collect();
    let fault = (what == Stratum::BadData).then(|| {
        let kind = Corruption::ALL[turn(seed, number) as usize % Corruption::ALL.len()];
        kind.spoil(&mut experiment, &mut rng)
    });
    let answer = answer(seed, number, what, scene, flawed, fault);
    let mut salt = [0; 32];
    for chunk in salt.chunks_mut(8) {
        chunk.copy_from_slice(&rng.bits().to_le_bytes());
    }
    Case { number, name, experiment, sealed: Sealed::new(answer, clean, salt) }
}

fn layout(scene: &Scene, flawed: &Flawed, rng: &mut Stream) -> Layout {
    let laboratory_units = rng.chance(0.4);
    // Backlash and a moving base part the table from the actuator: the pressure is then no simple sum.
    let parted = flawed.physics.base.is_some() || flawed.physics.table.backlash.is_some();
    let scale = rng.log_uniform(0.1, 0.4);
    let offset = rng.uniform(-0.3, 0.3);
    let noise = rng.uniform(0.05, 0.2);
    let pressure = (scene.pressures.0 && !parted).then_some((scale, offset, noise));
    let supply = scene.pressures.1.then(|| (10.0 * rng.uniform(14.0, 28.0)).round() / 10.0);
    let command_unit = match scene.kind {
        Kind::Servo => "1",
        Kind::Rigid => "N",
        Kind::Axis => "V",
    };
    Layout { laboratory_units, sigma: scene.sigma, command_unit, pressure, supply }
}

fn sheets(
    name: &str,
    scene: &Scene,
    layout: &Layout,
    columns: &[crate::sheet::Column],
    traces: &[Traces],
    mut jitter: impl FnMut() -> f64,
) -> Sheets {
    let last = scene.fit_runs();
    let list = scene.runs.iter().zip(traces).enumerate().map(|(i, (run, traces))| Sheet {
        file: format!("run-{}.csv", i + 1),
        values: layout.values(columns, run, traces, &mut jitter),
        controller: run.controller,
        holdout: i == last,
    });
    Sheets {
        name: name.to_string(),
        machine: scene.stated,
        fit: scene.fit.clone(),
        effects: Vec::new(),
        columns: columns.to_vec(),
        sheets: list.collect(),
    }
}

fn answer(seed: u64, number: u64, what: Stratum, scene: &Scene, flawed: Flawed, fault: Option<Fault>) -> Answer {
    let Noise { hum, .. } = scene.noise;
    let mut tolerated = flawed.unlisted.map_or(Vec::new(), |u| u.tolerated().to_vec());
    // A background hum below the noise is there: to name it is no wrong name.
    if hum.is_some() {
        tolerated.push(Effect::MainsHum.id());
    }
    // Where nothing could be made as asked for, the case is a null and says so.
    let failed = flawed.effects.is_empty() && flawed.unlisted.is_none() && fault.is_none();
    Answer {
        case: (seed, number),
        stratum: if failed { Stratum::Null } else { what },
        machine: match scene.kind {
            Kind::Servo => "servo",
            Kind::Rigid => "rigid",
            Kind::Axis => "axis",
        },
        model: scene.truth.parameters(),
        effects: flawed.effects,
        unlisted: flawed.unlisted.map(Unlisted::name),
        groups: if flawed.group.is_empty() { Vec::new() } else { vec![flawed.group] },
        tolerated,
        fault,
        bad_data_accepted: flawed.unlisted.is_some_and(Unlisted::may_be_bad_data),
        baseline_chi2: 1.0 + flawed.sized.excess,
    }
}
