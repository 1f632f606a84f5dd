//! Gains by weighted least squares for each delay and lag; delay and lags by search.

use nalgebra::{Complex, DMatrix, DVector};

/// Target and terms of one log, bin by bin.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// rad/s.
    pub(super) omega: Vec<f64>,
    pub(super) target: Vec<Complex<f64>>,
    pub(super) terms: Vec<Vec<Complex<f64>>>,
    /// One over the power of what is no signal.
    pub(super) weight: Vec<f64>,
}

/// Delay and lags, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Timing {
    pub(super) delay: f64,
    pub(super) lag: f64,
    /// Lag of the velocity's own filter.
    pub(super) velocity: f64,
}

/// What is to be fitted.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    parts: Vec<Part>,
    /// Which term is the velocity, where one is.
    velocity: Option<usize>,
}

/// A fit; values of terms that take no part are 0.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) gains: Vec<f64>,
    pub(super) std: Vec<f64>,
    /// Weighted RMS of each contribution over that of the target.
    pub(super) share: Vec<f64>,
    pub(super) timing: Timing,
    /// RMS of the residual over RMS of the target, not weighted.
    pub(super) misses: f64,
    /// Weighted sum of the squares of the residual.
    pub(super) squares: f64,
}

/// Delays searched, s: a command may be logged before the displacement that made it.
const DELAYS: (f64, f64) = (-0.004, 0.04);
/// Lags searched, s, and the longest.
const LAGS: [f64; 7] = [0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.06];
const LONGEST: f64 = 0.2;
/// Longest lag of a velocity's filter, s.
const FILTER: f64 = 0.01;
/// Step of the first search, s.
const STEP: f64 = 0.001;

impl Problem {
    pub(super) fn new(parts: Vec<Part>, velocity: Option<usize>) -> Self {
        Self { parts, velocity }
    }

    /// How many values the target has, real and imaginary parts counted.
    pub(super) fn count(&self) -> f64 {
        self.parts.iter().map(|p| 2.0 * p.target.len() as f64).sum()
    }

    /// Frequencies, rad/s, between which equal shares of the target's weighted power lie.
    pub(super) fn edges(&self, stretches: usize) -> Vec<f64> {
        let power = |p: &Part| -> Vec<(f64, f64)> {
            let bins = p.omega.iter().zip(&p.target).zip(&p.weight);
            bins.map(|((omega, target), weight)| (*omega, weight * target.norm_sqr())).collect()
        };
        let mut bins: Vec<(f64, f64)> = self.parts.iter().flat_map(power).collect();
        bins.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = bins.iter().map(|(_, p)| p).sum();
        let (mut edges, mut sum) = (vec![0.0], 0.0);
        for (omega, power) in bins {
            sum += power;
            if sum >= total * edges.len() as f64 / stretches as f64 && edges.len() < stretches {
                edges.push(omega);
            }
        }
        edges.push(f64::INFINITY);
        edges
    }

    /// The same without the bins above one frequency up to another, rad/s.
    pub(super) fn without(&self, above: f64, up_to: f64) -> Self {
        let mut rest = self.clone();
        for part in &mut rest.parts {
            for (omega, weight) in part.omega.iter().zip(&mut part.weight) {
                if *omega > above && *omega <= up_to {
                    *weight = 0.0;
                }
            }
        }
        rest
    }

    /// How much of the target goes along with a term.
    pub(super) fn along(&self, term: usize) -> f64 {
        let part = |p: &Part| -> f64 { p.target.iter().zip(&p.terms[term]).map(|(t, x)| (t * x.conj()).re).sum() };
        self.parts.iter().map(part).sum()
    }

    /// The best fit of some terms from everywhere: by a delay alone, or with a lag.
    pub(super) fn search(&self, active: &[bool], lag: bool) -> Option<Fitted> {
        let steps = ((DELAYS.1 - DELAYS.0) / STEP).round() as usize;
        let delays: Vec<f64> = (0..=steps).map(|k| DELAYS.0 + STEP * k as f64).collect();
        let lags: &[f64] = if lag { &LAGS } else { &[0.0] };
        let tried = lags.iter().flat_map(|&lag| {
            delays.iter().filter_map(move |&delay| self.at(active, Timing { delay, lag, velocity: 0.0 }))
        });
        let start = tried.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
        Some(self.refined(active, start, lag))
    }

    /// The best fit of some terms from a timing on.
    pub(super) fn near(&self, active: &[bool], timing: Timing, lag: bool) -> Option<Fitted> {
        let timing = if lag { timing } else { Timing { lag: 0.0, ..timing } };
        self.at(active, timing).map(|start| self.refined(active, start, lag))
    }

    /// Compass search from a fit, steps halved to eight microseconds.
    fn refined(&self, active: &[bool], start: Fitted, lag: bool) -> Fitted {
        let (mut best, mut step) = (start, STEP);
        let filtered = self.velocity.is_some_and(|i| active[i]);
        while step > 8e-6 {
            let mut moves = vec![(step, 0.0, 0.0), (-step, 0.0, 0.0)];
            if lag {
                moves.extend([(0.0, step, 0.0), (0.0, -step, 0.0), (step, -step, 0.0), (-step, step, 0.0)]);
            }
            if filtered {
                moves.extend([(0.0, 0.0, step), (0.0, 0.0, -step), (step, 0.0, -step), (-step, 0.0, step)]);
            }
            let tried = moves.iter().filter_map(|(d, l, v)| {
                let t = best.timing;
                let t = Timing { delay: t.delay + d, lag: t.lag + l, velocity: t.velocity + v };
                let inside = (0.0..=LONGEST).contains(&t.lag)
                    && (0.0..=FILTER).contains(&t.velocity)
                    && (DELAYS.0..=DELAYS.1).contains(&t.delay);
                inside.then(|| self.at(active, t)).flatten()
            });
            match tried.min_by(|a, b| a.squares.total_cmp(&b.squares)) {
                Some(better) if better.squares < best.squares => best = better,
                _ => step /= 2.0,
            }
        }
        best
    }

