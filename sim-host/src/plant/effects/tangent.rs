//! What a little of an effect would do: an effect with a share of its strength that is still nothing, everywhere or in each part of a range.
//!
//! What such a share makes has one derivative that is not nothing, by the share, and that is a plain number: the effect itself runs on
//! plain numbers along the motion that is there without it. One simulation says what a little of it would do in every part.

use super::regional::Along;
use super::{Dither, Effect, Entry, Flow, Hooks, Instant, Order, Parameter, Role, build, entry, regional};
use crate::plant::simulate::dynamics::STATES;
use crate::scalar::Scalar;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Added to the code of a variable, where the first of the further parameters says along what an effect acts.
const CODE: f64 = 20.0;
/// Widths from an inner end at which nothing is left of coming and going.
const OVER: f64 = 30.0;

/// The entry of an effect in this many parts along a variable; none for one that has no share of its strength, and none for a leakage:
/// a little of it does nothing.
pub(crate) fn in_parts(plain: &'static Entry, along: Along, parts: usize) -> Option<&'static Entry> {
    static KNOWN: Mutex<BTreeMap<(&'static str, Along, usize), &'static Entry>> = Mutex::new(BTreeMap::new());
    regional::regional(plain, along, regional::Shape::Window).filter(|_| plain.id != super::leakage::ENTRY.id)?;
    let of = || -> &'static Entry {
        let mut parameters = plain.parameters.to_vec();
        let given = (0..=parts).map(|_| further("given", Role::Given));
        parameters.extend(given.chain((0..parts).map(|_| further("share", Role::Shared))));
        Box::leak(Box::new(Entry { parameters: parameters.leak(), order: Order::Second, counter: None, ..*plain }))
    };
    Some(KNOWN.lock().ok()?.entry((plain.id, along, parts)).or_insert_with(of))
}

/// What stands behind the parameters of an effect in parts: along what, over what the parts' inner `ends` are smooth, these, and a share
/// of nothing in each.
pub(crate) fn parameters(along: Along, width: f64, ends: &[f64]) -> (Vec<f64>, usize) {
    let code = CODE + f64::from(along as u8);
    ([code, width].into_iter().chain(ends.iter().copied()).collect(), ends.len() + 1)
}

const fn further(key: &'static str, role: Role) -> Parameter {
    regional::further(key, "1", "for a look at parts", role)
}

/// An effect of which there is nothing yet.
#[derive(Debug)]
struct Tangent<S> {
    inner: Box<dyn Effect<f64>>,
    /// Share of its strength, in this step where it is in parts: nothing with derivatives.
    share: S,
    parts: Option<Parts<S>>,
}

/// Parts of a range with a share in each.
#[derive(Debug)]
struct Parts<S> {
    along: Along,
    width: f64,
    ends: Vec<f64>,
    shares: Vec<S>,
}

impl<S: Scalar> Parts<S> {
    /// The share at a value of what they are along.
    fn share(&self, s: f64) -> S {
        let rising = |end: f64| -> f64 {
            let x: f64 = (s - end) / self.width;
            if x.abs() < OVER { 1.0 / (1.0 + (-x).exp()) } else { f64::from(u8::from(x > 0.0)) }
        };
        let (mut share, mut begun) = (S::from(0.0), 1.0);
        for (i, &of_part) in self.shares.iter().enumerate() {
            let past = self.ends.get(i).map_or(0.0, |&end| rising(end));
            if begun > past {
                share = share.plus_scaled(of_part, begun - past);
            }
            begun = past;
        }
        share
    }
}

/// An effect that is everywhere, as many times as `share` says.
pub(super) fn everywhere<S: Scalar>(inner: Box<dyn Effect<f64>>, share: S) -> Box<dyn Effect<S>> {
    Box::new(Tangent { inner, share, parts: None })
}

/// The effect where its further parameters say that it is in parts.
pub(super) fn placed<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    let (own, further) = parameters.split_at_checked(entry(id)?.parameters.len())?;
    let &[code, width, ref rest @ ..] = further else { return None };
    let along = Along::ALL.into_iter().find(|along| CODE + f64::from(*along as u8) == code.value())?;
    let (ends, shares) = rest.split_at_checked(rest.len() / 2)?;
    let plain = |values: &[S]| -> Vec<f64> { values.iter().map(|value| value.value()).collect() };
    let parts =
        Parts { along, width: width.value().abs().max(f64::MIN_POSITIVE), ends: plain(ends), shares: shares.to_vec() };
    Some(Box::new(Tangent { inner: build(id, &plain(own))?, share: S::from(1.0), parts: Some(parts) }))
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
            self.share = parts.share(parts.along.of(&at, command));
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

#[cfg(test)]
mod tests;
