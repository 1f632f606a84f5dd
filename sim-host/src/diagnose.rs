//! Where a model and recordings part, and what physics was left out.
//!
//! What flows: an experiment comes in; [`search`] fits the stated model and grows it by effects of the library;
//! [`crate::identify::judge`] scores every survivor on the runs held back; [`decide`] names what stands, says what it is mistaken for and
//! what no effect explains; [`locate`] looks at the residual without the library; [`change`] says what it means for who
//! runs the table. Out comes a [`Diagnosis`].

pub mod change;
pub mod decide;
mod finish;
mod leftover;
pub mod locate;
mod next_test;
mod noise;
mod outdone;
mod ranking;
mod rejected;
pub mod remainder;
pub mod result;
mod rivals;
pub mod search;
mod shared;
mod structure;

use crate::identify::data::Run;
use crate::identify::fit::Fit;
use crate::identify::prepare::{PrepareError, Prepared, prepare};
use crate::identify::quantity::{quantities, stated_with};
use crate::identify::stated::expect_near_stated;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulateError;
use crate::recording::check::{Finding, check, is_bad_data};
use crate::recording::{self, Experiment, RecordingError, SetUpFinding, doubt};
pub use result::Diagnosis;
use std::path::Path;

/// Distance of a fitted value from the stated one, as a logarithm, from which the model is said to be of another table.
const FAR: f64 = 0.4;

/// Is told what is being done, with a share of the whole between 0 and 1.
pub type Progress<'a> = &'a (dyn Fn(&str, f64) + Sync);

/// What a diagnosis may be told.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// Told what is being done, with a share of the whole between 0 and 1.
    pub progress: Option<Progress<'a>>,
}

impl std::fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options").field("progress", &self.progress.is_some()).finish()
    }
}

impl Options<'_> {
    fn say(&self, what: &str, share: f64) {
        if let Some(progress) = self.progress {
            progress(what, share);
        }
    }
}

/// Why there is no diagnosis.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// The experiment or a recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The experiment cannot be fitted.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A model cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
}

/// A diagnosis with everything that was weighed for it, for reports.
#[derive(Debug, Clone)]
pub struct Examined {
    /// What came out.
    pub diagnosis: Diagnosis,
    /// Runs and stated model as they were fitted.
    pub prepared: Prepared,
    /// What was judged and decided.
    pub decision: decide::Decision,
}

impl Examined {
    /// The runs that judged: those held back, or those fitted where none was.
    pub fn judging_runs(&self) -> &[Run] {
        self.prepared.judging()
    }

    /// True where the model that came out is not the stated one refitted.
    pub fn changed(&self) -> bool {
        self.decision.after.fit.model.ids() != self.decision.before.fit.model.ids()
    }

    /// The stated model with its refitted values and the effects that were found.
    pub fn augmented(&self, stated: &recording::Model) -> recording::Model {
        stated_with(stated, &self.decision.after.fit)
    }
}

/// Diagnoses the experiment of a TOML file.
pub fn diagnose_file(path: &Path, options: &Options) -> Result<Diagnosis, DiagnoseError> {
    let experiment = Experiment::load(path)?;
    Ok(diagnose(&experiment, options)?.diagnosis)
}

