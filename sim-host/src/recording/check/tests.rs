//! Clean recordings, whatever physics is in them, must pass; each fault must be called by its name.

use super::*;
use crate::recording::channel::PerChannel;
use crate::recording::clock::{self, Clock};
use crate::recording::experiment::{ChannelSource, Origin};
use crate::recording::run::Use;
use crate::recording::unit::Unit;
use crate::recording::{Experiment, RecordedLaw, Servo};
use std::f64::consts::PI;
use std::path::PathBuf;

/// A closed-loop test of the paper's plant, with physics that a model may be missing.
#[derive(Debug, Clone, Copy)]
struct Bench {
    seed: u64,
    rate: f64,
    seconds: f64,
    /// Peak of the reference, m.
    peak: f64,
    /// Largest frequency of the reference, Hz.
    band: f64,
    kp: f64,
    deadband: f64,
    acceleration_gain: f64,
    acceleration_lag: f64,
    displacement_lag: f64,
    backlash: f64,
    /// Frequency of a base on springs, Hz; zero for none.
    base: f64,
    hum: f64,
}

const CLEAN: Bench = Bench {
    seed: 1,
    rate: 1000.0,
    seconds: 30.0,
    peak: 0.03,
    band: 3.0,
    kp: 3.7,
    deadband: 0.0,
    acceleration_gain: 1.0,
    acceleration_lag: 0.0,
    displacement_lag: 0.0,
    backlash: 0.0,
    base: 0.0,
    hum: 0.0,
};

struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

impl Bench {
    fn reference(&self, random: &mut Random) -> Vec<f64> {
        let n = (self.rate * self.seconds) as usize;
        let lines: Vec<(f64, f64, f64)> = (0..60)
            .map(|i| {
                let f = 0.15 + (self.band - 0.15) * f64::from(i) / 60.0;
                (f, (1.0 + (f / 0.8).powi(2)).recip(), 2.0 * PI * random.uniform())
            })
            .collect();
        let shape = |k: usize| {
            let t = k as f64 / self.rate;
            let envelope = ((t - 1.0) / 3.0).clamp(0.0, 1.0).powi(2) * ((self.seconds - 2.0 - t) / 6.0).clamp(0.0, 1.0);
            envelope * lines.iter().map(|(f, a, p)| a * (2.0 * PI * f * t + p).sin()).sum::<f64>()
        };
        let raw: Vec<f64> = (0..n).map(shape).collect();
        let largest = raw.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        raw.iter().map(|x| x * self.peak / largest).collect()
    }

    fn run(&self) -> Run {
        let mut random = Random(self.seed);
        let reference = self.reference(&mut random);
        let (dt, inner) = (1.0 / self.rate, 20);
        let h = dt / f64::from(inner);
        let (b1, b0, a1, limit) = (0.69, 138.0, 57.65, 0.242);
        let (mut z, mut x, mut sum, mut v_before) = (0.0, 0.0, 0.0, 0.0);
        let (mut lagged_x, mut lagged_a, mut table, mut base, mut base_v) = (0.0, 0.0, 0.0f64, 0.0, 0.0);
        let mut columns: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::new());
        for (k, &r) in reference.iter().enumerate() {
            lagged_x += (x - lagged_x)
                * if self.displacement_lag > 0.0 { 1.0 - (-dt / self.displacement_lag).exp() } else { 1.0 };
            let measured = 4e-5 * (lagged_x / 4e-5 + 0.5).floor();
            let e = r - measured;
            sum += e * dt;
            let u = self.kp * e + 0.6 * sum;
            let valve = u - u.clamp(-self.deadband, self.deadband);
            let mut v = 0.0;
            for _ in 0..inner {
                v = f64::clamp(z + b1 * valve, -limit, limit);
                z += h * (-a1 * z + (b0 - b1 * a1) * valve);
                x += h * v;
            }
            let before = table;
            table = table.clamp(x - self.backlash / 2.0, x + self.backlash / 2.0);
            let v_table = if self.backlash > 0.0 { (table - before) / dt } else { v };
            let a = (v_table - v_before) / dt;
            v_before = v_table;
            let w = 2.0 * PI * self.base;
            base_v += dt * (-w * w * base - 0.1 * w * base_v - 0.3 * a);
            base += dt * base_v;
            let absolute = if self.base > 0.0 { a - w * w * base - 0.1 * w * base_v - 0.3 * a } else { a };
            let keep = if self.acceleration_lag > 0.0 { 1.0 - (-dt / self.acceleration_lag).exp() } else { 1.0 };
            lagged_a += keep * (self.acceleration_gain * absolute - lagged_a);
            let hum = self.hum * (2.0 * PI * 50.0 * k as f64 * dt).sin();
            let noisy = lagged_a + hum + 0.02 * 9.80665 * random.normal();
            columns.iter_mut().zip([r, measured, noisy, u]).for_each(|(c, value)| c.push(value));
        }
        run_of(columns, dt, RecordedLaw::ProportionalIntegral { kp: self.kp, ki: 0.6 })
    }
}

