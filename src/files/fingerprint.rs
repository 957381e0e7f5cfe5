//! The fingerprint of a scene: whether two pictures were made of the same files; and of other content.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::addressed;
use crate::disk::{self, ReadFileError};
use sandtable_remote::address::is_address_path;

/// The SHA-256 of the scene file at `path` and of the `files` that the scene was made of, in hexadecimal digits. It depends
/// on their contents and order, not on their names; of a file with an address, on its address and on what its server says of its
/// version.
///
/// # Errors
/// A file cannot be read.
pub fn fingerprint(path: &Path, files: &[PathBuf]) -> Result<String, ReadFileError> {
    let mut whole = Sha256::new();
    for file in std::iter::once(path).chain(files.iter().map(PathBuf::as_path)) {
        // The hash of each, so that bytes cannot move from one to the next unseen.
        whole.update(match is_address_path(file) {
            true => Sha256::digest(addressed::version(file)?),
            false => Sha256::digest(disk::read(file)?),
        });
    }
    Ok(hexadecimal(&whole.finalize()))
}

/// The SHA-256 of `bytes`, in hexadecimal digits.
pub fn content_hash(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Bytes in hexadecimal digits.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_bytes_have_their_known_hash() {
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(content_hash(b"abc"), expected);
    }
}
