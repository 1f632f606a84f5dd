//! The relative error of Eq. 11 and 12, and the shift in time at which it is least.
//!
//! At whole samples the squared error of every shift comes from one correlation by FFT and running sums, exactly, the ends
//! of the response held where the shift reaches past them. Between samples the response is interpolated band-limited, which
//! makes the error a quadratic form of the interpolation's weights; it is minimised by golden section, to a ten-thousandth of a
//! sample, and what it comes to there is summed sample by sample.

use super::super::resample::{REACH, kernel};
use super::RelativeError;
use realfft::RealFftPlanner;
use std::ops::Range;

/// How the response may be shifted before it is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shift {
    /// Not at all.
    None,
    /// By the delay that makes the error least, within so many seconds to both sides.
    Free {
        /// The longest, s.
        max: f64,
    },
    /// By a delay known, s.
    By(f64),
}

/// The relative error of a response over a range of the reference's samples, both sampled every `dt` s.
pub(crate) fn relative_error(
    reference: &[f64],
    response: &[f64],
    dt: f64,
    range: Range<usize>,
    shift: Shift,
) -> RelativeError {
    let range = range.start.min(reference.len())..range.end.min(reference.len());
    if range.is_empty() || response.is_empty() {
        return RelativeError { ratio: f64::NAN, delay: 0.0 };
    }
    let lag = match shift {
        Shift::None => 0.0,
        Shift::By(delay) => delay / dt,
        Shift::Free { max } => best_lag(reference, response, &range, (max / dt).floor().max(0.0) as usize),
    };
    let wanted: f64 = reference[range.clone()].iter().map(|a| a * a).sum();
    let missed = squared_error(reference, response, &range, lag);
    let ratio = if missed == 0.0 { 0.0 } else { (missed / wanted).sqrt() };
    RelativeError { ratio, delay: lag * dt }
}

/// The lag of the response, in samples, at which the error is least.
fn best_lag(reference: &[f64], response: &[f64], range: &Range<usize>, max: usize) -> f64 {
    if max == 0 {
        return 0.0;
    }
    let errors = errors_at_whole_lags(reference, response, range, max);
    // The shortest shift wins where several are alike, as they are for a constant.
    let by_error =
        |&a: &usize, &b: &usize| errors[a].total_cmp(&errors[b]).then_with(|| a.abs_diff(max).cmp(&b.abs_diff(max)));
    let whole = (0..errors.len()).min_by(by_error).unwrap_or(max) as f64 - max as f64;
    let near = Near::new(reference, response, range, whole as isize);
    let limit = max as f64;
    let lag = golden_section(|lag| near.error(lag), (whole - 1.0).max(-limit), (whole + 1.0).min(limit));
    let error = |lag: f64| squared_error(reference, response, range, lag);
    if error(lag) < error(whole) { lag } else { whole }
}

/// The squared error within a sample of a whole lag, as a quadratic form of the weights: a look at it costs as much as they are many,
/// and not as the motion is long. It is good for where the least is, not for what it is: where nearly nothing is left, rounding is.
struct Near {
    /// The whole lag.
    whole: isize,
    /// Of the reference.
    wanted: f64,
    /// Products of the reference and the response at the lags `whole - REACH ..= whole + REACH`.
    products: Vec<f64>,
    /// Products of the response at one of these lags and at another, row by row.
    gram: Vec<f64>,
}

/// Lags that the weights of any lag within a sample reach.
const LAGS: usize = 2 * REACH + 1;

impl Near {
    fn new(reference: &[f64], response: &[f64], range: &Range<usize>, whole: isize) -> Self {
        let last = response.len().cast_signed() - 1;
        let first = range.start.cast_signed() + whole - REACH.cast_signed();
        let held = |i: usize| response[(first + i.cast_signed()).clamp(0, last).cast_unsigned()];
        let wide: Vec<f64> = (0..range.len() + LAGS).map(held).collect();
        let wanted = &reference[range.clone()];
        let dot = |a: &[f64], from: usize| a.iter().zip(&wide[from..]).map(|(a, y)| a * y).sum::<f64>();
        let products = (0..LAGS).map(|lag| dot(wanted, lag)).collect();
        let mut gram = vec![0.0; LAGS * LAGS];
        for (lag, product) in gram.iter_mut().take(LAGS).enumerate() {
            *product = dot(&wide[..range.len()], lag);
        }
        // The next row is of the same products, one sample on.
        for i in 1..LAGS {
            for j in i..LAGS {
                let end = range.len() - 1;
                let (gone, come) = (wide[i - 1] * wide[j - 1], wide[i + end] * wide[j + end]);
                gram[i * LAGS + j] = gram[(i - 1) * LAGS + j - 1] - gone + come;
            }
        }
        Self { whole, wanted: wanted.iter().map(|a| a * a).sum(), products, gram }
    }

