//! The fingerprint of a scene: whether two pictures were made of the same files; and of other content.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::pipeline::files::{self, ReadFileError};

/// The SHA-256 of the scene file at `path` and of the `files` that the scene was made of, in hexadecimal digits. It depends
/// on their contents and order, not on their names.
///
/// # Errors
/// A file cannot be read.
pub fn fingerprint(path: &Path, files: &[PathBuf]) -> Result<String, ReadFileError> {
    let mut whole = Sha256::new();
    for file in std::iter::once(path).chain(files.iter().map(PathBuf::as_path)) {
        // The hash of each, so that bytes cannot move from one to the next unseen.
        whole.update(Sha256::digest(files::read(file)?));
    }
    Ok(hexadecimal(&whole.finalize()))
}

/// The SHA-256 of `bytes`, in hexadecimal digits.
pub fn content_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
