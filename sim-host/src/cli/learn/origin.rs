//! Where a learnt drive comes from, and whether one that was learnt before is still true.

use super::super::Failure;
use super::super::described::Found;
use super::super::written::provenance;
use super::Args;
use crate::closed_loop::trial::Setup;
use crate::motion::Record;
use crate::motion::drive::{Drive, Quantity};
use std::path::Path;

/// What a learnt drive is true for: of another motion, table or controller it is stale.
const TRUE_FOR: [&str; 4] = ["source_sha256", "seed", "model_sha256", "controller"];

/// Where a learnt drive comes from, as far as it is known before the work.
pub(super) fn origin(
    args: &Args,
    record: &Record,
    described: &Found,
    controller: &str,
    setup: &Setup,
) -> Result<Vec<(String, String)>, Failure> {
    let made = format!("generated {}", record.name);
    let mut facts = provenance::source(args.source.record.as_deref(), made, args.source.seed)?;
    facts.extend(provenance::learnt_on(described.path.as_deref(), controller, setup.rate())?);
    let mut put = |key: &str, value: String| facts.push((key.to_owned(), value));
    put("fit", args.fit.clone());
    put(
        "conditioning",
        "table1: 3 s of rest before and 5 s after, 4.7 Hz 6th-order low-pass, 0.05 Hz high-pass".into(),
    );
    Ok(facts)
}

/// A drive that was learnt before; refused where something that it is true for has changed since.
pub(super) fn begin(path: &Path, origin: &[(String, String)], setup: &Setup) -> Result<Drive, Failure> {
    let refuse = |why: String| Failure::Input(format!("{}: {why}", path.display()));
    let drive = Drive::read(path).map_err(|e| Failure::Input(e.to_string()))?;
    let drive = drive.ok_or_else(|| refuse("is no drive: name one that `learn --out` wrote".into()))?;
    if drive.quantity != Quantity::Displacement || (1.0 / drive.dt / setup.rate() - 1.0).abs() > 1e-6 {
        return Err(refuse(format!("is no displacement at {} Hz: learn again without --from", setup.rate())));
    }
    for key in TRUE_FOR {
        let now = origin.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
        let then = drive.fact(key);
        if now != then {
            let short = |value: Option<&str>| value.map_or("none".to_owned(), |v| v.chars().take(20).collect());
            return Err(refuse(format!(
                "is stale: its {key} is {} and now it is {}; learn again without --from",
                short(then),
                short(now)
            )));
        }
    }
    Ok(drive)
}
