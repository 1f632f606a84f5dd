//! The load pressure under flows that depend on it.

use super::{Plant, State};
use crate::lab::balance::balance;
use crate::lab::law::{Column, Now, Place};

impl Plant {
    /// Whether a law's flow depends on the load pressure.
    pub(super) fn loads(&self) -> bool {
        self.parts.iter().any(|p| matches!(p.place, Place::Leak | Place::Edge))
    }

    /// The load pressure that acts on the piston while the edges pass `flow` (m/s) as far as it lets them and the leak passes
    /// what it asks for. The pressure of the oil's spring alone would do for neither: a leak that does not see what damps the
    /// oil gives energy.
    pub(super) fn load(&self, column: &dyn Column, now: &Now, flow: f64, y: &State, m: &State) -> f64 {
        let own = &y[self.column_at..self.used];
        let spring = column.spring(now, own);
        if !self.loads() {
            return spring;
        }
        balance(spring, |pressure| {
            let at = Now { pressure, ..*now };
            let q = self.through(Place::Edge, &at, flow, y, m);
            let lost = self.through(Place::Leak, &at, 0.0, y, m);
            column.rates(&at, q, lost, at.v, own, &mut [0.0; 8][..own.len()])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::{OWN, V};
    use crate::lab::forms::of;
    use crate::lab::law::{Now, Place};
    use crate::lab::plant::{Plant, State};
    use crate::lab::testing::{dial, servo};

    fn leaking() -> impl Iterator<Item = (&'static str, Plant)> {
        of("leakage").into_iter().map(|form| {
            let mut plant = Plant::baseline(servo());
            (form.build)(&mut plant, &dial(1.0));
            (form.name, plant)
        })
    }

    #[test]
    fn a_leak_is_odd_in_the_load_pressure_and_grows_with_it_without_a_jump() {
        for (name, plant) in leaking() {
            let (y, m) = plant.at_rest(0.0);
            let lost = |pressure| plant.through(Place::Leak, &Now { pressure, ..Now::default() }, 0.0, &y, &m);
            assert_eq!(lost(0.0), 0.0, "{name}");
            let steepest = lost(1e-3) / 1e-3 + lost(50.0) / 50.0;
            for k in 1..5000 {
                let (below, p) = (0.01 * f64::from(k - 1), 0.01 * f64::from(k));
                assert!((lost(p) + lost(-p)).abs() < 1e-15, "{name} at {p}");
                let step = lost(p) - lost(below);
                assert!(step > 0.0 && step < 0.02 * steepest, "{name} at {p}: {step}");
            }
        }
    }

    #[test]
    fn a_leaking_table_left_alone_loses_energy() {
        for (name, plant) in leaking() {
            let (rest, m) = plant.at_rest(0.0);
            for spring in [-20.0, -1.0, -0.01, 0.0, 0.3, 5.0] {
                for v in [-1.0, -0.05, 0.0, 0.002, 0.2] {
                    let (mut y, mut dy): (State, State) = (rest, rest);
                    (y[OWN], y[V]) = (spring / plant.column.as_ref().unwrap().spring(&Now::default(), &[1.0]), v);
                    plant.rates(&Now::default(), &y, &m, &mut dy);
                    let power = spring * dy[OWN] + v * dy[V];
                    assert!(power <= 1e-12, "{name}: {power} from {spring} m/s2 at {v} m/s");
                }
            }
        }
    }
}
