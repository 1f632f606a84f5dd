//! Texts in and out.

use core::ffi::{CStr, c_char};

use crate::numbers::SHAKEDOWN_NO_TEXT;
use crate::{SHAKEDOWN_NAME, pointer};

/// A text that ends in a zero.
pub(crate) fn closed<'a>(text: *const c_char) -> Result<&'a str, i32> {
    pointer::closed(text)?.to_str().map_err(|_| SHAKEDOWN_NO_TEXT)
}

/// A text of this length.
pub(crate) fn of<'a>(text: *const c_char, length: usize) -> Result<&'a str, i32> {
    core::str::from_utf8(pointer::bytes(text.cast(), length)?).map_err(|_| SHAKEDOWN_NO_TEXT)
}

/// A name of a field for C.
pub(crate) struct Field([u8; SHAKEDOWN_NAME]);

impl Field {
    /// The name, cut to what there is room for.
    pub(crate) fn new(name: &str) -> Self {
        let mut bytes = [0; SHAKEDOWN_NAME];
        for (place, byte) in bytes.iter_mut().take(SHAKEDOWN_NAME - 1).zip(name.bytes()) {
            *place = byte;
        }
        Self(bytes)
    }

    pub(crate) fn bytes(self) -> [u8; SHAKEDOWN_NAME] {
        self.0
    }
}

/// In the order of the codes.
const MEANINGS: [&CStr; 16] = [
    c"done",
    c"a setting is not a number, or outside its range",
    c"two settings contradict each other",
    c"a setting is within its own range, but not with the others",
    c"the request does not apply in this state",
    c"the safe ramp after the trip has not ended",
    c"the guard sees a reason to trip already",
    c"there is no guard, and so nothing to ask",
    c"there is no setting of this name",
    c"the value is not of the setting's kind",
    c"there is no request of this number",
    c"a pointer is null",
    c"a pointer is not aligned for its type",
    c"the storage is too small",
    c"the storage holds no controller: shakedown_init was not called, or refused",
    c"a text is not UTF-8",
];

/// What a code means.
pub(crate) fn meaning(code: i32) -> &'static CStr {
    let place = usize::try_from(code).ok();
    place.and_then(|place| MEANINGS.get(place)).copied().unwrap_or(c"there is no such code")
}
