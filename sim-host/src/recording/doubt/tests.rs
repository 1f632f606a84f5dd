use super::*;
use crate::recording::check::{Fault, Finding, Severity};
use crate::recording::clock::Clock;
use crate::recording::experiment::Experiment;
use crate::recording::holdout::HeldBack;
use crate::recording::law::{RecordedLaw, Shaping};
use crate::recording::model::{Accuracy, Baseline, Model, Servo};
use crate::recording::run::{Run, Use};
use crate::recording::{Channel, PerChannel};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::BTreeMap;

const DT: f64 = 0.002;
const N: usize = 8000;
const NOISE: f64 = 1e-5;

/// A table of one lag behind a PI law, its displacement recorded as the controller saw it.
pub(crate) fn experiment(ran: &RecordedLaw, shaping: Shaping, seed: u64) -> Experiment {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
    let RecordedLaw::ProportionalIntegral { kp, ki } = *ran else { panic!("a PI law") };
    let (mut x, mut sum, mut before) = (0.0, 0.0, 0.0);
    let mut seen_before = vec![0.0; shaping.late_displacement + 1];
    let (mut reference, mut displacement, mut command) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..N {
        let t = k as f64 * DT;
        let r = 0.02 * (1.0 + (0.31 * t).sin()) * ((4.0 * t).sin() + 0.3 * (11.0 * t + 1.0).sin());
        let seen = x + NOISE * normal();
        seen_before.rotate_right(1);
        seen_before[0] = seen;
        let error = r - seen_before[shaping.late_displacement];
        sum += error * DT;
        let u = kp * error + ki * sum + shaping.kvf * (r - before) / DT;
        before = r;
        reference.push(r);
        displacement.push(seen);
        command.push(u);
        x += DT * 2.4 * u;
    }
    let acceleration = crate::recording::signal::curvature(&displacement, DT).iter().map(|a| a * 0.0).collect();
    let mut channels = PerChannel::default();
    channels.set(Channel::Reference, reference);
    channels.set(Channel::Displacement, displacement);
    channels.set(Channel::Acceleration, acceleration);
    channels.set(Channel::Command, command);
    let mut noise = PerChannel::default();
    noise.set(Channel::Displacement, NOISE);
    let run = Run {
        name: "a.csv".into(),
        path: "a.csv".into(),
        dt: DT,
        time: (0..N).map(|k| k as f64 * DT).collect(),
        channels,
        noise,
        loop_noise: None,
        law: ran.clone(),
        shaping: Shaping::default(),
        controller_rate_hz: None,
        purpose: Use::Fit,
        cut: false,
        error_before: 0.0,
        sent_before: Vec::new(),
        elapsed: 0.0,
        clock: Clock::default(),
    };
    let servo = Servo { b1: 0.7, b0: 138.0, a1: 57.6, velocity_limit: None, mass: None, piston_area: None };
    Experiment {
        name: "a".into(),
        path: "a.toml".into(),
        model: Model {
            baseline: Baseline::Servo(servo),
            fit: Vec::new(),
            effects: Vec::new(),
            bandwidth_hz: None,
            accuracy: BTreeMap::<String, Accuracy>::new(),
            own: Vec::new(),
        },
        sources: PerChannel::default(),
        runs: vec![run],
        held_back: HeldBack::Stated,
        inputs: Vec::new(),
        notes: Vec::new(),
    }
}

fn pi(kp: f64, ki: f64) -> RecordedLaw {
    RecordedLaw::ProportionalIntegral { kp, ki }
}

fn kinds(found: &SetUp) -> Vec<Doubt> {
    found.findings.iter().map(|f| f.what).collect()
}

#[test]
fn a_set_up_that_is_as_stated_raises_no_doubt() {
    for seed in 0..20 {
        let found = doubt(&experiment(&pi(4.0, 1.0), Shaping::default(), seed));
        assert!(found.findings.is_empty(), "{seed}: {:?}", found.findings);
    }
}

#[test]
fn gains_stated_one_per_cent_wrong_are_found_to_a_part_in_ten_thousand() {
    let mut stated = experiment(&pi(4.0, 1.0), Shaping::default(), 1);
    stated.runs[0].law = pi(4.04, 0.97);
    let found = doubt(&stated);
    assert_eq!(kinds(&found), [Doubt::ControllerKp, Doubt::ControllerKi]);
    let RecordedLaw::ProportionalIntegral { kp, ki } = found.experiment.runs[0].law else { panic!() };
    assert!((kp / 4.0 - 1.0).abs() < 1e-4 && (ki - 1.0).abs() < 1e-3, "{kp} {ki}");
}

