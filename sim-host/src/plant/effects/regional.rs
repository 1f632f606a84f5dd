//! An effect of the library that acts in a part of each run or in a region of the state alone, or whose strength changes along it:
//! a lubricant that warms, a guide worn in the middle of the stroke, a seal that lifts at speed.
//!
//! Any effect times a share of its strength. In a window the share is one between `from` and `to` and nothing outside; on a slope
//! it is `1 + change s / span`, never negative. The share is taken at the start of each integration step.
//! Such an effect has its plain form's identifier and further parameters, whose keys say along what it acts.

mod along;

use super::{
    Compliance, Dither, Effect, Ends, Entry, Flow, Hooks, Instant, Order, Parameter, Role, SignalScale, build, entry,
};
use crate::scalar::Scalar;
use std::collections::BTreeMap;
use std::sync::Mutex;

pub(crate) use along::Along;

/// How it depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Shape {
    /// There between two values and nowhere else.
    Window,
    /// More, or less, in proportion.
    Slope,
}

/// Where the first of the further parameters says which form it is, and the second over what its ends are smooth, or the span.
const CODE: &str = "region";
/// Key of the width of a window's ends, and of a slope's span.
const SCALE: &str = "scale";

/// The code of a form, as the parameter `region` holds it: the first of the further ones; the scale, and what is fitted, follow.
pub(crate) fn code(along: Along, shape: Shape) -> f64 {
    f64::from(along as u8) + if shape == Shape::Slope { 10.0 } else { 0.0 }
}

fn decoded(code: f64) -> Option<(Along, Shape)> {
    let shape = if code >= 10.0 { Shape::Slope } else { Shape::Window };
    let along = Along::ALL.into_iter().find(|along| (self::code(*along, shape) - code).abs() < 0.5)?;
    Some((along, shape))
}

/// Effects that have no part of their strength: what they do is not added to what would be there without them.
const WHOLE: [&str; 4] = ["flow_softening", "oil_compliance", "load_dependent_flow", "gain_drift"];

/// Effects that are there whatever moves: one that came and went with the motion would be a friction.
const BIASES: [&str; 2] = ["null_bias", "acceleration_bias"];

/// An effect of the library with a region; none for one that has no share of its strength, and none for a bias along the motion.
pub(crate) fn regional(plain: &'static Entry, along: Along, shape: Shape) -> Option<&'static Entry> {
    type Known = BTreeMap<(&'static str, Along, Shape), &'static Entry>;
    static KNOWN: Mutex<Known> = Mutex::new(BTreeMap::new());
    let moving = matches!(along, Along::Velocity | Along::Speed | Along::Command);
    if WHOLE.contains(&plain.id) || super::own::found(plain.id).is_some() || (moving && BIASES.contains(&plain.id)) {
        return None;
    }
    let mut known = KNOWN.lock().ok()?;
    Some(known.entry((plain.id, along, shape)).or_insert_with(|| Box::leak(Box::new(of(plain, along, shape)))))
}

fn of(plain: &'static Entry, along: Along, shape: Shape) -> Entry {
    let keep = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
    let (name, unit) = (along.name(), along.unit());
    let code = code(along, shape);
    let given = |key, unit, meaning, value: f64| {
        let starts: &'static [f64] = Box::leak(vec![value].into_boxed_slice());
        Parameter { starts, ..further(key, unit, meaning, Role::Given) }
    };
    let mut parameters = plain.parameters.to_vec();
    parameters.push(given(CODE, "1", "along what it acts, as a number", code));
    let equation = match shape {
        Shape::Window => {
            parameters.push(given(SCALE, unit, "over which it comes and goes", 1.0));
            parameters.push(further(keep(format!("from_{name}")), unit, "where it begins", Role::Shared));
            parameters.push(further(keep(format!("to_{name}")), unit, "where it ends", Role::Shared));
            format!("{}, from_{name} < {name} < to_{name}", plain.equation)
        }
        Shape::Slope => {
            parameters.push(given(SCALE, unit, "over which it changes", 1.0));
            let meaning = "by how much it grows over the scale, as a share";
            parameters.push(further(keep(format!("change_with_{name}")), "1", meaning, Role::Shared));
            format!("({}) (1 + change {name} / scale)", plain.equation)
        }
    };
    // What acts in a part alone is not what a law counters everywhere.
    let parameters = Box::leak(parameters.into_boxed_slice());
    Entry { equation: keep(equation), parameters, order: Order::Second, counter: None, ..*plain }
}

pub(super) const fn further(key: &'static str, unit: &'static str, meaning: &'static str, role: Role) -> Parameter {
    Parameter {
        key,
        unit,
        rigid_unit: unit,
        meaning,
        signal_scale: SignalScale::One,
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
        starts: &[0.0],
        positive: false,
        simple: Ends::Both,
        role,
    }
}

/// The entry of a stated effect: with a region where one of its parameters' keys is a region's.
pub(crate) fn stated<'a>(id: &str, keys: impl Iterator<Item = &'a str>) -> Option<&'static Entry> {
    let plain = entry(id)?;
    let keys: Vec<&str> = keys.collect();
    let all = Along::ALL.into_iter().flat_map(|along| [(along, Shape::Window), (along, Shape::Slope)]);
    let form = all.into_iter().find(|(along, shape)| match shape {
        Shape::Window => keys.contains(&format!("from_{}", along.name()).as_str()),
        Shape::Slope => keys.contains(&format!("change_with_{}", along.name()).as_str()),
    });
    form.map_or(Some(plain), |(along, shape)| regional(plain, along, shape))
}

