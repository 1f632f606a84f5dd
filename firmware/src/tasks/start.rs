//! From reset to the first tick.

use cortex_m::{Peripherals, singleton};
use defmt_rtt as _;
use shakedown_core::link::{Assembler, Setup};
use shakedown_firmware::queues::{LoopEnd, Queues};
use shakedown_firmware::{ControlLoop, LinkServer, defaults, store};
use stm32f4xx_hal::{flash::LockedFlash, pac, prelude::*};

use super::{control::Control, link::Link};
use crate::board::{
    clock, converters::OnChip, entropy, failure, flash::Flash, line::Line, pins::Pins, ticker::Ticker,
    watchdog::Watchdog,
};

/// Sets everything up, the watchdog first: a start that hangs is a program that hangs. The first tick follows one period later.
pub(crate) fn start(
    device: pac::Peripherals,
    mut core: Peripherals,
    queues: &'static mut Queues,
) -> (Control, &'static mut Link) {
    let watchdog = Watchdog::start(device.IWDG);
    let (mut rcc, clock) = clock::start(device.RCC);
    let restarted = clock::restarted(&rcc);
    let flash = Flash(LockedFlash::new(device.FLASH));
    let (setup, stored) = stored_or_default(&flash);
    let port_a = device.GPIOA.split(&mut rcc);
    let port_b = device.GPIOB.split(&mut rcc);
    let port_d = device.GPIOD.split(&mut rcc);
    let _analog = (
        port_a.pa0.into_analog(),
        port_a.pa1.into_analog(),
        port_a.pa2.into_analog(),
        port_a.pa3.into_analog(),
        port_a.pa4.into_analog(),
    );
    // A line with nothing at its end is idle, not noise.
    let _line = (port_d.pd8.into_alternate::<7>(), port_d.pd9.into_alternate::<7>().internal_pull_up(true));
    let pins = Pins::new(port_b.pb0.into_push_pull_output(), port_b.pb1.into_pull_up_input(), device.PWR, &mut rcc);
    let converters = OnChip::new(device.ADC1, &device.ADC_COMMON, device.DAC, device.DMA2, &mut rcc);
    let line = Line::new(device.USART3, device.DMA1, &mut rcc);
    let ticker = Ticker::new(device.TIM2, setup.control.rate as u32, &mut rcc);
    let (loop_end, server_end) = queues.split();
    let decide = place_loop(&setup, loop_end);
    failure::prepare(decide.zero_flow());
    let Ok(()) = decide.begin(&setup, restarted) else { failure::park() };
    let entropy = entropy::gather(&device.RNG, &mut core.DCB, &mut core.DWT, &mut rcc);
    let server = LinkServer::new(setup, stored, clock, defaults::LIMITS, entropy, server_end);
    let link = place_link(server, line, flash);
    defmt::info!("started: settings from flash {}, after a failure {}", stored, restarted);
    let control = Control { decide, converters, pins, ticker, watchdog };
    control.ticker.start();
    (control, link)
}

/// The setup in flash, and whether there is one that this board takes.
#[inline(never)]
fn stored_or_default(flash: &Flash) -> (Setup, bool) {
    match store::load(flash).filter(|found| defaults::LIMITS.check(&found.setup).is_ok()) {
        Some(found) => (found.setup, true),
        None => (defaults::setup(), false),
    }
}

/// Puts the loop where it stays. Every large thing is made by a function of its own: what one of them needs of the stack
/// the others need not have free.
#[inline(never)]
fn place_loop(setup: &Setup, queues: LoopEnd<'static>) -> &'static mut ControlLoop<'static> {
    singleton!(: ControlLoop<'static> = ControlLoop::wired(setup, queues)).unwrap_or_else(|| failure::park())
}

/// Puts the link where it stays.
#[inline(never)]
fn place_link(server: LinkServer<'static>, line: Line, flash: Flash) -> &'static mut Link {
    let link = singleton!(: Link = Link { server, line, flash, assembler: Assembler::new(), answer: None });
    link.unwrap_or_else(|| failure::park())
}
