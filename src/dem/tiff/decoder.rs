//! The limits of the `tiff` crate's decoder, which reads directories, and the kinds of images that these state.

use std::io::{Read, Seek};

use tiff::decoder::{Decoder, Limits};
use tiff::tags::Tag;

use sandtable_base::limits::TIFF_TAG_BYTES;

/// NewSubfileType's bit for "reduced version of another image".
pub(crate) const IS_REDUCED: u32 = 1;

/// NewSubfileType's bit for "mask of another image".
pub(crate) const IS_MASK: u32 = 4;

/// The most that the decoder may allocate for a file of `file_bytes` bytes. It reads tags; blocks are unpacked elsewhere.
pub(crate) fn limits(file_bytes: usize) -> Limits {
    let mut limits = Limits::default();
    let most_bytes = TIFF_TAG_BYTES.count().max(1024);
    limits.ifd_value_size = file_bytes.clamp(1024, most_bytes);
    // The decoder keeps a value of a tag in 32 bytes, and allocates what a tag claims before it looks whether the file holds it.
    limits.decoding_buffer_size = 32 * file_bytes.clamp(1024, (most_bytes / 8).max(1024));
    limits
}

/// The bits of NewSubfileType of the decoder's current image; 0 where it has none.
pub(crate) fn image_kind<R: Read + Seek>(decoder: &mut Decoder<R>) -> u32 {
    decoder.find_tag_unsigned(Tag::NewSubfileType).ok().flatten().unwrap_or(0)
}
