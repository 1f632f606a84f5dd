//! The only place where C's pointers are followed.

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
pub(crate) fn from<'a, T>(pointer: *const T) -> Result<&'a T, i32> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; that it is the caller's `T`, and nobody else's meanwhile, is the caller's word.
    Ok(unsafe { &*pointer })
}

/// What the caller lets be written.
pub(crate) fn into<'a, T>(pointer: *mut T) -> Result<&'a mut T, i32> {
    check(pointer)?;
    // SAFETY: as above.
    Ok(unsafe { &mut *pointer })
}

/// A place whose old content is not looked at.
pub(crate) struct Place<T>(*mut T);

pub(crate) fn place<T>(pointer: *mut T) -> Result<Place<T>, i32> {
    check(pointer)?;
    Ok(Place(pointer))
}

impl<T> Place<T> {
    pub(crate) fn write(self, value: T) {
        // SAFETY: as above; nothing that needs to be dropped is there.
        unsafe { self.0.write(value) }
    }
}

/// Bytes that the caller reads.
pub(crate) fn bytes<'a>(pointer: *const u8, length: usize) -> Result<&'a [u8], i32> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer)?;
    // SAFETY: not null; that as many bytes are there is the caller's word.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// A text that ends in a zero.
pub(crate) fn closed<'a>(pointer: *const core::ffi::c_char) -> Result<&'a core::ffi::CStr, i32> {
    check(pointer)?;
    // SAFETY: not null; that a zero ends it is the caller's word.
    Ok(unsafe { core::ffi::CStr::from_ptr(pointer) })
}
