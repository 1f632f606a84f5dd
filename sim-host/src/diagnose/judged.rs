//! A model with its standing, and what was decided of many.

use super::calibration::CALIBRATION;
use super::departure::Departure;
use super::split::Weighing;
use crate::identify::data::Channel;
use crate::identify::fit::Fit;
use crate::identify::judge::Score;
use crate::identify::model::Model;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

/// A model and how it predicts what it was not fitted to.
#[derive(Debug, Clone)]
pub struct ScoredModel {
    /// The fitted model.
    pub fit: Fit,
    /// Its standing on what judges it: the stretches that weigh, and after the verdict the runs held out.
    pub hold: Score,
    /// Effects it adds to the stated model.
    pub added: Vec<&'static str>,
    /// Its share of belief among the candidates.
    pub probability: f64,
    /// The same without the details of its effects' forms, where these were fitted to it last: a name is weighed at the better of both.
    pub(super) plainer: Option<Box<ScoredModel>>,
    /// How far the stated values had to go, and how firmly the data hold them there.
    pub(super) departure: Departure,
}

/// chi2 up to which what is left is coloured as the noise is.
const LITTLE_LEFT: f64 = 1.3;

impl ScoredModel {
    /// Scores a fitted model on the stretches that weigh.
    pub(super) fn of(fit: Fit, weighing: &Weighing) -> Result<Self, SimulateError> {
        let added = fit.model.ids_beside(&weighing.model().ids());
        let departure = Departure::of(weighing.model(), &fit);
        Ok(Self { hold: weighing.score(&fit)?, fit, added, probability: 0.0, plainer: None, departure })
    }

    /// By how much samples that are not independent overstate what a gain of squares is worth: where little is left its colour is the
    /// noise's own; a misfit's colour is no noise.
    pub(super) fn colour_of_noise(&self) -> f64 {
        if self.hold.chi2 < LITTLE_LEFT { self.hold.colour } else { 1.0 }
    }

    /// What speaks against how far the stated values went, as firmly as the data hold them there: beside what a form leaves, a value that is
    /// put back may cost next to nothing on either kind of runs.
    pub(super) fn disbelief(&self) -> f64 {
        let freedom = CALIBRATION.form_freedom;
        let left = (self.fit.squares - self.fit.rows as f64).max(0.0) + freedom * self.colour_of_noise();
        self.departure.least(|squares| 2.0 * freedom * (squares / left).ln_1p())
    }

    /// The model without some of its effects, its other values as they were fitted.
    pub(super) fn model_without(&self, ids: &[&str]) -> Model {
        ids.iter().fold(self.fit.model.clone(), |model, id| model.without(id))
    }

    /// Squares on what fitted it and on what judges it.
    pub(super) fn total(&self) -> f64 {
        self.fit.squares + self.hold.squares()
    }

    /// Mean square and number of residuals on what fitted it and on what judges it.
    pub(super) fn kinds(&self) -> [(f64, f64); 2] {
        let kind = |squares: f64, rows: usize| ((squares / (rows as f64).max(1.0)).max(f64::MIN_POSITIVE), rows as f64);
        [kind(self.fit.squares, self.fit.rows), kind(self.hold.squares(), self.hold.rows)]
    }
}

/// What was decided.
#[derive(Debug, Clone)]
pub struct Decision {
    /// The stated model.
    pub stated: ScoredModel,
    /// The model that is handed on: the accepted one, the stated one where nothing was added, the one that predicts best where
    /// the mismatch is unlisted.
    pub accepted: ScoredModel,
    /// Every model judged, best first.
    pub candidates: Vec<ScoredModel>,
    /// Sets of effects that the data cannot tell apart.
    pub ties: Vec<Vec<&'static str>>,
    /// True where no combination of the library explains the mismatch.
    pub unlisted: bool,
    /// The best the library can do, where that is not enough.
    pub partial: Option<ScoredModel>,
    /// Probability that the mismatch is outside the library.
    pub unlisted_probability: f64,
    /// True where effects are named and leave more than noise and the simplicity of their equations.
    pub more_missing: bool,
    /// Noise that was found larger than stated: what is left of it follows nothing.
    pub noise: Vec<SetUpFinding>,
    /// The accepted effects with those that are not named, because others stand as well in their place.
    pub(super) in_full: Option<ScoredModel>,
    /// True where names were taken back because others stand as well: the runs held out may show that they explain all.
    pub(super) one_of_many: bool,
}

