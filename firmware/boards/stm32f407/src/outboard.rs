//! Converters of 16 bits outboard: an AD7606 on SPI1, an AD5761R on SPI2, both +/-10 V, so no level shifter stands before them.
//!
//! | pin | is |
//! |---|---|
//! | PA0 | RESET of the input converter |
//! | PA1 | CONVST A and B: TIM2's channel 2, high for 1 microsecond from the update on |
//! | PA2 | BUSY, pulled up: one that is not there is busy |
//! | PA3 | CS of the input converter |
//! | PA5, PA6 | its SCLK and DOUTA |
//! | PB12, PB13, PB15 | SYNC, SCLK and SDI of the output converter |
//!
//! A conversion of 16 scans takes 78 microseconds at most (AD7606 data sheet, t_CONV, oversampling by 16); the tick comes by TIM2's
//! channel 1 after 85, whatever the converter does, and finds it busy or its reference astray where it is not well. Reading five channels
//! takes 8 microseconds at 10.5 MHz, writing the code 2.

use core::sync::atomic::{AtomicU16, Ordering};

use embedded_hal::spi::{ErrorType, MODE_2};
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
use shakedown_firmware::Codes;
use shakedown_firmware::converters::{
    Converters,
    outboard::{self, last_frame},
};
use shakedown_firmware::limits::Limits;
use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::parts;
use stm32f4xx_hal::{
    gpio::{Input, Output, PA0, PA2, Pin, Speed},
    pac::{GPIOB, Interrupt, NVIC, SPI1, SPI2, TIM2},
    prelude::*,
    rcc::Rcc,
    spi::Spi,
};

use crate::pair::{Pair, Parts};

/// Counts of 84 MHz from the update to the tick.
const CONVERSION: u32 = 85 * 84;
/// Clock of both buses: within the 15 MHz that the input converter takes at 3.3 V.
const BUS_HZ: u32 = 10_500_000;
/// Cycles that the input converter is held in reset: 1 microsecond, where 50 ns are asked for.
const RESET: u32 = 168;
/// Looks at the bus while the last code goes out, of ten cycles and more each: ten times what a frame takes.
const LOOKS: u32 = 400;
/// PB12 in the port's set/reset register.
const SELECT: u32 = 1 << 12;
const DESELECT: u32 = 1 << 28;

/// What the input converter's LVDT channel read last, whoever reads it otherwise.
static DISPLACEMENT: AtomicU16 = AtomicU16::new(1 << 15);

type InputDevice = ExclusiveDevice<Spi<SPI1>, Pin<'A', 3, Output>, NoDelay>;
type OutputDevice = ExclusiveDevice<Spi<SPI2>, Pin<'B', 12, Output>, NoDelay>;
type Failed = outboard::Error<<InputDevice as ErrorType>::Error, <OutputDevice as ErrorType>::Error>;

/// Why there is no sample, or no output.
#[derive(Debug)]
pub enum Fault {
    /// The conversion has not ended.
    Busy,
    /// The pair itself.
    Pair(Failed),
}

/// The pair.
pub struct Outboard {
    pair: outboard::Outboard<InputDevice, OutputDevice>,
    busy: PA2<Input>,
    reset: PA0<Output>,
    timer: TIM2,
}

impl Outboard {
    /// Starts the input converter anew; it forgets the conversion under way.
    fn pulse_reset(&mut self) {
        self.reset.set_high();
        cortex_m::asm::delay(RESET);
        self.reset.set_low();
    }
}

impl Converters for Outboard {
    type Error = Fault;

    const FULL_SCALE: u16 = u16::MAX;

    fn read(&mut self) -> Result<Codes, Fault> {
        self.timer.sr().modify(|_, w| w.cc1if().clear());
        if self.busy.is_high() {
            return Err(Fault::Busy);
        }
        let codes = self.pair.read().map_err(Fault::Pair)?;
        let [_, displacement, _, _] = codes.each();
        DISPLACEMENT.store(displacement, Ordering::Relaxed);
        Ok(codes)
    }

    fn write(&mut self, code: u16) -> Result<(), Fault> {
        self.pair.write(code).map_err(Fault::Pair)
    }

    #[cold]
    fn recover(&mut self) {
        self.pulse_reset();
        self.pair.recover();
    }
}

impl Pair for Outboard {
    /// The rate is the on-chip converters' less what the buses take: 10 of 250 microseconds.
    const LIMITS: Limits = Limits { full_scale: u16::MAX, highest_rate: 4000 };
    const CONVERSION: Option<u32> = Some(CONVERSION);

    fn set_up(parts: Parts, rcc: &mut Rcc) -> Option<Self> {
        let port = parts.port_a;
        let _convert = port.pa1.into_alternate::<1>();
        let (reset, busy) = (port.pa0.into_push_pull_output(), port.pa2.into_pull_up_input());
        let clock = port.pa5.into_alternate::<5>().speed(Speed::High);
        let pins = (Some(clock), Some(port.pa6.into_alternate::<5>()), SPI1::NoMosi);
        let bus = Spi::new(parts.input_bus, pins, MODE_2, BUS_HZ.Hz(), rcc);
        let mut select = port.pa3.into_push_pull_output();
        select.set_high();
        let input = ExclusiveDevice::new_no_delay(bus, select).ok()?;
        let pins = (
            Some(parts.pb13.into_alternate::<5>().speed(Speed::High)),
            SPI2::NoMiso,
            Some(parts.pb15.into_alternate::<5>().speed(Speed::High)),
        );
        let bus = Spi::new(parts.output_bus, pins, MODE_2, BUS_HZ.Hz(), rcc);
        let mut select = parts.pb12.into_push_pull_output();
        select.set_high();
        let output = ExclusiveDevice::new_no_delay(bus, select).ok()?;
        // SAFETY: of the timer, this touches the one flag of its own channel, by a write that leaves the others.
        let timer = unsafe { TIM2::steal() };
        let pair = outboard::Outboard::new(input, output).ok()?;
        let mut whole = Self { pair, busy, reset, timer };
        whole.pulse_reset();
        Some(whole)
    }
}

impl parts::Pair for Outboard {
    #[inline]
    fn late() -> bool {
        NVIC::is_pending(Interrupt::TIM2)
    }

    /// The converter's output is live from its set-up on, at 0 V until the first code.
    fn go_live(&mut self) {}

    /// A frame that was under way is given up: the converter takes whole ones only.
    fn put_last(zero_flow: ZeroFlow) {
        let code = zero_flow.code(DISPLACEMENT.load(Ordering::Relaxed));
        // SAFETY: nothing runs after this, and whoever owned the bus runs no more.
        let (bus, port) = unsafe { (SPI2::steal(), GPIOB::steal()) };
        let settled = |quiet: bool| {
            (0..LOOKS).any(|_| {
                let status = bus.sr().read();
                if quiet { status.bsy().bit_is_clear() } else { status.txe().bit_is_set() }
            })
        };
        settled(true);
        port.bsrr().write(|w| unsafe { w.bits(SELECT) });
        cortex_m::asm::delay(RESET);
        port.bsrr().write(|w| unsafe { w.bits(DESELECT) });
        for byte in last_frame(code) {
            settled(false);
            bus.dr().write(|w| w.dr().set(u16::from(byte)));
        }
        settled(false);
        settled(true);
        port.bsrr().write(|w| unsafe { w.bits(SELECT) });
    }
}
