//! Long recordings looked at by their beginnings first: where these settle what is missing, all that was recorded is fitted once, for the
//! values, and judges.
//!
//! A clear effect shows in the samples of half a minute as well as in those of ten, and a search costs as many simulations of either. What
//! the beginnings do not settle, a name beside which more is missing or none at all, is searched for in everything.

use super::SEARCHED;
use super::calibration::CALIBRATION;
use super::concluded::Concluded;
use super::instead::Other;
use super::options::Options;
use super::passes::{End, conclude};
use super::reach::Reach;
use super::search::{CHANCE, beginnings};
use crate::identify::data::Run;
use crate::identify::prepare::Prepared;
use crate::identify::stated::fit_stated;
use crate::plant::simulate::SimulateError;

/// Samples that are as many as a search needs.
const FEW: usize = SEARCHED / 5;
/// Gains of squares, chance making one of them, that the beginnings must show of what is missing.
const CLEAR: f64 = 60.0;

/// Selects and judges, by the beginnings of what was seen where they are enough; where they are not, another reading of the set-up may
/// explain what they show, and saves the search of everything by the wrong one.
pub(super) fn conclude_by_few(
    whole: Prepared,
    seen: Prepared,
    options: &Options,
    reach: Reach,
    otherwise: impl Fn(&Concluded) -> Result<Option<Other>, SimulateError>,
) -> Result<End, SimulateError> {
    if let Some(few) = few(&seen, FEW)? {
        options.say("looking at the beginnings of long runs", 0.02);
        let end = conclude(whole.clone(), few, options, Reach::Beginnings)?;
        if settles(&end) {
            return Ok(end);
        }
        if let End::Concluded(concluded) = end
            && let Some(other) = otherwise(&concluded)?
        {
            return Ok(End::Otherwise(concluded, other));
        }
        options.say("the beginnings do not settle it: looking at everything", 0.02);
    }
    conclude(whole, seen, options, reach)
}

/// The beginnings of the runs that are seen, of so many samples at least, where they are few of all and show what is missing beyond doubt.
fn few(seen: &Prepared, least: usize) -> Result<Option<Prepared>, SimulateError> {
    if seen.fit.iter().map(Run::len).sum::<usize>() < 2 * least {
        return Ok(None);
    }
    let fit = fit_stated(seen)?;
    let Some(beginnings) = beginnings(&fit, &seen.fit, least as f64, 0.0)? else { return Ok(None) };
    let few = Prepared { fit: beginnings, ..seen.clone() };
    let fit = fit.on(&few.fit)?;
    let shown = fit.squares - fit.rows as f64;
    Ok((shown > CLEAR * CHANCE).then_some(few))
}

/// Whether nothing is left to be found: names that explain what there is, or a clock by which everything is to be read anew.
fn settles(end: &End) -> bool {
    let End::Concluded(concluded) = end else { return true };
    let conclusion = &concluded.conclusion;
    let names = !conclusion.unlisted && !conclusion.more_missing && !conclusion.consistent();
    names && conclusion.left() < 1.0 - CALIBRATION.explained
}

#[cfg(test)]
mod tests {
    use super::super::decide::tests::viscous;
    use super::super::verdict::Conclusion;
    use super::super::verdict::tests::{concluded, with_viscous};
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model, recorded};
    use crate::identify::model::{Model, SignalScales};

    fn seen(truth: &Model) -> Prepared {
        let fit = vec![recorded(truth, 1)];
        let signal_scales = SignalScales::of(&fit, 1.0);
        Prepared { model: model(TRUTH), fit, holdout: Vec::new(), signal_scales }
    }

    /// What shows all along shows at the beginning too; of a right model nothing shows there, and of a short run there is no beginning.
    #[test]
    fn a_beginning_is_enough_where_it_shows_what_is_missing() {
        let missing = seen(&model(TRUTH).with(viscous(30.0, 0.0, (-0.2, 2.0))));
        let of = |seen: &Prepared, least: usize| few(seen, least).unwrap().map(|few| few.fit[0].len());
        let beginning = of(&missing, 800).expect("friction shows at once");
        assert!((800..1800).contains(&beginning), "{beginning} of {}", missing.fit[0].len());
        assert_eq!(of(&missing, 2000), None);
        assert_eq!(of(&seen(&model(TRUTH)), 800), None);
    }

    /// Names that explain what there is settle it; none, or names beside which more is missing, do not.
    #[test]
    fn names_that_explain_it_settle_it() {
        let (none, friction) = (model(TRUTH), with_viscous(90.0));
        let ended = |conclusion: Conclusion| {
            End::Concluded(Box::new(Concluded {
                whole: seen(&none),
                conclusion,
                modelled: None,
                held_out_shared: false,
            }))
        };
        let named = concluded(&friction, &friction, with_viscous(50.0));
        let beside_more = Conclusion { more_missing: true, ..named.clone() };
        assert!(settles(&ended(named)));
        assert!(!settles(&ended(beside_more)));
        assert!(!settles(&ended(concluded(&none, &none, model(TRUTH)))));
    }
}
