//! The passes forward through the data: selected on training and validation, judged on the test; once more by a corrected clock, by a
//! noise that was stated too large, or with half of what was held out opened.

use super::calibration::CALIBRATION;
use super::concluded::{Concluded, FAR_LESS};
use super::instead::Other;
use super::judged::Decision;
use super::options::Options;
use super::reach::Reach;
use super::split::{Split, Weighing, reopened, split};
use super::term::Modelled;
use super::verdict::Conclusion;
use super::{SEARCHED, beside, clock, decide, outdone, overstated, region, reject_for_curve, search, term, verdict};
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

/// Share of the excess on the runs held out beyond which names leave most of it.
const MOST_LEFT: f64 = 0.5;

/// How passes end.
pub(super) enum End {
    Concluded(Box<Concluded>),
    /// What was concluded settles nothing, and another reading of the set-up explains the recordings.
    Otherwise(Box<Concluded>, Other),
    /// A clock of another rate is part of what was selected: everything is to be read anew by it, and what was judged before counts for nothing.
    Clock(SetUpFinding),
}

/// Selects and judges; once more with half of the stretches held out opened where they alone show what is missing.
pub(super) fn conclude(
    mut whole: Prepared,
    mut seen: Prepared,
    options: &Options,
    reach: Reach,
) -> Result<End, SimulateError> {
    let (split_up, selected) = with_noise_as_left(&mut whole, &mut seen, options, reach)?;
    if let Some(finding) = clock_in(&selected, &whole) {
        return Ok(End::Clock(finding));
    }
    let mut first = judge(split_up, selected, options, reach)?;
    if !first.conclusion.unforeseen() {
        return Ok(ended(first));
    }
    let rows = |runs: &[Run]| runs.iter().map(Run::len).sum::<usize>();
    let too_many = rows(&seen.fit) + rows(&first.conclusion.judging) / 2 > 2 * SEARCHED;
    if too_many || reach != Reach::Opened {
        first.conclusion.note_what_is_left_there();
        return Ok(ended(first));
    }
    options.say("the runs fitted do not show it: opening half of those held out", 0.9);
    let Conclusion { accepted, judging, .. } = &first.conclusion;
    let opened = reopened(&first.whole, seen, judging, &accepted.hold.predicted);
    let selected = select(&opened.weighing, options, reach)?;
    if let Some(finding) = clock_in(&selected, &opened.whole) {
        return Ok(End::Clock(finding));
    }
    let second = judge(opened, selected, options, reach)?;
    if is_better(&second.conclusion, &first.conclusion) {
        return Ok(ended(Concluded { held_out_shared: true, ..second }));
    }
    first.conclusion.note_what_is_left_there();
    Ok(ended(first))
}

/// Whether what was concluded with half of what was held out opened stands in the place of what was concluded before.
fn is_better(second: &Conclusion, first: &Conclusion) -> bool {
    let names = |conclusion: &Conclusion| !conclusion.unlisted && !conclusion.consistent();
    let left = first.left();
    let far_less = names(second) && (!names(first) || second.left() < FAR_LESS * left);
    // Names for the little that the runs fitted show say nothing of the much that those held out show and nothing explains. Those that
    // explain most of that stay, but where a curve explains more.
    let outdone = left > MOST_LEFT || second.left() < left;
    let for_a_little = names(first) && second.unlisted && outdone && left > 1.0 - CALIBRATION.explained;
    // Values that the runs fitted hardly determine predict nothing: fitted to some of what they missed, they predict the rest.
    let of_values = second.consistent() && second.explains_all();
    far_less || for_a_little || of_values
}

fn ended(mut concluded: Concluded) -> End {
    clock::settle(&mut concluded.whole);
    End::Concluded(Box::new(concluded))
}

/// A clock of another rate among what was selected.
fn clock_in(selected: &Selected, whole: &Prepared) -> Option<SetUpFinding> {
    clock::found(&selected.decision.accepted.fit, whole.fit.first().map_or(1.0, |run| run.dt))
}

/// Cuts the data up and selects; once more where what is named leaves less than the noise of a channel and one effect more leaves
/// still less of it: that noise is no larger than this, and what hides beneath it is weighed by it.
pub(super) fn with_noise_as_left(
    whole: &mut Prepared,
    seen: &mut Prepared,
    options: &Options,
    reach: Reach,
) -> Result<(Split, Selected), SimulateError> {
    let cut = |whole: &Prepared, seen: &Prepared| split(whole.clone(), Some(seen.clone()));
    let first = cut(whole, seen);
    let selected = select(&first.weighing, options, reach)?;
    let Some(left) = overstated::by_names(&first.weighing, &selected.decision) else { return Ok((first, selected)) };
    options.say("looking beneath a noise that was stated too large", 0.1);
    let mut lowered = [seen.clone(), whole.clone()];
    for prepared in &mut lowered {
        overstated::lower(prepared, &left);
    }
    let beneath = cut(&lowered[1], &lowered[0]).weighing;
    let named = &selected.decision.accepted.fit;
    let mut named = Fit::resume(named.model.clone(), named.locals.clone(), beneath.fitted())?;
    named.improve(beneath.fitted(), Effort::FULL)?;
    let one_more = search::grow_beside(&named, beneath.fitted(), &beneath.signal_scales())?;
    let Some(least) = overstated::by_any(&beneath, &one_more)? else {
        return Ok((first, selected));
    };
    for prepared in &mut lowered {
        overstated::lower(prepared, &least);
    }
    [*seen, *whole] = lowered;
    let second = cut(whole, seen);
    let selected = select(&second.weighing, options, reach)?;
    Ok((second, selected))
}

