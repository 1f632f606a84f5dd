//! The loop in rehearsal: a motion that asks too much, counted step by step.

use shakedown_core::State;
use stepper_table::{Axis, FASTEST, MOST, RATE, STEP, STROKE};

/// A pulse of 0.9 m/s, twice what the motor does, on a slow sine.
fn asked(k: u32) -> f32 {
    let t = k as f32 / RATE;
    0.03 * (0.8 * t).sin() + 0.09 * (10.0 * (t - 6.0)).sin() * (-(t - 6.0) * (t - 6.0)).exp()
}

/// Runs with the key turned on at `on` and off at `off`; the largest speed over 10 ms, the farthest position, what was on.
fn rehearsed(axis: &mut Axis, ticks: u32, on: u32, off: u32) -> (f32, f32, bool) {
    let (mut fastest, mut farthest, mut enabled, mut places) = (0.0_f32, 0.0_f32, false, vec![0.0_f32; 10]);
    for k in 0..ticks {
        let before = axis.position();
        let pulses = axis.tick(asked(k), (on..off).contains(&k));
        assert!(pulses.steps.abs() <= MOST, "tick {k}: {} steps", pulses.steps);
        assert!(pulses.enabled || pulses.steps == 0, "tick {k}: steps without current");
        assert!((axis.position() - before - pulses.steps as f32 * STEP).abs() < 0.1 * STEP);
        enabled |= pulses.enabled;
        fastest = fastest.max((axis.position() - places[k as usize % 10]).abs() / 10.0 * RATE);
        places[k as usize % 10] = axis.position();
        farthest = farthest.max(axis.position().abs());
    }
    (fastest, farthest, enabled)
}

#[test]
fn a_motion_that_asks_too_much_stays_within_speed_and_travel() {
    let mut axis = Axis::new().unwrap();
    let (fastest, farthest, _) = rehearsed(&mut axis, 16_000, 100, 13_000);
    // Rounded to whole steps, ten ticks may hold one more.
    assert!(fastest > 0.8 * FASTEST && fastest <= FASTEST + STEP / 10.0 * RATE, "{fastest} m/s");
    assert!(farthest > 0.04 && farthest <= STROKE, "{farthest} m");
    assert_eq!(axis.state(), State::Off);
}

/// A power failure during a test must not end in a table that starts when the power is back.
#[test]
fn a_key_that_is_on_when_the_power_comes_arms_nothing() {
    let mut axis = Axis::new().unwrap();
    assert_eq!(rehearsed(&mut axis, 5000, 0, 5000), (0.0, 0.0, false));
    assert_eq!(axis.state(), State::Off);
}
