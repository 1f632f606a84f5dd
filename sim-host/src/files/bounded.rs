//! Files read within bounds, so that one named by mistake (a disk image, `/dev/zero`) is refused and not taken into memory.

use std::io::{Error, ErrorKind, Read as _, Result};
use std::path::Path;

/// Most bytes of a file that a person writes: settings, a scenario, a model, an experiment.
pub(crate) const BY_HAND: u64 = 16 << 20;
/// Most bytes of a file that long work leaves behind: a thousand times what one holds today.
pub(crate) const BY_WORK: u64 = 256 << 20;

/// A file's content; [`ErrorKind::FileTooLarge`] where it holds more than `limit` bytes.
pub(crate) fn bytes(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let mut content = Vec::new();
    let read = std::fs::File::open(path)?.take(limit + 1).read_to_end(&mut content)?;
    if read as u64 > limit {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("holds more than {limit} bytes")));
    }
    Ok(content)
}

/// The same as text; [`ErrorKind::InvalidData`] where it is none.
pub(crate) fn text(path: &Path, limit: u64) -> Result<String> {
    let bytes = bytes(path, limit)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) || bytes.get(1) == Some(&0) {
        return Err(Error::new(ErrorKind::InvalidData, "is UTF-16: save it as UTF-8"));
    }
    String::from_utf8(bytes).map_err(|e| {
        let offset = e.utf8_error().valid_up_to();
        Error::new(ErrorKind::InvalidData, format!("is not text: byte {offset} is no UTF-8; save it as UTF-8"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_bound_and_refused_beyond() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "12345").unwrap();
        assert_eq!(text(&path, 5).unwrap(), "12345");
        let refused = bytes(&path, 4).unwrap_err();
        assert_eq!(
            (refused.kind(), refused.to_string().as_str()),
            (ErrorKind::FileTooLarge, "holds more than 4 bytes")
        );
        std::fs::write(&path, b"ab\xff").unwrap();
        assert_eq!(text(&path, 5).unwrap_err().to_string(), "is not text: byte 2 is no UTF-8; save it as UTF-8");
    }

    /// What has no end is refused all the same.
    #[cfg(unix)]
    #[test]
    fn a_file_without_end_is_refused() {
        assert_eq!(bytes(Path::new("/dev/zero"), 1 << 20).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }
}
