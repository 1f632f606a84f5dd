//! A force balance: what load the measured motion asks for, with any effects that act as forces.

use super::dynamics::EffectInstance;
use super::{EffectParameters, SimulateError, Start, Trace, Wanted};
use crate::plant::effects::Instant;
use crate::scalar::Scalar;

/// Measured motion of the table, one value a sample.
#[derive(Debug, Clone, Default)]
pub struct MeasuredMotion {
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Acceleration, m/s2.
    pub acceleration: Vec<f64>,
}

/// Integration steps in a sample.
const STEPS: usize = 4;
/// Continuous states provided for.
const MOST: usize = 12;

/// Displacement (m) within a sample, of third order through place and velocity at both ends: where a table turns round between two
/// samples it does so where friction does, and no straight line shows it.
fn turning(motion: &MeasuredMotion, [from, to]: [usize; 2], share: f64, dt: f64) -> f64 {
    let [a, b] = [from, to].map(|k| motion.displacement[k]);
    let [at_a, at_b] = [from, to].map(|k| motion.velocity[k] * dt);
    let left = 1.0 - share;
    let straight = a + (b - a) * share;
    straight + share * left * (left * (at_a - (b - a)) - share * (at_b - (b - a)))
}

/// The load per table mass, `x'' + c x' + f`, that the motion asks for, from how it starts on.
pub(crate) fn balance<S: Scalar>(
    viscous: S,
    effects: &[EffectParameters<S>],
    motion: &MeasuredMotion,
    dt: f64,
    start: &Start<S>,
) -> Result<Trace<S>, SimulateError> {
    let (mut mounted, used, _) =
        EffectInstance::all(effects.iter().map(|p| (p.id, p.parameters.clone())), |_| 0, MOST)?;
    let n = motion.acceleration.len();
    let at = |k: usize, share: f64| {
        let next = (k + 1).min(n - 1);
        let between = |series: &[f64]| series[k] + (series[next] - series[k]) * share;
        Instant {
            time: start.time + (k as f64 + share) * dt,
            displacement: S::from(turning(motion, [k, next], share, dt)),
            velocity: S::from(between(&motion.velocity)),
            sensed_velocity: S::from(0.0),
            velocity_limit: S::from(1.0),
        }
    };
    let rates = |mounted: &[EffectInstance<S>], at: &Instant<S>, y: &[S; MOST]| {
        let mut dy = [S::from(0.0); MOST];
        let mut force = S::from(0.0);
        for m in mounted {
            force += m.effect.force(at, &y[m.first..m.last], &mut dy[m.first..m.last]);
        }
        (dy, force)
    };
    let mut y = [S::from(0.0); MOST];
    for m in mounted.iter_mut().filter(|_| n > 0) {
        m.effect.rest(S::from(motion.displacement[0]), &mut y[m.first..m.last]);
        m.effect.after(S::from(motion.displacement[0]), start.time);
    }
    y.iter_mut().zip(&start.states).for_each(|(y, &away)| *y += away);
    let mut trace = Trace::with_capacity(n, Wanted { load: true, ..Wanted::default() });
    let h = dt / STEPS as f64;
    for k in 0..n {
        let now = at(k, 0.0);
        for m in &mut mounted {
            m.effect.observe(&now, S::from(0.0));
        }
        trace.load.push(rates(&mounted, &now, &y).1 + viscous * now.velocity + motion.acceleration[k]);
        for step in 0..STEPS {
            let share = |part: f64| at(k, (step as f64 + part) / STEPS as f64);
            let moved = |scale: f64, k: &[S; MOST]| {
                let mut moved = y;
                moved.iter_mut().zip(k).take(used).for_each(|(y, rate)| *y += *rate * scale);
                moved
            };
            let k1 = rates(&mounted, &share(0.0), &y).0;
            let k2 = rates(&mounted, &share(0.5), &moved(0.5 * h, &k1)).0;
            let k3 = rates(&mounted, &share(0.5), &moved(0.5 * h, &k2)).0;
            let k4 = rates(&mounted, &share(1.0), &moved(h, &k3)).0;
            for i in 0..used {
                y[i] += (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (h / 6.0);
            }
            let reached = share(1.0);
            for m in &mut mounted {
                m.effect.after(reached.displacement, reached.time);
            }
        }
    }
    Ok(trace)
}
