//! Names what stands: significance on the runs fitted, gain on the runs held back, and at least nine tenths of the
//! excess explained. What falls short is said to be outside the library.

use super::finish::{best_of, needed, polished, refined};
use super::leftover::{follows, larger_noise, more_is_missing};
use super::ranking::{Ranking, parameters};
use super::rivals::rivals;
use super::search::{CHANCE, Search};
use crate::identify::fit::Fit;
use crate::identify::judge::{Score, gains, score};
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;
use rayon::prelude::*;

/// Models of each size that are judged on the runs held back.
const JUDGED: usize = 6;
/// Gain of squares on the runs held back that chance does not give a model fitted elsewhere.
pub(super) const SURE: f64 = 16.0;
/// Gain there that needs no other on the runs fitted.
const OVERWHELMING: f64 = 600.0;
/// Most of that gain that blocks may lose elsewhere.
const LOST: f64 = 0.5;
/// Share of what was left that one more effect must take away.
const WORTH: f64 = 0.65;
/// Share of the baseline's excess that one more effect must take away: simple forms leave about as much of a real one.
const NOTICEABLE: f64 = 0.018;
/// Excess of chi2 on the runs fitted that speaks for itself where those held back are silent.
const SHOWN: f64 = 1.0;
/// Share of the excess that must be explained for names to be given; all but noise where an effect fits only at the end of
/// what makes sense for it, which a stranger to the mismatch may do.
const EXPLAINED: f64 = 0.9;
/// Excess of chi2 that is never called physics: noise is not known better.
const NEGLIGIBLE: f64 = 0.06;
/// chi2 up to which what follows nothing is noise that was stated too small.
const MODEST: f64 = 2.5;
/// Probability of physics outside the library where what is left follows nothing.
const IRREGULAR: f64 = 0.05;
/// Share of what is still left that an effect must have taken away: what explains less is a stranger to the mismatch.
const CREDIBLE: f64 = 0.15;
/// Least gain of chi2 for a further effect: less than this is not told from noise that is not quite white.
const LEAST_GAIN: f64 = 0.015;
/// Log odds below which two models are not told apart.
const TIE: f64 = 3.0;

/// A model and how it foresees the runs held back.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The fitted model.
    pub fit: Fit,
    /// Its standing on the runs held back.
    pub hold: Score,
    /// Effects it adds to the stated model.
    pub added: Vec<&'static str>,
    /// Its share of belief among the candidates.
    pub probability: f64,
}

impl Judged {
    /// Scores a fitted model on the runs that judge.
    pub(super) fn of(fit: Fit, prepared: &Prepared) -> Result<Self, SimulateError> {
        let added = fit.model.ids_beside(&prepared.model.ids());
        Ok(Self { hold: score(&fit.model, prepared.judging())?, fit, added, probability: 0.0 })
    }

    /// Squares on all runs.
    pub(super) fn total(&self) -> f64 {
        self.fit.squares + self.hold.squares()
    }

    /// Mean square and number of residuals on the runs fitted and on those that judge.
    pub(super) fn kinds(&self) -> [(f64, f64); 2] {
        let kind = |squares: f64, rows: usize| ((squares / (rows as f64).max(1.0)).max(f64::MIN_POSITIVE), rows as f64);
        [kind(self.fit.squares, self.fit.rows), kind(self.hold.squares(), self.hold.rows)]
    }
}

/// What was decided.
#[derive(Debug, Clone)]
pub struct Decision {
    /// The stated model on the runs held back.
    pub before: Judged,
    /// The model that is handed on: the accepted one, the stated one where nothing was added, the one that foresees best where
    /// the mismatch is unlisted.
    pub after: Judged,
    /// Every model judged, best first.
    pub candidates: Vec<Judged>,
    /// Sets of effects that the data cannot tell apart.
    pub ties: Vec<Vec<&'static str>>,
    /// True where no combination of the library explains the mismatch.
    pub unlisted: bool,
    /// The best the library can do, where that is not enough.
    pub partial: Option<Judged>,
    /// Probability that the mismatch is outside the library.
    pub unlisted_probability: f64,
    /// True where effects are named and leave more than noise and the simplicity of their equations.
    pub more_missing: bool,
    /// Noise that was found larger than stated: what is left of it follows nothing.
    pub noise: Vec<SetUpFinding>,
}

impl Decision {
    /// True where the stated model and the recordings agree.
    pub fn consistent(&self) -> bool {
        !self.unlisted && self.after.added.is_empty()
    }

