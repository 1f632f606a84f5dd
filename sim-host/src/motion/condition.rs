//! Conditioning: a [`Recipe`] of steps that turns a record into a motion a table can be asked to follow.
//!
//! After every step displacement and velocity are the exact integrals of the acceleration ([`Motion`]); nothing is
//! filtered on its own. Two recipes have names: [`Recipe::table1`] and [`Recipe::fitting`].

mod baseline;

use super::filter::{Butterworth, FilterError, Pass};
use super::record::central_difference;
use super::resample::{Interpolation, resample};
use super::{AccelerationUnit, Motion, Record, UnknownUnit, peak};
use serde::{Deserialize, Serialize};

/// One step of conditioning.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Step {
    /// Takes a least-squares polynomial out of the acceleration; degree 0 is the mean.
    Baseline {
        /// Its degree, 0 to 6.
        degree: usize,
    },
    /// Takes the derivative of a polynomial fitted to the velocity (zero at the start) out of the acceleration, which
    /// stops a drift of displacement.
    VelocityBaseline {
        /// Its degree, 1 to 6.
        degree: usize,
    },
    /// Keeps a stretch of time.
    Trim {
        /// Its begin, s.
        from_s: f64,
        /// Its end, s.
        to_s: f64,
    },
    /// Adds rest (zero acceleration).
    Rest {
        /// Before, s.
        before_s: f64,
        /// After, s.
        after_s: f64,
    },
    /// Another sampling rate.
    Resample {
        /// The rate, Hz.
        rate_hz: f64,
        /// What the acceleration is between its samples.
        between: Interpolation,
    },
    /// A Butterworth filter on the acceleration.
    Filter {
        /// The filter.
        filter: Butterworth,
        /// Once forward, or zero-phase.
        pass: Pass,
    },
    /// A zero-phase Butterworth high-pass on the acceleration, and again on the velocity it makes.
    HighPassMotion {
        /// Corner, Hz.
        corner_hz: f64,
        /// Order.
        order: usize,
    },
    /// Every quantity times a factor.
    Scale {
        /// The factor.
        factor: f64,
    },
    /// Scaled to a peak acceleration.
    ScaleToPeak {
        /// The peak, m/s²; [`peak_acceleration`] reads it from `0.74g`.
        peak: f64,
    },
    /// Scaled down until the largest displacement fits a stroke; a motion that fits already stays.
    FitStroke {
        /// The stroke to one side, m.
        stroke: f64,
    },
    /// Scaled down until the largest velocity fits a limit; a motion that fits already stays.
    FitVelocity {
        /// The limit, m/s.
        limit: f64,
    },
    /// Similitude of a model built to a length scale under the same accelerations: time shrinks with the square root of
    /// the length, velocity with it, displacement with the length. The sampling interval shrinks with time.
    Similitude {
        /// Length of the model over that of the prototype.
        length_scale: f64,
    },
}

/// Why a step cannot be done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ConditionError {
    /// A filter that cannot be made.
    #[error(transparent)]
    Filter(#[from] FilterError),
    /// A value out of its range.
    #[error("{what} {value}: expected {expected}")]
    OutOfRange {
        /// What the value is.
        what: &'static str,
        /// The value.
        value: f64,
        /// Its range.
        expected: &'static str,
    },
    /// Nothing to scale.
    #[error("a motion that is zero throughout cannot be scaled to a peak")]
    Zero,
    /// Fewer than two samples are left.
    #[error(
        "{what} leaves {samples} sample(s): expected at least two; keep a longer stretch, or check the sampling interval"
    )]
    TooShort {
        /// The step.
        what: &'static str,
        /// How many are left.
        samples: usize,
    },
    /// A stretch of time with nothing in it.
    #[error(
        "{from_s} to {to_s} s keeps {samples} sample(s): expected a stretch, first its begin and then its end, within 0 to {duration:.3} s"
    )]
    Outside {
        /// Its begin, s.
        from_s: f64,
        /// Its end, s.
        to_s: f64,
        /// Length of the motion, s.
        duration: f64,
        /// How many samples it has.
        samples: usize,
    },
    /// Numbers that no table and no controller can hold.
    #[error("step {step} makes the motion larger than any number that a controller holds (3.4e38), or none at all")]
    NotFinite {
        /// The step's number, from one.
        step: usize,
    },
    /// More samples than memory should be spent on.
    #[error("{what} makes {samples:.0} samples: expected at most {MAX_SAMPLES}")]
    TooLong {
        /// The step.
        what: &'static str,
        /// How many there would be.
        samples: f64,
    },
}

