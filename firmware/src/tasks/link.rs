//! The link: whatever came is answered, whatever is due is sent, one frame at a time.

use shakedown_core::link::{Assembler, MAX_FRAME, Report, Request, encode};
use shakedown_firmware::OpenRelay;
use shakedown_firmware::desk::{Action, Desk, Seen};
use shakedown_firmware::queues::Standing;
use shakedown_firmware::store;

use crate::board::{flash::Flash, line::Line, pins, standing, watchdog};

pub(crate) use crate::board::line::{received, sent};

/// What the link owns.
pub(crate) struct Link {
    pub(crate) desk: Desk<'static>,
    pub(crate) line: Line,
    pub(crate) flash: Flash,
    pub(crate) assembler: Assembler,
    pub(crate) answer: Option<Report>,
    /// What was logged last.
    pub(crate) logged: Option<Standing>,
}

impl Link {
    /// Logs where the test stands, when that has changed.
    fn log(&mut self) {
        let (standing, _, _) = standing::read();
        if self.logged != Some(standing) {
            self.logged = Some(standing);
            log(standing);
        }
    }

    /// Reads requests as long as their answers can leave, then sends what is due.
    pub(crate) fn serve(&mut self) {
        self.line.acknowledge();
        if let Some(action) = self.desk.heed() {
            self.act(action);
        }
        while self.answer.is_none() && !self.desk.waits() {
            let Some(byte) = self.line.take() else { break };
            if self.assembler.gather(byte) {
                self.hear();
            }
        }
        if self.line.ready() {
            self.speak();
        }
        self.log();
        watchdog::served();
    }

    /// A frame is whole. By itself, like what follows: what one of them needs of the stack the others need not have free.
    #[inline(never)]
    fn hear(&mut self) {
        match self.assembler.frame::<Request>() {
            Some(Ok(request)) => self.carry_out(request),
            Some(Err(_)) => self.desk.count_garbled(),
            None => {}
        }
    }

    fn carry_out(&mut self, request: Request) {
        let seen = seen();
        let action = self.desk.take(request, seen, self.desk.milliseconds(seen.ticks));
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
        let Self { flash, desk, .. } = self;
        let done = flash.write(&proof, |flash| store::save(flash, desk.setup()));
        if let Err(error) = &done {
            defmt::error!("settings not saved: {}", defmt::Debug2Format(error));
        }
        desk.saved(proof, done.is_ok())
    }

    /// Sends the answer that waits, or else what the desk has to say of its own accord.
    #[inline(never)]
    fn speak(&mut self) {
        if self.answer.is_none() {
            self.answer = self.desk.volunteer(seen());
        }
        let Some(report) = &self.answer else { return };
        self.line.send(|buffer: &mut [u8; MAX_FRAME]| encode(report, buffer).unwrap_or(0));
        self.answer = None;
    }
}

#[cold]
#[inline(never)]
fn log(standing: Standing) {
    defmt::info!("{}", standing);
}

fn seen() -> Seen {
    let (standing, ticks, dropped) = standing::read();
    Seen { standing, ticks, dropped, cause: pins::standing_cause() }
}
