//! The link's task on any board: whatever came is answered, whatever is due is sent, one frame at a time.

use shakedown_core::link::{Assembler, HostRequest, LinkError, MAX_FRAME, Report, Setup, StopCause, encode};

use crate::OpenRelay;
use crate::link_server::{Action, LinkServer, LoopStatus};
use crate::options::Options;
use crate::published;
use crate::queues::TestStatus;

/// What the link asks of a board. Nothing here waits but [`LinkBoard::save`].
pub trait LinkBoard {
    /// Forgets what woke the task, where the line wants that.
    fn acknowledge(&mut self);

    /// The next byte that has come.
    fn take(&mut self) -> Option<u8>;

    /// Whether the last frame has left.
    fn ready(&self) -> bool;

    /// Sends what `write` puts into the frame buffer, if it is free; `write` returns the length, 0 for nothing.
    fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize);

    /// Writes `setup` to flash with the ticks stopped; whether it is there. The proof says that nothing moves meanwhile.
    fn save(&mut self, proof: &OpenRelay, setup: &Setup) -> bool;

    /// A cause of a trip that stands on the board's inputs now.
    fn standing_cause(&self) -> Option<StopCause>;

    /// The option bytes that matter to this board, as they are in force.
    fn options(&self) -> Options;

    /// The link has been served: a watchdog wants to know.
    fn served(&self);

    /// Logs where the test stands.
    fn log(&self, standing: TestStatus);
}

/// What the link owns.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct Link<'q, B> {
    server: LinkServer<'q>,
    board: B,
    assembler: Assembler,
    answer: Option<Report>,
    /// What was logged last.
    logged: Option<TestStatus>,
}

impl<'q, B: LinkBoard> Link<'q, B> {
    /// The link of `server` over `board`.
    pub const fn new(server: LinkServer<'q>, board: B) -> Self {
        Self { server, board, assembler: Assembler::new(), answer: None, logged: None }
    }

    /// Logs where the test stands, when that has changed.
    fn log(&mut self) {
        let (standing, _, _) = published::read();
        if self.logged != Some(standing) {
            self.logged = Some(standing);
            self.board.log(standing);
        }
    }

    /// Reads requests as long as their answers can leave, then sends what is due.
    pub fn serve(&mut self) {
        self.board.acknowledge();
        if let Some(action) = self.server.heed() {
            self.act(action);
        }
        while self.answer.is_none() && !self.server.waits() {
            let Some(byte) = self.board.take() else { break };
            if self.assembler.gather(byte) {
                self.receive();
            }
        }
        if self.board.ready() {
            self.speak();
        }
        self.log();
        self.board.served();
    }

    /// A frame is whole. By itself, like what follows: what one of them needs of the stack the others need not have free.
    #[inline(never)]
    fn receive(&mut self) {
        match heard(&mut self.assembler) {
            Some(Ok(request)) => self.carry_out(request),
            Some(Err(_)) => self.server.count_garbled(),
            None => {}
        }
    }

    fn carry_out(&mut self, request: HostRequest) {
        let seen = self.seen();
        let action = self.server.take(request, seen, self.server.milliseconds(seen.ticks));
        self.act(action);
    }

    #[inline(never)]
    fn act(&mut self, action: Action) {
        match action {
            Action::Send(report) => self.answer = Some(report),
            Action::Save(proof) => self.answer = Some(self.save(proof)),
            Action::TellOptions => self.answer = Some(Report::Options(self.board.options())),
            Action::Wait => {}
        }
    }

    #[inline(never)]
    fn save(&mut self, proof: OpenRelay) -> Report {
        let done = self.board.save(&proof, self.server.setup());
        self.server.saved(proof, done)
    }

    /// Sends the answer that waits, or else what the server has to say of its own accord.
    #[inline(never)]
    fn speak(&mut self) {
        if self.answer.is_none() {
            self.answer = self.server.volunteer(self.seen());
        }
        let Some(report) = &self.answer else { return };
        self.board.send(|buffer| written(report, buffer));
        self.answer = None;
    }

    fn seen(&self) -> LoopStatus {
        let (standing, ticks, dropped) = published::read();
        LoopStatus { standing, ticks, dropped, cause: self.board.standing_cause() }
    }
}

/// The request that the assembler has gathered. Not part of what is made anew for every board, and neither is its counterpart: the
/// frames are the same, and so is the code.
#[inline(never)]
fn heard(assembler: &mut Assembler) -> Option<Result<HostRequest, LinkError>> {
    assembler.frame()
}

/// Bytes of `report`'s frame in `buffer`; 0 where it does not fit, and every report does.
#[inline(never)]
fn written(report: &Report, buffer: &mut [u8; MAX_FRAME]) -> usize {
    encode(report, buffer).unwrap_or(0)
}
