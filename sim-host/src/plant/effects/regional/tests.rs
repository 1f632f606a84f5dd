use super::super::entry;
use super::*;

fn at(time: f64, displacement: f64) -> Instant<f64> {
    Instant { time, displacement, velocity: 0.1, sensed_velocity: 0.1, velocity_limit: 1.0 }
}

#[test]
fn a_window_lets_an_effect_act_between_its_ends_alone() {
    let window_entry = regional(entry("viscous_friction").unwrap(), Along::Displacement, Shape::Window).unwrap();
    assert_eq!(window_entry.parameters.last().unwrap().key, "to_displacement");
    let n = entry("viscous_friction").unwrap().parameters.len();
    let mut parameters = vec![3.0; n];
    parameters.extend([code(Along::Displacement, Shape::Window), 1e-4, -0.01, 0.02]);
    let mut effect = build::<f64>("viscous_friction", &parameters).unwrap();
    let mut force = |x: f64| {
        effect.observe(&at(0.0, x), 0.0);
        effect.force(&at(0.0, x), &[], &mut [])
    };
    let inside = force(0.005);
    assert!(inside > 0.0 && force(-0.015).abs() < 1e-9 && force(0.025).abs() < 1e-9);
    assert!((force(-0.01) / inside - 0.5).abs() < 1e-6, "half its strength at an end");
    assert_eq!(window(window_entry, &parameters), Some((Along::Displacement, -0.01, 0.02)));
}

#[test]
fn along_the_command_it_acts_by_what_is_asked_for() {
    let mut parameters = vec![3.0; entry("viscous_friction").unwrap().parameters.len()];
    parameters.extend([code(Along::Command, Shape::Window), 1e-4, 0.2, 5.0]);
    let mut effect = build::<f64>("viscous_friction", &parameters).unwrap();
    let mut force = |command: f64| {
        effect.observe(&at(0.0, 0.0), command);
        effect.force(&at(0.0, 0.0), &[], &mut [])
    };
    assert!(force(1.0) > 0.0 && force(0.1).abs() < 1e-9 && force(-1.0).abs() < 1e-9);
}

#[test]
fn a_slope_changes_the_strength_in_proportion_and_never_turns_it_round() {
    let n = entry("viscous_friction").unwrap().parameters.len();
    let mut parameters = vec![3.0; n];
    parameters.extend([code(Along::Time, Shape::Slope), 10.0, -0.5]);
    let mut effect = build::<f64>("viscous_friction", &parameters).unwrap();
    let mut force = |t: f64| {
        effect.observe(&at(t, 0.0), 0.0);
        effect.force(&at(t, 0.0), &[], &mut [])
    };
    let whole = force(0.0);
    assert!((force(10.0) / whole - 0.5).abs() < 1e-12 && force(30.0).abs() < 1e-12);
}

#[test]
fn a_stated_effect_s_keys_say_which_form_it_has() {
    let form = |key: &'static str| stated("leakage", [key].into_iter()).unwrap().parameters.len();
    let plain = entry("leakage").unwrap().parameters.len();
    assert_eq!((form("coefficient"), form("from_speed"), form("change_with_time")), (plain, plain + 4, plain + 3));
    assert!(regional(entry("flow_softening").unwrap(), Along::Time, Shape::Window).is_none());
    let bias = |along| regional(entry("null_bias").unwrap(), along, Shape::Window).is_some();
    assert!(bias(Along::Time) && bias(Along::Displacement) && !bias(Along::Velocity) && !bias(Along::Command));
}