/// A clock that is slow by less than gains are stated wrong by, and none that is as good as a quartz; a gain that is as far off with the
/// other is no clock.
#[test]
fn a_clock_that_is_a_little_slow_is_told_by_the_law() {
    let of = |rate: f64, kp: f64| {
        let mut slow = experiment(&pi(4.0, 1.0), Shaping::default(), 1);
        slow.runs[0].law = pi(kp, 1.0);
        slow.runs[0].dt /= 1.0 + rate;
        doubt(&slow)
    };
    let found = of(4e-4, 4.0);
    assert_eq!(kinds(&found), [Doubt::ClockRate]);
    let period = &found.findings[0];
    assert!((period.found / period.stated.unwrap() - 1.0 - 4e-4).abs() < 2e-6, "{period:?}");
    assert!(of(2e-5, 4.0).findings.is_empty());
    assert!(of(4e-4, 4.001).findings.is_empty());
}

#[test]
fn feed_forward_that_nobody_stated_is_found() {
    let found = doubt(&experiment(&pi(4.0, 1.0), Shaping { kvf: 0.3, ..Shaping::default() }, 2));
    assert_eq!(kinds(&found), [Doubt::ControllerKvf]);
    assert!((found.experiment.runs[0].shaping.kvf - 0.3).abs() < 1e-3);
}

#[test]
fn a_controller_that_sees_the_displacement_late_is_found() {
    let found = doubt(&experiment(&pi(4.0, 1.0), Shaping { late_displacement: 2, ..Shaping::default() }, 3));
    assert_eq!(kinds(&found), [Doubt::ControllerDelay]);
    assert_eq!(found.experiment.runs[0].shaping.late_displacement, 2);
}

#[test]
fn a_displacement_that_drifts_in_the_recording_alone_is_straightened() {
    let mut drifting = experiment(&pi(4.0, 1.0), Shaping::default(), 4);
    let straight = drifting.runs[0].channel(Channel::Displacement).unwrap().to_vec();
    let drift = |k: usize| 2e-4 * (k as f64 / N as f64 - 0.5);
    let with = straight.iter().enumerate().map(|(k, x)| x + drift(k)).collect();
    drifting.runs[0].channels.set(Channel::Displacement, with);
    let found = doubt(&drifting);
    assert_eq!(kinds(&found), [Doubt::Drift]);
    assert!((found.findings[0].found / 2e-4 - 1.0).abs() < 0.05, "{:?}", found.findings);
}

#[test]
fn hum_of_the_displacement_is_taken_off() {
    let mut humming = experiment(&pi(4.0, 1.0), Shaping::default(), 5);
    let clean = humming.runs[0].channel(Channel::Displacement).unwrap().to_vec();
    let hum = |k: usize| 3e-5 * (std::f64::consts::TAU * 50.0 * k as f64 * DT + 0.7).sin();
    humming.runs[0].channels.set(Channel::Displacement, clean.iter().enumerate().map(|(k, x)| x + hum(k)).collect());
    let found = doubt(&humming);
    assert!(kinds(&found).contains(&Doubt::Hum), "{:?}", found.findings);
    let cleaned = found.experiment.runs[0].channel(Channel::Displacement).unwrap();
    let left = cleaned.iter().zip(&clean).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / N as f64;
    assert!(left.sqrt() < 2e-6, "{}", left.sqrt());
}

/// A controller that acts on the hum, through a derivative at that, sent the recorded command: what it made of the hum is known beside the
/// cleaned displacement. One that never saw it is left alone.
#[test]
fn what_a_controller_made_of_hum_is_kept() {
    let cascade = RecordedLaw::Cascade { kp: 58.0, kv: 225.0 };
    let hum = |k: usize| 3e-5 * (std::f64::consts::TAU * 50.0 * k as f64 * DT + 0.7).sin();
    let of = |seen: f64| {
        let mut run = experiment(&pi(4.0, 1.0), Shaping::default(), 5);
        let [reference, clean] =
            [Channel::Reference, Channel::Displacement].map(|c| run.runs[0].channel(c).unwrap().to_vec());
        let saw: Vec<f64> = clean.iter().enumerate().map(|(k, x)| x + seen * hum(k)).collect();
        let law = |k: usize| 58.0 * 225.0 * (reference[k] - saw[k]) - 225.0 * (saw[k] - saw[k.saturating_sub(1)]) / DT;
        let channels = &mut run.runs[0].channels;
        channels.set(Channel::Command, (0..N).map(law).collect());
        channels.set(Channel::Displacement, clean.iter().enumerate().map(|(k, x)| x + hum(k)).collect());
        run.runs[0].law = cascade.clone();
        doubt(&run)
    };
    let heard = of(1.0);
    assert!(kinds(&heard).contains(&Doubt::Hum), "{:?}", heard.findings);
    let added = heard.experiment.runs[0].channel(Channel::Disturbance).unwrap();
    let most = added.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    assert!((1.5..3.0).contains(&most), "{most}");
    let of_law = |f: &Finding| matches!(f.fault, Fault::WrongController | Fault::MissingInput);
    assert!(!check(&heard.experiment).iter().any(of_law));
    let unheard = of(0.0);
    assert!(unheard.experiment.runs[0].channel(Channel::Disturbance).is_none());
}