    /// Share of the stated model's excess on the runs held back that the model handed on leaves.
    pub fn left(&self) -> f64 {
        (self.after.hold.chi2 - 1.0).max(0.0) / (self.before.hold.chi2 - 1.0).max(1e-9)
    }
}

/// Judges everything the search found.
pub fn decide(prepared: &Prepared, search: &Search) -> Result<Decision, SimulateError> {
    let judged = |fit: &Fit| Judged::of(fit.clone(), prepared);
    let before = judged(&search.baseline)?;
    let mut sizes = Vec::new();
    for grown in &search.grown {
        let mut size = grown.par_iter().take(JUDGED).map(judged).collect::<Result<Vec<_>, _>>()?;
        let rank = Ranking::new(prepared, &before, &size);
        size.sort_by(|a, b| rank.cost(a).total_cmp(&rank.cost(b)));
        if let Some(best) = size.first_mut() {
            *best = refined(best.clone(), prepared)?;
        }
        sizes.push(size);
    }
    let after = polished(choose(&before, &sizes), prepared)?;
    if after.added.is_empty() {
        return weigh(prepared, before, after, sizes);
    }
    let rivals = rivals(prepared, &after.fit, search)?.iter().map(judged).collect::<Result<Vec<_>, _>>()?;
    let (after, rivals) = best_of(prepared, &before, after, rivals);
    sizes.push(rivals);
    let less = needed(&before, after.clone(), prepared)?;
    let after =
        if less.added.len() < after.added.len() { best_of_its_size(prepared, &before, less, &sizes) } else { after };
    weigh(prepared, before, after, sizes)
}

/// What is left of a model after an effect was taken out was found beside that effect: another of its size may do better.
fn best_of_its_size(prepared: &Prepared, before: &Judged, less: Judged, sizes: &[Vec<Judged>]) -> Judged {
    let size = less.added.len();
    best_of(prepared, before, less, sizes.iter().flatten().filter(|other| other.added.len() == size).cloned().collect())
        .0
}

/// The largest model that stands, each against the one before it.
fn choose(before: &Judged, sizes: &[Vec<Judged>]) -> Judged {
    let mut after = before.clone();
    // What already leaves less than the noise has nothing to explain, however surely a line stands within it.
    if before.hold.chi2 < 1.0 && before.fit.squares < before.fit.rows as f64 {
        return after;
    }
    let mut skipped = false;
    for size in sizes {
        let Some(best) = size.first() else { break };
        if stands(before, &after, best) {
            after = best.clone();
            skipped = false;
        } else if skipped {
            break;
        } else {
            skipped = true;
        }
    }
    after
}

/// Weighs the accepted model against all others and against what no library holds.
fn weigh(
    prepared: &Prepared,
    before: Judged,
    mut after: Judged,
    sizes: Vec<Vec<Judged>>,
) -> Result<Decision, SimulateError> {
    let others = sizes.into_iter().flatten().filter(|c| c.added != after.added);
    let mut candidates: Vec<Judged> = std::iter::once(before.clone()).chain(others).collect();
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
    let ranking = Ranking::new(prepared, &before, &candidates);
    candidates.sort_by(|a, b| ranking.cost(a).total_cmp(&ranking.cost(b)));
    let (mut unlisted, mut unlisted_probability) = outside(&before, &after);
    let mut noise = Vec::new();
    let modest = after.hold.chi2.max(after.fit.chi2()) < MODEST;
    let follows = follows(prepared, &after)?;
    if unlisted && modest && !follows.is_certain() {
        (unlisted, unlisted_probability) = (false, IRREGULAR);
        noise = larger_noise(prepared, &after, NEGLIGIBLE);
    }
    let ties = believe(&ranking, &after, &mut candidates, unlisted_probability);
    if let Some(same) = candidates.iter().find(|c| c.added == after.added) {
        after.probability = same.probability;
    }
    let partial = (unlisted && !after.added.is_empty()).then(|| after.clone());
    if unlisted {
        after = before.clone();
    }
    let more_missing = follows.is_certain() && more_is_missing(&before, &after, NEGLIGIBLE);
    Ok(Decision { before, after, candidates, ties, unlisted, partial, unlisted_probability, more_missing, noise })
}

