//! Dormand and Prince's embedded pair of orders 5 and 4 with step control (Hairer, Nørsett, Wanner, *Solving Ordinary
//! Differential Equations I*, table II.5.2): the truth is not integrated the way any model of it is.

/// Number of states; unused ones have zero derivative and cost nothing in accuracy.
pub const STATES: usize = 24;

/// A state vector; what each entry means is said in [`crate::plant::state`].
pub type State = [f64; STATES];

const A: [[f64; 5]; 5] = [
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
];
const B: [f64; 6] = [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];
const C: [f64; 5] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0];
/// Order 5 less order 4.
const E: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Step control: tolerances and the step carried from one stretch to the next.
#[derive(Debug, Clone)]
pub struct Integrator {
    relative: f64,
    absolute: State,
    step: f64,
    /// Derivative evaluations so far: the work done, which tests watch.
    pub evaluations: u64,
}

impl Integrator {
    /// Tolerances per state: `relative` to its size, or `absolute` in its own unit.
    pub fn new(relative: f64, absolute: State) -> Self {
        Self { relative, absolute, step: 1e-3, evaluations: 0 }
    }

    /// Integrates `y' = f(t, y)` from `from` to `to` (s) in place. `f` may have kinks; its jumps (commands that
    /// arrive) belong between two calls, as the error estimate sees a jump between the first stages badly.
    pub fn advance(&mut self, f: &impl Fn(f64, &State, &mut State), from: f64, to: f64, y: &mut State) {
        let mut t = from;
        let mut k = [[0.0; STATES]; 7];
        f(t, y, &mut k[0]);
        self.evaluations += 1;
        while to - t > 1e-12 {
            let remaining = to - t;
            let mut h = self.step.min(remaining);
            if remaining - h < 0.1 * h {
                h = remaining;
            }
            let (next, error) = self.attempt(f, t, h, y, &mut k);
            let factor = if error > 0.0 { (0.9 * error.powf(-0.2)).clamp(0.2, 5.0) } else { 5.0 };
            if error <= 1.0 || h <= 1e-7 {
                t += h;
                *y = next;
                k[0] = k[6];
                // A last short step to meet `to` says nothing about the step that accuracy allows.
                self.step = if h < self.step { self.step.max(h * factor) } else { h * factor };
            } else {
                self.step = h * factor.min(0.9);
            }
        }
    }

    fn attempt(
        &mut self,
        f: &impl Fn(f64, &State, &mut State),
        t: f64,
        h: f64,
        y: &State,
        k: &mut [State; 7],
    ) -> (State, f64) {
        let mut trial;
        for stage in 0..5 {
            trial = *y;
            for (weight, slope) in A[stage].iter().zip(k.iter()).take(stage + 1) {
                for (value, rate) in trial.iter_mut().zip(slope) {
                    *value += h * weight * rate;
                }
            }
            f(t + C[stage] * h, &trial, &mut k[stage + 1]);
        }
        let mut next = *y;
        for (weight, slope) in B.iter().zip(k.iter()) {
            for (value, rate) in next.iter_mut().zip(slope) {
                *value += h * weight * rate;
            }
        }
        f(t + h, &next, &mut k[6]);
        self.evaluations += 6;
        let mut worst = 0.0_f64;
        for i in 0..STATES {
            let error: f64 = E.iter().zip(k.iter()).map(|(weight, slope)| weight * slope[i]).sum::<f64>() * h;
            let scale = self.absolute[i] + self.relative * y[i].abs().max(next[i].abs());
            worst = worst.max((error / scale).abs());
        }
        (next, worst)
    }
}

#[cfg(test)]
mod tests {
    use super::{Integrator, STATES, State};

    fn oscillator(_: f64, y: &State, dy: &mut State) {
        *dy = [0.0; STATES];
        dy[0] = y[1];
        dy[1] = -400.0 * y[0];
    }

    #[test]
    fn an_oscillator_keeps_to_its_cosine_over_a_hundred_periods() {
        let mut y = [0.0; STATES];
        y[0] = 1.0;
        let mut integrator = Integrator::new(1e-9, [1e-12; STATES]);
        let end = 100.0 * std::f64::consts::TAU / 20.0;
        integrator.advance(&oscillator, 0.0, end, &mut y);
        assert!((y[0] - 1.0).abs() < 1e-5, "{}", y[0]);
    }

    #[test]
    fn a_tighter_tolerance_costs_steps_and_buys_accuracy() {
        let run = |tolerance: f64| {
            let mut y = [0.0; STATES];
            y[0] = 1.0;
            let mut integrator = Integrator::new(tolerance, [tolerance; STATES]);
            integrator.advance(&oscillator, 0.0, 1.0, &mut y);
            ((y[0] - 20.0_f64.cos()).abs(), integrator.evaluations)
        };
        let (loose, few) = run(1e-4);
        let (tight, many) = run(1e-9);
        assert!(tight < loose / 100.0, "{tight} against {loose}");
        assert!(many > few);
    }

    #[test]
    fn stretches_joined_agree_with_one_stretch_across_a_kink() {
        // Every law of the plant is continuous; limits and directions put kinks into them.
        let kink = |t: f64, _: &State, dy: &mut State| {
            *dy = [0.0; STATES];
            dy[0] = (t - 0.503).abs();
        };
        let mut y = [0.0; STATES];
        let mut integrator = Integrator::new(1e-7, [1e-9; STATES]);
        // Half samples at 250 Hz.
        for i in 0..500 {
            integrator.advance(&kink, f64::from(i) * 0.002, f64::from(i + 1) * 0.002, &mut y);
        }
        let exact = 0.5 * (0.503 * 0.503 + 0.497 * 0.497);
        assert!((y[0] - exact).abs() < 1e-7, "{} against {exact}", y[0]);
    }
}