/// A gap that no interpolation can stand for cuts a run in two; a short one does not.
#[test]
fn a_long_gap_cuts_the_run() {
    let law = RecordedLaw::ProportionalIntegral { kp: 2.0, ki: 0.5 };
    let with_gap = |seconds: f64, alone: Option<Channel>| {
        let mut experiment = experiment(&law, Shaping::default(), 3);
        let run = &mut experiment.runs[0];
        let missing = 3000..3000 + (seconds / DT) as usize;
        let channels: Vec<Channel> = run.channels.iter().map(|(channel, _)| channel).collect();
        for channel in channels.into_iter().filter(|c| alone.is_none_or(|alone| alone == *c)) {
            let mut samples = run.channel(channel).unwrap().to_vec();
            samples[missing.clone()].fill(f64::NAN);
            run.channels.set(channel, samples);
        }
        doubt(&experiment)
    };
    assert_eq!(with_gap(0.1, None).experiment.runs.len(), 1);
    // What the loop itself makes is compared where it was recorded.
    let lost = with_gap(0.4, Some(Channel::Displacement));
    assert_eq!(lost.experiment.runs.len(), 1);
    let bad = |f: &Finding| f.fault == Fault::MissingStretch && f.severity == Severity::BadData;
    assert!(!check(&lost.experiment).iter().any(bad));
    let cut = with_gap(0.4, None);
    assert_eq!(cut.experiment.runs.len(), 2);
    assert!(!cut.experiment.runs[0].cut && cut.experiment.runs[1].cut);
    assert!(cut.findings.iter().any(|f| f.what == Doubt::LostRows && (f.found - 0.4).abs() < 1e-9));
    assert!(check(&cut.experiment).iter().all(|f| f.fault != Fault::MissingStretch));
}

#[test]
fn a_small_stated_value_is_not_shown_as_nothing() {
    let sentence = SetUpFinding::noise("displacement", 2.38e-5, 4.385e-5, 1.2e-6, "m").sentence();
    assert!(sentence.contains("4.39e-5 +/- 1.2e-6 m, stated 2.38e-5 m"), "{sentence}");
}

/// The accelerometer of [`experiment`] with a motion on it that its range cuts off.
fn cut_off(range: f64) -> Experiment {
    let mut cut = experiment(&RecordedLaw::ProportionalIntegral { kp: 3.0, ki: 0.5 }, Shaping::default(), 3);
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut noise = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
    let swing = |k: usize| (4.0 * k as f64 * DT).sin() + 0.4 * (13.0 * k as f64 * DT).sin();
    let samples = (0..N).map(|k| (swing(k) + 0.01 * noise()).clamp(-range, range)).collect();
    cut.runs[0].channels.set(Channel::Acceleration, samples);
    cut
}

#[test]
fn what_a_range_cuts_off_is_left_out_and_said() {
    let cut = cut_off(1.1);
    assert!(check(&cut).iter().any(|f| f.fault == Fault::Clipped && f.severity == Severity::BadData));
    let (rest, remarks) = without_clipped(&cut);
    assert!(remarks.len() == 1 && remarks[0].severity == Severity::Remark && remarks[0].remedy.contains("left out"));
    let left = rest.runs[0].channel(Channel::Acceleration).unwrap();
    let of = cut.runs[0].channel(Channel::Acceleration).unwrap();
    assert!(left.iter().zip(of).all(|(l, o)| if o.abs() < 1.1 { l == o } else { l.is_nan() }));
    assert!(check(&rest).iter().all(|f| f.fault != Fault::Clipped));
    // Most of it cut off is a recording of nothing, and stays one.
    let (rest, remarks) = without_clipped(&cut_off(0.4));
    assert!(remarks.is_empty() && check(&rest).iter().any(|f| f.fault == Fault::Clipped));
}

/// The command as a logger recorded it, changed.
fn with_command(change: impl Fn(&[f64]) -> Vec<f64>, seed: u64) -> Experiment {
    let mut recorded = experiment(&pi(4.0, 1.0), Shaping::default(), seed);
    let sent = recorded.runs[0].channel(Channel::Command).unwrap().to_vec();
    recorded.runs[0].channels.set(Channel::Command, change(&sent));
    recorded
}

#[test]
fn a_command_recorded_late_by_part_of_a_sample_leaves_the_gains_as_they_are() {
    for samples in [1.4, 4.0, 9.3] {
        let late = with_command(|sent| crate::scalar::earlier(sent, -samples), 5);
        let found = doubt(&late);
        assert_eq!(kinds(&found), [Doubt::ControllerDelay], "{samples}: {:?}", found.findings);
        assert!((found.findings[0].found / DT - samples).abs() < 0.15, "{samples}: {:?}", found.findings);
    }
}

#[test]
fn a_command_recorded_through_a_low_pass_is_restored() {
    for samples in [3.0, 8.0] {
        let slow = with_command(|sent| crate::recording::lag::lagged(sent, samples), 6);
        let found = doubt(&slow);
        assert_eq!(kinds(&found), [Doubt::SensorLag], "{samples}: {:?}", found.findings);
        assert!((found.findings[0].found / DT / samples - 1.0).abs() < 0.03, "{samples}: {:?}", found.findings);
    }
}
