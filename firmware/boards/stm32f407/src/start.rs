//! From reset to the first tick.

use cortex_m::{Peripherals, singleton};
use defmt_rtt as _;
use shakedown_core::link::Setup;
use shakedown_firmware::parts::{Linked, Ticked};
use shakedown_firmware::queues::{LoopEnd, Queues};
use shakedown_firmware::{ControlLoop, LinkServer, store};
use stm32f4xx_hal::{flash::LockedFlash, pac, prelude::*};

use crate::chip::{Control, Line, Link};
use crate::pair::{Pair, Parts};
use crate::watchdog::{Registers, Watchdog};
use crate::{clock, entropy, failure, flash::Flash, line, pins::Pins, ticker::Ticker};

/// Sets everything up, the watchdog first: a start that hangs is a program that hangs. The first tick follows one period later.
pub fn start<P: Pair>(
    device: pac::Peripherals,
    mut core: Peripherals,
    queues: &'static mut Queues,
) -> (Control<P>, &'static mut Link) {
    let watchdog = Watchdog::start(Registers(device.IWDG));
    let (mut rcc, clock) = clock::start(device.RCC);
    let restarted = clock::restarted(&rcc);
    let flash = Flash(LockedFlash::new(device.FLASH));
    let (setup, stored) = store::load_or_default(&flash, P::LIMITS);
    let port_a = device.GPIOA.split(&mut rcc);
    let port_b = device.GPIOB.split(&mut rcc);
    let port_d = device.GPIOD.split(&mut rcc);
    // A line with nothing at its end is idle, not noise.
    let _line = (port_d.pd8.into_alternate::<7>(), port_d.pd9.into_alternate::<7>().internal_pull_up(true));
    let pins = Pins::new(port_b.pb0.into_push_pull_output(), port_b.pb1.into_pull_up_input(), device.PWR, &mut rcc);
    let parts = Parts {
        adc: device.ADC1,
        adc_common: device.ADC_COMMON,
        dac: device.DAC,
        dma: device.DMA2,
        scans: device.TIM1,
        input_bus: device.SPI1,
        output_bus: device.SPI2,
        port_a,
        pb12: port_b.pb12,
        pb13: port_b.pb13,
        pb15: port_b.pb15,
    };
    let Some(converters) = P::set_up(parts, &mut rcc) else { failure::park() };
    let Some(line) = line::start(device.USART3, device.DMA1, &mut rcc) else { failure::park() };
    let ticker = Ticker::new(device.TIM2, setup.control.rate as u32, P::CONVERSION, &mut rcc);
    let (loop_end, server_end) = queues.split();
    let decide = place_loop(&setup, loop_end);
    shakedown_firmware::failure::prepare(decide.zero_flow(), P::put_last);
    let Ok(()) = decide.begin(&setup, restarted) else { failure::park() };
    let entropy = entropy::gather(&device.RNG, &mut core.DCB, &mut core.DWT, &mut rcc);
    let server = LinkServer::new(setup, stored, clock, P::LIMITS, entropy, server_end);
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
