//! Butterworth filters of any order as cascades of second-order sections, causal and zero-phase.
//!
//! Sections are in transposed direct form II:
//! ```text
//! y = b0 x + s1,   s1 = b1 x - a1 y + s2,   s2 = b2 x - a2 y
//! ```
//! designed by the bilinear transform with the corner pre-warped, `K = tan(pi f dt)`, so that the gain at the corner is
//! 1/sqrt(2) for one pass, 1/2 for zero phase. Source: Oppenheim and Schafer, Discrete-Time Signal Processing, 7.1.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// What a filter lets through.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(clippy::enum_variant_names, reason = "what such filters are called")]
pub enum Band {
    /// Below a corner frequency, Hz.
    LowPass(f64),
    /// Above a corner frequency, Hz.
    HighPass(f64),
    /// Between two corner frequencies, Hz: a high-pass and a low-pass of the same order, one after the other.
    BandPass(f64, f64),
}

/// A Butterworth filter, still without a sampling interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Butterworth {
    /// What it lets through.
    pub band: Band,
    /// Order of each of its sides, 1 to [`MAX_ORDER`].
    pub order: usize,
}

/// The highest order that is designed.
pub(crate) const MAX_ORDER: usize = 20;

/// How a filter runs over a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pass {
    /// Once forward, from rest, as an analogue filter would.
    Causal,
    /// Forward and backward, so that no frequency is delayed; the gain is squared.
    ZeroPhase,
}

/// What a zero-phase filter takes a signal to be before its first and after its last sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// Its first and last values held for ever: right for a motion at rest at both ends, and exact.
    Hold,
    /// Reflected through its end points over so many samples, for a cut out of something longer.
    Odd(usize),
}

/// Why a filter cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The corner is not between 0 and half the sampling rate.
    #[error("corner frequency {corner} Hz: expected over 0 and below {nyquist} Hz, half the sampling rate")]
    Corner {
        /// The corner asked for, Hz.
        corner: f64,
        /// Half the sampling rate, Hz.
        nyquist: f64,
    },
    /// The corners of a band are the wrong way round.
    #[error("band {low} to {high} Hz: expected the lower corner first")]
    Band {
        /// Lower corner, Hz.
        low: f64,
        /// Upper corner, Hz.
        high: f64,
    },
    /// The order is 0 or too high.
    #[error("order {0}: expected 1 to {MAX_ORDER}")]
    Order(usize),
}

/// A second-order section, `a0 = 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator b0, b1, b2.
    pub b: [f64; 3],
    /// Denominator a1, a2.
    pub a: [f64; 2],
}

/// A filter for one sampling interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Cascade {
    sections: Vec<Section>,
}

impl Butterworth {
    /// A low-pass of an order at a corner, Hz.
    pub fn low_pass(order: usize, corner: f64) -> Self {
        Self { band: Band::LowPass(corner), order }
    }

    /// A high-pass of an order at a corner, Hz.
    pub fn high_pass(order: usize, corner: f64) -> Self {
        Self { band: Band::HighPass(corner), order }
    }

    /// The filter for signals sampled every `dt` s.
    pub fn design(&self, dt: f64) -> Result<Cascade, FilterError> {
        if !(1..=MAX_ORDER).contains(&self.order) {
            return Err(FilterError::Order(self.order));
        }
        let sections = match self.band {
            Band::LowPass(corner) => side(self.order, corner, dt, false)?,
            Band::HighPass(corner) => side(self.order, corner, dt, true)?,
            Band::BandPass(low, high) if low < high => {
                let mut sections = side(self.order, low, dt, true)?;
                sections.extend(side(self.order, high, dt, false)?);
                sections
            }
            Band::BandPass(low, high) => return Err(FilterError::Band { low, high }),
        };
        Ok(Cascade { sections })
    }

    /// Filters a signal sampled every `dt` s, its ends held where the pass is zero-phase.
    pub fn apply(&self, signal: &[f64], dt: f64, pass: Pass) -> Result<Vec<f64>, FilterError> {
        let cascade = self.design(dt)?;
        Ok(match pass {
            Pass::Causal => cascade.causal(signal),
            Pass::ZeroPhase => cascade.zero_phase(signal, Edge::Hold),
        })
    }
}

