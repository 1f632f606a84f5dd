//! The sampling timer's updates, from its registers.

/// Nanoseconds to so many counts of the timer, which has 84 MHz.
const NANOSECONDS: (u64, u64) = (250, 21);

/// The timer's updates, from its registers. A reload that is preloaded counts from the next update on (RM0090, 18.4.1, ARPE).
#[derive(Debug, Clone, Copy)]
pub(super) struct Timer {
    pub(super) running: bool,
    pub(super) started: u64,
    pub(super) updates: u64,
    reload: u64,
    preload: u64,
    preloads: bool,
    /// Counts before the first update of this start and since, at the reload in force then.
    counts: u64,
}

/// Of the control register: the reload is preloaded.
const ARPE: u64 = 1 << 7;
/// The reload after a reset.
const LONGEST: u64 = 0xFFFF_FFFF;

impl Default for Timer {
    fn default() -> Self {
        Self { running: false, started: 0, updates: 0, reload: LONGEST, preload: LONGEST, preloads: false, counts: 0 }
    }
}

impl Timer {
    /// A write to the reload's register.
    pub(super) fn set_reload(&mut self, value: u64) {
        self.preload = value;
        if !self.preloads {
            self.reload = value;
        }
    }

    /// A write to the control register.
    pub(super) fn control(&mut self, value: u64) {
        self.preloads = value & ARPE != 0;
    }

    /// Starts at `at`, ns.
    pub(super) fn start(&mut self, at: u64) {
        *self = Self { running: true, started: at, updates: 0, counts: 0, ..*self };
    }

    /// An update.
    pub(super) fn update(&mut self) {
        self.updates += 1;
        self.reload = self.preload;
    }

    /// When the next one comes, ns.
    pub(super) fn next(&mut self) -> u64 {
        self.counts += self.reload + 1;
        self.started + self.counts * NANOSECONDS.0 / NANOSECONDS.1
    }
}
