//! Frames: what a page is sent some twenty times a second, as JSON.

use std::fmt::Write as _;

use super::bench::{Sample, Status};
use super::spectra::Spectra;

/// Frames between two that carry spectra.
const SPECTRA_EVERY: u64 = 20;

/// Samples since the last frame, and the spectra so far.
pub(super) struct Frames {
    samples: Vec<Sample>,
    spectra: Spectra,
    number: u64,
    segments: Option<u32>,
}

impl Frames {
    /// Of samples at `rate`, Hz.
    pub(super) fn new(rate: f64) -> Self {
        Self { samples: Vec::new(), spectra: Spectra::new(rate), number: 0, segments: None }
    }

    /// Takes samples.
    pub(super) fn take(&mut self, samples: &[Sample]) {
        for sample in samples {
            self.spectra.take(sample);
        }
        self.samples.extend_from_slice(samples);
    }

    /// The next frame: everything since the last.
    pub(super) fn next(&mut self, status: &Status) -> String {
        self.number += 1;
        let mut text = String::with_capacity(256 + 60 * self.samples.len());
        let _ = write!(text, "{{\"frame\":{}", self.number);
        let samples = &self.samples;
        array(&mut text, "time", samples, 4, |s| s.time);
        array(&mut text, "reference", samples, 3, |s| 1e3 * s.reference);
        array(&mut text, "modified", samples, 3, |s| 1e3 * s.modified);
        array(&mut text, "displacement", samples, 3, |s| 1e3 * s.displacement);
        array(&mut text, "acceleration", samples, 3, |s| s.acceleration);
        array(&mut text, "command", samples, 3, |s| 1e3 * s.command);
        array(&mut text, "gap", samples, 0, |s| f64::from(s.gap));
        array(&mut text, "flags", samples, 0, |s| {
            f64::from(u8::from(s.saturated) + 2 * u8::from(s.limited) + 4 * u8::from(s.held))
        });
        if let Ok(status) = serde_json::to_string(status) {
            let _ = write!(text, ",\"status\":{status}");
        }
        if self.number.is_multiple_of(SPECTRA_EVERY) {
            self.spectra(&mut text);
        }
        text.push('}');
        self.samples.clear();
        text
    }

    /// The spectra, where they are others than the page has.
    fn spectra(&mut self, text: &mut String) {
        let shown = self.spectra.shown();
        let segments = shown.as_ref().map(|shown| shown.segments);
        if let (Some(shown), true) = (&shown, segments != self.segments)
            && let Ok(shown) = serde_json::to_string(shown)
        {
            let _ = write!(text, ",\"spectra\":{shown}");
        }
        self.segments = segments;
    }
}

/// One value of every sample; what is no number is `null`.
fn array(text: &mut String, name: &str, samples: &[Sample], digits: usize, of: impl Fn(&Sample) -> f64) {
    let _ = write!(text, ",\"{name}\":[");
    for (k, value) in samples.iter().map(of).enumerate() {
        let comma = if k == 0 { "" } else { "," };
        let _ = if value.is_finite() { write!(text, "{comma}{value:.digits$}") } else { write!(text, "{comma}null") };
    }
    text.push(']');
}