/// The most samples a step may make: over an hour at 1 kHz.
pub(crate) const MAX_SAMPLES: usize = 4_000_000;

/// Steps in their order.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Recipe {
    /// The steps.
    pub steps: Vec<Step>,
}

impl Recipe {
    /// The conditioning under which the paper's Table 1 comes out: the full record, linear between its samples, at
    /// `rate_hz`; 3 s of rest before and 5 s after; the causal 6th-order low-pass at 4.7 Hz that the paper's references
    /// look like; a 0.05 Hz 2nd-order zero-phase high-pass on acceleration and velocity.
    ///
    /// At 1 kHz the low-pass alone gives peaks of 0.739, 0.280 and 0.132 g for KJM000, IELC180 and TAF021, the paper's.
    pub fn table1(rate_hz: f64) -> Self {
        Self {
            steps: vec![
                Step::Resample { rate_hz, between: Interpolation::Linear },
                Step::Rest { before_s: 3.0, after_s: 5.0 },
                Step::Filter { filter: Butterworth::low_pass(6, 4.7), pass: Pass::Causal },
                Step::HighPassMotion { corner_hz: 0.05, order: 2 },
            ],
        }
    }

    /// What Table 1 does to the table's response before it is compared: a 15 Hz 4th-order zero-phase low-pass.
    pub fn table1_response() -> Butterworth {
        Butterworth::low_pass(4, 15.0)
    }

    /// The conditioning for fitting a record to a table's limits: 200 Hz, the first 40 s, 3 s of rest before and 5 s
    /// after, a 0.1 Hz 2nd-order zero-phase high-pass on acceleration and velocity. `peak` (m/s²), where given, is what
    /// the record is scaled to before the high-pass.
    pub fn fitting(peak: Option<f64>) -> Self {
        let mut steps = vec![Step::Trim { from_s: 0.0, to_s: 40.0 }];
        steps.extend(peak.map(|peak| Step::ScaleToPeak { peak }));
        steps.push(Step::Resample { rate_hz: 200.0, between: Interpolation::Linear });
        steps.push(Step::Rest { before_s: 3.0, after_s: 5.0 });
        steps.push(Step::HighPassMotion { corner_hz: 0.1, order: 2 });
        Self { steps }
    }

    /// What a record is made into for a specimen: its own rate, 200 Hz at least, linear between its samples; 3 s of rest before
    /// and 5 s after; a 0.1 Hz 2nd-order zero-phase high-pass on acceleration and velocity. `dt` is the record's, s.
    pub fn specimen(dt: f64) -> Self {
        let rate_hz = (1.0 / dt).max(200.0);
        Self {
            steps: vec![
                Step::Resample { rate_hz, between: Interpolation::Linear },
                Step::Rest { before_s: 3.0, after_s: 5.0 },
                Step::HighPassMotion { corner_hz: 0.1, order: 2 },
            ],
        }
    }

    /// [`Recipe::specimen`] in words.
    pub const SPECIMEN: &'static str = "at 200 Hz or the record's own rate, 3 s of rest before and 5 s after, 0.1 Hz 2nd-order zero-phase \
                                        high-pass on acceleration and velocity";

    /// Applies the steps to a record.
    pub fn apply(&self, record: &Record) -> Result<Motion, ConditionError> {
        self.apply_to(record.motion())
    }

    /// Applies the steps to a motion.
    pub fn apply_to(&self, motion: Motion) -> Result<Motion, ConditionError> {
        self.steps.iter().zip(1..).try_fold(motion, |motion, (step, number)| {
            let made = step.apply(motion)?;
            let signals = [&made.acceleration, &made.velocity, &made.displacement];
            // The core reads the reference in f32.
            let holds = signals.into_iter().flatten().all(|value| (*value as f32).is_finite());
            if holds { Ok(made) } else { Err(ConditionError::NotFinite { step: number }) }
        })
    }
}

