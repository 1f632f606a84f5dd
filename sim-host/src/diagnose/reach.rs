//! How far a pass through the data goes.

use super::calibration::CALIBRATION;
use super::judged::{Decision, ScoredModel};

/// What a pass may see, and how far it weighs that.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reach {
    /// The beginnings of long runs: what does not settle there is weighed no further, for everything is looked at next.
    Beginnings,
    /// What may be fitted.
    Fitted,
    /// That, and half of the stretches held out where they alone show what is missing.
    Opened,
}

impl Reach {
    /// Whether a model is worth being held against others: it leaves little enough for names to be enough once they are.
    pub(super) fn is_worth_weighing(self, before: &ScoredModel, after: &ScoredModel) -> bool {
        let left = |before: f64, after: f64| (after - 1.0).max(0.0) / (before - 1.0).max(CALIBRATION.negligible);
        let most = TWICE * (1.0 - CALIBRATION.explained);
        self != Self::Beginnings
            || left(before.fit.chi2(), after.fit.chi2()) < most
            || left(before.hold.chi2, after.hold.chi2) < most
    }

    /// Whether a decision is worth a look for what the library does not hold, and for parts of time and state.
    pub(super) fn goes_on(self, decision: &Decision) -> bool {
        self != Self::Beginnings || !(decision.unlisted || decision.more_missing)
    }
}

/// Share of what names may leave beside which others in their place may still leave less.
const TWICE: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::super::verdict::tests::{concluded, with_viscous};
    use super::Reach;
    use crate::identify::fit::tests::{TRUTH, model};

    /// Of beginnings, names that leave most of the mismatch are not held against others, and what is open is not looked into; of everything
    /// they are.
    #[test]
    fn beginnings_that_do_not_settle_it_are_weighed_no_further() {
        let friction = with_viscous(90.0);
        let named = concluded(&friction, &friction, with_viscous(50.0));
        let (stated, accepted) = (&named.stated, &named.accepted);
        assert!(Reach::Beginnings.is_worth_weighing(stated, accepted) && Reach::Beginnings.goes_on(&named.decision));
        assert!(!Reach::Beginnings.is_worth_weighing(stated, stated));
        let open = concluded(&friction, &model(TRUTH), with_viscous(50.0)).decision;
        let open = [(true, false), (false, true)].map(|(unlisted, more_missing)| super::Decision {
            unlisted,
            more_missing,
            ..open.clone()
        });
        for reach in [Reach::Fitted, Reach::Opened] {
            assert!(reach.is_worth_weighing(stated, stated) && open.iter().all(|decision| reach.goes_on(decision)));
        }
        assert!(!open.iter().any(|decision| Reach::Beginnings.goes_on(decision)));
    }
}
