//! The converters on the chip: ADC1, whose four inputs are scanned 16 times a tick and carried by DMA; DAC channel 1.
//!
//! TIM2's update starts TIM1, which runs its period 16 times and stops (one-pulse mode with a repetition count, RM0090, 17.3.10 and
//! 17.3.2); in each period its channel 1 rises once and starts a scan. A scan takes 4 x (15 + 12) cycles of 21 MHz, 5.1 microseconds of
//! the period's 6.0, and all of them 94.4. The DMA is circular over one buffer: it is whole when its interrupt comes, and stays so until
//! the next update.
//!
//! A code is the sum of 16 scans: 12 bits become 16, and noise that differs from scan to scan a quarter.

use core::cell::UnsafeCell;

use shakedown_firmware::converters::{Converters, INPUTS, SCANS, twelve_bits};
use shakedown_firmware::limits::Limits;
use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::parts;
use shakedown_firmware::{Codes, defaults};
use stm32f4xx_hal::{
    pac::{ADC_COMMON, ADC1, DAC, DMA2, Interrupt, NVIC, TIM1},
    rcc::{Enable, Rcc, Reset},
};

use crate::pair::{Pair, Parts};

/// Memory that the DMA writes, scan by scan: two codes a word.
struct Buffer(UnsafeCell<[[u32; INPUTS / 2]; SCANS]>);

// SAFETY: read only by `summed`, word by word and with volatile reads.
unsafe impl Sync for Buffer {}

static SAMPLES: Buffer = Buffer(UnsafeCell::new([[0; INPUTS / 2]; SCANS]));

/// Codes that the DMA carries a tick.
const TRANSFERS: u16 = (INPUTS * SCANS) as u16;
/// ADC cycles a channel is sampled for: code 1 is 15, 0.7 microseconds. By the data sheet's equation 1 for sources up to 11 kohm at the
/// converter's typical 4 pF, 4 kohm at its largest 7 pF; 100 nF stand in front of it.
const SAMPLE_TIME: u32 = 1;
/// TIM1_CC1.
const TRIGGER: u8 = 0b0000;
/// Counts of 168 MHz from scan to scan, and before the first.
const PERIOD: u16 = 1000;
const AHEAD: u16 = 8;
/// TIM1 is started by TIM2 (RM0090, table 92: ITR1), trigger mode.
const SLAVE: u32 = 0b001 << 4 | 0b110;
/// PWM mode 2 on channel 1: low up to the compare, and high to the period's end.
const RISES: u32 = 0b111 << 4;
/// Channel 1 is on, and the timer's outputs are; no pin is its.
const CHANNEL_ON: u32 = 1;
const OUTPUTS_ON: u32 = 1 << 15;

/// The converter failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A conversion ended before the one before it was fetched, or the DMA could not write.
    Lost,
}

/// The pair on the chip.
pub struct OnChip {
    adc: ADC1,
    dac: DAC,
    dma: DMA2,
    scans: TIM1,
}

impl OnChip {
    /// Sets both up. The first sample comes with TIM2's first update; the output stays high-impedance until
    /// [`parts::Pair::go_live`].
    pub fn new(adc: ADC1, common: &ADC_COMMON, dac: DAC, dma: DMA2, scans: TIM1, rcc: &mut Rcc) -> Self {
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        DAC::enable(rcc);
        DAC::reset(rcc);
        DMA2::enable(rcc);
        DMA2::reset(rcc);
        TIM1::enable(rcc);
        TIM1::reset(rcc);
        common.ccr().modify(|_, w| w.adcpre().div4());
        let pair = Self { adc, dac, dma, scans };
        pair.arm();
        pair
    }

