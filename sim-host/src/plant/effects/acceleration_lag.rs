//! The accelerometer's filter lags.

use super::displacement_lag::TIME_CONSTANT;
use super::{Effect, Entry, Hooks, Instant, Order, Stage};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "acceleration_lag",
    equation: "tau y' = a - y",
    stage: Stage::Sensor,
    parameters: &[TIME_CONSTANT],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "acceleration trails the second difference of displacement",
    mistaken_for: &["valve_lag", "command_delay"],
    test: "accelerometer against LVDT phase",
    order: Order::Fourth,
    counter: None,
};

/// A lag in the accelerometer.
#[derive(Debug, Clone)]
pub struct AccelerationLag<S> {
    time: S,
}

impl<S: Scalar> AccelerationLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[time] = parameters else { return None };
        Some(Self { time })
    }
}

impl<S: Scalar> Effect<S> for AccelerationLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { follow: true, velocity: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        1.0 / self.time.value().max(1e-4)
    }
    fn states(&self) -> usize {
        1
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (&[shown], [rate]) = (y, dy) {
            *rate = (at.sensed_velocity - shown) / self.time;
        }
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        y.first().copied().unwrap_or(velocity)
    }
}
