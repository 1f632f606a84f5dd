//! The simulated table for C, and through it for an FMU: a command in, a tick's motion out, as `shakedown run` moves it.
//!
//! Unlike the core's interface it allocates: a table is opened, stepped and closed. The header, `include/shakedown_twin.h`, is
//! written from here by cbindgen.
#![allow(unsafe_code, reason = "names that C finds; C's pointers are followed in `shakedown_c::pointer` alone")]

mod table;
#[cfg(test)]
mod tests;

use std::ffi::c_char;

use shakedown_c::numbers::SHAKEDOWN_NO_TEXT;
use shakedown_c::pointer::{self, bytes_mut, from, into, place};
use shakedown_core::host::code;

pub use table::{Motion, Options, Table};

fn done(result: Result<(), i32>) -> i32 {
    result.err().unwrap_or(code::OK)
}

/// Writes the defaults: 1 kHz, at rest at the centre, no pressure sensor.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_twin_default(options: *mut Options) -> i32 {
    done(place(options).map(|place| place.write(Options::default())))
}

/// Opens a table: `text` of `length` bytes in the words of a `table.toml`. What is refused leaves `table` as it was and says
/// why in `message`, at most `room` bytes with a closing zero.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_twin_open(
    text: *const c_char,
    length: usize,
    options: *const Options,
    table: *mut *mut Table,
    message: *mut c_char,
    room: usize,
) -> i32 {
    let open = || {
        let (options, place) = (from(options)?, into(table)?);
        let said = bytes_mut(message.cast(), room)?;
        let text = std::str::from_utf8(pointer::bytes(text.cast(), length)?).map_err(|_| SHAKEDOWN_NO_TEXT)?;
        match Table::new("table.toml", text, options) {
            Ok(opened) => *place = pointer::give(opened),
            Err(why) => {
                write(&why, said);
                return Err(code::WRONG_VALUE);
            }
        }
        Ok(())
    };
    done(open())
}

/// One tick with `command` (m) at the valve; a command that is no number is refused and moves nothing.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_twin_step(table: *mut Table, command: f64, motion: *mut Motion) -> i32 {
    let step = || {
        let (table, place) = (into(table)?, place(motion)?);
        if !command.is_finite() {
            return Err(code::OUT_OF_RANGE);
        }
        place.write(table.step(command));
        Ok(())
    };
    done(step())
}

/// What the sensors said last, at first of the table at rest.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_twin_motion(table: *const Table, motion: *mut Motion) -> i32 {
    done(from(table).and_then(|table| place(motion).map(|place| place.write(table.motion()))))
}

/// Closes a table that was opened; null is left alone.
#[unsafe(no_mangle)]
pub extern "C" fn shakedown_twin_close(table: *mut Table) {
    pointer::take(table);
}

/// As much of a text as there is room for, closed by a zero.
fn write(text: &str, room: &mut [u8]) {
    let Some(most) = room.len().checked_sub(1) else { return };
    let length = text.floor_char_boundary(most);
    room[..length].copy_from_slice(&text.as_bytes()[..length]);
    room[length] = 0;
}
