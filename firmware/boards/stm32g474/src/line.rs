//! The serial line: USART3 at 1 Mbit/s, DMA both ways.

use cortex_m::singleton;
use shakedown_core::link::MAX_FRAME;
use shakedown_firmware::line::{self, RING, Ring};
use stm32g4::stm32g474::{DMA1, DMAMUX, Interrupt, USART3};

use crate::chip::Line;

/// 170 MHz to 1 Mbit/s.
const DIVIDER: u32 = 170;
/// `CR1`: on, receiver, transmitter, interrupt when idle. `CR3`: DMA both ways; a byte that comes too early takes the place of the one before it,
/// for an overrun would end the reception (RM0440, OVRDIS). `ISR` and `ICR`: idle.
const LISTENING: u32 = 1 | 1 << 2 | 1 << 3 | 1 << 4;
const BY_DMA: u32 = 1 << 6 | 1 << 7 | 1 << 12;
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

static RECEIVED: Ring = Ring::new();

/// Registers of the line and its DMA.
pub struct Port {
    usart: USART3,
    /// Whoever sets up the converters' channel before has let go of it.
    dma: DMA1,
}

/// Sets the line up and listens; none where it was set up before. It uses channels 2 and 3 of the controller alone.
pub(crate) fn start(usart: USART3, dma: DMA1, requests: &DMAMUX) -> Option<Line> {
    let port = Port { usart, dma };
    port.usart.brr().write(|w| unsafe { w.bits(DIVIDER) });
    port.usart.cr3().write(|w| unsafe { w.bits(BY_DMA) });
    requests.ccr(1).write(|w| unsafe { w.bits(RECEIVES) });
    requests.ccr(2).write(|w| unsafe { w.bits(SENDS) });
    port.listen();
    port.usart.cr1().write(|w| unsafe { w.bits(LISTENING) });
    let frame = singleton!(: [u8; MAX_FRAME] = [0; MAX_FRAME])?;
    Some(Line::new(port, frame))
}

impl Port {
    fn listen(&self) {
        let channel = self.dma.ch2();
        channel.par().write(|w| unsafe { w.bits(self.usart.rdr().as_ptr() as u32) });
        channel.mar().write(|w| unsafe { w.bits(RECEIVED.place() as u32) });
        channel.ndtr().write(|w| unsafe { w.bits(RING as u32) });
        channel.cr().write(|w| unsafe { w.bits(ROUND) });
        channel.cr().write(|w| unsafe { w.bits(ROUND | ON) });
    }
}

impl line::Port for Port {
    fn ring(&self) -> &'static Ring {
        &RECEIVED
    }

    fn until_end(&self) -> usize {
        self.dma.ch2().ndtr().read().bits() as usize
    }

    /// That takes no byte from the DMA here.
    fn acknowledge(&self) {
        self.usart.icr().write(|w| unsafe { w.bits(IDLE) });
    }

    /// Its channel has no more to carry.
    fn ready(&self) -> bool {
        self.dma.ch3().ndtr().read().bits() == 0
    }

    fn send(&self, from: *const u8, length: u16) {
        let channel = self.dma.ch3();
        channel.cr().write(|w| unsafe { w.bits(OUT) });
        self.dma.ifcr().write(|w| unsafe { w.bits(FLAGS_3) });
        channel.par().write(|w| unsafe { w.bits(self.usart.tdr().as_ptr() as u32) });
        channel.mar().write(|w| unsafe { w.bits(from as u32) });
        channel.ndtr().write(|w| unsafe { w.bits(u32::from(length)) });
        channel.cr().write(|w| unsafe { w.bits(OUT | ON) });
    }

    fn wake() {
        wake();
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
