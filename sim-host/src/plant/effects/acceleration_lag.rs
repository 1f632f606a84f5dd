//! The accelerometer's filter lags.

use super::displacement_lag::{SECOND, TIME_CONSTANT};
use super::{Effect, Entry, Family, Hooks, Instant, Order, Stage};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "acceleration_lag",
    equation: "tau y' = a - y, tau_2 z' = y - z",
    stage: Stage::Sensor,
    family: Family::Sensors,
    parameters: &[TIME_CONSTANT, SECOND],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "acceleration trails the second difference of displacement",
    mistaken_for: &["valve_lag", "command_delay"],
    test: "accelerometer against LVDT phase",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A lag in the accelerometer.
#[derive(Debug, Clone)]
pub(crate) struct AccelerationLag<S> {
    time: S,
    second: Option<S>,
}

impl<S: Scalar> AccelerationLag<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[time, second] = parameters else { return None };
        Some(Self { time, second: Some(second).filter(|second| second.value() > TIME_CONSTANT.low) })
    }
}

impl<S: Scalar> Effect<S> for AccelerationLag<S> {
    fn hooks(&self) -> Hooks {
        Hooks { follow: true, velocity: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        1.0 / self.second.unwrap_or(self.time).min(self.time).value().max(1e-4)
    }
    fn states(&self) -> usize {
        1 + usize::from(self.second.is_some())
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        let mut ahead = at.sensed_velocity;
        for ((shown, rate), time) in y.iter().zip(dy).zip([Some(self.time), self.second].into_iter().flatten()) {
            *rate = (ahead - *shown) / time;
            ahead = *shown;
        }
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        y.last().copied().unwrap_or(velocity)
    }
}
