//! The last fit and the only look at the runs held out: what was selected is fitted to every sample that may be fitted and
//! judged on data that nothing was chosen by. Names that do not hold there are taken back; nothing is chosen anew.

mod refusal;

use super::calibration::CALIBRATION;
use super::decide::EVEN;
use super::judged::{Decision, ScoredModel};
use super::leftover::{Followed, more_is_missing};
use super::split::Test;
use super::standing::{accounted, beyond, explains_all_held, outside};
use super::term::Modelled;
use crate::identify::data::Run;
use crate::identify::evaluate::Local;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::{score, score_beside, score_from};
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
pub(crate) use refusal::Refusal;
use refusal::{Before, refusal, rest_beyond_noise, untold};

/// How far the last fit goes: it starts from the values found on two thirds of its samples.
const LAST: Effort = Effort { steps: 12, tolerance: 1e-6 };
/// Share of the misfit on the runs held out, below which what is left of the runs fitted is nothing to speak of.
const NOTHING: f64 = 0.1;

/// What came out, as judged on the runs held out, or on those fitted where none is.
#[derive(Debug, Clone)]
pub struct Conclusion {
    /// The stated model.
    pub stated: ScoredModel,
    /// The model that is handed on: the one with the names or the curve, the stated one where nothing was found.
    pub accepted: ScoredModel,
    /// The best the library can do, where that is not enough for names.
    pub partial: Option<ScoredModel>,
    /// True where no combination of the library explains the mismatch.
    pub unlisted: bool,
    /// True where effects are named and more is missing beside them.
    pub more_missing: bool,
    /// Why names that were selected are not given.
    pub refusal: Option<Refusal>,
    /// The runs that judged.
    pub judging: Vec<Run>,
    /// True where these were held out.
    pub held_out: bool,
    /// What was selected, weighed on stretches of the runs fitted.
    pub decision: Decision,
}

impl Conclusion {
    /// True where the stated model and the recordings agree.
    pub fn consistent(&self) -> bool {
        !self.unlisted && self.accepted.added.is_empty()
    }

    /// Share of the stated model's excess that the model handed on leaves.
    pub fn left(&self) -> f64 {
        (self.accepted.hold.chi2 - 1.0).max(0.0) / (self.stated.hold.chi2 - 1.0).max(1e-9)
    }

    /// What the model handed on leaves beyond the noise on the runs that judge, as an excess of chi2; what noise leaves at least.
    pub(super) fn left_beyond_noise(&self) -> f64 {
        (self.accepted.hold.chi2 - 1.0).max(CALIBRATION.negligible)
    }

    /// True where the model handed on leaves no more than noise of the runs that judge.
    pub(super) fn explains_all(&self) -> bool {
        !rest_beyond_noise(&self.accepted)
    }

    /// True where the runs held out miss what the runs fitted do not show, or refuse what those showed.
    pub(super) fn unforeseen(&self) -> bool {
        let (fit, held) = (self.accepted.fit.chi2() - 1.0, self.accepted.hold.chi2 - 1.0);
        let hidden = outside(&self.stated, &self.accepted).0 && fit < NOTHING * held;
        let refused = self.unlisted
            && matches!(self.refusal, Some(Refusal::Worse { .. } | Refusal::NoSkill { .. } | Refusal::NoGain { .. }));
        self.held_out && (hidden || refused || self.leaves_more_held_out())
    }

    /// True where the runs held out alone show that more is missing. However little of the mismatch it is: a form that leaves a share of
    /// what its effect does leaves it on all runs alike.
    fn leaves_more_held_out(&self) -> bool {
        let (fit, held) = (self.accepted.fit.chi2() - 1.0, self.accepted.hold.chi2 - 1.0);
        (self.more_missing || rest_beyond_noise(&self.accepted)) && fit < NOTHING * held
    }

    /// Says that more is missing beside names where the runs held out alone show it, beyond any noise, and no second look found it.
    pub(super) fn note_what_is_left_there(&mut self) {
        let beyond = self.accepted.hold.chi2 > CALIBRATION.modest && self.leaves_more_held_out();
        self.more_missing |= self.held_out && beyond && !self.unlisted && !self.accepted.added.is_empty();
    }
}

