//! The fault campaign: a sample keeps its promises, a deaf guard would be seen, and a campaign stops, goes on and joins.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown::blocks::faults::campaign::{join, run, run_shard};
use shakedown::blocks::faults::class::{Channel, Fault};
use shakedown::blocks::faults::spoil::SignalFault;
use shakedown::blocks::faults::watcher::{Violation, judge};
use shakedown::blocks::faults::{Beside, CampaignError, Case, Class, Motions, Plan, Summary};
use shakedown_core::Settings;
use shakedown_core::settings::{
    EnvelopeSettings, GuardSettings, PlausibilitySettings, ValveMonitorSettings, WitnessSettings,
};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

const SEED: u64 = 3;

static MOTIONS: LazyLock<Motions> = LazyLock::new(|| Motions::new(None).unwrap());

fn plan(runs: u64) -> Plan {
    Plan { seed: SEED, runs, class: None, beside: Beside::LimitSwitches, records: Vec::new(), version: "test".into() }
}

#[test]
fn a_sample_keeps_its_promises() {
    let summary = Summary::of(&run(&plan(120), &MOTIONS, &|_| ()).unwrap());
    assert!(summary.failed.is_empty(), "{:?}", summary.failed);
    let row = |class: &str| summary.rows.iter().find(|row| row.class == class);
    assert!(summary.rows.len() > 25, "{} classes", summary.rows.len());
    assert!(row("lvdt-open").is_some_and(|row| row.reported == row.runs));
}

/// The same settings with a guard that believes everything and stops nothing.
fn deaf(settings: &Settings) -> Settings {
    let guard = GuardSettings {
        envelope: EnvelopeSettings {
            margin: 0.0,
            stopping_latency: 0.0,
            stopping_deceleration: 1000.0,
            velocity: 100.0,
            tracking: 100.0,
            ..EnvelopeSettings::default()
        },
        plausibility: PlausibilitySettings {
            lost: 1.0,
            stuck: 10.0,
            disagreement: 1.0,
            offset: 1000.0,
            acceleration_noise: 1e4,
        },
        witness: WitnessSettings { scale: 0.5, delay: 0.1, bias: 100.0, noise: 100.0, ..WitnessSettings::default() },
        valve: ValveMonitorSettings { mismatch: 10.0, memory: 0.2 },
        ..GuardSettings::default()
    };
    Settings { guard: Some(guard), ..*settings }
}

/// What a class breaks over some runs under a deaf guard.
fn broken_when_deaf(class: &str) -> Vec<Violation> {
    let class = Class::named(class).unwrap();
    let runs = (0..12).map(|number| {
        let mut case = Case::deal(SEED, number, Some(class), &MOTIONS).guard_alone();
        case.settings = deaf(&case.settings);
        judge(&case).unwrap().broken
    });
    runs.flatten().collect()
}

#[test]
fn a_deaf_guard_would_be_seen() {
    assert!(broken_when_deaf("lvdt-open").contains(&Violation::Late));
    let stuck = broken_when_deaf("lvdt-stuck");
    assert!(stuck.contains(&Violation::Excursion) && stuck.contains(&Violation::Unreported), "{stuck:?}");
    assert!(broken_when_deaf("lvdt-reversed").contains(&Violation::Excursion));
    assert!(broken_when_deaf("command-runaway").contains(&Violation::Excursion));
    let over = broken_when_deaf("valve-hard-over");
    assert!(over.contains(&Violation::Late) || over.contains(&Violation::Unreported), "{over:?}");
}

/// A creep, m/s, that an unknown null of the valve explains as well: it is not promised that the guard alone sees it.
const CREEP: f64 = 0.007;

/// What no guard can see by LVDT, accelerometer and command, the limit switches do, or a second displacement sensor.
#[test]
fn a_creeping_lvdt_is_what_the_limit_switches_are_for() {
    let class = Class::named("lvdt-creeping").unwrap();
    let creeping = |number| {
        let case = Case::deal(SEED, number, Some(class), &MOTIONS);
        let sign = if number % 2 == 0 { 1.0 } else { -1.0 };
        let fault = Fault::Signal(Channel::Displacement, SignalFault::Drifting(sign * CREEP));
        // From soon after the start on, so that it lasts.
        let onset = (1.5 * case.rate()) as usize;
        Case { fault, onset, ..case }
    };
    let outside = |beside| {
        let outcomes = (0..60).map(|number| judge(&creeping(number).beside(beside)).unwrap());
        let outcomes: Vec<_> = outcomes.collect();
        assert!(outcomes.iter().all(|outcome| !outcome.broken.contains(&Violation::Excursion)));
        outcomes.iter().filter(|outcome| outcome.outside).count()
    };
    assert!(outside(Beside::Nothing) > 0);
    assert_eq!(outside(Beside::LimitSwitches), 0);
    assert_eq!(outside(Beside::SecondSensor), 0);
}

#[test]
fn a_campaign_stops_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, done) = (plan(20), AtomicU64::new(0));
    let count = |n| {
        done.fetch_add(n, Ordering::Relaxed);
    };
    let missing = join(&plan, folder.path());
    assert!(matches!(missing, Err(CampaignError::Missing { missing: 20, .. })), "{missing:?}");
    run_shard(&plan, (2, 2), folder.path(), &MOTIONS, &count).unwrap();
    assert_eq!(done.load(Ordering::Relaxed), 0, "all twenty are the first shard's");
    run_shard(&plan, (1, 2), folder.path(), &MOTIONS, &count).unwrap();
    let written = std::fs::read(folder.path().join("chunk-00000.json")).unwrap();
    run_shard(&plan, (1, 1), folder.path(), &MOTIONS, &count).unwrap();
    assert_eq!(done.load(Ordering::Relaxed), 40);
    assert_eq!(std::fs::read(folder.path().join("chunk-00000.json")).unwrap(), written);
    assert_eq!(join(&plan, folder.path()).unwrap(), run(&plan, &MOTIONS, &|_| ()).unwrap());
    let other = Plan { seed: SEED + 1, ..plan };
    assert!(matches!(run_shard(&other, (1, 1), folder.path(), &MOTIONS, &count), Err(CampaignError::Other(_))));
}
