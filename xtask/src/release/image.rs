//! An ELF image as what flashing tools take: the bytes of the flash from its first address (`.bin`), and the same as Intel HEX.

use ihex::Record;
use object::LittleEndian;
use object::read::elf::{ElfFile32, ProgramHeader as _};

/// Bytes of a line of Intel HEX.
const LINE: usize = 16;
/// What an erased flash reads.
const ERASED: u8 = 0xFF;
/// Largest gap that is filled between two parts of an image, byte: a program's sectors lie side by side.
const GAP: usize = 64 * 1024;

/// The bytes of the flash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Flash {
    /// Address of the first.
    pub(super) origin: u32,
    /// From there on, gaps as erased.
    pub(super) bytes: Vec<u8>,
}

impl Flash {
    /// What the ELF file `elf` loads, by the addresses it is stored at, which for initial values of variables are not those they
    /// have at run time.
    pub(super) fn of(elf: &[u8]) -> Result<Self, String> {
        let file = ElfFile32::<LittleEndian>::parse(elf).map_err(|e| e.to_string())?;
        let mut parts = Vec::new();
        for header in file.elf_program_headers() {
            if header.p_type(LittleEndian) == object::elf::PT_LOAD && header.p_filesz(LittleEndian) > 0 {
                let bytes =
                    header.data(LittleEndian, elf).map_err(|()| "a segment lies outside the file".to_owned())?;
                parts.push((header.p_paddr(LittleEndian), bytes));
            }
        }
        Self::joined(parts)
    }

    fn joined(mut parts: Vec<(u32, &[u8])>) -> Result<Self, String> {
        parts.sort_unstable_by_key(|&(at, _)| at);
        let origin = parts.first().ok_or("it loads nothing")?.0;
        let mut bytes = Vec::new();
        for (at, part) in parts {
            let from = (at - origin) as usize;
            let gap = from.checked_sub(bytes.len()).ok_or_else(|| format!("two parts overlap at {at:#x}"))?;
            if gap > GAP {
                return Err(format!("a gap of {gap} bytes before {at:#x}"));
            }
            bytes.resize(from, ERASED);
            bytes.extend_from_slice(part);
        }
        Ok(Self { origin, bytes })
    }

    /// As Intel HEX: lines of 16 bytes under an extended linear address for every 64 KiB.
    pub(super) fn hex(&self) -> Result<String, String> {
        let mut records = Vec::new();
        let mut upper = None;
        for (number, line) in self.bytes.chunks(LINE).enumerate() {
            let at = self.origin + (number * LINE) as u32;
            if upper != Some(at >> 16) {
                upper = Some(at >> 16);
                records.push(Record::ExtendedLinearAddress((at >> 16) as u16));
            }
            records.push(Record::Data { offset: at as u16, value: line.to_vec() });
        }
        records.push(Record::EndOfFile);
        ihex::create_object_file_representation(&records).map_err(|e| e.to_string()).map(|text| text + "\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Reads HEX as a programmer does: a byte by its address.
    fn programmed(hex: &str) -> BTreeMap<u32, u8> {
        let (mut upper, mut bytes) = (0, BTreeMap::new());
        for record in ihex::Reader::new(hex).map(Result::unwrap) {
            match record {
                Record::ExtendedLinearAddress(high) => upper = u32::from(high) << 16,
                Record::Data { offset, value } => {
                    bytes.extend((upper + u32::from(offset)..).zip(value));
                }
                _ => {}
            }
        }
        bytes
    }

    #[test]
    fn parts_are_joined_with_erased_bytes_between() {
        let flash = Flash::joined(vec![(0x0800_0010, &[3, 4][..]), (0x0800_0000, &[1; 14][..])]).unwrap();
        assert_eq!((flash.origin, flash.bytes.len()), (0x0800_0000, 18));
        assert_eq!(flash.bytes[12..], [1, 1, 0xFF, 0xFF, 3, 4]);
        assert!(Flash::joined(vec![(0, &[1; 4][..]), (2, &[1; 4][..])]).is_err(), "an overlap");
        assert!(Flash::joined(vec![(0, &[1; 4][..]), (0x2000_0000, &[1; 4][..])]).is_err(), "RAM is no flash");
    }

    #[test]
    fn hex_programs_the_same_bytes_across_a_boundary() {
        let bytes: Vec<u8> = (0..200_u32).map(|k| (k * 7) as u8).collect();
        let flash = Flash { origin: 0x0800_FFC0, bytes };
        let programmed = programmed(&flash.hex().unwrap());
        assert_eq!(programmed.len(), 200);
        assert!((0..200).all(|k| programmed[&(flash.origin + k)] == flash.bytes[k as usize]));
    }
}
