//! Record modification with a bounded preview: the taut string through the part of the tube that is in view.
//!
//! The output lags the reference by the preview. At each tick the velocity given up, e, may move along any slope that
//! keeps it inside the tube `r - V <= e <= r + V` over the samples in view: the funnel `[low, high]`, narrowed sample by
//! sample, the first to close it deciding which wall the string touches. Inside an open funnel the slope nearest to the
//! washout's is taken; with no washout this is the string with a free end, which minimises every convex norm of the
//! acceleration error over the view. The tube is built from the velocity limit in force at this tick, so a limit lowered
//! mid-run reshapes all of it at once. The walls of [`super::causal`] stand behind it.
//!
//! A funnel over every sample costs one slope a sample. Here the samples in view are grouped in aligned runs of a power
//! of two, none longer than a quarter of its distance, each known by its extremes and where they lie: near samples are
//! seen one by one, far ones coarsely, and what is coarse becomes fine as it draws near. At most 5 log2 N - 8
//! runs are looked at in a tick, 37 for 512 samples, and one sample added merges at most log2 N runs; no loop is longer.

mod window;

use super::input::Input;
use super::travel::{Integrator, Walls};
use super::{Limits, Washout, within};
use crate::math::{max, min};
use crate::settings::SettingsError;
use window::Window;

/// What is set before a test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    walls: Walls,
    velocity_share: f32,
    displacement_share: f32,
    delay: u32,
}

impl Config {
    /// The washout with which the benches' figures are taken.
    pub const WASHOUT: Washout = Washout { frequency: 0.3, damping: 0.6 };

    /// A modifier that looks `preview` seconds ahead; a window of `N` samples holds at most N - 1 of them.
    pub fn new<const N: usize>(limits: &Limits, washout: &Washout, preview: f32) -> Result<Self, SettingsError> {
        limits.validate()?;
        washout.validate(limits.rate)?;
        within("preview", preview, 0.0, (N.saturating_sub(1)) as f32 / limits.rate)?;
        let (velocity_share, displacement_share) = washout.shares(limits.rate);
        let delay = (preview * limits.rate + 0.5) as u32;
        Ok(Self { walls: Walls::new(limits), velocity_share, displacement_share, delay })
    }

    /// By how many ticks the output lags the reference.
    pub fn delay(&self) -> u32 {
        self.delay
    }
}

/// What changes during a test; `N` samples of the reference, a power of two.
#[derive(Debug, Clone)]
pub struct State<const N: usize> {
    input: Input,
    window: Window<N>,
    /// The delayed reference that was answered last.
    answered: window::Point,
    output: Integrator,
    limited: bool,
}

impl<const N: usize> State<N> {
    /// At rest at `reference`, m.
    pub fn at(reference: f32) -> Self {
        let input = Input::at(reference);
        let rest = window::Point { displacement: input.displacement, step: 0.0 };
        Self {
            input,
            window: Window::filled(rest),
            answered: rest,
            output: Integrator::at(input.displacement),
            limited: false,
        }
    }

    /// The last reference was not a number, or leapt, and was not followed.
    pub fn held(&self) -> bool {
        self.input.held
    }

    /// The last output met a wall: the speed in force or the room left to stop in.
    pub fn limited(&self) -> bool {
        self.limited
    }
}

/// One tick: `reference` in m, `velocity_limit_now` in m/s; gives the modified reference of [`Config::delay`] ticks ago, m.
pub fn step<const N: usize>(config: &Config, state: &mut State<N>, reference: f32, velocity_limit_now: f32) -> f32 {
    let walls = &config.walls;
    let limit = walls.step_now(velocity_limit_now);
    state.input.accept(reference, walls.leap, walls.brake);
    state.window.push(window::Point { displacement: state.input.displacement, step: state.input.step });

    let error = state.answered.step - state.output.step;
    let behind = state.output.behind(state.answered.displacement);
    let home = -(config.velocity_share * error + config.displacement_share * behind);
    let slope = string(&state.window, config.delay, error, limit, home);

    state.answered = state.window.point(config.delay);
    let want = state.answered.step - (error + slope);
    let kept = walls.keep(want, limit, state.output.displacement);
    state.limited = kept != want;
    state.output.advance(kept)
}

/// The slope of the string from `error` through the next `ahead` + 1 samples, as near to `home` as the tube allows.
fn string<const N: usize>(window: &Window<N>, ahead: u32, error: f32, limit: f32, home: f32) -> f32 {
    let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
    for run in window.runs(ahead) {
        let floor = (run.highest.step - limit - error) / run.highest.ticks;
        let roof = (run.lowest.step + limit - error) / run.lowest.ticks;
        if floor > high {
            return high;
        }
        if roof < low {
            return low;
        }
        low = max(low, floor);
        high = min(high, roof);
    }
    min(max(home, low), high)
}
