use super::*;
use proptest::prelude::*;

#[test]
fn a_step_of_acceleration_gives_the_closed_form() {
    let (period, z) = (0.7, 0.05);
    let spectrum = response_spectrum(&vec![2.0; 2001], 0.01, z, &[period]).unwrap();
    let w = 2.0 * PI / period;
    let overshoot = (-z * PI / (1.0 - z * z).sqrt()).exp();
    let displacement = 2.0 / (w * w) * (1.0 + overshoot);
    assert!((spectrum.s_d[0] / displacement - 1.0).abs() < 1e-5, "{}", spectrum.s_d[0] / displacement);
    // The spring's pull ends at the ground's acceleration, so the first peak of it is that of displacement.
    assert!((spectrum.pseudo_acceleration()[0] / (2.0 * (1.0 + overshoot)) - 1.0).abs() < 1.5e-3);
}

#[test]
fn resonance_grows_to_its_steady_state() {
    let (period, z, dt) = (0.5, 0.05, 0.005);
    let w = 2.0 * PI / period;
    let a: Vec<f64> = (0..8000).map(|k| (w * f64::from(k) * dt).sin()).collect();
    let spectrum = response_spectrum(&a, dt, z, &[period]).unwrap();
    let steady = 1.0 / (2.0 * z * w * w);
    assert!((spectrum.s_d[0] / steady - 1.0).abs() < 2e-3, "{}", spectrum.s_d[0] / steady);
    assert!((spectrum.s_v[0] / (steady * w) - 1.0).abs() < 2e-3);
    assert!((spectrum.s_a[0] / (steady * w * w * (1.0 + 4.0 * z * z).sqrt()) - 1.0).abs() < 2e-3);
}

#[test]
fn a_stiff_oscillator_follows_the_ground_and_a_soft_one_stays_behind() {
    let dt = 0.005;
    let a: Vec<f64> =
        (0..4000).map(|k| (2.0 * PI * f64::from(k) * dt).sin() * (1.0 - (f64::from(k) / 4000.0))).collect();
    let motion = crate::motion::Motion::from_acceleration(dt, a.clone());
    let spectrum = response_spectrum(&a, dt, 0.05, &[0.01, 500.0]).unwrap();
    assert!((spectrum.s_a[0] / crate::motion::peak(&a) - 1.0).abs() < 2e-3);
    assert!((spectrum.s_d[1] / crate::motion::peak(&motion.displacement) - 1.0).abs() < 0.05);
}

/// Found by the property below: a displacement that turned there and back within a sample.
#[test]
fn a_turn_there_and_back_within_a_sample_is_seen() {
    let a = [-4.38, -4.167, 1.28, -4.395, 3.49, 2.347, -2.591, 2.887];
    let fine = super::super::resample::resample(&a, 0.02, 1e-4, super::super::resample::Interpolation::Linear);
    let at = |a: &[f64], dt| response_spectrum(a, dt, 0.05, &[0.518_867_457_263]).unwrap().s_d[0];
    assert!((at(&a, 0.02) / at(&fine, 1e-4) - 1.0).abs() < 1e-4, "{} {}", at(&a, 0.02), at(&fine, 1e-4));
}

/// Every sample taken in short steps, as none may be skipped that holds a peak.
fn plainly(oscillator: &Oscillator, acceleration: &[f64]) -> [f64; 3] {
    let (mut peaks, mut state) = ([0.0; 3], (0.0, 0.0));
    for pair in acceleration.windows(2) {
        state = oscillator.sought(&mut peaks, state, (pair[0], pair[1]));
    }
    peaks
}

proptest! {
    #[test]
    fn no_peak_lies_in_what_is_passed_over(
        signal in prop::collection::vec(-1.0..1.0f64, 200), period in 0.01..10.0f64, damping in 0.0..0.5f64
    ) {
        // A burst, and what it leaves: weaker, and later nearly nothing.
        let size = |k: usize| if k < 60 { 5.0 } else if k < 120 { 1.0 } else { 0.05 };
        let shaken: Vec<f64> = signal.iter().enumerate().map(|(k, a)| size(k) * a).collect();
        let oscillator = Oscillator::new(period, damping, 0.01);
        let (fast, plain) = (oscillator.peaks(&shaken, &impulses(&shaken, 0.01)), plainly(&oscillator, &shaken));
        for (a, b) in fast.iter().zip(&plain) {
            prop_assert!((a - b).abs() <= 1e-9 * b.abs(), "{fast:?} {plain:?}");
        }
    }
}

#[test]
fn bad_input_is_refused_with_its_value() {
    assert_eq!(response_spectrum(&[0.0; 4], 0.01, 1.0, &[1.0]), Err(SpectrumError::Damping(1.0)));
    assert_eq!(response_spectrum(&[0.0; 4], 0.01, 0.05, &[1.0, 0.0]), Err(SpectrumError::Period(0.0)));
    assert!(response_spectrum(&[], 0.01, 0.05, &[1.0]).is_ok_and(|s| s.s_a == [0.0]));
}

#[test]
fn the_fourier_amplitude_of_a_gaussian_is_a_gaussian() {
    let dt = 0.01;
    let x: Vec<f64> = (0..1024).map(|k| (-((f64::from(k) * dt - 5.0) / 0.2).powi(2)).exp()).collect();
    let (frequency, amplitude) = fourier_amplitude(&x, dt);
    for (f, found) in frequency.iter().zip(&amplitude).take(40) {
        let exact = 0.2 * PI.sqrt() * (-(PI * f * 0.2).powi(2)).exp();
        assert!((found - exact).abs() < 1e-9, "{f} Hz: {found} {exact}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn spectra_scale_with_the_motion_and_finer_samples_of_the_same_lines_change_nothing(
        a in prop::collection::vec(-5.0..5.0f64, 2..60), factor in 0.1..4.0f64
    ) {
        let t = periods(0.05, 3.0, 8);
        let spectrum = response_spectrum(&a, 0.02, 0.05, &t).unwrap();
        let scaled: Vec<f64> = a.iter().map(|x| x * factor).collect();
        let other = response_spectrum(&scaled, 0.02, 0.05, &t).unwrap();
        let fine = super::super::resample::resample(&a, 0.02, 0.002, super::super::resample::Interpolation::Linear);
        let finer = response_spectrum(&fine, 0.002, 0.05, &t).unwrap();
        for (scaled, plain) in other.s_a.iter().zip(&spectrum.s_a) {
            prop_assert!((scaled - factor * plain).abs() < 1e-9 * (1.0 + scaled));
        }
        for ((fine, coarse), period) in finer.s_d.iter().zip(&spectrum.s_d).zip(&t) {
            prop_assert!((fine / coarse - 1.0).abs() < 1e-3, "{fine} {coarse} at {period} s");
        }
    }
}
