//! Record modification with a bounded preview: the taut string through the part of the tube that is in view.
//!
//! The output lags the reference by the preview. At each tick the velocity given up, e, may move along any slope that
//! keeps it inside the tube `r - V <= e <= r + V` over the samples in view: the funnel `[low, high]`, narrowed sample by
//! sample, the first to close it deciding which wall the string touches. Inside an open funnel the slope nearest to the
//! washout's is taken; with no washout this is the string with a free end, which minimises every convex norm of the
//! acceleration error over the view. The tube is built from the velocity limit in force at this tick, so a limit lowered
//! mid-run reshapes all of it at once. The walls of [`super::causal`] stand behind it.
//!
//! A funnel over every sample costs one slope a sample. Here the samples in view are grouped in aligned runs of 1, 4, 16
//! and 64, none longer than its distance, each known by its extremes and where they lie: near samples are seen one by
//! one, far ones coarsely, and what is coarse becomes fine as it draws near. At most 25 runs are looked at in a tick for
//! 512 samples, and a sample added is shown to three; no loop is longer. Little more than 4 bytes a sample.

mod window;

use super::input::Input;
use super::travel::{Integrator, TickLimits};
use super::{DriftRecovery, ReferenceLimits, within};
use crate::math::{max, min};
use crate::settings::SettingsError;
use window::Window;

/// What is set before a test.
///
/// ```
/// use shakedown_core::blocks::record::{ReferenceLimits, preview};
///
/// const WINDOW: usize = 256;
/// let limits = ReferenceLimits::new(1000.0, 0.242, 0.12);
/// let config = preview::Config::new::<WINDOW>(&limits, &preview::Config::DRIFT_RECOVERY, 0.2)?;
/// let mut state = preview::State::<WINDOW, { preview::places(WINDOW) }>::at(0.0);
/// assert_eq!(preview::step(&config, &mut state, 0.0, 0.242), 0.0);
/// assert_eq!(config.delay(), 200); // the output lags by the preview
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    walls: TickLimits,
    velocity_share: f32,
    displacement_share: f32,
    delay: u32,
}

impl Config {
    /// The washout with which the benches' figures are taken.
    pub const DRIFT_RECOVERY: DriftRecovery = DriftRecovery { frequency: 0.3, damping: 0.6 };

    /// A modifier that looks `preview` seconds ahead; a window of `N` samples holds at most N - 1 of them.
    pub fn new<const N: usize>(
        limits: &ReferenceLimits,
        washout: &DriftRecovery,
        preview: f32,
    ) -> Result<Self, SettingsError> {
        limits.validate()?;
        washout.validate(limits.rate)?;
        within("preview", preview, 0.0, (N.saturating_sub(1)) as f32 / limits.rate)?;
        let (velocity_share, displacement_share) = washout.shares(limits.rate);
        let delay = (preview * limits.rate + 0.5) as u32;
        Ok(Self { walls: TickLimits::new(limits), velocity_share, displacement_share, delay })
    }

    /// By how many ticks the output lags the reference.
    pub fn delay(&self) -> u32 {
        self.delay
    }
}

/// Bytes that a window of `n` samples keeps beside them: the second parameter of [`State`].
pub const fn places(n: usize) -> usize {
    window::places(n)
}

/// What changes during a test; `N` samples of the reference, a power of two, and [`places`] of as many.
#[derive(Debug, Clone)]
pub struct State<const N: usize, const PLACES: usize> {
    input: Input,
    /// The reference as it enters the window, leaps left out.
    entered: Integrator,
    /// The same as it leaves it: what was answered last.
    answered: Integrator,
    output: Integrator,
    limited: bool,
    window: Window<N, PLACES>,
}

impl<const N: usize, const PLACES: usize> State<N, PLACES> {
    /// At rest at `reference`, m.
    pub fn at(reference: f32) -> Self {
        let input = Input::at(reference);
        let rest = Integrator::at(input.displacement);
        Self { input, entered: rest, answered: rest, output: rest, limited: false, window: Window::at_rest() }
    }

    /// Puts it at rest at `reference`, m, where it stands: a window is large to build and move.
    pub fn restart(&mut self, reference: f32) {
        self.input = Input::at(reference);
        let rest = Integrator::at(self.input.displacement);
        (self.entered, self.answered, self.output) = (rest, rest, rest);
        self.limited = false;
        self.window.rest();
    }

    /// Goes on after ticks that were not heard, with `reference` (m) the next: what it moved meanwhile is washed out.
    pub fn resume(&mut self, reference: f32) {
        self.input.resume(reference);
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
pub fn step<const N: usize, const PLACES: usize>(
    config: &Config,
    state: &mut State<N, PLACES>,
    reference: f32,
    velocity_limit_now: f32,
) -> f32 {
    let walls = &config.walls;
    let limit = walls.step_now(velocity_limit_now);
    state.input.accept(reference, walls.leap, walls.brake);
    state.window.push(state.input.step);
    state.entered.advance(state.input.step);

    let error = state.answered.step - state.output.step;
    // A leap counts from the tick in which it comes. Both sums see the same steps, so that they agree to the last bit
    // when the reference rests.
    let behind = state.output.behind(state.input.displacement) - state.entered.beyond(&state.answered);
    let home = -(config.velocity_share * error + config.displacement_share * behind);
    let slope = string(&state.window, config.delay, error, limit, home);

    state.answered.advance(state.window.late(config.delay));
    let want = state.answered.step - (error + slope);
    let kept = walls.keep(want, limit, state.output.displacement);
    state.limited = kept != want;
    state.output.advance(kept)
}

/// The slope of the string from `error` through the next `ahead` + 1 samples, as near to `home` as the tube allows.
#[inline]
fn string<const N: usize, const PLACES: usize>(
    window: &Window<N, PLACES>,
    ahead: u32,
    error: f32,
    limit: f32,
    home: f32,
) -> f32 {
    let mut funnel = Funnel { low: f32::NEG_INFINITY, high: f32::INFINITY };
    let (floor, roof) = (limit + error, limit - error);
    let closed = window.scan(ahead, |run| {
        let (rise, fall) = (run.highest.step - floor, run.lowest.step + roof);
        // Most runs change nothing, and say so without a division.
        let above = rise > funnel.low * run.highest.ticks;
        let below = fall < funnel.high * run.lowest.ticks;
        if above && below && run.lowest.ticks < run.highest.ticks {
            return funnel.below(fall / run.lowest.ticks).or_else(|| funnel.above(rise / run.highest.ticks));
        }
        let closed = if above { funnel.above(rise / run.highest.ticks) } else { None };
        if below { closed.or_else(|| funnel.below(fall / run.lowest.ticks)) } else { closed }
    });
    closed.unwrap_or_else(|| min(max(home, funnel.low), funnel.high))
}

/// The slopes that keep the string inside the tube as far as it has been seen.
struct Funnel {
    low: f32,
    high: f32,
}

impl Funnel {
    /// Keeps the slope above `low`; the slope of the wall that the string touches where that closes the funnel.
    #[inline]
    fn above(&mut self, low: f32) -> Option<f32> {
        if low > self.high {
            return Some(self.high);
        }
        self.low = low;
        None
    }

    /// Keeps the slope below `high`, in the same way.
    #[inline]
    fn below(&mut self, high: f32) -> Option<f32> {
        if high < self.low {
            return Some(self.low);
        }
        self.high = high;
        None
    }
}
