use super::*;

/// A reference of many sines that begins and ends at rest, its rate and its second derivative.
fn reference(t: f64, duration: f64) -> f64 {
    let fade = ((t / 2.0).min((duration - t) / 2.0)).clamp(0.0, 1.0);
    let fade = fade * fade * (3.0 - 2.0 * fade);
    let tones = [(0.31, 0.02), (0.83, 0.008), (1.9, 0.003), (4.3, 6e-4), (7.7, 2e-4)];
    fade * tones.iter().enumerate().map(|(i, (f, a))| a * (std::f64::consts::TAU * f * t + i as f64).sin()).sum::<f64>()
}

/// A digital law at 1 kHz around an integrator with a lag, and its own log: every tick, with the noise that it saw.
fn log(law: &mut dyn FnMut(f64, f64, f64, f64) -> f64) -> Log {
    let (dt, duration) = (1e-3, 24.0);
    let (mut x, mut v, mut before_r, mut before_x, mut state) = (0.0, 0.0, 0.0, 0.0, 7u64);
    let mut log = Log { dt, ..Log::default() };
    let mut late = std::collections::VecDeque::from(vec![0.0; 3]);
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        6e-6 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
    };
    for k in 0..(duration / dt) as usize {
        let r = reference(k as f64 * dt, duration);
        let seen = x + noise();
        let u = law(r, (r - before_r) / dt, seen, (seen - before_x) / dt);
        (before_r, before_x) = (r, seen);
        late.push_back(u);
        let acting = late.pop_front().unwrap_or(0.0);
        log.reference.push(r);
        log.displacement.push(seen);
        log.command.push(acting);
        v += dt * 60.0 * (2.4 * acting - v);
        x += dt * v;
    }
    log
}

#[test]
fn a_pid_with_feed_forward_is_found_with_its_delay() {
    let mut sum = 0.0;
    let mut law = |r: f64, rv: f64, x: f64, v: f64| {
        sum += 1e-3 * (r - x);
        6.0 * (r - x) + 2.0 * sum + 0.35 * rv - 0.05 * v
    };
    let found = identify(&[log(&mut law)]).unwrap();
    assert_eq!(found.closure, Closure::Command);
    // The gain of a velocity and the delay are hardly known here, for the table makes command and velocity nearly one: the error that
    // is stated must say so.
    let velocity = found.gains.iter().find(|gain| gain.term == Term::Velocity);
    assert!(velocity.is_none_or(|gain| (gain.value - 0.05).abs() < 4.0 * gain.std), "{found:?}");
    for (term, value, within) in
        [(Term::Error, 6.0, 0.03), (Term::Integral, 2.0, 0.03), (Term::ReferenceRate, 0.35, 0.1)]
    {
        assert!((found.gain(term) / value - 1.0).abs() < within, "{term:?}: {found:?}");
    }
    assert!(found.misses < 3e-3, "{found:?}");
}

#[test]
fn a_loop_closed_in_hardware_is_found_from_the_motion() {
    let mut seen = Vec::new();
    let mut law = |r: f64, _: f64, x: f64, _: f64| {
        seen.push(r);
        4.0 * (r - x)
    };
    let mut hard = log(&mut law);
    hard.command = hard.reference.iter().map(|r| 80.0 * r).collect();
    let found = identify(&[hard]).unwrap();
    assert_eq!(found.closure, Closure::Hardwired, "{found:?}");
    assert!((found.scale / 80.0 - 1.0).abs() < 1e-3 && (found.gain(Term::Error) / 9.6 - 1.0).abs() < 0.02, "{found:?}");
    assert!((found.delay + found.lag - 3e-3 - 1.0 / 60.0).abs() < 2e-3, "{found:?}");
}

#[test]
fn a_reference_that_rests_tells_nothing() {
    let still = Log {
        dt: 1e-3,
        reference: vec![0.0; 4000],
        command: vec![0.0; 4000],
        displacement: vec![0.0; 4000],
        ..Log::default()
    };
    assert_eq!(identify(&[still]).unwrap_err(), InnerLoopError::Still);
    assert!(matches!(identify(&[Log::default()]), Err(InnerLoopError::TooShort { .. })));
}

/// A gain whose error reaches to zero, or that contributes nothing, is named and not stated.
#[test]
fn what_the_data_do_not_determine_is_not_stated() {
    let gain = |term, value, std, share| Gain { term, value, std, share };
    let found = InnerLoop {
        closure: Closure::Command,
        gains: vec![
            gain(Term::Error, 20.000_81, 1.3e-2, 1.0),
            gain(Term::Velocity, 0.0435, 4.3e-2, 0.1),
            gain(Term::ReferenceRate, 1e-7, 2e-8, 1e-7),
        ],
        delay: 0.0,
        lag: 0.0,
        filter: 0.0,
        scale: 1.0,
        misses: 1e-3,
        band: (0.1, 20.0),
    };
    let words = found.describe();
    assert!(words.contains("kp = 20.001 +/- 0.013; not determined: kv, kvf; delay"), "{words}");
}
