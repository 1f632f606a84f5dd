//! The encoding of a text: UTF-16 and UTF-8 by their marks, else UTF-8, else Windows-1252.

use std::borrow::Cow;

/// How a text's bytes stand for its characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// UTF-8, ASCII included.
    Utf8,
    /// UTF-16, the lower byte first.
    Utf16Le,
    /// UTF-16, the higher byte first.
    Utf16Be,
    /// Windows-1252, which holds Latin-1.
    Windows1252,
}

impl Encoding {
    /// The encoding of these first bytes; an error where they are no text.
    pub(crate) fn of(bytes: &[u8]) -> Result<Self, String> {
        match bytes {
            [0xff, 0xfe, ..] => return Ok(Self::Utf16Le),
            [0xfe, 0xff, ..] => return Ok(Self::Utf16Be),
            _ => {}
        }
        let head = &bytes[..bytes.len().min(256)];
        if let Some(at) = head.iter().position(|b| *b == 0) {
            let zeros = head.split(|b| *b == 0).count() - 1;
            if zeros * 5 >= head.len() * 2 {
                return Err("is UTF-16 without the mark that says so: save it as UTF-8".to_owned());
            }
            return Err(format!(
                "byte 0x00 at offset {at} is not text: expected a text file; unpack it, or export it as text"
            ));
        }
        Ok(if std::str::from_utf8(bytes).is_ok() { Self::Utf8 } else { Self::Windows1252 })
    }

    /// What is said of it where it is not UTF-8.
    pub(crate) fn note(self) -> Option<&'static str> {
        match self {
            Self::Utf8 => None,
            Self::Utf16Le | Self::Utf16Be => Some("UTF-16 text"),
            Self::Windows1252 => Some("no UTF-8: read as Windows-1252"),
        }
    }
}

/// Characters of the bytes 0x80 to 0x9f in Windows-1252.
const UPPER: [char; 32] = [
    '\u{20ac}', '\u{81}', '\u{201a}', '\u{192}', '\u{201e}', '\u{2026}', '\u{2020}', '\u{2021}', '\u{2c6}', '\u{2030}',
    '\u{160}', '\u{2039}', '\u{152}', '\u{8d}', '\u{17d}', '\u{8f}', '\u{90}', '\u{2018}', '\u{2019}', '\u{201c}',
    '\u{201d}', '\u{2022}', '\u{2013}', '\u{2014}', '\u{2dc}', '\u{2122}', '\u{161}', '\u{203a}', '\u{153}', '\u{9d}',
    '\u{17e}', '\u{178}',
];

/// The text of some bytes.
pub(crate) fn decode(bytes: &[u8], encoding: Encoding) -> Cow<'_, str> {
    let pairs = |of: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).map(|pair| of([pair[0], pair[1]]));
        let text: String = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        Cow::Owned(text.trim_start_matches('\u{feff}').to_owned())
    };
    match encoding {
        Encoding::Utf16Le => pairs(u16::from_le_bytes),
        Encoding::Utf16Be => pairs(u16::from_be_bytes),
        Encoding::Utf8 => String::from_utf8_lossy(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
        Encoding::Windows1252 => Cow::Owned(
            bytes
                .iter()
                .map(|&b| if (0x80..0xa0).contains(&b) { UPPER[usize::from(b) - 0x80] } else { char::from(b) })
                .collect(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_encoding_gives_the_same_text() {
        let text = "Länge [µm];1,5\n";
        let utf16 = |of: fn(u16) -> [u8; 2], mark: [u8; 2]| {
            mark.into_iter().chain(text.encode_utf16().flat_map(of)).collect::<Vec<u8>>()
        };
        let windows: Vec<u8> = text.chars().map(|c| c as u32 as u8).collect();
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            utf16(u16::to_le_bytes, [0xff, 0xfe]),
            utf16(u16::to_be_bytes, [0xfe, 0xff]),
            windows,
        ] {
            assert_eq!(decode(&bytes, Encoding::of(&bytes).unwrap()), text);
        }
        assert_eq!(decode(b"\x80", Encoding::Windows1252), "\u{20ac}");
    }

    #[test]
    fn what_is_no_text_is_refused() {
        let unmarked: Vec<u8> = "time;x\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert!(Encoding::of(&unmarked).unwrap_err().contains("save it as UTF-8"));
        assert!(Encoding::of(b"\x7fELF\x02\x01\x01\0\0\x01\x01\x01\x01\x01\x01\x01").unwrap_err().contains("offset 7"));
    }
}
