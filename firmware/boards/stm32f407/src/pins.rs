//! Relay and emergency stop, and the supply's own monitor.

use stm32f4xx_hal::{
    gpio::{Input, Output, PB0, PB1},
    pac::PWR,
    rcc::{Enable, Rcc},
};

use shakedown_core::link::StopCause;
use shakedown_firmware::parts;

/// Relay, emergency stop and supply monitor.
pub struct Pins {
    relay: PB0<Output>,
    stop: PB1<Input>,
    power: PWR,
}

impl Pins {
    /// With the relay open and the supply monitor at 2.84 V falling, 2.93 V rising: below a board of 3.0 V, above the 2.7 V
    /// that the flash is written with.
    pub fn new(mut relay: PB0<Output>, stop: PB1<Input>, power: PWR, rcc: &mut Rcc) -> Self {
        relay.set_low();
        // Without its clock the monitor takes no setting and says that all is well.
        PWR::enable(rcc);
        // SAFETY: any three bits are a threshold.
        power.cr().modify(|_, w| unsafe { w.pls().bits(5) }.pvde().set_bit());
        Self { relay, stop, power }
    }
}

impl parts::Pins for Pins {
    #[inline]
    fn set_relay(&mut self, closed: bool) {
        if closed {
            self.relay.set_high();
        } else {
            self.relay.set_low();
        }
    }

    #[inline]
    fn emergency_stop(&self) -> bool {
        self.stop.is_high()
    }

    #[inline]
    fn supply_low(&self) -> bool {
        self.power.csr().read().pvdo().bit_is_set()
    }

    fn standing_cause() -> Option<StopCause> {
        // SAFETY: both registers are read only.
        let (stop, power) = unsafe { (stm32f4xx_hal::pac::GPIOB::steal(), PWR::steal()) };
        if stop.idr().read().bits() & 1 << 1 != 0 {
            Some(StopCause::EmergencyStop)
        } else if power.csr().read().pvdo().bit_is_set() {
            Some(StopCause::SupplyLow)
        } else {
            None
        }
    }
}

/// Opens the relay, whoever owns it: for the end of a program that has failed.
pub fn open_relay() {
    // SAFETY: a write to the set/reset register touches the one bit named, and nothing runs after it.
    unsafe { stm32f4xx_hal::pac::GPIOB::steal() }.bsrr().write(|w| unsafe { w.bits(1 << 16) });
}
