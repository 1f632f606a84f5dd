//! The inner loop of an existing controller, from its own logs: gains, feed-forward, delay and lag.
//!
//! ```text
//! u(t) = F [ kp (r - x) + ki I(r - x) + kvf r' + kaf r'' - kv x' - ka a - kdp p ] + bias + drift t
//! F    = exp(-s delay) / (1 + s lag)
//! ```
//! r is the reference (m), u the command, x the displacement (m), a the acceleration (m/s2), p the pressure difference, I the integral
//! over time. Three-variable control has kp, kv, ka with the same feed-forward; a PID has kv = kd and kvf = kd plus its
//! feed-forward. Where the command does not follow the displacement at all, the loop is closed in hardware behind it, and the motion
//! identifies it:
//! ```text
//! x'(t) = F [ k (c - x) + ki I(c - x) + kf c' ] + bias,     c = command as a displacement, m
//! ```
//! The equations hold whatever the table does, saturated or not, for they are the controller's; those of a hard-wired loop do not
//! where the valve is fully open. All signals are tapered and compared over the band that the reference excites, so that sensor
//! noise above it biases nothing; gains follow by least squares for each delay and lag, which are searched. Terms that are not
//! significant are left out.

mod band;
mod best;
mod fit;
mod spread;

use crate::digits;
use band::{Band, Order};
use best::{Noise, Reduced, best};
use fit::Problem;

/// Signals of one run as a controller or a logger beside it wrote them, evenly sampled, without gaps, in SI.
#[derive(Debug, Clone, Default)]
pub struct Log {
    /// Step, s.
    pub dt: f64,
    /// Reference, m.
    pub reference: Vec<f64>,
    /// Command, in the controller's unit.
    pub command: Vec<f64>,
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Acceleration, m/s2, where it was logged.
    pub acceleration: Option<Vec<f64>>,
    /// Pressure difference, in its unit, where it was logged.
    pub pressure: Option<Vec<f64>>,
}

/// A signal that a gain multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Term {
    /// Reference less displacement.
    Error,
    /// Its integral.
    Integral,
    /// Rate of the reference.
    ReferenceRate,
    /// Second derivative of the reference.
    ReferenceAcceleration,
    /// Velocity of the table, negative.
    Velocity,
    /// Acceleration of the table, negative.
    Acceleration,
    /// Pressure difference, negative.
    Pressure,
}

impl Term {
    /// The gain's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "kp",
            Self::Integral => "ki",
            Self::ReferenceRate => "kvf",
            Self::ReferenceAcceleration => "kaf",
            Self::Velocity => "kv",
            Self::Acceleration => "ka",
            Self::Pressure => "kdp",
        }
    }
}

/// One gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// What it multiplies.
    pub term: Term,
    /// Its value, unit of the command (m/s for a hard-wired loop) per unit of the term.
    pub value: f64,
    /// Its standard error.
    pub std: f64,
    /// RMS of what it contributes over RMS of the whole.
    pub share: f64,
}

impl Gain {
    /// True where the data determine it: it is known to be none of zero, and what it contributes is seen.
    pub fn determined(&self) -> bool {
        self.value.abs() > CERTAIN * self.std && self.share > SEEN
    }

    /// Its name, its value and its standard error.
    fn words(&self) -> String {
        format!("{} = {}", self.term.name(), digits::with_spread(self.value, Some(self.std)))
    }
}

/// Standard errors from zero at which a gain is determined.
const CERTAIN: f64 = 3.0;
/// Least share of the whole that a gain contributes where it is determined.
const SEEN: f64 = 1e-3;

/// Where the loop is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Closure {
    /// The logged command answers to the displacement.
    Command,
    /// The command is a displacement asked for; hardware behind it subtracts the displacement.
    Hardwired,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct InnerLoop {
    /// Where the loop is closed.
    pub closure: Closure,
    /// The gains that are significant.
    pub gains: Vec<Gain>,
    /// Delay, s.
    pub delay: f64,
    /// Time constant of a first-order lag, s; 0 where the delay alone explains as much.
    pub lag: f64,
    /// Time constant of the velocity's own filter, s.
    pub filter: f64,
    /// Command for one metre, where the loop is hard-wired; else 1.
    pub scale: f64,
    /// RMS of what is left over RMS of what is explained, within the band.
    pub misses: f64,
    /// The band, Hz.
    pub band: (f64, f64),
}

impl InnerLoop {
    /// A gain's value, 0 where its term is not in the loop.
    pub fn gain(&self, term: Term) -> f64 {
        self.gains.iter().find(|g| g.term == term).map_or(0.0, |g| g.value)
    }

    /// In a sentence: the gains that the data determine, with their standard errors, delay and lag.
    pub fn describe(&self) -> String {
        let (known, others): (Vec<&Gain>, Vec<&Gain>) = self.gains.iter().partition(|g| g.determined());
        let gains: Vec<String> = known.iter().map(|g| g.words()).collect();
        let others: Vec<&str> = others.iter().map(|g| g.term.name()).collect();
        let open = if others.is_empty() { String::new() } else { format!("; not determined: {}", others.join(", ")) };
        let place = match self.closure {
            Closure::Command => "closed by the command",
            Closure::Hardwired => "closed in hardware behind the command",
        };
        let lag = if self.lag > 0.0 { format!(", lag {:.2} ms", 1e3 * self.lag) } else { String::new() };
        format!(
            "{place}; {}{open}; delay {:.2} ms{lag}; misses {:.2} % from {:.1} to {:.1} Hz",
            gains.join(", "),
            1e3 * self.delay,
            100.0 * self.misses,
            self.band.0,
            self.band.1
        )
    }
}

