//! A bench watched and operated from a local page while it runs.
//!
//! ```text
//! Bench (a device, its twin, a recording) -> watch (one thread) -> Hub -> Server (loopback only) -> page
//!                                                 ^--------- orders ---------'
//! ```
//! The thread that watches owns the bench, its recording on disk and what the page shows. A page only reads frames and sends
//! orders: it may be closed, reloaded or killed without the test, the recording or the counters noticing. Who may read or order
//! is decided in one place, [`Admission`].

mod admission;
mod attendant;
mod bench;
mod frame;
mod hub;
mod recorded;
mod server;
mod soft_device;
mod spectra;
mod watch;

pub use admission::{Admission, Forbidden};
pub use attendant::{Attendant, Storage};
pub use bench::{Answer, Bench, BenchError, Facts, Order, Phase, Sample, Status};
pub use hub::Hub;
pub use recorded::{Recorded, RecordedError};
pub use server::{Server, ServerError};
pub use soft_device::{SoftDevice, SoftDeviceError};
pub use watch::{Summary, watch};
