//! An attended device as a bench: what a page asks of it and what it answers.

use super::{Attendant, GONE_AFTER};
use crate::device::{Line, Recorder};
use crate::live::bench::{Answer, Bench, BenchError, Facts, Order, Sample, Status};
use shakedown_core::link::HostRequest;

impl<L: Line> Bench for Attendant<L> {
    fn facts(&self) -> Facts {
        self.facts.clone()
    }

    fn advance(&mut self) -> Result<Vec<Sample>, BenchError> {
        self.pump()?;
        let now = self.now();
        self.listen(now);
        self.speak(now)?;
        let rows = self.telemetry.take_rows();
        let gaps = self.telemetry.take_gaps();
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.take(&rows)
        {
            // A test that is recorded no more is ended.
            self.stop();
            self.recorder = None;
            self.say(format!("the test is ended, for its recording cannot go on: {error}"));
        }
        Ok(self.samples.of(&rows, &gaps))
    }

    fn status(&self) -> Status {
        let now = self.now();
        let total = if self.storage.reference.is_empty() {
            self.storage.attended.unwrap_or(0)
        } else {
            self.storage.reference.len() as u64
        };
        Status {
            phase: self.phase(),
            state: self.state(),
            cause: self.vitals.and_then(|vitals| vitals.cause).map(|cause| format!("{cause:?}")),
            answers: now < self.heard + GONE_AFTER,
            gone: self.gone.min(total),
            total,
            samples: self.samples.count(),
            missing: self.samples.missing(),
            dropped: u64::from(self.telemetry.dropped()),
            garbled: self.talker.heard().garbled,
            recorded: self.recorder.as_ref().map_or(0, Recorder::rows),
            message: self.message.1.clone(),
            message_number: self.message.0,
        }
    }

    fn order(&mut self, order: Order) -> Result<Answer, String> {
        let done = |outcome: Result<(), String>| outcome.map(|()| Answer::default());
        match order {
            Order::Arm => self.arm(),
            Order::Confirm(number) => done(self.confirm(number)),
            Order::Start => done(self.begin()),
            Order::Hold => done(self.hold()),
            Order::Stop => {
                self.stop();
                Ok(Answer::default())
            }
            Order::Trip => {
                self.arming.forget();
                self.talker.say(&HostRequest::Trip);
                self.tripping = Some(self.now());
                self.say("tripping");
                Ok(Answer::default())
            }
        }
    }

    fn is_idle(&self) -> bool {
        self.drive.is_none() && self.tripping.is_none()
    }
}
