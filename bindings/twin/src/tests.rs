//! The table beside `shakedown run`'s, and what is refused.

use std::ptr::{null, null_mut};

use super::*;
use shakedown::fit::{Recipe, generate};
use shakedown::recording::Model;
use shakedown::simulate::{Named, Setup, Twin};

const SERVO: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";

fn opened(text: &str, options: &Options) -> Result<*mut Table, String> {
    let (mut table, mut message) = (null_mut(), [1_u8; 200]);
    let said = message.as_mut_ptr().cast();
    let code = shakedown_twin_open(text.as_ptr().cast(), text.len(), options, &raw mut table, said, message.len());
    if code == 0 {
        return Ok(table);
    }
    assert!(table.is_null());
    Err(std::ffi::CStr::from_bytes_until_nul(&message).unwrap().to_str().unwrap().into())
}

/// The commands of a closed loop, played again, move the table through the same bits.
#[test]
fn it_moves_as_a_run_moves_it() {
    let motion = Recipe::table1(1000.0).apply(&generate::FAR_FIELD.generate(1).unwrap()).unwrap();
    let oil = "effects = [\"oil_compliance\"]\n[effects.oil_compliance]\nfrequency = 12.0\ndamping = 0.05\n";
    for text in [SERVO.to_owned(), format!("{SERVO}{oil}")] {
        let model = Model::from_text("table.toml".as_ref(), &text).unwrap();
        let setup = Setup { table: Twin::of(&model).unwrap(), ..Setup::paper(Named::Strong) };
        let trace = setup.play(&motion).unwrap().trace;
        let options = Options { start: trace.displacement[0], area_per_mass: 2e-6, ..Options::default() };
        let table = opened(&text, &options).unwrap();
        let mut seen = Motion::default();
        assert_eq!(shakedown_twin_motion(table, &raw mut seen), 0);
        for (k, &command) in trace.command.iter().enumerate() {
            assert_eq!(seen.displacement, trace.measured_displacement[k], "tick {k}");
            assert_eq!(seen.acceleration, trace.measured_acceleration[k], "tick {k}");
            assert_eq!(shakedown_twin_step(table, command, &raw mut seen), 0);
        }
        assert!(seen.pressure_difference.is_finite());
        shakedown_twin_close(table);
    }
}

#[test]
fn what_is_no_table_is_refused_in_words() {
    let refused = |text: &str, options: Options| opened(text, &options).unwrap_err();
    let plain = Options::default();
    let kind = refused(&SERVO.replace("servo", "table"), plain);
    assert!(kind.contains("table.toml") && kind.contains("kind"), "{kind}");
    let rate = refused(SERVO, Options { rate: 0.0, ..plain });
    assert!(rate.contains("rate 0 Hz"), "{rate}");
    let start = refused(SERVO, Options { start: f64::NAN, ..plain });
    assert!(start.contains("start NaN m"), "{start}");
    let area = refused(SERVO, Options { area_per_mass: -1.0, ..plain });
    assert!(area.contains("area_per_mass"), "{area}");
}

#[test]
fn what_c_gets_wrong_is_a_code() {
    let (table, mut motion) = (opened(SERVO, &Options::default()).unwrap(), Motion::default());
    assert_eq!(shakedown_twin_step(table, f64::NAN, &raw mut motion), code::OUT_OF_RANGE);
    assert_eq!(motion, Motion::default());
    assert_eq!(shakedown_twin_step(table, 0.0, null_mut()), 11);
    assert_eq!(shakedown_twin_step(null_mut(), 0.0, &raw mut motion), 11);
    assert_eq!(shakedown_twin_motion(null(), &raw mut motion), 11);
    assert_eq!(shakedown_twin_step(table, 0.1, &raw mut motion), 0);
    assert!(motion.displacement > 0.0 && motion.pressure_difference.is_nan());
    shakedown_twin_close(table);
    shakedown_twin_close(null_mut());
    // A message longer than its room is cut between characters.
    let mut small = [9_u8; 4];
    write("a\u{b5}\u{b5}", &mut small);
    assert_eq!(small, [b'a', 0xc2, 0xb5, 0]);
}
