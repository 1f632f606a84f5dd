//! Spectra against closed forms, and one rule broken at a time.

use super::*;
use crate::motion::STANDARD_GRAVITY as G;
use crate::motion::spectrum::response_spectrum;
use std::f64::consts::PI;

const SITE: Site = Site { s_ds: 1.0, z_over_h: 0.0, code: Code::Asce16, direction: Direction::Horizontal, high: false };
const DT: f64 = 1.0 / 400.0;

fn ac156() -> (Standard, Required) {
    let standard = Standard::named("ac156").unwrap();
    (standard, standard.required(&SITE).unwrap())
}

fn asked((standard, required): &(Standard, Required), lowest: f64) -> Requirement<'_> {
    Requirement { standard, required, lowest }
}

fn made(shape: &Shape, seed: u64) -> Vec<f64> {
    synthesise(asked(&ac156(), 1.3), 1.05, shape, seed).unwrap()
}

fn broken(motion: &[f64], axes: &[Vec<f64>]) -> Vec<&'static str> {
    let judged = judge(motion, DT, axes, asked(&ac156(), 1.3)).unwrap();
    judged.broken().map(|rule| rule.name).collect()
}

/// An oscillator at rest under a sine that begins: the closed form, sampled so finely that its peak is met.
#[test]
fn a_spectrum_is_within_a_thousandth_of_its_closed_form() {
    let (z, drive, dt, seconds) = (0.05, 2.0 * PI * 3.0, 0.0005, 6.0);
    let motion: Vec<f64> = (0..=(seconds / dt) as usize).map(|k| (drive * k as f64 * dt).sin()).collect();
    for f in [0.5, 1.1, 2.4, 3.0, 4.7, 9.0, 20.0] {
        let w = 2.0 * PI * f;
        let (real, imaginary) = (w * w - drive * drive, 2.0 * z * w * drive);
        let size = real * real + imaginary * imaginary;
        // x'' + 2 z w x' + w2 x = -sin(drive t): x = p sin + q cos, and a free part that starts it from rest.
        let (p, q) = (-real / size, imaginary / size);
        let wd = w * (1.0 - z * z).sqrt();
        let (c1, c2) = (-q, (-p * drive - z * w * q) / wd);
        let absolute = |t: f64| {
            let decay = (-z * w * t).exp();
            let (s, c) = ((wd * t).sin(), (wd * t).cos());
            let x = p * (drive * t).sin() + q * (drive * t).cos() + decay * (c1 * c + c2 * s);
            let v = drive * (p * (drive * t).cos() - q * (drive * t).sin())
                + decay * ((c2 * wd - z * w * c1) * c - (c1 * wd + z * w * c2) * s);
            -2.0 * z * w * v - w * w * x
        };
        let exact = (0..=(seconds / 1e-5) as usize).map(|k| absolute(k as f64 * 1e-5).abs()).fold(0.0, f64::max);
        let found = response_spectrum(&motion, dt, z, &[1.0 / f]).unwrap().s_a[0];
        assert!((found / exact - 1.0).abs() < 1e-3, "{f} Hz: {found} {exact}");
    }
}

#[test]
fn required_spectra_are_their_formulas() {
    let (_, required) = ac156();
    for (f, a) in [(1.3, 1.0), (5.0, 1.0), (8.3, 1.0), (33.3, 0.4), (50.0, 0.4), (0.1, 0.1)] {
        assert!((required.at(f).unwrap() / (a * G) - 1.0).abs() < 1e-12, "{f}");
    }
    let middle = (8.3f64 * 33.3).sqrt();
    assert!((required.at(middle).unwrap() / (0.4f64.sqrt() * G) - 1.0).abs() < 1e-12);
    assert_eq!(required.at(0.05), None);
    let roof = |code| Standard::named("ac156").unwrap().required(&Site { z_over_h: 1.0, code, ..SITE }).unwrap();
    assert!((roof(Code::Asce16).at(5.0).unwrap() / G - 1.6).abs() < 1e-12);
    assert!((roof(Code::Asce16).zero_period() / G - 1.2).abs() < 1e-12);
    assert!((roof(Code::Asce22).zero_period() / G - 0.4 * 3.5 / 1.3).abs() < 1e-12);
    let high = Standard::named("ieee693").unwrap().required(&Site { high: true, ..SITE }).unwrap();
    for (f, a) in [(1.0, 1.144), (4.0, 1.25), (16.0, 0.755), (33.0, 0.5)] {
        assert!((high.at(f).unwrap() / (a * G) - 1.0).abs() < 2e-3, "{f} Hz: {}", high.at(f).unwrap() / G);
    }
    assert!(Standard::named("ieee344").unwrap().required(&SITE).unwrap_err().to_string().contains("--rrs"));
}

#[test]
fn a_synthetic_motion_has_the_margin_it_was_made_with() {
    let motion = made(&Shape::USUAL, 1);
    let judged = judge(&motion, DT, &[made(&Shape::USUAL, 2)], asked(&ac156(), 1.3)).unwrap();
    assert!((judged.margin - 1.05).abs() < 1e-9, "{}", judged.margin);
    assert!(judged.complies(), "{:?}", judged.broken().collect::<Vec<_>>());
    assert_eq!(judged.rules.len(), 7);
}

