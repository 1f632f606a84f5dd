//! The tracking law and the preview modifier on an emulated Cortex-M4, and how many instructions a tick of them retires.
//!
//! `cargo xtask law-cost` runs this under QEMU, on an STM32F405, with `-icount shift=0`: one instruction is one
//! nanosecond, and the board's timer runs at 168 MHz, 168 counts to a thousand of them. It also says a hash over the bits
//! of every command of a run; on the host this program says the same hash, or the two do not compute alike.
#![cfg_attr(target_os = "none", no_std, no_main)]

mod drive;

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "the emulator's door to its host, and the only owner of the peripherals")]
mod target {
    use core::hint::black_box;

    use crate::drive::{full, hash};

    use cortex_m::Peripherals;
    use cortex_m::peripheral::SYST;
    use cortex_m::peripheral::syst::SystClkSource;
    use shakedown_core::blocks::record::{ReferenceLimits, preview};
    use shakedown_core::blocks::tracking::{Surroundings, Tracking, TrackingInput, TrackingState};
    use shakedown_core::settings::{PREVIEW_PLACES, PREVIEW_WINDOW, TrackingSettings};
    use shakedown_core::{Controller, Sample, Settings};

    const TICKS: u32 = 2000;
    const COUNTS_A_THOUSAND: u32 = 168;

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        loop {
            cortex_m::asm::nop();
        }
    }

    fn host(operation: u32, argument: u32) {
        // SAFETY: the emulator answers; on a board without a debugger this is never run.
        unsafe { cortex_m::asm::semihosting_syscall(operation, argument) };
    }

    fn say(name: &core::ffi::CStr, mut value: u32) {
        host(4, name.as_ptr() as u32);
        let mut digits = *b"           \n\0";
        for digit in digits.iter_mut().take(11).rev() {
            *digit = b'0' + (value % 10) as u8;
            value /= 10;
            if value == 0 {
                break;
            }
        }
        host(4, digits.as_ptr() as u32);
    }

    /// Instructions that one call of `tick` retires, the mean of many.
    fn count(mut tick: impl FnMut(f32)) -> u32 {
        let mut counts = 0;
        for k in 0..TICKS {
            let reference = 0.03 * ((k % 200) as f32 * 0.01 - 1.0);
            let before = SYST::get_current();
            tick(reference);
            counts += before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff;
        }
        counts * (1_000_000 / COUNTS_A_THOUSAND) / TICKS / 1000
    }

    #[inline(never)]
    fn advance(law: &Tracking, state: &mut TrackingState, seen: &TrackingInput) -> f32 {
        law.advance(state, seen)
    }

    #[inline(never)]
    fn of_law(name: &core::ffi::CStr, settings: &TrackingSettings) {
        let around = Surroundings { dt: 1e-3, valve: [2.39, 0.0174], command_limit: 10.0, velocity_limit: 0.242 };
        let Ok(law) = black_box(settings).law(&around) else { return };
        let mut state = TrackingState::default();
        let tick = |reference: f32| {
            let displacement = 0.9 * reference;
            let seen = TrackingInput { reference, displacement, acceleration: 0.01, pressure_difference: 100.0 };
            black_box(advance(black_box(&law), &mut state, black_box(&seen)));
        };
        say(name, count(tick));
    }

    #[inline(never)]
    fn of_controller(name: &core::ffi::CStr, tracking: Option<TrackingSettings>) {
        let settings = Settings { tracking, ..Settings::default() };
        let Ok(mut controller) = Controller::new(black_box(&settings)) else { return };
        let tick = |reference: f32| {
            let sample = Sample { pressure_difference: 100.0, ..Sample::new(reference, 0.9 * reference, 0.01) };
            black_box(controller.step(black_box(&sample)));
        };
        say(name, count(tick));
    }

    /// A preview of half a second: the most of any tick. A reference that keeps inside the tube is looked
    /// at to the end of the window, one that leaves it only as far as decides.
    #[inline(never)]
    fn of_preview(name: &core::ffi::CStr, amplitude: f32) {
        let limits = ReferenceLimits::new(1000.0, 0.242, 0.12);
        let washout = preview::Config::DRIFT_RECOVERY;
        let Ok(config) = preview::Config::new::<PREVIEW_WINDOW>(black_box(&limits), &washout, 0.5) else { return };
        let mut state = preview::State::<PREVIEW_WINDOW, PREVIEW_PLACES>::at(0.0);
        let mut sine = [amplitude, 0.0_f32];
        let mut most = 0;
        for _ in 0..TICKS {
            sine[1] += 0.006 * sine[0];
            sine[0] -= 0.006 * sine[1];
            let before = SYST::get_current();
            black_box(preview::step(black_box(&config), &mut state, sine[1], 0.242));
            most = u32::max(most, before.wrapping_sub(SYST::get_current()) & 0x00ff_ffff);
        }
        say(name, most * (1_000_000 / COUNTS_A_THOUSAND) / 1000);
    }

    /// The end of the memory: controllers by value need more stack than the image's memory map gives, and there is room.
    const TOP: u32 = 0x2002_0000;

    #[cortex_m_rt::entry]
    fn main() -> ! {
        // SAFETY: nothing is on the stack that is needed again.
        unsafe { cortex_m::asm::bootstrap(TOP as *const u32, measure as *const u32) }
    }

    extern "C" fn measure() -> ! {
        // SAFETY: nobody else is here.
        let mut timer = unsafe { Peripherals::steal() }.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(0x00ff_ffff);
        timer.clear_current();
        timer.enable_counter();
        say(
            c"nothing ",
            count(|_| {
                black_box(());
            }),
        );
        of_law(c"law, paper's table ", &TrackingSettings::default());
        of_law(c"law, every part ", &full());
        of_controller(c"controller, bare, paper's loops ", None);
        of_controller(c"controller, bare, law for the paper's table ", Some(TrackingSettings::default()));
        of_controller(c"controller, bare, law with every part ", Some(full()));
        of_preview(c"preview, quiet record, most ", 0.01);
        of_preview(c"preview, record at three times the limit, most ", 0.12);
        say(c"hash, paper's table ", hash(TrackingSettings::default()));
        say(c"hash, every part ", hash(full()));
        host(0x18, 0x2_0026);
        loop {
            cortex_m::asm::nop();
        }
    }
}

#[cfg(not(target_os = "none"))]
#[allow(clippy::print_stdout, reason = "its two lines are all it is for")]
fn main() {
    println!("hash, paper's table {:>10}", drive::hash(shakedown_core::settings::TrackingSettings::default()));
    println!("hash, every part {:>10}", drive::hash(drive::full()));
}
