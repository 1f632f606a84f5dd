//! From reset to the first tick.

use cortex_m::{Peripherals, singleton};
use defmt_rtt as _;
use shakedown_core::link::Setup;
use shakedown_firmware::parts::{Linked, Pair as _, Ticked};
use shakedown_firmware::queues::{LoopEnd, Queues};
use shakedown_firmware::{ControlLoop, LinkServer, store};
use stm32g4::stm32g474 as pac;

use crate::chip::{Control, Line, Link};
use crate::converters::{LIMITS, OnChip};
use crate::watchdog::{Registers, Watchdog};
use crate::{clock, entropy, failure, flash::Flash, line, pins::Pins, ticker::Ticker};

/// Sets everything up, the watchdog first: a start that hangs is a program that hangs. The first tick follows one period later.
pub fn start(
    device: pac::Peripherals,
    mut core: Peripherals,
    queues: &'static mut Queues,
) -> (Control, &'static mut Link) {
    let watchdog = Watchdog::start(Registers(device.IWDG));
    let restarted = clock::restarted(&device.RCC);
    let Some(clock) = clock::start(&device.RCC, &device.FLASH, &device.PWR) else { failure::park() };
    let flash = Flash::new(device.FLASH);
    let (setup, stored) = store::load_or_default(&flash, LIMITS);
    let pins = Pins::new(&device.GPIOA, device.GPIOB, &device.GPIOC, device.PWR);
    // SAFETY: the line touches two channels of the controller, the converters a third.
    let channels = unsafe { pac::DMA1::steal() };
    let Some(line) = line::start(device.USART3, channels, &device.DMAMUX) else { failure::park() };
    let converters = OnChip::new(device.ADC1, &device.ADC12_COMMON, device.DAC1, device.DMA1, device.DMAMUX);
    let Some(converters) = converters else { failure::park() };
    let ticker = Ticker::new(device.TIM2, setup.control.rate as u32);
    let (loop_end, server_end) = queues.split();
    let decide = place_loop(&setup, loop_end);
    shakedown_firmware::failure::prepare(decide.zero_flow(), OnChip::put_last);
    let Ok(()) = decide.begin(&setup, restarted) else { failure::park() };
    let entropy = entropy::gather(&device.RNG, &mut core.DCB, &mut core.DWT);
    let server = LinkServer::new(setup, stored, clock, LIMITS, entropy, server_end);
    let link = place_link(server, line, flash);
    defmt::info!("started: settings from flash {}, after a failure {}", stored, restarted);
    let control = Control::new(decide, Ticked { converters, pins, ticker, watchdog });
    control.board().ticker.start();
    (control, link)
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
    singleton!(: Link = Link::new(server, Linked { line, flash })).unwrap_or_else(|| failure::park())
}