/// The sections of a low-pass, or of a high-pass.
fn side(order: usize, corner: f64, dt: f64, high: bool) -> Result<Vec<Section>, FilterError> {
    let nyquist = 0.5 / dt;
    if !(corner > 0.0 && corner < nyquist) {
        return Err(FilterError::Corner { corner, nyquist });
    }
    let k = (PI * corner * dt).tan();
    let mut sections = Vec::with_capacity(order.div_ceil(2));
    for pair in 0..order / 2 {
        // The angle of a pole pair from the negative real axis.
        let angle = if order.is_multiple_of(2) { pair as f64 + 0.5 } else { pair as f64 + 1.0 } * PI / order as f64;
        let damping = 2.0 * angle.cos();
        let norm = 1.0 / (1.0 + damping * k + k * k);
        let b = if high { [norm, -2.0 * norm, norm] } else { [k * k * norm, 2.0 * k * k * norm, k * k * norm] };
        sections.push(Section { b, a: [2.0 * (k * k - 1.0) * norm, (1.0 - damping * k + k * k) * norm] });
    }
    if !order.is_multiple_of(2) {
        let norm = 1.0 / (1.0 + k);
        let b = if high { [norm, -norm, 0.0] } else { [k * norm, k * norm, 0.0] };
        sections.push(Section { b, a: [(k - 1.0) * norm, 0.0] });
    }
    Ok(sections)
}

impl Section {
    /// Gain at zero frequency.
    fn dc_gain(&self) -> f64 {
        (self.b[0] + self.b[1] + self.b[2]) / (1.0 + self.a[0] + self.a[1])
    }

    /// Magnitude of the slower pole.
    fn radius(&self) -> f64 {
        let [a1, a2] = self.a;
        let discriminant = a1 * a1 / 4.0 - a2;
        if discriminant < 0.0 { a2.sqrt() } else { a1.abs() / 2.0 + discriminant.sqrt() }
    }

    /// Runs over a signal in place, from the state that an input held for ever before it leaves.
    fn run(&self, signal: &mut [f64], held: f64) {
        let gain = self.dc_gain();
        let mut s2 = (self.b[2] - self.a[1] * gain) * held;
        let mut s1 = (self.b[1] - self.a[0] * gain) * held + s2;
        for x in signal {
            let y = self.b[0] * *x + s1;
            s1 = self.b[1] * *x - self.a[0] * y + s2;
            s2 = self.b[2] * *x - self.a[1] * y;
            *x = y;
        }
    }
}

impl Cascade {
    /// The sections, in the order they run.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Gain of one pass at a frequency (Hz) for a sampling interval (s).
    pub fn gain(&self, frequency: f64, dt: f64) -> f64 {
        let w = 2.0 * PI * frequency * dt;
        let magnitude = |c0: f64, c1: f64, c2: f64| {
            let re = c0 + c1 * w.cos() + c2 * (2.0 * w).cos();
            let im = c1 * w.sin() + c2 * (2.0 * w).sin();
            re.hypot(im)
        };
        self.sections.iter().map(|s| magnitude(s.b[0], s.b[1], s.b[2]) / magnitude(1.0, s.a[0], s.a[1])).product()
    }

    /// Samples until the slowest mode has fallen to 1e-10 of its start.
    fn ring(&self) -> usize {
        let slowest = self.sections.iter().map(Section::radius).fold(0.0, f64::max);
        if slowest <= 0.0 { 1 } else { (1e-10f64.ln() / slowest.ln()).ceil().clamp(1.0, 4e6) as usize }
    }

    fn run(&self, signal: &mut [f64], mut held: f64) {
        for section in &self.sections {
            section.run(signal, held);
            held *= section.dc_gain();
        }
    }

    /// One pass forward from rest.
    pub fn causal(&self, signal: &[f64]) -> Vec<f64> {
        let mut out = signal.to_vec();
        self.run(&mut out, 0.0);
        out
    }

    /// Forward and backward; as long as the signal.
    pub fn zero_phase(&self, signal: &[f64], edge: Edge) -> Vec<f64> {
        let (Some(&first), Some(&last)) = (signal.first(), signal.last()) else { return Vec::new() };
        let n = signal.len();
        let (mut out, before) = match edge {
            Edge::Hold => {
                let mut out = signal.to_vec();
                out.resize(n + self.ring(), last);
                (out, 0)
            }
            Edge::Odd(pad) => {
                let pad = pad.min(n - 1);
                let head = (1..=pad).rev().map(|i| 2.0 * first - signal[i]);
                let tail = (1..=pad).map(|i| 2.0 * last - signal[n - 1 - i]);
                (head.chain(signal.iter().copied()).chain(tail).collect(), pad)
            }
        };
        for _ in 0..2 {
            let held = out.first().copied().unwrap_or(0.0);
            self.run(&mut out, held);
            out.reverse();
        }
        out[before..before + n].to_vec()
    }
}

#[cfg(test)]
mod tests;
