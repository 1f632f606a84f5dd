//! The noise floors a fit weighs its channels by: those of the recording where they are stated, else what
//! [`crate::recording::noise`] finds, behind the same low-pass as the comparison.

use crate::motion::filter::{Cascade, Edge};
use crate::recording::noise::{self, Floor, Origin};
use crate::recording::signal::filled;
use crate::recording::{self, PerChannel};

/// The floor of each channel of a run that has one, SI; `all` are searched for repeats, and for rest where this run has none.
pub(super) fn floors(run: &recording::Run, all: &[recording::Run], filter: Option<&Cascade>) -> PerChannel<f64> {
    let raw = rested(run, all);
    let mut floors = PerChannel::default();
    for (channel, floor) in raw.iter() {
        floors.set(channel, floor.std);
    }
    let Some(filter) = filter else { return floors };
    let smooth = rested(&smoothed(run, filter), &all.iter().map(|r| smoothed(r, filter)).collect::<Vec<_>>());
    for (channel, floor) in raw.iter() {
        // High differences of a low-passed signal hold nothing; then the share of a white noise that passes counts.
        let passed = match smooth.get(channel).map(|f| (f.origin, f.std)) {
            Some((Origin::Rest(..) | Origin::Repeats(_), std)) => std,
            _ => floor.std * share(filter, run.dt),
        };
        floors.set(channel, passed.min(floor.std));
    }
    floors
}

/// The floors of a run; where it never rests, those of another run of the same sensors and the same controller that does. What high
/// differences leave is less than a noise that swings slowly.
fn rested(run: &recording::Run, all: &[recording::Run]) -> PerChannel<Floor> {
    let mut floors = noise::floors(run, all);
    let poor = |floor: &Floor| matches!(floor.origin, Origin::Differences | Origin::Step);
    let alike = |other: &&recording::Run| other.name != run.name && other.dt == run.dt && other.law == run.law;
    for other in all.iter().filter(alike) {
        if !floors.iter().any(|(_, floor)| poor(floor)) {
            break;
        }
        let others = noise::floors(other, all);
        for (channel, other) in others.iter().filter(|(_, other)| matches!(other.origin, Origin::Rest(..))) {
            if floors.get(channel).is_some_and(|own| poor(own) && own.std < other.std) {
                floors.set(channel, other.clone());
            }
        }
    }
    floors
}

/// Standard deviation that a filter run both ways leaves of white noise of one.
pub(super) fn share(filter: &Cascade, dt: f64) -> f64 {
    let n = ((20.0 / dt) as usize).clamp(512, 1 << 14);
    let mut impulse = vec![0.0; n];
    impulse[n / 2] = 1.0;
    filter.zero_phase(&impulse, Edge::Hold).iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn smoothed(run: &recording::Run, filter: &Cascade) -> recording::Run {
    let mut out = run.clone();
    for (channel, samples) in run.channels.iter() {
        let smooth = filter.zero_phase(&filled(samples), Edge::Hold);
        let kept = samples.iter().zip(smooth).map(|(raw, smooth)| if raw.is_finite() { smooth } else { f64::NAN });
        out.channels.set(channel, kept.collect());
    }
    out.noise = PerChannel::default();
    out
}

/// A floor where nothing is known of a channel: too small to matter beside one that is.
pub(super) fn least(values: &[f64]) -> f64 {
    let scale = values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
    (1e-6 * scale).max(1e-12)
}