    /// Weights the bins by what a fit leaves, smoothed over a sixth of an octave: noise counts where it is.
    pub(super) fn weigh(&mut self, fitted: &Fitted, active: &[bool]) {
        for part in &mut self.parts {
            let rest: Vec<f64> = residual(part, fitted, active, self.velocity).iter().map(Complex::norm_sqr).collect();
            let mut sums = vec![0.0; rest.len() + 1];
            rest.iter().enumerate().for_each(|(k, r)| sums[k + 1] = sums[k] + r);
            let whole = sums[rest.len()] / rest.len().max(1) as f64;
            let Some(first) = part.omega.first().copied() else { continue };
            let width = part.omega.get(1).map_or(first, |w| w - first);
            for (k, omega) in part.omega.iter().enumerate() {
                let half = (0.06 * omega / width).ceil().max(6.0) as usize;
                let (from, to) = (k.saturating_sub(half), (k + half + 1).min(rest.len()));
                let power = (sums[to] - sums[from]) / (to - from) as f64;
                part.weight[k] = 1.0 / power.max(1e-6 * whole).max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Weighted least squares at one timing.
    fn at(&self, active: &[bool], timing: Timing) -> Option<Fitted> {
        let which: Vec<usize> = (0..active.len()).filter(|i| active[*i]).collect();
        let n = which.len();
        let (mut matrix, mut right) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
        let mut size = 0.0;
        let mut row = vec![Complex::new(0.0, 0.0); n];
        for part in &self.parts {
            for (k, (omega, target)) in part.omega.iter().zip(&part.target).enumerate() {
                let filter = timing.filter(*omega);
                // The target against the filter, so that the terms stay as they are.
                let (turned, power, weight) = (target * filter.conj(), filter.norm_sqr(), part.weight[k]);
                for (a, &i) in which.iter().enumerate() {
                    row[a] = part.terms[i][k];
                    if Some(i) == self.velocity {
                        row[a] /= Complex::new(1.0, omega * timing.velocity);
                    }
                }
                for (a, x) in row.iter().enumerate() {
                    right[a] += weight * (x.re * turned.re + x.im * turned.im);
                    for (b, y) in row.iter().enumerate().skip(a) {
                        matrix[(a, b)] += weight * power * (x.re * y.re + x.im * y.im);
                    }
                }
                size += weight * target.norm_sqr();
            }
        }
        for a in 0..n {
            for b in 0..a {
                matrix[(a, b)] = matrix[(b, a)];
            }
        }
        let scale: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
        if scale.iter().any(|s| !s.is_normal()) {
            return None;
        }
        let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (scale[i] * scale[j]));
        let unit = DVector::from_fn(n, |i, _| right[i] / scale[i]);
        let inverse = scaled.cholesky()?.inverse();
        let solution = &inverse * &unit;
        let squares = (size - solution.dot(&unit)).max(1e-14 * size);
        let variance = squares / f64::max(self.count() - n as f64, 1.0);
        let spread = |values: &dyn Fn(usize) -> f64| {
            let mut all = vec![0.0; active.len()];
            which.iter().enumerate().for_each(|(a, &i)| all[i] = values(a));
            all
        };
        let mut fitted = Fitted {
            gains: spread(&|a| solution[a] / scale[a]),
            std: spread(&|a| (variance * inverse[(a, a)].max(0.0)).sqrt() / scale[a]),
            share: spread(&|a| solution[a].abs() / size.sqrt()),
            timing,
            misses: f64::NAN,
            squares,
        };
        fitted.misses = (squares / size).sqrt();
        Some(fitted)
    }

    /// RMS of what a fit leaves over RMS of the target, up to a frequency (rad/s), not weighted.
    pub(super) fn missed(&self, fitted: &Fitted, active: &[bool], up_to: f64) -> f64 {
        let (mut left, mut all) = (0.0, 0.0);
        for part in &self.parts {
            let rest = residual(part, fitted, active, self.velocity);
            for ((omega, target), r) in part.omega.iter().zip(&part.target).zip(&rest) {
                if *omega <= up_to {
                    left += r.norm_sqr();
                    all += target.norm_sqr();
                }
            }
        }
        (left / all.max(f64::MIN_POSITIVE)).sqrt()
    }
}

impl Timing {
    fn filter(&self, omega: f64) -> Complex<f64> {
        Complex::from_polar(1.0, -omega * self.delay) / Complex::new(1.0, omega * self.lag)
    }
}

/// What a fit leaves of a part's target.
fn residual(part: &Part, fitted: &Fitted, active: &[bool], velocity: Option<usize>) -> Vec<Complex<f64>> {
    let own = |i: usize, omega: f64| {
        if Some(i) == velocity {
            Complex::new(1.0, omega * fitted.timing.velocity).inv()
        } else {
            Complex::new(1.0, 0.0)
        }
    };
    let explained = |k: usize, omega: f64| -> Complex<f64> {
        let sum: Complex<f64> =
            (0..active.len()).filter(|i| active[*i]).map(|i| part.terms[i][k] * own(i, omega) * fitted.gains[i]).sum();
        sum * fitted.timing.filter(omega)
    };
    part.omega.iter().zip(&part.target).enumerate().map(|(k, (omega, target))| target - explained(k, *omega)).collect()
}