/// Diagnoses an experiment.
pub fn diagnose(experiment: &Experiment, options: &Options) -> Result<Examined, DiagnoseError> {
    let begun = std::time::Instant::now();
    options.say("checking the recordings", 0.0);
    let mut set_up = doubt(experiment);
    let findings = check(&set_up.experiment);
    let mut prepared = prepare(&set_up.experiment)?;
    expect_near_stated(&mut prepared.model);
    if is_bad_data(&findings) {
        return unfit(prepared, &findings, begun);
    }
    set_up.findings.extend(noise::rescale(&mut prepared)?);
    let Answer { prepared, search, mut decision, held_out_shared } = answer(prepared, options)?;
    let curve = outdone::outdone(&prepared, &mut decision)?;
    let location = locate::locate(&prepared, &search.baseline, &decision)?;
    let modelled = if curve.is_some() {
        curve
    } else if decision.unlisted {
        options.say("modelling what the library does not hold", 0.93);
        remainder::remainder(&prepared, &decision.before, decision.partial.as_ref().unwrap_or(&decision.before))?
    } else {
        None
    };
    if let Some(modelled) = modelled.as_ref().filter(|m| decision.unlisted && m.names_needed) {
        decision.name_beside_more(&modelled.remainder.beside);
    }
    options.say("looking for the test that would settle what is open", 0.96);
    let next_test = next_test::next_test(&prepared, &decision, modelled.as_ref())?;
    let remainder = modelled.map(|modelled| {
        decision.after = modelled.judged;
        modelled.remainder
    });
    // Without a curve the nearest that the library has foresees better than the stated model, whatever its name is worth.
    if remainder.is_none()
        && let Some(partial) = decision.partial.clone().filter(|p| p.hold.chi2 < decision.before.hold.chi2)
    {
        decision.after = partial;
    }
    let change = change::change(&prepared, &decision)?;
    let seconds = begun.elapsed().as_secs_f64();
    let open = result::Open { remainder, next_test, change, held_out_shared, seconds };
    let mut diagnosis = result::assemble(&prepared, &decision, location, open, &findings);
    diagnosis.set_up = set_up.findings;
    diagnosis.set_up.extend(far_from_stated(experiment, &decision));
    diagnosis.set_up.extend(decision.noise.clone());
    Ok(Examined { diagnosis, prepared, decision })
}

/// Stated values of the model that the data place far away, by name.
fn far_from_stated(experiment: &Experiment, decision: &decide::Decision) -> Vec<SetUpFinding> {
    let fitted = quantities(&decision.after.fit);
    let kind = decision.after.fit.model.kind;
    // Masses and dashpots may be stated in any way: residuals depend on them almost linearly.
    if kind != Kind::Servo {
        return Vec::new();
    }
    let far = |(name, stated): (&'static str, f64)| {
        let unit = kind.parameters().iter().find(|p| p.key == name)?.unit;
        let quantity = fitted.get(name).filter(|_| experiment.model.fits(name))?;
        let away = (quantity.value / stated).abs().ln().abs();
        (away.is_nan() || away >= FAR)
            .then(|| SetUpFinding::model_value(name, stated, quantity.value, quantity.std, unit))
    };
    experiment.model.baseline.parameters().into_iter().filter_map(far).collect()
}

/// What was found, and on which runs.
struct Answer {
    prepared: Prepared,
    search: search::Search,
    decision: decide::Decision,
    held_out_shared: bool,
}

/// Searches and decides; once more with half of the runs held back where they alone show it.
fn answer(prepared: Prepared, options: &Options) -> Result<Answer, SimulateError> {
    let search = search::search(&prepared, options)?;
    options.say("judging on the runs held back", 0.9);
    let decision = decide::decide(&prepared, &search)?;
    if !prepared.holdout.is_empty() && shared::unseen(&decision) {
        options.say("the runs fitted do not show it: trying with half of those held back", 0.9);
        let prepared = shared::shared(&prepared);
        let search = search::search(&prepared, options)?;
        let other = decide::decide(&prepared, &search)?;
        if shared::better(&other, &decision) {
            let decision = other;
            return Ok(Answer { prepared, search, decision, held_out_shared: true });
        }
    }
    Ok(Answer { prepared, search, decision, held_out_shared: false })
}

/// What is said of recordings that cannot be believed: the stated model's standing and nothing more.
fn unfit(prepared: Prepared, findings: &[Finding], begun: std::time::Instant) -> Result<Examined, DiagnoseError> {
    let stated = Fit::begin(prepared.model.clone(), &prepared.fit)?;
    let decision = decide::decide(
        &prepared,
        &search::Search { baseline: stated, grown: Vec::new(), yardsticks: prepared.yardsticks },
    )?;
    let location = locate::Location::default();
    let open = result::Open { seconds: begun.elapsed().as_secs_f64(), ..result::Open::default() };
    let mut diagnosis = result::assemble(&prepared, &decision, location, open, findings);
    diagnosis.verdict = result::Verdict::BadData;
    diagnosis.effects.clear();
    diagnosis.candidates.clear();
    Ok(Examined { diagnosis, prepared, decision })
}
