mod halving;

use super::*;
use crate::identify::model::{ModelEffect as Start0, SignalScales};
use crate::plant::effects::ENTRIES;
use crate::plant::effects::regional::{self, Along, Shape};
use crate::plant::model::Kind;
use crate::scalar::{Dual, Scalar};

const DT: f64 = 0.004;
const YARDSTICKS: SignalScales = SignalScales { displacement: 0.05, ..SignalScales::TYPICAL };

fn reference(n: usize) -> Vec<f64> {
    let sine = |t: f64, hz: f64, size: f64| size * (std::f64::consts::TAU * hz * t).sin();
    (0..n).map(|k| k as f64 * DT).map(|t| t.min(1.0) * (sine(t, 0.7, 0.04) + sine(t, 3.1, 0.006))).collect()
}

fn paper<S: Scalar>() -> Baseline<S> {
    Baseline::Servo { b1: 0.69.into(), b0: 138.0.into(), a1: 57.65.into(), velocity_limit: 0.242.into() }
}

/// A plant that a command drives.
fn commanded(input: &[f64], wanted: Wanted) -> Excitation<'_> {
    let (law, shaping) = (SimulatedLaw::Recorded, Shaping::default());
    Excitation { dt: DT, ticks: 1, input, added: &[], before: None, law, shaping, sensor_noise: 0.0, wanted }
}

fn run<S: Scalar>(effects: &[EffectParameters<S>]) -> Trace<S> {
    let input = reference(1200);
    let drive = Excitation {
        dt: DT,
        ticks: 1,
        input: &input,
        added: &[],
        before: None,
        law: SimulatedLaw::Pi { kp: 6.0, ki: 1.0 },
        shaping: Shaping::default(),
        sensor_noise: 1e-5,
        wanted: Wanted::ALL,
    };
    let start = Start { displacement: 0.0.into(), velocity: 0.0.into(), states: Vec::new(), time: 0.0 };
    simulate(&paper(), effects, &drive, &start).unwrap()
}

/// Every effect's derivative by every parameter against central differences of the simulation, on displacement and
/// velocity-like sums that corners do not upset.
#[test]
fn sensitivities_are_those_of_the_simulation() {
    let mut worst: Vec<String> = Vec::new();
    for entry in ENTRIES.iter().filter(|e| e.kinds.contains(&Kind::Servo)) {
        let starts: Vec<_> = (0..).map_while(|i| Start0::start(entry, i, &YARDSTICKS)).collect();
        // The slowest spools make the loop hunt, where a difference says nothing.
        let hunting = if entry.id == "valve_rate_limit" { 3 } else { 0 };
        let last = &starts[starts.len() - 1 - hunting];
        // Off the round values, where steps and delays are whole and a difference would straddle a corner.
        let at: Vec<f64> = last.values.iter().map(|v| 1.037 * v.value).collect();
        for i in 0..at.len() {
            let with = |value: f64| {
                let mut parameters = at.clone();
                parameters[i] = value;
                run::<f64>(&[EffectParameters { id: entry.id, parameters }])
            };
            let h = 1e-5 * at[i].abs().max(1e-3);
            let (up, down) = (with(at[i] + h), with(at[i] - h));
            let parameters =
                at.iter().enumerate().map(|(j, &v)| if i == j { Dual::<1>::variable(v, 0) } else { Dual::from(v) });
            let dual = run(&[EffectParameters { id: entry.id, parameters: parameters.collect() }]);
            let (mut error, mut size) = (0.0, 1e-12);
            for k in 0..dual.displacement.len() {
                let difference = (up.displacement[k] - down.displacement[k]) / (2.0 * h);
                error += (dual.displacement[k].part(1) - difference).powi(2);
                size += difference.powi(2);
            }
            let key = entry.parameters[i].key;
            worst.extend(
                (error > 0.02_f64.powi(2) * size + 1e-9).then(|| format!("{}.{key}: {error} of {size}", entry.id)),
            );
        }
    }
    assert!(worst.is_empty(), "{worst:#?}");
}

