//! What a little of an effect would do: an effect with a share of its strength that is still nothing.
//!
//! What such a share makes has one derivative that is not nothing, by the share, and that is a plain number: the effect itself runs on
//! plain numbers along the motion that is there without it.

use super::{Dither, Effect, Flow, Hooks, Instant, STATES};
use crate::scalar::Scalar;

/// An effect of which there is nothing yet.
#[derive(Debug)]
struct Tangent<S> {
    inner: Box<dyn Effect<f64>>,
    /// Share of its strength, in this step where it is in parts: nothing with derivatives.
    share: S,
    parts: Option<Box<dyn Shares<S>>>,
}

/// A share that changes with the motion or the command, nothing with derivatives.
pub(super) trait Shares<S>: std::fmt::Debug + Send {
    /// The share in a step that begins like this.
    fn share(&self, at: &Instant<f64>, command: f64) -> S;
}

/// An effect that is everywhere, as many times as `share` says.
pub(super) fn everywhere<S: Scalar>(inner: Box<dyn Effect<f64>>, share: S) -> Box<dyn Effect<S>> {
    Box::new(Tangent { inner, share, parts: None })
}

/// An effect of which the share is another in each step.
pub(super) fn in_shares<S: Scalar>(inner: Box<dyn Effect<f64>>, shares: Box<dyn Shares<S>>) -> Box<dyn Effect<S>> {
    Box::new(Tangent { inner, share: S::from(1.0), parts: Some(shares) })
}

/// States as plain numbers.
struct Plain([f64; STATES]);

impl Plain {
    fn of<S: Scalar>(y: &[S]) -> Self {
        let mut plain = [0.0; STATES];
        plain.iter_mut().zip(y).for_each(|(plain, y)| *plain = y.value());
        Self(plain)
    }
}

fn plain<S: Scalar>(at: &Instant<S>) -> Instant<f64> {
    Instant {
        time: at.time,
        displacement: at.displacement.value(),
        velocity: at.velocity.value(),
        sensed_velocity: at.sensed_velocity.value(),
        velocity_limit: at.velocity_limit.value(),
    }
}

/// What `inner` gives with these states, and their rates.
fn with_states<S: Scalar, T>(y: &[S], dy: &mut [S], inner: impl Fn(&[f64], &mut [f64]) -> T) -> T {
    let (states, mut rates) = (Plain::of(y), Plain::of(dy));
    let given = inner(&states.0[..y.len()], &mut rates.0[..dy.len()]);
    dy.iter_mut().zip(rates.0).for_each(|(dy, rate)| *dy = S::from(rate));
    given
}

impl<S: Scalar> Tangent<S> {
    /// What a share of the effect makes of something.
    fn part(&self, without: S, with: f64) -> S {
        without + self.share * (with - without.value())
    }
}

impl<S: Scalar> Effect<S> for Tangent<S> {
    fn hooks(&self) -> Hooks {
        let own = self.inner.hooks();
        Hooks { linear: own.linear && self.parts.is_none(), observes: own.observes || self.parts.is_some(), ..own }
    }
    fn states(&self) -> usize {
        self.inner.states()
    }
    fn fastest(&self) -> f64 {
        // Nothing of a term has no rate of its own; an effect's states have.
        if self.parts.is_some() { self.inner.fastest() } else { 0.0 }
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        let mut states = Plain::of(y);
        self.inner.rest(displacement.value(), &mut states.0[..y.len()]);
        y.iter_mut().zip(states.0).for_each(|(y, state)| *y = S::from(state));
    }
    fn dither(&mut self, dither: Dither) {
        self.inner.dither(dither);
    }
    fn under_way(&mut self, command: S) {
        self.inner.under_way(command.value());
    }
    fn observe(&mut self, at: &Instant<S>, command: S) {
        let (at, command) = (plain(at), command.value());
        self.inner.observe(&at, command);
        if let Some(parts) = &self.parts {
            self.share = parts.share(&at, command);
        }
    }
    fn command(&mut self, u: S, h: f64) -> S {
        let with = self.inner.command(u.value(), h);
        self.part(u, with)
    }
    fn valve(&self, u: S, y: &[S], dy: &mut [S]) -> S {
        let with = with_states(y, dy, |y, dy| self.inner.valve(u.value(), y, dy));
        self.part(u, with)
    }
    fn flow(&self, at: &Instant<S>, y: &[S], flow: &mut Flow<S>) {
        let without = *flow;
        let mut with = Flow {
            gain: without.gain.value(),
            limit: without.limit.value(),
            positive: without.positive.value(),
            negative: without.negative.value(),
            sharpness: without.sharpness.map(Scalar::value),
        };
        self.inner.flow(&plain(at), &Plain::of(y).0[..y.len()], &mut with);
        flow.gain = self.part(without.gain, with.gain);
        flow.limit = self.part(without.limit, with.limit);
        flow.positive = self.part(without.positive, with.positive);
        flow.negative = self.part(without.negative, with.negative);
    }
    fn force(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) -> S {
        let at = plain(at);
        self.share * with_states(y, dy, |y, dy| self.inner.force(&at, y, dy))
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        let at = plain(at);
        with_states(y, dy, |y, dy| self.inner.follow(&at, y, dy));
    }
    fn after(&mut self, displacement: S, time: f64) {
        self.inner.after(displacement.value(), time);
    }
    fn sense_displacement(&self, displacement: S, y: &[S]) -> S {
        self.part(displacement, self.inner.sense_displacement(displacement.value(), &Plain::of(y).0[..y.len()]))
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        self.part(velocity, self.inner.sense_velocity(velocity.value(), &Plain::of(y).0[..y.len()]))
    }
    fn sense_acceleration(&self, acceleration: S, at: &Instant<S>) -> S {
        self.part(acceleration, self.inner.sense_acceleration(acceleration.value(), &plain(at)))
    }
    fn supply_pressure(&self, y: &[S]) -> Option<S> {
        self.inner.supply_pressure(&Plain::of(y).0[..y.len()]).map(S::from)
    }
}
