//! Data elements: a tag with type and size, then the data, padded to eight bytes.

use super::Flaw;

/// `miMATRIX`
pub(super) const MATRIX: u32 = 14;
/// `miCOMPRESSED`
pub(super) const COMPRESSED: u32 = 15;

/// Order of bytes in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// Least significant first.
    Little,
    /// Most significant first.
    Big,
}

impl Order {
    /// Four bytes as a number; fewer are taken as the low ones.
    pub(super) fn u32(self, bytes: &[u8]) -> u32 {
        self.unsigned(bytes) as u32
    }

    /// Up to eight bytes as a number.
    pub(super) fn unsigned(self, bytes: &[u8]) -> u64 {
        let join = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        match self {
            Self::Little => bytes.iter().rev().fold(0, join),
            Self::Big => bytes.iter().fold(0, join),
        }
    }
}

/// One element: its type and its bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) kind: u32,
    pub(super) bytes: &'a [u8],
}

/// Takes the next element off `rest`.
pub(super) fn take<'a>(rest: &mut &'a [u8], order: Order) -> Result<Element<'a>, Flaw> {
    let cut = || "holds a variable that ends too early".to_owned();
    let word = order.u32(rest.get(..4).ok_or_else(cut)?);
    let (kind, size, start) = if word >> 16 != 0 {
        // Small form: type and size share four bytes, the data the next four.
        (word & 0xffff, (word >> 16) as usize, 4)
    } else {
        (word, order.u32(rest.get(4..8).ok_or_else(cut)?) as usize, 8)
    };
    if start == 4 && size > 4 {
        return Err("holds a small element of more than four bytes".to_owned());
    }
    let end = start + size;
    let bytes = rest.get(start..end).ok_or_else(cut)?;
    *rest = rest.get(end.next_multiple_of(8)..).unwrap_or_default();
    Ok(Element { kind, bytes })
}

impl Element<'_> {
    /// The element's data as numbers, whatever type they are stored in.
    pub(super) fn numbers(&self, order: Order) -> Result<Vec<f64>, Flaw> {
        let all = |width: usize, number: &dyn Fn(u64) -> f64| {
            self.bytes.chunks_exact(width).map(|b| number(order.unsigned(b))).collect()
        };
        Ok(match self.kind {
            1 => all(1, &|b| f64::from((b as u8).cast_signed())),
            2 | 16 => all(1, &|b| b as f64),
            3 => all(2, &|b| f64::from((b as u16).cast_signed())),
            4 | 17 => all(2, &|b| b as f64),
            5 => all(4, &|b| f64::from((b as u32).cast_signed())),
            6 => all(4, &|b| b as f64),
            7 => all(4, &|b| f64::from(f32::from_bits(b as u32))),
            9 => all(8, &f64::from_bits),
            12 => all(8, &|b| b.cast_signed() as f64),
            13 => all(8, &|b| b as f64),
            kind => return Err(format!("holds numbers of the unknown type {kind}")),
        })
    }

    /// The element's data as text.
    pub(super) fn text(&self, order: Order) -> Result<String, Flaw> {
        match self.kind {
            1 | 2 | 16 => Ok(String::from_utf8_lossy(self.bytes).into_owned()),
            _ => {
                let codes = self.numbers(order)?;
                Ok(codes.iter().map(|&c| char::from_u32(c as u32).unwrap_or('\u{fffd}')).collect())
            }
        }
    }
}
