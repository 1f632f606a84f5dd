//! The taut string: least acceleration error under a velocity limit, in one pass.
//!
//! The velocity given up, e = r - v, has to lie in the tube [r - V, r + V]. Among all such e with given ends the string
//! pulled taut through the tube minimises the sum of f(e') for every convex f at once: least squares, least absolute
//! error and least peak are the same motion (Barlow et al. 1972; Davies and Kovac 2001, Ann. Statist. 29).
//!
//! A given end displacement adds one multiplier l to the least-squares problem: e'' = l wherever the tube is not
//! touched. Subtracting the parabola with that curvature leaves a taut string again, in a bent tube, and the
//! displacement grows with l; so the exact answer is a root of one increasing function.

use super::{FitError, Fitted, Limits, Reference};

/// The best motion under `limits.velocity`, ending at rest, at `limits.end` where that is given. Other limits are not
/// looked at.
pub fn fit(reference: &Reference, limits: &Limits) -> Result<Fitted, FitError> {
    limits.check(reference)?;
    let tube = Tube { reference, limit: limits.velocity };
    let (given_up, bend) = match limits.end {
        None => (tube.pulled(0.0), 0.0),
        Some(end) => tube.ending_at(end)?,
    };
    // Rounding may leave the string a last place outside its tube; the velocity limit is kept exactly.
    let limit = limits.velocity;
    let velocity: Vec<f64> =
        reference.velocity.iter().zip(&given_up).map(|(r, e)| (r - e).clamp(-limit, limit)).collect();
    let bound = bound(reference, limits, &velocity, bend);
    Ok(Fitted { velocity, bound: Some(bound) })
}

/// Weak duality: for any y and any multiplier m of the end displacement, every motion v in the tube has
/// |D(v - r)|^2 / 2 >= -|y|^2 / 2 - y'Dr + m (start - end) - V sum |D'y + m w|, w being the trapezoidal weights.
/// Taken at the string's own acceleration error and curvature this is as high as the string is good.
fn bound(reference: &Reference, limits: &Limits, velocity: &[f64], bend: f64) -> f64 {
    let r = &reference.velocity;
    let multiplier = -bend / reference.dt;
    let error = |k: usize| (velocity[k + 1] - velocity[k]) - (r[k + 1] - r[k]);
    let (mut value, mut whole) = (0.0, 0.0);
    for k in 0..r.len() - 1 {
        let asked = r[k + 1] - r[k];
        value -= error(k) * (0.5 * error(k) + asked);
        whole += asked * asked;
        if k > 0 {
            value -= limits.velocity * (error(k - 1) - error(k) + multiplier * reference.dt).abs();
        }
    }
    if let Some(end) = limits.end {
        value += multiplier * (reference.start - end);
    }
    if whole > 0.0 { (2.0 * value / whole).max(0.0).sqrt() } else { 0.0 }
}

/// The tube a string is pulled through.
struct Tube<'a> {
    reference: &'a Reference,
    limit: f64,
}

impl Tube<'_> {
    /// The string in the tube bent by a parabola of second difference `bend`, m/s.
    fn pulled(&self, bend: f64) -> Vec<f64> {
        let last = self.reference.len() - 1;
        let parabola = |k: usize| 0.5 * bend * k as f64 * (k as f64 - last as f64);
        let tube = |k: usize| {
            let middle = self.reference.velocity[k] - parabola(k);
            if k == 0 || k == last { (middle, middle) } else { (middle - self.limit, middle + self.limit) }
        };
        let mut string = taut_string(self.reference.len(), tube);
        if bend != 0.0 {
            for (k, e) in string.iter_mut().enumerate() {
                *e += parabola(k);
            }
        }
        string
    }

    /// Displacement given up at the end, m.
    fn area(&self, string: &[f64]) -> f64 {
        let inner: f64 = string.iter().sum();
        let ends = 0.5 * (string.first().unwrap_or(&0.0) + string.last().unwrap_or(&0.0));
        self.reference.dt * (inner - ends)
    }

    /// The string whose motion ends at `end`, m, and its bend.
    fn ending_at(&self, end: f64) -> Result<(Vec<f64>, f64), FitError> {
        let asked = self.reference.start + self.area(&self.reference.velocity) - end;
        let bent = |bend: f64| {
            let string = self.pulled(bend);
            let missed = self.area(&string) - asked;
            Bent { bend, string, missed }
        };
        let mut near = bent(0.0);
        if near.missed == 0.0 {
            return Ok((near.string, 0.0));
        }
        let n = self.reference.len() as f64;
        // The bend that would make up the missing area in a tube without walls, then more until the root is between.
        let mut bend = 12.0 * near.missed / (n * n * n * self.reference.dt);
        for _ in 0..60 {
            let far = bent(bend);
            if far.missed * near.missed <= 0.0 {
                return Ok(between(near, far, bent));
            }
            near = far;
            bend *= 4.0;
        }
        Err(FitError::Infeasible(format!(
            "within {} m/s the record is too short to end {end} m from the centre",
            self.limit
        )))
    }
}

