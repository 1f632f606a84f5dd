//! A spring whose stiffness changes with travel, up to none left and up to twice as much.

use crate::scalar::Scalar;

/// Stiffness at a travel over that at none: `1 + h d^2/(1 + |h| d^2)`, `h` being its relative change per square of travel, 1/m2.
pub(super) fn bent<S: Scalar>(hardening: S, travel: S) -> S {
    let bent = hardening * travel * travel;
    bent / (bent.abs() + 1.0) + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffness_changes_up_to_none_and_up_to_twice() {
        assert_eq!(bent(0.0, 1e-3), 1.0);
        assert!((bent(1e6, 1e-3) - 1.5).abs() < 1e-12 && (bent(-1e6, -1e-3) - 0.5).abs() < 1e-12);
        assert!((bent(1e10_f64, 1e-3) - 2.0).abs() < 1e-3 && bent(-1e10_f64, 1e-3).abs() < 1e-3);
    }
}
