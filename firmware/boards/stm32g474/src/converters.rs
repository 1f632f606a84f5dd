//! The converters on the chip: ADC1, whose four inputs are scanned at TIM2's update and carried by DMA; DAC channel 1.
//!
//! The converter itself takes 16 conversions of each input and sums them up to 16 bits. They take 64 x (12.5 + 12.5) cycles of 42.5 MHz, 38
//! microseconds, input after input. The DMA is circular over one buffer: it is whole when its interrupt comes, and stays so until the
//! next update.

use core::cell::UnsafeCell;

use shakedown_firmware::converters::{Converters, INPUTS, twelve_bits};
use shakedown_firmware::limits::Limits;
use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::parts;
use shakedown_firmware::{Codes, defaults};
use stm32g4::stm32g474::{ADC1, ADC12_COMMON, DAC1, DMA1, DMAMUX, Interrupt};

/// What the board with these converters keeps up with: codes and processor are the STM32F407's, with the clock and the wait states of this
/// one, which are no worse.
pub const LIMITS: Limits = defaults::LIMITS;

/// Memory that the DMA writes, two codes a word.
struct Buffer(UnsafeCell<[u32; INPUTS / 2]>);

// SAFETY: read only by `sampled`, word by word and with volatile reads.
unsafe impl Sync for Buffer {}

static SAMPLES: Buffer = Buffer(UnsafeCell::new([0; INPUTS / 2]));

/// `ADC_CR`: regulator, calibration, on; what a start is. Every write keeps the regulator.
const REGULATOR: u32 = 1 << 28;
const CALIBRATE: u32 = 1 << 31;
const ON: u32 = 1;
const OFF: u32 = 1 << 1;
const START: u32 = 1 << 2;
const STOP: u32 = 1 << 4;
/// `ADC_ISR`: ready; overrun, and its interrupt in `ADC_IER`.
const READY: u32 = 1;
const OVERRUN: u32 = 1 << 4;
/// `ADC_CFGR`: 12 bits, DMA without end, rising edge of external event 11, TIM2_TRGO; an overrun keeps the word there is.
const CONFIGURATION: u32 = 1 | 1 << 1 | 11 << 5 | 0b01 << 10;
/// `ADC_CFGR2`: regular oversampling, by 16, no shift, all 16 at one trigger.
const OVERSAMPLING: u32 = 1 | 0b011 << 2;
/// `ADC_SMPR1`: 12.5 cycles for inputs 1 to 4. `ADC_SQR1`: these, in order.
const SAMPLE_TIME: u32 = 0b010 << 3 | 0b010 << 6 | 0b010 << 9 | 0b010 << 12;
const SEQUENCE: u32 = 3 | 1 << 6 | 2 << 12 | 3 << 18 | 4 << 24;
/// `ADC_CCR`: a quarter of the bus's clock.
const QUARTER: u32 = 0b11 << 16;
/// Cycles in which the regulator starts: 20 microseconds. Looks at what takes 1 microsecond to 100.
const REGULATOR_START: u32 = 4000;
const LOOKS: u32 = 4000;
/// DMA channel 1: half words, memory upwards, circular, very high, end and error interrupts. Its request is ADC1's.
const CHANNEL: u32 = 0b11 << 12 | 1 << 10 | 1 << 8 | 1 << 7 | 1 << 5 | 1 << 3 | 1 << 1;
const REQUEST: u32 = 5;
const CHANNEL_ON: u32 = 1;
/// Its flags, and the one of an error.
const FLAGS: u32 = 0xF;
const ERROR: u32 = 1 << 3;
/// `DAC_MCR`: channel 1 to its pin alone without the buffer, for a bus of more than 160 MHz. `DAC_CR`: on.
const UNBUFFERED: u32 = 0b010 | 0b10 << 14;
const DAC_ON: u32 = 1;

/// The converter failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A conversion ended before the one before it was fetched, or the DMA could not write.
    Lost,
}

/// The pair on the chip.
pub struct OnChip {
    adc: ADC1,
    dac: DAC1,
    dma: DMA1,
    requests: DMAMUX,
}

