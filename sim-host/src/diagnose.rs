//! Where a model and recordings part, and what physics was left out.
//!
//! ```no_run
//! use shakedown::diagnose::{Options, Verdict, diagnose_file};
//!
//! let diagnosis = diagnose_file("experiment.toml".as_ref(), &Options::default())?;
//! if diagnosis.verdict == Verdict::Mismatch {
//!     let names: Vec<&str> = diagnosis.effects.iter().map(|effect| effect.id).collect();
//!     println!("{} of {} candidates: {names:?}", names.len(), diagnosis.candidates.len());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Evidence goes forward only. An experiment comes in and its stated set-up is doubted first
//! ([`crate::recording::doubt()`]); `split` cuts it into training, validation and test; `search` fits the stated model to
//! the training and grows it by effects of the library; `decide` weighs every survivor on the validation, names what
//! is accepted, says what it is mistaken for and what no effect explains; `verdict` fits what was selected to all that may be
//! fitted, consumes the test and judges. `locate` looks at the residual without the library; `change` says what it means
//! for who runs the table. `passes` goes through these in order; `few` lets it see the beginnings of long recordings first; `look`
//! does so by one reading of the set-up, and `instead` asks whether another explains the recordings. Out comes a [`Diagnosis`].

mod beside;
mod calibration;
pub(crate) mod change;
mod clock;
mod concluded;
pub(crate) mod decide;
mod departure;
mod far;
mod few;
mod finish;
mod instead;
pub(crate) mod judged;
mod left;
mod leftover;
mod line;
pub(crate) mod locate;
mod look;
mod next_test;
mod noise;
mod onward;
mod options;
mod outdone;
mod overstated;
mod passes;
pub(crate) mod planned;
mod ranking;
mod reach;
mod region;
mod reject_for_curve;
mod rejected;
pub(crate) mod remainder;
mod residual;
pub(crate) mod result;
mod rivals;
pub(crate) mod search;
mod split;
mod standing;
mod structure;
pub(crate) mod term;
pub(crate) mod verdict;

use crate::identify::data::Run;
use crate::identify::fit::Fit;
use crate::identify::prepare::{PrepareError, Prepared};
use crate::identify::quantity::stated_with;
use crate::plant::simulate::SimulateError;
use crate::recording::check::Finding;
use crate::recording::{self, Experiment, RecordingError, SetUpFinding};
use concluded::Concluded;
use instead::{Instead, Other};
use look::{Look, Looked, Pass, examine};
pub use options::{Options, Progress};
use reach::Reach;
pub use result::{Diagnosis, Verdict};
use split::{Split, split};
use std::path::Path;
use verdict::Conclusion;

/// Samples that a search fits at most, and the last fit: of longer recordings the stretches with the most motion.
const SEARCHED: usize = 120_000;
const FITTED: usize = 400_000;

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
    /// What was selected and judged.
    pub conclusion: Conclusion,
}

impl Examined {
    /// The runs that judged: those held out, or those fitted where none was.
    pub fn judging_runs(&self) -> &[Run] {
        &self.conclusion.judging
    }

    /// True where the model that came out is not the stated one refitted.
    pub fn changed(&self) -> bool {
        self.conclusion.accepted.fit.model.ids() != self.conclusion.stated.fit.model.ids()
    }

    /// The stated model with its refitted values and the effects that were found.
    pub fn augmented(&self, stated: &recording::Model) -> recording::Model {
        stated_with(stated, &self.conclusion.accepted.fit)
    }
}

/// Diagnoses the experiment of a TOML file.
pub fn diagnose_file(path: &Path, options: &Options) -> Result<Diagnosis, DiagnoseError> {
    let experiment = Experiment::load(path)?;
    Ok(diagnose(&experiment, options)?.diagnosis)
}

/// Diagnoses an experiment; once more by another reading of its set-up where that explains the recordings, and nothing that was found
/// does.
pub fn diagnose(experiment: &Experiment, options: &Options) -> Result<Examined, DiagnoseError> {
    let begun = std::time::Instant::now();
    let mut examined = match examine(experiment, options, Look::First, None)? {
        Looked::Unfit(prepared, findings, set_up) => unfit(*prepared, &findings, set_up)?,
        Looked::Concluded(first) => said_or_read_otherwise(experiment, *first, options)?,
        Looked::Otherwise(first, other) => match by_another_reading(experiment, &first, other, options)? {
            Some(examined) => examined,
            None => match examine(experiment, options, Look::All, first.clock)? {
                Looked::Unfit(prepared, findings, set_up) => unfit(*prepared, &findings, set_up)?,
                Looked::Concluded(all) | Looked::Otherwise(all, _) => {
                    said_or_read_otherwise(experiment, *all, options)?
                }
            },
        },
    };
    examined.diagnosis.seconds = begun.elapsed().as_secs_f64();
    Ok(examined)
}

