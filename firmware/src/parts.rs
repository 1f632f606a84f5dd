//! A board put together from its parts: what a tick asks of them, and what the link does. A port supplies the parts of a [`Chip`], and
//! says with which converters it runs.

use shakedown_core::link::{MAX_FRAME, Setup, StopCause};

use crate::converters::Converters;
use crate::line::Serial;
use crate::link_task::{self, LinkBoard};
use crate::options::Options;
use crate::output::ZeroFlow;
use crate::queues::TestStatus;
use crate::store::{self, Slots};
use crate::tick::{self, Board};
use crate::watchdog::{self, Watchdog};
use crate::{OpenRelay, failure, published};

/// The tick on a chip with converters `P`.
pub type Control<C, P> = tick::Control<'static, 'static, Ticked<C, P>>;

/// The link on a chip.
pub type Link<C> = link_task::Link<'static, Linked<C>>;

/// What a chip is made of.
pub trait Chip {
    /// Relay, emergency stop and supply.
    type Pins: Pins;
    /// The timer of the ticks.
    type Ticker: Ticker;
    /// The watchdog's registers.
    type Watchdog: watchdog::Registers;
    /// The serial line.
    type Line: Serial;
    /// The flash.
    type Flash: Flash;

    /// The option bytes that matter.
    fn options() -> Options;
}

/// Relay, emergency stop and the supply's monitor.
pub trait Pins {
    /// Closes or opens the relay.
    fn set_relay(&mut self, closed: bool);

    /// Whether the emergency-stop circuit is open.
    fn emergency_stop(&self) -> bool;

    /// Whether the supply is below its threshold.
    fn supply_low(&self) -> bool;

    /// A cause of a trip that stands on the inputs now, whoever owns them.
    fn standing_cause() -> Option<StopCause>;
}

/// The timer of the ticks.
pub trait Ticker {
    /// `rate` ticks a second from the next one on.
    fn set_rate(&self, rate: u32);
}

/// Converters as the tick has them.
pub trait Pair: Converters {
    /// Whether the next tick has come already; asked at the end of a tick.
    fn late() -> bool;

    /// Lets the last code written out, if it is not out yet.
    fn go_live(&mut self);

    /// Puts on the output what stops the oil, whoever owns it: for the end of a program that has failed.
    fn put_last(zero_flow: ZeroFlow);
}

/// The flash.
pub trait Flash: Slots<Error: defmt::Format> + Sized {
    /// Lets `work` write. The ticks stop meanwhile, with the output as it is: only with the relay open.
    fn write<T>(&mut self, open: &OpenRelay, work: impl FnOnce(&mut Self) -> T) -> T;
}

/// What the tick owns.
#[allow(missing_debug_implementations, reason = "registers have none")]
pub struct Ticked<C: Chip, P> {
    /// Inputs and output.
    pub converters: P,
    /// Relay, emergency stop, supply.
    pub pins: C::Pins,
    /// The timer.
    pub ticker: C::Ticker,
    /// Fed where something follows a tick, which is at least every sixteenth, and the link has been served.
    pub watchdog: Watchdog<C::Watchdog>,
}

impl<C: Chip, P: Pair> Board for Ticked<C, P> {
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
        C::Line::wake();
    }
}

/// What the link owns.
#[allow(missing_debug_implementations, reason = "registers have none")]
pub struct Linked<C: Chip> {
    /// The line.
    pub line: C::Line,
    /// The flash.
    pub flash: C::Flash,
}

impl<C: Chip> LinkBoard for Linked<C> {
    fn acknowledge(&mut self) {
        self.line.acknowledge();
    }

    fn take(&mut self) -> Option<u8> {
        self.line.take()
    }

    fn ready(&self) -> bool {
        self.line.ready()
    }

    fn send(&mut self, write: impl FnOnce(&mut [u8; MAX_FRAME]) -> usize) {
        self.line.send(write);
    }

    fn save(&mut self, proof: &OpenRelay, setup: &Setup) -> bool {
        let done = self.flash.write(proof, |flash| store::save(flash, setup));
        if let Err(why) = &done {
            defmt::error!("settings not saved: {}", why);
        }
        done.is_ok()
    }

    fn standing_cause(&self) -> Option<StopCause> {
        C::Pins::standing_cause()
    }

    fn options(&self) -> Options {
        C::options()
    }

    fn served(&self) {
        watchdog::served();
    }

    #[cold]
    #[inline(never)]
    fn log(&self, standing: TestStatus) {
        defmt::info!("{}", standing);
    }
}
