use super::*;
use proptest::prelude::*;

const LINE: Scale = Scale { zero: 2048.0, per_code: 0.1524 / 2048.0 };
const INPUTS: Inputs = Inputs {
    reference: LINE,
    displacement: LINE,
    acceleration: Scale { zero: 2048.0, per_code: 0.01 },
    external: LINE,
    full_scale: 4095,
};

proptest! {
    #[test]
    fn a_code_is_the_nearest_or_the_end(value in -1.0f32..1.0, inverted: bool) {
        let scale = Scale { per_code: if inverted { -LINE.per_code } else { LINE.per_code }, ..LINE };
        let code = nearest(scale, value, 4095);
        let exact = f64::from(value) / f64::from(scale.per_code) + f64::from(scale.zero);
        prop_assert!((exact.clamp(0.0, 4095.0) - f64::from(code)).abs() < 0.501, "{} {}", exact, code);
    }

    /// Whatever comes out of a device, the table keeps to its limit and stays a number.
    #[test]
    fn the_table_stays_within_its_limit(outputs in proptest::collection::vec(any::<f32>(), 1..50), behind in 0..3usize) {
        let behind = [Behind::Valve, Behind::HardwiredLoop, Behind::ExistingLoop][behind];
        let mut rehearsal = Rehearsal::new(1000.0, behind);
        for output in outputs {
            let before = rehearsal.table().displacement();
            rehearsal.advance(output, true);
            prop_assert!(rehearsal.table().velocity().abs() <= VELOCITY_LIMIT);
            prop_assert!((rehearsal.table().displacement() - before).abs() <= 1.001e-3 * VELOCITY_LIMIT);
        }
    }
}

#[test]
fn a_table_without_oil_stands() {
    let mut rehearsal = Rehearsal::new(1000.0, Behind::Valve);
    for _ in 0..100 {
        rehearsal.advance(0.05, true);
    }
    let there = rehearsal.table().displacement();
    assert!(there > 0.005);
    for _ in 0..100 {
        rehearsal.advance(0.05, false);
    }
    assert_eq!((rehearsal.table().displacement(), rehearsal.table().velocity()), (there, 0.0));
}

#[test]
fn each_loop_behind_the_device_closes() {
    for (behind, settles) in [(Behind::Valve, false), (Behind::HardwiredLoop, true), (Behind::ExistingLoop, true)] {
        let mut rehearsal = Rehearsal::new(1000.0, behind);
        for _ in 0..3000 {
            rehearsal.advance(0.01, true);
        }
        let off = (rehearsal.table().displacement() - 0.01).abs();
        assert_eq!(off < 1e-4, settles, "{behind:?}: {off}");
    }
}

#[test]
fn an_existing_controller_follows_the_reference() {
    let rehearsal = Rehearsal::new(1000.0, Behind::Valve);
    let codes = rehearsal.codes(&INPUTS, 0.01);
    assert_eq!(codes, [2048, 2048, 2048, nearest(LINE, 0.037, 4095)]);
}