/// Whether a larger model stands against the present one.
pub(super) fn stands(before: &Judged, present: &Judged, larger: &Judged) -> bool {
    let added = parameters(larger) - parameters(present);
    let gained = present.fit.squares - larger.fit.squares;
    let held_gain = present.hold.chi2 - larger.hold.chi2;
    let left = (present.hold.chi2 - 1.0).max(0.0);
    let excess = (before.hold.chi2 - 1.0).max(0.0);
    let (better, worse) = gains(&present.hold.blocks, &larger.hold.blocks);
    // Where little is left its colour is the noise's own; a misfit's colour is no noise.
    let colour = if larger.hold.chi2 < 1.3 { larger.hold.colour } else { 1.0 };
    // What values far from those stated hide on the runs fitted shows on those held back.
    let shown_there = gained > -CHANCE && better - worse > OVERWHELMING * colour;
    if silent(present, larger) {
        return gained > OVERWHELMING && worse - better < SURE * colour;
    }
    (gained > (CHANCE + 4.0 * added) * colour || shown_there)
        && better - worse > SURE * colour
        && worse < LOST * better
        && (present.added.is_empty() || held_gain > (WORTH * left).max(LEAST_GAIN))
        && held_gain > NOTICEABLE * excess
        && held_gain > CREDIBLE * (larger.hold.chi2 - 1.0)
}

/// True where the runs held back cannot say: they lack nothing without an effect that explains nearly all that the runs
/// fitted lack.
fn silent(present: &Judged, larger: &Judged) -> bool {
    let lacks = |judged: &Judged| (judged.fit.chi2() - 1.0).max(0.0);
    present.hold.chi2 < 1.0 + NEGLIGIBLE && lacks(present) > SHOWN && lacks(larger) < (1.0 - EXPLAINED) * lacks(present)
}

/// True where an added effect fits only at an end of what makes sense, one that stands for no simpler form of it.
pub(super) fn strained(judged: &Judged) -> bool {
    let names = judged.fit.model.effects.iter().flat_map(|p| p.entry.parameters.iter().map(|q| (p.entry.id, q)));
    let own = judged.fit.model.values().count() - names.clone().count();
    let pushed = judged.fit.pushed().into_iter().skip(own);
    let values = judged.fit.model.values().skip(own);
    names.zip(values).zip(pushed).any(|(((id, parameter), value), cost)| {
        let at_low = value.value - value.low < value.high - value.value;
        judged.added.contains(&id) && cost > CHANCE && parameter.simple.strained(at_low)
    })
}

/// Whether what is left lies outside the library, and how probable that is.
fn outside(before: &Judged, after: &Judged) -> (bool, f64) {
    let excess = before.hold.chi2 - 1.0;
    let left = after.hold.chi2 - 1.0;
    let blur = 3.0 * (2.0 / after.hold.samples.max(1) as f64).sqrt();
    let noise = NEGLIGIBLE + blur;
    let allowed = if strained(after) { noise } else { noise.max((1.0 - EXPLAINED) * excess) };
    let ratio = (left / allowed).max(1e-3);
    (left > allowed, 1.0 / (1.0 + (-3.0 * ratio.ln()).exp()) * if ratio < 0.3 { 0.5 } else { 1.0 })
}

/// True where a model explains the mismatch with values that make sense.
pub(super) fn sound(before: &Judged, judged: &Judged) -> bool {
    !strained(judged) && !outside(before, judged).0
}

/// Spreads belief over the candidates of the accepted size and finds what is not told apart.
fn believe(ranking: &Ranking, after: &Judged, candidates: &mut [Judged], unlisted: f64) -> Vec<Vec<&'static str>> {
    let best = ranking.cost(after);
    let odds = |judged: &Judged| -0.5 * (ranking.cost(judged) - best);
    // A price on parameters chooses between what the data leave open; it does not close it.
    let open = |judged: &Judged| -0.5 * (ranking.bare_cost(judged) - ranking.bare_cost(after));
    let same_size = |judged: &Judged| judged.added.len() == after.added.len();
    let sum: f64 = candidates.iter().filter(|c| same_size(c)).map(|c| odds(c).min(50.0).exp()).sum();
    let mut ties = Vec::new();
    for judged in candidates.iter_mut() {
        if !same_size(judged) {
            judged.probability = 0.0;
            continue;
        }
        judged.probability = (1.0 - unlisted) * odds(judged).min(50.0).exp() / sum;
        if judged.added != after.added && !after.added.is_empty() && odds(judged).max(open(judged)) > -TIE {
            let differ = |a: &[&'static str], b: &[&'static str]| -> Vec<&'static str> {
                a.iter().copied().filter(|id| !b.contains(id)).collect()
            };
            let mut tie = differ(&after.added, &judged.added);
            tie.extend(differ(&judged.added, &after.added));
            ties.push(tie);
        }
    }
    ties
}

#[cfg(test)]
pub(super) mod tests;
