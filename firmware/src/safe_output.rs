//! The output that stops the oil, reached from wherever the output stands.
//!
//! Zero volts is not zero flow: with a hard-wired inner loop (Fig. 2) the amplifier subtracts the LVDT from the
//! command, so a zero from x = 0.1 m is an order to return at 0.21 m/s. There the safe output is the LVDT's reading.

use shakedown_core::link::{SafeOutput, Wiring};

/// Ramps the output to the safe one, and follows it from then on.
#[derive(Debug, Clone, Copy)]
pub struct SafeRamp {
    /// Output now, code, not rounded.
    level: f32,
    /// Most the output moves in a tick, codes.
    step: f32,
}

impl SafeRamp {
    /// From the output code `from`, over the wiring's ramp time at `rate` ticks a second.
    pub fn new(from: u16, wiring: &Wiring, rate: f32) -> Self {
        let ticks = wiring.safe_ramp * rate;
        let step = if ticks > 1.0 { f32::from(wiring.full_scale) / ticks } else { f32::from(wiring.full_scale) };
        Self { level: f32::from(from), step }
    }

    /// The output code of this tick; `displacement` is the table's, m.
    pub fn step(&mut self, wiring: &Wiring, displacement: f32) -> u16 {
        let target = f32::from(target(wiring, displacement));
        self.level += (target - self.level).clamp(-self.step, self.step);
        round(self.level, wiring.full_scale)
    }
}

/// The safe output itself, code, for a table at `displacement`, m.
pub fn target(wiring: &Wiring, displacement: f32) -> u16 {
    match wiring.safe {
        SafeOutput::Zero => to_code(0.0, wiring),
        SafeOutput::Displacement => to_code(displacement, wiring),
    }
}

/// The output code for `value`, m: the nearest one, the converter's ends where it reaches no further, and the code of
/// zero for what is no number.
#[inline]
pub fn to_code(value: f32, wiring: &Wiring) -> u16 {
    let value = if value.is_nan() { 0.0 } else { value };
    round(value / wiring.output.per_code + wiring.output.zero, wiring.full_scale)
}

/// The nearest code, halves up; float to integer saturates in Rust, as it does in the hardware.
#[inline]
fn round(level: f32, full_scale: u16) -> u16 {
    let code = (level + 0.5) as u16;
    if code > full_scale { full_scale } else { code }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::defaults;
    use proptest::prelude::*;

    #[test]
    fn zero_flow_behind_a_hard_wired_loop_is_the_tables_own_place() {
        let mut wiring = defaults::WIRING;
        wiring.safe = SafeOutput::Displacement;
        let at_rest = target(&wiring, 0.0);
        assert_eq!(target(&wiring, 0.1), to_code(0.1, &wiring));
        assert!(target(&wiring, 0.1) > at_rest);
        wiring.safe = SafeOutput::Zero;
        assert_eq!(target(&wiring, 0.1), at_rest);
    }

    #[test]
    fn no_number_gives_the_code_of_zero() {
        let wiring = defaults::WIRING;
        assert_eq!(to_code(f32::NAN, &wiring), to_code(0.0, &wiring));
        assert_eq!(to_code(f32::INFINITY, &wiring), wiring.full_scale);
        assert_eq!(to_code(f32::NEG_INFINITY, &wiring), 0);
    }

    proptest! {
        #[test]
        fn the_ramp_ends_at_the_safe_output_in_its_time(from in 0..=4095u16, x in -0.12f32..0.12, ramp in 0.0f32..0.5) {
            let wiring = Wiring { safe: SafeOutput::Displacement, safe_ramp: ramp, ..defaults::WIRING };
            let mut safe = SafeRamp::new(from, &wiring, 1000.0);
            let mut last = from;
            let mut most = 0;
            for _ in 0..=(ramp * 1000.0) as usize + 1 {
                let code = safe.step(&wiring, x);
                most = most.max(code.abs_diff(last));
                last = code;
            }
            prop_assert_eq!(last, target(&wiring, x));
            if ramp > 0.002 {
                prop_assert!(f32::from(most) <= 4095.0 / (ramp * 1000.0) + 1.0);
            }
        }
    }
}
