//! Military symbols drawn alone.

use crate::api::error::Error;
use crate::api::scene::Picture;
use sandtable_annotate::symbol_picture::symbol_picture;
use sandtable_files::png::encode_png;
use sandtable_symbology::labeled::LabeledSymbol;

/// A military symbol of MIL-STD-2525 or APP-6 with the text round it.
///
/// ```
/// use sandtable::Symbol;
/// let symbol = Symbol::new("10031000161211000000", &[("unique_designation", "1-12")])?;
/// assert_eq!(symbol.description(), "friend, land unit, infantry");
/// assert!(symbol.svg(64.0).starts_with("<svg"));
/// assert!(symbol.render(64.0).size().1 > 64);
/// # Ok::<(), sandtable::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    labeled: LabeledSymbol,
}

impl Symbol {
    /// The symbol of a code of 20 or 30 digits or of 15 letters, with fields of text by the keys of `[[symbol]]` in a scene file
    /// or by the letters of the standard.
    ///
    /// # Errors
    /// [`Error::Symbol`]: the code is none, its set has no frames, or no symbol has such a field.
    pub fn new(code: &str, fields: &[(&str, &str)]) -> Result<Self, Error> {
        Ok(Self { labeled: LabeledSymbol::new(code, fields)? })
    }

    /// What it is: its identity, its set, and its entity where one is stated and drawn.
    pub fn description(&self) -> String {
        self.labeled.description()
    }

    /// Parts of the code that the drawing lacks.
    pub fn notes(&self) -> &[String] {
        &self.labeled.symbol.notes
    }

    /// The text of an SVG picture, in which the frame of a friendly unit is `frame_px` high.
    pub fn svg(&self, frame_px: f32) -> String {
        self.labeled.svg(frame_px)
    }

    /// A picture in which the frame of a friendly unit is `frame_px` high, from 8 to 1000, on nothing.
    pub fn render(&self, frame_px: f32) -> Picture {
        Picture::new(symbol_picture(&self.labeled, frame_px))
    }

    /// [`Symbol::render`] as the bytes of a PNG file.
    pub fn png(&self, frame_px: f32) -> Vec<u8> {
        encode_png(&symbol_picture(&self.labeled, frame_px))
    }
}
