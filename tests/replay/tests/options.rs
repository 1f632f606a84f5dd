//! Option bytes: what a board says of them over the link, against the reference manuals' tables.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

/// The board's own reading of its registers; on the host no register is read.
#[path = "../../../firmware/boards/stm32g474/src/options.rs"]
#[allow(unreachable_pub, reason = "a module of the board's, read here as it is")]
mod g474;

use crate::common::{image, outboard};
use shakedown::blocks::device::LinkClient;
use shakedown_core::link::OptionPurpose::{self, Banks, BrownOut, ReadProtection, Watchdog, WriteProtection};
use shakedown_core::link::{HostRequest, OptionByte, Report};
use shakedown_replay::{Fitted, Tick, World};

/// Asks for the option bytes of a chip that has these.
struct Asking {
    fitted: Fitted,
    bytes: u32,
    talker: LinkClient,
    heard: Option<Vec<OptionByte>>,
    ticks: usize,
}

impl World for Asking {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        self.talker.hear(tick.line.from_device.drain(..));
        while let Some(report) = self.talker.report() {
            if let Report::Options(options) = report {
                self.heard = Some(options.to_vec());
            }
        }
        self.ticks += 1;
        if self.ticks == 50 {
            self.talker.say(&HostRequest::ReadOptions);
        }
        tick.line.to_device.extend(self.talker.outgoing().drain(..));
        self.heard.is_none() && self.ticks < 200
    }

    fn fitted(&self) -> Fitted {
        self.fitted
    }

    fn option_bytes(&self) -> u32 {
        self.bytes
    }
}

fn asked(fitted: Fitted, bytes: u32) -> Vec<OptionByte> {
    let image = if fitted == Fitted::OnChip { image() } else { outboard() };
    let world = Asking { fitted, bytes, talker: LinkClient::new(), heard: None, ticks: 0 };
    let ran = shakedown_replay::run(&image, world).unwrap();
    assert!(ran.blind_spots.iter().all(|spot| !spot.starts_with("FLASH")), "{:?}", ran.blind_spots);
    ran.world.heard.expect("the device said nothing of its option bytes")
}

/// What is not as the board asks: what for, under which name, found and wanted.
fn differing(options: &[OptionByte]) -> Vec<(OptionPurpose, &str, u32, u32)> {
    let differ = options.iter().filter(|byte| byte.found != byte.wanted);
    differ.map(|byte| (byte.purpose, byte.name.as_str(), byte.found, byte.wanted)).collect()
}

/// RM0090, 3.9.10: a chip from the factory has brown-out off (3) and a watchdog that the program starts.
#[test]
fn the_image_says_what_a_chip_from_the_factory_lacks() {
    for fitted in [Fitted::OnChip, Fitted::Outboard] {
        let options = asked(fitted, 0x0FFF_AAED);
        assert_eq!(differing(&options), [(BrownOut, "BOR_LEV", 3, 0), (Watchdog, "WDG_SW", 1, 0)], "{fitted:?}");
        assert_eq!(options.len(), 5);
    }
}

#[test]
fn the_image_is_content_with_what_it_asks_for() {
    assert_eq!(differing(&asked(Fitted::OnChip, 0x0FFF_AAC1)), []);
}

/// Level 1 of the read protection, and sector 11 write protected.
#[test]
fn the_image_says_what_is_protected() {
    let options = asked(Fitted::OnChip, 0x07FF_55C1);
    assert_eq!(differing(&options), [(ReadProtection, "RDP", 0x55, 0xAA), (WriteProtection, "nWRP11", 0, 1)]);
}

/// RM0440, 5.7.8: as the factory delivers it, brown-out level 0, watchdog by the program, two banks, nothing protected.
const FACTORY: u32 = 0xFFEF_F8AA;
const WANTED: u32 = FACTORY & !(1 << 16) | 3 << 8;
const NONE: u32 = 0xFF00_FFFF;

#[test]
fn the_stm32g474_reads_its_registers_as_the_manual_says() {
    let found = g474::of(FACTORY, [NONE; 2]);
    assert_eq!(differing(&found), [(BrownOut, "BOR_LEV", 0, 3), (Watchdog, "IWDG_SW", 1, 0)]);
    assert_eq!(differing(&g474::of(WANTED, [NONE; 2])), []);
}

/// The register of a protected area, from its first page to its last.
fn area(first: u32, last: u32) -> u32 {
    first | last << 16
}

/// One bank, and an area from page 100 to 126; the other ends before the slots.
#[test]
fn the_stm32g474_says_what_is_protected() {
    let found = g474::of(WANTED & !(1 << 22), [area(100, 126), area(10, 125)]);
    assert_eq!(differing(&found), [(Banks, "DBANK", 0, 1), (WriteProtection, "WRP2A_END", 126, 125)]);
}
