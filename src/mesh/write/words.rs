//! Counts and values as the words of a binary file.

use std::borrow::Cow;
use std::io;

/// Why a mesh does not fit a format; the inner error of an [`io::ErrorKind::InvalidInput`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum MeshWriteError {
    #[error("{count} {what} exceed the {} that the format can hold; raise the maximum error", u32::MAX)]
    TooLarge { count: usize, what: &'static str },
    #[error("a glTF mesh needs at least one triangle")]
    Empty,
}

impl From<MeshWriteError> for io::Error {
    fn from(error: MeshWriteError) -> Self {
        Self::new(io::ErrorKind::InvalidInput, error)
    }
}

/// `count` as the 32 bits that a format has for it.
pub(in crate::write) fn count_u32(count: usize, what: &'static str) -> Result<u32, MeshWriteError> {
    u32::try_from(count).map_err(|_| MeshWriteError::TooLarge { count, what })
}

/// `values` as little-endian bytes; copied only on big-endian processors. All words of `T` must have its alignment.
pub(in crate::write) fn little_endian<T: bytemuck::Pod>(values: &[T]) -> Cow<'_, [u8]> {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    if cfg!(target_endian = "little") {
        return bytes.into();
    }
    bytes.chunks_exact(align_of::<T>()).flat_map(|word| word.iter().rev()).copied().collect()
}
