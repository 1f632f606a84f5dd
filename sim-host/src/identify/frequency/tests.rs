use super::transfer::{Order, TransferFunction, choose, fit};
use super::*;
use std::f64::consts::PI;

/// The paper's plant, Eq. 7.
fn plant() -> TransferFunction {
    TransferFunction { numerator: vec![138.0, 0.69], denominator: vec![57.65], integrators: 1, delay: 0.0 }
}

/// Normal numbers enough for statistics: the sum of twelve uniform ones.
fn normal(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64) / (1u64 << 53) as f64
    };
    (0..n).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
}

/// A first-order lag of 20 ms, exactly sampled, its output delayed by `delay` samples.
const LAG: f64 = 0.02;

fn lagged(input: &[f64], dt: f64, delay: usize) -> Vec<f64> {
    let keep = (-dt / LAG).exp();
    let mut y = 0.0;
    let all: Vec<f64> = input
        .iter()
        .map(|u| {
            let out = y;
            y = keep * y + (1.0 - keep) * u;
            out
        })
        .collect();
    std::iter::repeat_n(0.0, delay).chain(all).take(input.len()).collect()
}

/// Its response: held input, so with the hold's half step and the recurrence's own shape.
fn lag_response(frequency: f64, dt: f64, delay: usize) -> Complex64 {
    let z = (laplace(frequency) * dt).exp();
    let keep = (-dt / LAG).exp();
    (1.0 - keep) / (z - keep) * z.powu(delay as u32).inv()
}

fn measured(function: &TransferFunction, relative: f64, seed: u64) -> Response {
    let noise = normal(seed, 400);
    let points = (0..60).map(|k| {
        let frequency = 0.1 * 1.09f64.powi(k);
        let value = function.at(frequency);
        let std = relative * value.norm();
        let e = Complex64::new(noise[2 * k as usize], noise[2 * k as usize + 1]) * std / 2f64.sqrt();
        Point { frequency, value: value + e, std, coherence: 1.0 }
    });
    Response { points: points.collect() }
}

const EQ7: Order = Order { numerator: 1, denominator: 1, integrators: 1, longest_delay: 0.0 };

#[test]
fn the_paper_s_transfer_function_comes_back_with_honest_errors() {
    let fit = fit(&measured(&plant(), 0.02, 1), EQ7).unwrap();
    assert!((0.6..1.5).contains(&fit.chi2), "{}", fit.chi2);
    let found = [fit.function.numerator[0], fit.function.numerator[1], fit.function.denominator[0]];
    for ((value, truth), std) in found.iter().zip([138.0, 0.69, 57.65]).zip(&fit.std) {
        assert!((value - truth).abs() < 4.0 * std, "{value} +- {std}, true {truth}");
    }
    assert!(fit.std[0] < 0.02 * 138.0);
}

#[test]
fn standard_errors_cover_the_truth() {
    let covered = (0..200)
        .filter(|seed| {
            let fit = fit(&measured(&plant(), 0.05, 1000 + seed), EQ7).unwrap();
            (fit.function.denominator[0] - 57.65).abs() < 1.645 * fit.std[2]
        })
        .count();
    assert!((164..=193).contains(&covered), "{covered} of 200");
}

#[test]
fn a_delay_is_told_from_a_pole() {
    let truth = TransferFunction { delay: 0.008, ..plant() };
    let fit = fit(&measured(&truth, 0.01, 3), Order { longest_delay: 0.05, ..EQ7 }).unwrap();
    assert!((fit.function.delay - 0.008).abs() < 5e-4, "{:?}", fit.function);
}

#[test]
fn the_order_is_chosen_by_data_held_back() {
    let truth =
        TransferFunction { numerator: vec![6e5], denominator: vec![6e4, 1.2e3, 62.0], integrators: 1, delay: 0.0 };
    assert!(truth.is_stable());
    let orders: Vec<Order> = (1..=5)
        .flat_map(|n| {
            (0..n.min(3)).map(move |m| Order { numerator: m, denominator: n, integrators: 1, longest_delay: 0.0 })
        })
        .collect();
    let trials = choose(&measured(&truth, 0.02, 4), &measured(&truth, 0.02, 5), &orders).unwrap();
    assert_eq!((trials[0].order.numerator, trials[0].order.denominator), (0, 3), "{:?}", trials[0].order);
    assert!(trials[0].held_back < 1.5);
}

