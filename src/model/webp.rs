//! The sizes of the pictures in a WebP file, as their own headers state them.
//!
//! ```text
//! RIFF size WEBP ─┬─ VP8X (canvas) ─┬─ VP8  (frame) │ VP8L (frame)
//!                 │                 └─ ANMF (place and size) ── VP8  │ VP8L
//!                 └─ VP8 │ VP8L
//! ```
//!
//! `image-webp` 0.2.4 allocates a lossy frame by its own size before it compares that with the file's.

/// Bytes of a frame of an animation before its chunks.
const FRAME_HEADER: usize = 16;

/// The size of every picture in `bytes`, in pixels; those of chunks that are cut off before their size are left out.
pub(super) fn frame_sizes(bytes: &[u8]) -> impl Iterator<Item = [u32; 2]> + '_ {
    chunks(bytes.get(12..).unwrap_or_default()).flat_map(|chunk| {
        let inner = match &chunk.kind {
            b"ANMF" => chunk.body.get(FRAME_HEADER..).unwrap_or_default(),
            _ => &[],
        };
        std::iter::once(chunk).chain(chunks(inner)).filter_map(|chunk| chunk.frame_size())
    })
}

#[derive(Clone, Copy)]
struct WebpChunk<'a> {
    kind: [u8; 4],
    /// As much as the file has of it.
    body: &'a [u8],
}

impl WebpChunk<'_> {
    /// The size of the picture that it holds; `None` of other chunks.
    fn frame_size(&self) -> Option<[u32; 2]> {
        match &self.kind {
            b"VP8 " => {
                let sides = self.body.get(6..10)?;
                let side = |at: usize| u32::from(u16::from_le_bytes([sides[at], sides[at + 1]]) & 0x3FFF);
                Some([side(0), side(2)])
            }
            b"VP8L" => {
                let sides = u32::from_le_bytes(*self.body.get(1..)?.first_chunk()?);
                Some([sides & 0x3FFF, sides >> 14 & 0x3FFF].map(|side| side + 1))
            }
            _ => None,
        }
    }
}

/// The chunks one after another, up to the end of `bytes`.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = WebpChunk<'_>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (header, body) = rest.split_first_chunk::<8>()?;
        let [a, b, c, d, size @ ..] = *header;
        let size = u32::from_le_bytes(size) as usize;
        // Chunks begin at even places.
        rest = body.get(size.saturating_add(size % 2)..).unwrap_or_default();
        Some(WebpChunk { kind: [a, b, c, d], body: &body[..size.min(body.len())] })
    })
}

#[cfg(test)]
pub(super) mod tests {
    use std::io::Cursor;

    use super::*;

    /// A lossless file of one color.
    pub(crate) fn lossless(width: u32, height: u32, color: [u8; 3]) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image::RgbImage::from_pixel(width, height, image::Rgb(color))
            .write_to(&mut bytes, image::ImageFormat::WebP)
            .expect("memory takes all");
        bytes.into_inner()
    }

    fn chunk(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
        let mut chunk = [&kind[..], &(body.len() as u32).to_le_bytes(), body].concat();
        chunk.resize(chunk.len().next_multiple_of(2), 0);
        chunk
    }

    /// The chunk of a lossy frame that ends after its size.
    pub(crate) fn lossy_header(width: u16, height: u16) -> Vec<u8> {
        let [width, height] = [width, height].map(u16::to_le_bytes);
        chunk(b"VP8 ", &[&[0x10, 0, 0, 0x9d, 0x01, 0x2a][..], &width, &height].concat())
    }

    /// A file with a canvas of this size and these chunks.
    pub(crate) fn extended(canvas: [u32; 2], chunks: &[u8]) -> Vec<u8> {
        let [width, height] = canvas.map(|side| (side - 1).to_le_bytes());
        let header = chunk(b"VP8X", &[&[0; 4][..], &width[..3], &height[..3]].concat());
        let size = (4 + header.len() + chunks.len()) as u32;
        [b"RIFF", &size.to_le_bytes()[..], b"WEBP", &header, chunks].concat()
    }

    #[test]
    fn the_sizes_of_frames_are_found_wherever_they_are() {
        let sizes = |bytes: &[u8]| frame_sizes(bytes).collect::<Vec<_>>();
        assert_eq!(sizes(&lossless(7, 300, [1, 2, 3])), [[7, 300]]);
        assert_eq!(sizes(&extended([9, 9], &lossy_header(640, 480))), [[640, 480]]);
        let moved = chunk(b"ANMF", &[&[0; 16][..], &lossy_header(40, 30)].concat());
        let two = extended([9, 9], &[chunk(b"ICCP", &[1, 2, 3]), moved, lossy_header(5, 6)].concat());
        assert_eq!(sizes(&two), [[40, 30], [5, 6]]);
    }

    #[test]
    fn cut_and_forged_files_end() {
        let file = extended([9, 9], &lossy_header(640, 480));
        for end in 0..file.len() {
            assert!(frame_sizes(&file[..end]).count() <= 1);
        }
        let forged = extended([9, 9], &[&b"VP8L"[..], &[0xFF; 40]].concat());
        assert!(frame_sizes(&forged).count() <= 1);
    }
}
