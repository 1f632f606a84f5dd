//! What the server orders, carried out between two ticks, and what comes of it.

use shakedown_core::link::StopCause;
use shakedown_core::{OperatorRequest, Refused, Relay, State};

use shakedown_rehearsal::{Behind, Rehearsal};

use super::{ControlLoop, OpenRelay, round};
use crate::input_scaling::InputScaling;
use crate::queues::{LoopCommand, Verdict};

impl ControlLoop<'_> {
    /// Carries out one order, unless the relay's proof is lent. Returns whether there is a new setup.
    #[inline(never)]
    pub(super) fn apply_commands(&mut self) -> bool {
        if self.lent {
            self.lent = self.queues.returned.dequeue().is_none();
            return false;
        }
        match self.queues.orders.dequeue() {
            Some(LoopCommand::TakeSetup) => return self.take_setup(),
            Some(LoopCommand::Lend) => self.lend(),
            Some(LoopCommand::Ask(request)) => self.ask(request),
            Some(LoopCommand::HostSilent) => self.miss_host(),
            Some(LoopCommand::Probe(code)) => self.probe = code,
            None => {}
        }
        false
    }

    /// Proof that the relay is open, where it is: as the last tick left it, and the board has put that on its pin since.
    fn open_relay(&self) -> Option<OpenRelay> {
        (self.controller.relay() == Relay::Open).then(OpenRelay::seen)
    }

    /// Lends that proof.
    fn lend(&mut self) {
        let verdict = self.open_relay().map_or(Verdict::Refused(self.controller.state()), Verdict::Lent);
        let lends = matches!(verdict, Verdict::Lent(_));
        self.lent = self.say(verdict) && lends;
    }

    /// Exchanges the setup that waits, from where it lies: a copy would cost the stack. It was worked out by the server.
    #[inline(never)]
    fn take_setup(&mut self) -> bool {
        let open = self.open_relay();
        let Some(prepared) = self.queues.setups.peek() else { return false };
        let (wires, rate, behind) = (*prepared.zero_flow.wires(), prepared.rate, prepared.behind);
        let same_board = wires.same_board(&self.wires) && rate == self.rate;
        let verdict = if !same_board && open.is_none() {
            Verdict::Refused(self.controller.state())
        } else if self.controller.exchange(&prepared.tuning).is_err() {
            // It was worked out, and so holds by itself: what is refused with oil behind the valve may be taken without.
            if open.is_some() { Verdict::NotTaken } else { Verdict::Refused(self.controller.state()) }
        } else {
            (self.every, self.zero_flow) = (prepared.every, prepared.zero_flow);
            if let Some(open) = open {
                self.rewire(wires, rate, &open);
            }
            self.rehearsal.rewire(behind);
            self.record_at = self.counts().0;
            Verdict::Taken
        };
        self.queues.setups.dequeue();
        let taken = verdict == Verdict::Taken;
        self.say(verdict);
        taken
    }

    /// Changes what the codes mean and how fast the ticks come: never with oil behind the valve. A rehearsal's table begins anew, and
    /// neither a probe nor a reference that was read by other wires is one under these.
    fn rewire(&mut self, wires: InputScaling, rate: f32, _: &OpenRelay) {
        if !wires.same_board(&self.wires) {
            (self.probe, self.reference) = (None, 0.0);
        }
        self.wires = wires;
        self.rate = rate;
        self.round = round(rate);
        self.rehearsal = Rehearsal::new(rate, Behind::Valve);
    }

    /// Tells the server, and has it woken in this tick. Returns whether there was room.
    fn say(&mut self, verdict: Verdict) -> bool {
        self.told = u16::MAX;
        let (ticks, _) = self.counts();
        (self.left, self.due) = (1, ticks.wrapping_add(1));
        self.queues.verdicts.enqueue(verdict).is_ok()
    }

    /// Fades out a test whose host is silent, and disarms what has come to a stand.
    fn miss_host(&mut self) {
        let request = match self.controller.state() {
            State::Running | State::Hold => OperatorRequest::Stop,
            State::Ready => OperatorRequest::Off,
            _ => return,
        };
        self.attribute_trip(Some(StopCause::HostSilent));
        if self.controller.request(request).is_ok() {
            self.stream_for(request);
        }
    }

    fn ask(&mut self, request: OperatorRequest) {
        self.probe = None;
        match self.controller.request(request) {
            Ok(()) => {
                self.attribute_trip((request == OperatorRequest::Trip).then_some(StopCause::Asked));
                self.stream_for(request);
            }
            // A trip that stands has its cause already.
            Err(Refused::Cause(trip)) if self.controller.state() == State::Off => {
                self.attribute_trip(Some(StopCause::Guard(trip)));
            }
            Err(_) => {}
        }
    }
}
