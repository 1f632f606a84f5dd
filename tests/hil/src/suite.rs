//! The tests, in their order.

use cortex_m::peripheral::{DWT, NVIC, SCB};
use cortex_m_rt::entry;
use defmt_rtt as _;
use shakedown_core::link::Clock;
use shakedown_firmware::converters::Converters as _;
use shakedown_firmware::parts::{Pair as _, Pins as _};
use stm32f4xx_hal::{
    pac::{self, Interrupt},
    prelude::*,
};

use board::{
    clock, entropy, on_chip, on_chip::OnChip, pins, pins::Pins, ticker::Ticker, watchdog::Registers, watchdog::Watchdog,
};

use crate::console::{Fatal, Report};

/// Control rate, Hz, and cycles of the processor from tick to tick.
const RATE: u32 = 4000;
const PERIOD: f32 = 42_000.0;
/// What is waited before a tick is looked for: on this core the wait takes up to half as much again, and is over before the tick.
const MOST_OF_A_PERIOD: u32 = 25_000;
const CYCLES_A_MILLISECOND: f32 = 168_000.0;
/// Looks for a tick, each of ten cycles and more: twenty periods.
const PATIENCE: u32 = 20 * 4200;
/// Cycles between two notes of the time while the watchdog is starved.
const STRIDE: u32 = 1000;
const MIDDLE: u16 = 32768;
/// Ticks that a test of the timer looks at, and samples of one of noise.
const TICKS: usize = 100;
const SAMPLES: u16 = 64;
const OPTIONS: *const u32 = 0x4002_3C14 as *const u32;

#[entry]
fn run() -> ! {
    let (Some(device), Some(mut core)) = (pac::Peripherals::take(), cortex_m::Peripherals::take()) else {
        Report::default().end()
    };
    let mut report = match Report::resumed() {
        Some((Fatal::Starved, mut report, cycles)) => {
            report.bounded("watchdog resets in time", cycles as f32 / CYCLES_A_MILLISECOND, "ms", 38.0, 105.0);
            fail(&report, device)
        }
        Some((Fatal::Panicked, mut report, _)) => {
            report.bounded("a panic ends in a reset", 1.0, "", 1.0, 1.0);
            lose_clock(&report, device)
        }
        Some((Fatal::Unclocked, mut report, went_on)) => {
            report.bounded("a clock that fails ends in a reset", went_on as f32, "(1: it went on)", 0.0, 0.0);
            report.end()
        }
        None => Report::default(),
    };
    let (mut rcc, source) = clock::start(device.RCC);
    let runs_on = [Clock::Crystal, Clock::External, Clock::Internal].iter().position(|&one| one == source);
    report.bounded("clock is a crystal or comes from outside", runs_on.unwrap_or(2) as f32, "(2: internal)", 0.0, 1.0);
    let entropy = [(); 2].map(|()| entropy::gather(&device.RNG, &mut core.DCB, &mut core.DWT, &mut rcc));
    report.bounded("two draws of random numbers differ", f32::from(u8::from(entropy[0] != entropy[1])), "", 1.0, 1.0);

    let (port_a, port_b) = (device.GPIOA.split(&mut rcc), device.GPIOB.split(&mut rcc));
    let _analog = (port_a.pa1.into_analog(), port_a.pa4.into_analog());
    let mut pins = Pins::new(port_b.pb0.into_push_pull_output(), port_b.pb1.into_pull_up_input(), device.PWR, &mut rcc);
    report.bounded("supply monitor is quiet", f32::from(u8::from(pins.supply_low())), "", 0.0, 0.0);
    relay(&mut report, &mut pins);

    let mut pair = OnChip::new(device.ADC1, &device.ADC_COMMON, device.DAC, device.DMA2, device.TIM1, &mut rcc);
    let ticker = Ticker::new(device.TIM2, RATE, None, &mut rcc);
    pair.go_live();
    ticker.start();
    ticks(&mut report, &mut pair);
    looped(&mut report, &mut pair);
    // SAFETY: a register that may be read at any time.
    Report::noted(
        "option bytes (RM0090, 3.9.10); bits 3 and 2 are 0 for brown-out level 3, bit 5 for a hardware watchdog",
        unsafe { OPTIONS.read_volatile() },
    );
    starve(&report, Watchdog::start(Registers(device.IWDG)))
}

