//! The paper's Table 1, run: eight controllers, three records, every figure beside the paper's.

pub mod fitted;

use super::named::RATE;
use super::published::{Event, Figures, Named, PublishedGains};
use super::trial::{ScoredSignal, Scores, Setup, Trial, TrialError, strong_and_weak, table1_motion};
use super::twin::Twin;
use super::{Actuation, ClosedLoopError, ControlLaw, Measured};
use crate::motion::metrics::Window;
use crate::motion::{Motion, Record};
use crate::plant::sensors::GRAVITY;
use rayon::prelude::*;
use shakedown_core::settings::ReferenceRates;
use shakedown_core::{Controller, Settings};

/// How the velocity and acceleration loops of Fig. 12 are read. The paper does not say whether they act on an error
/// against the reference's velocity and acceleration, or on the measured ones alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reading {
    /// Both on the error, at the gains printed: what the text says, "the table should track the acceleration profile more
    /// accurately".
    Tracking,
    /// The velocity loop on the error; the acceleration loop on the measured acceleration alone, at a quarter of its
    /// gains. Inferred from the table itself: every row with acceleration feedback shows a table that follows at
    /// four fifths of the amplitude, `E_d` 0.200, as 10 over 10 + 2.5 does. The paper says nothing of such a factor.
    Damping,
}

impl Reading {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tracking => "tracking",
            Self::Damping => "damping",
        }
    }

    /// Where the two differ: controllers with an acceleration loop.
    pub fn apply_to(named: Named) -> &'static [Self] {
        if named.gains().acceleration == (0.0, 0.0) { &[Self::Tracking] } else { &[Self::Tracking, Self::Damping] }
    }
}

/// The core, told that the reference's acceleration is zero.
#[derive(Debug, Clone)]
struct NoReferenceAcceleration(Controller);

impl ControlLaw for NoReferenceAcceleration {
    fn step(&mut self, measured: &Measured) -> Actuation {
        ControlLaw::step(&mut self.0, &Measured { reference_acceleration: 0.0, ..*measured })
    }
}

/// Plays a motion with a controller under a reading.
pub fn play(named: Named, reading: Reading, table: &Twin, motion: &Motion) -> Result<Trial, TrialError> {
    let setup = Setup { table: table.clone(), ..Setup::paper(named) };
    if reading == Reading::Tracking {
        return setup.play(motion);
    }
    let gains = named.gains();
    let (kp, ki) = gains.acceleration;
    let gains = PublishedGains { acceleration: (kp / 4.0, ki / 4.0), ..gains };
    let settings = Settings { reference_rates: ReferenceRates::Supplied, ..super::named::settings(gains, RATE) };
    let core = Controller::new(&settings).map_err(ClosedLoopError::from)?;
    setup.play_with(&mut NoReferenceAcceleration(core), motion)
}

/// One record, conditioned.
#[derive(Debug, Clone)]
pub struct Case {
    /// Which of the paper's records it is, or stands in for.
    pub event: Event,
    /// Name of the record.
    pub name: String,
    /// The motion at the control rate.
    pub motion: Motion,
    /// Strong and weak stretch.
    pub windows: (Window, Window),
}

impl Case {
    /// Conditions `record` as the table needs it; a stand-in is scaled to the paper's peak afterwards.
    pub fn new(event: Event, record: &Record, stands_in: bool) -> Result<Self, TrialError> {
        let mut motion = table1_motion(record, RATE)?;
        if stands_in {
            let (_, _, peak) = motion.peaks();
            motion = motion.scaled(event.reference_peak_g() * GRAVITY / peak);
        }
        let windows = strong_and_weak(&motion);
        Ok(Self { event, name: record.name.clone(), motion, windows })
    }

    /// Peak of the reference's acceleration, g.
    pub fn peak_g(&self) -> f64 {
        self.motion.peaks().2 / GRAVITY
    }
}

/// One row: a controller on a record.
#[derive(Debug, Clone)]
pub struct Row {
    /// Record.
    pub event: Event,
    /// Controller.
    pub named: Named,
    /// How its velocity and acceleration loops were read.
    pub reading: Reading,
    /// Over the whole record.
    pub whole: Scores,
    /// Over its strong stretch.
    pub strong: Scores,
    /// Over its weak stretch.
    pub weak: Scores,
    /// The run itself.
    pub trial: Trial,
}

impl Row {
    /// Peak acceleration of the table, g.
    pub fn peak_g(&self) -> f64 {
        self.whole.against_wanted.response_peak / GRAVITY
    }

    /// The paper's figures of this row.
    pub fn published(&self) -> Figures {
        self.named.published(self.event)
    }
}

/// Runs every controller under every reading asked for on every case, over all cores; `done` is called after each.
pub fn rows(
    cases: &[Case],
    asked: &[(Named, Reading)],
    table: &Twin,
    done: impl Fn() + Sync,
) -> Result<Vec<Row>, TrialError> {
    let all: Vec<_> = cases.iter().flat_map(|case| asked.iter().map(move |&pair| (case, pair))).collect();
    let row = |&(case, (named, reading)): &(&Case, (Named, Reading))| {
        let trial = play(named, reading, table, &case.motion)?;
        let scores = |window| trial.scores(ScoredSignal::Truly, window);
        let (whole, strong, weak) = (scores(None)?, scores(Some(case.windows.0))?, scores(Some(case.windows.1))?);
        done();
        Ok(Row { event: case.event, named, reading, whole, strong, weak, trial })
    };
    all.par_iter().map(row).collect()
}

/// One figure that must come near the paper's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Record.
    pub event: Event,
    /// Controller.
    pub named: Named,
    /// Which figure.
    pub figure: &'static str,
    /// The figure here.
    pub value: f64,
    /// The paper's.
    pub paper: f64,
    /// Largest relative deviation allowed.
    pub bound: f64,
}

impl Check {
    /// Deviation from the paper's figure, relative to it.
    pub fn deviation(&self) -> f64 {
        self.value / self.paper - 1.0
    }

    /// Whether it is within the bound.
    pub fn holds(&self) -> bool {
        self.deviation().abs() <= self.bound
    }
}

/// The figures that the paper's plant and records determine, and how near they must come: the plain displacement loops
/// without (Taft) or with little (El Centro) saturation, and the spike of Kobe. Everything else is shown, not held.
pub fn checks(rows: &[Row]) -> Vec<Check> {
    use Event::{ElCentro, Kobe, Taft};
    use Named::{Current, Strong};
    let wanted: [(Event, Named, &'static str, f64); 9] = [
        (Taft, Current, "E_d", 0.20),
        (Taft, Current, "peak", 0.20),
        (Taft, Strong, "E_d", 0.20),
        (Taft, Strong, "peak", 0.20),
        (ElCentro, Current, "E_d", 0.15),
        (ElCentro, Current, "peak", 0.15),
        (Kobe, Strong, "peak", 0.05),
        (ElCentro, Current, "E_a", 0.35),
        (Taft, Current, "E_a", 0.35),
    ];
    let check = |&(event, named, figure, bound): &(Event, Named, &'static str, f64)| {
        let row = rows.iter().find(|r| r.event == event && r.named == named && r.reading == Reading::Tracking)?;
        let (score, paper) = (&row.whole.against_wanted, row.published());
        let (value, paper) = match figure {
            "E_d" => (score.e_d.ratio, paper.e_d),
            "E_a" => (score.e_a.squared(), paper.e_a),
            _ => (row.peak_g(), paper.peak_g),
        };
        Some(Check { event, named, figure, value, paper, bound })
    };
    wanted.iter().filter_map(check).collect()
}
