//! The converters that the board is built with: its own, or a pair on its SPI.

use shakedown_firmware::limits::Limits;
use shakedown_firmware::parts;
use stm32f4xx_hal::{
    gpio::{gpioa, gpiob},
    pac::{ADC_COMMON, ADC1, DAC, DMA2, SPI1, SPI2, TIM1},
    rcc::Rcc,
};

/// What converters may be made of: everything that nothing else on the board needs.
pub struct Parts {
    /// The chip's own input converter.
    pub adc: ADC1,
    /// What all of those share.
    pub adc_common: ADC_COMMON,
    /// The chip's own output converter.
    pub dac: DAC,
    /// The controller that carries samples to memory.
    pub dma: DMA2,
    /// The timer that makes several scans of one tick.
    pub scans: TIM1,
    /// For an input converter outboard.
    pub input_bus: SPI1,
    /// For an output converter outboard.
    pub output_bus: SPI2,
    /// PA0 to PA15.
    pub port_a: gpioa::Parts,
    /// PB12: the output converter's select.
    pub pb12: gpiob::PB12,
    /// PB13: its clock.
    pub pb13: gpiob::PB13,
    /// PB15: its data.
    pub pb15: gpiob::PB15,
}

/// Converters of this board.
pub trait Pair: parts::Pair + Sized + 'static {
    /// What the board with these converters keeps up with.
    const LIMITS: Limits;
    /// From the timer's update to the tick, counts of the timer: the time of a conversion that nothing else tells the end of; none
    /// where the converter's own interrupt does.
    const CONVERSION: Option<u32>;

    /// Sets them up. The output stays as it is before [`parts::Pair::go_live`]; none where they do not answer.
    fn set_up(parts: Parts, rcc: &mut Rcc) -> Option<Self>;
}
