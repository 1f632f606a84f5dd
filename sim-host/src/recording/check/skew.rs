//! One channel later than another: separate converters, filters of unequal delay, transducers with a lag.
//!
//! The accelerometer is compared with the second derivative of the displacement. A constant delay is a fault of the
//! recording that a shift of the channel mends; a lag that also rolls the gain off is a sensor's, an effect the
//! diagnosis knows. Either way the data can be used, so this is a remark; the delay is given for whoever aligns them.

use super::consistency::{Bin, coherent_bins, delay_over};
use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use std::f64::consts::PI;

/// How far the acceleration comes after the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skew {
    /// Delay, s; negative where the acceleration comes first.
    pub delay_s: f64,
    /// Its standard deviation, s.
    pub std_s: f64,
    /// Frequencies it rests on, Hz.
    pub from_hz: f64,
    /// The same.
    pub to_hz: f64,
    /// Gain of the acceleration against the second derivative of the displacement at the upper end of the band, over
    /// that at the lower end: a first-order lag lowers it, a pure delay does not.
    pub roll_off: f64,
}

/// Gains between which a bin counts.
const GAINS: std::ops::Range<f64> = 0.5..2.0;

/// Highest frequency used, Hz: above it the second derivative of a displacement is its sensor's noise.
const HIGHEST: f64 = 25.0;

impl Skew {
    /// Measures it; none where the two are not coherent over a band wide enough.
    pub fn of(run: &Run) -> Option<Self> {
        let displacement = run.channel(Channel::Displacement)?;
        let acceleration = run.channel(Channel::Acceleration)?;
        let (mut bins, _) = coherent_bins(displacement, acceleration, run.dt, 2);
        // Where one of them is mostly something else its phase says nothing of a delay.
        bins.retain(|b| GAINS.contains(&b.gain) && b.frequency < HIGHEST);
        let (first, last) = (bins.first()?, bins.last()?);
        if bins.len() < 8 || last.frequency < 2.0 * first.frequency {
            return None;
        }
        let delay_s = delay_over(&bins);
        // Neighbouring bins share a Hann window, so about half of them count.
        let information: f64 = bins.iter().map(|b| b.weight * (2.0 * PI * b.frequency).powi(2)).sum();
        let scatter =
            bins.iter().map(|b| b.weight * wrapped(b.phase + 2.0 * PI * b.frequency * delay_s).powi(2)).sum::<f64>()
                / (bins.len() - 1) as f64;
        let quarter = bins.len().div_ceil(4);
        let mean = |part: &[_]| part.iter().map(|b: &Bin| b.gain.ln()).sum::<f64>() / part.len() as f64;
        let roll_off = (mean(&bins[bins.len() - quarter..]) - mean(&bins[..quarter])).exp();
        let std_s = (2.0 * scatter / information).sqrt();
        Some(Self { delay_s, std_s, from_hz: first.frequency, to_hz: last.frequency, roll_off })
    }

    /// True where the delay is beyond doubt and long enough to matter: half a sample.
    pub fn matters(&self, dt: f64) -> bool {
        self.delay_s.abs() > (0.5 * dt).max(5.0 * self.std_s)
    }

    /// True where the gain does not fall with the delay, so that a shift undoes it.
    pub fn is_delay(&self) -> bool {
        self.roll_off > 0.8
    }
}

fn wrapped(phase: f64) -> f64 {
    phase - 2.0 * PI * (phase / (2.0 * PI)).round()
}

/// Reports a skew that matters.
pub(super) fn check(run: &Run) -> Option<Finding> {
    let skew = Skew::of(run).filter(|s| s.matters(run.dt))?;
    let (ms, samples) = (1e3 * skew.delay_s.abs(), skew.delay_s.abs() / run.dt);
    let order = if skew.delay_s > 0.0 { "after" } else { "before" };
    let shape = if skew.is_delay() {
        "its gain does not fall with it, so the channels were sampled or filtered apart"
    } else {
        "its gain falls with it, as a sensor's lag or a filter makes it"
    };
    Some(Finding::whole(run, Channel::Acceleration, Fault::Skew, Severity::Remark).saying(
        format!(
            "acceleration comes {ms:.2} ms ({samples:.2} samples) {order} the motion that displacement shows \
             ({:.1} to {:.1} Hz); {shape}",
            skew.from_hz, skew.to_hz
        ),
        format!("shift the acceleration by {:+.5} s, as a force balance does by itself", -skew.delay_s),
    ))
}