impl Step {
    /// Does this step to a motion.
    pub fn apply(&self, motion: Motion) -> Result<Motion, ConditionError> {
        let dt = motion.dt;
        match self {
            Self::Baseline { degree } => {
                Ok(Motion::from_acceleration(dt, baseline::acceleration(&motion, degree_in_range(*degree, 0)?)))
            }
            Self::VelocityBaseline { degree } => {
                Ok(Motion::from_acceleration(dt, baseline::velocity(&motion, degree_in_range(*degree, 1)?)))
            }
            Self::Trim { from_s, to_s } => trim(&motion, *from_s, *to_s),
            Self::Rest { before_s, after_s } => rest(&motion, *before_s, *after_s),
            Self::Resample { rate_hz, between } => resampled(motion, *rate_hz, *between),
            Self::Filter { filter, pass } => {
                Ok(Motion::from_acceleration(dt, filter.apply(&motion.acceleration, dt, *pass)?))
            }
            Self::HighPassMotion { corner_hz, order } => high_pass(&motion, Butterworth::high_pass(*order, *corner_hz)),
            Self::Scale { factor } if factor.is_finite() => Ok(motion.scaled(*factor)),
            Self::Scale { factor } => {
                Err(ConditionError::OutOfRange { what: "factor", value: *factor, expected: "a finite number" })
            }
            Self::ScaleToPeak { peak: wanted } => {
                positive("peak acceleration", *wanted)?;
                let found = peak(&motion.acceleration);
                if found > 0.0 { Ok(motion.scaled(wanted / found)) } else { Err(ConditionError::Zero) }
            }
            Self::FitStroke { stroke } => Ok(fitted(&motion, peak(&motion.displacement), positive("stroke", *stroke)?)),
            Self::FitVelocity { limit } => {
                Ok(fitted(&motion, peak(&motion.velocity), positive("velocity limit", *limit)?))
            }
            Self::Similitude { length_scale } => {
                let length_scale = positive("length scale", *length_scale)?;
                Ok(Motion::from_acceleration(dt * length_scale.sqrt(), motion.acceleration))
            }
        }
    }
}

/// A peak acceleration with its unit, such as `0.74g`, `7.2 m/s2` or `350 gal`, in m/s².
pub fn peak_acceleration(text: &str) -> Result<f64, PeakError> {
    let text = text.trim();
    let plain =
        |text: &str| text.find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-'))).unwrap_or(text.len());
    let mut end = plain(text);
    // An exponent: no unit begins with e and a digit.
    if let Some(rest) = text[end..].strip_prefix(['e', 'E'])
        && rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-'))
    {
        end += 1 + plain(rest);
    }
    let (number, unit) = text.split_at(end);
    if unit.trim().is_empty() {
        return Err(PeakError::NoUnit(text.to_owned()));
    }
    let value: f64 = number.parse().map_err(|_| PeakError::Number(text.to_owned()))?;
    let peak = value * unit.parse::<AccelerationUnit>()?.in_si();
    match peak {
        p if p > LARGEST_PEAK => Err(PeakError::TooLarge(text.to_owned())),
        p if p > 0.0 => Ok(p),
        _ => Err(PeakError::Number(text.to_owned())),
    }
}

/// Largest peak acceleration that a motion is scaled to, m/s2.
const LARGEST_PEAK: f64 = 1e4;

/// Why a text is no peak acceleration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PeakError {
    /// It does not begin with a positive number.
    #[error("`{0}`: expected a positive number and a unit, such as 0.74g or 7.2m/s2")]
    Number(String),
    /// It is beyond any table.
    #[error("`{0}`: expected at most 1e4 m/s2 (1020 g)")]
    TooLarge(String),
    /// It has no unit.
    #[error("`{0}` has no unit: say 0.74g or 7.2m/s2")]
    NoUnit(String),
    /// The unit is not known.
    #[error(transparent)]
    Unit(#[from] UnknownUnit),
}

