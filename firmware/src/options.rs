//! Option bytes: settings that a chip takes from its flash at power-on, before any program runs. A board lists those that it relies on,
//! by the names that its vendor's programmer gives them; the host says what to do where one differs.

use shakedown_core::link::{MAX_OPTIONS, OptionByte, OptionPurpose};

/// What a board reads.
pub type Options = heapless::Vec<OptionByte, MAX_OPTIONS>;

/// A field of a register of option bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Field {
    /// What it decides.
    pub purpose: OptionPurpose,
    /// Its name in the vendor's programmer, 16 bytes at most.
    pub name: &'static str,
    /// Its lowest bit, and how many there are.
    pub bits: (u32, u32),
    /// The value that the board asks for.
    pub wanted: u32,
}

impl Field {
    /// What `register` says of it.
    pub fn read(&self, register: u32) -> OptionByte {
        let (lowest, count) = self.bits;
        let mask = u32::MAX.checked_shr(u32::BITS.saturating_sub(count)).unwrap_or(0);
        let found = register.checked_shr(lowest).unwrap_or(0) & mask;
        option(self.purpose, self.name, found, self.wanted)
    }
}

/// An option byte; of a name that is too long nothing.
pub fn option(purpose: OptionPurpose, name: &str, found: u32, wanted: u32) -> OptionByte {
    OptionByte { purpose, name: name.try_into().unwrap_or_default(), found, wanted }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_its_bits_alone() {
        let field = |bits| Field { purpose: OptionPurpose::Banks, name: "X", bits, wanted: 1 };
        assert_eq!(field((2, 2)).read(0xFFFF_FFFB).found, 0b10);
        assert_eq!(field((31, 1)).read(0x8000_0000).found, 1);
        assert_eq!(field((0, 32)).read(0x8000_0001).found, 0x8000_0001);
        assert_eq!(field((0, 8)).read(0x1AA), option(OptionPurpose::Banks, "X", 0xAA, 1));
    }
}
