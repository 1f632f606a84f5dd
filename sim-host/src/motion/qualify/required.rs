//! A required response spectrum: straight lines between points, both axes logarithmic.

use super::Standard;

/// What a motion is made for and judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement<'a> {
    /// The rules.
    pub standard: &'a Standard,
    /// The spectrum to be reached.
    pub required: &'a Required,
    /// The lowest frequency that is judged, Hz.
    pub lowest: f64,
}

/// A required response spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct Required {
    /// Damping ratio of the oscillators, 1.
    pub damping: f64,
    /// Frequency, Hz, and required spectral acceleration, m/s2, rising in frequency; beyond the last point its value holds.
    pub points: Vec<(f64, f64)>,
}

impl Required {
    /// What is required at a frequency, Hz; none below the first point.
    pub fn at(&self, frequency: f64) -> Option<f64> {
        let after = self.points.partition_point(|(f, _)| *f <= frequency);
        let (f, a) = *self.points.get(after.checked_sub(1)?)?;
        let Some(&(g, b)) = self.points.get(after) else { return Some(a) };
        Some(a * (b / a).powf((frequency / f).ln() / (g / f).ln()))
    }

    /// The zero-period acceleration, m/s2: what is required at the highest frequency.
    pub fn zero_period(&self) -> f64 {
        self.points.last().map_or(0.0, |(_, a)| *a)
    }

    /// Reads pairs of numbers, a line each, `frequency [Hz], acceleration [g]`; lines that begin with no number are skipped
    /// before the first pair.
    pub fn parse(text: &str, damping: f64) -> Result<Self, String> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        for (number, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())) {
            if line.is_empty() || line.starts_with('#') {
                continue;
            }
            let fields: Vec<&str> = line.split([',', ';', '\t', ' ']).filter(|field| !field.is_empty()).collect();
            let values: Vec<f64> = fields.iter().filter_map(|field| field.parse().ok()).collect();
            match values[..] {
                [f, a] if fields.len() == 2 && f > 0.0 && a > 0.0 && f.is_finite() && a.is_finite() => {
                    if points.last().is_some_and(|(before, _)| *before >= f) {
                        return Err(format!(
                            "line {number}: {f} Hz does not rise above the line before; sort by frequency"
                        ));
                    }
                    points.push((f, a * super::super::STANDARD_GRAVITY));
                }
                _ if points.is_empty() && values.is_empty() => {}
                _ => {
                    return Err(format!(
                        "line {number}: `{}` is no pair of frequency [Hz] and acceleration [g], both above zero",
                        line.chars().take(40).collect::<String>()
                    ));
                }
            }
        }
        if points.len() < 2 {
            return Err("holds fewer than two pairs of frequency [Hz] and acceleration [g]".into());
        }
        Ok(Self { damping, points })
    }
}
