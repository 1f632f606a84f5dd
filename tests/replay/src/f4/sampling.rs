//! From an update of the sampling timer to samples in the firmware's hands, which the emulator has no chain of triggers for.
//!
//! Samples come only where every register on their way is set as the reference manual (RM0090) asks: one that is not leaves the
//! converter silent, as it does on silicon.

use std::collections::BTreeMap;

use rigless::mcu::Operate;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::board::Part;
use crate::world::SCANS;

/// A register, the bits of it that matter, and what they must be.
type Required = (u64, u64, u64);

const TIM1: u64 = 0x4001_0000;
const TIM2: u64 = 0x4000_0000;
const ADC1: u64 = 0x4001_2000;
const GPIOA: u64 = 0x4002_0000;
const SPI1: u64 = 0x4001_3000;
const SPI2: u64 = 0x4000_3800;
const DMA2_STREAM0: u64 = 0x4002_6410;
const COMMON: u64 = ADC1 + 0x304;
const BUFFER: u64 = DMA2_STREAM0 + 0x0C;
const ARR: u64 = TIM1 + 0x2C;

/// 16 scans of four inputs by TIM1, which TIM2 starts, carried by the DMA.
const ON_CHIP: [Required; 17] = [
    // The update is TIM2's trigger output.
    (TIM2 + 0x04, 0x70, 0b010 << 4),
    // One pulse; started by ITR1, trigger mode; PWM mode 2 on channel 1, on; 16 periods; outputs on.
    (TIM1, 0x78, 1 << 3),
    (TIM1 + 0x08, 0x77, 0x16),
    (TIM1 + 0x18, 0x73, 0x70),
    (TIM1 + 0x20, 0b11, 0b01),
    (TIM1 + 0x28, 0xFFFF, 0),
    (TIM1 + 0x30, 0xFF, SCANS as u64 - 1),
    (TIM1 + 0x44, 1 << 15, 1 << 15),
    // Scan of 12 bits; rising edge of TIM1_CC1, DMA without end, on; 15 cycles; inputs 0 to 3; a quarter of 84 MHz.
    (ADC1 + 0x04, 3 << 24 | 1 << 8, 1 << 8),
    (ADC1 + 0x08, 3 << 28 | 0xF << 24 | 0xB03, 1 << 28 | 0x301),
    (ADC1 + 0x10, 0o7777, 0o1111),
    (ADC1 + 0x2C, 0xF << 20, 3 << 20),
    (ADC1 + 0x34, 0xF_FFFF, 1 << 5 | 2 << 10 | 3 << 15),
    (COMMON, 3 << 16, 1 << 16),
    // Channel 0, half words, memory upwards, circular, to memory, both interrupts, on; 64 of them from the data register.
    (DMA2_STREAM0, 7 << 25 | 0x7FD5, 1 << 13 | 1 << 11 | 1 << 10 | 1 << 8 | 1 << 4 | 1 << 2 | 1),
    (DMA2_STREAM0 + 0x04, 0xFFFF, 4 * SCANS as u64),
    (DMA2_STREAM0 + 0x08, 0xFFFF_FFFF, ADC1 + 0x4C),
];

/// A conversion started by TIM2's channel 2 on PA1, and read in mode 2, most significant bit first, at an eighth of 84 MHz and a quarter
/// of 42.
const OUTBOARD: [Required; 6] = [
    (TIM2 + 0x18, 0x7300, 0x6000),
    (TIM2 + 0x20, 3 << 4, 1 << 4),
    (GPIOA, 3 << 2, 2 << 2),
    (GPIOA + 0x20, 0xF << 4, 1 << 4),
    (SPI1, 0xBF, 0b010 << 3 | 0b110),
    (SPI2, 0xBF, 0b001 << 3 | 0b110),
];

/// Nanoseconds of a scan: 4 x 27 cycles of 21 MHz. Of so many counts of TIM1: 168 MHz.
const SCAN: u64 = 4 * 27 * 1000 / 21;
const COUNTS: (u64, u64) = (125, 21);

/// What is written in every tick and sets nothing up: the timer's flags, selects, data of both buses.
const EVERY_TICK: [u64; 4] = [TIM2 + 0x10, GPIOA + 0x18, SPI1 + 0x0C, SPI2 + 0x0C];

/// Whether the way is set up, looked at again once it may have changed.
#[derive(Debug, Default)]
pub(super) struct Sampling {
    /// What the firmware wrote to TIM2 last: a read of it between two stops would move the emulator's own.
    timer: BTreeMap<u64, u64>,
    looked: bool,
    way: Option<Way>,
}

/// Where samples go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// The buffer in memory.
    pub(super) buffer: u64,
    /// From the update to the last scan's end, ns.
    pub(super) takes: u64,
}

impl Sampling {
    /// A write of the firmware's.
    pub(super) fn notice(&mut self, address: u64, value: u64) {
        if EVERY_TICK.contains(&address) {
            return;
        }
        if address & !0x3FF == TIM2 {
            self.timer.insert(address, value);
        }
        let on_the_way = [TIM1, TIM2, ADC1, GPIOA, SPI1, SPI2].contains(&(address & !0x3FF));
        if on_the_way || (DMA2_STREAM0..DMA2_STREAM0 + 0x18).contains(&address) {
            self.looked = false;
        }
    }

    /// The way of the on-chip converter's samples; none where it is not set up.
    pub(super) fn on_chip(&mut self, part: &mut Part, at: VirtualNanos) -> Option<Way> {
        if !std::mem::replace(&mut self.looked, true) {
            let read = |part: &mut Part, address| part.read(at, address, Width::W32).unwrap_or(0);
            let period = (read(part, ARR) + 1) * COUNTS.0 / COUNTS.1;
            let buffer = read(part, BUFFER);
            let takes = (SCANS as u64 - 1) * period + SCAN;
            self.way = (self.set(part, at, &ON_CHIP) && period > SCAN).then_some(Way { buffer, takes });
        }
        self.way
    }

    /// Whether outboard converters are started and read as they want it.
    pub(super) fn outboard(&mut self, part: &mut Part, at: VirtualNanos) -> bool {
        if !std::mem::replace(&mut self.looked, true) {
            self.way = self.set(part, at, &OUTBOARD).then_some(Way { buffer: 0, takes: 0 });
        }
        self.way.is_some()
    }

    fn set(&self, part: &mut Part, at: VirtualNanos, all: &[Required]) -> bool {
        all.iter().all(|&(address, bits, value)| {
            let read = if address & !0x3FF == TIM2 {
                self.timer.get(&address).copied()
            } else {
                part.read(at, address, Width::W32).ok()
            };
            read.is_some_and(|read| read & bits == value)
        })
    }
}
