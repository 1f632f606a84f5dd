//! How far a fitted model's values are from those stated, and how firmly the data hold them there.

use super::calibration::CALIBRATION;
use super::clock;
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::plant::effects::valve_lag;
use crate::plant::model::Kind;
use nalgebra::{DMatrix, DVector};

/// Stated values that were fitted: where they came to lie, and what their return would cost.
///
/// A value that the data hardly determine lies wherever an equation's error of form leads it, and says nothing against that equation: it
/// could be put back for a little of what the fit explains. So what counts is the least of both together,
///
/// ```text
/// min over u:  misfit(S + u' H u) + |r + u|^2
/// ```
/// with the squares S of the best fit, their curvature H by the stated values, all others fitted along, and r how far these are from
/// what was stated, in standard deviations of what stated values are wrong by.
#[derive(Debug, Clone)]
pub(super) struct Departure {
    away: DVector<f64>,
    /// Inverse of H in the same unit; none where the data do not determine the model.
    spread: Option<DMatrix<f64>>,
    /// What speaks against a clock at another rate and against values that an effect seldom has, which no value of the plant can take
    /// back.
    seldom: f64,
}

/// What is known of an effect's value before any recording.
struct Usual {
    id: &'static str,
    key: &'static str,
    value: f64,
    /// Standard deviation of its logarithm.
    spread: f64,
}

/// A spool that is damped by much more than one is two lags one after the other, which a sensor's filter is as well. The value and its
/// spread are by judgement.
///
/// Source of the form: W. J. Thayer, "Transfer functions for Moog servovalves", Technical Bulletin 103, Moog, 1958, revised 1965.
const USUAL: [Usual; 1] = [Usual { id: valve_lag::ENTRY.id, key: "damping", value: 0.8, spread: 0.35 }];

/// What speaks against the values of effects that were added, as twice a logarithm.
fn unusual(stated: &Model, fitted: &Model) -> f64 {
    let known = stated.ids();
    let away = |usual: &Usual| {
        let placed = fitted.effects.iter().find(|placed| placed.entry.id == usual.id)?;
        let place = placed.entry.parameters.iter().position(|parameter| parameter.key == usual.key)?;
        Some(((placed.values.get(place)?.value / usual.value).ln() / usual.spread).powi(2))
    };
    USUAL.iter().filter(|usual| !known.contains(&usual.id)).filter_map(away).sum()
}

/// Prices of a square at which the values are put back, as powers of ten, and how many a decade.
const PRICES: (f64, f64) = (-9.0, 3.0);
const A_DECADE: f64 = 4.0;

impl Departure {
    /// Of a fit from what was stated. Masses and dashpots may be stated in any way: residuals depend on them almost linearly.
    pub(super) fn of(stated: &Model, fit: &Fit) -> Self {
        let seldom = clock::disbelief(stated, &fit.model) + unusual(stated, &fit.model);
        if stated.kind != Kind::Servo {
            return Self { away: DVector::zeros(0), spread: None, seldom };
        }
        // Coordinates of the fit: its free values in their order, of which the plant's own are the first.
        let pairs = stated.own.iter().zip(&fit.model.own).filter(|(_, fitted)| fitted.free).enumerate();
        let known: Vec<(usize, f64, f64)> = pairs
            .filter(|(_, (stated, _))| stated.free && stated.value != 0.0)
            .map(|(i, (stated, fitted))| {
                let unit = CALIBRATION.stated_share * stated.value;
                (i, (fitted.value - stated.value) / unit, fitted.slope() / unit)
            })
            .collect();
        let of = |all: DMatrix<f64>| {
            DMatrix::from_fn(known.len(), known.len(), |i, j| all[(known[i].0, known[j].0)] * known[i].2 * known[j].2)
        };
        Self {
            away: DVector::from_iterator(known.len(), known.iter().map(|k| k.1)),
            spread: fit.spread().map(of),
            seldom,
        }
    }

    /// How far the stated values went: the sum of squares of what they are away, in what stated values are wrong by.
    pub(super) fn disbelief(&self) -> f64 {
        self.away.norm_squared() + self.seldom
    }

    /// The least of a misfit, which grows with what is added to the squares of the fit, and of what the values are still away.
    pub(super) fn least(&self, misfit: impl Fn(f64) -> f64) -> f64 {
        let as_fitted = misfit(0.0) + self.away.norm_squared();
        let Some(spread) = &self.spread else { return as_fitted + self.seldom };
        let count = ((PRICES.1 - PRICES.0) * A_DECADE) as i32;
        let put_back = |k: i32| {
            let price = 10f64.powf(PRICES.0 + f64::from(k) / A_DECADE);
            let priced = spread + DMatrix::identity(self.away.len(), self.away.len()) * price;
            let part = priced.cholesky()?.solve(&self.away);
            let added = part.dot(&(spread * &part));
            Some(misfit(added) + (part * price).norm_squared())
        };
        (0..=count).filter_map(put_back).fold(as_fitted, f64::min) + self.seldom
    }

    /// Of values that are as stated.
    #[cfg(test)]
    pub(super) fn none() -> Self {
        Self { away: DVector::zeros(0), spread: None, seldom: 0.0 }
    }

    /// Of one value that is away by so many standard deviations, with the variance that the data leave it.
    #[cfg(test)]
    pub(super) fn away(by: f64, variance: f64) -> Self {
        let spread = Some(DMatrix::from_element(1, 1, variance));
        Self { away: DVector::from_element(1, by), spread, seldom: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a square counts as it is, the least is that of two parabolas: r^2 / (1 + variance).
    #[test]
    fn a_value_is_put_back_as_far_as_the_data_let_it() {
        for variance in [1e-4, 0.3, 20.0] {
            let least = Departure::away(3.0, variance).least(|squares| squares);
            let exact = 9.0 / (1.0 + variance);
            assert!((least / exact - 1.0).abs() < 0.1 && least >= exact - 1e-9, "{variance}: {least} of {exact}");
        }
        assert!((Departure::away(3.0, 1e-12).disbelief() - 9.0).abs() < 1e-12);
    }
}
