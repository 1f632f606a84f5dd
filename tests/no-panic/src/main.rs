//! `Controller::step`, `retune` and `request`, and a panic handler that calls a function that is nowhere. `cargo xtask
//! replay` links this: it succeeds only when the compiler has shown every panic unreachable.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "memory that the compiler may not look through, and the function that is nowhere")]
mod target {
    use core::hint::black_box;
    use core::mem::MaybeUninit;

    use shakedown_core::{Controller, OperatorRequest, Sample, Settings};

    unsafe extern "C" {
        fn a_panic_is_left_in_step() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: never linked.
        unsafe { a_panic_is_left_in_step() }
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        // SAFETY: never run.
        let settings = unsafe { black_box(MaybeUninit::<Settings>::uninit()).assume_init() };
        let mut samples = black_box([Sample::default(); 2]);
        if let Ok(mut controller) = Controller::new(&settings) {
            loop {
                let _ = black_box(controller.request(black_box(OperatorRequest::Arm)));
                let _ = black_box(controller.retune(black_box(&settings)));
                #[cfg(feature = "planted")]
                {
                    samples[black_box(7)].reference = 1.0;
                }
                black_box(controller.step(black_box(&samples[0])));
                samples = black_box(samples);
            }
        }
        loop {
            cortex_m::asm::nop();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