#[test]
fn poles_are_the_roots_of_the_denominator() {
    // (s + 2)(s^2 + 2 s + 26): -2, -1 +- 5j
    let function =
        TransferFunction { numerator: vec![1.0], denominator: vec![52.0, 30.0, 4.0], integrators: 0, delay: 0.0 };
    let mut poles = function.poles();
    poles.sort_by(|a, b| a.im.total_cmp(&b.im));
    for (found, truth) in
        poles.iter().zip([Complex64::new(-1.0, -5.0), Complex64::new(-2.0, 0.0), Complex64::new(-1.0, 5.0)])
    {
        assert!((found - truth).norm() < 1e-9, "{found} {truth}");
    }
}

#[test]
fn too_few_points_are_refused() {
    let response = Response { points: measured(&plant(), 0.01, 1).points[..2].to_vec() };
    assert_eq!(fit(&response, EQ7).unwrap_err(), ResponseError::TooFew { what: "frequencies", found: 2, least: 3 });
}

#[test]
fn a_sine_gives_gain_and_phase_of_an_incomplete_period_with_drift() {
    let (dt, frequency) = (1e-3, 0.83);
    let phase = |k: usize| 2.0 * PI * frequency * k as f64 * dt;
    let input: Vec<f64> = (0..4321).map(|k| 0.01 * phase(k).sin() + 0.2).collect();
    let output: Vec<f64> = (0..4321).map(|k| 0.03 * (phase(k) - 0.5).sin() - 1.0 + 1e-5 * k as f64).collect();
    let point = sine::sine_point(&input, &output, dt, frequency).unwrap();
    assert!((point.point.value.norm() - 3.0).abs() < 1e-6 && (point.point.value.arg() + 0.5).abs() < 1e-6);
    assert!((point.amplitude - 0.01).abs() < 1e-9 && point.even < 1e-5 && point.odd < 1e-5);
}

#[test]
fn a_clipped_sine_shows_odd_harmonics_and_its_describing_function() {
    let dt = 1e-3;
    let input: Vec<f64> = (0..20_000).map(|k| (2.0 * PI * 1.0 * f64::from(k) * dt).sin()).collect();
    let output: Vec<f64> = input.iter().map(|u| u.clamp(-0.5, 0.5)).collect();
    let point = sine::sine_point(&input, &output, dt, 1.0).unwrap();
    // Describing function of a saturation at half the amplitude.
    let r: f64 = 0.5;
    let gain = 2.0 / PI * (r.asin() + r * (1.0 - r * r).sqrt());
    assert!((point.point.value.norm() - gain).abs() < 1e-4, "{}", point.point.value.norm());
    assert!(point.odd > 0.1 && point.even < 1e-4, "{point:?}");
}

#[test]
fn a_recorded_sweep_of_held_sines_is_taken_apart() {
    let dt = 1e-3;
    let mut input = Vec::new();
    for frequency in [0.5, 1.0, 2.0, 4.0] {
        let n = (8.0 / frequency / dt) as usize;
        input.extend((0..n).map(|k| 0.01 * (2.0 * PI * frequency * k as f64 * dt).sin()));
    }
    let output = lagged(&input, dt, 0);
    let points = sine::sweep(&input, &output, dt, 2).unwrap();
    assert_eq!(points.len(), 4, "{points:?}");
    for p in &sine::response(&points).points {
        assert!((p.value - lag_response(p.frequency, dt, 0)).norm() < 2e-3, "{p:?}");
    }
}

