//! Frequency response: from sines the paper's way, from any record, from multisines with their distortion; and transfer
//! functions fitted to it.
//!
//! | given | use | gives |
//! |---|---|---|
//! | sines held at one frequency and a real amplitude (Figs. 4, 5, 10) | [`sine`] | gain, phase, distortion at each |
//! | an earthquake, a random motion | [`multitaper`] | response, coherence, standard deviation |
//! | a short or transient record | [`local`] | response free of leakage, noise power |
//! | periods of a multisine that leaves lines out | [`multisine`] | best linear approximation, odd and even distortion |
//! | any of these | [`transfer`] | `b(s)/a(s)`, delay, standard errors, order by hold-out data |

use realfft::num_complex::Complex64;

pub(crate) mod local;
pub(crate) mod multisine;
pub(crate) mod multitaper;
pub(crate) mod sine;
pub(crate) mod transfer;

/// A measured frequency response.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Response {
    /// Its points, by rising frequency.
    pub points: Vec<Point>,
}

/// One frequency of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Hz.
    pub frequency: f64,
    /// Output over input.
    pub value: Complex64,
    /// Standard deviation of the value: of its real and of its imaginary part alike, each this over sqrt(2).
    pub std: f64,
    /// Part of the output's power that a linear system driven by the input accounts for, 0 to 1.
    pub coherence: f64,
}

impl Point {
    /// Gain in decibels.
    pub fn decibels(&self) -> f64 {
        20.0 * self.value.norm().log10()
    }

    /// Phase in degrees, -180 to 180.
    pub fn degrees(&self) -> f64 {
        self.value.arg().to_degrees()
    }
}

impl Response {
    /// The points whose coherence reaches `least` and whose frequency lies in the band, Hz.
    #[must_use]
    pub fn within(&self, from_hz: f64, to_hz: f64, least: f64) -> Self {
        let kept = |p: &&Point| (from_hz..=to_hz).contains(&p.frequency) && p.coherence >= least;
        Self { points: self.points.iter().filter(kept).copied().collect() }
    }

    /// Phases in degrees without jumps of a whole turn.
    pub fn unwrapped_degrees(&self) -> Vec<f64> {
        let mut last = 0.0;
        self.points
            .iter()
            .map(|p| {
                let here = p.degrees();
                last = here - 360.0 * ((here - last) / 360.0).round();
                last
            })
            .collect()
    }

    /// The response times `(j 2 pi f)^power`: +1 turns displacement into velocity, -1 back.
    #[must_use]
    pub fn times_s(&self, power: i32) -> Self {
        let points = self.points.iter().map(|p| {
            let s = laplace(p.frequency).powi(power);
            Point { value: p.value * s, std: p.std * s.norm(), ..*p }
        });
        Self { points: points.collect() }
    }
}

/// `s` at a frequency in Hz.
pub(crate) fn laplace(frequency: f64) -> Complex64 {
    Complex64::new(0.0, 2.0 * std::f64::consts::PI * frequency)
}

/// Why no response can be given.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResponseError {
    /// Input and output of different length.
    #[error("input has {input} samples and output {output}")]
    Lengths {
        /// Samples of the input.
        input: usize,
        /// Samples of the output.
        output: usize,
    },
    /// Samples that are no numbers.
    #[error("sample {at} is not a number; fill or cut the gap first")]
    NotANumber {
        /// The first such sample.
        at: usize,
    },
    /// Too few samples or points for what is asked.
    #[error("{found} {what}; at least {least} are needed")]
    TooFew {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        least: usize,
    },
    /// An input that is nothing at the frequencies asked for.
    #[error("the input carries nothing at {frequency} Hz")]
    NotDriven {
        /// Hz.
        frequency: f64,
    },
    /// A frequency that sampling cannot hold.
    #[error("{frequency} Hz does not lie between zero and half the sampling rate, {nyquist} Hz")]
    OutOfBand {
        /// Hz.
        frequency: f64,
        /// Half the sampling rate, Hz.
        nyquist: f64,
    },
    /// Equations that determine nothing.
    #[error("the points do not determine a transfer function of this order")]
    Singular,
}

/// Checks that two signals can be compared.
fn check(input: &[f64], output: &[f64], least: usize) -> Result<(), ResponseError> {
    if input.len() != output.len() {
        return Err(ResponseError::Lengths { input: input.len(), output: output.len() });
    }
    if let Some(at) = input.iter().zip(output).position(|(u, y)| !(u.is_finite() && y.is_finite())) {
        return Err(ResponseError::NotANumber { at });
    }
    if input.len() < least {
        return Err(ResponseError::TooFew { what: "samples", found: input.len(), least });
    }
    Ok(())
}

/// Discrete Fourier transform of a real signal, bins zero to half.
fn transform(samples: &[f64]) -> Vec<Complex64> {
    let fft = realfft::RealFftPlanner::<f64>::new().plan_fft_forward(samples.len());
    let mut buffer = samples.to_vec();
    let mut spectrum = fft.make_output_vec();
    // Lengths agree by construction, which is all that can fail.
    let _ = fft.process(&mut buffer, &mut spectrum);
    spectrum
}

#[cfg(test)]
mod tests;