impl Decision {
    /// How far an effect is believed: the probabilities of the candidates that hold it.
    pub(super) fn probability(&self, id: &str) -> f64 {
        self.candidates.iter().filter(|c| c.added.contains(&id)).map(|c| c.probability).sum()
    }

    /// Gives back the names that were taken back because others stand as well.
    pub(super) fn give_one_of_many(&mut self) {
        let sum: f64 = self.candidates.iter().map(|c| c.probability).sum();
        self.candidates.iter_mut().for_each(|c| c.probability /= sum.max(1e-9));
        (self.unlisted, self.unlisted_probability) = (false, 0.0);
    }

    /// Moves belief to what the library does not hold, at least as much as this.
    pub(super) fn take_back(&mut self, belief: f64) {
        let share = (1.0 - belief) / (1.0 - self.unlisted_probability).max(1e-9);
        self.candidates.iter_mut().for_each(|c| c.probability *= share.min(1.0));
        self.unlisted_probability = self.unlisted_probability.max(belief);
    }

    /// Takes all names back, the nearest that the library has staying as `partial`: the mismatch is unlisted, believed at least as much as this.
    pub(super) fn give_up_names(&mut self, belief: f64, partial: Option<ScoredModel>) {
        self.take_back(belief);
        self.unlisted = true;
        self.accepted = self.stated.clone();
        self.partial = partial;
        self.ties.clear();
    }

    /// Moves the belief in names to those of them that are left, where these were weighed.
    pub(super) fn pass_on(&mut self, names: &[&'static str], left: &[&'static str]) {
        if names == left || !self.candidates.iter().any(|c| c.added == left) {
            return;
        }
        let given: f64 = self.candidates.iter().filter(|c| c.added == names).map(|c| c.probability).sum();
        self.candidates.iter_mut().filter(|c| c.added == names).for_each(|c| c.probability = 0.0);
        self.candidates.iter_mut().filter(|c| c.added == left).for_each(|c| c.probability += given);
    }

    /// Moves belief from names that nothing speaks for to the stated model.
    pub(super) fn fall_back(&mut self, belief: f64) {
        self.candidates.iter_mut().for_each(|c| c.probability *= 1.0 - belief);
        let none = self.candidates.iter_mut().filter(|c| c.added.is_empty());
        none.for_each(|c| c.probability = belief);
        self.unlisted_probability *= 1.0 - belief;
    }

    /// Share of the stated model's excess on the validation that the model handed on leaves.
    pub(super) fn left(&self) -> f64 {
        (self.accepted.hold.chi2 - 1.0).max(0.0) / (self.stated.hold.chi2 - 1.0).max(1e-9)
    }
}

/// The channel of which a model explains nearly all that another lacks far beyond the noise, and what it leaves of that.
pub(super) fn explains_a_channel(without: &ScoredModel, with: &ScoredModel) -> Option<(Channel, f64)> {
    let share = |&(channel, before, _): &(Channel, f64, usize)| {
        let left = (with.hold.chi2_of(channel)? - 1.0).max(0.0) / (before - 1.0);
        (before > CALIBRATION.modest && left < 1.0 - CALIBRATION.explained).then_some((channel, left))
    };
    without.hold.channels.iter().filter_map(share).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Parameters that were fitted.
pub(super) fn parameters(judged: &ScoredModel) -> f64 {
    judged.fit.model.free_values() as f64
}
