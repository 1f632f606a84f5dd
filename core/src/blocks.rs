//! The parts that a [`Controller`](crate::Controller) is made of, one by one: for fitting, for comparison, for a controller of
//! another make.
//!
//! Who drives a table needs none of them: [`Controller::step`](crate::Controller::step) calls them in their order. Each part
//! is a configuration, made once from physical quantities and checked, apart from the state that a tick changes.
//!
//! ```
//! use shakedown_core::blocks::filter::Lag;
//! use shakedown_core::blocks::Block;
//!
//! // A lag of 50 ms at 1 kHz, its input stepping from 0 to 1: after 50 ms it has made 63 % of the way.
//! let lag = Lag::new(0.05, 1e-3)?;
//! let mut state = Default::default();
//! let outputs: Vec<f32> = (0..50).map(|_| lag.advance(&mut state, 1.0)).collect();
//! assert!((outputs[49] - 0.632).abs() < 1e-3);
//! # Ok::<(), shakedown_core::blocks::BlockError>(())
//! ```

pub use crate::block::{Block, BlockError, Held, RANGE, within_range};
pub use crate::scalar::Scalar;

/// Filters and the motion observer.
pub mod filter {
    pub use crate::filter::differentiator::{Differentiator, DifferentiatorState};
    pub use crate::filter::lag::{Lag, LagState};
    pub use crate::filter::observer::{MotionObserver, MotionState};
    pub use crate::filter::second_order::{SecondOrder, SecondOrderState};
    pub use crate::filter::washout::{Washout, WashoutState};
}

/// The loops of the paper's three-variable law.
pub mod control {
    pub use crate::control::acceleration::{AccelerationLoop, AccelerationState};
    pub use crate::control::displacement::{DisplacementLoop, DisplacementState};
    pub use crate::control::velocity::{VelocityLoop, VelocityState};
    pub use crate::control::{Blocked, LoopGains};
}

/// The tracking law and its parts.
pub mod tracking {
    pub use crate::control::tracking::disturbance::{Disturbance, DisturbanceState};
    pub use crate::control::tracking::flow::{FlowMap, FlowState};
    pub use crate::control::tracking::friction::Friction;
    pub use crate::control::tracking::oil::{OilColumn, OilState};
    pub use crate::control::tracking::pressure::PressureDamping;
    pub use crate::control::tracking::trajectory::{History, ReferenceState, Stencil};
    pub use crate::control::tracking::valve::{Valve, ValveState};
    pub use crate::control::tracking::{Surroundings, Tracking, TrackingInput, TrackingState};
}

/// The guard's input gate, monitors and state machine, and the detection of velocity saturation.
pub mod guard {
    pub use crate::guard::creep::Creep;
    pub use crate::guard::envelope::{DebouncedSignals, Envelope, EnvelopeState};
    pub use crate::guard::input_gate::InputGate;
    pub use crate::guard::inputs::{InputMonitor, InputState};
    pub use crate::guard::noise::{NoiseMonitor, NoiseState};
    pub use crate::guard::plausibility::{Plausibility, PlausibilityState};
    pub use crate::guard::supervisor::{Ramps, Supervisor};
    pub use crate::guard::valve::{ValveMonitor, ValveMonitorState};
    pub use crate::guard::witness::{DisplacementWitness, WitnessState};
    pub use crate::saturation::{Detector, DetectorState, Evidence};
}

/// Record modification while a test runs: [`clip`](record::clip) as the paper has it, [`causal`](record::causal) without
/// preview, [`preview`](record::preview) with the reference known ahead of time.
pub mod record {
    pub use crate::record::{DriftRecovery, ReferenceLimits};

    /// The paper's Eq. 10: velocity clipped, then integrated. It drifts and knows no stroke.
    pub mod clip {
        pub use crate::record::clip::{Config, State, step};
    }

    /// Inside velocity and stroke, without drift and without preview.
    pub mod causal {
        pub use crate::record::causal::{Config, State, step};
    }

    /// The same with a bounded preview: the taut string through the part of the reference in view.
    pub mod preview {
        pub use crate::record::preview::{Config, State, places, step};
    }
}

/// The mathematical functions of the core, whose bits agree between host and target.
pub mod math {
    pub use crate::math::{Magnitude, exp, exp_m1, floor, max, min, pow, sin, sqrt, tan};
}