fn positive(what: &'static str, value: f64) -> Result<f64, ConditionError> {
    let expected = "a finite number over 0";
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(ConditionError::OutOfRange { what, value, expected }) }
}

fn degree_in_range(degree: usize, lowest: usize) -> Result<usize, ConditionError> {
    if (lowest..=6).contains(&degree) {
        return Ok(degree);
    }
    let (value, expected) = (degree as f64, if lowest == 0 { "0 to 6" } else { "1 to 6" });
    Err(ConditionError::OutOfRange { what: "degree", value, expected })
}

fn fitted(motion: &Motion, found: f64, limit: f64) -> Motion {
    motion.scaled(if found > limit { limit / found } else { 1.0 })
}

fn trim(motion: &Motion, from_s: f64, to_s: f64) -> Result<Motion, ConditionError> {
    let index = |t: f64| (t.max(0.0) / motion.dt).round().min(motion.len() as f64) as usize;
    // The sample at the end belongs to the stretch.
    let (from, to) = (index(from_s), index(to_s).saturating_add(1).min(motion.len()));
    let part = motion.acceleration.get(from..to).unwrap_or(&[]);
    if part.len() < 2 {
        return Err(ConditionError::Outside { from_s, to_s, duration: motion.duration(), samples: part.len() });
    }
    Ok(Motion::from_acceleration(motion.dt, part.to_vec()))
}

fn rest(motion: &Motion, before_s: f64, after_s: f64) -> Result<Motion, ConditionError> {
    for value in [before_s, after_s] {
        if value.is_nan() || value < 0.0 {
            return Err(ConditionError::OutOfRange { what: "rest", value, expected: "0 s or more" });
        }
    }
    let samples = motion.len() as f64 + (before_s + after_s) / motion.dt;
    within_memory("rest", samples)?;
    let zeros = |s: f64| std::iter::repeat_n(0.0, (s / motion.dt).round() as usize);
    let padded = zeros(before_s).chain(motion.acceleration.iter().copied()).chain(zeros(after_s)).collect();
    Ok(Motion::from_acceleration(motion.dt, padded))
}

fn within_memory(what: &'static str, samples: f64) -> Result<(), ConditionError> {
    if samples <= MAX_SAMPLES as f64 { Ok(()) } else { Err(ConditionError::TooLong { what, samples }) }
}

fn resampled(motion: Motion, rate_hz: f64, between: Interpolation) -> Result<Motion, ConditionError> {
    let to = 1.0 / positive("sampling rate", rate_hz)?;
    within_memory("resampling", motion.duration() * rate_hz)?;
    if ((to - motion.dt) / motion.dt).abs() < 1e-9 {
        return Ok(motion);
    }
    // Before and not after: the sinc of a rate far below one sample in the whole motion has no end.
    if motion.duration() * rate_hz < 1.0 - 1e-6 {
        return Err(ConditionError::TooShort { what: "resampling", samples: 1 });
    }
    Ok(Motion::from_acceleration(to, resample(&motion.acceleration, motion.dt, to, between)))
}

/// The high-pass on acceleration and then velocity. What the second pass takes out of the velocity is slow, so that its
/// derivative is exact by central differences; taken out of the acceleration, the three stay each other's integrals.
fn high_pass(motion: &Motion, filter: Butterworth) -> Result<Motion, ConditionError> {
    let dt = motion.dt;
    let once = Motion::from_acceleration(dt, filter.apply(&motion.acceleration, dt, Pass::ZeroPhase)?);
    let velocity = filter.apply(&once.velocity, dt, Pass::ZeroPhase)?;
    let slow: Vec<f64> = once.velocity.iter().zip(&velocity).map(|(v, kept)| v - kept).collect();
    let slope = central_difference(&slow, dt);
    let acceleration = once.acceleration.iter().zip(&slope).map(|(a, s)| a - s).collect();
    Ok(Motion::from_state(dt, acceleration, 0.0, velocity.first().copied().unwrap_or(0.0)))
}

#[cfg(test)]
mod tests;
