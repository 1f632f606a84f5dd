//! The values of a model as they are stated: how far each may go, and what is known of it beforehand.

use crate::identify::model::{Prior, SignalScales, Value};
use crate::plant::model::Own;
use crate::recording;

/// What takes energy out: no table is pushed by its dashpot, and one that were would stand for a friction that falls with speed.
const DASHPOT: &str = "viscous";

/// A value that is free, with what was said of its accuracy for what is known of it beforehand: what these recordings do not determine
/// stays as another determined it.
pub(super) fn beforehand(value: Value, accuracy: Option<&recording::Accuracy>) -> Value {
    let unit = if value.positive { value.value.abs() } else { 1.0 };
    let std = accuracy.and_then(|accuracy| accuracy.std).map(|std| std / unit).filter(|std| *std > 0.0);
    let prior = std.map(|std| Prior { mean: value.coordinate(), std, lent: false });
    Value { prior: prior.filter(|_| value.free), ..value }
}

/// One of a model's own parameters; a velocity limit that is not given lies far above what the runs reach.
pub(super) fn own_value(given: Option<f64>, parameter: &Own, free: bool, signal_scales: &SignalScales) -> Value {
    let positive = parameter.positive;
    let value = given.unwrap_or(if positive { 1e3 * signal_scales.speed } else { 1.0 });
    if positive {
        Value { value, low: value * 0.1, high: value * 10.0, positive, free, prior: None }
    } else {
        let low = if parameter.key == DASHPOT { value.min(0.0) } else { f64::NEG_INFINITY };
        Value { value, low, high: f64::INFINITY, positive, free, prior: None }
    }
}

#[cfg(test)]
mod tests {
    use super::{beforehand, own_value};
    use crate::identify::model::SignalScales;
    use crate::plant::model::Kind;
    use crate::recording::Accuracy;

    #[test]
    fn no_dashpot_pushes() {
        let scales = SignalScales::of(&[], 1.0);
        for kind in [Kind::ForceBalance, Kind::RigidMass] {
            let viscous = kind.parameters().iter().find(|parameter| parameter.key == "viscous").unwrap();
            let low = |stated| own_value(Some(stated), viscous, true, &scales).low;
            assert_eq!([low(0.0), low(200.0), low(-3.0)], [0.0, 0.0, -3.0]);
        }
    }

    #[test]
    fn a_stated_deviation_is_known_beforehand_of_a_value_that_is_fitted() {
        let scales = SignalScales::of(&[], 1.0);
        let mass = Kind::RigidMass.parameters().iter().find(|parameter| parameter.key == "mass").unwrap();
        let known = |free| {
            let accuracy = Accuracy { std: Some(2.0), low: None, high: None };
            beforehand(own_value(Some(100.0), mass, free, &scales), Some(&accuracy)).prior
        };
        let prior = known(true).unwrap();
        assert!((prior.std - 0.02).abs() < 1e-12 && (prior.mean - 100.0_f64.ln()).abs() < 1e-12, "{prior:?}");
        assert_eq!(known(false), None);
    }
}
