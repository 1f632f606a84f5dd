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
        let tolerance = 1e-9;
        let miss = |string: &[f64]| self.area(string) - asked;
        let flat = self.pulled(0.0);
        let at_zero = miss(&flat);
        if at_zero.abs() < tolerance {
            return Ok((flat, 0.0));
        }
        let n = self.reference.len() as f64;
        // The bend that would give the missing area in a tube without walls, then doubled until the root is between.
        let mut far = 12.0 * at_zero / (n * n * n * self.reference.dt);
        let (mut near, mut at_near) = (0.0, at_zero);
        for _ in 0..60 {
            let string = self.pulled(far);
            let at_far = miss(&string);
            if at_far.abs() < tolerance {
                return Ok((string, far));
            }
            if at_far * at_zero < 0.0 {
                return self.between((near, at_near), (far, at_far), tolerance, miss);
            }
            (near, at_near) = (far, at_far);
            far *= 4.0;
        }
        Err(FitError::Infeasible(format!(
            "within {} m/s the record is too short to end {end} m from the centre",
            self.limit
        )))
    }

    /// Regula falsi with Illinois' correction between two bends whose areas lie on either side of the one asked for.
    fn between(
        &self,
        mut low: (f64, f64),
        mut high: (f64, f64),
        tolerance: f64,
        miss: impl Fn(&[f64]) -> f64,
    ) -> Result<(Vec<f64>, f64), FitError> {
        for _ in 0..200 {
            let bend = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let string = self.pulled(bend);
            let missed = miss(&string);
            if missed.abs() < tolerance {
                return Ok((string, bend));
            }
            if missed * high.1 < 0.0 {
                low = high;
            } else {
                low.1 *= 0.5;
            }
            high = (bend, missed);
        }
        Err(FitError::Solver("the end displacement did not converge".into()))
    }
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
        && grown.side * (apex.slope(newest) - apex.slope(corner)) >= 0.0
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
        (to.value - self.value) / (to.at as f64 - self.at as f64)
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
        while self.len() > 0 {
            let last = self.knots[self.knots.len() - 1];
            let before = if self.len() > 1 { self.knots[self.knots.len() - 2] } else { apex };
            if self.side * (before.slope(knot) - before.slope(last)) < 0.0 {
                break;
            }
            self.knots.pop();
        }
        self.knots.push(knot);
    }
}
