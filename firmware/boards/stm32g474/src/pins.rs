//! Relay and emergency stop, and the supply's own monitor.

use shakedown_core::link::StopCause;
use shakedown_firmware::parts;
use stm32g4::stm32g474::{GPIOA, GPIOB, GPIOC, PWR};

/// PB0 in the port's set/reset register.
const CLOSE: u32 = 1;
const OPEN: u32 = 1 << 16;
/// PB1.
const STOP: u32 = 1 << 1;
/// `PWR_CR2`: the monitor is on, at level 5: 2.8 V. `PWR_SR2`: the supply is below.
const MONITOR: u32 = 1 | 5 << 1;
const BELOW: u32 = 1 << 11;
/// Two bits a pin of `MODER`: output, alternate, analog; of `PUPDR`: up.
const OUTPUT: u32 = 0b01;
const ALTERNATE: u32 = 0b10;
const ANALOG: u32 = 0b11;
const UP: u32 = 0b01;
/// USART3 on PC10 and PC11.
const FUNCTION: u32 = 7;

/// Relay, emergency stop and supply monitor.
pub struct Pins {
    port: GPIOB,
    power: PWR,
}

impl Pins {
    /// With the relay open, and the supply monitor at 2.8 V: below a board of 3.0 V, above the 2.7 V that the converters want.
    pub fn new(analog: &GPIOA, port: GPIOB, line: &GPIOC, power: PWR) -> Self {
        // PA0 to PA4.
        analog.moder().modify(|r, w| unsafe { w.bits(two_bits(r.bits(), 0..=4, ANALOG)) });
        port.bsrr().write(|w| unsafe { w.bits(OPEN) });
        port.moder().modify(|r, w| unsafe { w.bits(two_bits(two_bits(r.bits(), 0..=0, OUTPUT), 1..=1, 0)) });
        port.pupdr().modify(|r, w| unsafe { w.bits(two_bits(r.bits(), 1..=1, UP)) });
        // A line with nothing at its end is idle, not noise.
        line.pupdr().modify(|r, w| unsafe { w.bits(two_bits(r.bits(), 11..=11, UP)) });
        line.afrh().modify(|r, w| unsafe { w.bits(r.bits() & !0xFF00 | FUNCTION << 8 | FUNCTION << 12) });
        line.moder().modify(|r, w| unsafe { w.bits(two_bits(r.bits(), 10..=11, ALTERNATE)) });
        power.cr2().modify(|r, w| unsafe { w.bits(r.bits() & !0xF | MONITOR) });
        Self { port, power }
    }
}

impl parts::Pins for Pins {
    #[inline]
    fn set_relay(&mut self, closed: bool) {
        self.port.bsrr().write(|w| unsafe { w.bits(if closed { CLOSE } else { OPEN }) });
    }

    #[inline]
    fn emergency_stop(&self) -> bool {
        self.port.idr().read().bits() & STOP != 0
    }

    #[inline]
    fn supply_low(&self) -> bool {
        self.power.sr2().read().bits() & BELOW != 0
    }

    fn standing_cause() -> Option<StopCause> {
        // SAFETY: both registers are read only.
        let (port, power) = unsafe { (GPIOB::steal(), PWR::steal()) };
        if port.idr().read().bits() & STOP != 0 {
            Some(StopCause::EmergencyStop)
        } else if power.sr2().read().bits() & BELOW != 0 {
            Some(StopCause::SupplyLow)
        } else {
            None
        }
    }
}

/// `bits` with the two of each of these pins replaced.
fn two_bits(bits: u32, pins: core::ops::RangeInclusive<u32>, value: u32) -> u32 {
    pins.fold(bits, |bits, pin| bits & !(0b11 << (2 * pin)) | value << (2 * pin))
}

/// Opens the relay, whoever owns it: for the end of a program that has failed.
pub fn open_relay() {
    // SAFETY: a write to the set/reset register touches the one bit named, and nothing runs after it.
    unsafe { GPIOB::steal() }.bsrr().write(|w| unsafe { w.bits(OPEN) });
}
