//! A font file whose letters can be drawn.

use std::sync::Arc;

use skrifa::{FontRef, MetadataProvider};

/// Larger files are not read. The largest families in one file, of Chinese, Japanese and Korean, have 20 MB.
pub const LARGEST_FONT_BYTES: u64 = 64 << 20;

/// The bytes of a TrueType or OpenType font, or of a collection of them, that has characters and outlines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FontFile {
    bytes: Arc<Vec<u8>>,
}

/// Why bytes are no font with which text can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FontFileError {
    /// WOFF or WOFF2, which are compressed for the web.
    #[error("it is a web font (WOFF); convert it to TTF or OTF, as `fonttools ttLib` does")]
    Web,
    /// Neither TrueType nor OpenType, or cut off.
    #[error("it is no TrueType or OpenType font, or it is damaged")]
    NoFont,
    /// Only bitmaps or drawings in color.
    #[error("it has no outlines (`glyf` or `CFF`); name a font whose letters are outlines")]
    NoOutlines,
    /// No character has a glyph.
    #[error("it has no characters (`cmap`)")]
    NoCharacters,
}

impl FontFile {
    /// The font in `bytes`; of a collection, its first.
    ///
    /// # Errors
    /// See [`FontFileError`].
    pub fn new(bytes: Vec<u8>) -> Result<Self, FontFileError> {
        if bytes.starts_with(b"wOFF") || bytes.starts_with(b"wOF2") {
            return Err(FontFileError::Web);
        }
        let font = FontRef::from_index(&bytes, 0).map_err(|_| FontFileError::NoFont)?;
        if font.outline_glyphs().format().is_none() {
            return Err(FontFileError::NoOutlines);
        }
        if font.charmap().mappings().next().is_none() {
            return Err(FontFileError::NoCharacters);
        }
        Ok(Self { bytes: Arc::new(bytes) })
    }

    /// The file's bytes.
    pub fn bytes(&self) -> Arc<Vec<u8>> {
        self.bytes.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FONT: &[u8] = include_bytes!("../../assets/fonts/NotoSans-Regular.ttf");

    #[test]
    fn a_font_is_taken_and_what_is_none_is_named() {
        assert!(FontFile::new(FONT.to_vec()).is_ok());
        for (bytes, error) in [
            (&b"wOF2\0\x01\0\0"[..], FontFileError::Web),
            (b"", FontFileError::NoFont),
            (b"\x89PNG\r\n\x1a\n", FontFileError::NoFont),
        ] {
            assert_eq!(FontFile::new(bytes.to_vec()), Err(error));
        }
        assert!(FontFile::new(FONT[..100].to_vec()).is_err());
    }

    #[test]
    fn a_font_cut_off_anywhere_is_refused_or_taken_but_never_a_panic() {
        for end in (0..FONT.len()).step_by(997) {
            let _ = FontFile::new(FONT[..end].to_vec());
        }
    }
}
