//! The chip's option bytes beside those that its board asks for, and what to do where they differ.

use super::failed;
use crate::cli::Failure;
use crate::cli::output::print;
use crate::device::{Port, Session};
use shakedown_core::link::{HostRequest, OptionByte, OptionPurpose, Report};
use std::fmt::Write as _;

/// Reads them, says what differs, and notes all of them.
pub(super) fn compare(session: &mut Session<Port>, text: &mut String) -> Result<(), Failure> {
    let asked = |report: &Report| if let Report::Options(options) = report { Some(options.clone()) } else { None };
    let options = session.ask(&HostRequest::ReadOptions, asked).map_err(failed)?;
    print(&said(&options));
    text.push_str(&noted(&options));
    Ok(())
}

/// Why a board asks for it, and what follows where it has another value.
const fn why(purpose: OptionPurpose) -> &'static str {
    match purpose {
        OptionPurpose::BrownOut => {
            "at a supply too low for its clock the chip computes wrongly instead of standing in reset, where the relay is open"
        }
        OptionPurpose::Watchdog => "a program that hangs before it starts the watchdog is never reset",
        OptionPurpose::ReadProtection => {
            "a probe can neither check nor test the program; the programmer erases the flash when it takes this back: flash the image \
             and save the setup anew"
        }
        OptionPurpose::WriteProtection | OptionPurpose::Banks => "the setup cannot be saved",
    }
}

/// In words: each that differs with its reason, then the one command that sets all of them.
fn said(options: &[OptionByte]) -> String {
    if options.is_empty() {
        return "Option bytes: the device has none.\n".into();
    }
    let differ: Vec<&OptionByte> = options.iter().filter(|byte| byte.found != byte.wanted).collect();
    if differ.is_empty() {
        return "Option bytes: as the board asks for.\n".into();
    }
    let mut said = String::from("Option bytes that differ from what the board asks for:\n");
    for byte in &differ {
        let OptionByte { purpose, name, found, wanted } = byte;
        let _ = writeln!(said, "  {name} is {found:#x}, not {wanted:#x}: {}", why(*purpose));
    }
    let settings: Vec<String> = differ.iter().map(|byte| format!("{}={:#x}", byte.name, byte.wanted)).collect();
    let _ = writeln!(
        said,
        "To set them, with a probe on the board: STM32_Programmer_CLI -c port=SWD -ob {}\nthen pull the supply, and begin again.",
        settings.join(" ")
    );
    said
}

/// As TOML.
fn noted(options: &[OptionByte]) -> String {
    options.iter().fold(String::new(), |mut text, byte| {
        let OptionByte { purpose, name, found, wanted } = byte;
        let _ = writeln!(
            text,
            "\n[[option-byte]]\npurpose = \"{purpose:?}\"\nname = \"{name}\"\nfound = {found:#x}\nwanted = {wanted:#x}\nas_wanted = {}",
            found == wanted
        );
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn byte(purpose: OptionPurpose, name: &str, found: u32) -> OptionByte {
        OptionByte { purpose, name: name.try_into().unwrap(), found, wanted: 0 }
    }

    #[test]
    fn what_differs_is_said_with_one_command_that_sets_it() {
        let options = [
            byte(OptionPurpose::BrownOut, "BOR_LEV", 3),
            byte(OptionPurpose::Watchdog, "WDG_SW", 1),
            byte(OptionPurpose::Banks, "DBANK", 0),
        ];
        let text = said(&options);
        assert!(text.contains("BOR_LEV is 0x3, not 0x0: at a supply too low"), "{text}");
        assert!(text.contains("-ob BOR_LEV=0x0 WDG_SW=0x0\n") && !text.contains("DBANK"), "{text}");
        let notes: toml::Table = noted(&options).parse().unwrap();
        let noted = notes["option-byte"].as_array().unwrap();
        assert_eq!(
            (noted.len(), noted[0]["found"].as_integer(), noted[2]["as_wanted"].as_bool()),
            (3, Some(3), Some(true))
        );
    }

    #[test]
    fn a_chip_as_asked_for_is_said_too() {
        assert!(said(&[byte(OptionPurpose::Banks, "DBANK", 0)]).contains("as the board asks"));
        assert!(said(&[]).contains("none"));
    }
}
