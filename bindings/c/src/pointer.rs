//! The only place where C's pointers are followed, for the twin's interface as well.
#![allow(
    clippy::not_unsafe_ptr_arg_deref,
    reason = "called by what C calls alone, whose word it is that a pointer leads to what it says"
)]

use crate::numbers::{SHAKEDOWN_MISALIGNED, SHAKEDOWN_NULL};

fn check<T>(pointer: *const T) -> Result<(), i32> {
    if pointer.is_null() {
        Err(SHAKEDOWN_NULL)
    } else if pointer.is_aligned() {
        Ok(())
    } else {
        Err(SHAKEDOWN_MISALIGNED)
    }
}

/// What the caller reads.
pub fn from<'a, T>(pointer: *const T) -> Result<&'a T, i32> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; that it is the caller's `T`, and nobody else's meanwhile, is the caller's word.
    Ok(unsafe { &*pointer })
}

/// What the caller lets be written.
pub fn into<'a, T>(pointer: *mut T) -> Result<&'a mut T, i32> {
    check(pointer)?;
    // SAFETY: as above.
    Ok(unsafe { &mut *pointer })
}

/// A place whose old content is not looked at.
#[derive(Debug)]
pub struct Place<T>(*mut T);

/// Where something is to be written.
pub fn place<T>(pointer: *mut T) -> Result<Place<T>, i32> {
    check(pointer)?;
    Ok(Place(pointer))
}

impl<T> Place<T> {
    /// Writes it.
    pub fn write(self, value: T) {
        // SAFETY: as above; nothing that needs to be dropped is there.
        unsafe { self.0.write(value) }
    }
}

/// Bytes that the caller reads.
pub fn bytes<'a>(pointer: *const u8, length: usize) -> Result<&'a [u8], i32> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer)?;
    // SAFETY: not null; that as many bytes are there is the caller's word.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// Bytes that the caller lets be written.
pub fn bytes_mut<'a>(pointer: *mut u8, length: usize) -> Result<&'a mut [u8], i32> {
    if length == 0 {
        return Ok(&mut []);
    }
    check(pointer.cast_const())?;
    // SAFETY: not null; that as many bytes are there, and nobody else's meanwhile, is the caller's word.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, length) })
}

/// Hands something over, until [`take`] takes it back.
#[cfg(not(target_os = "none"))]
pub fn give<T>(value: T) -> *mut T {
    Box::into_raw(Box::new(value))
}

/// Takes back, and drops, what [`give`] handed over; null is left alone.
#[cfg(not(target_os = "none"))]
pub fn take<T>(pointer: *mut T) {
    if check(pointer.cast_const()).is_ok() {
        // SAFETY: neither null nor misaligned; that `give` gave it, and that it is not used again, is the caller's word.
        drop(unsafe { Box::from_raw(pointer) });
    }
}

/// A text that ends in a zero.
pub fn closed<'a>(pointer: *const core::ffi::c_char) -> Result<&'a core::ffi::CStr, i32> {
    check(pointer)?;
    // SAFETY: not null; that a zero ends it is the caller's word.
    Ok(unsafe { core::ffi::CStr::from_ptr(pointer) })
}