/// A string pulled in a bent tube, and the displacement, m, by which it misses what was asked.
struct Bent {
    bend: f64,
    string: Vec<f64>,
    missed: f64,
}

/// Where the two brackets of the root are this near to each other, m, a mixture of both strings is the answer.
const NEAR: f64 = 1e-5;

/// Regula falsi with Illinois' correction between two strings that miss on either side. The strings left at the end are
/// mixed to give the area exactly: a mixture stays inside the tube, and what it loses is of second order.
fn between(mut low: Bent, mut high: Bent, bent: impl Fn(f64) -> Bent) -> (Vec<f64>, f64) {
    let (mut low_weight, mut high_weight) = (1.0, 1.0);
    for _ in 0..60 {
        if (high.missed - low.missed).abs() < NEAR || low.missed == 0.0 || high.missed == 0.0 {
            break;
        }
        let (a, b) = (low.missed * low_weight, high.missed * high_weight);
        let middle = bent((low.bend * b - high.bend * a) / (b - a));
        if middle.missed * high.missed <= 0.0 {
            (low, low_weight) = (high, 1.0);
            (high, high_weight) = (middle, 1.0);
        } else {
            (high, high_weight) = (middle, 1.0);
            low_weight *= 0.5;
        }
        if high.missed.abs() < 0.1 * NEAR {
            break;
        }
    }
    let share = if low.missed == high.missed { 0.0 } else { low.missed / (low.missed - high.missed) };
    let mixed = low.string.iter().zip(&high.string).map(|(l, h)| l + share * (h - l)).collect();
    (mixed, low.bend + share * (high.bend - low.bend))
}

/// The string of `n` points pulled taut through a tube, given as (lower, upper) at each point; where both are equal it is
/// held. Each wall point enters a chain and leaves it once: O(n).
pub fn taut_string(n: usize, tube: impl Fn(usize) -> (f64, f64)) -> Vec<f64> {
    let mut string = Vec::with_capacity(n);
    if n == 0 {
        return string;
    }
    let first = tube(0);
    let mut apex = Knot { at: 0, value: 0.5 * (first.0 + first.1) };
    string.push(apex.value);
    let (mut lower, mut upper) = (Chain::new(1.0), Chain::new(-1.0));
    for at in 1..n {
        let (low, high) = tube(at);
        upper.add(apex, Knot { at, value: high });
        cross(&mut apex, &mut upper, &mut lower, &mut string);
        lower.add(apex, Knot { at, value: low });
        cross(&mut apex, &mut lower, &mut upper, &mut string);
    }
    // Held at its end, both chains lead there; one of them is the string.
    let rest = if upper.len() >= lower.len() { upper } else { lower };
    for knot in rest.knots() {
        lead(&mut apex, knot, &mut string);
    }
    string
}

/// Where the newest point of `grown` is out of sight behind `other`, the string bends around `other`.
fn cross(apex: &mut Knot, grown: &mut Chain, other: &mut Chain, string: &mut Vec<f64>) {
    while grown.len() == 1
        && let (Some(newest), Some(corner)) = (grown.front(), other.front())
        && corner.at < newest.at
        && grown.side * apex.turn(corner, newest) >= 0.0
    {
        lead(apex, corner, string);
        other.drop_front();
    }
}

/// Draws the string straight from `apex` to `knot`, which becomes the apex.
fn lead(apex: &mut Knot, knot: Knot, string: &mut Vec<f64>) {
    let slope = apex.slope(knot);
    for k in 1..knot.at - apex.at {
        string.push(apex.value + slope * k as f64);
    }
    if knot.at > apex.at {
        string.push(knot.value);
    }
    *apex = knot;
}

/// A point of the string or of a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    at: usize,
    value: f64,
}

impl Knot {
    fn slope(self, to: Self) -> f64 {
        (to.value - self.value) / (to.at - self.at) as f64
    }

    /// Positive where `b`, seen from here, lies above the line to `a`; both lie ahead.
    #[inline]
    fn turn(self, a: Self, b: Self) -> f64 {
        (b.value - self.value) * (a.at - self.at) as f64 - (a.value - self.value) * (b.at - self.at) as f64
    }
}

/// The taut line from the apex along one wall: convex along the upper, concave along the lower.
struct Chain {
    knots: Vec<Knot>,
    head: usize,
    /// 1 for the lower wall, -1 for the upper.
    side: f64,
}

impl Chain {
    fn new(side: f64) -> Self {
        Self { knots: Vec::new(), head: 0, side }
    }

    fn len(&self) -> usize {
        self.knots.len() - self.head
    }

