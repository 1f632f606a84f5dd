//! The tracking law: each part against its closed form, and the whole against any input.

use proptest::prelude::*;
use shakedown_core::blocks::filter::{MotionObserver, MotionState};
use shakedown_core::blocks::tracking::{
    FlowMap, FlowState, History, Stencil, Surroundings, TrackingInput, TrackingState, Valve, ValveState,
};
use shakedown_core::settings::{FlowSettings, Gains, NotchSettings, OilSettings, PressureSettings, TrackingSettings};
use shakedown_core::{Channels, Controller, Sample, Settings, SettingsError};

use crate::table::any_sample;

const DT: f32 = 1e-3;

fn settings(tracking: TrackingSettings) -> Settings {
    Settings { displacement: Gains::new(0.0, 0.0), tracking: Some(tracking), ..Settings::default() }
}

/// Everything that the law can have.
fn full() -> TrackingSettings {
    TrackingSettings {
        delay: 0.003,
        flow: FlowSettings { sharpness: 3.0, droop: 0.3, recovery: 2.0, stall: 30.0, ..FlowSettings::default() },
        oil: Some(OilSettings { frequency: 12.0, damping: 0.05 }),
        pressure: Some(PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 }),
        notch: Some(NotchSettings { frequency: 30.0, damping: 0.2 }),
        ..TrackingSettings::default()
    }
}

/// The servo model in `f64`, one tick with the command held: the mean of its flow, and its state after.
fn mean_flow(lag: &mut f64, u: f64) -> f64 {
    let (b1, b0, a1, dt) = (0.69, 138.0, 57.65, f64::from(DT));
    let (kept, settled) = ((-a1 * dt).exp(), (b0 / a1 - b1) * u);
    let mean = b1 * u + settled + (*lag - settled) * (1.0 - kept) / (a1 * dt);
    *lag = settled + (*lag - settled) * kept;
    mean
}

proptest! {
    /// Sixth-degree polynomials come back exactly; what rounding leaves goes with the inverse powers of the spacing.
    #[test]
    fn rates_of_a_polynomial_are_exact(c in proptest::array::uniform7(-1.0..1.0f64), ticks in 1u32..8) {
        let stencil = Stencil::new(ticks as f32 * DT, DT).unwrap();
        let mut history = History::at(0.0);
        let (n, scale) = (60i32, 0.03);
        let at = |k: i32| {
            let t = f64::from(k - n + stencil.reach() as i32) / 30.0;
            scale * c.iter().rev().fold(0.0, |sum, c| sum * t + c)
        };
        for k in 0..=n {
            history.push(at(k) as f32);
        }
        let found = stencil.at(&history, stencil.reach());
        // t runs at 1/30 a tick: 1000/30 a second.
        let rate = 1000.0 / 30.0;
        let h = f64::from(ticks) * 1e-3;
        let ulp = 4e-8 * 0.3;
        let close = |found: f32, exact: f64, noise: f64| (f64::from(found) - exact).abs() < noise + 1e-5 * exact.abs();
        prop_assert!(close(found.displacement, scale * c[0], ulp));
        prop_assert!(close(found.velocity, scale * c[1] * rate, 2.0 * ulp / h));
        prop_assert!(close(found.acceleration, scale * 2.0 * c[2] * rate * rate, 8.0 * ulp / (h * h)));
        prop_assert!(close(found.jerk, scale * 6.0 * c[3] * rate.powi(3), 8.0 * ulp / (h * h * h)));
    }

    /// The inverse makes the model's mean flow the one wanted, tick by tick, whatever is wanted.
    #[test]
    fn the_valve_does_what_its_inverse_was_asked(flows in proptest::collection::vec(-0.3..0.3f32, 1..200)) {
        let valve = Valve::new([138.0 / 57.65, 1.0 / 57.65, 0.69 / 138.0], 10.0, DT).unwrap();
        let (mut state, mut lag) = (ValveState::default(), 0.0);
        for flow in flows {
            let (command, made) = valve.advance(&mut state, flow, 0.0);
            prop_assert_eq!(made, flow);
            prop_assert!((mean_flow(&mut lag, f64::from(command)) - f64::from(flow)).abs() < 2e-6);
        }
    }

    #[test]
    fn a_command_at_its_limit_says_what_flow_it_makes(flows in proptest::collection::vec(-3.0..3.0f32, 1..200)) {
        let valve = Valve::new([138.0 / 57.65, 1.0 / 57.65, 0.69 / 138.0], 0.2, DT).unwrap();
        let (mut state, mut lag) = (ValveState::default(), 0.0);
        for flow in flows {
            let (command, made) = valve.advance(&mut state, flow, 0.0);
            prop_assert!(command.abs() <= 0.2);
            prop_assert!((mean_flow(&mut lag, f64::from(command)) - f64::from(made)).abs() < 1e-5);
        }
    }

    /// The soft limit's inverse, put through the soft limit, is the flow that was wanted.
    #[test]
    fn a_soft_limit_is_undone(share in -0.95..0.95f32, sharpness in 2.0..8.0f32) {
        let limit = 0.242;
        let map = FlowMap::new(&FlowSettings { sharpness, ..FlowSettings::default() }, limit, DT).unwrap();
        let (open, made) = map.advance(&mut FlowState::default(), share * limit, 0.0, 0.0);
        prop_assert_eq!(made, share * limit);
        let w = f64::from(open / limit);
        let n = f64::from(sharpness);
        let back = w / (1.0 + w.abs().powf(n)).powf(1.0 / n);
        prop_assert!((back - f64::from(share)).abs() < 0.01, "{back} {share}");
    }

    /// After any input a quiet table gets numbers again, within the command's limit.
    #[test]
    fn whatever_arrives_it_stays_finite(
        tracking in prop_oneof![Just(full()), Just(TrackingSettings::default())],
        samples in proptest::collection::vec(any_sample(), 1..400),
    ) {
        let settings = settings(tracking);
        let mut controller = Controller::new(&settings).unwrap();
        for sample in &samples {
            let command = controller.step(sample);
            prop_assert!(command.valve.abs() <= settings.valve.command_limit && command.reference.is_finite());
        }
        for _ in 0..50 {
            let command = controller.step(&Sample::default());
            prop_assert!(command.valve.is_finite() && !command.status.held);
        }
    }
}

