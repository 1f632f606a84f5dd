//! What the tests of the image share: a bench around the board, a host at its line, and the same firmware on the host.
#![allow(dead_code, reason = "each test uses its part")]

pub mod bench;
pub mod seen;
pub mod twin;

use std::path::PathBuf;

use shakedown_core::Mode;
use shakedown_core::link::Setup;
use shakedown_firmware::defaults;

/// The image under test; `cargo xtask firmware` builds it.
pub fn image() -> PathBuf {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../target/thumbv7em-none-eabihf/firmware/shakedown-firmware");
    assert!(path.exists(), "{} is missing: run `cargo xtask firmware` first", path.display());
    path
}

/// The setup for a mode: the paper's gains, every part of the core at work.
pub fn setup(mode: Mode) -> Setup {
    let mut setup = defaults::setup();
    setup.control.mode = mode;
    setup
}

/// A near-field record of `seconds` at 1 kHz, m: a fling step with a velocity pulse beyond the table's limit, and
/// incoherent shaking on top, from a fixed generator.
pub fn near_field(seconds: usize) -> Vec<f32> {
    let mut noise = 0x2545_F491_4F6C_DD1D_u64;
    let mut shake = [0.0_f64; 2];
    (0..seconds * 1000)
        .map(|tick| {
            let t = tick as f64 / 1000.0;
            noise ^= noise << 13;
            noise ^= noise >> 7;
            noise ^= noise << 17;
            let white = (noise >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            shake[0] += 0.02 * (white - shake[0]);
            shake[1] += 0.01 * (shake[0] - shake[1]);
            let pulse = |at: f64, width: f64| 0.035 * (-((t - at) / width).powi(2)).exp() * ((t - at) * 9.0).sin();
            let fling = 0.02 * (1.0 / (1.0 + (-(t - 8.0) * 6.0).exp()) - 1.0 / (1.0 + (-(t - 40.0)).exp()));
            let window = (t / 3.0).min(1.0) * ((seconds as f64 - t) / 5.0).clamp(0.0, 1.0);
            (window * (pulse(8.0, 1.2) + pulse(21.0, 2.5) + fling + 0.12 * shake[1])) as f32
        })
        .collect()
}