#[test]
fn random_records_give_the_response_and_its_scatter() {
    let (dt, n) = (5e-3, 20_000);
    let input = normal(11, n);
    let noise = normal(12, n);
    let output: Vec<f64> = lagged(&input, dt, 3).iter().zip(noise).map(|(y, e)| y + 0.1 * e).collect();
    let by_tapers = multitaper::multitaper(&[(&input, &output)], dt, 12).unwrap().within(0.2, 60.0, 0.0);
    let by_polynomials = local::local_polynomial(&input, &output, dt, 8, 10).unwrap().within(0.2, 60.0, 0.0);
    for (name, response) in [("tapers", by_tapers), ("polynomials", by_polynomials)] {
        let errors: Vec<f64> = response
            .points
            .iter()
            .map(|p| ((p.value - lag_response(p.frequency, dt, 3)).norm() / p.std).powi(2))
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(errors.len() > 100 && (0.7..1.6).contains(&mean), "{name}: {mean} over {}", errors.len());
        let slow = response.points.iter().find(|p| p.frequency > 1.0).unwrap();
        assert!(slow.coherence > 0.95, "{name}: {slow:?}");
    }
}

#[test]
fn a_short_record_that_starts_and_ends_in_motion_is_no_trouble_to_polynomials() {
    let (dt, n) = (5e-3, 600);
    let long = normal(13, n + 4000);
    let output = lagged(&long, dt, 0);
    let (input, output) = (&long[4000..], &output[4000..]);
    let response = local::local_polynomial(input, output, dt, 6, 1).unwrap().within(2.0, 60.0, 0.0);
    let worst = response.points.iter().map(|p| (p.value - lag_response(p.frequency, dt, 0)).norm()).fold(0.0, f64::max);
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn a_multisine_tells_odd_from_even_distortion() {
    let period = 2048;
    let phases = normal(14, 300);
    // Odd lines, every third of them left out.
    let driven: Vec<usize> = (1..120).step_by(2).filter(|k| k % 3 != 0).collect();
    let input: Vec<f64> = (0..4 * period)
        .map(|t| {
            let line =
                |(i, k): (usize, &usize)| (2.0 * PI * (*k * t) as f64 / period as f64 + 2.0 * PI * phases[i]).cos();
            driven.iter().enumerate().map(line).sum::<f64>() / 10.0
        })
        .collect();
    let noise = normal(15, input.len());
    let analyse = |cubic: f64, square: f64| {
        let output: Vec<f64> =
            input.iter().zip(&noise).map(|(u, e)| 2.0 * u + cubic * u.powi(3) + square * u * u + 1e-3 * e).collect();
        multisine::multisine(&[(&input, &output)], 1e-3, period).unwrap()
    };
    let size = |lines: &[multisine::DistortionLine]| {
        (lines.iter().map(|l| l.amplitude.powi(2)).sum::<f64>() / lines.len() as f64).sqrt()
    };
    let (odd, even, clean) = (analyse(0.1, 0.0), analyse(0.0, 0.1), analyse(0.0, 0.0));
    assert!(size(&odd.odd) > 20.0 * size(&odd.even), "{} {}", size(&odd.odd), size(&odd.even));
    assert!(size(&even.even) > 20.0 * size(&even.odd), "{} {}", size(&even.even), size(&even.odd));
    assert!(clean.odd.iter().all(|l| l.amplitude < 6.0 * l.noise), "{:?}", clean.odd[0]);
    assert!(clean.response.points.iter().all(|p| (p.value - 2.0).norm() < 6.0 * p.std));
    assert_eq!(clean.response.points.len(), driven.len());
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let (a, b) = (vec![0.0; 400], vec![f64::NAN; 400]);
    assert_eq!(multitaper::multitaper(&[(&a, &b)], 1e-3, 8).unwrap_err(), ResponseError::NotANumber { at: 0 });
    assert_eq!(
        local::local_polynomial(&a, &a[1..], 1e-3, 6, 1).unwrap_err(),
        ResponseError::Lengths { input: 400, output: 399 }
    );
    assert_eq!(sine::sine_point(&a, &a, 1e-3, 2.0).unwrap_err(), ResponseError::NotDriven { frequency: 2.0 });
    assert_eq!(
        sine::sine_point(&a, &a, 1e-3, 900.0).unwrap_err(),
        ResponseError::OutOfBand { frequency: 900.0, nyquist: 500.0 }
    );
}
