//! The monitor of noise: what is no noise of a sensor, how soon noise is said, and what is said exactly at the limit.

use shakedown_core::Trip;
use shakedown_core::blocks::Block;
use shakedown_core::blocks::filter::{Lag, LagState};
use shakedown_core::blocks::guard::{NoiseMonitor, NoiseState};
use shakedown_core::blocks::math::sin;
use shakedown_core::settings::{EnvelopeSettings, PlausibilitySettings};

/// Mean magnitude of white noise's change from tick to tick over that of its third difference, 1.
const WHITE: f32 = 0.316_227_77;

fn monitor(envelope: &EnvelopeSettings, dt: f32) -> NoiseMonitor {
    NoiseMonitor::new(&PlausibilitySettings::default(), envelope, true, dt).unwrap()
}

/// A monitor that takes no motion into account, at limits of `displacement` (m) and `acceleration` (m/s2) to the last bit.
fn without_motion(displacement: f32, acceleration: f32, dt: f32) -> NoiseMonitor {
    let settings = PlausibilitySettings {
        disagreement: displacement,
        acceleration_noise: acceleration,
        ..PlausibilitySettings::default()
    };
    let still = EnvelopeSettings { acceleration: 1e-20, jerk: 1e-20, ..EnvelopeSettings::default() };
    NoiseMonitor::new(&settings, &still, true, dt).unwrap()
}

/// What a monitor says tick by tick of displacements and accelerations.
fn said(monitor: &NoiseMonitor, readings: impl Iterator<Item = (f32, f32)>) -> Vec<Option<Trip>> {
    let mut state = NoiseState::default();
    readings.map(|(x, a)| monitor.advance(&mut state, x, a)).collect()
}

fn alternating(size: f32, tick: usize) -> f32 {
    if tick.is_multiple_of(2) { size } else { -size }
}

/// Where a table stands and how an accelerometer is mounted is no noise: a constant beside a noisy reading changes no verdict at any
/// tick, the first ones included.
#[test]
fn a_constant_is_no_noise_at_any_tick() {
    let monitor = monitor(&EnvelopeSettings::default(), 1e-3);
    let with = |x: f32, a: f32| {
        let lvdt = said(&monitor, (0..300).map(|k| (x + alternating(1.0 / 1024.0, k), a)));
        let accelerometer = said(&monitor, (0..300).map(|k| (x, a + alternating(2.0, k))));
        [lvdt, accelerometer]
    };
    let none = with(0.0, 0.0);
    for (found, cause) in none.iter().zip([Trip::DisplacementNoisy, Trip::AccelerationNoisy]) {
        assert!(found.contains(&Some(cause)), "{cause:?} is not seen");
    }
    for (x, a) in [(0.125, 0.0), (0.0, 16.0), (-0.125, -16.0)] {
        assert_eq!(with(x, a), none, "{x} m and {a} m/s2");
    }
}

/// A third difference takes four readings, and at turns so long that the mean is the reading itself the fourth is enough.
#[test]
fn the_fourth_reading_can_be_noisy() {
    let monitor = without_motion(0.002, 3.0, 1.0);
    let readings = [0.0, 0.0, 0.0, 0.1];
    let expected = [None, None, None, Some(Trip::DisplacementNoisy)];
    assert_eq!(said(&monitor, readings.iter().map(|&x| (x, 0.0))), expected);
    let expected = [None, None, None, Some(Trip::AccelerationNoisy)];
    assert_eq!(said(&monitor, readings.iter().map(|&a| (0.0, 1e3 * a))), expected);
}

/// A spike counts for four ticks at twice the limit, however high: 4 dt / 50 ms of it, 0.16 of the limit at 1 kHz.
#[test]
fn one_spike_of_either_sensor_is_no_noise() {
    let monitor = monitor(&EnvelopeSettings::default(), 1e-3);
    for (x, a) in [(10.0, 0.0), (0.0, 1e4), (-10.0, 0.0), (0.0, -1e4)] {
        let spike = |k| if k == 50 { (x, a) } else { (0.0, 0.0) };
        assert!(said(&monitor, (0..300).map(spike)).iter().all(Option::is_none), "{x} m, {a} m/s2");
    }
}

/// Every sine within the envelope up to its corner J / A, or up to a tenth of the rate, is motion at every rate.
#[test]
fn no_sine_within_the_envelope_is_noise_at_any_rate() {
    for jerk in [5000.0_f32, 50_000.0] {
        let envelope = EnvelopeSettings { jerk, ..EnvelopeSettings::default() };
        for rate in [200.0_f32, 500.0, 1000.0, 2000.0, 5000.0] {
            let monitor = monitor(&envelope, 1.0 / rate);
            for share in [0.1_f32, 0.3, 1.0] {
                // No faster than three quarters of the turns of the mean, of which the roughest is the corner's.
                let fastest = (jerk / envelope.acceleration).max(std::f32::consts::TAU * 0.1 * rate);
                let w = (share * fastest).min(2.0 * rate.min(1000.0));
                let size = envelope.acceleration.min(jerk / w);
                let motion = |k: u16| {
                    let a = size * sin((w * f32::from(k) / rate) % std::f32::consts::TAU);
                    (-a / (w * w), a)
                };
                let found = said(&monitor, (0..4000).map(motion)).into_iter().flatten().next();
                assert_eq!(found, None, "{w} rad/s at {rate} Hz, {jerk} m/s3");
            }
        }
    }
}

/// Above 1 kHz the mean over a millisecond is judged: noise that alternates from one to the next has the limit that it has at 1 kHz.
#[test]
fn noise_of_milliseconds_has_one_limit_at_every_rate() {
    for ticks in [1_usize, 2, 5] {
        let monitor = without_motion(0.002, 3.0, 1e-3 / ticks as f32);
        let found = |size: f32| {
            said(&monitor, (0..400 * ticks).map(|k| (0.0, alternating(size, k / ticks)))).into_iter().flatten().next()
        };
        // Third differences of 8 sizes.
        let limit = 3.0 / (8.0 * WHITE);
        assert_eq!((found(0.99 * limit), found(1.01 * limit)), (None, Some(Trip::AccelerationNoisy)), "{ticks}");
    }
}

/// The limit as the mean of the roughness after 40 ms, to the last bit: it is not passed then, nor in the ticks until the next mean, and
/// is passed from that one on, at every tick.
#[test]
fn at_its_limit_no_noise_is_said() {
    for ticks in [1_usize, 2, 4] {
        let mean = Lag::<f32>::new(0.05, 1e-3).unwrap();
        let mut state = LagState::default();
        let limit = (0..40).map(|_| mean.advance(&mut state, 8.0 * WHITE)).last().unwrap();
        let monitor = without_motion(1.0, limit, 1e-3 / ticks as f32);
        let found = said(&monitor, (0..60 * ticks).map(|k| (0.0, alternating(1.0, k / ticks))));
        // Three means come before the first third difference, and a mean is there at its last tick.
        let from = (3 + 41) * ticks - 1;
        let expected = (0..60 * ticks).map(|k| (k >= from).then_some(Trip::AccelerationNoisy));
        assert_eq!(found, expected.collect::<Vec<_>>(), "{ticks}");
    }
}
