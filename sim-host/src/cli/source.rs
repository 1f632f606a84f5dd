//! The ground motion of a command: a file, or a generated near-field motion.

use super::Failure;
use shakedown::motion::read::Options;
use shakedown::motion::{Record, generate, read};
use std::path::PathBuf;

/// Which record, and what its file leaves out.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Source {
    /// Ground-motion record: PEER, CSMIP, COSMOS, GeoNet, K-NET, or columns with --dt and --unit; without one, a generated
    /// near-field motion.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Sampling interval, s, where the file does not state it.
    #[arg(long, value_name = "S")]
    pub(crate) dt: Option<f64>,
    /// Unit of the acceleration, where the file does not state it: m/s2, cm/s2, mm/s2, gal or g.
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<String>,
    /// Component, where the file has several: its number or a part of its name.
    #[arg(long, value_name = "NAME")]
    pub(crate) channel: Option<String>,
    /// Seed of the generated motion.
    #[arg(long, value_name = "N", conflicts_with = "record")]
    pub(crate) seed: Option<u64>,
}

impl Source {
    /// Reads or generates the record.
    pub(crate) fn load(&self) -> Result<Record, Failure> {
        let Some(path) = &self.record else {
            for (option, given) in
                [("--dt", self.dt.is_some()), ("--unit", self.unit.is_some()), ("--channel", self.channel.is_some())]
            {
                if given {
                    return Err(Failure::Input(format!("{option} describes a file: give it with --record FILE")));
                }
            }
            return generate::NEAR_FIELD_STRONG
                .generate(self.seed.unwrap_or(1))
                .map_err(|e| Failure::Work(format!("generated motion: {e}")));
        };
        let unit = self.unit.as_deref().map(str::parse).transpose();
        let options = Options {
            dt: self.dt,
            unit: unit.map_err(|e| Failure::Input(format!("--unit: {e}")))?,
            channel: self.channel.as_deref().map_or_else(Default::default, |name| {
                let Ok(channel) = name.parse();
                channel
            }),
        };
        read::record(path, &options).map_err(|e| Failure::Input(e.to_string()))
    }

    /// The files read.
    pub(crate) fn inputs(&self) -> Vec<PathBuf> {
        self.record.iter().cloned().collect()
    }
}