/// Why nothing was found.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InnerLoopError {
    /// The signals differ in length, or there are too few.
    #[error("the log has {found} samples of every signal, expected at least {least} of each")]
    TooShort {
        /// Samples that all signals have.
        found: usize,
        /// Fewest.
        least: usize,
    },
    /// The reference moves too little.
    #[error("the reference hardly moves: an inner loop shows in a run that moves")]
    Still,
    /// The terms do not determine the gains.
    #[error("the signals do not determine the gains: log a run whose reference moves over a wider band")]
    Singular,
}

/// Fewest samples.
const SAMPLES: usize = 200;
/// A command that the reference alone explains to this share follows no displacement.
const OPEN: f64 = 0.02;
/// The reference explains a command as well as reference and motion together where it misses no more than so many times as much.
const AS_WELL: f64 = 1.5;
/// A term counts where the data without it are so much less likely: as many logarithms of the number of values.
const WORTH: f64 = 2.0;
/// A term of a hard-wired loop counts where without it so many times as much is missed: what is missed there is no noise.
const CLEARLY: f64 = 1.5;
/// Rounds in which noise is measured.
const ROUNDS: usize = 3;
/// Upper edges of the band that are tried, Hz.
const WIDEST: [f64; 3] = [120.0, 60.0, 30.0];
/// A wide band agrees with what the reference excites where it misses so many times as much there at most.
const AGREES: f64 = 1.15;
/// Lag from which a search for one begins, s.
const LAG: f64 = 0.002;

/// Finds the loop.
pub fn identify(logs: &[Log]) -> Result<InnerLoop, InnerLoopError> {
    for log in logs {
        let found = log.reference.len().min(log.command.len()).min(log.displacement.len());
        if found < SAMPLES || log.dt.is_nan() || log.dt <= 0.0 {
            return Err(InnerLoopError::TooShort { found, least: SAMPLES });
        }
    }
    let bands: Vec<Band> =
        logs.iter().map(|log| Band::of(&log.reference, log.dt)).collect::<Option<_>>().ok_or(InnerLoopError::Still)?;
    if bands.is_empty() {
        return Err(InnerLoopError::TooShort { found: 0, least: SAMPLES });
    }
    let closed = by_command(logs, &bands);
    let open = follows_reference(logs, &bands);
    // A PI law around an integrator makes a command that follows the reference too, but never as well as one that is made of it alone.
    if let Some((scale, _)) =
        open.filter(|(_, misses)| *misses < OPEN && closed.as_ref().is_none_or(|c| *misses < AS_WELL * c.misses))
    {
        return hardwired(logs, &bands, scale);
    }
    closed.map(|f| found(f, Closure::Command, 1.0, &bands)).ok_or(InnerLoopError::Singular)
}

/// The loop that the command closes, from the widest band that agrees with what the reference excites. A controller's own log, every
/// tick of it, holds the noise that the controller saw, and noise tells its gains apart where the table's motion does not; noise that
/// is a logger's own, or that fell between its samples, does the opposite.
fn by_command(logs: &[Log], bands: &[Band]) -> Option<Reduced> {
    let terms = closed(logs);
    let of = |bands: &[Band]| {
        best(logs, bands, &terms, Noise::Measured, |log, band| band.spectrum(&log.command, Order::Itself))
    };
    let narrow = of(bands)?;
    for highest in WIDEST {
        let wide: Vec<Band> = bands.iter().map(|band| band.widened(highest)).collect();
        if let Some(found) = of(&wide).filter(|found| found.misses < AGREES * narrow.misses) {
            return Some(found);
        }
    }
    Some(narrow)
}

/// The command as the reference makes it, without the motion and without a lag: command for one metre, and the share it misses.
fn follows_reference(logs: &[Log], bands: &[Band]) -> Option<(f64, f64)> {
    let parts = logs.iter().zip(bands).map(|(log, band)| {
        let of = |order| band.spectrum(&log.reference, order);
        let terms = vec![of(Order::Itself), of(Order::First), of(Order::Second)];
        band.part(band.spectrum(&log.command, Order::Itself), terms)
    });
    let fitted = Problem::new(parts.collect(), None).search(&[true; 3], false)?;
    Some((fitted.gains[0], fitted.misses))
}

/// The terms of a law whose command is logged.
fn closed(logs: &[Log]) -> Vec<Term> {
    let mut terms = vec![
        Term::Error,
        Term::Integral,
        Term::ReferenceRate,
        Term::ReferenceAcceleration,
        Term::Velocity,
        Term::Acceleration,
    ];
    if logs.iter().all(|log| log.pressure.is_some()) {
        terms.push(Term::Pressure);
    }
    terms
}

/// The loop that hardware closes behind the command.
fn hardwired(logs: &[Log], bands: &[Band], scale: f64) -> Result<InnerLoop, InnerLoopError> {
    let asked: Vec<Log> = logs
        .iter()
        .map(|log| {
            let reference: Vec<f64> = log.command.iter().map(|u| u / scale).collect();
            Log { reference, ..log.clone() }
        })
        .collect();
    let terms = [Term::Error, Term::Integral, Term::ReferenceRate];
    let fitted =
        best(&asked, bands, &terms, Noise::Unmodelled, |log, band| band.spectrum(&log.displacement, Order::First));
    fitted.map(|f| found(f, Closure::Hardwired, scale, bands)).ok_or(InnerLoopError::Singular)
}

fn found(fitted: Reduced, closure: Closure, scale: f64, bands: &[Band]) -> InnerLoop {
    let band = bands.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), b| (low.min(b.low), high.max(b.high)));
    let Reduced { gains, timing, misses } = fitted;
    InnerLoop { closure, gains, delay: timing.delay, lag: timing.lag, filter: timing.velocity, scale, misses, band }
}

#[cfg(test)]
mod tests;
