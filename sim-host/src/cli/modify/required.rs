//! A record fitted to a required spectrum and to the table's limits, or the frequencies that no motion within them reaches.

use super::super::attained::Sought;
use super::super::failure::first_given;
use super::super::required::Demanded;
use super::super::source::plausible;
use super::super::written::provenance;
use super::{Args, Failure, Objective};

/// Fits, writes and says what came out.
pub(super) fn run(args: &Args, demanded: Demanded) -> Result<(), Failure> {
    args.only_required()?;
    let limits = args.limits()?;
    let plan = args.plan()?;
    let (record, mut inputs) = args.read()?;
    let motion = args.condition(&record)?;
    plausible(&args.record.display().to_string(), &motion);
    let made = format!("generated {}", record.name);
    let mut facts = provenance::source(inputs.first().map(std::path::PathBuf::as_path), made, args.seed)?;
    facts.push(("conditioning".to_owned(), args.conditioning()));
    facts.extend(args.demand.facts(&demanded)?);
    inputs.extend(args.table.iter().chain(&args.demand.rrs).cloned());
    let sought = Sought {
        command: "modify",
        record: Some(motion),
        demanded,
        limits,
        seed: args.seed.unwrap_or(1),
        out: args.out.as_deref().zip(plan),
        facts,
        inputs,
        outputs: &args.outputs,
    };
    sought.seek()
}

impl Args {
    /// Refuses options of other objectives.
    fn only_required(&self) -> Result<(), Failure> {
        let refuse = |what: String| Err(Failure::Input(format!("modify: {what}")));
        if self.objective != Objective::Spectrum {
            return refuse(
                "--standard states the spectrum that --objective spectrum is for: add that, or leave it out".into(),
            );
        }
        let others = [
            ("--band", self.band.is_some()),
            ("--damping", self.damping.is_some()),
            ("--tolerance", self.tolerance.is_some()),
            ("--target", self.target.is_some()),
        ];
        match first_given(others) {
            Some(option) => refuse(format!(
                "{option} is for the record's own spectrum, and --standard asks for another: leave one of them out"
            )),
            None => Ok(()),
        }
    }
}
