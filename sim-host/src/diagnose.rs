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
//! for who runs the table. `passes` goes through these in order; `few` lets it see the beginnings of long recordings first. Out comes a [`Diagnosis`].

mod beside;
mod calibration;
pub(crate) mod change;
mod clock;
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
mod next_test;
mod noise;
mod onward;
mod options;
mod outdone;
mod overstated;
mod passes;
pub(crate) mod planned;
mod ranking;
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
use crate::identify::prepare::{PrepareError, Prepared, prepare};
use crate::identify::quantity::stated_with;
use crate::identify::stated::{expect_near_stated, weigh_determined};
use crate::plant::simulate::SimulateError;
use crate::recording::check::{Finding, check, is_bad_data};
use crate::recording::{self, Experiment, RecordingError, SetUpFinding, doubt, excerpt};
use calibration::CALIBRATION;
use few::conclude_by_few;
use instead::Instead;
pub use options::{Options, Progress};
use passes::{Concluded, End, Reopening};
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

    /// What the model that came out leaves beyond the noise on the runs that judge, as an excess of chi2; what noise leaves at least.
    fn left(&self) -> f64 {
        (self.conclusion.accepted.hold.chi2 - 1.0).max(CALIBRATION.negligible)
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
    let (mut examined, clock) = examine(experiment, options, Reopening::Allowed, None)?;
    if examined.diagnosis.verdict == Verdict::BadData {
        return Ok(examined);
    }
    match instead::instead(experiment, &examined)? {
        Instead::Nothing => {}
        Instead::AsWell(values) => examined.diagnosis.stated_values_instead = values,
        Instead::Better(read, finding) => {
            options.say("another reading of the set-up explains it", 0.0);
            let (mut again, _) = examine(&read, options, Reopening::Never, clock)?;
            let open = |examined: &Examined| examined.conclusion.unlisted || examined.conclusion.more_missing;
            if again.left() > examined.left() || (open(&examined) && open(&again)) {
                examined.diagnosis.seconds += again.diagnosis.seconds;
                return Ok(examined);
            }
            let found: Vec<SetUpFinding> =
                instead::others(experiment, &again.conclusion.accepted.fit).into_iter().chain(finding).collect();
            again.diagnosis.set_up.retain(|said| {
                !found.iter().any(|f| (f.what, &f.parameter, f.channel) == (said.what, &said.parameter, said.channel))
            });
            again.diagnosis.set_up.extend(found);
            again.diagnosis.seconds += examined.diagnosis.seconds;
            examined = again;
        }
    }
    Ok(examined)
}

/// Diagnoses an experiment as its set-up was stated; anew by another clock, where that is found, and says by which.
fn examine(
    experiment: &Experiment,
    options: &Options,
    reopening: Reopening,
    mut clock: Option<SetUpFinding>,
) -> Result<(Examined, Option<SetUpFinding>), DiagnoseError> {
    let begun = std::time::Instant::now();
    loop {
        let read = clock.as_ref().map(|finding| clock::corrected(experiment, finding));
        match once(read.as_ref().unwrap_or(experiment), options, reopening, clock.as_ref())? {
            Once::Examined(mut examined) => {
                examined.diagnosis.seconds = begun.elapsed().as_secs_f64();
                return Ok((*examined, clock));
            }
            Once::Clock(finding) => clock = Some(finding),
        }
        options.say("reading everything by another sampling period", 0.0);
    }
}

/// What comes of going through everything once.
enum Once {
    Examined(Box<Examined>),
    /// The clock runs at another rate: everything is to be read anew.
    Clock(SetUpFinding),
}

/// Goes through everything once, by the clock as stated or by one that was found, and then no other is.
fn once(
    experiment: &Experiment,
    options: &Options,
    reopening: Reopening,
    clock: Option<&SetUpFinding>,
) -> Result<Once, DiagnoseError> {
    options.say("checking the recordings", 0.0);
    let mut set_up = doubt(experiment);
    let findings = check(&set_up.experiment);
    let shortened = excerpt(&set_up.experiment, FITTED);
    let mut whole = prepare(shortened.as_ref().unwrap_or(&set_up.experiment))?;
    if is_bad_data(&findings) {
        expect_near_stated(&mut whole.model);
        return Ok(Once::Examined(Box::new(unfit(whole, &findings, set_up.findings)?)));
    }
    weigh_determined(&mut whole)?;
    expect_near_stated(&mut whole.model);
    let searched = excerpt(&set_up.experiment, SEARCHED).as_ref().map(prepare).transpose()?;
    let mut seen = searched.map_or_else(|| whole.clone(), |seen| Prepared { model: whole.model.clone(), ..seen });
    set_up.findings.extend(noise::rescale(&mut seen, &mut whole)?);
    if clock.is_none() {
        let told = clock::told(experiment, &set_up.experiment);
        for prepared in [&mut whole, &mut seen] {
            clock::doubt(prepared, told);
        }
    }
    let concluded = match conclude_by_few(whole, seen, options, reopening)? {
        End::Concluded(concluded) => *concluded,
        End::Clock(finding) => return Ok(Once::Clock(finding)),
    };
    set_up.findings.extend(clock.cloned());
    Ok(Once::Examined(Box::new(said(experiment, concluded, (set_up.findings, findings), options)?)))
}

/// What is said of what was concluded.
fn said(
    experiment: &Experiment,
    concluded: Concluded,
    (set_up, findings): (Vec<SetUpFinding>, Vec<Finding>),
    options: &Options,
) -> Result<Examined, DiagnoseError> {
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
    diagnosis.set_up.extend(far::far_from_stated(experiment, &whole, &conclusion)?);
    diagnosis.set_up.extend(far::moved_effects(experiment, &conclusion));
    for noise in &conclusion.decision.noise {
        diagnosis.set_up.retain(|f| f.what != noise.what || f.channel != noise.channel);
        diagnosis.set_up.push(noise.clone());
    }
    left::report(experiment, &whole, &conclusion, &mut diagnosis.set_up)?;
    Ok(Examined { diagnosis, prepared: whole, conclusion })
}

/// What is said of recordings that cannot be believed: the stated model's standing and nothing more.
fn unfit(prepared: Prepared, findings: &[Finding], set_up: Vec<SetUpFinding>) -> Result<Examined, DiagnoseError> {
    let Split { weighing, whole, test } = split(prepared, None);
    let baseline = Fit::begin(weighing.model().clone(), weighing.fitted())?;
    let signal_scales = weighing.signal_scales();
    let stated = search::Search { baseline, grown: Vec::new(), signal_scales };
    let decision = decide::decide(&weighing, &stated)?;
    let conclusion = verdict::as_stated(&whole, decision, test)?;
    let location = locate::Location::default();
    let mut diagnosis = result::assemble(&whole, &conclusion, location, result::Open::default(), findings);
    diagnosis.verdict = Verdict::BadData;
    diagnosis.effects.clear();
    diagnosis.candidates.clear();
    diagnosis.set_up = set_up;
    Ok(Examined { diagnosis, prepared: whole, conclusion })
}
