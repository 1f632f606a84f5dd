//! The whole controller through [`script`](crate::script), under settings that leave no part out.

use crate::script::play;
use crate::tape::{hold, run};
use crate::tracking::full;
use shakedown_core::settings::{
    Detection, EnvelopeSettings, ForceSettings, Gains, GuardSettings, InnerLoop, ObserverSettings,
    PlausibilitySettings, RampSettings, ReferenceRates, TrackingSettings, ValveSettings, VelocitySource,
};
use shakedown_core::{Mode, Modification, Settings};

/// A test of 0.2 s ramps, told of saturation, its state watched.
fn guarded() -> Settings {
    let envelope = EnvelopeSettings { velocity: 0.5, ..EnvelopeSettings::default() };
    let ramps = RampSettings { test: 0.2, safe: 0.05 };
    Settings {
        displacement: Gains::new(6.0, 2.0),
        saturation: Some(Detection::default()),
        guard: Some(GuardSettings { envelope, ramps, ..GuardSettings::default() }),
        ..Settings::default()
    }
}

/// The same, minding only sensors that are lost and a table that leaves its stroke.
fn lenient() -> Settings {
    let mut settings = guarded();
    if let Some(guard) = &mut settings.guard {
        guard.envelope = EnvelopeSettings { velocity: 5.0, acceleration: 1e4, jerk: 1e7, ..guard.envelope };
        guard.plausibility.acceleration_noise = 1e3;
        (guard.plausibility.disagreement, guard.plausibility.offset) = (1.0, 1e3);
        guard.valve.mismatch = 1.0;
    }
    settings
}

/// The three loops, each with both gains.
fn loops() -> Settings {
    Settings {
        displacement: Gains::new(4.0, 3.0),
        velocity: Gains::new(0.6, 0.4),
        acceleration: Gains::new(0.05, 0.02),
        anti_windup: true,
        ..guarded()
    }
}

type Pair = (&'static str, Settings, Settings);

/// Every place in the valve command path, and from each to the next.
fn modes() -> Vec<Pair> {
    let guard = guarded();
    let bare = Settings { guard: None, ..guard };
    let mode = |settings: Settings, mode| Settings { mode, ..settings };
    let wired = Settings { inner_loop: InnerLoop::Hardwired, ..guard };
    let bias = ValveSettings { null_bias: 0.004, command_limit: 0.12, ..ValveSettings::default() };
    vec![
        ("plain", Settings::default(), bare),
        ("guarded controller", guard, mode(guard, Mode::Guard)),
        ("guard", mode(guard, Mode::Guard), mode(guard, Mode::Modifier)),
        ("modifier", mode(guard, Mode::Modifier), guard),
        ("bare guard", mode(bare, Mode::Guard), Settings { velocity_limit: 0.2, ..mode(bare, Mode::Guard) }),
        ("bare modifier", mode(bare, Mode::Modifier), mode(guard, Mode::Modifier)),
        ("hard-wired", wired, Settings { blend: 0.0, ..guard }),
        ("biased and limited", Settings { valve: bias, ..guard }, Settings { valve: bias, saturation: None, ..guard }),
        ("biased guard", Settings { valve: bias, ..mode(wired, Mode::Guard) }, wired),
        ("guard that detects nothing", Settings { saturation: None, ..mode(guard, Mode::Guard) }, bare),
    ]
}

/// Every source of a rate, every part left out.
fn parts() -> Vec<Pair> {
    let rates = |reference_rates| Settings { reference_rates, ..loops() };
    let sensor = Settings { velocity_source: VelocitySource::Sensor, ..loops() };
    let deaf = ObserverSettings { accelerometer: false, smoothing: 0.0, ..ObserverSettings::default() };
    let blind = Settings { observer: deaf, acceleration: Gains::default(), guard: lenient().guard, ..loops() };
    let force = |limit| Some(ForceSettings { limit, piston_area: 0.01 });
    let (mut forced, mut overpowered) = (guarded(), guarded());
    let mut patient = Settings { mode: Mode::Guard, ..guarded() };
    if let (Some(strong), Some(weak), Some(slow)) = (&mut forced.guard, &mut overpowered.guard, &mut patient.guard) {
        (strong.envelope.force, weak.envelope.force) = (force(3e4), force(4e3));
        slow.plausibility = PlausibilitySettings { lost: 0.5, ..slow.plausibility };
    }
    let limited = ValveSettings { command_limit: 0.06, ..ValveSettings::default() };
    let unguarded = Settings { guard: None, saturation: None, ..loops() };
    vec![
        ("three loops", loops(), rates(ReferenceRates::Zero)),
        ("derived rates", rates(ReferenceRates::Derived { frequency: 40.0 }), loops()),
        ("supplied rates", rates(ReferenceRates::Supplied), rates(ReferenceRates::Derived { frequency: 40.0 })),
        ("no rates", rates(ReferenceRates::Zero), sensor),
        ("velocity sensor", sensor, loops()),
        ("no accelerometer", blind, Settings { mode: Mode::Guard, ..blind }),
        ("force", forced, guarded()),
        ("too much force", overpowered, guarded()),
        ("patient guard", patient, Settings { mode: Mode::Guard, ..forced }),
        ("loops alone", unguarded, Settings { velocity: Gains::default(), ..unguarded }),
        ("sensor alone", Settings { guard: None, saturation: None, ..sensor }, unguarded),
        ("limited loops", Settings { valve: limited, ..loops() }, loops()),
        ("wound up", Settings { anti_windup: false, ..loops() }, loops()),
    ]
}

/// The tracking law, and the modifiers in front of it and of the loops.
fn laws() -> Vec<Pair> {
    let tracking = |law| Settings { tracking: Some(law), ..lenient() };
    let plain = tracking(TrackingSettings::default());
    let modified = |settings: Settings, modification| Settings { modification, ..settings };
    let slow = |settings: Settings| Settings { velocity_limit: 0.15, ..settings };
    let bare = Settings { guard: None, ..tracking(full()) };
    let preview = Modification::Preview { seconds: 0.1 };
    let in_front = Settings { mode: Mode::Modifier, ..guarded() };
    vec![
        ("tracking", plain, lenient()),
        ("tracking that is doubted", Settings { guard: guarded().guard, ..plain }, guarded()),
        ("tracking everything", tracking(full()), plain),
        ("tracking, bare", bare, plain),
        ("clip", modified(guarded(), Modification::Clip), modified(slow(guarded()), Modification::Clip)),
        ("causal", modified(plain, Modification::Causal), modified(slow(plain), Modification::Causal)),
        ("preview", modified(plain, preview), modified(plain, Modification::Causal)),
        ("clip in front", modified(in_front, Modification::Clip), modified(in_front, preview)),
        ("causal in front", modified(in_front, Modification::Causal), in_front),
        ("preview in front", modified(in_front, preview), slow(modified(in_front, preview))),
    ]
}

fn hold_all(group: &str, pairs: &[Pair]) {
    let runs: Vec<_> =
        pairs.iter().map(|(name, settings, other)| run(name, |tape| play(tape, settings, other))).collect();
    hold(group, &runs);
}

#[test]
fn controller_in_every_mode() {
    hold_all("modes", &modes());
}

#[test]
fn controller_of_every_part() {
    hold_all("parts", &parts());
}

#[test]
fn controller_with_every_law() {
    hold_all("laws", &laws());
}
