//! The serial line: USART3 at 1 Mbit/s, DMA both ways.

use cortex_m::singleton;
use shakedown_core::link::MAX_FRAME;
use shakedown_firmware::line::{self, RING, Ring};
use stm32f4xx_hal::{
    pac::{DMA1, Interrupt, USART3},
    rcc::{Enable, Rcc, Reset},
};

use crate::chip::Line;

/// 42 MHz / 16 / 2.625 is 1 Mbit/s exactly: mantissa 2, fraction 10/16.
const DIVIDER: u16 = 2 * 16 + 10;
/// Channel of USART3 on both its streams.
const CHANNEL: u8 = 4;
/// Stream flags of `LIFCR`, for streams 1 and 3.
const FLAGS_1: u32 = 0x3D << 6;
const FLAGS_3: u32 = 0x3D << 22;

static RECEIVED: Ring = Ring::new();

/// Registers of the line and its DMA.
pub struct Port {
    usart: USART3,
    dma: DMA1,
}

/// Sets the line up and listens; none where it was set up before.
pub(crate) fn start(usart: USART3, dma: DMA1, rcc: &mut Rcc) -> Option<Line> {
    USART3::enable(rcc);
    USART3::reset(rcc);
    DMA1::enable(rcc);
    DMA1::reset(rcc);
    let port = Port { usart, dma };
    port.usart.brr().write(|w| unsafe { w.bits(DIVIDER) });
    port.usart.cr3().write(|w| w.dmar().enabled().dmat().enabled());
    port.listen();
    port.usart.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().idleie().enabled());
    let frame = singleton!(: [u8; MAX_FRAME] = [0; MAX_FRAME])?;
    Some(Line::new(port, frame))
}

impl Port {
    fn listen(&self) {
        let stream = self.dma.st(1);
        stream.par().write(|w| unsafe { w.bits(self.usart.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(RECEIVED.place() as u32) });
        stream.ndtr().write(|w| w.ndt().set(RING as u16));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).minc().incremented().circ().enabled();
            w.htie().enabled().tcie().enabled()
        });
        stream.cr().modify(|_, w| w.en().enabled());
    }
}

impl line::Port for Port {
    fn ring(&self) -> &'static Ring {
        &RECEIVED
    }

    fn until_end(&self) -> usize {
        usize::from(self.dma.st(1).ndtr().read().ndt().bits())
    }

    /// Reading the data register forgets that the line is idle, and that a byte was lost, after which the receiver takes no more (RM0090, 30.3.3,
    /// ORE). It takes a byte that waits there, so not while one does: the DMA fetches it, which does it as well, and if it does not this is
    /// asked again.
    fn acknowledge(&self) {
        let status = self.usart.sr().read();
        if (status.idle().bit_is_set() || status.ore().bit_is_set()) && status.rxne().bit_is_clear() {
            let _ = self.usart.dr().read();
        }
    }

    fn ready(&self) -> bool {
        self.dma.st(3).cr().read().en().bit_is_clear()
    }

    fn send(&self, from: *const u8, length: u16) {
        let stream = self.dma.st(3);
        self.dma.lifcr().write(|w| unsafe { w.bits(FLAGS_3) });
        stream.par().write(|w| unsafe { w.bits(self.usart.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(from as u32) });
        stream.ndtr().write(|w| w.ndt().set(length));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).minc().incremented().dir().memory_to_peripheral();
            w.tcie().enabled()
        });
        stream.cr().modify(|_, w| w.en().enabled());
    }

    fn wake() {
        wake();
    }
}

/// Half of the ring is full: have it read.
pub fn received() {
    // SAFETY: a write of ones to the flag-clear register touches those flags alone.
    unsafe { DMA1::steal() }.lifcr().write(|w| unsafe { w.bits(FLAGS_1) });
    wake();
}

/// The frame has left: have the next one sent.
pub fn sent() {
    // SAFETY: as above.
    unsafe { DMA1::steal() }.lifcr().write(|w| unsafe { w.bits(FLAGS_3) });
    wake();
}

/// Has the server look at its queues.
#[inline]
pub fn wake() {
    rtic::pend(Interrupt::USART3);
}