/// Behind a leak or an orifice that gives way at once the oil's spring hardly shows, however fast the two together are.
#[test]
fn oil_is_stable_beside_what_gives_way_to_load() {
    let placed = |id: &'static str, parameters: &[f64]| EffectParameters { id, parameters: parameters.to_vec() };
    let oil = placed("oil_compliance", &[90.0, 0.1, 0.0, 0.0]);
    // A table at the end of its cylinder, where the oil is five times as stiff.
    let cornered = placed("oil_compliance", &[90.0, 0.1, 0.0, 1e6]);
    let apart = |a: &Trace<f64>, b: &Trace<f64>| {
        a.displacement.iter().zip(&b.displacement).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let plain = run::<f64>(&[]);
    for gives in [placed("leakage", &[0.02]), placed("load_dependent_flow", &[8.0, 1000.0, 0.2])] {
        for oil in [&oil, &cornered] {
            let (alone, both) = (run(std::slice::from_ref(&gives)), run(&[oil.clone(), gives.clone()]));
            assert!(both.displacement.iter().all(|x| x.is_finite()), "{} with oil", gives.id);
            let share = apart(&alone, &both) / apart(&alone, &plain);
            assert!(share < 0.15, "{}: oil changes {share} of what it changes", gives.id);
        }
    }
}

/// Matrices are a short way through the same rule: values and derivatives are the same but for rounding, in the free
/// stretches and at the limit.
#[test]
fn matrices_give_what_the_rule_gives() {
    let input = reference(1200);
    let sets = ENTRIES.iter().filter(|e| e.kinds.contains(&Kind::Servo)).map(|e| vec![*e]);
    let pair = |a: &str, b: &str| vec![entry(a).unwrap(), entry(b).unwrap()];
    let more = [vec![], pair("oil_compliance", "payload_resonance"), pair("command_delay", "valve_lag")];
    for (set, ticks) in sets.chain(more).flat_map(|set| [(set.clone(), 1), (set, 2)]) {
        let mut lane = 2;
        let mut parameters = |entry: &'static crate::plant::effects::Entry| {
            let start = Start0::start(entry, 0, &YARDSTICKS).unwrap();
            let variable = |v: &crate::identify::model::Value| {
                lane += 1;
                Dual::<8>::variable(1.037 * v.value, lane)
            };
            EffectParameters { id: entry.id, parameters: start.values.iter().map(variable).collect() }
        };
        let effects: Vec<EffectParameters<Dual<8>>> = set.iter().map(|entry| parameters(entry)).collect();
        let model = Baseline::Servo {
            b1: 0.69.into(),
            b0: Dual::variable(138.0, 0),
            a1: Dual::variable(57.65, 1),
            velocity_limit: Dual::variable(0.242, 2),
        };
        let law = SimulatedLaw::Pi { kp: 6.0, ki: 1.0 };
        let drive = Excitation {
            dt: DT,
            ticks,
            input: &input,
            added: &[],
            before: None,
            law,
            shaping: Shaping::default(),
            sensor_noise: 1e-5,
            wanted: Wanted::ALL,
        };
        let start = Start { displacement: 0.0.into(), velocity: 0.0.into(), states: Vec::new(), time: 0.0 };
        let [short, long] = [true, false]
            .map(|matrices| super::run(Dynamics::new(&model, &effects).unwrap(), &drive, &start, matrices));
        let series = |t: &Trace<Dual<8>>| [&t.displacement, &t.velocity, &t.acceleration, &t.load].map(Clone::clone);
        for (short, long) in series(&short).iter().zip(&series(&long)) {
            assert_eq!(short.len(), input.len());
            for part in 0..=8 {
                // Values have double precision, derivatives single.
                let rounding = if part == 0 { 1e-9 } else { 1e-4 };
                let largest = long.iter().fold(0.0_f64, |m, x| m.max(x.part(part).abs()));
                for (k, (a, b)) in short.iter().zip(long).enumerate() {
                    let apart = (a.part(part) - b.part(part)).abs();
                    let ids: Vec<_> = set.iter().map(|e| e.id).collect();
                    assert!(apart <= rounding * largest, "{ids:?}, part {part} at {k}: {a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn without_effects_it_is_the_papers_plant() {
    // The exact solution of one step: z settles as one exponential, x is its integral.
    let (b1, b0, a1, u) = (0.69, 138.0, 57.65, 0.05);
    let input = vec![u; 200];
    let drive = commanded(&input, Wanted::ALL);
    let start = Start { displacement: 0.0, velocity: 0.0, states: Vec::new(), time: 0.0 };
    let trace = simulate::<f64>(&paper(), &[], &drive, &start).unwrap();
    let settled = (b0 - b1 * a1) * u / a1;
    for (k, x) in trace.displacement.iter().enumerate() {
        let t = k as f64 * DT;
        let exact = settled * (t - (1.0 - (-a1 * t).exp()) / a1) + b1 * u * t;
        // A ten-thousandth of the LVDT's step of 0.04 mm.
        assert!((x - exact).abs() < 4e-9, "{k}: {x} {exact}");
    }
}

/// A run that begins a minute into its file begins with the gain that a minute made.
#[test]
fn a_gain_that_drifts_goes_on_where_a_run_is_cut() {
    let reached = |time: f64| {
        let input = vec![0.02; 201];
        let drive = commanded(&input, Wanted::default());
        let effects = [EffectParameters { id: "gain_drift", parameters: vec![0.005, 1e4] }];
        let start = Start { displacement: 0.0, velocity: 0.0, states: Vec::new(), time };
        simulate::<f64>(&paper(), &effects, &drive, &start).unwrap().displacement[200]
    };
    let ratio = reached(60.0) / reached(0.0);
    assert!((ratio - 1.3).abs() < 2e-3, "{ratio}");
}

/// While the table rests in its play nothing moves the base.
#[test]
fn a_base_stands_still_under_a_table_that_does() {
    let of = |id, parameters: &[f64]| EffectParameters { id, parameters: parameters.to_vec() };
    let base = of("base_compliance", &[6.0, 0.05, 0.5, 0.0]);
    let most =
        |effects: &[EffectParameters<f64>]| run(effects).acceleration.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    let moving = most(std::slice::from_ref(&base));
    let resting = most(&[of("backlash", &[0.4, 30.0, 0.0]), base]);
    assert!(resting < 1e-9 * moving, "{resting} of {moving}");
}

#[test]
fn an_unknown_effect_is_refused_by_name() {
    let effects = [EffectParameters { id: "phlogiston", parameters: vec![1.0] }];
    let drive = commanded(&[0.0], Wanted::ALL);
    let start = Start { displacement: 0.0, velocity: 0.0, states: Vec::new(), time: 0.0 };
    let refused = simulate::<f64>(&paper(), &effects, &drive, &start);
    assert!(matches!(refused, Err(SimulateError::UnknownEffect { id, count: 1 }) if id == "phlogiston"));
}

/// On a rigid mass an overlap is in the command's unit and an offset in N, as the table of effects says.
#[test]
fn effects_on_a_rigid_mass_have_their_units() {
    let moved = |id: &'static str, parameters: &[f64], command: f64| {
        let input = vec![command; 251];
        let drive = commanded(&input, Wanted::default());
        let start = Start { displacement: 0.0, velocity: 0.0, states: Vec::new(), time: 0.0 };
        let mass = Baseline::RigidMass { mass: 10.0, viscous: 0.0, gain: 20.0 };
        let trace =
            simulate(&mass, &[EffectParameters { id, parameters: parameters.to_vec() }], &drive, &start).unwrap();
        trace.displacement[250]
    };
    // Half a metre per m/s2 after a second.
    let cases: [(&str, &[f64], f64, f64); 3] = [
        ("valve_deadband", &[0.2, 0.01, 0.0], 0.5, 20.0 * 0.3),
        ("valve_deadband", &[0.2, 0.01, 0.0], -0.1, 0.0),
        ("null_bias", &[3.0, 0.0], 0.5, 10.0 + 3.0),
    ];
    for (id, parameters, command, force) in cases {
        let expected = 0.5 * force / 10.0;
        let x = moved(id, parameters, command);
        assert!((x - expected).abs() < 1e-9, "{id}: {x} m for {expected} m");
    }
}

/// Friction that is there for the first half of a second alone, or while the command is above its own, which it never is.
#[test]
fn an_effect_on_a_rigid_mass_acts_in_its_region_alone() {
    let coasted = |along, from: f64, to: f64| {
        let input = vec![0.0; 251];
        let coasting = Start { displacement: 0.0, velocity: 1.0, states: Vec::new(), time: 0.0 };
        let mass = Baseline::RigidMass { mass: 10.0, viscous: 0.0, gain: 20.0 };
        let region = [regional::code(along, Shape::Window), 1e-4, from, to];
        let friction =
            EffectParameters { id: "coulomb_friction", parameters: [3.0, 1e-6].into_iter().chain(region).collect() };
        simulate::<f64>(&mass, &[friction], &commanded(&input, Wanted::default()), &coasting).unwrap().displacement[250]
    };
    // Without friction it coasts a metre; 0.3 m/s2 slow it down by 0.15 m/s in the half second.
    let half = coasted(Along::Time, -1.0, 0.5);
    assert!((half - (1.0 - 0.0375 - 0.5 * 0.15)).abs() < 1e-3, "{half} m");
    let never = coasted(Along::Command, 0.1, 9.0);
    assert!((never - 1.0).abs() < 1e-9, "{never} m");
}

/// A part that begins in the middle of a motion goes on where the whole run was: what was sent before it is on its way, and the spool is
/// where it was. Where nobody recorded that, the first command stands for it, and is nearer than none.
#[test]
fn a_part_of_a_run_goes_on_with_what_was_sent_before() {
    const CUT: usize = 400;
    let mass = Baseline::RigidMass { mass: 10.0, viscous: 60.0, gain: 20.0 };
    let effects = [("command_delay", vec![0.03]), ("valve_rate_limit", vec![9.0, 0.02, 1.0])]
        .map(|(id, parameters)| EffectParameters { id, parameters });
    let input: Vec<f64> = (0..800).map(|k| 2.0 * (1.5 * f64::from(k) * DT).sin()).collect();
    let begun = |input: &[f64], (displacement, velocity), before| {
        let drive = Excitation { before, ..commanded(input, Wanted { velocity: true, ..Wanted::default() }) };
        let start = Start { displacement, velocity, states: Vec::new(), time: 0.0 };
        simulate::<f64>(&mass, &effects, &drive, &start).unwrap()
    };
    let whole = begun(&input, (0.0, 0.0), None);
    let astray = |before| {
        let part = begun(&input[CUT..], (whole.displacement[CUT], whole.velocity[CUT]), before).displacement;
        part.iter().zip(&whole.displacement[CUT..]).map(|(part, whole)| (part - whole).abs()).fold(0.0, f64::max)
    };
    let (known, first, rest) = (astray(Some(&input[CUT - 250..CUT])), astray(Some(&[])), astray(None));
    let moved = whole.displacement[CUT..].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(known < 1e-9 * moved && first < 0.5 * rest, "{known}, {first} and {rest} of {moved}");
}
