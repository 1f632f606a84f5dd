//! What no effect of the library holds: a curve through knots, in one coordinate, at one place of the signal path.
//!
//! These are not physics and no search tries them: a diagnosis that has to call a mismatch unlisted fits them to what is
//! left, so that the model predicts better and the curve's shape says what to look for.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, SignalScale, Stage};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// Knots of a curve, evenly spread over what the runs reach.
pub(crate) const KNOTS: usize = 9;

/// Where a curve acts, and along what.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Acts {
    ForceByVelocity,
    ForceByDisplacement,
    FrictionByDisplacement,
    GainByDisplacement,
    GainByVelocity,
    LimitByTime,
}

const CURVES: [(Acts, Entry); 6] = [
    (
        Acts::ForceByVelocity,
        curve("remainder_force_by_velocity", "f = f(v)", Stage::Table, &knots(SignalScale::Speed, "m/s", FORCE)),
    ),
    (
        Acts::ForceByDisplacement,
        curve(
            "remainder_force_by_displacement",
            "f = f(x)",
            Stage::Table,
            &knots(SignalScale::Displacement, "m", FORCE),
        ),
    ),
    (
        Acts::FrictionByDisplacement,
        curve(
            "remainder_friction_by_displacement",
            "f = f(x) sign v",
            Stage::Table,
            &knots(SignalScale::Displacement, "m", FORCE),
        ),
    ),
    (
        Acts::GainByDisplacement,
        curve(
            "remainder_gain_by_displacement",
            "b0 (1 + g(x))",
            Stage::Flow,
            &knots(SignalScale::Displacement, "m", SHARE),
        ),
    ),
    (
        Acts::GainByVelocity,
        curve("remainder_gain_by_velocity", "b0 (1 + g(v))", Stage::Flow, &knots(SignalScale::Speed, "m/s", SHARE)),
    ),
    (
        Acts::LimitByTime,
        curve("remainder_limit_by_time", "vmax (1 + g(t))", Stage::Flow, &knots(SignalScale::Duration, "s", SHARE)),
    ),
];

/// Every curve, in the order of the signal path's places above.
pub(crate) fn entries() -> impl Iterator<Item = &'static Entry> {
    const ALL: &[(Acts, Entry)] = &CURVES;
    ALL.iter().map(|(_, entry)| entry)
}

/// What a knot's height is measured in.
#[derive(Clone, Copy)]
struct Height {
    unit: &'static str,
    rigid_unit: &'static str,
    signal_scale: SignalScale,
    most: f64,
}

const FORCE: Height = Height { unit: "m/s2", rigid_unit: "N", signal_scale: SignalScale::Force, most: 8.0 };
const SHARE: Height = Height { unit: "1", rigid_unit: "1", signal_scale: SignalScale::One, most: 0.9 };

const KEYS: [&str; KNOTS] = ["k1", "k2", "k3", "k4", "k5", "k6", "k7", "k8", "k9"];

const fn curve(
    id: &'static str,
    equation: &'static str,
    stage: Stage,
    parameters: &'static [Parameter; KNOTS + 1],
) -> Entry {
    const SERVO: &[Kind] = &[Kind::Servo];
    const ANY: &[Kind] = &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance];
    Entry {
        id,
        equation,
        stage,
        family: Family::Sensors,
        parameters,
        kinds: if matches!(stage, Stage::Flow) { SERVO } else { ANY },
        frees: &[],
        signature: "what the library's effects leave",
        mistaken_for: &[],
        test: "the same runs at another amplitude: a curve in the wrong coordinate does not carry over",
        order: Order::Second,
        contains: &[],
        counter: None,
    }
}

const fn knots(along: SignalScale, unit: &'static str, height: Height) -> [Parameter; KNOTS + 1] {
    let mut all = [Parameter {
        key: "span",
        unit,
        rigid_unit: unit,
        meaning: "where the last knot stands",
        signal_scale: along,
        low: 1.0,
        high: 1.0,
        starts: &[1.0],
        positive: false,
        simple: Ends::Both,
        role: Role::Given,
    }; KNOTS + 1];
    let mut i = 0;
    while i < KNOTS {
        all[i + 1] = Parameter {
            key: KEYS[i],
            unit: height.unit,
            rigid_unit: height.rigid_unit,
            meaning: "height of the curve at a knot",
            signal_scale: height.signal_scale,
            low: -height.most,
            high: height.most,
            starts: &[0.0],
            positive: false,
            simple: Ends::Both,
            role: Role::Shared,
        };
        i += 1;
    }
    all
}

