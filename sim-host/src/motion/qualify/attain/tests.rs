use super::super::{Code, Direction, Required, STANDARDS, Site, Standard};
use super::*;

fn ac156(s_ds: f64) -> (Standard, Required) {
    let standard = STANDARDS[0];
    let site = Site { s_ds, z_over_h: 0.0, code: Code::Asce16, direction: Direction::Horizontal, high: false };
    (standard, standard.required(&site).unwrap())
}

fn asked<'a>(standard: &'a Standard, required: &'a Required) -> Requirement<'a> {
    Requirement { standard, required, lowest: standard.band.0 }
}

#[test]
fn a_wide_table_gets_random_motion_and_a_narrow_one_a_proof() {
    let (standard, required) = ac156(0.3);
    let wide = Limits::table(1.0, 0.25);
    let found = attain(asked(&standard, &required), &wide, 1).unwrap();
    let Attained::Motion { motion, way: Way::Random, judged, .. } = &found else { panic!("{}", found.word()) };
    assert!(judged.complies() && used(motion, &wide) <= 1.0);
    let narrow = Limits::table(0.02, 0.01);
    let Attained::Impossible(proof) = attain(asked(&standard, &required), &narrow, 1).unwrap() else {
        panic!("a table that reaches a tenth of what is asked");
    };
    assert!(proof.iter().all(|u| u.bound < u.required) && proof.iter().any(|u| u.limit == "velocity"));
    let (low, high) = (proof[0].frequency, proof[proof.len() - 1].frequency);
    assert!(low <= 1.31 && high < 33.3, "{low} to {high}");
}

/// Between what random motion needs and what the bound forbids lies what a sweep reaches.
#[test]
fn a_table_too_slow_for_random_motion_is_swept() {
    let (standard, required) = ac156(0.8);
    let limits = Limits::table(0.16, 0.08);
    let found = attain(asked(&standard, &required), &limits, 1).unwrap();
    let Attained::Motion { motion, way, judged, .. } = &found else { panic!("{found:?}") };
    assert!(*way != Way::Random && judged.complies() && used(motion, &limits) <= 1.0, "{way:?}");
}

/// A floor asks for much acceleration beside its spectrum: a burst above the band gives it, on a table that has room for it.
#[test]
fn the_zero_period_is_raised_where_the_spectrum_is_reached() {
    let standard = STANDARDS[0];
    let site = Site { s_ds: 0.4, z_over_h: 1.0, code: Code::Asce16, direction: Direction::Horizontal, high: false };
    let required = standard.required(&site).unwrap();
    let limits = Limits { stall: Some(40.0), ..Limits::table(1.0, 0.25) };
    let found = attain(asked(&standard, &required), &limits, 1).unwrap();
    let Attained::Motion { motion, judged, .. } = &found else { panic!("{}", found.word()) };
    assert!(judged.complies() && used(motion, &limits) <= 1.0);
    let least = standard.zero_period * required.zero_period();
    assert!((crate::motion::peak(&motion.acceleration) / least - 1.0).abs() < 0.05);
}
