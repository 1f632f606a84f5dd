//! The serial line: USART3 at 1 Mbit/s, DMA both ways.
//!
//! Bytes come into a ring that the DMA fills without end; they go out of one frame buffer, which is the sender's again
//! when the DMA is done.

use core::cell::UnsafeCell;

use shakedown_core::link::MAX_FRAME;
use stm32f4xx_hal::{
    pac::{DMA1, Interrupt, USART3},
    rcc::{Enable, Rcc, Reset},
};

/// Bytes of the receive ring: 5 ms.
const RING: usize = 512;
/// 42 MHz / 16 / 2.625 is 1 Mbit/s exactly: mantissa 2, fraction 10/16.
const DIVIDER: u16 = 2 * 16 + 10;
/// Channel of USART3 on both its streams.
const CHANNEL: u8 = 4;
/// Stream flags of `LIFCR`, for streams 1 and 3.
const FLAGS_1: u32 = 0x3D << 6;
const FLAGS_3: u32 = 0x3D << 22;

struct Ring(UnsafeCell<[u8; RING]>);
struct Frame(UnsafeCell<[u8; MAX_FRAME]>);

// SAFETY: the ring is written by the DMA alone and read by the one `Line`, volatile; the frame is touched by the one
// `Line`, and only while the DMA does not read it.
unsafe impl Sync for Ring {}
// SAFETY: as above.
unsafe impl Sync for Frame {}

static RECEIVED: Ring = Ring(UnsafeCell::new([0; RING]));
static SENDING: Frame = Frame(UnsafeCell::new([0; MAX_FRAME]));

/// The line.
pub struct Line {
    usart: USART3,
    dma: DMA1,
    taken: usize,
    /// How far the DMA had come when last asked: asking costs as much as several bytes.
    written: usize,
}

impl Line {
    /// Sets the line up and listens.
    pub fn new(usart: USART3, dma: DMA1, rcc: &mut Rcc) -> Self {
        USART3::enable(rcc);
        USART3::reset(rcc);
        DMA1::enable(rcc);
        DMA1::reset(rcc);
        let line = Self { usart, dma, taken: 0, written: 0 };
        line.usart.brr().write(|w| unsafe { w.bits(DIVIDER) });
        line.usart.cr3().write(|w| w.dmar().enabled().dmat().enabled());
        line.listen();
        line.usart.cr1().write(|w| w.ue().enabled().te().enabled().re().enabled().idleie().enabled());
        line
    }

    fn listen(&self) {
        let stream = self.dma.st(1);
        stream.par().write(|w| unsafe { w.bits(self.usart.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(RECEIVED.0.get() as u32) });
        stream.ndtr().write(|w| w.ndt().set(RING as u16));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).minc().incremented().circ().enabled();
            w.htie().enabled().tcie().enabled()
        });
        stream.cr().modify(|_, w| w.en().enabled());
    }

    /// The next byte that has come.
    pub fn take(&mut self) -> Option<u8> {
        if self.written == self.taken {
            self.written = (RING - usize::from(self.dma.st(1).ndtr().read().ndt().bits())) % RING;
        }
        if self.written == self.taken {
            return None;
        }
        let place = self.taken % RING;
        // SAFETY: `place` is inside the ring.
        let byte = unsafe { RECEIVED.0.get().cast::<u8>().add(place).read_volatile() };
        self.taken = (place + 1) % RING;
        Some(byte)
    }

    /// Forgets that the line fell idle, if it did. Reading the data register does that and takes a byte that waits there, so not
    /// while one does: the DMA fetches it, which does it as well, and if it does not this is asked again.
    pub fn acknowledge(&self) {
        let status = self.usart.sr().read();
        if status.idle().bit_is_set() && status.rxne().bit_is_clear() {
            let _ = self.usart.dr().read();
        }
    }

    /// Whether the last frame has left.
    pub fn ready(&self) -> bool {
        self.dma.st(3).cr().read().en().bit_is_clear()
    }

    /// Sends what `write` puts into the frame buffer, if it is free; `write` returns the length.
    pub fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize) {
        if !self.ready() {
            return;
        }
        // SAFETY: the stream is off, so nothing else reads or writes the buffer.
        let length = write(unsafe { &mut *SENDING.0.get() }).min(MAX_FRAME);
        if length == 0 {
            return;
        }
        let stream = self.dma.st(3);
        self.dma.lifcr().write(|w| unsafe { w.bits(FLAGS_3) });
        stream.par().write(|w| unsafe { w.bits(self.usart.dr().as_ptr() as u32) });
        stream.m0ar().write(|w| unsafe { w.bits(SENDING.0.get() as u32) });
        stream.ndtr().write(|w| w.ndt().set(length as u16));
        stream.cr().write(|w| {
            w.chsel().set(CHANNEL).minc().incremented().dir().memory_to_peripheral();
            w.tcie().enabled()
        });
        stream.cr().modify(|_, w| w.en().enabled());
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
