//! Pressures that flows and the oil they pass through agree on.
//!
//! A leak or a loaded edge passes the more the higher the pressure, and what it passes takes the pressure down. Taken one
//! after the other in stiff oil this is a far faster rate than any integration step follows: the solution jumps to and fro
//! about the right one, or settles beside it. Solved at once it is no rate at all.

/// How well the two agree, in m/s2 and as a share of the pressure.
const CLOSE: f64 = 1e-11;
/// More than any of the laws needs.
const TRIES: usize = 60;

/// The pressure `p` with `of(p) = p`, for an `of` that nowhere rises: there is one, no further from `start` than `of(start)`.
pub(super) fn balance(start: f64, of: impl Fn(f64) -> f64) -> f64 {
    let excess = |p: f64| of(p) - p;
    let (mut a, mut fa) = (start, excess(start));
    let (mut b, mut fb) = (start + fa, excess(start + fa));
    for _ in 0..TRIES {
        // The slope of the excess is at least one: it bounds how far the solution is away.
        if fb.is_nan() || fb.abs() <= CLOSE * (1.0 + b.abs()) {
            break;
        }
        let p = between(a, b, b - fb * (b - a) / (fb - fa));
        let fp = excess(p);
        if fp * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            // Anderson and Bjorck: the end that stays counts for less, or it would stay for good.
            let less = 1.0 - fp / fb;
            fa *= if less > 0.0 { less } else { 0.5 };
        }
        (b, fb) = (p, fp);
    }
    b
}

/// The guess where it lies between the ends, the middle otherwise.
fn between(a: f64, b: f64, guess: f64) -> f64 {
    if (guess - a) * (guess - b) < 0.0 { guess } else { 0.5 * (a + b) }
}

#[cfg(test)]
mod tests {
    use super::balance;

    #[test]
    fn a_falling_law_has_its_one_solution_even_where_it_is_steep() {
        for steepness in [0.0, 0.1, 10.0, 1e4] {
            for start in [-3.0, 0.0, 2.0, 50.0] {
                let cubic = |p: f64| 5.0 - steepness * (p - 1.0).powi(3);
                let root = |p: f64| 1.0 - steepness * (p - 1.0).signum() * (p - 1.0).abs().sqrt();
                let p = balance(start, cubic);
                assert!((cubic(p) - p).abs() < 1e-6 * (1.0 + steepness.sqrt()), "{steepness} from {start}: {p}");
                let p = balance(start, root);
                assert!((p - 1.0).abs() < 1e-9, "{steepness} from {start}: {p}");
            }
        }
    }

    #[test]
    fn no_number_gives_no_number() {
        assert!(balance(f64::NAN, |p| -p).is_nan());
    }
}
