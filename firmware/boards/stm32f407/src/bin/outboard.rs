//! shakedown on an STM32F407 with converters outboard: resources and task signatures. What the registers need is in the library above
//! this file, what the tasks do in that of the firmware, and what decides the output in the core.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use shakedown_firmware::queues::Queues;

    use shakedown_stm32f407::{chip::Control, chip::Link, line, outboard::Outboard, start};

    #[shared]
    struct Shared {
        #[lock_free]
        control: Control<Outboard>,
    }

    #[local]
    struct Local {
        link: &'static mut Link,
    }

    #[init(local = [queues: Queues = Queues::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let (control, link) = start::start(context.device, context.core, context.local.queues);
        (Shared { control }, Local { link })
    }

    /// The converter has had its time for every input of this tick.
    #[task(binds = TIM2, priority = 15, shared = [control])]
    fn tick(context: tick::Context) {
        context.shared.control.tick();
    }

    /// Bytes have come and the line fell idle, or one of the others below asks for it.
    #[task(binds = USART3, priority = 2, local = [link])]
    fn link(context: link::Context) {
        context.local.link.serve();
    }

    /// Half of the receive buffer is full.
    #[task(binds = DMA1_STREAM1, priority = 3)]
    fn received(_: received::Context) {
        line::received();
    }

    /// The frame has left.
    #[task(binds = DMA1_STREAM3, priority = 3)]
    fn sent(_: sent::Context) {
        line::sent();
    }

    #[idle]
    fn idle(_: idle::Context) -> ! {
        loop {
            cortex_m::asm::wfi();
        }
    }
}

/// The firmware runs on its target only; on the host this package is its library and the tests of it.
#[cfg(not(target_os = "none"))]
fn main() {}
