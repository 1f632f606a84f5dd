//! The board: the part with the instances that the firmware uses, and no chips but what [`super::wire`] puts at its line.
//!
//! A part of the library's tells every instance it carries of every request line that moves, and asks every port for a
//! byte at every stop. Only what is named here has a model; the rest answers from its registers alone, and a firmware that
//! touches it adds to [`super::Ran::blind_spots`].

use std::num::{NonZeroU32, NonZeroU64};
use std::sync::{Arc, Mutex, PoisonError};

use rigless::cpu::armv7m::windows;
use rigless::device::{ErasedDevice, ResetCause};
use rigless::machine::{self, Target, armv7m};
use rigless::mcu::{Mcu, Operate};
use rigless::snapshot::Store;
use rigless::soc::stm32f427::Stm32f427;
use rigless::soc::stm32f427::generated::flash::Register;
use rigless::soc::{Bus, Error};
use rigless::time::VirtualNanos;

use super::outboard::{Ad5761r, Ad7606, Wires, select};
use super::wire::Wire;
use crate::Line;

/// What has a model.
const CARRIED: [&str; 14] = [
    "RCC", "PWR", "FLASH", "IWDG", "DWT", "TIM2", "ADC1", "C_ADC", "DMA1", "DMA2", "USART3", "GPIOA", "GPIOB", "GPIOD",
];
/// USART3 in the part's list of ports.
const PORT: usize = 2;
/// What has a model besides where the converters are outboard.
const CARRIED_OUTBOARD: [&str; 2] = ["SPI1", "SPI2"];
/// SPI1 and SPI2 in the part's list of serial interfaces.
const INPUT_BUS: usize = 0;
const OUTPUT_BUS: usize = 1;
/// Crystals, Hz: none at the slow pair.
const CRYSTALS: (u64, u64) = (8_000_000, 0);
/// Supply, mV.
const SUPPLY: u32 = 3300;
const CLOCK_HZ: u64 = 168_000_000;
const PRIORITY_BITS: u8 = 4;
/// What the processor's clock is divided by for its own timer.
const TIMER_DIVIDER: u32 = 8;
const NAME: &str = "shakedown";

/// The part, less what the firmware has no use for.
#[derive(Debug)]
pub(super) struct Part {
    /// The library's.
    pub(super) whole: Stm32f427,
    carried: Vec<bool>,
    line: Arc<Mutex<Line>>,
}

impl Mcu for Part {
    fn bus(&self) -> &Bus {
        self.whole.bus()
    }

    fn bus_mut(&mut self) -> &mut Bus {
        self.whole.bus_mut()
    }

    fn reset(&mut self, at: VirtualNanos, cause: ResetCause) {
        self.whole.reset(at, cause);
    }

    /// A port asks its far end for a byte; a line with none to send need not be asked.
    fn poll(&mut self, now: VirtualNanos) {
        let silent = self.line.lock().unwrap_or_else(PoisonError::into_inner).to_device.is_empty();
        if !silent {
            self.whole.poll(now);
        }
    }

    fn split(&mut self, slot: usize) -> (&mut Bus, Option<&mut dyn ErasedDevice>) {
        if self.carried.get(slot).copied().unwrap_or(false) {
            self.whole.split(slot)
        } else {
            (self.whole.bus_mut(), None)
        }
    }
}

/// The board.
#[derive(Debug)]
pub(super) struct Board {
    pub(super) part: Part,
}

impl Board {
    /// The board with the world at its line.
    pub(super) fn new(line: Arc<Mutex<Line>>, outboard: Option<Wires>) -> Result<Self, Error> {
        let mut whole = Stm32f427::new()?;
        whole.rcc.attach_crystals(CRYSTALS.0, CRYSTALS.1);
        whole.set_supply(SUPPLY);
        whole.usart[PORT].attach(Wire(Arc::clone(&line)));
        let more: &[&str] = if outboard.is_some() { &CARRIED_OUTBOARD } else { &[] };
        if let (Some(wires), Some(input), Some(output)) = (outboard, select("GPIOA", 3), select("GPIOB", 12)) {
            whole.spi[INPUT_BUS].attach_selected(Ad7606::new(Arc::clone(&wires)), input);
            whole.spi[OUTPUT_BUS].attach_selected(Ad5761r::new(wires), output);
        }
        let named = |name| CARRIED.contains(&name) || more.contains(&name);
        let carried = whole.bus().slots().iter().map(|slot| named(slot.peripheral().name)).collect();
        Ok(Self { part: Part { whole, carried, line } })
    }

    /// The option bytes, which a reset takes from the flash anew.
    pub(super) fn set_options(&mut self, bytes: u32) {
        let bus = self.part.bus_mut();
        if let Some(place) = bus.slots().iter().position(|slot| slot.peripheral().name == "FLASH") {
            bus.slot_mut(place).registers_mut().set(Register::Optcr, bytes.into());
        }
    }
}

/// A run is repeated, not resumed.
impl Store for Board {}

impl machine::Board for Board {
    fn name(&self) -> &'static str {
        NAME
    }

    fn target_names(&self) -> Vec<&'static str> {
        vec![NAME]
    }

    fn mcu(&mut self, target: usize) -> Option<&mut dyn Mcu> {
        (target == 0).then_some(&mut self.part)
    }

    fn targets(&mut self) -> Vec<Target<'_>> {
        let lines = u32::from(self.part.cpu().interrupt_lines);
        let (Some(clock_hz), Some(interrupt_lines), Some(refclk_divider)) =
            (NonZeroU64::new(CLOCK_HZ), NonZeroU32::new(lines), NonZeroU32::new(TIMER_DIVIDER))
        else {
            return Vec::new();
        };
        let core = armv7m::Core {
            variant: armv7m::Variant::M4,
            clock_hz,
            interrupt_lines,
            priority_bits: PRIORITY_BITS,
            refclk_divider,
            instructions_per_second: armv7m::INSTRUCTIONS_PER_SECOND,
            boot: "flash",
        }
        .spec_with_parts(&windows(self.part.bus()), armv7m::Fpu::FpV4Sp, armv7m::MpuRegions::Eight);
        vec![Target::new(NAME, &mut self.part, core)]
    }
}
