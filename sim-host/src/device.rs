//! The host's side of the serial link: requests and answers, a run of a record, telemetry as a recording.
//!
//! Everything here takes bytes and gives bytes; whoever calls it owns the line (a serial port, a pseudo-terminal, the
//! emulated image's UART) and the clock.

mod drive;
mod line;
#[cfg(unix)]
mod port;
mod proof_test;
mod recorder;
mod recording;
mod session;
mod telemetry;

pub use drive::{DriveError, Progress, TestRunner};
pub use line::{LinkClient, LinkCounters};
#[cfg(unix)]
pub use port::Port;
pub use proof_test::{PROOF_TEST, ProofTest, proof_test_kept};
pub use recorder::{Kept, Recorder, RecorderError};
pub use recording::Sheet;
pub use session::{Line, Session, SessionError};
pub use telemetry::{Gap, Row, Telemetry};
