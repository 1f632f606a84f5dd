use super::*;
use crate::recording::RecordedLaw;
use crate::recording::clock::Clock;
use crate::recording::run::Use;
use std::f64::consts::PI;

/// Normal numbers enough for statistics: the sum of twelve uniform ones.
fn normal(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64) / (1u64 << 53) as f64
    };
    (0..n).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
}

/// Rest, motion, rest.
fn run(seed: u64, acceleration_noise: &[f64], resting: bool) -> Run {
    let (n, dt) = (10_000usize, 1e-3);
    let motion = |k: usize| {
        let t = k as f64 * dt;
        let envelope = if resting { ((t - 2.0) * (8.0 - t) / 9.0).max(0.0).powi(2) } else { 1.0 };
        0.02 * envelope * (2.0 * PI * 1.3 * t).sin()
    };
    let reference: Vec<f64> = (0..n).map(motion).collect();
    let quantised = |x: f64| 4e-5 * (x / 4e-5 + 0.5).floor();
    let displacement = reference.iter().zip(normal(seed, n)).map(|(x, e)| quantised(x + 1e-5 * e)).collect();
    let acceleration = reference.iter().zip(acceleration_noise).map(|(x, e)| -66.7 * x + e).collect();
    let mut channels = PerChannel::default();
    channels.set(Channel::Reference, reference);
    channels.set(Channel::Displacement, displacement);
    channels.set(Channel::Acceleration, acceleration);
    Run {
        name: format!("{seed}.csv"),
        path: "a.csv".into(),
        dt,
        time: (0..n).map(|k| k as f64 * dt).collect(),
        channels,
        noise: PerChannel::default(),
        loop_noise: None,
        law: RecordedLaw::Open,
        shaping: crate::recording::Shaping::default(),
        controller_rate_hz: None,
        purpose: Use::Fit,
        cut: false,
        error_before: 0.0,
        sent_before: Vec::new(),
        elapsed: 0.0,
        clock: Clock::default(),
    }
}

fn white(seed: u64) -> Vec<f64> {
    normal(seed + 100, 10_000).iter().map(|e| 0.2 * e).collect()
}

#[test]
fn a_stretch_at_rest_gives_size_and_colour() {
    let floors = floors(&run(1, &white(1), true), &[]);
    let acceleration = floors.get(Channel::Acceleration).unwrap();
    assert!((acceleration.std / 0.2 - 1.0).abs() < 0.05, "{acceleration:?}");
    assert!(matches!(acceleration.origin, Origin::Rest(from, to) if to <= 2.3 || from >= 7.7), "{acceleration:?}");
    assert_eq!(acceleration.colour, Colour::White);
}

#[test]
fn coloured_noise_is_known_for_what_it_is() {
    let innovation = white(2);
    let coloured: Vec<f64> = innovation
        .iter()
        .scan(0.0, |past, e| {
            *past = 0.8 * *past + e;
            Some(*past)
        })
        .collect();
    let floors = floors(&run(2, &coloured, true), &[]);
    let Colour::Coloured(ar) = &floors.get(Channel::Acceleration).unwrap().colour else { panic!("{floors:?}") };
    assert!((ar.coefficients[0] - 0.8).abs() < 0.06, "{ar:?}");
    assert!((ar.innovation / 0.2 - 1.0).abs() < 0.06, "{ar:?}");
    let whitened = ar.whitened(&coloured);
    let again = Autoregression::fit(&whitened, 20);
    assert!(again.coefficients.iter().all(|a| a.abs() < 0.06), "{again:?}");
}

#[test]
fn a_table_that_never_rests_is_judged_by_differences() {
    let floors = floors(&run(3, &white(3), false), &[]);
    let acceleration = floors.get(Channel::Acceleration).unwrap();
    assert_eq!(acceleration.origin, Origin::Differences);
    assert!((acceleration.std / 0.2 - 1.0).abs() < 0.05, "{acceleration:?}");
    assert_eq!(acceleration.colour, Colour::Unknown);
}

#[test]
fn no_floor_is_below_the_converter_s_step() {
    let floors = floors(&run(4, &white(4), true), &[]);
    let displacement = floors.get(Channel::Displacement).unwrap();
    assert!((displacement.step.unwrap() - 4e-5).abs() < 1e-9);
    assert!(displacement.std >= 4e-5 / 12f64.sqrt() - 1e-12, "{displacement:?}");
}

