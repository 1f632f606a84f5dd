//! The bare controller is the plain law of the file formats: `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`.

use proptest::prelude::*;
use shakedown_core::settings::Gains;
use shakedown_core::{Controller, Sample, Settings};

proptest! {
    #[test]
    fn bare_controller_is_the_plain_law(
        kp in -30.0..30.0f32,
        ki in -20.0..20.0f32,
        signal in proptest::collection::vec((-0.12..0.12f32, -0.12..0.12f32), 1..400),
    ) {
        let settings = Settings { displacement: Gains::new(kp, ki), ..Settings::default() };
        let mut controller = Controller::new(&settings).unwrap();
        let (mut sum, mut size) = (0.0_f64, 0.0_f64);
        for (reference, displacement) in signal {
            let error = f64::from(reference) - f64::from(displacement);
            sum += error;
            size += error.abs();
            let expected = f64::from(kp) * error + f64::from(ki) * 1e-3 * sum;
            let command = controller.step(&Sample::new(reference, displacement, 0.0));
            let allowed = 1e-6 * (f64::from(kp.abs()) * 0.24 + f64::from(ki.abs()) * 1e-3 * size) + 1e-12;
            prop_assert!((f64::from(command.valve) - expected).abs() <= allowed);
            prop_assert_eq!(command.reference, reference);
            prop_assert!(!command.status.held);
        }
    }
}

#[test]
fn a_wrong_gain_would_be_seen() {
    let off = Settings { displacement: Gains::new(1.0001, 0.0), ..Settings::default() };
    let command = Controller::new(&off).unwrap().step(&Sample::new(0.1, 0.0, 0.0));
    assert!((f64::from(command.valve) - 0.1).abs() > 1e-6);
}
