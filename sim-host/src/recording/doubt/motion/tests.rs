use super::super::tests::experiment;
use super::super::{Doubt, SetUp, doubt};
use crate::recording::law::{RecordedLaw, Shaping};
use crate::recording::model::{Baseline, ForceBalance};
use crate::recording::{Channel, Experiment};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const RATE: f64 = 200.0;
const SECONDS: f64 = 24.0;

/// What is wrong with the accelerometer.
#[derive(Debug, Clone, Copy)]
struct Sensor {
    gain: f64,
    lag: f64,
    delay: f64,
    offset: f64,
}

const RIGHT: Sensor = Sensor { gain: 1.0, lag: 0.0, delay: 0.0, offset: 0.0 };

/// A table that moves along sixty sines, two seconds of them at a time, seen by both sensors with noise.
fn moved(sensor: Sensor, seed: u64) -> Experiment {
    let law = RecordedLaw::ProportionalIntegral { kp: 4.0, ki: 1.0 };
    let mut it = experiment(&law, Shaping::default(), seed);
    it.model.baseline = Baseline::ForceBalance(ForceBalance { viscous: 0.0, scale: None, offset: None, lead: 0.0 });
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX);
    let lines: Vec<[f64; 3]> = (0..60)
        .map(|i| {
            let f = 0.4 * 50.0_f64.powf((f64::from(i) + uniform()) / 60.0);
            [std::f64::consts::TAU * f, 0.3 / (f * f * (1.0 + f)), std::f64::consts::TAU * uniform()]
        })
        .collect();
    let n = (RATE * SECONDS) as usize;
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let at = |k: usize| k as f64 / RATE;
    let x = |t: f64| lines.iter().map(|[w, a, p]| 0.1 * a * (w * t + p).sin()).sum::<f64>();
    let displacement = (0..n).map(|k| x(at(k)) + 2e-6 * normal()).collect();
    let shown = |t: f64| {
        let line = |[w, a, p]: &[f64; 3]| {
            let lag = w * sensor.lag;
            -0.1 * a * w * w * (w * (t - sensor.delay) + p - lag.atan()).sin() / lag.hypot(1.0)
        };
        sensor.gain * lines.iter().map(line).sum::<f64>() + sensor.offset
    };
    let acceleration = (0..n).map(|k| shown(at(k)) + 0.02 * normal()).collect();
    let run = &mut it.runs[0];
    run.dt = RATE.recip();
    run.time = (0..n).map(at).collect();
    run.law = RecordedLaw::Open;
    run.channels.set(Channel::Displacement, displacement);
    run.channels.set(Channel::Acceleration, acceleration);
    run.channels.set(Channel::PressureDifference, vec![0.0; n]);
    it.runs[0].channels.remove(Channel::Reference);
    it.runs[0].channels.remove(Channel::Command);
    it
}

fn found(set_up: &SetUp, what: Doubt) -> Option<(f64, f64)> {
    set_up.findings.iter().find(|f| f.what == what).map(|f| (f.found, f.std.unwrap_or(0.0)))
}

#[test]
fn an_accelerometer_that_shows_what_the_displacement_does_raises_no_doubt() {
    for seed in 0..20 {
        let set_up = doubt(&moved(RIGHT, seed));
        assert!(set_up.findings.is_empty(), "{seed}: {:?}", set_up.findings);
    }
}

#[test]
fn each_fault_of_an_accelerometer_is_found_with_its_size_and_taken_off() {
    let faults = [
        (Sensor { gain: 0.94, ..RIGHT }, Doubt::SensorGain, 0.94),
        (Sensor { lag: 0.012, ..RIGHT }, Doubt::SensorLag, 0.012),
        (Sensor { delay: 0.008, ..RIGHT }, Doubt::SampleShift, 0.008),
        (Sensor { offset: 0.03, ..RIGHT }, Doubt::Offset, 0.03),
        (Sensor { gain: 1.2, lag: 0.015, delay: 0.008, offset: 0.0 }, Doubt::SensorLag, 0.015),
    ];
    for (sensor, what, size) in faults {
        let set_up = doubt(&moved(sensor, 3));
        let (value, std) = found(&set_up, what).unwrap_or_else(|| panic!("{sensor:?}: {:?}", set_up.findings));
        assert!((value - size).abs() < (4.0 * std).max(0.03 * size), "{sensor:?}: {value} +/- {std}");
        let again = doubt(&set_up.experiment);
        assert!(again.findings.is_empty(), "{sensor:?} taken off: {:?}", again.findings);
    }
}

/// What drives nothing is a channel that a model explains: its gain is physics there, an effect of the library.
#[test]
fn an_accelerometer_that_is_explained_is_left_to_the_models() {
    let mut servo = moved(Sensor { gain: 0.9, offset: 0.03, ..RIGHT }, 4);
    servo.model.baseline =
        experiment(&RecordedLaw::ProportionalIntegral { kp: 4.0, ki: 1.0 }, Shaping::default(), 1).model.baseline;
    let gains = |what| found(&doubt(&servo), what);
    assert_eq!([gains(Doubt::SensorGain), gains(Doubt::Offset)], [None, None]);
}
