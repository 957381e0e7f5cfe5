//! Streams of a PDF: packed bytes, and checks of them.

use std::io::Write;

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};

/// `bytes` as `FlateDecode` unpacks them; `None` where they are too long for a stream.
pub fn deflated(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    let packed = packed.write_all(bytes).and_then(|()| packed.finish()).ok()?;
    // The length of a stream is a number of 32 bits.
    i32::try_from(packed.len()).is_ok().then_some(packed)
}

/// A CRC-32 of `bytes`, which distinguishes files and fonts of one kind.
pub fn check(bytes: &[u8]) -> [u8; 4] {
    let mut check = Crc::new();
    check.update(bytes);
    check.sum().to_be_bytes()
}
