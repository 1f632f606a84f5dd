//! From what the core asks to the code that goes out.

use shakedown_core::Mode;
use shakedown_core::link::{Setup, Wiring};
use shakedown_core::settings::InnerLoop;

use crate::input_scaling::InputScaling;

/// 2^23: an `f32` from here to 2^24 is a whole number, and holds it in its last bits.
const WHOLE: f32 = 8_388_608.0;

/// The output's straight line, worked out for a tick that does not divide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Output {
    per_unit: f32,
    zero: f32,
    full_scale: u16,
}

impl Output {
    /// The output of `wiring`.
    pub fn new(wiring: &Wiring) -> Self {
        Self { per_unit: 1.0 / wiring.output.per_code, zero: wiring.output.zero, full_scale: wiring.full_scale }
    }

    /// Largest code.
    pub(crate) const fn full_scale(&self) -> u16 {
        self.full_scale
    }

    /// What `code` stands for, m.
    pub(crate) fn to_si(self, code: u16) -> f32 {
        (f32::from(code) - self.zero) / self.per_unit
    }

    /// The code nearest to `code` that the converter has.
    pub fn nearest(&self, code: u16) -> u16 {
        code.min(self.full_scale)
    }

    /// The code for `value`, m: the nearest one, halves to even; the converter's ends where it reaches no further; the code
    /// of zero for what is no number.
    ///
    /// What is no number lies beyond either end, by its sign, and is told apart there.
    ///
    /// By adding 2^23 and taking the last bits, and by comparing bits as whole numbers, whose order is that of the numbers
    /// they stand for: half the instructions of a conversion.
    #[inline]
    pub fn code(&self, value: f32) -> u16 {
        let code = self.bits(value).wrapping_sub(WHOLE.to_bits());
        if code <= u32::from(self.full_scale) { code as u16 } else { self.end(value) }
    }

    /// Those of 2^23 plus the code for `value`, where the converter reaches that far.
    #[inline(always)]
    fn bits(&self, value: f32) -> u32 {
        (value * self.per_unit + self.zero + WHOLE).to_bits()
    }

    /// The code for a `value` beyond the ends.
    #[cold]
    #[inline(never)]
    fn end(&self, value: f32) -> u16 {
        let value = if value.is_nan() { 0.0 } else { value };
        let above = self.bits(value).cast_signed().saturating_sub_unsigned(WHOLE.to_bits());
        above.clamp(0, i32::from(self.full_scale)) as u16
    }
}

/// What a program that fails leaves behind: the output code at which no oil flows, worked out ahead as far as it can be.
///
/// Zero volts is not zero flow: with a hard-wired inner loop (Fig. 2), or an existing position controller behind the
/// device, the LVDT is subtracted from the output, and a zero from x = 0.1 m is an order to return, on the paper's
/// table at 0.24 m/s.
#[derive(Debug, Clone, Copy)]
pub struct ZeroFlow {
    wires: InputScaling,
    /// Whether the LVDT is subtracted behind the device.
    follows: bool,
    /// Null bias of the valve, m.
    bias: f32,
}

impl ZeroFlow {
    /// For the wiring of `setup`.
    pub fn new(setup: &Setup) -> Self {
        let control = &setup.control;
        Self {
            wires: InputScaling::new(setup),
            follows: control.mode == Mode::Modifier || control.inner_loop == InnerLoop::Hardwired,
            bias: if control.mode == Mode::Modifier { 0.0 } else { control.valve.null_bias },
        }
    }

    /// How the board is wired.
    pub(crate) const fn wires(&self) -> &InputScaling {
        &self.wires
    }

    /// The code, with `displacement` the LVDT's own.
    pub fn code(&self, displacement: u16) -> u16 {
        let displacement = self.wires.read(self.wires.displacement, displacement);
        let displacement = if displacement.is_finite() && self.follows { displacement } else { 0.0 };
        self.wires.output.code(displacement + self.bias)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ControlLoop;
    use crate::defaults;
    use crate::queues::Queues;
    use proptest::prelude::*;
    use shakedown_core::link::Scale;

    #[test]
    fn no_number_gives_the_code_of_zero() {
        let output = Output::new(&defaults::WIRING);
        assert_eq!(output.code(f32::NAN), 32768);
        assert_eq!(output.code(-f32::NAN), 32768);
        assert_eq!(output.code(0.0), 32768);
        assert_eq!(output.code(f32::INFINITY), defaults::WIRING.full_scale);
        assert_eq!(output.code(f32::NEG_INFINITY), 0);
    }

    proptest! {
        /// Any number at all gives the code nearest to it, or the end that it lies beyond.
        #[test]
        fn every_value_gives_the_nearest_code(bits: u32, small in -0.2f32..0.2, outboard: bool, inverted: bool) {
            let mut wiring = defaults::WIRING;
            if outboard {
                wiring.full_scale = u16::MAX;
                wiring.output = Scale { zero: 32_767.5, per_code: 0.1524 / 32_768.0 };
            }
            if inverted {
                wiring.output.per_code = -wiring.output.per_code;
            }
            let output = Output::new(&wiring);
            for value in [f32::from_bits(bits), small] {
                let value = if value.is_nan() { 0.0 } else { value };
                let exact = f64::from(value) / f64::from(wiring.output.per_code) + f64::from(wiring.output.zero);
                let code = f64::from(output.code(value));
                prop_assert!((exact.clamp(0.0, f64::from(wiring.full_scale)) - code).abs() < 0.51, "{} {}", exact, code);
            }
        }

        /// What a failing program leaves is what the core itself asks for while the test is off.
        #[test]
        fn zero_flow_is_the_cores_own(code in 6400..59_200u16, mode in 0..3usize, hardwired: bool, bias in -0.002f32..0.002) {
            let mut setup = defaults::setup();
            setup.control.mode = [Mode::Guard, Mode::Modifier, Mode::Controller][mode];
            setup.control.inner_loop = if hardwired { InnerLoop::Hardwired } else { InnerLoop::Absent };
            setup.control.valve.null_bias = bias;
            let mut queues = Queues::new();
            let mut decide = ControlLoop::new(&setup, queues.split().0, false).unwrap();
            let outcome = decide.tick(|input| [32768, code, 32768, 32768][input]);
            prop_assert_eq!(outcome.output, ZeroFlow::new(&setup).code(code));
            prop_assert!(!decide.relay());
        }
    }
}
