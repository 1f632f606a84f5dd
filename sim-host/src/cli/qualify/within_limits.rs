//! Limits that a motion for a standard keeps, as options.

use super::super::attained::Sought;
use super::super::described::Found;
use super::super::failure::within;
use super::super::required::Demanded;
use super::super::written::{Shape, provenance};
use super::super::{Failure, described};
use super::Args;
use crate::motion::fit::Limits;
use std::path::PathBuf;

/// The table's limits, as options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(super) struct Kept {
    /// The motion keeps this speed, m/s [default: the table's].
    #[arg(long, value_name = "M/S", requires = "synthesise", conflicts_with = "record")]
    velocity: Option<f64>,
    /// The motion keeps this displacement to either side, m [default: the table's, else 0.12].
    #[arg(long, value_name = "M", requires = "synthesise", conflicts_with = "record")]
    stroke: Option<f64>,
    /// The motion keeps this acceleration, m/s2.
    #[arg(long, value_name = "M/S2", requires = "synthesise", conflicts_with = "record")]
    acceleration: Option<f64>,
    /// Load at which the flow stalls, as table acceleration, m/s2: the motion keeps v^2 / V^2 + |a| / stall below 1.
    #[arg(long, value_name = "M/S2", requires = "synthesise", conflicts_with = "record")]
    stall: Option<f64>,
    /// The table's file, which states what the options do not.
    #[arg(long, value_name = "TABLE.toml", requires = "synthesise", conflicts_with = "record")]
    table: Option<PathBuf>,
    /// The motion begins from this record, whose character it keeps where it can.
    #[arg(long, value_name = "FILE", requires = "synthesise", conflicts_with = "record")]
    from: Option<PathBuf>,
    #[command(flatten)]
    pub(super) shape: Shape,
}

impl Kept {
    /// True where the motion is to keep limits.
    pub(super) fn asked(&self) -> bool {
        let numbers = [self.velocity, self.stroke, self.acceleration, self.stall];
        self.table.is_some() || self.from.is_some() || numbers.iter().any(Option::is_some)
    }

    /// The limits, and the table that states them.
    fn limits(&self) -> Result<(Limits, Found), Failure> {
        let described = described::found(self.table.as_deref())?;
        let twin = crate::cli::table(described.path.as_deref())?;
        let velocity = crate::cli::velocity_limit(self.velocity, &twin, described.path.as_deref())?;
        let stroke = self.stroke.or(described.table.stroke).unwrap_or(described::STROKE);
        within("--velocity", velocity, 1e-3, 20.0, "m/s")?;
        within("--stroke", stroke, 1e-4, 5.0, "m")?;
        within("--acceleration", self.acceleration.unwrap_or(1.0), 1e-2, 1e3, "m/s2")?;
        within("--stall", self.stall.unwrap_or(1.0), 1e-1, 1e5, "m/s2")?;
        let limits = Limits {
            acceleration: self.acceleration.or(described.table.acceleration),
            jerk: described.table.jerk,
            stall: self.stall.or_else(|| twin.stall()),
            ..Limits::table(velocity, stroke)
        };
        Ok((limits, described))
    }
}

/// Looks for the motion, writes it, or says why there is none.
pub(super) fn run(args: &Args, demanded: Demanded) -> Result<(), Failure> {
    let (limits, described) = args.within.limits()?;
    let plan = args.synthesise.as_deref().map(|path| {
        let mut shape = args.within.shape.clone();
        shape.described(path, &described.table);
        let plan = shape.plan("--synthesise", path, limits.stroke.unwrap_or(described::STROKE));
        plan.map(|plan| (path, plan))
    });
    let from = args.within.from.as_deref();
    let made = format!("generated for {}", demanded.standard.title);
    let mut facts = provenance::source(from, made, args.seed)?;
    facts.extend(args.demand.facts(&demanded)?);
    let sought = Sought {
        command: "qualify",
        record: from.map(|path| args.read(path)).transpose()?.map(|record| record.motion()),
        demanded,
        limits,
        seed: args.seed.unwrap_or(1),
        out: plan.transpose()?,
        facts,
        inputs: described.path.iter().chain(&args.within.from).chain(&args.demand.rrs).cloned().collect(),
        outputs: &args.outputs,
    };
    sought.seek()
}