/// Cycles from the write that opens the relay to the pin's reading low.
fn relay(report: &mut Report, pins: &mut Pins) {
    let low = || {
        // SAFETY: the register is read only.
        let port = unsafe { pac::GPIOB::steal() };
        port.idr().read().bits() & 1 == 0
    };
    pins.set_relay(true);
    cortex_m::asm::delay(1000);
    report.bounded("relay pin is high when closed", f32::from(u8::from(!low())), "", 1.0, 1.0);
    let from = DWT::cycle_count();
    pins::open_relay();
    let opened = (0..PATIENCE).any(|_| low());
    let cycles = DWT::cycle_count().wrapping_sub(from);
    report.bounded("relay pin falls", if opened { cycles as f32 } else { f32::INFINITY }, "cycles", 0.0, 168.0);
}

/// Waits for the next tick's sample, and when it came; none where none comes.
fn tick(pair: &mut OnChip) -> Option<u32> {
    cortex_m::asm::delay(MOST_OF_A_PERIOD);
    let came = (0..PATIENCE).any(|_| NVIC::is_pending(Interrupt::DMA2_STREAM0));
    let at = DWT::cycle_count();
    let failed = pair.failed();
    NVIC::unpend(Interrupt::DMA2_STREAM0);
    (came && !failed).then_some(at)
}

/// Period and jitter of the sampling, cycles.
fn ticks(report: &mut Report, pair: &mut OnChip) {
    let (mut last, mut shortest, mut longest, mut sum) = (tick(pair), f32::INFINITY, 0.0_f32, 0.0);
    for _ in 0..TICKS {
        let next = tick(pair);
        let period = match (last, next) {
            (Some(last), Some(next)) => next.wrapping_sub(last) as f32,
            _ => f32::NAN,
        };
        (shortest, longest, sum) = (shortest.min(period), longest.max(period), sum + period);
        last = next;
    }
    report.bounded("period of a tick", sum / TICKS as f32, "cycles", 0.999 * PERIOD, 1.001 * PERIOD);
    report.bounded("jitter of a tick", longest - shortest, "cycles", 0.0, 100.0);
}

/// The output, looped back to the LVDT's input: the largest difference over the range, and the noise in its middle, codes of
/// 65536.
fn looped(report: &mut Report, pair: &mut OnChip) {
    let mut back = |code: u16| {
        let _ = pair.write(code);
        for _ in 0..3 {
            let _ = tick(pair);
        }
        f32::from(on_chip::last_displacement())
    };
    let worst = (1..=15).map(|step| step * 4096).fold(0.0_f32, |worst, code| {
        let off = back(code) - f32::from(code);
        worst.max(off).max(-off)
    });
    report.bounded("output to input, largest difference", worst, "codes", 0.0, 320.0);
    let (mut sum, mut square) = (0.0, 0.0);
    for _ in 0..SAMPLES {
        let off = back(MIDDLE) - f32::from(MIDDLE);
        (sum, square) = (sum + off, square + off * off);
    }
    let mean = sum / f32::from(SAMPLES);
    report.bounded(
        "output to input, variance in the middle",
        square / f32::from(SAMPLES) - mean * mean,
        "codes^2",
        0.0,
        64.0,
    );
}

/// Lets the watchdog have its way; the report goes on after the reset.
fn starve(report: &Report, _running: Watchdog) -> ! {
    report.keep(Fatal::Starved);
    let from = DWT::cycle_count();
    loop {
        Report::keep_cycles(DWT::cycle_count().wrapping_sub(from));
        cortex_m::asm::delay(STRIDE);
    }
}

/// Panics with the relay closed. That it opens before anything is logged only who watches its pin can say: the emulated board, or a scope.
#[allow(clippy::panic, reason = "what is tested")]
fn fail(report: &Report, device: pac::Peripherals) -> ! {
    close_relay(report, Fatal::Panicked, device);
    panic!()
}

/// Raises what the clock security system raises when the crystal stops, with the relay closed.
fn lose_clock(report: &Report, device: pac::Peripherals) -> ! {
    close_relay(report, Fatal::Unclocked, device);
    Report::keep_cycles(0);
    // SAFETY: the write pends the one exception (ARMv7-M, B3.2.4: NMIPENDSET).
    unsafe { (*SCB::PTR).icsr.write(1 << 31) };
    cortex_m::asm::isb();
    Report::keep_cycles(1);
    loop {
        cortex_m::asm::nop();
    }
}

/// Closes the relay, and keeps the report over the reset that is to come of `fatal`.
fn close_relay(report: &Report, fatal: Fatal, device: pac::Peripherals) {
    report.keep(fatal);
    let (mut rcc, _) = clock::start(device.RCC);
    let port_b = device.GPIOB.split(&mut rcc);
    let mut pins = Pins::new(port_b.pb0.into_push_pull_output(), port_b.pb1.into_pull_up_input(), device.PWR, &mut rcc);
    let _running = Watchdog::start(Registers(device.IWDG));
    pins.set_relay(true);
    cortex_m::asm::delay(1000);
}
