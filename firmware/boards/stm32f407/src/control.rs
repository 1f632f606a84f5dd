//! The tick's board: an STM32F407.

use shakedown_firmware::output::ZeroFlow;
use shakedown_firmware::queues::TestStatus;
use shakedown_firmware::tick::{self, Board};

use shakedown_firmware::published;

use crate::{failure, line, pair::Pair, pins::Pins, ticker::Ticker, watchdog::Watchdog};

/// The tick, with converters `P`.
pub type Control<P> = tick::Control<'static, 'static, Stm32f407<P>>;

/// What the tick owns of the board.
pub struct Stm32f407<P> {
    /// Inputs and output.
    pub converters: P,
    /// Relay, emergency stop, supply.
    pub pins: Pins,
    /// The timer.
    pub ticker: Ticker,
    /// Fed where something follows a tick, which is at least every sixteenth, and the link has been served.
    pub watchdog: Watchdog,
}

impl<P: Pair> Board for Stm32f407<P> {
    type Pair = P;

    #[inline]
    fn pair(&mut self) -> &mut P {
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
        P::late()
    }

    #[inline]
    fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }

    fn take_setup(&mut self, rate: u32, zero_flow: ZeroFlow) {
        self.ticker.set_rate(rate);
        failure::prepare(zero_flow, P::put_last);
    }

    #[inline]
    fn tell(&mut self, standing: TestStatus, ticks: u32, dropped: u32) {
        published::publish(standing, ticks, dropped);
        self.converters.go_live();
        line::wake();
    }
}
