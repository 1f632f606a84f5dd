//! What else stands in the place of accepted names: others that the data do not tell apart from them, and what is then said.

use super::super::calibration::CALIBRATION;
use super::super::judged::{Decision, ScoredModel};
use super::super::standing::{at_bound, explains_all};
use super::EVEN;
use crate::plant::effects::{Stage, entry};

/// Alternatives among which one may be given as the likeliest.
const FEW: usize = 2;

/// Says of others of its size that explain the mismatch to the noise, as the accepted model does, that they are not told apart from it: what
/// they leave more, on both kinds of runs, is no more than a form leaves of what it explains, and than the noise is known by.
pub(super) fn as_exact_as_its_form(decision: &mut Decision) {
    let (stated, accepted) = (&decision.stated, &decision.accepted);
    if decision.unlisted || accepted.added.is_empty() || !is_negligible(accepted) {
        return;
    }
    let kinds = |judged: &ScoredModel| [judged.fit.chi2(), judged.hold.chi2];
    let near = |other: &&ScoredModel| {
        let each = kinds(stated).into_iter().zip(kinds(accepted)).zip(kinds(other));
        let mut each = each.map(|((stated, accepted), other)| (stated - accepted, other - accepted));
        each.all(|(explained, more)| more < CALIBRATION.negligible.min(CALIBRATION.form_most * explained))
    };
    let same_size = |other: &&ScoredModel| {
        other.added.len() == accepted.added.len() && other.added != accepted.added && !at_bound(other)
    };
    let alike = decision.candidates.iter().filter(same_size).filter(near);
    let ties = alike.map(|other| differing(&accepted.added, &other.added));
    let new: Vec<Vec<&'static str>> = ties.filter(|tie| !decision.ties.contains(tie)).collect();
    decision.ties.extend(new);
}

/// The effects in which two sets differ, those of the first before those of the other.
pub(super) fn differing(ours: &[&'static str], theirs: &[&'static str]) -> Vec<&'static str> {
    let of = |a: &[&'static str], b: &[&'static str]| -> Vec<&'static str> {
        a.iter().copied().filter(|id| !b.contains(id)).collect()
    };
    [of(ours, theirs), of(theirs, ours)].concat()
}

/// Takes names back for which several others stand as well: what is missing is then not among what these data can name, unless it is
/// explained whole. Then it is one of them. Of what is no more than noise nothing is missing.
pub(super) fn scatter(decision: &mut Decision, quiet: f64) {
    let beliefs = decision.accepted.added.iter().map(|id| belief(id, &decision.candidates));
    let Some(least) = beliefs.min_by(f64::total_cmp) else { return };
    if least < EVEN && is_negligible(&decision.stated) && one_story(decision) {
        return;
    }
    let many = least < EVEN && stories(&decision.ties, &decision.accepted.added) > FEW;
    let one_of_many = many && !explains_all(&decision.stated, &decision.accepted, quiet);
    if decision.unlisted || !(least < CALIBRATION.unlikely || one_of_many) {
        return;
    }
    if is_negligible(&decision.stated) {
        decision.fall_back(1.0 - least);
        (decision.accepted, decision.more_missing, decision.in_full) = (decision.stated.clone(), false, None);
        decision.ties.clear();
        return;
    }
    decision.take_back(1.0 - least);
    (decision.unlisted, decision.more_missing) = (true, false);
    decision.partial = Some(std::mem::replace(&mut decision.accepted, decision.stated.clone()));
    decision.one_of_many = one_of_many;
}

/// True where the accepted effect and those that the library says it is mistaken for are believed together: what is missing is one of them,
/// however many they are.
pub(in crate::diagnose) fn one_story(decision: &Decision) -> bool {
    let [id] = decision.accepted.added[..] else { return false };
    let same = |judged: &&ScoredModel| matches!(judged.added[..], [other] if other == id || mistaken(id, other));
    decision.candidates.iter().filter(same).map(|c| c.probability).sum::<f64>() >= EVEN
}

/// True where a model leaves no more than noise that is not known better, on both kinds of runs: nothing is missing there.
fn is_negligible(judged: &ScoredModel) -> bool {
    judged.hold.chi2.max(judged.fit.chi2()) - 1.0 < CALIBRATION.negligible
}

/// Alternatives among ties that tell another story than the accepted effects: another law of the same thing does not.
fn stories(ties: &[Vec<&'static str>], accepted: &[&'static str]) -> usize {
    let told = |tie: &Vec<&'static str>| {
        let (ours, theirs): (Vec<&'static str>, Vec<&'static str>) = tie.iter().partition(|id| accepted.contains(id));
        let of = |ids: &[&'static str], others: &[&'static str]| -> Vec<&'static str> {
            ids.iter().copied().filter(|id| !others.iter().any(|other| kin(id, other))).collect()
        };
        [of(&ours, &theirs), of(&theirs, &ours)].concat()
    };
    let mut stories: Vec<Vec<&'static str>> = ties.iter().map(told).filter(|story| !story.is_empty()).collect();
    stories.sort_unstable();
    stories.dedup();
    stories.len()
}

/// How far an effect, or another law of the same thing, is believed.
pub(super) fn belief(id: &str, candidates: &[ScoredModel]) -> f64 {
    let with = |judged: &&ScoredModel| judged.added.iter().any(|other| *other == id || kin(id, other));
    candidates.iter().filter(with).map(|c| c.probability).sum()
}

/// True for two laws of one thing: at one place, and one mistaken for the other by the library's own word. Sensors' faults are
/// each their own.
fn kin(id: &str, other: &str) -> bool {
    let (Some(a), Some(b)) = (entry(id), entry(other)) else { return false };
    a.stage == b.stage && a.stage != Stage::Sensor && mistaken(id, other)
}

/// True where one effect is mistaken for the other by the library's own word.
fn mistaken(id: &str, other: &str) -> bool {
    let (Some(a), Some(b)) = (entry(id), entry(other)) else { return false };
    a.mistaken_for.contains(&b.id) || b.mistaken_for.contains(&a.id)
}
