//! From what the core asks to the code that goes out.

use shakedown_core::link::{Setup, Wiring};
use shakedown_core::{Mode, control::InnerLoop};

/// The output code for `value`, m: the nearest one, halves up; the converter's ends where it reaches no further; the code
/// of zero for what is no number. Float to integer saturates in Rust, as it does in the hardware.
#[inline]
pub fn to_code(value: f32, wiring: &Wiring) -> u16 {
    let value = if value.is_nan() { 0.0 } else { value };
    let code = (value / wiring.output.per_code + wiring.output.zero + 0.5) as u16;
    if code > wiring.full_scale { wiring.full_scale } else { code }
}

/// The output code at which no oil flows with the table at `displacement`, m: what a program that fails leaves behind.
///
/// Zero volts is not zero flow: with a hard-wired inner loop (Fig. 2), or an existing position controller behind the
/// device, the LVDT is subtracted from the output, and a zero from x = 0.1 m is an order to return at 0.21 m/s.
pub fn zero_flow(setup: &Setup, displacement: f32) -> u16 {
    let control = &setup.control;
    let follows = control.mode == Mode::Modifier || control.inner_loop == InnerLoop::Hardwired;
    let displacement = if displacement.is_finite() && follows { displacement } else { 0.0 };
    let bias = if control.mode == Mode::Modifier { 0.0 } else { control.valve.null_bias };
    to_code(displacement + bias, &setup.wiring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defaults;
    use crate::queues::Queues;
    use crate::{Events, Loop};
    use proptest::prelude::*;
    use shakedown_core::Controller;

    #[test]
    fn no_number_gives_the_code_of_zero() {
        let wiring = defaults::WIRING;
        assert_eq!(to_code(f32::NAN, &wiring), to_code(0.0, &wiring));
        assert_eq!(to_code(f32::INFINITY, &wiring), wiring.full_scale);
        assert_eq!(to_code(f32::NEG_INFINITY, &wiring), 0);
    }

    proptest! {
        /// What a failing program leaves is what the core itself asks for while the test is off.
        #[test]
        fn zero_flow_is_the_cores_own(code in 400..3700u16, mode in 0..3usize, hardwired: bool, bias in -0.002f32..0.002) {
            let mut setup = defaults::setup();
            setup.control.mode = [Mode::Guard, Mode::Modifier, Mode::Controller][mode];
            setup.control.inner_loop = if hardwired { InnerLoop::Hardwired } else { InnerLoop::Absent };
            setup.control.valve.null_bias = bias;
            let mut queues = Queues::new();
            let controller = Controller::new(&setup.control).unwrap();
            let mut decide = Loop::new(controller, &setup, queues.split().0, false);
            let outcome = decide.tick([2048, code, 2048, 2048], Events::default());
            prop_assert_eq!(outcome.output, zero_flow(&setup, setup.wiring.displacement.to_si(code)));
            prop_assert!(!outcome.relay);
        }
    }
}
