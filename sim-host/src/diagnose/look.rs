//! One look at an experiment: its set-up doubted, its recordings checked and prepared, and what is concluded of them, before anything is
//! said of it.

use super::concluded::Concluded;
use super::few::conclude_by_few;
use super::instead::{self, Instead, Other};
use super::options::Options;
use super::passes::{End, conclude};
use super::reach::Reach;
use super::{DiagnoseError, FITTED, SEARCHED, clock, noise};
use crate::identify::prepare::{Prepared, prepare};
use crate::identify::stated::{expect_near_stated, weigh_determined};
use crate::plant::simulate::SimulateError;
use crate::recording::check::{Finding, check, is_bad_data};
use crate::recording::{Experiment, SetUpFinding, doubt, excerpt};

/// How an experiment is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// As it was stated; by the beginnings of long runs first.
    First,
    /// As it was stated, everything of it: the beginnings do not settle it.
    All,
    /// By another reading of the set-up, which explains the recordings at once or is not what is wrong.
    Again,
}

/// What comes of looking at an experiment.
pub(super) enum Looked {
    /// The recordings cannot be believed, for what the checks found and what was doubted of the set-up.
    Unfit(Box<Prepared>, Vec<Finding>, Vec<SetUpFinding>),
    Concluded(Box<Pass>),
    /// The beginnings do not settle it, and another reading of the set-up explains what nothing does that was found there.
    Otherwise(Box<Pass>, Other),
}

/// What comes of going through everything once.
enum Once {
    Looked(Looked),
    /// The clock runs at another rate: everything is to be read anew.
    Clock(SetUpFinding),
}

/// One pass through the recordings, before anything is said of it.
pub(super) struct Pass {
    /// By the clock that was found.
    pub(super) experiment: Experiment,
    pub(super) concluded: Concluded,
    pub(super) set_up: Vec<SetUpFinding>,
    pub(super) findings: Vec<Finding>,
    pub(super) clock: Option<SetUpFinding>,
}

/// Looks at an experiment; anew by another clock, where that is found, and says by which.
pub(super) fn examine(
    experiment: &Experiment,
    options: &Options,
    look: Look,
    mut clock: Option<SetUpFinding>,
) -> Result<Looked, DiagnoseError> {
    loop {
        let read = clock.as_ref().map_or_else(|| experiment.clone(), |finding| clock::corrected(experiment, finding));
        match once(read, experiment, options, look, clock.as_ref())? {
            Once::Clock(finding) => clock = Some(finding),
            Once::Looked(looked) => return Ok(looked),
        }
        options.say("reading everything by another sampling period", 0.0);
    }
}

/// Goes through everything once, by the clock as stated or by one that was found, and then no other is. Another reading is of the experiment
/// as `stated`: whoever looks at it again corrects its clock.
fn once(
    experiment: Experiment,
    stated: &Experiment,
    options: &Options,
    look: Look,
    clock: Option<&SetUpFinding>,
) -> Result<Once, DiagnoseError> {
    options.say("checking the recordings", 0.0);
    let mut set_up = doubt(&experiment);
    let findings = check(&set_up.experiment);
    let shortened = excerpt(&set_up.experiment, FITTED);
    let mut whole = prepare(shortened.as_ref().unwrap_or(&set_up.experiment))?;
    if is_bad_data(&findings) {
        expect_near_stated(&mut whole.model);
        return Ok(Once::Looked(Looked::Unfit(Box::new(whole), findings, set_up.findings)));
    }
    weigh_determined(&mut whole)?;
    expect_near_stated(&mut whole.model);
    let searched = excerpt(&set_up.experiment, SEARCHED).as_ref().map(prepare).transpose()?;
    let mut seen = searched.map_or_else(|| whole.clone(), |seen| Prepared { model: whole.model.clone(), ..seen });
    set_up.findings.extend(noise::rescale(&mut seen, &mut whole)?);
    if clock.is_none() {
        let told = clock::told(&experiment, &set_up.experiment);
        for prepared in [&mut whole, &mut seen] {
            clock::doubt(prepared, told);
        }
    }
    set_up.findings.extend(clock.cloned());
    let pass = |concluded: Concluded, set_up: Vec<SetUpFinding>| {
        Box::new(Pass { concluded, set_up, findings, clock: clock.cloned(), experiment: experiment.clone() })
    };
    Ok(match concluded_as(look, (whole, seen), stated, options)? {
        End::Concluded(concluded) => Once::Looked(Looked::Concluded(pass(*concluded, set_up.findings))),
        End::Otherwise(concluded, other) => Once::Looked(Looked::Otherwise(pass(*concluded, set_up.findings), other)),
        End::Clock(finding) => Once::Clock(finding),
    })
}

/// Concludes from what was prepared, all of it and what a search sees.
fn concluded_as(
    look: Look,
    (whole, seen): (Prepared, Prepared),
    stated: &Experiment,
    options: &Options,
) -> Result<End, SimulateError> {
    // What was weighed no further may yet be named where a reading takes as many values from the data as names do.
    let explains = |concluded: &Concluded| match instead::instead(stated, concluded)? {
        Instead::Better(other) => Ok(Some(other).filter(|other| other.finding.is_some())),
        Instead::Nothing | Instead::AsWell(_) => Ok(None),
    };
    match look {
        Look::First => conclude_by_few(whole, seen, options, Reach::Opened, explains),
        Look::All => conclude(whole, seen, options, Reach::Opened),
        Look::Again => conclude_by_few(whole, seen, options, Reach::Fitted, |_| Ok(None)),
    }
}