/// The steady gains against Riccati's equation, iterated in `f64` until it rests.
#[test]
fn the_observer_has_the_kalman_gains() {
    let (r, q, dt) = (1.15e-5_f64, 0.196_f64, 1e-3_f64);
    let mut p = [[1e-6, 0.0], [0.0, 1e-2]];
    let mut gain = [0.0; 2];
    for _ in 0..200_000 {
        let g = [0.5 * dt * dt * q, dt * q];
        let a = p[0][0] + 2.0 * dt * p[0][1] + dt * dt * p[1][1] + g[0] * g[0];
        let b = p[0][1] + dt * p[1][1] + g[0] * g[1];
        let c = p[1][1] + g[1] * g[1];
        gain = [a / (a + r * r), b / (a + r * r)];
        p = [[(1.0 - gain[0]) * a, (1.0 - gain[0]) * b], [(1.0 - gain[0]) * b, c - gain[1] * b]];
    }
    let kalman = MotionObserver::kalman(r as f32, q as f32, DT).unwrap();
    let mut state = MotionState::default();
    kalman.advance(&mut state, 1.0, 0.0);
    assert!((f64::from(state.displacement) / gain[0] - 1.0).abs() < 1e-3, "{state:?} {gain:?}");
    assert!((f64::from(state.velocity) / gain[1] - 1.0).abs() < 1e-3, "{state:?} {gain:?}");
}

/// The servo model in closed loop with a controller, its gain off by a factor.
struct Loop {
    gain: f64,
    lag: f64,
    displacement: f64,
    velocity: f64,
    command: f64,
}

impl Loop {
    fn new(gain: f64) -> Self {
        Self { gain, lag: 0.0, displacement: 0.0, velocity: 0.0, command: 0.0 }
    }