    /// The squared error at a lag, in samples, within one of the whole.
    fn error(&self, lag: f64) -> f64 {
        let floor = lag.floor();
        let weights = weights(lag - floor);
        // The first weight is that of the sample `1 - REACH` after the floor's.
        let first = (floor as isize - self.whole + 1).clamp(0, 1).cast_unsigned();
        let mut sum = self.wanted;
        for (i, w) in (first..).zip(&weights) {
            let row = &self.gram[i * LAGS + i..(i + 1) * LAGS];
            let rest = &weights[i - first..];
            let across: f64 = row.iter().zip(rest).skip(1).map(|(g, u)| g * u).sum();
            sum += w * (row[0] * w + 2.0 * across - 2.0 * self.products[i]);
        }
        sum
    }
}

/// Squared errors at the lags `-max..=max`.
fn errors_at_whole_lags(reference: &[f64], response: &[f64], range: &Range<usize>, max: usize) -> Vec<f64> {
    let n = range.len();
    let last = response.len().cast_signed() - 1;
    let held = |i: isize| response[i.clamp(0, last).cast_unsigned()];
    // The response over the range widened by the longest lag to both sides.
    let wide: Vec<f64> = (0..n + 2 * max).map(|i| held((range.start + i).cast_signed() - max.cast_signed())).collect();
    let products = correlate(&reference[range.clone()], &wide, 2 * max + 1);
    let mut running = vec![0.0];
    for x in &wide {
        running.push(running[running.len() - 1] + x * x);
    }
    let wanted: f64 = reference[range.clone()].iter().map(|a| a * a).sum();
    (0..=2 * max).map(|lag| wanted - 2.0 * products[lag] + running[lag + n] - running[lag]).collect()
}

/// `sum over k of a[k] b[k + lag]` for the first `lags` lags, by FFT.
fn correlate(a: &[f64], b: &[f64], lags: usize) -> Vec<f64> {
    let size = (b.len() + lags).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let forward = planner.plan_fft_forward(size);
    let transform = |signal: &[f64]| {
        let mut buffer = signal.to_vec();
        buffer.resize(size, 0.0);
        let mut spectrum = forward.make_output_vec();
        // The buffers are made for this plan: their lengths cannot be wrong.
        forward.process(&mut buffer, &mut spectrum).map(|()| spectrum).unwrap_or_default()
    };
    let (spectrum_a, mut spectrum_b) = (transform(a), transform(b));
    for (x, y) in spectrum_b.iter_mut().zip(&spectrum_a) {
        *x *= y.conj();
    }
    let inverse = planner.plan_fft_inverse(size);
    let mut out = inverse.make_output_vec();
    // The only complaint left is rounding in the imaginary parts at zero and Nyquist, which are then taken as zero.
    let _ = inverse.process(&mut spectrum_b, &mut out);
    out.iter().take(lags).map(|x| x / size as f64).collect()
}

/// The squared error at any lag, counted in samples.
fn squared_error(reference: &[f64], response: &[f64], range: &Range<usize>, lag: f64) -> f64 {
    let whole = lag.floor();
    let fraction = lag - whole;
    let last = response.len().cast_signed() - 1;
    let held = |i: isize| response[i.clamp(0, last).cast_unsigned()];
    let weights = weights(fraction);
    let reach = weights.len().cast_signed() / 2;
    let mut sum = 0.0;
    for k in range.clone() {
        let at = k.cast_signed() + whole as isize;
        let shifted = if fraction == 0.0 {
            held(at)
        } else if at >= reach && at + reach < last {
            let from = (at + 1 - reach).cast_unsigned();
            response[from..from + weights.len()].iter().zip(&weights).map(|(x, w)| x * w).sum()
        } else {
            weights.iter().enumerate().map(|(j, w)| w * held(at + 1 - reach + j.cast_signed())).sum()
        };
        sum += (reference[k] - shifted).powi(2);
    }
    sum
}

