//! A serial line with DMA both ways, on any board. Bytes come into a ring that the DMA fills without end; they go out of one frame
//! buffer, which is the sender's again when the DMA is done.

use core::sync::atomic::{AtomicU8, Ordering, compiler_fence};

use shakedown_core::link::MAX_FRAME;

/// Bytes of the receive ring: 5 ms at 1 Mbit/s.
pub const RING: usize = 512;

/// The ring, which the DMA alone writes.
#[derive(Debug)]
pub struct Ring([AtomicU8; RING]);

impl Ring {
    /// An empty one.
    pub const fn new() -> Self {
        Self([const { AtomicU8::new(0) }; RING])
    }

    /// Where it lies, for the DMA.
    pub const fn place(&self) -> *const u8 {
        self.0.as_ptr().cast()
    }
}

impl Default for Ring {
    fn default() -> Self {
        Self::new()
    }
}

/// The serial line; see [`crate::link_task::LinkBoard`] for what its calls promise.
pub trait Serial {
    /// Forgets what woke the task.
    fn acknowledge(&mut self);

    /// The next byte that has come.
    fn take(&mut self) -> Option<u8>;

    /// Whether the last frame has left.
    fn ready(&self) -> bool;

    /// Sends what `write` puts into the frame buffer, if it is free.
    fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize);

    /// Has the server look at its queues.
    fn wake();
}

/// Registers of the line and its DMA.
pub trait Port {
    /// The ring that the DMA fills from its beginning.
    fn ring(&self) -> &'static Ring;

    /// Bytes from where the DMA writes next to the ring's end, 0 counting as a whole ring.
    fn until_end(&self) -> usize;

    /// Forgets that the line fell idle, without taking a byte from the DMA.
    fn acknowledge(&self);

    /// Whether the last frame has left.
    fn ready(&self) -> bool;

    /// Has the DMA send so many bytes from this place, which stay as they are until it is ready again.
    fn send(&self, from: *const u8, length: u16);

    /// Has the server look at its queues.
    fn wake();
}

/// The line.
#[derive(Debug)]
pub struct Line<P> {
    port: P,
    frame: &'static mut [u8; MAX_FRAME],
    taken: usize,
    /// How far the DMA had come when last asked: asking costs as much as several bytes.
    written: usize,
}

impl<P: Port> Line<P> {
    /// The line of `port`, which sends from `frame`.
    pub const fn new(port: P, frame: &'static mut [u8; MAX_FRAME]) -> Self {
        Self { port, frame, taken: 0, written: 0 }
    }
}

impl<P: Port> Serial for Line<P> {
    #[inline]
    fn acknowledge(&mut self) {
        self.port.acknowledge();
    }

    #[inline]
    fn take(&mut self) -> Option<u8> {
        if self.written == self.taken {
            self.written = (RING - self.port.until_end() % (RING + 1)) % RING;
            // What the DMA has written is read after it was asked how far it is.
            compiler_fence(Ordering::Acquire);
        }
        if self.written == self.taken {
            return None;
        }
        // A place within the ring, which the compiler sees.
        let place = self.taken % RING;
        let byte = self.port.ring().0.get(place)?.load(Ordering::Relaxed);
        self.taken = (place + 1) % RING;
        Some(byte)
    }

    #[inline]
    fn ready(&self) -> bool {
        self.port.ready()
    }

    #[inline]
    fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize) {
        if !self.port.ready() {
            return;
        }
        let length = write(self.frame).min(MAX_FRAME);
        if length == 0 {
            return;
        }
        // The frame is in memory before the DMA is told of it.
        compiler_fence(Ordering::SeqCst);
        self.port.send(self.frame.as_ptr(), length as u16);
    }

    fn wake() {
        P::wake();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::{Cell, RefCell};
    use std::vec::Vec;

    /// A DMA that has written so many bytes in all, and what it was told to send.
    struct Wire {
        ring: &'static Ring,
        came: Cell<usize>,
        sent: RefCell<Vec<usize>>,
        busy: Cell<bool>,
    }

    impl Wire {
        fn receive(&self, bytes: &[u8]) {
            for &byte in bytes {
                self.ring.0[self.came.get() % RING].store(byte, Ordering::Relaxed);
                self.came.set(self.came.get() + 1);
            }
        }
    }

    impl Port for &Wire {
        fn ring(&self) -> &'static Ring {
            self.ring
        }

        fn until_end(&self) -> usize {
            RING - self.came.get() % RING
        }

        fn acknowledge(&self) {}

        fn ready(&self) -> bool {
            !self.busy.get()
        }

        fn send(&self, _: *const u8, length: u16) {
            self.sent.borrow_mut().push(usize::from(length));
            self.busy.set(true);
        }

        fn wake() {}
    }

    fn wire() -> Wire {
        let ring = std::boxed::Box::leak(std::boxed::Box::new(Ring::new()));
        Wire { ring, came: Cell::new(0), sent: RefCell::new(Vec::new()), busy: Cell::new(false) }
    }

    fn line(wire: &Wire) -> Line<&Wire> {
        Line::new(wire, std::boxed::Box::leak(std::boxed::Box::new([0; MAX_FRAME])))
    }

    #[test]
    fn every_byte_is_taken_once_and_in_order_round_the_ring() {
        let wire = wire();
        let mut line = line(&wire);
        let mut next = 0_u32;
        for round in 0..200_usize {
            let bytes: Vec<u8> = (0..=round % 40).map(|k| (next as usize + k) as u8).collect();
            wire.receive(&bytes);
            let taken: Vec<u8> = core::iter::from_fn(|| line.take()).collect();
            assert_eq!(taken, bytes, "round {round}");
            next += bytes.len() as u32;
        }
        assert!(wire.came.get() > 7 * RING);
        // A DMA that shows nothing left has come round.
        assert_eq!(line.take(), None);
    }

    #[test]
    fn a_frame_waits_for_the_one_before_and_an_empty_one_is_none() {
        let wire = wire();
        let mut line = line(&wire);
        line.send(|_| 0);
        line.send(|frame| {
            frame[..3].copy_from_slice(b"abc");
            3
        });
        line.send(|_| panic!("the buffer is not the sender's"));
        wire.busy.set(false);
        line.send(|_| MAX_FRAME + 1);
        assert_eq!(*wire.sent.borrow(), [3, MAX_FRAME]);
    }
}
