//! The serial line: USART3 at 1 Mbit/s, DMA both ways.
//!
//! Bytes come into a ring that the DMA fills without end; they go out of one frame buffer, which is the sender's again
//! when the DMA is done.

use core::cell::UnsafeCell;

use shakedown_core::link::MAX_FRAME;
use stm32g4::stm32g474::{DMA1, DMAMUX, Interrupt, USART3};

/// Bytes of the receive ring: 5 ms.
const RING: usize = 512;
/// 170 MHz to 1 Mbit/s.
const DIVIDER: u32 = 170;
/// `CR1`: on, receiver, transmitter, interrupt when idle. `CR3`: DMA both ways. `ISR` and `ICR`: idle.
const LISTENING: u32 = 1 | 1 << 2 | 1 << 3 | 1 << 4;
const BY_DMA: u32 = 1 << 6 | 1 << 7;
const IDLE: u32 = 1 << 4;
/// DMA requests of USART3, on channels 2 and 3; the channels' flags.
const RECEIVES: u32 = 28;
const SENDS: u32 = 29;
const FLAGS_2: u32 = 0xF << 4;
const FLAGS_3: u32 = 0xF << 8;
/// A channel: on; memory upwards; round without end, interrupts when half and whole; from memory, interrupt when whole.
const ON: u32 = 1;
const UPWARDS: u32 = 1 << 7;
const ROUND: u32 = UPWARDS | 1 << 5 | 1 << 2 | 1 << 1;
const OUT: u32 = UPWARDS | 1 << 4 | 1 << 1;

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
    /// Whoever sets up the converters' channel before has let go of it.
    dma: DMA1,
    taken: usize,
    /// How far the DMA had come when last asked: asking costs as much as several bytes.
    written: usize,
}

impl Line {
    /// Sets the line up and listens. It uses channels 2 and 3 of the controller alone.
    pub fn new(usart: USART3, dma: DMA1, requests: &DMAMUX) -> Self {
        let line = Self { usart, dma, taken: 0, written: 0 };
        line.usart.brr().write(|w| unsafe { w.bits(DIVIDER) });
        line.usart.cr3().write(|w| unsafe { w.bits(BY_DMA) });
        requests.ccr(1).write(|w| unsafe { w.bits(RECEIVES) });
        requests.ccr(2).write(|w| unsafe { w.bits(SENDS) });
        line.listen();
        line.usart.cr1().write(|w| unsafe { w.bits(LISTENING) });
        line
    }

    fn listen(&self) {
        let channel = self.dma.ch2();
        channel.par().write(|w| unsafe { w.bits(self.usart.rdr().as_ptr() as u32) });
        channel.mar().write(|w| unsafe { w.bits(RECEIVED.0.get() as u32) });
        channel.ndtr().write(|w| unsafe { w.bits(RING as u32) });
        channel.cr().write(|w| unsafe { w.bits(ROUND) });
        channel.cr().write(|w| unsafe { w.bits(ROUND | ON) });
    }

    /// The next byte that has come.
    pub fn take(&mut self) -> Option<u8> {
        if self.written == self.taken {
            self.written = (RING - self.dma.ch2().ndtr().read().bits() as usize % (RING + 1)) % RING;
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

    /// Forgets that the line fell idle. That takes no byte from the DMA here.
    pub fn acknowledge(&self) {
        self.usart.icr().write(|w| unsafe { w.bits(IDLE) });
    }

    /// Whether the last frame has left: its channel has no more to carry.
    pub fn ready(&self) -> bool {
        self.dma.ch3().ndtr().read().bits() == 0
    }

    /// Sends what `write` puts into the frame buffer, if it is free; `write` returns the length.
    pub fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize) {
        if !self.ready() {
            return;
        }
        // SAFETY: the channel has no more to carry, so nothing else reads or writes the buffer.
        let length = write(unsafe { &mut *SENDING.0.get() }).min(MAX_FRAME);
        if length == 0 {
            return;
        }
        let channel = self.dma.ch3();
        channel.cr().write(|w| unsafe { w.bits(OUT) });
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS_3) });
        channel.par().write(|w| unsafe { w.bits(self.usart.tdr().as_ptr() as u32) });
        channel.mar().write(|w| unsafe { w.bits(SENDING.0.get() as u32) });
        channel.ndtr().write(|w| unsafe { w.bits(length as u32) });
        channel.cr().write(|w| unsafe { w.bits(OUT | ON) });
    }
}

/// Half of the ring is full: have it read.
pub fn received() {
    // SAFETY: a write of ones to the flag-clear register touches those flags alone.
    unsafe { DMA1::steal() }.ifcr().write(|w| unsafe { w.bits(FLAGS_2) });
    wake();
}

/// The frame has left: have the next one sent.
pub fn sent() {
    // SAFETY: as above.
    unsafe { DMA1::steal() }.ifcr().write(|w| unsafe { w.bits(FLAGS_3) });
    wake();
}

/// Has the server look at its queues.
#[inline]
pub fn wake() {
    rtic::pend(Interrupt::USART3);
}