impl OnChip {
    /// Sets both up; none where the converter does not become ready. The first sample comes with TIM2's first update; the output stays
    /// high-impedance until [`parts::Pair::go_live`].
    pub fn new(adc: ADC1, common: &ADC12_COMMON, dac: DAC1, dma: DMA1, requests: DMAMUX) -> Option<Self> {
        common.ccr().write(|w| unsafe { w.bits(QUARTER) });
        // Out of deep power-down, the regulator on.
        adc.cr().write(|w| unsafe { w.bits(0) });
        adc.cr().write(|w| unsafe { w.bits(REGULATOR) });
        cortex_m::asm::delay(REGULATOR_START);
        adc.cr().write(|w| unsafe { w.bits(REGULATOR | CALIBRATE) });
        if !(0..LOOKS).any(|_| adc.cr().read().bits() & CALIBRATE == 0) {
            return None;
        }
        // On no earlier than four of its cycles after the calibration.
        cortex_m::asm::delay(64);
        dac.mcr().write(|w| unsafe { w.bits(UNBUFFERED) });
        let pair = Self { adc, dac, dma, requests };
        pair.arm().then_some(pair)
    }

    /// The DMA's channel, then the converter on its trigger; whether it is ready.
    #[cold]
    #[inline(never)]
    fn arm(&self) -> bool {
        self.halt();
        let channel = self.dma.ch1();
        channel.cr().write(|w| unsafe { w.bits(CHANNEL) });
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS) });
        channel.par().write(|w| unsafe { w.bits(self.adc.dr().as_ptr() as u32) });
        channel.mar().write(|w| unsafe { w.bits(SAMPLES.0.get() as u32) });
        channel.ndtr().write(|w| unsafe { w.bits(INPUTS as u32) });
        self.requests.ccr(0).write(|w| unsafe { w.bits(REQUEST) });
        channel.cr().write(|w| unsafe { w.bits(CHANNEL | CHANNEL_ON) });

        self.adc.cfgr().write(|w| unsafe { w.bits(CONFIGURATION) });
        self.adc.cfgr2().write(|w| unsafe { w.bits(OVERSAMPLING) });
        self.adc.smpr1().write(|w| unsafe { w.bits(SAMPLE_TIME) });
        self.adc.sqr1().write(|w| unsafe { w.bits(SEQUENCE) });
        self.adc.isr().write(|w| unsafe { w.bits(READY | OVERRUN) });
        self.adc.ier().write(|w| unsafe { w.bits(OVERRUN) });
        self.adc.cr().write(|w| unsafe { w.bits(REGULATOR | ON) });
        let ready = (0..LOOKS).any(|_| self.adc.isr().read().bits() & READY != 0);
        self.adc.cr().write(|w| unsafe { w.bits(REGULATOR | START) });
        ready
    }

    /// Stops a conversion and turns the converter off, for its configuration takes nothing else.
    fn halt(&self) {
        let running = |bits: u32| self.adc.cr().read().bits() & bits != 0;
        if running(START) {
            self.adc.cr().write(|w| unsafe { w.bits(REGULATOR | STOP) });
            let _ = (0..LOOKS).any(|_| !running(STOP));
        }
        if running(ON) {
            self.adc.cr().write(|w| unsafe { w.bits(REGULATOR | OFF) });
            let _ = (0..LOOKS).any(|_| !running(ON));
        }
    }

    /// Acknowledges the sample; whether the DMA failed. An overrun of the converter comes as an interrupt of its own.
    #[inline]
    fn failed(&mut self) -> bool {
        let flags = self.dma.isr().read().bits();
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS) });
        flags & ERROR != 0
    }
}

impl parts::Pair for OnChip {
    #[inline]
    fn late() -> bool {
        cortex_m::peripheral::NVIC::is_pending(Interrupt::DMA1_CH1)
    }

    fn go_live(&mut self) {
        self.dac.cr().write(|w| unsafe { w.bits(DAC_ON) });
    }

    fn put_last(zero_flow: ZeroFlow) {
        let [_, displacement, _, _] = sampled().each();
        let code = twelve_bits(zero_flow.code(displacement));
        // SAFETY: one write to a data register, and nothing runs after it.
        unsafe { DAC1::steal() }.dhr12r1().write(|w| unsafe { w.bits(u32::from(code)) });
    }
}

impl Converters for OnChip {
    type Error = Fault;

    const FULL_SCALE: u16 = LIMITS.full_scale;

    #[inline]
    fn read(&mut self) -> Result<Codes, Fault> {
        if self.failed() { Err(Fault::Lost) } else { Ok(sampled()) }
    }

    #[inline]
    fn write(&mut self, code: u16) -> Result<(), Fault> {
        self.dac.dhr12r1().write(|w| unsafe { w.bits(u32::from(twelve_bits(code))) });
        Ok(())
    }

    #[cold]
    fn recover(&mut self) {
        let _ = self.arm();
    }
}

/// This tick's codes.
#[inline(always)]
fn sampled() -> Codes {
    // SAFETY: inside the buffer, and the DMA has written it and does not touch it again before the next update.
    Codes::of_words([0, 1].map(|half| unsafe { (&raw const (*SAMPLES.0.get())[half]).read_volatile() }))
}
