//! shakedown on an STM32G474: resources and task signatures. What the registers need is in the library beside this file, what the tasks
//! do in that of the firmware, and what decides the output in the core.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[rtic::app(device = stm32g4::stm32g474, peripherals = true)]
mod app {
    use shakedown_firmware::queues::Queues;

    use shakedown_stm32g474::{chip::Control, chip::Link, line, start};

    #[shared]
    struct Shared {
        #[lock_free]
        control: Control,
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

    /// The converter has sampled every input of this tick.
    #[task(binds = DMA1_CH1, priority = 15, shared = [control])]
    fn tick(context: tick::Context) {
        context.shared.control.tick();
    }

    /// The converter overran: this tick has no sample.
    #[task(binds = ADC1_2, priority = 15, shared = [control])]
    fn lost(context: lost::Context) {
        context.shared.control.tick_without_sample();
    }

    /// Bytes have come and the line fell idle, or one of the others below asks for it.
    #[task(binds = USART3, priority = 2, local = [link])]
    fn link(context: link::Context) {
        context.local.link.serve();
    }

    /// Half of the receive buffer is full.
    #[task(binds = DMA1_CH2, priority = 3)]
    fn received(_: received::Context) {
        line::received();
    }

    /// The frame has left.
    #[task(binds = DMA1_CH3, priority = 3)]
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

/// The firmware runs on its target only.
#[cfg(not(target_os = "none"))]
fn main() {}
