//! Parts of the library one by one, for benchmarks, tests and tools of one's own. The doors at the crate's root are for
//! everybody else: what is here changes with the library's inside.

/// Parts of [`crate::simulate`].
pub mod closed_loop {
    pub use crate::closed_loop::named::settings;
    pub use crate::closed_loop::{bode, design, learning, sweep_recording, table1};
}

/// A controller at the other end of its link: client, recorder, session.
pub mod device {
    pub use crate::device::*;
}

/// Parts of [`mod@crate::diagnose`].
pub mod diagnose {
    pub use crate::diagnose::locate::leftover;
}

/// The campaigns that examine the guard.
pub mod faults {
    pub use crate::faults::*;
}

/// Files that are whole or not there at all.
pub mod files {
    pub use crate::files::*;
}

/// Parts of [`mod@crate::identify`].
pub mod identify {
    pub use crate::identify::data::{Channel, Measured, Run};
    pub use crate::identify::evaluate::{Local, predict};
    pub use crate::identify::fit::{Effort, Fit};
    pub use crate::identify::frequency::local::local_polynomial;
    pub use crate::identify::frequency::multisine::{DistortionLine, Multisine, multisine};
    pub use crate::identify::frequency::sine::{Dwell, SinePoint, dwells, response, sine_point, sweep};
    pub use crate::identify::frequency::{Point, Response, ResponseError};
    pub use crate::identify::interval::{NINETY, profiles};
    pub use crate::identify::judge::{Score, score};
    pub use crate::identify::model::{Model, ModelEffect, SignalScales, Value};
    pub use crate::identify::prepare::{Prepared, prepare};
    pub use crate::identify::starts::fitted;
}

/// The server of the operator's page.
#[cfg(all(feature = "cli", not(target_family = "wasm")))]
pub mod live {
    pub use crate::live::*;
}

/// Parts of [`crate::fit`].
pub mod motion {
    pub use crate::motion::fit::named::{ASKED, RecordFit};
    pub use crate::motion::fit::spectrum::Band;
    pub use crate::motion::fit::{certificate, convex, online, taut};
    pub use crate::motion::{qualify, spectrum};
}

/// Models of tables, and the paper's.
pub mod plant {
    pub use crate::plant::effects::{ENTRIES, Entry, build, entry, identifiers};
    pub use crate::plant::model::{Baseline, Kind};
    pub use crate::plant::simulate::{
        EffectParameters, Excitation, Notch, Shaping, SimulatedLaw, Start, Wanted, simulate,
    };
    pub use crate::plant::{Plant, paper, sensors};
}

/// The examination of diagnosis: cases, answers, scores.
#[cfg(feature = "cli")]
pub mod prove {
    pub use crate::prove::*;
}

/// Parts of [`crate::recording`].
pub mod recording {
    pub use crate::files::layout::Stated;
    pub use crate::recording::inner_loop::{Closure, Gain, InnerLoop, InnerLoopError, Log, Term, identify};
    pub use crate::recording::own_effect::load as load_effects;

    /// Recordings of columns.
    pub mod csv {
        pub use crate::recording::csv::{headings, read};
    }

    /// Recordings of MATLAB, version 5.
    pub mod mat {
        pub use crate::recording::mat::{headings, read};
    }

    pub use crate::recording::binary::hdf5::parse as parse_hdf5;
    pub use crate::recording::binary::rpc::parse as parse_rpc;
    pub use crate::recording::binary::tdms::parse as parse_tdms;
}

/// Pages and plots.
pub mod report {
    pub use crate::report::*;
}
