//! What the emulator forgives and the silicon does not: a crystal that does not start, a core that stands while its flash is
//! erased, a data register that gives its byte to whoever reads it first. And what the firmware set, for tests to hold against the
//! reference manual (RM0090) and the data sheet.

use std::collections::BTreeMap;

use rigless::emulator::{Access, AccessKind, Host};
use rigless::session::Session;
use rigless::soc::stm32f427::generated::rcc::{Register, cr};
use rigless::time::VirtualNanos;

use super::board::Board;
use crate::Oscillator;

const RCC_CR: u64 = 0x4002_3800;
const USART3_SR: u64 = 0x4000_4800;
const USART3_DR: u64 = 0x4000_4804;
const IDLE: u64 = 1 << 4;
const RXNE: u64 = 1 << 5;
const FLASH_CR: u64 = 0x4002_3C10;
const FLASH: std::ops::RangeInclusive<u64> = 0x4002_3C00..=FLASH_CR;
const STRT: u64 = 1 << 16;
/// Time in which a sector of 128 kB is erased, ns: typical at 32 bits a step (data sheet, table 42).
const ERASE: u64 = 1_000_000_000;
/// Port D's pulls, the supply monitor, the output converter, the clocks' control and the generator of random numbers.
const CONFIGURATION: [u64; 5] = [0x4002_0C0C, 0x4000_7000, 0x4000_7400, RCC_CR, 0x5006_0800];

/// What the silicon would have taken amiss, and what was set.
#[derive(Debug, Clone, Default)]
pub struct Silicon {
    /// Reads of the line's data register by the program while the line was not idle, or a byte stood there for the DMA.
    pub stolen: u64,
    /// Times that the core stood for an erase.
    pub stalls: u64,
    /// Writes to the flash's registers, by address, in their order.
    pub flash: Vec<(u64, u64)>,
    configuration: BTreeMap<u64, u64>,
    ever: BTreeMap<u64, u64>,
    status: u64,
    stands_until: Option<u64>,
}

impl Silicon {
    /// What was last written to a register of [`CONFIGURATION`]; none where nothing was.
    pub fn written(&self, address: u64) -> Option<u64> {
        self.configuration.get(&address).copied()
    }

    /// The bits of a register of [`CONFIGURATION`] that were ever written as ones.
    pub fn ever_set(&self, address: u64) -> u64 {
        self.ever.get(&address).copied().unwrap_or(0)
    }

    /// An access that has settled.
    pub(super) fn settled(
        &mut self,
        session: &mut Session<Board>,
        host: &mut dyn Host,
        oscillator: Oscillator,
        access: Access,
        value: u64,
    ) {
        if access.kind == AccessKind::Write && FLASH.contains(&access.address) {
            self.flash.push((access.address, value));
        }
        if access.kind == AccessKind::Write && CONFIGURATION.contains(&access.address) {
            self.configuration.insert(access.address, value);
            *self.ever.entry(access.address).or_default() |= value;
        }
        match (access.kind, access.address) {
            (AccessKind::Read, USART3_SR) => self.status = value,
            (AccessKind::Read, USART3_DR) if access.program_counter.is_some() => {
                self.stolen += u64::from(self.status & IDLE == 0 || self.status & RXNE != 0);
            }
            (AccessKind::Write, RCC_CR) => start(session, oscillator),
            (AccessKind::Write, FLASH_CR) if value & STRT != 0 && self.stands_until.is_none() => {
                self.stalls += 1;
                self.stand(session, host, access.virtual_time.0 + ERASE);
            }
            _ => {}
        }
    }

    /// The core stands until then.
    pub(super) fn stand(&mut self, session: &mut Session<Board>, host: &mut dyn Host, until: u64) {
        self.stands_until = Some(until);
        host.hold(true);
        session.pause_at(Some(VirtualNanos(until)));
    }

    /// The core goes on when it has stood long enough.
    pub(super) fn stopped(&mut self, session: &mut Session<Board>, host: &mut dyn Host, now: u64) {
        match self.stands_until {
            Some(until) if now >= until => {
                self.stands_until = None;
                session.pause_at(None);
                host.hold(false);
            }
            Some(until) => session.pause_at(Some(VirtualNanos(until))),
            None => {}
        }
    }
}

/// An oscillator that does not start stays off: the emulator's reaches ready with nothing on its pins.
fn start(session: &mut Session<Board>, oscillator: Oscillator) {
    let (_, registers) = session.board_mut().part.whole.clocks();
    let control = registers.get(Register::Cr);
    let starts = match oscillator {
        Oscillator::Crystal => !cr::HSEBYP.is_set(control),
        Oscillator::External => cr::HSEBYP.is_set(control),
        Oscillator::Dead => false,
    };
    if !starts && cr::HSEON.is_set(control) {
        registers.set(Register::Cr, cr::HSERDY.set(cr::HSEON.set(control, 0), 0));
    }
}
