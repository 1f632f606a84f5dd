//! What reaches the board from outside: samples of its converters, and its pins.

use std::sync::PoisonError;

use rigless::device::Level;
use rigless::emulator::{Host, InterruptLine};
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;

use super::board::Board;
use super::driver::Lockstep;
use crate::World;
use crate::world::SCANS;

/// Where the firmware acknowledges the DMA's interrupt, and its line.
const DMA2_LIFCR: u64 = 0x4002_6408;
const DMA2_STREAM0: u16 = 56;
const ADC1_CR2: u64 = 0x4001_2008;
const SWSTART: u64 = 1 << 30;
const DMA2_S0CR: u64 = 0x4002_6410;
const ADON: u64 = 1;
/// Port B, and the emergency stop on it; port A, and the outboard converter's busy on it.
const PORT_B: usize = 1;
const STOP_PIN: u8 = 1;
const PORT_A: usize = 0;
const BUSY_PIN: u8 = 2;

impl<W: World> Lockstep<W> {
    /// The emergency stop and the outboard converter's busy, as they are.
    pub(super) fn circuit(&self, session: &mut Session<Board>, at: VirtualNanos) {
        drive(session, at, PORT_B, STOP_PIN, !self.circuit_closed);
        if self.outboard.is_some() {
            drive(session, at, PORT_A, BUSY_PIN, self.busy);
        }
    }

    /// An update: the converters sample where they are set up to.
    pub(super) fn convert(&mut self, session: &mut Session<Board>, at: VirtualNanos) {
        if self.outboard.is_some() {
            return self.convert_outboard(session, at);
        }
        let part = &mut session.board_mut().part;
        if self.world.overruns() {
            let _ = part.write(at, DMA2_S0CR, Width::W32, 0);
            self.sampling.notice(DMA2_S0CR, 0);
            let control = part.read(at, ADC1_CR2, Width::W32).unwrap_or(0);
            if control & ADON != 0 {
                let _ = part.write(at, ADC1_CR2, Width::W32, control | SWSTART);
            }
        } else if self.world.converts()
            && let Some(way) = self.sampling.on_chip(part, at)
        {
            self.scans = Some((at.0 + way.takes, way.buffer, self.world.scans(self.inputs)));
        }
    }

    /// The chips outboard sample, where they are asked to; one that is dead or late stays busy.
    fn convert_outboard(&mut self, session: &mut Session<Board>, at: VirtualNanos) {
        let asked = self.sampling.outboard(&mut session.board_mut().part, at);
        let busy = !asked || !self.world.converts() || self.world.overruns();
        if let Some(wires) = self.outboard.as_ref().filter(|_| !busy) {
            wires.lock().unwrap_or_else(PoisonError::into_inner).inputs = Some(self.inputs);
        }
        if busy != self.busy {
            self.busy = busy;
            drive(session, at, PORT_A, BUSY_PIN, busy);
        }
    }

    /// The scans of a tick have ended: they are in memory, and the DMA says so.
    pub(super) fn deliver(host: &mut dyn Host, buffer: u64, scans: &[[u16; 4]; SCANS]) {
        let halves = scans.as_flattened().iter().zip((buffer..).step_by(2));
        for (&code, address) in halves {
            let _ = host.write(address, Width::W16, u64::from(code));
        }
        raise(host, Level::High);
    }

    /// A write of the firmware's by which it acknowledges the samples.
    pub(super) fn acknowledge(&self, host: &mut dyn Host, address: u64) {
        if address == DMA2_LIFCR && self.outboard.is_none() {
            raise(host, Level::Low);
        }
    }
}

/// Puts a level on a pin from outside.
fn drive(session: &mut Session<Board>, at: VirtualNanos, port: usize, pin: u8, high: bool) {
    let level = if high { Level::High } else { Level::Low };
    if let Some(pin) = Pin::new(pin) {
        let part = &mut session.board_mut().part.whole;
        part.drive_port(at, port, |port, registers, context| port.drive(pin, Some(level), registers, context));
    }
}

/// The interrupt of the DMA's stream of samples.
fn raise(host: &mut dyn Host, level: Level) {
    if let Some(line) = InterruptLine::new(DMA2_STREAM0) {
        host.set_interrupt(line, level);
    }
}