    fn front(&self) -> Option<Knot> {
        self.knots.get(self.head).copied()
    }

    fn drop_front(&mut self) {
        self.head += 1;
    }

    fn knots(&self) -> impl Iterator<Item = Knot> + '_ {
        self.knots.iter().skip(self.head).copied()
    }

    /// Adds a wall point and takes back those that the line to it passes on the free side.
    fn add(&mut self, apex: Knot, knot: Knot) {
        while let [.., last] = self.knots[self.head..] {
            let before = if let [.., before, _] = self.knots[self.head..] { before } else { apex };
            if self.side * before.turn(last, knot) < 0.0 {
                break;
            }
            self.knots.pop();
        }
        self.knots.push(knot);
    }
}

#[cfg(test)]
mod tests {
    use super::super::convex::{self, Norm};
    use super::*;
    use proptest::prelude::*;

    fn references() -> impl Strategy<Value = Reference> {
        prop::collection::vec(-1.0..1.0f64, 3..60).prop_map(|steps| {
            let mut v = 0.0;
            let velocity = steps.iter().map(|s| {
                v = 0.95 * v + s;
                v
            });
            Reference { dt: 0.01, velocity: velocity.collect(), start: 0.0 }
        })
    }

    #[test]
    fn a_triangle_is_scaled_where_it_is_too_fast() {
        // r runs 0, 2, 0, -2, 0 and the tube is 1 wide either way: the string has slope 1/2 of r's between the peaks.
        let reference =
            Reference { dt: 1.0, velocity: vec![0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0], start: 0.0 };
        let fitted = fit(&reference, &Limits::velocity(1.0)).unwrap();
        let expected = [0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -0.5, 0.0];
        for (v, x) in fitted.velocity.iter().zip(expected) {
            assert!((v - x).abs() < 1e-12, "{:?}", fitted.velocity);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// The bound, which trusts nothing, meets the error: the string is the optimum.
        #[test]
        fn is_proven_optimal(reference in references(), limit in 0.05..2.0f64) {
            let fitted = fit(&reference, &Limits::velocity(limit)).unwrap();
            let error = reference.acceleration_error(&fitted.velocity);
            let bound = fitted.bound.unwrap();
            prop_assert!(bound <= error + 1e-9 && error <= bound + 1e-6, "{error} against {bound}");
            prop_assert!(fitted.velocity.iter().all(|v| v.abs() <= limit));
            prop_assert!(fitted.velocity[0].abs() < 1e-12 && fitted.velocity[reference.len() - 1].abs() < 1e-12);
        }

        /// With the end given too, and it ends there.
        #[test]
        fn ends_where_it_is_told_and_is_proven_optimal(reference in references(), limit in 0.3..2.0f64) {
            let limits = Limits { end: Some(0.0), ..Limits::velocity(limit) };
            let fitted = fit(&reference, &limits).unwrap();
            let error = reference.acceleration_error(&fitted.velocity);
            let bound = fitted.bound.unwrap();
            let end = reference.displacement(&fitted.velocity).pop().unwrap();
            prop_assert!(end.abs() < 1e-9, "{end}");
            prop_assert!(bound <= error + 1e-9 && error <= bound * 1.001 + 1e-4, "{error} against {bound}");
        }

        /// Pulled taut it is the least in every norm: the linear programs find nothing better.
        #[test]
        fn is_least_in_every_norm(reference in references(), limit in 0.1..1.0f64) {
            let limits = Limits::velocity(limit);
            let fitted = fit(&reference, &limits).unwrap();
            for norm in [Norm::One, Norm::Two, Norm::Peak] {
                let bound = convex::fit(&reference, &limits, norm).unwrap().bound.unwrap();
                let error = norm.error(&reference, &fitted.velocity);
                // The solver's accuracy is that of what it makes small, which is half of the square.
                let within = match norm {
                    Norm::Two => 0.5 * (error * error - bound * bound) <= 1e-7,
                    Norm::One | Norm::Peak => error <= bound + 1e-5,
                };
                prop_assert!(within, "{norm:?}: {error} against {bound}");
            }
        }

        #[test]
        fn visits_every_point_of_the_tube(walls in prop::collection::vec((-1.0..1.0f64, 0.0..1.0f64), 1..80)) {
            let tube = |k: usize| (walls[k].0 - walls[k].1, walls[k].0 + walls[k].1);
            let string = taut_string(walls.len() , |k| if k + 1 == walls.len() { (walls[k].0, walls[k].0) } else { tube(k) });
            prop_assert_eq!(string.len(), walls.len());
            for (k, e) in string.iter().enumerate() {
                prop_assert!(tube(k).0 - 1e-12 <= *e && *e <= tube(k).1 + 1e-12, "{k}: {e}");
            }
        }
    }
}
