//! Coloured noise as an autoregression, `x[k] = sum_i a_i x[k-i] + e[k]`.

#[cfg(test)]
use std::f64::consts::PI;

/// An autoregression; without coefficients it is white noise.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Autoregression {
    /// The coefficients `a_1, a_2, ...`
    pub coefficients: Vec<f64>,
    /// Standard deviation of the innovation e, the samples' unit.
    pub innovation: f64,
}

impl Autoregression {
    /// Fits by Burg's method, the order up to `highest` chosen by the Bayesian information criterion.
    ///
    /// Source: J. P. Burg, "Maximum entropy spectral analysis", 1975.
    pub(crate) fn fit(samples: &[f64], highest: usize) -> Self {
        let n = samples.len() as f64;
        let cost = |fit: &Self| {
            n * (fit.innovation.powi(2)).max(f64::MIN_POSITIVE).ln() + n.ln() * fit.coefficients.len() as f64
        };
        burg(samples, highest)
            .into_iter()
            .min_by(|a, b| cost(a).total_cmp(&cost(b)))
            .unwrap_or(Self { coefficients: Vec::new(), innovation: 0.0 })
    }
}

/// What tests hold a fit against.
#[cfg(test)]
impl Autoregression {
    /// The innovations behind samples: white where the samples are of this colour. The first ones, before the past is
    /// long enough, use what past there is.
    pub(crate) fn whitened(&self, samples: &[f64]) -> Vec<f64> {
        (0..samples.len())
            .map(|k| {
                let past = self.coefficients.iter().zip(samples[..k].iter().rev());
                samples[k] - past.map(|(a, x)| a * x).sum::<f64>()
            })
            .collect()
    }

    /// One-sided power spectral density at a frequency in Hz, the samples' unit squared per Hz.
    pub(crate) fn power(&self, frequency: f64, dt: f64) -> f64 {
        let phase = 2.0 * PI * frequency * dt;
        let (re, im) = self.coefficients.iter().zip(1..).fold((1.0, 0.0), |(re, im), (a, i): (&f64, i32)| {
            (re - a * (f64::from(i) * phase).cos(), im + a * (f64::from(i) * phase).sin())
        });
        2.0 * dt * self.innovation.powi(2) / (re * re + im * im)
    }
}

/// Fits of every order from zero up, each from the one before.
fn burg(samples: &[f64], highest: usize) -> Vec<Autoregression> {
    let n = samples.len();
    if n == 0 {
        return Vec::new();
    }
    let (mut forward, mut backward) = (samples.to_vec(), samples.to_vec());
    let mut power = samples.iter().map(|x| x * x).sum::<f64>() / n as f64;
    let mut coefficients: Vec<f64> = Vec::new();
    let mut fits = vec![Autoregression { coefficients: Vec::new(), innovation: power.sqrt() }];
    for order in 1..=highest.min(n / 2) {
        let (mut product, mut energy) = (0.0, 0.0);
        for k in order..n {
            product += forward[k] * backward[k - 1];
            energy += forward[k].powi(2) + backward[k - 1].powi(2);
        }
        if energy <= 0.0 {
            break;
        }
        let reflection = 2.0 * product / energy;
        for k in (order..n).rev() {
            let (f, b) = (forward[k], backward[k - 1]);
            forward[k] = f - reflection * b;
            backward[k] = b - reflection * f;
        }
        let reversed: Vec<f64> = coefficients.iter().rev().copied().collect();
        coefficients.iter_mut().zip(reversed).for_each(|(a, r)| *a -= reflection * r);
        coefficients.push(reflection);
        power *= 1.0 - reflection * reflection;
        fits.push(Autoregression { coefficients: coefficients.clone(), innovation: power.max(0.0).sqrt() });
    }
    fits
}
