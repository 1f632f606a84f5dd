//! The host's side of the serial link: requests and answers, a run of a record, telemetry as a recording.
//!
//! Everything here takes bytes and gives bytes; whoever calls it owns the line (a serial port, a pseudo-terminal, the
//! emulated image's UART) and the clock.

mod drive;
mod line;
mod telemetry;

pub use drive::{Drive, DriveError, Progress};
pub use line::{Heard, Talker};
pub use telemetry::{Gap, Row, Telemetry};