/// Weights of the samples `1 - reach ..= reach` for the value a fraction of a sample after sample 0; they sum to 1.
fn weights(fraction: f64) -> Vec<f64> {
    let reach = REACH.cast_signed();
    let raw: Vec<f64> = (1 - reach..=reach).map(|i| kernel(fraction - i as f64)).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}

/// Where a function with one minimum between two points is least, to 1e-4.
fn golden_section(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let share = (5f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - share * (high - low), low + share * (high - low));
    let (mut fa, mut fb) = (f(a), f(b));
    while high - low > 1e-4 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - share * (high - low);
            fa = f(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + share * (high - low);
            fb = f(b);
        }
    }
    f64::midpoint(low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn wave(k: f64) -> f64 {
        (-((k - 200.0) / 40.0).powi(2)).exp() * (0.4 * k).sin()
    }

    fn samples(lag: f64) -> Vec<f64> {
        (0..400).map(|k| wave(f64::from(k) - lag)).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn a_delay_is_found_between_samples_and_taken_out(lag in -20.0..20.0f64) {
            let free = relative_error(&samples(0.0), &samples(lag), 0.01, 0..400, Shift::Free { max: 0.25 });
            prop_assert!((free.delay - 0.01 * lag).abs() < 2e-6, "{} for {}", free.delay, 0.01 * lag);
            prop_assert!(free.ratio < 1e-3, "{}", free.ratio);
        }

        #[test]
        fn a_free_shift_is_never_worse(
            a in prop::collection::vec(-1.0..1.0f64, 50), b in prop::collection::vec(-1.0..1.0f64, 50)
        ) {
            let error = |shift| relative_error(&a, &b, 0.01, 5..45, shift).ratio;
            let free = relative_error(&a, &b, 0.01, 5..45, Shift::Free { max: 0.1 });
            prop_assert!(free.ratio <= error(Shift::None) * (1.0 + 1e-9));
            prop_assert!(free.delay.abs() <= 0.1 + 1e-12);
            prop_assert!((error(Shift::By(free.delay)) - free.ratio).abs() < 1e-12);
        }

        #[test]
        fn the_correlation_gives_the_error_of_every_whole_lag(
            a in prop::collection::vec(-1.0..1.0f64, 30), b in prop::collection::vec(-1.0..1.0f64, 30)
        ) {
            let fast = errors_at_whole_lags(&a, &b, &(4..26), 9);
            for (i, error) in fast.iter().enumerate() {
                let plain = squared_error(&a, &b, &(4..26), i as f64 - 9.0);
                prop_assert!((error - plain).abs() < 1e-9, "{error} {plain} at {i}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]
        #[test]
        fn the_form_gives_the_error_between_samples(
            a in prop::collection::vec(-1.0..1.0f64, 90), b in prop::collection::vec(-1.0..1.0f64, 90),
            whole in -40..40isize, off in -1.0..=1.0f64,
        ) {
            let lag = whole as f64 + off;
            let (form, plain) = (Near::new(&a, &b, &(5..77), whole).error(lag), squared_error(&a, &b, &(5..77), lag));
            prop_assert!((form - plain).abs() < 1e-11, "{form} {plain} at {lag}");
        }
    }

    #[test]
    fn the_error_of_a_scaled_response_is_the_scale_less_one() {
        let reference = samples(0.0);
        let response: Vec<f64> = reference.iter().map(|x| 1.3 * x).collect();
        let error = relative_error(&reference, &response, 0.01, 0..400, Shift::None);
        assert!((error.ratio - 0.3).abs() < 1e-12 && (error.squared() - 0.09).abs() < 1e-12);
        let zero = relative_error(&[0.0; 4], &[0.0; 4], 0.01, 0..4, Shift::Free { max: 0.5 });
        assert_eq!((zero.ratio, zero.delay), (0.0, 0.0));
        assert!(relative_error(&[0.0; 4], &[1.0; 4], 0.01, 0..4, Shift::None).ratio.is_infinite());
        assert!(relative_error(&[], &[], 0.01, 0..4, Shift::None).ratio.is_nan());
    }
}
