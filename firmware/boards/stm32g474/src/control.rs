//! The tick's board: an STM32G474.

use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::published;
use shakedown_firmware::queues::TestStatus;
use shakedown_firmware::tick::{self, Board};

use crate::{converters::OnChip, failure, line, pins::Pins, ticker::Ticker, watchdog::Watchdog};

/// The tick.
pub type Control = tick::Control<'static, 'static, Stm32g474>;

/// What the tick owns of the board.
pub struct Stm32g474 {
    pub(crate) converters: OnChip,
    pub(crate) pins: Pins,
    pub(crate) ticker: Ticker,
    /// Fed where something follows a tick, which is at least every sixteenth, and the link has been served.
    pub(crate) watchdog: Watchdog,
}

impl Board for Stm32g474 {
    type Pair = OnChip;

    #[inline]
    fn pair(&mut self) -> &mut OnChip {
        &mut self.converters
    }

    #[inline]
    fn emergency_stop(&self) -> bool {
        self.pins.emergency_stop()
    }

    #[inline]
    fn supply_low(&self) -> bool {
        self.pins.supply_low()
    }

    #[inline]
    fn set_relay(&mut self, closed: bool) {
        self.pins.set_relay(closed);
    }

    #[inline]
    fn late(&self) -> bool {
        OnChip::late()
    }

    #[inline]
    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }

    fn take_setup(&mut self, rate: u32, zero_flow: ZeroFlow) {
        self.ticker.set_rate(rate);
        failure::prepare(zero_flow);
    }

    #[inline]
    fn tell(&mut self, standing: TestStatus, ticks: u32, dropped: u32) {
        published::publish(standing, ticks, dropped);
        self.converters.go_live();
        line::wake();
    }
}