/// Where the further parameters of a regional effect's entry begin among its values, and what form these say it has; none for
/// another effect.
pub(crate) fn form(entry: &Entry, values: &[f64]) -> Option<(usize, Along, Shape)> {
    let place = entry.parameters.iter().position(|p| p.key == CODE)?;
    let (along, shape) = decoded(*values.get(place)?)?;
    Some((place, along, shape))
}

/// The window of a regional effect's entry and values: along what, from where, to where; none for another effect.
pub(crate) fn window(entry: &Entry, values: &[f64]) -> Option<(Along, f64, f64)> {
    match (form(entry, values)?, values) {
        ((_, along, Shape::Window), &[.., from, to]) => Some((along, from, to)),
        _ => None,
    }
}

/// True for a parameter that only says which form an effect has.
pub(crate) fn is_code(key: &str) -> bool {
    key == CODE
}

/// An effect with a region in place.
#[derive(Debug)]
struct Regional<S> {
    inner: Box<dyn Effect<S>>,
    along: Along,
    scale: f64,
    ends: Share<S>,
    /// Share of its strength in this step.
    share: S,
}

#[derive(Debug)]
enum Share<S> {
    Window { from: S, to: S },
    Slope { change: S },
}

/// The effect where it has more parameters than its plain form.
pub(super) fn placed<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    let (own, further) = parameters.split_at_checked(entry(id)?.parameters.len())?;
    let &[code, scale, first, ref rest @ ..] = further else { return None };
    let (along, shape) = decoded(code.value())?;
    let ends = match (shape, rest) {
        (Shape::Window, &[to]) => Share::Window { from: first, to },
        (Shape::Slope, []) => Share::Slope { change: first },
        _ => return None,
    };
    let scale = scale.value().abs().max(f64::MIN_POSITIVE);
    Some(Box::new(Regional { inner: build(id, own)?, along, scale, ends, share: S::from(1.0) }))
}

/// Rises from nothing to one about zero, over about four of its argument.
pub(super) fn rising<S: Scalar>(x: S) -> S {
    let e = (-x.clamp(S::from(-40.0), S::from(40.0))).exp();
    S::from(1.0) / (e + 1.0)
}

impl<S: Scalar> Regional<S> {
    /// What the effect makes of something, at its present share.
    fn part(&self, without: S, with: S) -> S {
        without + (with - without) * self.share
    }
}

impl<S: Scalar> Effect<S> for Regional<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: false, observes: true, ..self.inner.hooks() }
    }
    fn states(&self) -> usize {
        self.inner.states()
    }
    fn fastest(&self) -> f64 {
        self.inner.fastest()
    }
    fn rest(&self, displacement: S, y: &mut [S]) {
        self.inner.rest(displacement, y);
    }
    fn dither(&mut self, dither: Dither) {
        self.inner.dither(dither);
    }
    fn under_way(&mut self, command: S) {
        self.inner.under_way(command);
    }
    fn observe(&mut self, at: &Instant<S>, command: S) {
        let s = self.along.of(at, command);
        self.share = match self.ends {
            Share::Window { from, to } => rising((s - from) / self.scale) * rising((to - s) / self.scale),
            Share::Slope { change } => (change * s / self.scale + 1.0).max(S::from(0.0)),
        };
    }
    fn command(&mut self, u: S, h: f64) -> S {
        let with = self.inner.command(u, h);
        self.part(u, with)
    }
    fn valve(&self, u: S, y: &[S], dy: &mut [S]) -> S {
        self.part(u, self.inner.valve(u, y, dy))
    }
    fn flow(&self, at: &Instant<S>, y: &[S], flow: &mut Flow<S>) {
        let without = *flow;
        self.inner.flow(at, y, flow);
        flow.gain = self.part(without.gain, flow.gain);
        flow.limit = self.part(without.limit, flow.limit);
        flow.positive = self.part(without.positive, flow.positive);
        flow.negative = self.part(without.negative, flow.negative);
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        self.inner.yields(compliance);
        if let Some(leakage) = self.leakage() {
            compliance.leakage = Some(leakage);
        }
    }
    fn leakage(&self) -> Option<S> {
        let none = Compliance::STIFF;
        let mut own = none;
        self.inner.yields(&mut own);
        own.leakage.map(|leakage| leakage * self.share)
    }
    fn force(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) -> S {
        self.inner.force(at, y, dy) * self.share
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        self.inner.follow(at, y, dy);
    }
    fn after(&mut self, displacement: S, time: f64) {
        self.inner.after(displacement, time);
    }
    fn sense_displacement(&self, displacement: S, y: &[S]) -> S {
        self.part(displacement, self.inner.sense_displacement(displacement, y))
    }
    fn sense_velocity(&self, velocity: S, y: &[S]) -> S {
        self.part(velocity, self.inner.sense_velocity(velocity, y))
    }
    fn sense_acceleration(&self, acceleration: S, at: &Instant<S>) -> S {
        self.part(acceleration, self.inner.sense_acceleration(acceleration, at))
    }
    fn supply_pressure(&self, y: &[S]) -> Option<S> {
        self.inner.supply_pressure(y)
    }
}

#[cfg(test)]
mod tests;