#[test]
fn one_broken_rule_is_named_and_no_other() {
    let whole = made(&Shape::USUAL, 1);
    let scaled: Vec<f64> = whole.iter().map(|a| 0.85 * a).collect();
    assert_eq!(broken(&scaled, &[]), ["envelope"]);
    let short = made(&Shape { rise: 3.0, hold: 21.0, decay: 3.0, ..Shape::USUAL }, 1);
    assert_eq!(broken(&short, &[]), ["duration"]);
    let weak = made(&Shape { rise: 13.0, hold: 4.0, decay: 13.0, ..Shape::USUAL }, 1);
    assert_eq!(broken(&weak, &[]), ["strong motion"]);
    let other = made(&Shape::USUAL, 2);
    // Weakly the same at every frequency; then the same at one frequency and independent elsewhere.
    let tied: Vec<f64> = whole.iter().zip(&other).map(|(a, b)| 0.37 * a + 0.93 * b).collect();
    assert_eq!(broken(&whole, &[tied]), ["correlation"]);
    let tone = |x: &[f64]| -> Vec<f64> {
        let hum =
            |k: usize| 0.6 * (2.0 * PI * 20.0 * k as f64 * DT).sin() * (k.min(x.len() - k) as f64 * DT / 5.0).min(1.0);
        x.iter().enumerate().map(|(k, a)| a + hum(k)).collect()
    };
    assert_eq!(broken(&tone(&whole), &[tone(&other)]), ["coherence"]);
    // A third axis that is the second once more.
    let weaker: Vec<f64> = other.iter().map(|a| 0.9 * a).collect();
    assert_eq!(broken(&whole, &[other, weaker]), ["correlation", "coherence"]);
}

/// Strong oscillators shake a weak table long enough: the spectrum is reached, the table's own acceleration is not.
#[test]
fn the_zero_period_is_a_rule_of_its_own() {
    let standard = Standard::named("ac156").unwrap();
    let required = standard.required(&Site { z_over_h: 1.0, ..SITE }).unwrap();
    let asked = Requirement { standard: &standard, required: &required, lowest: 1.3 };
    let motion = synthesise::sines(asked, 1.05, &Shape::USUAL, 1).unwrap();
    let judged = judge(&motion, DT, &[], asked).unwrap();
    assert_eq!(judged.broken().map(|r| r.name).collect::<Vec<_>>(), ["zero-period acceleration"]);
}

/// Every standard that states a spectrum of its own, every site: what is made for it satisfies it, the table's own acceleration included.
#[test]
fn what_is_made_for_a_standard_satisfies_it() {
    let mut held = 0;
    for standard in STANDARDS {
        let (name, lowest) = (standard.id, standard.band.0);
        let directions = [Direction::Horizontal, Direction::Vertical];
        for (z_over_h, direction) in [0.0, 0.5, 1.0].into_iter().flat_map(|z| directions.map(|d| (z, d))) {
            let Ok(required) = standard.required(&Site { z_over_h, direction, ..SITE }) else { continue };
            let asked = Requirement { standard: &standard, required: &required, lowest };
            let motion = synthesise(asked, 1.05, &Shape::USUAL, 7).unwrap();
            let judged = judge(&motion, DT, &[], asked).unwrap();
            let broken: Vec<_> = judged.broken().map(|r| r.name).collect();
            assert!(
                broken.is_empty() && judged.margin > 1.05 - 1e-9,
                "{name}, {z_over_h}: {broken:?}, {}",
                judged.margin
            );
            held += 1;
        }
    }
    assert!(held >= 12, "{held}");
}

#[test]
fn what_weakens_is_not_stationary() {
    let standard = Standard::named("ieee344").unwrap();
    let required = Required::parse("frequency,acceleration\n1,0.4\n4,1.0\n16,1.0\n33,0.5\n", 0.05).unwrap();
    let asked = Requirement { standard: &standard, required: &required, lowest: 1.0 };
    let motion = synthesise(asked, 1.1, &Shape::USUAL, 3).unwrap();
    let steady = judge(&motion, DT, &[], asked).unwrap();
    assert!(steady.complies(), "{:?}", steady.broken().collect::<Vec<_>>());
    // Strong, weak and strong again.
    let third = motion.len() / 3;
    let uneven: Vec<f64> =
        motion.iter().enumerate().map(|(k, a)| if k / third == 1 { 0.5 * a } else { 1.6 * a }).collect();
    let judged = judge(&uneven, DT, &[], asked).unwrap();
    assert_eq!(judged.broken().map(|r| r.name).collect::<Vec<_>>(), ["stationarity"]);
}

#[test]
fn a_spectrum_of_ones_own_is_read_or_refused_by_line() {
    for (text, said) in [
        ("1,0.4\n0.5,1\n", "line 2: 0.5 Hz does not rise"),
        ("1,0.4\n2,x\n", "line 2: `2,x`"),
        ("1,0.4\n2,-1\n", "line 2"),
        ("a,b\n1,0.4\n", "fewer than two"),
    ] {
        assert!(Required::parse(text, 0.05).unwrap_err().contains(said), "{text}");
    }
    let slow = judge(&[0.0; 100], 0.02, &[], asked(&ac156(), 1.3)).unwrap_err().to_string();
    assert!(slow.contains("50 Hz") && slow.contains("33.3 Hz"), "{slow}");
}
