//! What the tick and the link find of this chip.

use shakedown_firmware::options::Options;
use shakedown_firmware::{line, parts};

use crate::{flash::Flash, line::Port, options, pins::Pins, ticker::Ticker, watchdog::Registers};

/// The tick.
pub type Control = parts::Control<Stm32g474, crate::converters::OnChip>;

/// The link.
pub type Link = parts::Link<Stm32g474>;

/// The serial line.
pub(crate) type Line = line::Line<Port>;

/// An STM32G474.
pub struct Stm32g474;

impl parts::Chip for Stm32g474 {
    type Pins = Pins;
    type Ticker = Ticker;
    type Watchdog = Registers;
    type Line = Line;
    type Flash = Flash;

    fn options() -> Options {
        options::read()
    }
}
