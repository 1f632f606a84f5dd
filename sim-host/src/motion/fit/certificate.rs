//! What was given up, where, under which limit; and what it would take to meet a target.
//!
//! A fit that returns a bound is proven: no motion within the limits comes nearer than the bound. A relaxation is proven
//! on both sides: at `met_at` a motion exists, at `missed_at` the bound lies above the target.

use super::convex::{self, Norm};
use super::{FitError, Limits, Reference, taut};

/// A stretch of the record in which acceleration was given up.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub to: f64,
    /// Its share of the squared acceleration error, 0 to 1.
    pub share: f64,
    /// Largest acceleration error in it, m/s2.
    pub peak: f64,
    /// The limits that the motion touches in it or at its ends, by name.
    pub limits: Vec<&'static str>,
}

/// Pauses in the error shorter than this, s, do not end a stretch.
const PAUSE: f64 = 0.25;

/// Where `velocity`, m/s, gives up acceleration, largest share first: stretches whose error exceeds a thousandth of the
/// reference's peak acceleration.
pub fn given_up(reference: &Reference, velocity: &[f64], limits: &Limits) -> Vec<Stretch> {
    let dt = reference.dt;
    let asked = super::steepest(&reference.velocity, dt);
    let error: Vec<f64> = reference
        .velocity
        .windows(2)
        .zip(velocity.windows(2))
        .map(|(r, v)| ((r[1] - r[0]) - (v[1] - v[0])) / dt)
        .collect();
    let whole: f64 = error.iter().map(|e| e * e).sum();
    let displacement = reference.displacement(velocity);
    let pause = (PAUSE / dt) as usize;
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in (0..error.len()).filter(|&k| error[k].abs() > 1e-3 * asked) {
        match found.last_mut() {
            Some((_, to)) if k <= *to + pause => *to = k,
            _ => found.push((k, k)),
        }
    }
    let mut stretches: Vec<Stretch> = found
        .into_iter()
        .map(|(from, to)| Stretch {
            from: from as f64 * dt,
            to: (to + 1) as f64 * dt,
            share: error[from..=to].iter().map(|e| e * e).sum::<f64>() / whole,
            peak: error[from..=to].iter().map(|e| e.abs()).fold(0.0, f64::max),
            limits: touched(&velocity[from..=to + 1], &displacement[from..=to + 1], dt, limits),
        })
        .collect();
    stretches.sort_by(|a, b| b.share.total_cmp(&a.share));
    stretches
}

/// The limits that a piece of the motion touches to within a thousandth.
fn touched(velocity: &[f64], displacement: &[f64], dt: f64, limits: &Limits) -> Vec<&'static str> {
    let peak = |signal: &[f64]| signal.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let slope: Vec<f64> = velocity.windows(2).map(|w| (w[1] - w[0]) / dt).collect();
    let flow = limits.stall.map(|stall| {
        let used = |v: &f64, a: &f64| (v / limits.velocity).powi(2) + a.abs() / stall;
        velocity.iter().zip(&slope).map(|(v, a)| used(v, a)).fold(0.0, f64::max)
    });
    let used = [
        ("velocity", peak(velocity) / limits.velocity),
        ("stroke", limits.stroke.map_or(0.0, |x| peak(displacement) / x)),
        ("acceleration", limits.acceleration.map_or(0.0, |a| peak(&slope) / a)),
        ("jerk", limits.jerk.map_or(0.0, |j| super::steepest(&slope, dt) / j)),
        ("flow under load", flow.unwrap_or(0.0)),
    ];
    used.into_iter().filter(|(_, used)| *used > 0.999).map(|(name, _)| name).collect()
}

/// Which limits a relaxation multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relaxed {
    /// The velocity limit.
    Velocity,
    /// The stroke.
    Stroke,
    /// Velocity, stroke, acceleration, jerk and stall by one factor, which is the record scaled down instead.
    All,
}

impl Relaxed {
    /// What is multiplied, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity limit",
            Self::Stroke => "stroke",
            Self::All => "all limits",
        }
    }

    fn applied(self, limits: &Limits, factor: f64) -> Limits {
        let times = |limit: Option<f64>| limit.map(|x| x * factor);
        match self {
            Self::Velocity => Limits { velocity: limits.velocity * factor, ..*limits },
            Self::Stroke => Limits { stroke: times(limits.stroke), ..*limits },
            Self::All => Limits {
                velocity: limits.velocity * factor,
                stroke: times(limits.stroke),
                acceleration: times(limits.acceleration),
                jerk: times(limits.jerk),
                stall: times(limits.stall),
                end: limits.end,
            },
        }
    }
}

/// The smallest factor on some limits with which a target is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relaxation {
    /// What is multiplied.
    pub relaxed: Relaxed,
    /// With this factor a motion meets the target.
    pub met_at: f64,
    /// With this factor none does.
    pub missed_at: f64,
    /// The error that is reached at `met_at`.
    pub error: f64,
    /// Below this no motion comes at `missed_at`.
    pub bound: f64,
}

/// Relative width at which the search for a relaxation ends.
const WIDTH: f64 = 2e-3;

/// The smallest factor on `relaxed` with which some motion has `E_a` at most `target`; `None` where the limits meet it
/// already, an error where no factor up to 1000 does.
pub fn relaxation(
    reference: &Reference,
    limits: &Limits,
    relaxed: Relaxed,
    target: f64,
) -> Result<Option<Relaxation>, FitError> {
    let best = |factor: f64| best(reference, &relaxed.applied(limits, factor));
    let (error, bound) = best(1.0)?;
    if error <= target {
        return Ok(None);
    }
    let mut missed = (1.0, bound);
    let mut met = (2.0, best(2.0)?.0);
    while met.1 > target {
        if met.0 > 1000.0 {
            return Err(FitError::Infeasible(format!("no {} brings the error down to {target}", relaxed.name())));
        }
        missed = (met.0, best(met.0)?.1);
        met = (2.0 * met.0, best(2.0 * met.0)?.0);
    }
    while met.0 - missed.0 > WIDTH * missed.0 {
        let middle = 0.5 * (met.0 + missed.0);
        let (error, bound) = best(middle)?;
        if error <= target {
            met = (middle, error);
        } else if bound > target {
            missed = (middle, bound);
        } else {
            break;
        }
    }
    Ok(Some(Relaxation { relaxed, met_at: met.0, error: met.1, missed_at: missed.0, bound: missed.1 }))
}

/// Error reached and bound proven by the cheapest exact method for these limits.
fn best(reference: &Reference, limits: &Limits) -> Result<(f64, f64), FitError> {
    let only_velocity = Limits { velocity: limits.velocity, end: limits.end, ..Limits::velocity(1.0) } == *limits;
    let fitted = if only_velocity { taut::fit(reference, limits)? } else { convex::fit(reference, limits, Norm::Two)? };
    Ok((reference.acceleration_error(&fitted.velocity), fitted.bound.unwrap_or(0.0)))
}