/// What was selected, and the curve that outdoes it.
pub(super) struct Selected {
    pub(super) decision: Decision,
    pub(super) modelled: Option<Modelled>,
}

/// Fits hypotheses to the training and weighs them on the validation.
pub(super) fn select(weighing: &Weighing, options: &Options, reach: Reach) -> Result<Selected, SimulateError> {
    let search = search::search(weighing, options)?;
    options.say("weighing what was found", 0.9);
    let decision = decide::decide(weighing, &search, reach)?;
    if !reach.goes_on(&decision) {
        return Ok(Selected { decision, modelled: None });
    }
    options.say("looking for effects that act in a part of time or state", 0.92);
    let mut decision = region::region(weighing, &search, decision)?;
    let mut modelled = reject_for_curve::reject_for_curve(weighing, &mut decision)?;
    if modelled.is_none() {
        modelled = outdone::reject_for_valve(weighing, &mut decision)?;
    }
    Ok(Selected { decision, modelled })
}

/// Models what is unlisted and judges all on the test.
fn judge(split: Split, selected: Selected, options: &Options, reach: Reach) -> Result<Concluded, SimulateError> {
    let Split { weighing, whole, test } = split;
    let Selected { mut decision, mut modelled } = selected;
    let unlisted = decision.unlisted && reach.goes_on(&decision);
    if modelled.is_none() && unlisted {
        options.say("modelling what the library does not hold", 0.93);
        let beside = decision.partial.as_ref().unwrap_or(&decision.stated);
        modelled = term::unlisted(&weighing, &decision.stated, beside)?;
    }
    if unlisted && let Some(unnamed) = modelled.as_ref().filter(|m| !m.names_needed) {
        options.say("looking for effects beside it", 0.94);
        modelled = beside::name_beside(&weighing, &mut decision, unnamed)?.or(modelled);
    }
    let explain = |m: &&Modelled| decision.explain_a_part(&m.judged.added);
    if let Some(modelled) = modelled.as_ref().filter(|m| decision.unlisted && m.names_needed).filter(explain) {
        decision.name_beside_more(&modelled.judged.added);
    }
    let conclusion = verdict::verdict(&whole, weighing.fitted(), decision, modelled.as_ref(), test)?;
    Ok(Concluded { whole, conclusion, modelled, held_out_shared: false })
}

#[cfg(test)]
mod tests {
    use super::super::verdict::tests::{concluded, with_viscous};
    use super::is_better;
    use crate::identify::fit::tests::{TRUTH, model};

    /// What the runs held out refused is no mismatch where the stated model, fitted to half of them too, explains the rest; where that is
    /// not so either, what was said first stands.
    #[test]
    fn values_that_the_runs_fitted_do_not_determine_are_no_mismatch() {
        let (none, friction) = (model(TRUTH), with_viscous(90.0));
        let refused = concluded(&friction, &none, with_viscous(50.0));
        let consistent = concluded(&none, &none, model(TRUTH));
        let missed = concluded(&friction, &friction, model(TRUTH));
        assert!(refused.unlisted && consistent.consistent());
        assert!(is_better(&consistent, &refused));
        assert!(!is_better(&missed, &refused) && !is_better(&refused, &refused));
    }
    /// Names that explain most of what the runs held out show give way to what explains more of it, not to what leaves more; names for a
    /// little give way to either.
    #[test]
    fn names_that_explain_most_stand_against_what_leaves_more() {
        let friction = with_viscous(90.0);
        let leaving = |share: f64, unlisted: bool| {
            let mut conclusion = concluded(&friction, &friction, with_viscous(50.0));
            conclusion.accepted.hold.chi2 = 1.0 + share * (conclusion.stated.hold.chi2 - 1.0);
            conclusion.unlisted = unlisted;
            conclusion
        };
        let names = leaving(0.13, false);
        assert!(!is_better(&leaving(0.52, true), &names) && is_better(&leaving(0.11, true), &names));
        assert!(is_better(&leaving(1.0, true), &leaving(0.7, false)));
    }
}
