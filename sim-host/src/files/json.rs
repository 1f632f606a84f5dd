//! JSON files that long work leaves behind and finds again.

use super::{bounded, write_whole};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Why a file was not written or not taken.
#[derive(Debug, thiserror::Error)]
pub enum JsonError {
    /// A file could not be read or written.
    #[error("{path}: {cause}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        cause: std::io::Error,
    },
    /// A file is not what it should be.
    #[error("{path}: {problem}; remove it to have what it holds done anew")]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}

impl JsonError {
    /// What the file system said of `path`.
    pub fn file(path: &Path) -> impl Fn(std::io::Error) -> Self + '_ {
        move |cause| Self::File { path: path.to_path_buf(), cause }
    }

    /// What is wrong with the content of `path`.
    pub fn content(path: &Path) -> impl Fn(serde_json::Error) -> Self + '_ {
        move |e| Self::Content { path: path.to_path_buf(), problem: e.to_string() }
    }
}

/// Writes a value as it was laid out, whole or not at all.
pub(crate) fn write(path: &Path, text: serde_json::Result<String>) -> Result<(), JsonError> {
    let text = text.map_err(JsonError::content(path))?;
    write_whole(path, (text + "\n").as_bytes()).map_err(JsonError::file(path))
}

/// Reads a value.
pub(crate) fn read<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, JsonError> {
    let text = bounded::bytes(path, bounded::BY_WORK).map_err(JsonError::file(path))?;
    serde_json::from_slice(&text).map_err(JsonError::content(path))
}
