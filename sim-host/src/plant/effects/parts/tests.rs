use super::*;
use crate::plant::model::Baseline;
use crate::plant::simulate::{EffectParameters, Excitation, Shaping, SimulatedLaw, Start, Trace, Wanted, simulate};
use crate::scalar::Dual;

const ENDS: [f64; 3] = [-0.004, 0.001, 0.006];
const WIDTH: f64 = 1e-4;

fn run<S: Scalar>(id: &'static str, parameters: Vec<S>) -> Trace<S> {
    let own = [0.69, 138.0, 57.65, 0.242].map(S::from);
    let baseline = Baseline::Servo { b1: own[0], b0: own[1], a1: own[2], velocity_limit: own[3] };
    let input: Vec<f64> = (0..600).map(|k| 0.01 * (0.03 * f64::from(k)).sin()).collect();
    let drive = Excitation {
        dt: 0.002,
        ticks: 1,
        input: &input,
        added: &[],
        before: None,
        law: SimulatedLaw::Pi { kp: 4.0, ki: 1.0 },
        shaping: Shaping::default(),
        sensor_noise: 1e-6,
        wanted: Wanted::ALL,
    };
    let start = Start { displacement: S::from(0.0), velocity: S::from(0.0), states: Vec::new(), time: 0.0 };
    simulate(&baseline, &[EffectParameters { id, parameters }], &drive, &start).unwrap()
}

/// An effect's displacement by the share in each part of the stroke.
fn by_parts(id: &'static str, own: &[f64]) -> Vec<[f32; 4]> {
    let (given, count) = parameters(Along::Displacement, WIDTH, &ENDS);
    assert_eq!(count, 4);
    let share = |i: usize| {
        let mut share = Dual::<4>::from(0.0);
        share.tangent[i] = 1.0;
        share
    };
    let values = own.iter().copied().chain(given).map(Dual::from).chain((0..4).map(share));
    run(id, values.collect()).displacement.iter().map(|x| x.tangent).collect()
}

/// What so small a strength of an effect in a window changes is what the share in that part says, times the strength.
#[test]
fn a_share_s_derivative_is_what_little_of_an_effect_changes_in_its_part() {
    let nothing = run::<f64>("viscous_friction", vec![0.0]).displacement;
    let own = |strength: f64| -> Vec<f64> {
        let details = entry("viscous_friction").unwrap().parameters.iter().skip(1).map(Parameter::first_start);
        [strength].into_iter().chain(details).collect()
    };
    let slopes = by_parts("viscous_friction", &own(50.0));
    let little = 1e-3;
    let part = (ENDS[0], ENDS[1]);
    let mut values = own(50.0 * little);
    values.extend([regional::code(Along::Displacement, regional::Shape::Window), WIDTH, part.0, part.1]);
    let changed = run::<f64>("viscous_friction", values).displacement;
    let largest = slopes.iter().map(|s| f64::from(s[1]).abs()).fold(0.0, f64::max);
    assert!(largest > 1e-5, "{largest}");
    for ((with, without), slope) in changed.iter().zip(&nothing).zip(&slopes) {
        let (chord, slope) = ((with - without) / little, f64::from(slope[1]));
        assert!((chord - slope).abs() < 0.02 * largest, "{chord} {slope}");
    }
    // Deliberate break: it is not what the next part's share says.
    assert!(
        changed.iter().zip(&nothing).zip(&slopes).any(|((with, without), slope)| {
            ((with - without) / little - f64::from(slope[2])).abs() > 0.2 * largest
        })
    );
}

/// The shares together are the effect everywhere, and with none of them nothing of the motion is another.
#[test]
fn nothing_of_an_effect_leaves_the_motion_as_it_is_and_all_parts_are_the_whole() {
    for (id, own) in
        [("coulomb_friction", vec![0.4]), ("displacement_nonlinearity", vec![3.0]), ("null_bias", vec![0.02])]
    {
        let details = entry(id).unwrap().parameters.iter().skip(own.len()).map(Parameter::first_start);
        let own: Vec<f64> = own.iter().copied().chain(details).collect();
        let (given, count) = parameters(Along::Displacement, WIDTH, &ENDS);
        let idle: Vec<f64> = own.iter().copied().chain(given).chain(vec![0.0; count]).collect();
        let still = run::<f64>("null_bias", vec![0.0]).displacement;
        let away = run(id, idle).displacement.iter().zip(&still).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(away < 1e-12, "{id}: {away}");
        let slopes = by_parts(id, &own);
        let little = 1e-4;
        let scaled: Vec<f64> = std::iter::once(own[0] * little).chain(own[1..].iter().copied()).collect();
        let (whole, nothing) = (run(id, scaled).displacement, run("null_bias", vec![0.0]).displacement);
        let sum = |s: &[f32; 4]| f64::from(s.iter().sum::<f32>());
        let largest = slopes.iter().map(|s| sum(s).abs()).fold(0.0, f64::max);
        for ((with, without), slope) in whole.iter().zip(&nothing).zip(&slopes) {
            let chord = (with - without) / little;
            assert!((chord - sum(slope)).abs() < 0.1 * largest, "{id}: {chord} {}", sum(slope));
        }
    }
}

/// A leakage has no slope at nothing: oil is stiff until it leaks some.
#[test]
fn a_leakage_and_what_has_no_share_are_in_no_parts() {
    let known = |id| in_parts(entry(id).unwrap(), Along::Time, 4).is_some();
    assert!(known("viscous_friction") && !known("leakage") && !known("oil_compliance"));
}
