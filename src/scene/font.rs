//! The font that a scene names.

use crate::assets::Assets;
use sandtable_base::message::suggest::quoted;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_draw::font::{FontFile, LARGEST_FONT_BYTES};

/// The font of `document`; `None` where it names none.
///
/// # Errors
/// The file cannot be read, is too large, or is no font with outlines.
pub fn load(document: &Document, assets: &Assets) -> Result<Option<FontFile>, Diagnostic> {
    let Some(name) = &document.font else { return Ok(None) };
    let refused =
        |cause: String| document.error(name, format!("'{}' is not used as a font: {cause}", quoted(name)));
    let bytes = assets.read(name).map_err(|error| document.error(name, error))?;
    if bytes.len() as u64 > LARGEST_FONT_BYTES {
        return Err(refused(format!("it has {} bytes, more than {LARGEST_FONT_BYTES}", bytes.len())));
    }
    FontFile::new(bytes).map(Some).map_err(|error| refused(error.to_string()))
}
