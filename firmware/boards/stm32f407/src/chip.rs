//! What the tick and the link find of this chip.

use shakedown_firmware::options::Options;
use shakedown_firmware::{line, parts};

use crate::{flash::Flash, line::Port, options, pins::Pins, ticker::Ticker, watchdog::Registers};

/// The tick, with converters `P`.
pub type Control<P> = parts::Control<Stm32f407, P>;

/// The link.
pub type Link = parts::Link<Stm32f407>;

/// The serial line.
pub(crate) type Line = line::Line<Port>;

/// An STM32F407.
pub struct Stm32f407;

impl parts::Chip for Stm32f407 {
    type Pins = Pins;
    type Ticker = Ticker;
    type Watchdog = Registers;
    type Line = Line;
    type Flash = Flash;

    fn options() -> Options {
        options::read()
    }
}