/// Judges what was selected, and the curve that stands for what is unlisted; `seen` are the runs that were fitted so far.
pub(super) fn verdict(
    whole: &Prepared,
    seen: &[Run],
    mut decision: Decision,
    modelled: Option<&Modelled>,
    test: Test,
) -> Result<Conclusion, SimulateError> {
    let (judging, held_out) = test.consume(whole);
    let last = |judged: &ScoredModel| last(judged, (whole, seen), &judging);
    let stated = last(&decision.stated)?;
    let mut partial = decision.partial.as_ref().map(last).transpose()?;
    let curve = modelled.map(|modelled| last(&modelled.judged)).transpose()?.filter(|c| c.hold.chi2 < stated.hold.chi2);
    let selected = (!decision.accepted.added.is_empty()).then(|| last(&decision.accepted)).transpose()?;
    // Names that stand beside a curve are judged with it, and where that fails without it: the curve may be what fails.
    let beside = modelled.filter(|_| decision.more_missing && selected.is_none());
    let with_curve = if beside.is_some() { curve.clone() } else { None };
    let known = Before {
        beside_more: decision.more_missing,
        doubtful: selected.as_ref().is_some_and(|names| names.probability < EVEN),
    };
    let refused = |named: &ScoredModel| -> Result<Option<Refusal>, SimulateError> {
        let failed = refusal(&stated, named, &judging, known);
        if failed.is_some() { Ok(failed) } else { untold(&stated, named, whole, &judging) }
    };
    let (mut named, mut refusal) = (selected.or(with_curve), None);
    if let Some(all) = named.take() {
        let (rest, refused) = told(&all, refused, last)?;
        decision.pass_on(&all.added, &rest.added);
        (named, refusal) = (Some(rest), refused);
    }
    if (named.is_none() || refusal.is_some())
        && let Some(names) = beside.and_then(|modelled| decision.weighed(&modelled.judged.added).next())
        && let alone = last(names)?
        && refused(&alone)?.is_none()
    {
        (named, refusal) = (Some(alone), None);
    }
    // Of several names that stand as well one is right where they explain all that the runs held out miss.
    if decision.one_of_many
        && named.is_none()
        && let Some(names) = partial.as_ref().filter(|names| held_out && explains_all_held(&stated, names))
        && refused(names)?.is_none()
    {
        named = partial.take();
        decision.give_one_of_many();
    }
    let (mut unlisted, mut more_missing) = (decision.unlisted, decision.more_missing);
    let mut accepted = stated.clone();
    match named {
        Some(named) if refusal.is_none() => accepted = named,
        // Nothing is missing, and nothing there speaks for the names.
        Some(named) if refusal.as_ref().is_some_and(|refusal| leaves_nothing(&stated, refusal)) => {
            (unlisted, more_missing) = (false, false);
            decision.fall_back(CALIBRATION.failed);
            partial = Some(named);
        }
        Some(named) => {
            (unlisted, more_missing) = (true, false);
            decision.take_back(CALIBRATION.failed);
            partial = Some(named);
        }
        // The curve that names were given beside predicts the runs held out worse than the stated model: neither holds there.
        None if more_missing => {
            (unlisted, more_missing) = (true, false);
            decision.take_back(CALIBRATION.failed);
        }
        None => {}
    }
    // A misfit far from the noise is physics whether or not it follows the motion.
    if !unlisted
        && let fitted = score_from(&accepted.fit, &whole.fit)?
        && let follows = Followed::of(&judging, &accepted.hold.predicted).beside(&fitted)
        && (!follows.is_modest(&accepted) || follows.is_certain())
    {
        let quiet = follows.noise(&accepted);
        // What shows on the runs held out alone: more than the names explain, or anything at all.
        if !accepted.added.is_empty() {
            let excess = accounted(&stated, &accepted, |model| score(&model, &judging))?;
            more_missing |=
                more_is_missing(&stated, &accepted, excess, quiet) || follows.leaves_a_channel(&stated, &accepted);
        } else if beyond(stated.hold.chi2 - 1.0, &accepted, quiet).0 {
            unlisted = true;
            decision.take_back(CALIBRATION.failed);
        }
    }
    if !unlisted && !accepted.added.is_empty() && rest_beyond_noise(&accepted) {
        decision.take_back(CALIBRATION.mimicked);
    }
    // Without a curve the nearest that the library has predicts better than the stated model, whatever its names are worth.
    if unlisted && let Some(better) = curve.or(partial.clone().filter(|p| p.hold.chi2 < stated.hold.chi2)) {
        accepted = better;
    }
    Ok(Conclusion { stated, accepted, partial, unlisted, more_missing, refusal, judging, held_out, decision })
}

/// Whether the stated model leaves no more than noise of the runs that judge, and of those fitted where names that these showed are refused.
fn leaves_nothing(stated: &ScoredModel, refusal: &Refusal) -> bool {
    let fitted = stated.fit.chi2() - 1.0;
    !rest_beyond_noise(stated) && (matches!(refusal, Refusal::NotTold { .. }) || fitted < CALIBRATION.negligible)
}

/// Names less those that nothing shows on the runs that judge, as long as others are left, and why they cannot stand.
fn told(
    named: &ScoredModel,
    refused: impl Fn(&ScoredModel) -> Result<Option<Refusal>, SimulateError>,
    last: impl Fn(&ScoredModel) -> Result<ScoredModel, SimulateError>,
) -> Result<(ScoredModel, Option<Refusal>), SimulateError> {
    let mut rest = named.clone();
    let mut refusal = refused(&rest)?;
    while let Some(Refusal::NotTold { id }) = refusal
        && rest.added.len() > 1
    {
        rest.fit.model = rest.fit.model.without(id);
        rest.added.retain(|other| *other != id);
        rest = last(&rest)?;
        refusal = refused(&rest)?;
    }
    Ok((rest, refusal))
}

/// The stated model's standing, for recordings of which nothing else can be said.
pub(super) fn as_stated(whole: &Prepared, decision: Decision, test: Test) -> Result<Conclusion, SimulateError> {
    let (judging, held_out) = test.consume(whole);
    let stated = ScoredModel { hold: score(&decision.stated.fit.model, &judging)?, ..decision.stated.clone() };
    Ok(Conclusion {
        accepted: stated.clone(),
        stated,
        partial: None,
        unlisted: false,
        more_missing: false,
        refusal: None,
        judging,
        held_out,
        decision,
    })
}

/// A model fitted to all that may be fitted, judged.
fn last(
    judged: &ScoredModel,
    (whole, seen): (&Prepared, &[Run]),
    judging: &[Run],
) -> Result<ScoredModel, SimulateError> {
    let model = judged.fit.model.clone();
    // Where an excerpt begins is not where its run does.
    let local = |((run, seen), local): ((&Run, &Run), &Local)| {
        if run.from == seen.from { local.clone() } else { Local::start(&model, run) }
    };
    let locals = whole.fit.iter().zip(seen).zip(&judged.fit.locals).map(local).collect();
    let mut fit = Fit::resume(model, locals, &whole.fit)?;
    fit.improve(&whole.fit, LAST)?;
    Ok(ScoredModel { hold: score_beside(&fit, &whole.fit, judging)?, fit, ..judged.clone() })
}

#[cfg(test)]
pub(super) mod tests;
