//! What terms of the grammar give: their values, their units and how much of them makes sense.

use super::grammar::{Form, Reach, Term, Times};
use crate::plant::effects::own::Sense;

impl Term {
    /// Unit of its coefficients.
    pub(super) fn unit(self) -> String {
        let power = match self.form {
            Form::Linear | Form::Magnitude => 2,
            Form::OddSquare | Form::Square => 4,
            Form::Cube => 6,
            Form::Root => 1,
            Form::Direction | Form::Wave => 0,
        };
        // Twice the exponents, for roots.
        let mut twice = self.follows.dimension().map(|e| -power * e);
        let gives: [i32; 3] = match self.sense {
            Sense::ForcePerMass | Sense::Acceleration => [1, -2, 0],
            Sense::Force | Sense::Gain => [0, 0, 0],
            Sense::Command => [0, 0, 1],
            Sense::Displacement => [1, 0, 0],
        };
        let times: [i32; 3] = match self.times {
            Times::One | Times::Against => [0, 0, 0],
            Times::Velocity => [1, -1, 0],
            Times::Passing if self.sense == Sense::Acceleration => [1, -2, 0],
            Times::Passing => [0, 0, 1],
        };
        for i in 0..3 {
            twice[i] += 2 * (gives[i] - times[i]);
        }
        written(twice, self.sense == Sense::Force)
    }

    /// Largest coefficient that makes sense: twenty times what passes the place.
    pub(super) fn most(self, reach: &Reach) -> f64 {
        let s = self.follows.reach(reach);
        let form = match self.form {
            Form::Linear | Form::Magnitude => s,
            Form::OddSquare | Form::Square => s * s,
            Form::Cube => s.powi(3),
            Form::Root => s.sqrt(),
            Form::Direction | Form::Wave => 1.0,
        };
        let gives = match self.sense {
            Sense::ForcePerMass | Sense::Acceleration => reach.acceleration.max(1.0),
            Sense::Force => reach.mass * reach.acceleration.max(1.0),
            Sense::Gain => 0.2,
            Sense::Command => reach.command,
            Sense::Displacement => reach.place,
        };
        let times = match self.times {
            Times::One | Times::Against => 1.0,
            Times::Velocity => reach.velocity,
            Times::Passing if self.sense == Sense::Acceleration => reach.acceleration,
            Times::Passing => reach.command,
        };
        20.0 * gives / (form * times).max(1e-12)
    }

    /// What its form gives at a value of what it follows, memory and what multiplies it left out; `length` is a wave's.
    pub(super) fn value(self, s: f64, coefficients: &[f64], length: f64) -> f64 {
        let of = |i: usize| coefficients.get(i).copied().unwrap_or(0.0);
        let form = match self.form {
            Form::Linear => s,
            Form::Magnitude => s.abs(),
            Form::OddSquare => s * s.abs(),
            Form::Square => s * s,
            Form::Cube => s.powi(3),
            Form::Root => s.signum() * s.abs().sqrt(),
            Form::Direction => s.signum(),
            Form::Wave => {
                let angle = std::f64::consts::TAU * s / length;
                return of(0) * angle.cos() + of(1) * angle.sin();
            }
        };
        of(0) * form
    }

    /// The unit of what it follows.
    pub(super) fn state_unit(self) -> String {
        written(self.follows.dimension().map(|e| 2 * e), false)
    }
}

/// A unit from twice its exponents of metre, second and the command's unit; `newton` puts N before them.
pub(super) fn written(twice: [i32; 3], newton: bool) -> String {
    let part = |sign: i32| {
        let mut factors: Vec<String> = Vec::new();
        for (name, e) in ["m", "s", "u"].iter().zip(twice) {
            let e = e * sign;
            if e == 2 {
                factors.push((*name).to_owned());
            } else if e > 0 {
                factors.push(format!("{name}{}", f64::from(e) / 2.0));
            }
        }
        factors
    };
    let mut above = part(1);
    if newton {
        above.insert(0, "N".into());
    }
    let below = part(-1);
    let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    match below.as_slice() {
        [] => above,
        [one] => format!("{above}/{one}"),
        many => format!("{above}/({})", many.join(" ")),
    }
}
