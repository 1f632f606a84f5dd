//! A fit by frequency: the response from what drives a run to each channel, measured and simulated alike, and what is
//! left over against the noise floor.

use super::data::{Measured, Run};
use super::floor::share;
use super::frequency::multitaper::multitaper;
use super::frequency::{Response, ResponseError};
use crate::recording::signal::{filled, segment_length, spectra};

/// Windows of the response: each point smooths over `(TAPERS + 1) / (2 duration)` Hz to either side.
const TAPERS: usize = 12;

/// Power of the input over its strongest below which a frequency counts as not driven.
const DRIVEN: f64 = 1e-7;

/// Longest segment of a power spectrum, samples.
const LONGEST: usize = 4096;

/// The response from a run's input to one channel.
#[derive(Debug, Clone)]
pub(crate) struct Responses {
    /// Of the recording.
    pub measured: Response,
    /// Of the model, from its simulated samples.
    pub model: Response,
}

/// Power spectral densities of one channel, one-sided.
#[derive(Debug, Clone)]
pub(crate) struct Leftover {
    /// Frequencies, Hz.
    pub frequency: Vec<f64>,
    /// Of the recording, its unit squared per Hz.
    pub measured: Vec<f64>,
    /// Of the recording less the model.
    pub residual: Vec<f64>,
    /// Of white noise as strong as the floor.
    pub floor: f64,
}

/// Both responses of a channel where the input drives it; `model` holds one simulated value a sample.
pub(crate) fn responses(run: &Run, measured: &Measured, model: &[f64]) -> Result<Responses, ResponseError> {
    let drive = spectra(&run.input, &run.input, run.dt, segment_length(run.len(), LONGEST));
    let strongest = drive.input.iter().copied().fold(0.0, f64::max);
    let driven = |frequency: f64| {
        let bin = drive.frequency.partition_point(|f| *f < frequency);
        drive.input.get(bin).is_some_and(|power| *power > DRIVEN * strongest)
    };
    let of = |output: &[f64]| -> Result<Response, ResponseError> {
        let mut response = multitaper(&[(run.input.as_slice(), output)], run.dt, TAPERS)?;
        response.points.retain(|p| driven(p.frequency));
        Ok(response)
    };
    Ok(Responses { measured: of(&filled(&measured.values))?, model: of(&filled(model))? })
}

/// What the model leaves of a channel, by frequency.
pub(crate) fn leftover(run: &Run, measured: &Measured, model: &[f64]) -> Leftover {
    let residual: Vec<f64> = measured.values.iter().zip(model).map(|(y, m)| y - m).collect();
    let both = spectra(&filled(&residual), &filled(&measured.values), run.dt, segment_length(run.len(), LONGEST));
    let passed = run.filter.as_ref().map_or(1.0, |filter| share(filter, run.dt).powi(2));
    let floor = measured.noise.powi(2) * 2.0 * run.dt / passed;
    // The first bin holds what the trend's removal leaves.
    let from = 1.min(both.frequency.len());
    Leftover {
        frequency: both.frequency[from..].to_vec(),
        measured: both.output[from..].to_vec(),
        residual: both.input[from..].to_vec(),
        floor,
    }
}
