use super::super::tests::at_rest_with;
use super::mains_line;
use crate::recording::channel::Channel;

const DT: f64 = 1.0 / 204.8;
const N: usize = 2458;

/// White noise through an oscillator: a mode of a table that the mains do not drive.
fn mode(frequency: f64, damping: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let angle = std::f64::consts::TAU * frequency * DT;
    let kept = (-damping * angle).exp();
    let (mut now, mut before) = (0.0, 0.0);
    let step = |_| {
        (now, before) = (2.0 * kept * angle.cos() * now - kept * kept * before + uniform(), now);
        now
    };
    (0..N).map(step).collect()
}

#[test]
fn a_mode_of_the_table_near_the_mains_is_no_hum() {
    for seed in 1..40 {
        for frequency in [48.5, 49.2, 50.0] {
            let run = at_rest_with(mode(frequency, 0.02, seed), DT);
            assert_eq!(mains_line(&run, Channel::Acceleration), None, "{frequency} Hz, {seed}");
        }
    }
}

#[test]
fn hum_beside_such_a_mode_is_found() {
    let hum = |k: usize| 8.0 * (std::f64::consts::TAU * 50.0 * k as f64 * DT).sin();
    let with = mode(48.5, 0.02, 3).iter().enumerate().map(|(k, a)| a + hum(k)).collect();
    assert_eq!(mains_line(&at_rest_with(with, DT), Channel::Acceleration), Some(50.0));
}