/// Says what was concluded, or what is by another reading of the set-up.
fn said_or_read_otherwise(experiment: &Experiment, first: Pass, options: &Options) -> Result<Examined, DiagnoseError> {
    options.say("asking whether the set-up was stated wrong", 0.95);
    match instead::instead(experiment, &first.concluded)? {
        Instead::Nothing => said(first, options),
        Instead::AsWell(values) => {
            let mut examined = said(first, options)?;
            examined.diagnosis.stated_values_instead = values;
            Ok(examined)
        }
        Instead::Better(other) => match by_another_reading(experiment, &first, other, options)? {
            Some(examined) => Ok(examined),
            None => said(first, options),
        },
    }
}

/// The diagnosis by another reading of the set-up; none where it leaves more than was left before, or as much unnamed.
fn by_another_reading(
    experiment: &Experiment,
    first: &Pass,
    other: Other,
    options: &Options,
) -> Result<Option<Examined>, DiagnoseError> {
    options.say("another reading of the set-up explains it", 0.0);
    let Looked::Concluded(again) = examine(&other.experiment, options, Look::Again, first.clock.clone())? else {
        return Ok(None);
    };
    let (before, after) = (&first.concluded.conclusion, &again.concluded.conclusion);
    let open = |conclusion: &Conclusion| conclusion.unlisted || conclusion.more_missing;
    if after.left_beyond_noise() > before.left_beyond_noise() || (open(before) && open(after)) {
        return Ok(None);
    }
    let found: Vec<SetUpFinding> =
        instead::others(experiment, &after.accepted.fit).into_iter().chain(other.finding).collect();
    let mut examined = said(*again, options)?;
    examined.diagnosis.set_up.retain(|said| {
        !found.iter().any(|f| (f.what, &f.parameter, f.channel) == (said.what, &said.parameter, said.channel))
    });
    examined.diagnosis.set_up.extend(found);
    Ok(Some(examined))
}

/// What is said of what was concluded.
fn said(pass: Pass, options: &Options) -> Result<Examined, DiagnoseError> {
    let Pass { experiment, concluded, set_up, findings, .. } = pass;
    let Concluded { whole, conclusion, modelled, held_out_shared } = concluded;
    options.say("looking for the test that would settle what is open", 0.96);
    let (next_test, no_test) = next_test::next_test(&whole, &conclusion, modelled.as_ref())?.parts();
    let location = locate::locate(&whole, &conclusion)?;
    let change = change::change(&whole, &conclusion)?;
    let modelled = modelled.filter(|_| conclusion.unlisted || conclusion.more_missing);
    let term = modelled.as_ref().and_then(|m| term::report::reported(m.term.as_ref()?, &conclusion));
    let remainder = modelled.and_then(|m| m.remainder);
    let open = result::Open { remainder, term, next_test, no_test, change, held_out_shared };
    let mut diagnosis = result::assemble(&whole, &conclusion, location, open, &findings);
    if let Some(term) = diagnosis.term.as_ref().filter(|_| conclusion.unlisted) {
        diagnosis.location.block = Some(term.place);
    }
    diagnosis.set_up = set_up;
    diagnosis.set_up.extend(far::far_from_stated(&experiment, &whole, &conclusion)?);
    diagnosis.set_up.extend(far::moved_effects(&experiment, &conclusion));
    for noise in &conclusion.decision.noise {
        diagnosis.set_up.retain(|f| f.what != noise.what || f.channel != noise.channel);
        diagnosis.set_up.push(noise.clone());
    }
    left::report(&experiment, &whole, &conclusion, &mut diagnosis.set_up)?;
    Ok(Examined { diagnosis, prepared: whole, conclusion })
}

/// What is said of recordings that cannot be believed: the stated model's standing and nothing more.
fn unfit(prepared: Prepared, findings: &[Finding], set_up: Vec<SetUpFinding>) -> Result<Examined, DiagnoseError> {
    let Split { weighing, whole, test } = split(prepared, None);
    let baseline = Fit::begin(weighing.model().clone(), weighing.fitted())?;
    let signal_scales = weighing.signal_scales();
    let stated = search::Search { baseline, grown: Vec::new(), signal_scales };
    let decision = decide::decide(&weighing, &stated, Reach::Fitted)?;
    let conclusion = verdict::as_stated(&whole, decision, test)?;
    let location = locate::Location::default();
    let mut diagnosis = result::assemble(&whole, &conclusion, location, result::Open::default(), findings);
    diagnosis.verdict = Verdict::BadData;
    diagnosis.effects.clear();
    diagnosis.candidates.clear();
    diagnosis.set_up = set_up;
    Ok(Examined { diagnosis, prepared: whole, conclusion })
}
