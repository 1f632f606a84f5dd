//! Where fits of one more effect start, and which of them deserve the work.

use super::ringing::{dominant_frequencies, structure_at};
use crate::identify::data::Run;
use crate::identify::fit::Fit;
use crate::identify::fit::secant::Base;
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::plant::effects::{Parameter, Role, SignalScale};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Starts of each effect alone that are looked at with all their derivatives.
const STARTS: usize = 2;
/// Starts of a further effect, of all effects, that are.
const LOOKS: usize = 36;
/// Starts that are taken further than one look.
const PROMISING: usize = 18;

/// Every effect that a parent has not, at each of its starting values; no set of effects from parents of different effects.
pub(in crate::diagnose) fn candidate_starts<'a>(
    parents: &'a [Fit],
    singles: &[Fit],
    signal_scales: &SignalScales,
    runs: &[Run],
) -> Result<Vec<CandidateStart<'a>>, SimulateError> {
    let mut candidate_starts = Vec::new();
    let mut sets: Vec<(Vec<&'static str>, Vec<&'static str>)> = Vec::new();
    for parent in parents {
        let of = parent.model.ids();
        let dominant = dominant_frequencies(parent, runs)?;
        for entry in parent.model.candidates() {
            let mut set = of.clone();
            set.push(entry.id);
            set.sort_unstable();
            if sets.iter().any(|(known, others)| *known == set && *others != of) {
                continue;
            }
            sets.push((set, of.clone()));
            // Alone the effect was fitted already: its values there are one start, the library's the others.
            let alone = singles.iter().find_map(|fit| fit.model.effects.iter().find(|p| p.entry.id == entry.id));
            let library = (0..).map_while(|i| ModelEffect::start(entry, i, signal_scales));
            // A resonance is found from near its frequency only, a gap from near its width, and a limit from where it binds.
            let places = [SignalScale::CommandRate, SignalScale::Displacement];
            let ladder = |p: &Parameter| p.starts.len() > 1 && ["Hz", "m"].contains(&p.unit);
            let near = |p: &Parameter| ladder(p) || places.contains(&p.signal_scale);
            let far = entry.parameters.iter().any(near);
            let most = if alone.is_some() && !far { 1 } else { usize::MAX };
            let first = ModelEffect::start(entry, 0, signal_scales);
            let rings = dominant.iter().filter_map(|&frequency| structure_at(first.clone()?, frequency));
            let starts = alone.cloned().into_iter().chain(library.take(most)).chain(rings);
            candidate_starts.extend(starts.map(|placed| CandidateStart { parent, placed }));
        }
    }
    Ok(candidate_starts)
}

/// A start: which parent, with which effect where.
pub(in crate::diagnose) struct CandidateStart<'a> {
    pub(super) parent: &'a Fit,
    /// The effect where it starts.
    pub(in crate::diagnose) placed: ModelEffect,
}

impl CandidateStart<'_> {
    /// The model to start from.
    pub(in crate::diagnose) fn model(&self) -> Model {
        self.parent.model.with(self.placed.clone())
    }

    /// Squares that the start promises beside its parent, from which `base` is; none where a chord says nothing of it, as of a hum, whose
    /// size each run has for itself and begins from none.
    pub(in crate::diagnose) fn look(&self, base: &Base, runs: &[Run]) -> Result<Option<f64>, SimulateError> {
        let each_run_for_itself = self.placed.entry.parameters.iter().any(|p| p.role == Role::PerRun);
        if each_run_for_itself || !self.placed.entry.frees.is_empty() {
            return Ok(None);
        }
        base.promised(&self.model(), self.signed(), runs)
    }

    /// True where less than none of the effect makes sense.
    fn signed(&self) -> bool {
        self.placed.values.iter().any(|v| v.free && !v.positive)
    }
}

/// The starts that deserve a look with all their derivatives: of a single effect the best of each, of further ones the best
/// of all; and those of which a chord says nothing.
pub(super) fn screen_by_secant<'a>(
    candidate_starts: Vec<CandidateStart<'a>>,
    parents: &'a [Fit],
    runs: &[Run],
    single: bool,
) -> Result<Vec<CandidateStart<'a>>, SimulateError> {
    let bases = parents.par_iter().map(|parent| Base::of(parent, runs)).collect::<Result<Vec<_>, _>>()?;
    let look = |candidate: &CandidateStart| -> Result<Option<f64>, SimulateError> {
        let base =
            parents.iter().position(|parent| std::ptr::eq(parent, candidate.parent)).and_then(|i| bases[i].as_ref());
        base.map_or(Ok(None), |base| candidate.look(base, runs))
    };
    let looks = candidate_starts.par_iter().map(look).collect::<Result<Vec<_>, _>>()?;
    let mut ranked: Vec<_> = candidate_starts.into_iter().zip(looks).collect();
    ranked.sort_by(|(_, a), (_, b)| a.unwrap_or(f64::NEG_INFINITY).total_cmp(&b.unwrap_or(f64::NEG_INFINITY)));
    let mut seen: Vec<(*const Fit, &str)> = Vec::new();
    let mut rank = 0;
    ranked.retain(|(candidate, look)| {
        if look.is_none() {
            return true;
        }
        rank += 1;
        let key = (std::ptr::from_ref(candidate.parent), candidate.placed.entry.id);
        let tried = seen.iter().filter(|&&other| other == key).count();
        seen.push(key);
        if single { tried < STARTS } else { rank <= LOOKS }
    });
    Ok(ranked.into_iter().map(|(candidate, _)| candidate).collect())
}

/// The starts that promise most; of a single effect, on each fit of the stated model, at least its best start, for what
/// a linear step promises from far away is little.
pub(super) fn screen_by_fit(fits: Vec<Fit>, candidate_starts: &[CandidateStart], single: bool) -> Vec<Fit> {
    let finite = |fit: &Fit| Some(fit.promised()).filter(|x| x.is_finite()).unwrap_or(f64::INFINITY);
    let mut ranked: Vec<(&CandidateStart, Fit)> = candidate_starts.iter().zip(fits).collect();
    ranked.sort_by(|(_, a), (_, b)| finite(a).total_cmp(&finite(b)));
    let mut seen: Vec<(*const Fit, &str)> = Vec::new();
    let mut rank = 0;
    ranked.retain(|(candidate, _)| {
        rank += 1;
        let key = (std::ptr::from_ref(candidate.parent), candidate.placed.entry.id);
        let best = single && !seen.contains(&key);
        seen.push(key);
        best || rank <= PROMISING
    });
    ranked.into_iter().map(|(_, fit)| fit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model, recorded};
    use crate::plant::effects::entry;

    /// Begun from no size, a hum changes nothing along a chord: ranked by it, it would come last however loud it is.
    #[test]
    fn a_hum_is_not_ranked_by_a_chord() {
        let runs = vec![recorded(&model(TRUTH), 1)];
        let fit = Fit::begin(model(TRUTH), &runs).unwrap();
        let base = Base::of(&fit, &runs).unwrap().unwrap();
        let look = |id| {
            let placed = ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
            CandidateStart { parent: &fit, placed }.look(&base, &runs).unwrap()
        };
        assert_eq!(look("mains_hum"), None);
        assert!(look("viscous_friction").is_some());
    }
}
