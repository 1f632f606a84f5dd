//! The control core for C: storage by the caller, no allocation, a code from every call.
//!
//! The header, `include/shakedown.h`, is written from here by cbindgen. Every pointer is checked for null and alignment, and
//! storage for the word that `shakedown_init` leaves in it; what no check can find is a pointer to memory that is not the
//! caller's. Enums are numbers that are checked.
#![cfg_attr(target_os = "none", no_std)]
#![allow(unsafe_code, reason = "C's pointers end here: each is checked for null and alignment before it is followed")]

mod convert;
pub mod guard;
pub mod numbers;
#[doc(hidden)]
pub mod pointer;
pub mod sample;
pub mod settings;
mod text;
pub mod tracking;

use core::ffi::c_char;
use core::mem::size_of;

use shakedown_core::host::{self, code};
use shakedown_core::{Controller, SettingsError};

use numbers::{SHAKEDOWN_TOO_SMALL, SHAKEDOWN_UNINITIALISED};
use pointer::{from, into};
use sample::{Command, Fault, Sample};
use settings::Settings;
use text::Field;

/// The version of this interface: the header's, and that of the library by `shakedown_abi`.
pub const SHAKEDOWN_ABI: u32 = 1;
/// Bytes of a controller's storage, some of them to spare.
pub const SHAKEDOWN_SIZE: usize = 4096;
/// Bytes of a field's name in `shakedown_fault_t`, the closing zero included.
pub const SHAKEDOWN_NAME: usize = 64;

/// Storage of a controller. Only `shakedown_init` makes it one.
#[derive(Debug)]
#[repr(C)]
pub struct Shakedown {
    /// Not for the caller.
    pub opaque: [u64; 512],
}

/// What storage holds once it is a controller.
#[repr(C)]
struct Held {
    magic: u32,
    controller: Controller,
}

/// "SHKD".
const MAGIC: u32 = 0x5348_4b44;

const _: () = assert!(size_of::<Held>() <= SHAKEDOWN_SIZE && size_of::<Shakedown>() == SHAKEDOWN_SIZE);
const _: () = assert!(align_of::<Held>() <= align_of::<Shakedown>());

fn done(result: Result<(), i32>) -> i32 {
    result.err().unwrap_or(code::OK)
}

/// The controller in `storage`.
fn held<'a>(storage: *mut Shakedown) -> Result<&'a mut Held, i32> {
    let held: &mut Held = into(storage.cast())?;
    if held.magic == MAGIC { Ok(held) } else { Err(SHAKEDOWN_UNINITIALISED) }
}

/// The version of the library; compare it with `SHAKEDOWN_ABI`.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_abi() -> u32 {
    SHAKEDOWN_ABI
}

/// Sizes by which a caller can tell that header and library fit, byte: 0 storage, 1 settings, 2 sample, 3 command, 4 fault; 0
/// for any other number.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_sizeof(what: u32) -> usize {
    match what {
        0 => SHAKEDOWN_SIZE,
        1 => size_of::<Settings>(),
        2 => size_of::<Sample>(),
        3 => size_of::<Command>(),
        4 => size_of::<Fault>(),
        _ => 0,
    }
}

/// Writes the defaults: the controller of the paper's table, bare, at 1 kHz.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_settings_default(settings: *mut Settings) -> i32 {
    let write = |place: &mut Settings| *place = (&shakedown_core::Settings::default()).into();
    done(into(settings).map(write))
}

/// Sets one field by its dotted name, written as in a settings file: "guard.envelope.velocity", "0.5"; a word stands in double
/// quotes. Both texts are closed by a zero. On an error the settings are as they were.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_settings_set(settings: *mut Settings, name: *const c_char, value: *const c_char) -> i32 {
    let take = || {
        let place = into(settings)?;
        let mut read = shakedown_core::Settings::try_from(&*place)?;
        read.set(text::closed(name)?, text::closed(value)?).map_err(host::name_code)?;
        *place = (&read).into();
        Ok(())
    };
    done(take())
}

/// Reads a text of `length` bytes in a settings file's words: `name = value`, `[table]`, `# comment`; no inline tables. What it
/// does not name stays. On an error the settings are as they were.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_settings_read(settings: *mut Settings, text: *const c_char, length: usize) -> i32 {
    let take = || {
        let place = into(settings)?;
        let mut read = shakedown_core::Settings::try_from(&*place)?;
        read.read(text::of(text, length)?).map_err(host::name_code)?;
        *place = (&read).into();
        Ok(())
    };
    done(take())
}

/// Checks settings as a whole, and says in `fault` (which may be null) what is wrong.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_check(settings: *const Settings, fault: *mut Fault) -> i32 {
    let check = || shakedown_core::Settings::try_from(from(settings)?);
    let (number, found) = match check() {
        Err(number) => (number, None),
        Ok(settings) => match settings.validate() {
            Ok(()) => (code::OK, None),
            Err(error) => (host::settings_code(&error), Some(error)),
        },
    };
    if let Ok(place) = into(fault) {
        *place = explained(number, found);
    }
    number
}

fn explained(code: i32, error: Option<SettingsError>) -> Fault {
    let (field, value, low, high) = match error {
        Some(
            SettingsError::OutOfRange { field, value, low, high }
            | SettingsError::Conflict { field, value, low, high, .. },
        ) => (field, value, low, high),
        Some(SettingsError::Contradiction { field, .. }) => (field, 0.0, 0.0, 0.0),
        _ => ("", 0.0, 0.0, 0.0),
    };
    Fault { code, value, low, high, field: Field::new(field).bytes() }
}

/// Makes `storage` of `size` bytes a controller, if the settings hold. With a guard it is off, and moves nothing before it is
/// armed and started; without one it runs. Refused settings leave no controller.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_init(storage: *mut Shakedown, size: usize, settings: *const Settings) -> i32 {
    let begin = || {
        if size < size_of::<Held>() {
            return Err(SHAKEDOWN_TOO_SMALL);
        }
        let settings = shakedown_core::Settings::try_from(from(settings)?)?;
        let place = pointer::place::<Held>(storage.cast())?;
        place.write(Held { magic: 0, controller: Controller::inert() });
        let held: &mut Held = into(storage.cast())?;
        held.controller.retune(&settings).map_err(|error| host::settings_code(&error))?;
        held.magic = MAGIC;
        Ok(())
    };
    done(begin())
}

/// Exchanges the settings between two ticks, whole or not at all.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_retune(storage: *mut Shakedown, settings: *const Settings) -> i32 {
    let retune = || {
        let settings = shakedown_core::Settings::try_from(from(settings)?)?;
        held(storage)?.controller.retune(&settings).map_err(|error| host::settings_code(&error))
    };
    done(retune())
}

/// Asks for a change of state: one of `SHAKEDOWN_REQUEST_...`.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_request(storage: *mut Shakedown, request: u8) -> i32 {
    held(storage).map_or_else(|code| code, |held| host::request(&mut held.controller, u32::from(request)))
}

/// One tick. On an error `command` is as it was: the caller then opens the relay.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_step(storage: *mut Shakedown, sample: *const Sample, command: *mut Command) -> i32 {
    let step = || {
        let (sample, place) = (from(sample)?, into(command)?);
        let controller = &mut held(storage)?.controller;
        let command = controller.step(&sample.into());
        *place = Command::of(&command, controller.changes());
        Ok(())
    };
    done(step())
}

/// What a code means, in English; static text.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_error(code: i32) -> *const c_char {
    text::meaning(code).as_ptr()
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // The linker finds every panic in the core's step unreachable; what is left is settings, between tests.
    loop {
        core::hint::spin_loop();
    }
}
