//! Names what is accepted: significance on the training, gain on the validation, and at least nine tenths of the excess
//! explained. What falls short is said to be outside the library.

mod alternatives;

use super::calibration::CALIBRATION;
use super::finish::{best_of, needed, polished, refined, simplify, unbent, without};
use super::judged::{Decision, ScoredModel};
use super::leftover::{follows, larger_noise, more_is_missing};
use super::onward::onward;
use super::ranking::Ranking;
use super::reach::Reach;
use super::rivals::rivals;
use super::search::{CHANCE, Search};
use super::split::Weighing;
use super::standing::{Alone, LEAST_GAIN, accounted, at_bound, beyond, is_justified, kept};
use crate::identify::data::Channel;
use crate::identify::fit::Fit;
use crate::identify::model::ModelEffect;
use crate::plant::effects::SignalScale;
use crate::plant::simulate::SimulateError;
pub(super) use alternatives::one_story;
use alternatives::{as_exact_as_its_form, belief, differing, scatter};
use rayon::prelude::*;

/// Models of each size that are weighed on the validation.
const JUDGED: usize = 6;
/// Probability below which a name is likelier wrong than right.
pub(super) const EVEN: f64 = 0.5;
/// Probability of physics outside the library where what is left follows nothing.
const IRREGULAR: f64 = 0.05;

/// Judges everything the search found.
pub(super) fn decide(weighing: &Weighing, search: &Search, reach: Reach) -> Result<Decision, SimulateError> {
    let judged = |fit: &Fit| ScoredModel::of(fit.clone(), weighing);
    let before = judged(&search.baseline)?;
    let mut sizes = Vec::new();
    for grown in &search.grown {
        let mut size = grown.par_iter().take(JUDGED).map(judged).collect::<Result<Vec<_>, _>>()?;
        size.extend(unbent(&size, weighing)?);
        simplify(&before, &mut size, weighing)?;
        let rank = Ranking::new(&before, &size);
        rank.sort(&mut size);
        if let Some(best) = size.first_mut() {
            *best = refined(best.clone(), weighing)?;
        }
        sizes.push(size);
    }
    let alone = Alone::of(search, &weighing.model().ids());
    let mut after = polished(choose(&before, &sizes, &alone), weighing)?;
    if after.added.is_empty() || !reach.is_worth_weighing(&before, &after) {
        return weigh(weighing, before, after, sizes);
    }
    loop {
        let mut rivals = rivals(weighing, &after.fit, search)?.iter().map(judged).collect::<Result<Vec<_>, _>>()?;
        simplify(&before, &mut rivals, weighing)?;
        let (best, rivals) = best_of(&before, after, rivals);
        sizes.push(rivals);
        after = best;
        let larger = onward(weighing, search, &before, &after, JUDGED)?;
        let justified =
            |model: &&ScoredModel| is_justified(&before, &after, model, alone.tell_apart(&after.added, &model.added));
        let standing = larger.iter().find(justified).cloned();
        sizes.push(larger);
        let Some(standing) = standing else { break };
        after = polished(standing, weighing)?;
    }
    let less = needed(&before, after.clone(), weighing, &alone)?;
    let after = if less.added.len() < after.added.len() { best_of_its_size(&before, less, &sizes) } else { after };
    weigh(weighing, before, after, sizes)
}

/// What is left of a model after an effect was taken out was found beside that effect: another of its size may do better.
fn best_of_its_size(before: &ScoredModel, less: ScoredModel, sizes: &[Vec<ScoredModel>]) -> ScoredModel {
    let size = less.added.len();
    best_of(before, less, sizes.iter().flatten().filter(|other| other.added.len() == size).cloned().collect()).0
}

/// The largest model that stands, each against the one before it.
fn choose(before: &ScoredModel, sizes: &[Vec<ScoredModel>], alone: &Alone) -> ScoredModel {
    let mut after = before.clone();
    let believed = before.departure.disbelief() < CHANCE;
    let beneath = believed && before.hold.chi2 < 1.0 && before.fit.squares < before.fit.rows as f64;
    // What leaves more than any noise is explained by something: where the best of a size does not stand, one that is not as good may.
    let asked = if before.hold.chi2.max(before.fit.chi2()) > CALIBRATION.modest { JUDGED } else { 1 };
    let mut skipped = false;
    for size in sizes {
        let stands = |model: &&ScoredModel| {
            is_justified(before, &after, model, alone.tell_apart(&after.added, &model.added))
                && (!beneath || follows_motion(before, model))
        };
        match size.iter().take(asked).find(stands) {
            Some(standing) => {
                after = standing.clone();
                skipped = false;
            }
            None if skipped => break,
            None => skipped = true,
        }
    }
    after
}

/// True where a model explains what noise does not, beneath a noise that was stated too large: more than noise that is not quite white
/// seems to gain, and no line, which stands in any noise for sure.
fn follows_motion(before: &ScoredModel, model: &ScoredModel) -> bool {
    let line = |p: &ModelEffect| p.entry.parameters.iter().any(|p| p.signal_scale == SignalScale::Line);
    gained_of_a_channel(before, model) > LEAST_GAIN && !model.fit.model.effects.iter().any(line)
}

/// The largest share of what a model leaves of a channel that it takes away from what another leaves there: a noise that was stated too
/// large, or of other channels, hides none of it.
fn gained_of_a_channel(before: &ScoredModel, model: &ScoredModel) -> f64 {
    let share = |(channel, chi2, _): (Channel, f64, usize)| Some((before.hold.chi2_of(channel)? - chi2) / chi2);
    model.hold.counted().filter_map(share).fold(f64::NEG_INFINITY, f64::max)
}