fn run_of([reference, displacement, acceleration, command]: [Vec<f64>; 4], dt: f64, law: RecordedLaw) -> Run {
    let time: Vec<f64> = (0..reference.len()).map(|k| k as f64 * dt).collect();
    let mut channels = PerChannel::default();
    channels.set(Channel::Reference, reference);
    channels.set(Channel::Displacement, displacement);
    channels.set(Channel::Acceleration, acceleration);
    channels.set(Channel::Command, command);
    Run {
        name: "a.csv".into(),
        path: "a.csv".into(),
        dt,
        time,
        channels,
        noise: PerChannel::default(),
        loop_noise: None,
        law,
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

/// A table that slowly comes and goes, and what its accelerometer shows.
pub(super) fn at_rest_with(acceleration: Vec<f64>, dt: f64) -> Run {
    let slow: Vec<f64> = (0..acceleration.len()).map(|k| 0.01 * (0.5 * k as f64 * dt).sin()).collect();
    let nothing = vec![0.0; acceleration.len()];
    run_of([slow.clone(), slow, acceleration, nothing], dt, RecordedLaw::Open)
}

fn sources() -> PerChannel<ChannelSource> {
    let mut sources = PerChannel::default();
    for (channel, unit) in [
        (Channel::Reference, "m"),
        (Channel::Displacement, "m"),
        (Channel::Acceleration, "m/s2"),
        (Channel::Command, "1"),
    ] {
        let unit = Unit::named(unit).unwrap();
        sources.set(
            channel,
            ChannelSource {
                origin: Origin::Column(channel.name().into()),
                unit,
                noise: None,
                loop_noise: None,
                optional: false,
            },
        );
    }
    sources
}

fn findings(run: &Run) -> Vec<Finding> {
    check_run(run, &sources(), &BASELINE)
}

/// The paper's plant.
const BASELINE: Baseline = Baseline::Servo(Servo {
    b1: 0.69,
    b0: 138.0,
    a1: 57.65,
    velocity_limit: Some(0.242),
    mass: None,
    piston_area: None,
});

/// The findings that turn the verdict, as (channel, fault).
fn bad(run: &Run) -> Vec<(&'static str, Fault)> {
    findings(run).iter().filter(|f| f.severity == Severity::BadData).map(|f| (f.channel, f.fault)).collect()
}

fn changed(run: &Run, channel: Channel, change: impl Fn(usize, f64) -> f64) -> Run {
    let samples = run.channel(channel).unwrap().iter().enumerate().map(|(k, &x)| change(k, x)).collect();
    let mut run = run.clone();
    run.channels.set(channel, samples);
    run
}

fn swapped(run: &Run, a: Channel, b: Channel) -> Run {
    let mut out = run.clone();
    out.channels.set(a, run.channel(b).unwrap().to_vec());
    out.channels.set(b, run.channel(a).unwrap().to_vec());
    out
}

/// Clean recordings of many kinds of tables and motions.
fn clean() -> Vec<(&'static str, Bench)> {
    vec![
        ("clean", CLEAN),
        ("another seed", Bench { seed: 7, ..CLEAN }),
        ("barely moving", Bench { peak: 0.002, ..CLEAN }),
        ("severe saturation", Bench { peak: 0.15, band: 6.0, kp: 10.0, ..CLEAN }),
        ("slow sampling", Bench { rate: 200.0, ..CLEAN }),
        ("short", Bench { seconds: 12.0, ..CLEAN }),
        ("gain 1.2", Bench { acceleration_gain: 1.2, ..CLEAN }),
        ("accelerometer lag 20 ms", Bench { acceleration_lag: 0.02, ..CLEAN }),
        ("LVDT lag 20 ms", Bench { displacement_lag: 0.02, ..CLEAN }),
        ("deadband", Bench { deadband: 0.002, ..CLEAN }),
        ("backlash", Bench { backlash: 0.0005, ..CLEAN }),
        ("base on springs", Bench { base: 8.0, ..CLEAN }),
        ("hum", Bench { hum: 0.5, ..CLEAN }),
    ]
}

#[test]
fn no_physics_is_taken_for_bad_data() {
    for (name, bench) in clean() {
        let run = bench.run();
        assert_eq!(bad(&run), [], "{name}: {:#?}", findings(&run));
        for part in [run.part(0, run.len() * 2 / 3), run.part(run.len() * 2 / 3, run.len())] {
            assert_eq!(bad(&part), [], "{name}, a part: {:#?}", findings(&part));
        }
    }
}

/// A valve so slow that the table moves against its reference is physics where the stated controller makes the recorded
/// command of it, and bad data where it does not.
#[test]
fn a_controller_that_is_reproduced_vouches_for_its_channels() {
    let dt = 0.005;
    let tones = [(0.4, 0.03), (0.9, 0.02), (1.7, 0.01)];
    let sum = |order: i32, k: usize| {
        let tone = |(hz, size): &(f64, f64)| {
            let w = 2.0 * PI * hz;
            size * w.powi(order) * (w * k as f64 * dt + f64::from(order) * PI / 2.0).sin()
        };
        tones.iter().map(tone).sum::<f64>()
    };
    let series = |order: i32, factor: f64| (0..6000).map(|k| factor * sum(order, k)).collect::<Vec<_>>();
    let (reference, displacement) = (series(0, 1.0), series(0, -0.5));
    let mut integral = 0.0;
    let errors = reference.iter().zip(&displacement).map(|(r, x)| r - x);
    let command = errors.map(|e| {
        integral += e * dt;
        3.7 * e + 0.6 * integral
    });
    let command = command.collect();
    let law = RecordedLaw::ProportionalIntegral { kp: 3.7, ki: 0.6 };
    let run = run_of([reference, displacement, series(2, -0.5), command], dt, law);
    assert_eq!(bad(&run), [], "{:#?}", findings(&run));
    let other = changed(&run, Channel::Command, |k, u| u + 0.2 * (0.37 * (k * k % 1009) as f64).sin());
    assert!(!bad(&other).is_empty(), "{:#?}", findings(&other));
}

/// A spike of the displacement that the loop was given is in its command. Dropped from the recording, it makes no other controller.
#[test]
fn a_sample_that_is_dropped_is_no_fault_of_the_controller() {
    let (dt, kp, kv) = (0.002, 20.0, 140.0);
    let motion = |k: usize| 1e-3 * (2.0 * PI * 0.5 * k as f64 * dt).sin();
    let spiked = |k: usize| motion(k) + if k % 1009 == 700 { 3e-4 } else { 0.0 };
    let series = |of: &dyn Fn(usize) -> f64| (0..8000).map(of).collect::<Vec<_>>();
    let command = |k: usize| kv * (kp * (motion(k) - spiked(k)) - (spiked(k) - spiked(k.saturating_sub(1))) / dt);
    let law = RecordedLaw::Cascade { kp, kv };
    let acceleration = |k: usize| -PI * PI * motion(k);
    let run = run_of([series(&motion), series(&spiked), series(&acceleration), series(&command)], dt, law);
    let dropped = changed(&run, Channel::Displacement, |k, x| if k % 1009 == 700 { f64::NAN } else { x });
    let of_the_controller = |run: &Run| bad(run).iter().any(|(channel, _)| *channel == "command");
    assert!(!of_the_controller(&dropped), "{:#?}", findings(&dropped));
    let other = changed(&dropped, Channel::Command, |k, u| u + 0.2 * (0.37 * (k * k % 1009) as f64).sin());
    assert!(of_the_controller(&other), "{:?}", findings(&other));
}

#[test]
fn a_clean_table_leaves_nothing_to_remark() {
    assert_eq!(findings(&CLEAN.run()), []);
}

/// A table at its limit follows a sine of 50/9 Hz as a saw-tooth, whose ninth harmonic is at 50 Hz while it moves.
#[test]
fn harmonics_of_a_saw_tooth_are_no_hum() {
    let hums = |hum: f64| {
        let (dt, f, mut random) = (1e-3, 50.0 / 9.0, Random(7));
        let mut columns = [const { Vec::new() }; 4];
        for k in 0..30_000 {
            let t = f64::from(k) * dt;
            let moving = f64::from(u8::from((6.0..22.0).contains(&t)));
            let tone = |n: f64| (2.0 * PI * n * f * t).sin();
            let square = (0..12).map(|i| f64::from(2 * i + 1)).map(|n| tone(n) / n).sum::<f64>();
            let spikes = (0..12).map(|i| f64::from(2 * i + 1)).map(tone).sum::<f64>();
            let noise = 0.2 * random.normal() + hum * (2.0 * PI * 50.0 * t).sin();
            let row = [0.01 * moving * tone(1.0), 0.005 * moving * square, moving * spikes + noise, 0.0];
            columns.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
        }
        let run = run_of(columns, dt, RecordedLaw::ProportionalIntegral { kp: 3.7, ki: 0.6 });
        hum::check(&run).iter().any(|f| f.channel == "acceleration")
    };
    assert!(!hums(0.0), "a harmonic was mistaken for hum");
    assert!(hums(2.0), "hum was overlooked");
}

/// Gravity on an accelerometer that tilts with travel turns its slow part round, here below 0.7 to 2 Hz. Exchanged wires turn all of
/// it.
#[test]
fn a_tilting_accelerometer_is_not_turned_round() {
    for (seed, band) in [(1, 3.0), (2, 3.5), (3, 6.0)] {
        let run = Bench { seed, band, ..CLEAN }.run();
        let x = run.channels.get(Channel::Displacement).unwrap().clone();
        for pull in [20.0, 50.0, 92.0, 150.0] {
            let tilted = changed(&run, Channel::Acceleration, |k, a| a + pull * x[k]);
            assert!(bad(&tilted).is_empty(), "{band} Hz, {pull} 1/s2: {:?}", bad(&tilted));
        }
        let turned = changed(&run, Channel::Acceleration, |_, a| -a);
        assert_eq!(bad(&turned), [("acceleration", Fault::Inverted)]);
    }
}

/// Where all that both see is fast a delay of some samples turns the phase as a sign does.
#[test]
fn a_late_accelerometer_that_only_fast_motion_shows_is_not_turned_round() {
    let dt = 1.0 / 204.8;
    let mut random = Random(7);
    let lines: Vec<[f64; 3]> =
        (0..40).map(|i| [2.0 * PI * (26.0 + 0.5 * f64::from(i)), 1e-5, 2.0 * PI * random.uniform()]).collect();
    let at = |t: f64, power: i32| -> f64 { lines.iter().map(|[w, a, p]| a * w.powi(power) * (w * t + p).sin()).sum() };
    let displacement: Vec<f64> = (0..2458).map(|k| at(f64::from(k) * dt, 0)).collect();
    let acceleration = (0..2458).map(|k| -at(f64::from(k) * dt - 0.0082, 2) + 1e-3 * random.normal()).collect();
    let run = run_of([displacement.clone(), displacement, acceleration, vec![0.0; 2458]], dt, RecordedLaw::Open);
    assert!(bad(&run).is_empty(), "{:?}", findings(&run));
}

#[test]
fn each_fault_is_called_by_its_name() {
    use Channel::{Acceleration, Command, Displacement, Reference};
    for bench in [
        CLEAN,
        Bench { seed: 3, peak: 0.01, ..CLEAN },
        Bench { peak: 0.15, kp: 10.0, ..CLEAN },
        Bench { rate: 200.0, ..CLEAN },
    ] {
        let run = bench.run();
        let middle = run.len() / 2;
        let clip = |channel: Channel, part: f64| {
            let top = part * run.channel(channel).unwrap().iter().fold(0.0f64, |m, x| m.max(x.abs()));
            changed(&run, channel, |_, x| x.clamp(-top, top))
        };
        let held = |channel: Channel, from: usize, to: usize| {
            let value = run.channel(channel).unwrap()[from];
            changed(&run, channel, |k, x| if (from..to).contains(&k) { value } else { x })
        };
        let with_law = |law: RecordedLaw| Run { law, ..run.clone() };
        let second = |s: f64| (s * bench.rate) as usize;
        let cases = vec![
            (changed(&run, Acceleration, |_, a| -a), "acceleration", Fault::Inverted),
            (changed(&run, Displacement, |_, x| -x), "displacement", Fault::Inverted),
            (changed(&run, Acceleration, |_, a| a / 9.80665), "acceleration", Fault::WrongUnit),
            (changed(&run, Acceleration, |_, a| a * 9.80665), "acceleration", Fault::WrongUnit),
            (changed(&run, Acceleration, |_, a| a * 1e3), "acceleration", Fault::WrongUnit),
            (changed(&run, Displacement, |_, x| x * 1e3), "displacement", Fault::WrongUnit),
            (
                changed(&changed(&run, Displacement, |_, x| x * 1e3), Reference, |_, x| x * 1e3),
                "reference",
                Fault::WrongUnit,
            ),
            (changed(&run, Reference, |_, x| x * 1e3), "reference", Fault::WrongUnit),
            (swapped(&run, Displacement, Acceleration), "acceleration", Fault::Swapped),
            (swapped(&run, Displacement, Reference), "reference", Fault::Swapped),
            (swapped(&run, Displacement, Command), "displacement", Fault::Swapped),
            (swapped(&run, Acceleration, Command), "acceleration", Fault::Swapped),
            (held(Displacement, middle, middle + second(1.0)), "displacement", Fault::Stuck),
            (held(Displacement, middle, run.len()), "displacement", Fault::Stuck),
            (held(Displacement, 0, run.len()), "displacement", Fault::Stuck),
            (held(Acceleration, middle, middle + second(0.5)), "acceleration", Fault::Stuck),
            (clip(Displacement, 0.6), "displacement", Fault::Clipped),
            (clip(Acceleration, 0.4), "acceleration", Fault::Clipped),
            (
                with_law(RecordedLaw::ProportionalIntegral { kp: 2.0 * bench.kp, ki: 0.6 }),
                "command",
                Fault::WrongController,
            ),
            (
                with_law(RecordedLaw::ProportionalIntegral { kp: -bench.kp, ki: -0.6 }),
                "command",
                Fault::WrongController,
            ),
            (
                changed(
                    &run,
                    Command,
                    |k, u| if k / second(0.5) % 4 == 1 { u + 0.5 * bench.peak * bench.kp } else { u },
                ),
                "command",
                Fault::MissingInput,
            ),
            (
                changed(&run, Reference, |k, x| if (middle..middle + second(0.2)).contains(&k) { f64::NAN } else { x }),
                "reference",
                Fault::MissingStretch,
            ),
            (
                changed(&with_law(RecordedLaw::Open), Displacement, |k, x| {
                    if (middle..middle + second(0.2)).contains(&k) { f64::NAN } else { x }
                }),
                "displacement",
                Fault::MissingStretch,
            ),
        ];
        for (place, (faulty, channel, fault)) in cases.into_iter().enumerate() {
            let found = bad(&faulty);
            assert!(
                found.contains(&(channel, fault)) && found.iter().all(|f| f.1 == fault),
                "case {place}: wanted {fault:?} of {channel} at {} Hz, peak {}, got {:#?}",
                bench.rate,
                bench.peak,
                findings(&faulty)
            );
        }
    }
}

#[test]
fn a_channel_in_si_that_is_stated_in_g_is_named() {
    let mut sources = sources();
    let stated =
        ChannelSource { unit: Unit::named("g").unwrap(), ..sources.get(Channel::Acceleration).unwrap().clone() };
    sources.set(Channel::Acceleration, stated);
    let run = changed(&CLEAN.run(), Channel::Acceleration, |_, a| a * 9.80665);
    let finding = &check_run(&run, &sources, &BASELINE)[0];
    assert_eq!(finding.fault, Fault::WrongUnit);
    assert!(finding.problem.starts_with("acceleration: recorded in m/s2, not in g as stated"), "{}", finding.problem);
}

/// Where the size is all that speaks, more than one unit is possible, and none is named.
#[test]
fn a_unit_that_the_size_alone_speaks_against_is_asked_for() {
    let mut run = CLEAN.run();
    let mut lengths = PerChannel::default();
    for channel in [Channel::Reference, Channel::Displacement] {
        lengths.set(channel, run.channel(channel).unwrap().iter().map(|x| 1e3 * x).collect());
    }
    (run.channels, run.law) = (lengths, RecordedLaw::Open);
    let finding = &check_run(&run, &sources(), &BASELINE)[0];
    assert_eq!(finding.fault, Fault::WrongUnit);
    for said in ["not recorded in m as stated", "cm, mm"] {
        assert!(finding.problem.contains(said), "{}", finding.problem);
    }
    assert_eq!(finding.remedy, "write the unit that the recorder used for reference and displacement");
}

#[test]
fn what_can_be_physics_is_only_remarked() {
    let remark = |bench: Bench| -> Vec<Fault> { findings(&bench.run()).iter().map(|f| f.fault).collect() };
    assert!(remark(Bench { acceleration_lag: 0.008, ..CLEAN }).contains(&Fault::Skew));
    assert!(remark(Bench { hum: 0.5, ..CLEAN }).contains(&Fault::Hum));
    assert!(remark(Bench { peak: 0.0004, ..CLEAN }).contains(&Fault::CoarseSteps));
}

#[test]
fn stamps_that_repeat_scatter_or_are_missing_are_found() {
    let stamps: Vec<f64> = (0..5000).map(|k| f64::from(k) * 1e-3).collect();
    let found = |stamps: &[f64]| {
        let grid = clock::lay(stamps).unwrap();
        let n = grid.rows.len();
        let value = |k: &Option<usize>| k.map_or(f64::NAN, |r| (r as f64 * 0.01).sin());
        let samples: Vec<f64> = grid.rows.iter().map(value).collect();
        let mut channels = PerChannel::default();
        channels.set(Channel::Reference, samples);
        let time = (0..n).map(|k| k as f64 * grid.dt).collect();
        let run = Run { time, channels, dt: grid.dt, clock: grid.clock, ..CLEAN_RUN.with(Clone::clone) };
        findings(&run).iter().map(|f| (f.fault, f.severity)).collect::<Vec<_>>()
    };
    assert_eq!(found(&stamps), []);
    let doubled: Vec<f64> =
        stamps.iter().enumerate().map(|(k, t)| if (2000..2020).contains(&k) { stamps[1999] } else { *t }).collect();
    assert_eq!(found(&doubled)[0], (Fault::RepeatedTime, Severity::BadData));
    let mut dropped = stamps.clone();
    dropped.drain(1000..1200);
    assert_eq!(found(&dropped), [(Fault::MissingStretch, Severity::BadData)]);
    let jittering: Vec<f64> = stamps.iter().enumerate().map(|(k, t)| t + 2e-4 * (k as f64 * 1.7).sin()).collect();
    assert_eq!(found(&jittering), [(Fault::JitteringTime, Severity::Remark)]);
}

thread_local! {
    static CLEAN_RUN: Run = run_of(std::array::from_fn(|_| vec![0.0; 16]), 1e-3, RecordedLaw::Open);
}

fn data() -> PathBuf {
    std::env::var("SHAKEDOWN_DATA").map_or_else(|_| "../../shared/data".into(), PathBuf::from)
}

#[test]
fn the_real_tables_are_sound_and_their_late_accelerometers_are_found() {
    let folder = data().join("recordings/shake_table");
    if !folder.exists() {
        crate::skipped::without(&folder);
        return;
    }
    for name in ["CHY027", "KAU039", "TAP089"] {
        let experiment = Experiment::load(&folder.join(format!("{name}.toml"))).unwrap();
        let findings = check(&experiment);
        for finding in &findings {
            eprintln!("{name}: {} {:?} {:?}: {}", finding.run, finding.severity, finding.fault, finding.problem);
        }
        assert!(!is_bad_data(&findings), "{name}");
        let skew = Skew::of(&experiment.runs[0]).unwrap();
        assert!(skew.matters(experiment.runs[0].dt) && (skew.delay_s - 0.0081).abs() < 0.0008, "{name}: {skew:?}");
        assert!(findings.iter().any(|f| f.fault == Fault::Skew), "{name}");
    }
}

/// An experiment over one of the EMPS files, whatever stands in `more` added to its channels.
fn emps(file: &str, more: &str) -> Option<Experiment> {
    let path = data().join("recordings/emps").join(file);
    if !path.exists() {
        crate::skipped::without(&path);
        return None;
    }
    let folder = tempfile::TempDir::new().unwrap();
    let text = format!(
        r#"
        [model]
        kind = "rigid-mass"
        mass = 95.1
        viscous = 203.5
        gain = 35.15
        [channels]
        time = {{ column = "t", unit = "s" }}
        reference = {{ column = "qg", unit = "m" }}
        displacement = {{ column = "qm", unit = "m" }}
        command = {{ column = "vir", unit = "V" }}
        {more}
        [[runs]]
        file = {:?}
        controller = {{ kind = "cascade", kp = 160.18, kv = 243.45 }}
        "#,
        path.canonicalize().unwrap()
    );
    let experiment = folder.path().join("e.toml");
    std::fs::write(&experiment, text).unwrap();
    Some(Experiment::load(&experiment).unwrap())
}

#[test]
fn a_real_servo_axis_is_sound_and_its_undeclared_pulses_are_noticed() {
    let Some(clean) = emps("DATA_EMPS.mat", "") else { return };
    assert!(!is_bad_data(&check(&clean)), "{:#?}", check(&clean));
    let undeclared = check(&emps("DATA_EMPS_PULSES.mat", "").unwrap());
    assert!(undeclared.iter().any(|f| f.fault == Fault::MissingInput), "{undeclared:#?}");
    let pulses = "disturbance = { column = \"pulses_N\", unit = \"V\" }";
    let declared = check(&emps("DATA_EMPS_PULSES.mat", pulses).unwrap());
    assert!(!is_bad_data(&declared), "{declared:#?}");
}
