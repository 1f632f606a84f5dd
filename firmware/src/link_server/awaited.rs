//! What only the loop can answer: whether it takes a setup, and whether the relay is open.

use shakedown_core::State;
use shakedown_core::link::{RefusedBecause, Report, Setup};

use super::{Action, LinkServer, at_rest};
use crate::control_loop::{OpenRelay, Prepared};
use crate::queues::{LoopCommand, Verdict};

/// What the server waits for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is one of them")]
pub(super) enum Awaited {
    /// That the loop takes this setup, or does not.
    Setup(Setup),
    /// Proof of an open relay, to save with.
    Proof,
}

impl LinkServer<'_> {
    /// Gives back the proof under which [`Action::Save`] was carried out; `done` where the setup in force is now the one in
    /// flash. What to say of it.
    pub fn saved(&mut self, proof: OpenRelay, done: bool) -> Report {
        // There is one proof and room for one.
        let _ = self.queues.returned.enqueue(proof);
        self.stored |= done;
        if done { Report::Done } else { Report::Refused(RefusedBecause::Flash) }
    }

    /// Whether the answer to the last request is still to come.
    pub const fn waits(&self) -> bool {
        self.awaited.is_some()
    }

    /// What to do about what the loop says, if it has said anything.
    pub fn heed(&mut self) -> Option<Action> {
        let verdict = self.queues.verdicts.dequeue()?;
        let awaited = self.awaited.take();
        let refused = |because| Some(Action::Send(Report::Refused(because)));
        match (verdict, awaited) {
            (Verdict::Lent(proof), Some(Awaited::Proof)) => Some(Action::Save(proof)),
            (Verdict::Lent(proof), _) => {
                let _ = self.queues.returned.enqueue(proof);
                None
            }
            (Verdict::Taken, Some(Awaited::Setup(setup))) => {
                (self.setup, self.stored) = (setup, false);
                Some(Action::Send(Report::Done))
            }
            (Verdict::Refused(state), _) => refused(RefusedBecause::State(state)),
            (Verdict::NotTaken | Verdict::Taken, _) => refused(RefusedBecause::Setup),
        }
    }

    /// Hands a setup to the loop, which takes it or not. What is refused here would be refused there: the loop knows the relay,
    /// and the server only what was published last.
    pub(super) fn write(&mut self, setup: &Setup, state: State) -> Result<(), RefusedBecause> {
        let wired = |setup: &Setup| {
            let control = &setup.control;
            (setup.wiring, control.rate, control.mode, control.inner_loop)
        };
        if !at_rest(state) && wired(setup) != wired(&self.setup) {
            return Err(RefusedBecause::State(state));
        }
        self.limits.check(setup)?;
        self.prepare(setup)?;
        let _ = self.queues.orders.enqueue(LoopCommand::TakeSetup);
        self.awaited = Some(Awaited::Setup(*setup));
        Ok(())
    }

    /// Works `setup` out, which takes longer than a tick, and puts it where the loop finds it. By itself, for its stack.
    #[inline(never)]
    fn prepare(&mut self, setup: &Setup) -> Result<(), RefusedBecause> {
        let prepared = Prepared::new(setup).map_err(|_| RefusedBecause::Setup)?;
        // Both or neither: one without the other would be the setup of another order.
        if !self.queues.orders.ready() || self.queues.setups.enqueue(prepared).is_err() {
            return Err(RefusedBecause::Full);
        }
        Ok(())
    }
}
