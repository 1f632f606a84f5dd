//! Mains hum: a narrow line at 50 or 60 Hz or a harmonic, or where sampling folds it to.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::{Spectra, quantile, segment_length, spectra};

/// A line must stand out from its neighbours by this factor in power.
const STANDS_OUT: f64 = 30.0;

/// Harmonics of the mains that are looked for.
const HARMONICS: [u32; 3] = [1, 2, 3];

/// Looks for the strongest line of the mains in every sensor.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    use Channel::{Acceleration, Displacement, PressureDifference, SpecimenAcceleration, Velocity};
    [Displacement, Velocity, Acceleration, PressureDifference, SpecimenAcceleration]
        .into_iter()
        .filter_map(|channel| finding(run, channel))
        .collect()
}

fn finding(run: &Run, channel: Channel) -> Option<Finding> {
    let samples = run.channel(channel)?;
    let segment = segment_length(samples.len(), (20.0 / run.dt) as usize);
    let power = spectra(samples, samples, run.dt, segment);
    let driven = run.channel(Channel::Reference).map(|r| spectra(r, r, run.dt, segment));
    if power.segments < 4 {
        return None;
    }
    let mains = [50.0, 60.0].into_iter().flat_map(|f| HARMONICS.map(|h| (f, f64::from(h))));
    let lines = mains.filter_map(|(mains, harmonic)| {
        let folded = fold(mains * harmonic, 1.0 / run.dt);
        let line = Line::at(&power, folded)?;
        let also_driven = driven.as_ref().and_then(|d| Line::at(d, folded)).is_some_and(|d| d.ratio > 10.0);
        (line.ratio > STANDS_OUT && !also_driven).then_some((mains * harmonic, folded, line))
    });
    let (true_hz, seen_hz, line) = lines.max_by(|a, b| a.2.amplitude.total_cmp(&b.2.amplitude))?;
    let folded = if (true_hz - seen_hz).abs() < 1e-6 {
        format!("{seen_hz:.1} Hz")
    } else {
        format!("{seen_hz:.2} Hz, where {:.1} Hz sampling folds {true_hz:.0} Hz to", 1.0 / run.dt)
    };
    Some(Finding::whole(run, channel, Fault::Hum, Severity::Remark).saying(
        format!("{channel} carries hum at {folded}, amplitude {:.3e} (SI)", line.amplitude),
        "check shields and earths, filter before sampling, or let the model carry `mains_hum`",
    ))
}

/// Where sampling puts a frequency, Hz.
fn fold(frequency: f64, rate: f64) -> f64 {
    (frequency - rate * (frequency / rate).round()).abs()
}

/// A narrow line of a spectrum.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Peak power over the median of the neighbours.
    ratio: f64,
    /// Amplitude of the sine that would make it.
    amplitude: f64,
}

impl Line {
    /// The line at a frequency; none where the spectrum does not reach there, or the bin next to it is not the peak of
    /// its surroundings.
    fn at(power: &Spectra, frequency: f64) -> Option<Self> {
        let width = power.frequency.get(1)?;
        let middle = (frequency / width).round() as usize;
        if middle < 12 || middle + 12 >= power.input.len() {
            return None;
        }
        let peak = (middle - 1..=middle + 1).max_by(|a, b| power.input[*a].total_cmp(&power.input[*b]))?;
        let around: Vec<f64> =
            (middle - 12..=middle + 12).filter(|k| k.abs_diff(peak) > 3).map(|k| power.input[k]).collect();
        let (floor, tallest) = (quantile(&around, 0.5), quantile(&around, 1.0));
        let above: f64 = (peak - 2..=peak + 2).map(|k| (power.input[k] - floor).max(0.0)).sum();
        let ratio =
            if tallest * 3.0 > power.input[peak] { 0.0 } else { power.input[peak] / floor.max(f64::MIN_POSITIVE) };
        Some(Self { ratio, amplitude: (2.0 * above * width).sqrt() })
    }
}