/// Weighs the accepted model against all others and against what no library holds.
pub(super) fn weigh(
    weighing: &Weighing,
    before: ScoredModel,
    mut after: ScoredModel,
    sizes: Vec<Vec<ScoredModel>>,
) -> Result<Decision, SimulateError> {
    let others = sizes.into_iter().flatten().filter(|c| c.added != after.added && !c.fit.model.is_redundant());
    let mut candidates: Vec<ScoredModel> = std::iter::once(before.clone()).chain(others).collect();
    // A set that was fitted twice counts once, at its best.
    candidates.sort_by(|a, b| a.total().total_cmp(&b.total()));
    let mut seen: Vec<Vec<&'static str>> = Vec::new();
    candidates.retain(|c| {
        let new = !seen.contains(&c.added);
        seen.push(c.added.clone());
        new
    });
    if !after.added.is_empty() {
        candidates.push(after.clone());
    }
    let ranking = Ranking::new(&before, &candidates);
    ranking.sort(&mut candidates);
    let follows = follows(weighing, &after)?;
    let quiet = follows.noise(&after);
    let excess = accounted(&before, &after, |model| {
        weighing.score(&Fit::resume(model, after.fit.locals.clone(), weighing.fitted())?)
    })?;
    let (mut unlisted, mut unlisted_probability) = beyond(excess, &after, quiet);
    let irregular = unlisted && follows.is_modest(&after) && !follows.is_certain();
    if irregular {
        (unlisted, unlisted_probability) = (false, IRREGULAR);
    }
    let larger = irregular || (!unlisted && quiet > CALIBRATION.negligible);
    let noise = if larger { larger_noise(weighing, &after, &follows) } else { Vec::new() };
    let mut ties = posterior(&ranking, &after, &mut candidates, unlisted_probability);
    let mut in_full = None;
    if !unlisted && let Some(surer) = surer(weighing, &after, &candidates)? {
        candidates.retain(|c| c.added != surer.added);
        candidates.push(surer.clone());
        in_full = Some(std::mem::replace(&mut after, surer));
        ties = posterior(&ranking, &after, &mut candidates, unlisted_probability);
    }
    if let Some(same) = candidates.iter().find(|c| c.added == after.added) {
        after.probability = same.probability;
    }
    let partial = (unlisted && !after.added.is_empty()).then(|| after.clone());
    if unlisted {
        after = before.clone();
    }
    let more_missing = in_full.is_some() || follows.is_certain() && more_is_missing(&before, &after, excess, quiet);
    let mut decision = Decision {
        stated: before,
        accepted: after,
        candidates,
        ties,
        unlisted,
        partial,
        unlisted_probability,
        more_missing,
        noise,
        in_full,
        one_of_many: false,
    };
    scatter(&mut decision, if larger { quiet } else { 0.0 });
    as_exact_as_its_form(&mut decision);
    if let Some(leader) = decision.partial.take_if(|partial| leads(&decision.stated, partial, &decision.candidates)) {
        decision.name_beside_more(&leader.added);
        decision.accepted = ScoredModel { probability: CALIBRATION.beside_more, ..leader };
    }
    Ok(decision)
}

/// The accepted model less the names of which others of its size stand in the place, where others stand: what is missing there is
/// then said to be missing, not named.
fn surer(
    weighing: &Weighing,
    after: &ScoredModel,
    candidates: &[ScoredModel],
) -> Result<Option<ScoredModel>, SimulateError> {
    let doubtful: Vec<&'static str> = after.added.iter().copied().filter(|id| belief(id, candidates) < EVEN).collect();
    if doubtful.is_empty() || doubtful.len() == after.added.len() {
        return Ok(None);
    }
    let less = without(after, &doubtful, weighing)?;
    let known = candidates.iter().filter(|c| c.added == less.added).cloned();
    Ok(known.chain([less.clone()]).min_by(|a, b| a.total().total_cmp(&b.total())))
}

/// Whether names explain most of the mismatch and no other set of their size comes near: what they leave is then something beside
/// them, not what they are mistaken for. The runs fitted and the others count together, for one may hardly show what the other does.
fn leads(before: &ScoredModel, names: &ScoredModel, candidates: &[ScoredModel]) -> bool {
    let mut rivals = candidates.iter().filter(|c| c.added.len() == names.added.len() && c.added != names.added);
    !at_bound(names)
        && kept(before, names) < (1.0 - CALIBRATION.most).powi(2)
        && rivals.all(|rival| kept(rival, names) < CALIBRATION.lead.powi(-2))
}

/// Spreads belief over the candidates of the accepted size and finds what is not told apart.
fn posterior(
    ranking: &Ranking,
    after: &ScoredModel,
    candidates: &mut [ScoredModel],
    unlisted: f64,
) -> Vec<Vec<&'static str>> {
    let best = ranking.cost(after);
    let odds = |judged: &ScoredModel| -0.5 * (ranking.cost(judged) - best);
    // A price on parameters chooses between what the data leave open; it does not close it.
    let open = |judged: &ScoredModel| -0.5 * (ranking.bare_cost(judged) - ranking.bare_cost(after));
    let same_size = |judged: &ScoredModel| judged.added.len() == after.added.len();
    let sum: f64 = candidates.iter().filter(|c| same_size(c)).map(|c| odds(c).min(50.0).exp()).sum();
    let mut ties = Vec::new();
    for judged in candidates.iter_mut() {
        if !same_size(judged) {
            judged.probability = 0.0;
            continue;
        }
        judged.probability = (1.0 - unlisted) * odds(judged).min(50.0).exp() / sum;
        if judged.added != after.added && !after.added.is_empty() && odds(judged).max(open(judged)) > -CALIBRATION.tie {
            ties.push(differing(&after.added, &judged.added));
        }
    }
    ties
}

#[cfg(test)]
pub(super) mod tests;