/// Where a curve's knots stand, in the unit of its coordinate; evenly from `-span` to `span`, of time from 0.
pub(crate) fn places(id: &str, span: f64) -> Option<[f64; KNOTS]> {
    let (acts, _) = CURVES.iter().find(|(_, entry)| entry.id == id)?;
    let low = if *acts == Acts::LimitByTime { 0.0 } else { -span };
    Some(std::array::from_fn(|i| low + (span - low) * i as f64 / (KNOTS - 1) as f64))
}

/// A curve with its parameters, in the order of its entry; none where the identifier is unknown.
pub(crate) fn build<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    let (acts, _) = CURVES.iter().find(|(_, entry)| entry.id == id)?;
    let (&span, heights) = parameters.split_first()?;
    let heights: [S; KNOTS] = heights.try_into().ok()?;
    Some(Box::new(Curve { acts: *acts, span, heights }))
}

/// A curve in place.
#[derive(Debug, Clone)]
struct Curve<S> {
    acts: Acts,
    span: S,
    heights: [S; KNOTS],
}

impl<S: Scalar> Curve<S> {
    /// The curve at a coordinate; beyond the ends it keeps its last height.
    fn at(&self, coordinate: S) -> S {
        let share = coordinate / self.span.max(S::from(1e-12));
        let share = if self.acts == Acts::LimitByTime { share } else { share * 0.5 + 0.5 };
        let last = (KNOTS - 1) as f64;
        let place = (share * last).clamp(S::from(0.0), S::from(last));
        let left = (place.value() as usize).min(KNOTS - 2);
        let between = place - left as f64;
        self.heights[left] + (self.heights[left + 1] - self.heights[left]) * between
    }
}

/// Speed within which friction turns round, m/s.
const TURNING: f64 = 1e-3;

impl<S: Scalar> Effect<S> for Curve<S> {
    fn hooks(&self) -> Hooks {
        let flow = matches!(self.acts, Acts::GainByDisplacement | Acts::GainByVelocity | Acts::LimitByTime);
        Hooks { flow, force: !flow, ..Hooks::default() }
    }
    fn flow(&self, at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        match self.acts {
            Acts::LimitByTime => flow.limit = flow.limit * (self.at(S::from(at.time)) + 1.0),
            Acts::GainByVelocity => flow.gain = flow.gain * (self.at(at.velocity) + 1.0),
            _ => flow.gain = flow.gain * (self.at(at.displacement) + 1.0),
        }
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        match self.acts {
            Acts::ForceByVelocity => self.at(at.velocity),
            Acts::FrictionByDisplacement => self.at(at.displacement) * (at.velocity / TURNING).tanh(),
            _ => self.at(at.displacement),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_its_knots_and_keeps_its_ends() {
        let mut parameters = vec![0.2];
        parameters.extend((0..KNOTS).map(|i| (i * i) as f64));
        let curve = Curve { acts: Acts::ForceByVelocity, span: 0.2, heights: parameters[1..].try_into().unwrap() };
        let places = places("remainder_force_by_velocity", 0.2).unwrap();
        for (place, height) in places.into_iter().zip(&parameters[1..]) {
            assert!((curve.at(place) - height).abs() < 1e-9, "{place}");
        }
        assert_eq!((curve.at(-9.0), curve.at(9.0)), (0.0, 64.0));
        assert!((curve.at(0.025) - 20.5).abs() < 1e-9);
    }

    #[test]
    fn every_curve_can_be_built_and_no_search_holds_one() {
        for entry in entries() {
            let parameters = vec![0.1; entry.parameters.len()];
            assert!(super::super::build(entry.id, &parameters).is_some(), "{}", entry.id);
            assert!(!super::super::identifiers().contains(&entry.id));
        }
    }
}