#[test]
fn repeats_and_the_experiment_s_own_figure_go_first() {
    let (one, two) = (run(5, &white(5), true), run(6, &white(6), true));
    let floor = floors(&one, std::slice::from_ref(&two));
    let acceleration = floor.get(Channel::Acceleration).unwrap();
    assert_eq!(acceleration.origin, Origin::Repeats(2));
    assert!((acceleration.std / 0.2 - 1.0).abs() < 0.05, "{acceleration:?}");
    let mut stated = one;
    stated.noise.set(Channel::Acceleration, 0.3);
    let floor = floors(&stated, &[two]);
    let acceleration = floor.get(Channel::Acceleration).unwrap();
    assert_eq!((acceleration.std, acceleration.origin), (0.3, Origin::Stated));
    assert!((acceleration.measured.unwrap() / 0.2 - 1.0).abs() < 0.05);
}

#[test]
fn the_power_of_an_autoregression_sums_to_its_variance() {
    let ar = Autoregression { coefficients: vec![0.5, -0.3], innovation: 1.0 };
    let (dt, bins) = (0.01, 4000);
    let width = 0.5 / dt / f64::from(bins);
    let sum: f64 = (0..bins).map(|k| ar.power((f64::from(k) + 0.5) * width, dt) * width).sum();
    // Variance of an AR(2): (1 - a2) s2 / ((1 + a2) ((1 - a2)^2 - a1^2)).
    let variance = 1.3 / (0.7 * (1.3f64.powi(2) - 0.25));
    assert!((sum / variance - 1.0).abs() < 1e-3, "{sum} {variance}");
}

/// A piece of a run in which nothing moves is at rest from end to end, however coloured its noise is.
#[test]
fn a_run_that_never_moves_is_at_rest() {
    let mut still = run(5, &white(5), true);
    let mut swing = 0.0;
    let coloured = normal(6, 10_000)
        .iter()
        .map(|e| {
            swing = 0.9 * swing + e;
            1e-5 * swing
        })
        .collect::<Vec<_>>();
    let size = deviation(&coloured);
    still.channels.set(Channel::Reference, vec![0.0; 10_000]);
    still.channels.set(Channel::Displacement, coloured);
    let floors = floors(&still, &[]);
    let floor = floors.get(Channel::Displacement).unwrap();
    assert!((floor.std / size - 1.0).abs() < 0.05, "{floor:?} {size}");
}

/// A table that creeps to where it rests says nothing of the sensor's noise before it is there.
#[test]
fn a_tail_of_motion_is_not_noise() {
    let mut settling = run(1, &white(1), true);
    let (dt, n) = (settling.dt, settling.time.len());
    let tail = |k: usize| 3e-4 * (-(k as f64 * dt - 8.0) / 0.3).exp() * f64::from(u8::from(k as f64 * dt > 8.0));
    let noise = normal(7, n);
    let moved =
        settling.channel(Channel::Reference).unwrap().iter().enumerate().map(|(k, x)| x + tail(k) + 1e-5 * noise[k]);
    // The motion starts at once, so that the end is the longest rest.
    let moved = moved.enumerate().map(|(k, x)| if k < 2000 { 0.01 * (k as f64 * 0.01).sin() + x } else { x }).collect();
    settling.channels.set(Channel::Displacement, moved);
    let floor = floors(&settling, &[]).get(Channel::Displacement).cloned().unwrap();
    assert!(matches!(floor.origin, Origin::Rest(from, _) if from > 8.5), "{:?}", floor.origin);
    assert!((floor.std - 1e-5).abs() < 2e-6, "{}", floor.std);
}

/// A reference that moves by a thousandth of its range is at rest; that the table follows it is not noise.
#[test]
fn a_slow_reference_that_is_followed_is_not_noise() {
    let mut slow = run(1, &white(1), true);
    let creep = |k: usize| 5e-5 * (k as f64 * slow.dt * 3.0).sin();
    let reference: Vec<f64> =
        slow.channel(Channel::Reference).unwrap().iter().enumerate().map(|(k, x)| x + creep(k)).collect();
    let followed = reference.iter().zip(normal(7, reference.len())).map(|(x, e)| x + 1e-5 * e).collect();
    slow.channels.set(Channel::Reference, reference);
    slow.channels.set(Channel::Displacement, followed);
    let floor = floors(&slow, &[]).get(Channel::Displacement).cloned().unwrap();
    assert!(matches!(floor.origin, Origin::Rest(..)), "{:?}", floor.origin);
    assert!((floor.std - 1e-5).abs() < 2e-6, "{}", floor.std);
}
