//! The converters on the chip: ADC1, four inputs scanned at TIM2's update and carried by DMA; DAC channel 1.
//!
//! The scan takes 4 x (56 + 12) cycles of 21 MHz, 13 microseconds. The DMA is circular over one buffer: it is whole when
//! its interrupt comes, and stays so until the next update.

use core::cell::UnsafeCell;

use shakedown_firmware::Codes;
use shakedown_firmware::converters::{Converters, INPUTS};
use stm32f4xx_hal::{
    pac::{ADC_COMMON, ADC1, DAC, DMA2, Interrupt, NVIC},
    rcc::{Enable, Rcc, Reset},
};

/// Memory that the DMA writes.
struct Buffer(UnsafeCell<[u16; INPUTS]>);

// SAFETY: read only by `sampled`, code by code and with volatile reads.
unsafe impl Sync for Buffer {}

static SAMPLES: Buffer = Buffer(UnsafeCell::new([0; INPUTS]));

/// ADC cycles a channel is sampled for: code 3 is 56.
const SAMPLE_TIME: u32 = 3;
/// TIM2_TRGO.
const TRIGGER: u8 = 0b0110;

/// The converter failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fault {
    /// A conversion ended before the one before it was fetched, or the DMA could not write.
    Lost,
}

/// The pair on the chip.
pub(crate) struct OnChip {
    adc: ADC1,
    dac: DAC,
    dma: DMA2,
}

impl OnChip {
    /// Sets both up. The first sample comes with TIM2's first update; the output stays high-impedance until
    /// [`Self::go_live`].
    pub(crate) fn new(adc: ADC1, common: &ADC_COMMON, dac: DAC, dma: DMA2, rcc: &mut Rcc) -> Self {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        DAC::enable(rcc);
        DAC::reset(rcc);
        DMA2::enable(rcc);
        DMA2::reset(rcc);
        common.ccr().modify(|_, w| w.adcpre().div4());
        let pair = Self { adc, dac, dma };
        pair.arm();
        pair
    }

    /// The DMA stream, then the converter on its trigger.
    #[cold]
    #[inline(never)]
    pub(crate) fn arm(&self) {
        let stream = self.dma.st(0);
        stream.cr().modify(|_, w| w.en().disabled());
        while stream.cr().read().en().bit_is_set() {}
        self.dma.lifcr().write(|w| unsafe { w.bits(0x3D) });
        stream.par().write(|w| unsafe { w.bits(self.adc.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(SAMPLES.0.get() as u32) });
        stream.ndtr().write(|w| w.ndt().set(INPUTS as u16));
        stream.cr().write(|w| {
            w.psize().bits16().msize().bits16().minc().incremented().circ().enabled();
            w.pl().very_high().tcie().enabled().teie().enabled()
        });
        stream.cr().modify(|_, w| w.en().enabled());

        self.adc.cr2().write(|w| w.adon().disabled());
        self.adc.sr().write(|w| unsafe { w.bits(0) });
        self.adc.cr1().write(|w| w.scan().enabled().res().twelve_bit().ovrie().enabled());
        self.adc.smpr2().write(|w| unsafe { w.bits(SAMPLE_TIME * 0o1111) });
        self.adc.sqr1().write(|w| w.l().set(INPUTS as u8 - 1));
        // Channel n at place n, five bits each.
        self.adc.sqr3().write(|w| unsafe { w.bits(1 << 5 | 2 << 10 | 3 << 15) });
        self.adc.cr2().write(|w| {
            unsafe { w.extsel().bits(TRIGGER) };
            w.exten().rising_edge().dma().enabled().dds().continuous().adon().enabled()
        });
    }

    /// Acknowledges the sample; whether the DMA failed and needs [`Self::arm`]. An overrun of the converter stops the DMA,
    /// so that it comes as an interrupt of its own.
    #[inline]
    pub(crate) fn failed(&mut self) -> bool {
        let flags = self.dma.lisr().read();
        self.dma.lifcr().write(|w| unsafe { w.bits(0x3D) });
        flags.teif0().bit_is_set()
    }

    /// Whether the next tick has come already; asked at the end of a tick. The processor's own register, for one of the
    /// DMA's takes the bus.
    #[inline]
    pub(crate) fn late() -> bool {
        NVIC::is_pending(Interrupt::DMA2_STREAM0)
    }

    /// Lets the last code written out, if it is not out yet. Without the chip's buffer, which would end 0.2 V from either rail: the
    /// follower behind the pin drives what comes after.
    pub(crate) fn go_live(&mut self) {
        self.dac.cr().write(|w| w.boff1().disabled().en1().enabled());
    }
}

impl Converters for OnChip {
    type Error = Fault;

    const FULL_SCALE: u16 = 4095;

    #[inline]
    fn read(&mut self) -> Result<Codes, Fault> {
        if self.failed() { Err(Fault::Lost) } else { Ok(Codes::of(sampled)) }
    }

    #[inline]
    fn write(&mut self, code: u16) -> Result<(), Fault> {
        self.dac.dhr12r(0).write(|w| unsafe { w.bits(u32::from(code)) });
        Ok(())
    }

    #[cold]
    fn recover(&mut self) {
        self.arm();
    }
}

/// The code of an input, by its number, as sampled for this tick.
#[inline(always)]
pub(crate) fn sampled(input: usize) -> u16 {
    // SAFETY: inside the buffer, and the DMA has written it and does not touch it again before the next update.
    unsafe { SAMPLES.0.get().cast::<u16>().add(input % INPUTS).read_volatile() }
}

/// Code of the LVDT as the converter last saw it, whoever reads it otherwise.
pub(crate) fn last_displacement() -> u16 {
    sampled(1)
}

/// Writes `code` to the output, whoever owns it: for the end of a program that has failed.
pub(crate) fn write_last(code: u16) {
    // SAFETY: one write to a data register, and nothing runs after it.
    unsafe { DAC::steal() }.dhr12r(0).write(|w| unsafe { w.bits(u32::from(code)) });
}
