//! The tick's board: an STM32F407.

use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::queues::TestStatus;
use shakedown_firmware::tick::{self, Board};

use crate::board::{converters::OnChip, failure, line, pins::Pins, standing, ticker::Ticker, watchdog::Watchdog};

/// The tick.
pub(crate) type Control = tick::Control<'static, 'static, Stm32f407>;

/// What the tick owns of the board.
pub(crate) struct Stm32f407 {
    /// Inputs and output.
    pub(crate) converters: OnChip,
    /// Relay, emergency stop, supply.
    pub(crate) pins: Pins,
    /// The timer.
    pub(crate) ticker: Ticker,
    /// Fed where something follows a tick, which is at least every sixteenth, and the link has been served.
    pub(crate) watchdog: Watchdog,
}

impl Board for Stm32f407 {
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
        standing::publish(standing, ticks, dropped);
        self.converters.go_live();
        line::wake();
    }
}
