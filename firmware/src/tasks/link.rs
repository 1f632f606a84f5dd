//! The link: whatever came is answered, whatever is due is sent, one frame at a time.

use shakedown_core::link::{Assembler, HostRequest, MAX_FRAME, Report, encode};
use shakedown_firmware::OpenRelay;
use shakedown_firmware::link_server::{Action, LinkServer, LoopStatus};
use shakedown_firmware::store;

use crate::board::{flash::Flash, line::Line, pins, standing, watchdog};

pub(crate) use crate::board::line::{received, sent};

/// What the link owns.
pub(crate) struct Link {
    pub(crate) server: LinkServer<'static>,
    pub(crate) line: Line,
    pub(crate) flash: Flash,
    pub(crate) assembler: Assembler,
    pub(crate) answer: Option<Report>,
}

impl Link {
    /// Reads requests as long as their answers can leave, then sends what is due.
    pub(crate) fn serve(&mut self) {
        self.line.acknowledge();
        if let Some(action) = self.server.heed() {
            self.act(action);
        }
        while self.answer.is_none() && !self.server.waits() {
            let Some(byte) = self.line.take() else { break };
            if self.assembler.gather(byte) {
                self.receive();
            }
        }
        if self.line.ready() {
            self.speak();
        }
        watchdog::served();
    }

    /// A frame is whole. By itself, like what follows: what one of them needs of the stack the others need not have free.
    #[inline(never)]
    fn receive(&mut self) {
        match self.assembler.frame::<HostRequest>() {
            Some(Ok(request)) => self.carry_out(request),
            Some(Err(_)) => self.server.count_garbled(),
            None => {}
        }
    }

    fn carry_out(&mut self, request: HostRequest) {
        let seen = seen();
        let action = self.server.take(request, seen, self.server.milliseconds(seen.ticks));
        self.act(action);
    }

    #[inline(never)]
    fn act(&mut self, action: Action) {
        match action {
            Action::Send(report) => self.answer = Some(report),
            Action::Save(proof) => self.answer = Some(self.save(proof)),
            Action::Wait => {}
        }
    }

    #[inline(never)]
    fn save(&mut self, proof: OpenRelay) -> Report {
        let Self { flash, server, .. } = self;
        let done = flash.write(&proof, |flash| store::save(flash, server.setup()));
        if let Err(error) = &done {
            defmt::error!("settings not saved: {}", defmt::Debug2Format(error));
        }
        server.saved(proof, done.is_ok())
    }

    /// Sends the answer that waits, or else what the server has to say of its own accord.
    #[inline(never)]
    fn speak(&mut self) {
        if self.answer.is_none() {
            self.answer = self.server.volunteer(seen());
        }
        let Some(report) = &self.answer else { return };
        self.line.send(|buffer: &mut [u8; MAX_FRAME]| encode(report, buffer).unwrap_or(0));
        self.answer = None;
    }
}

fn seen() -> LoopStatus {
    let (standing, ticks, dropped) = standing::read();
    LoopStatus { standing, ticks, dropped, cause: pins::standing_cause() }
}
