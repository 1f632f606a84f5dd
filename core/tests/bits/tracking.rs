//! The tracking law as a whole, and what it keeps when another takes over.

use crate::tape::{Noise, Tape, hold, run, signal};
use shakedown_core::blocks::tracking::{Surroundings, Tracking, TrackingInput, TrackingState};
use shakedown_core::settings::{
    FlowSettings, FrictionSettings, NotchSettings, OilSettings, PressureSettings, TrackingSettings,
};

const DT: f32 = 1e-3;

/// Everything that the law can have.
pub(crate) fn full() -> TrackingSettings {
    TrackingSettings {
        delay: 0.003,
        flow: FlowSettings { sharpness: 3.0, droop: 0.3, recovery: 2.0, stall: 30.0, ..FlowSettings::default() },
        friction: FrictionSettings { coulomb: 0.3, viscous: 1.0, velocity: 0.01, deadband: 0.002 },
        oil: Some(OilSettings { frequency: 12.0, damping: 0.05 }),
        pressure: Some(PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 }),
        notch: Some(NotchSettings { frequency: 30.0, damping: 0.2 }),
        ..TrackingSettings::default()
    }
}

fn law(settings: &TrackingSettings) -> Tracking {
    let valve = [138.0 / 57.65, 1.0 / 57.65];
    settings.law(&Surroundings { dt: DT, valve, command_limit: 0.3, velocity_limit: 0.242 }).unwrap()
}

/// `first` for a third of the run, then `second` with the state that it left.
fn course(first: TrackingSettings, second: TrackingSettings) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let (first, second) = (law(&first), law(&second));
        tape.count(first.lag());
        tape.count(second.lag());
        let mut state = TrackingState::at(0.01);
        let mut noise = Noise::new(61);
        let mut displacement = 0.01;
        for (k, x) in signal(67, 0.002, 1200).enumerate() {
            let reference = 0.01 + 0.04 * libm::sinf(k as f32 * 0.006) + if k % 5 == 0 { x } else { 0.0 };
            displacement += 0.02 * (reference - displacement) + 1e-5 * noise.next();
            let pressure_difference = 1e5 * noise.next();
            let seen = TrackingInput { reference, displacement, acceleration: noise.next(), pressure_difference };
            if k == 400 || k == 700 {
                (if k == 400 { &second } else { &first }).adapt_state(&mut state);
            }
            let now = if (400..700).contains(&k) { &second } else { &first };
            tape.note(now.advance(&mut state, &seen));
        }
    }
}

#[test]
fn tracking() {
    let plain = TrackingSettings::default();
    let bare = TrackingSettings { disturbance: 0.0, bandwidth: 0.0, ..plain };
    let fast = TrackingSettings { bandwidth: 20.0, disturbance: 80.0, spacing: 0.004, ..plain };
    let late = TrackingSettings { delay: 0.015, spacing: 0.001, ..plain };
    let soft = TrackingSettings { bandwidth: 25.0, disturbance: 10.0, ..full() };
    let no_feedback = TrackingSettings { bandwidth: 0.0, ..full() };
    hold(
        "tracking",
        &[
            run("plain, then fast", course(plain, fast)),
            run("bare, then plain", course(bare, plain)),
            run("late, then plain", course(late, plain)),
            run("full, then softer", course(full(), soft)),
            run("full, without feedback between", course(full(), no_feedback)),
            run("stiff, then compliant", course(plain, full())),
        ],
    );
}