    /// The timer of the scans, which stands until TIM2 starts it: a burst that is under way ends here.
    fn arm_scans(&self) {
        let timer = &self.scans;
        timer.smcr().write(|w| unsafe { w.bits(0) });
        timer.cr1().write(|w| w.opm().enabled().arpe().enabled());
        timer.arr().write(|w| w.arr().set(PERIOD - 1));
        timer.rcr().write(|w| w.rep().set(SCANS as u8 - 1));
        timer.ccr1().write(|w| w.ccr().set(AHEAD));
        timer.ccmr1_output().write(|w| unsafe { w.bits(RISES) });
        timer.ccer().write(|w| unsafe { w.bits(CHANNEL_ON) });
        timer.bdtr().write(|w| unsafe { w.bits(OUTPUTS_ON) });
        // The repetition count is taken over at an update, and the counter begins at 0.
        timer.egr().write(|w| w.ug().update());
        timer.smcr().write(|w| unsafe { w.bits(SLAVE) });
    }

    /// The timer of the scans, the DMA stream, then the converter on its trigger.
    #[cold]
    #[inline(never)]
    pub fn arm(&self) {
        self.arm_scans();
        let stream = self.dma.st(0);
        stream.cr().modify(|_, w| w.en().disabled());
        while stream.cr().read().en().bit_is_set() {}
        self.dma.lifcr().write(|w| unsafe { w.bits(0x3D) });
        stream.par().write(|w| unsafe { w.bits(self.adc.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(SAMPLES.0.get() as u32) });
        stream.ndtr().write(|w| w.ndt().set(TRANSFERS));
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
    pub fn failed(&mut self) -> bool {
        let flags = self.dma.lisr().read();
        self.dma.lifcr().write(|w| unsafe { w.bits(0x3D) });
        flags.teif0().bit_is_set()
    }
}

impl Pair for OnChip {
    const LIMITS: Limits = defaults::LIMITS;
    const CONVERSION: Option<u32> = None;

    fn set_up(parts: Parts, rcc: &mut Rcc) -> Option<Self> {
        let port = parts.port_a;
        let _analog = (
            port.pa0.into_analog(),
            port.pa1.into_analog(),
            port.pa2.into_analog(),
            port.pa3.into_analog(),
            port.pa4.into_analog(),
        );
        Some(Self::new(parts.adc, &parts.adc_common, parts.dac, parts.dma, parts.scans, rcc))
    }
}

impl parts::Pair for OnChip {
    /// The processor's own register, for one of the DMA's takes the bus.
    #[inline]
    fn late() -> bool {
        NVIC::is_pending(Interrupt::DMA2_STREAM0)
    }

    /// Without the chip's buffer, which would end 0.2 V from either rail: the follower behind the pin drives what comes after.
    fn go_live(&mut self) {
        self.dac.cr().write(|w| w.boff1().disabled().en1().enabled());
    }

    fn put_last(zero_flow: ZeroFlow) {
        let code = twelve_bits(zero_flow.code(last_displacement()));
        // SAFETY: one write to a data register, and nothing runs after it.
        unsafe { DAC::steal() }.dhr12r(0).write(|w| unsafe { w.bits(u32::from(code)) });
    }
}

impl Converters for OnChip {
    type Error = Fault;

    const FULL_SCALE: u16 = defaults::LIMITS.full_scale;

    #[inline]
    fn read(&mut self) -> Result<Codes, Fault> {
        if self.failed() { Err(Fault::Lost) } else { Ok(summed()) }
    }

    #[inline]
    fn write(&mut self, code: u16) -> Result<(), Fault> {
        self.dac.dhr12r(0).write(|w| unsafe { w.bits(u32::from(twelve_bits(code))) });
        Ok(())
    }

    #[cold]
    fn recover(&mut self) {
        self.arm();
    }
}

/// The sums of this tick's scans. Two codes at once: 16 of 12 bits do not carry out of their half of the word.
#[inline(always)]
fn summed() -> Codes {
    let mut sums = [0_u32; INPUTS / 2];
    for scan in 0..SCANS {
        for (half, sum) in sums.iter_mut().enumerate() {
            // SAFETY: inside the buffer, and the DMA has written it and does not touch it again before the next update.
            *sum = sum.wrapping_add(unsafe { (&raw const (*SAMPLES.0.get())[scan][half]).read_volatile() });
        }
    }
    Codes::of_words(sums)
}

/// Code of the LVDT as the converter last saw it, whoever reads it otherwise.
pub fn last_displacement() -> u16 {
    let [_, displacement, _, _] = summed().each();
    displacement
}