    /// One tick: the sensors as they are at its start, the accelerometer the mean over the tick before.
    fn tick(&mut self, controller: &mut Controller, reference: f64) -> f64 {
        let velocity = self.lag + 0.69 * self.gain * self.command;
        let acceleration = (velocity - self.velocity) * 1e3;
        self.velocity = velocity;
        let sample = Sample::new(reference as f32, self.displacement as f32, acceleration as f32);
        self.command = f64::from(controller.step(&sample).valve);
        self.displacement += 1e-3 * mean_flow(&mut self.lag, self.gain * self.command);
        self.command
    }
}

/// A sine that comes up without a corner, m.
fn sine(k: u32) -> f64 {
    let t = f64::from(k) * 1e-3;
    let s = (t / 2.0).min(1.0);
    0.03 * (6.0 * t).sin() * s * s * s * (10.0 - s * (15.0 - 6.0 * s))
}

/// On its own model, in closed loop, the table is where the reference was the law's lag ago.
#[test]
fn on_its_own_model_the_table_follows() {
    let mut controller = Controller::new(&settings(TrackingSettings::default())).unwrap();
    let mut table = Loop::new(1.0);
    let lag = |k: u32| 0.03 * (6.0 * (f64::from(k) * 1e-3 + 1e-3 - 0.0065)).sin();
    let mut farthest = 0.0_f64;
    for k in 0..6000 {
        table.tick(&mut controller, sine(k));
        if k > 2100 {
            farthest = farthest.max((table.displacement - lag(k)).abs());
        }
    }
    // A twentieth of the LVDT's step of 0.04 mm, at 0.18 m/s.
    assert!(farthest < 2e-6, "{farthest}");
}

/// With the gain a third too small the feedback has much to say; a change of its gains is not seen in the command.
#[test]
fn retuning_makes_no_bump() {
    let slow = settings(TrackingSettings { bandwidth: 2.0, ..TrackingSettings::default() });
    let fast = settings(TrackingSettings { bandwidth: 20.0, ..TrackingSettings::default() });
    let mut controller = Controller::new(&slow).unwrap();
    let mut table = Loop::new(0.7);
    let (mut last, mut steepest) = (0.0, [0.0_f64; 2]);
    for k in 0..4000 {
        if k == 3000 {
            controller.retune(&fast).unwrap();
        }
        let command = table.tick(&mut controller, sine(k));
        let now = &mut steepest[usize::from((3000..3010).contains(&k))];
        *now = now.max((command - last).abs());
        last = command;
    }
    // Ten times the gain on an error of millimetres would be a jump of centimetres.
    assert!(steepest[1] < 2.0 * steepest[0], "{steepest:?}");
}

/// At rest there is nothing to take over, and a law without feedback has nothing to take it up with.
#[test]
fn a_law_without_feedback_takes_over_at_rest() {
    let around = Surroundings { dt: DT, valve: [2.4, 0.017], command_limit: 10.0, velocity_limit: 0.242 };
    let law = TrackingSettings { bandwidth: 0.0, ..TrackingSettings::default() }.law(&around).unwrap();
    let mut state = TrackingState::at(0.0);
    law.adapt_state(&mut state);
    assert_eq!(law.advance(&mut state, &TrackingInput::default()), 0.0);
}

/// Eight ticks of spacing and fifteen of delay reach as far back as the history goes.
#[test]
fn a_stencil_does_not_look_beyond_its_history() {
    let at = |spacing: f32, delay: f32| {
        Controller::new(&settings(TrackingSettings { spacing, delay, ..TrackingSettings::default() })).map(|_| ())
    };
    assert_eq!((at(0.008, 0.015), at(0.0083, 0.014)), (Ok(()), Ok(())));
    let Err(SettingsError::OutOfRange { field, high, .. }) = at(0.0083, 0.015) else { panic!("too far back") };
    assert_eq!((field, high), ("tracking.spacing", 0.008));
}

#[test]
fn pressure_is_read_only_where_it_damps() {
    let lost = Sample { pressure_difference: f32::NAN, ..Sample::default() };
    let mut blind = Controller::new(&settings(TrackingSettings::default())).unwrap();
    assert!(!blind.step(&lost).status.held);
    let mut damped = Controller::new(&settings(full())).unwrap();
    assert_eq!(damped.step(&lost).status.missing, Channels::PRESSURE_DIFFERENCE);
}
