//! The tests of the image that run as fast as the emulator does, in one binary: it takes longer to compile than anything that a
//! test adds to it, and a long test leaves no processor idle beside another.

mod common;

mod beside;
mod bit_identity;
mod campaign;
mod cost;
mod diagnose;
mod faults;
mod flash;
mod hil;
mod options;
mod outboard;
mod rehearsal;
mod relay;
mod resolution;
mod second_opinion;
mod shorts;
mod silicon;
