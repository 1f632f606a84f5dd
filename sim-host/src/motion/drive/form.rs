//! What a drive's values are, in which unit, and in which file.

use crate::recording::binary::rpc::Points;
use std::path::Path;

/// How the first line of a drive begins, after what marks a comment.
pub(super) const MARK: &str = "shakedown drive";

/// What the header of an RPC III drive says of its making.
pub(in crate::motion) const OPERATION: &str = "SHAKEDOWN DRIVE";

/// True for the first line of a drive's file.
pub(in crate::motion) fn is_first_line(line: &str) -> bool {
    let start: String = line.trim_start_matches(['#', ' ']).chars().take(MARK.len()).collect();
    start.eq_ignore_ascii_case(MARK)
}

/// What a drive's values are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// Displacement, m.
    Displacement,
    /// Acceleration, m/s2.
    Acceleration,
}

impl Quantity {
    /// Its name in files.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Acceleration => "acceleration",
        }
    }

    /// The quantity of that name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        [Self::Displacement, Self::Acceleration].into_iter().find(|q| q.name() == name)
    }
}

/// The unit of a drive's values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct DriveUnit {
    /// How the file writes it: `mm`, `V`, `%`, `g`.
    pub symbol: String,
    /// m, or m/s2, in one of it.
    pub in_si: f64,
}

impl DriveUnit {
    /// A unit with a fixed size; none for `V` and `%`, whose size the table decides.
    pub(crate) fn fixed(symbol: &str, quantity: Quantity) -> Option<Self> {
        let in_si = match quantity {
            Quantity::Displacement => match symbol {
                "m" => 1.0,
                "cm" => 0.01,
                "mm" => 0.001,
                "in" => 0.0254,
                _ => return None,
            },
            Quantity::Acceleration => symbol.parse::<crate::motion::AccelerationUnit>().ok()?.in_si(),
        };
        Some(Self { symbol: symbol.to_owned(), in_si })
    }
}

/// Files that a drive is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// `.csv`
    Csv,
    /// `.rpc`, `.drv`, `.tim`: MTS RPC III, its points stored so.
    Rpc(Points),
    /// `.at2`: PEER, acceleration in g alone.
    Peer,
}

impl Form {
    /// The form that a file's extension says; the refusal names the forms there are.
    pub(crate) fn of(path: &Path) -> Result<Self, String> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("rpc" | "drv" | "tim") => Ok(Self::Rpc(Points::default())),
            Some("at2") => Ok(Self::Peer),
            other => {
                let found = other.map_or_else(|| "no extension".to_owned(), |e| format!("`.{e}`"));
                Err(format!(
                    "{found}: a drive is written as .csv, .rpc (MTS RPC III) or .AT2 (PEER, acceleration in g); name one"
                ))
            }
        }
    }
}
