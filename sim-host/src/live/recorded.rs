//! A recording played as if it were measured now.

use std::time::{Duration, Instant};

use shakedown_core::State;

use super::bench::{Answer, Bench, BenchError, Facts, Order, Phase, Sample, Status};
use crate::recording::{Baseline, Channel, Experiment};

/// Between two looks at the clock.
const NAP: Duration = Duration::from_millis(5);

/// Why a recording cannot be played.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RecordedError {
    /// There is no such run.
    #[error("--run {asked}: the experiment has runs 1 to {runs}")]
    Run {
        /// What was asked for.
        asked: usize,
        /// How many there are.
        runs: usize,
    },
    /// The table's motion was not recorded.
    #[error("the run has no channel `displacement`; there is nothing to watch")]
    Displacement,
}

/// A run of an experiment, played.
#[derive(Debug)]
pub struct Recorded {
    samples: Vec<Sample>,
    facts: Facts,
    /// Samples played, and those played before the clock was last started.
    at: usize,
    started_at: usize,
    since: Option<Instant>,
    /// Samples played that hold no number.
    missed: u64,
    speed: f64,
    message: (u64, String),
}

impl Recorded {
    /// Run `number`, from 1, of an experiment, `speed` times as fast as it was recorded.
    pub fn new(experiment: &Experiment, number: usize, speed: f64) -> Result<Self, RecordedError> {
        let none = RecordedError::Run { asked: number, runs: experiment.runs.len() };
        let run = number.checked_sub(1).and_then(|index| experiment.runs.get(index)).ok_or(none)?;
        let displacement = run.channel(Channel::Displacement).ok_or(RecordedError::Displacement)?;
        let value =
            |channel: Channel, k: usize| run.channel(channel).and_then(|y| y.get(k)).copied().unwrap_or(f64::NAN);
        let first = run.time.first().copied().unwrap_or(0.0);
        let limit = velocity_limit(experiment);
        let samples: Vec<Sample> = (0..displacement.len())
            .map(|k| Sample {
                time: run.time.get(k).map_or(k as f64 * run.dt, |t| t - first),
                gap: 0,
                reference: value(Channel::Reference, k),
                modified: value(Channel::Reference, k),
                displacement: value(Channel::Displacement, k),
                acceleration: value(Channel::Acceleration, k),
                command: value(Channel::Command, k),
                state: State::Running,
                saturated: limit.is_some_and(|limit| value(Channel::Velocity, k).abs() >= limit),
                limited: false,
                held: false,
            })
            .collect();
        let facts = Facts {
            kind: "recording",
            name: run.name.clone(),
            rate: 1.0 / run.dt,
            full_opening: full_opening(experiment),
            stroke: None,
            has_test: true,
            recorded_in: None,
        };
        let since = Some(Instant::now());
        let message = (0, "playing".into());
        Ok(Self { samples, facts, at: 0, started_at: 0, since, missed: 0, speed, message })
    }

    fn say(&mut self, message: &str) {
        self.message = (self.message.0 + 1, message.into());
    }

    fn pause(&mut self) {
        self.since = None;
        self.started_at = self.at;
    }
}

/// Largest speed that the experiment's model states, m/s.
fn velocity_limit(experiment: &Experiment) -> Option<f64> {
    let parameters = experiment.model.baseline.parameters();
    parameters.into_iter().find(|(name, _)| *name == "velocity_limit").map(|(_, value)| value)
}

/// Command that opens the valve fully under that model, m.
fn full_opening(experiment: &Experiment) -> Option<f64> {
    let Baseline::Servo(_) = &experiment.model.baseline else { return None };
    let parameters = experiment.model.baseline.parameters();
    let of = |wanted: &str| parameters.iter().find(|(name, _)| *name == wanted).map(|(_, value)| *value);
    let full = of("velocity_limit")? * of("a1")? / of("b0")?;
    (full.is_finite() && full > 0.0).then_some(full)
}

impl Bench for Recorded {
    fn facts(&self) -> Facts {
        self.facts.clone()
    }

    fn advance(&mut self) -> Result<Vec<Sample>, BenchError> {
        std::thread::sleep(NAP);
        let Some(since) = self.since else { return Ok(Vec::new()) };
        let played = (since.elapsed().as_secs_f64() * self.speed * self.facts.rate) as usize;
        let to = self.samples.len().min(self.started_at + played);
        let samples = self.samples.get(self.at..to).unwrap_or_default().to_vec();
        self.missed += samples.iter().filter(|sample| !sample.displacement.is_finite()).count() as u64;
        self.at = to;
        if self.at == self.samples.len() {
            self.pause();
            self.say("the recording is over");
        }
        Ok(samples)
    }

    fn status(&self) -> Status {
        let playing = self.since.is_some();
        Status {
            phase: if playing { Phase::Running } else { Phase::Held },
            state: Some(if playing { State::Running } else { State::Hold }),
            cause: None,
            answers: true,
            gone: self.at as u64,
            total: self.samples.len() as u64,
            samples: self.at as u64,
            missing: self.missed,
            dropped: 0,
            garbled: 0,
            recorded: 0,
            message: self.message.1.clone(),
            message_number: self.message.0,
        }
    }

    fn order(&mut self, order: Order) -> Result<Answer, String> {
        match order {
            Order::Start if self.at < self.samples.len() => {
                self.since.get_or_insert_with(Instant::now);
                self.say("playing");
            }
            Order::Start => return Err("the recording is over; start `shakedown live` again to see it again".into()),
            Order::Hold | Order::Stop | Order::Trip => {
                self.pause();
                self.say("paused");
            }
            Order::Arm | Order::Confirm(_) => return Err("a recording is not armed; start plays it".into()),
        }
        Ok(Answer::default())
    }

    fn is_idle(&self) -> bool {
        self.since.is_none()
    }
}
