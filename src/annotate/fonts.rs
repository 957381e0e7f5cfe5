//! The fonts embedded in the program: five cuts of Noto Sans, and the signs of Noto Sans Math that they lack.
//!
//! The files in `assets/fonts/` are subsets (Latin, Greek and Cyrillic; kerning and marks kept, hinting dropped);
//! `assets/README.md` says how they are made. The four cuts for names are a little narrower than the family's normal
//! width, so that more names find a place.

use std::sync::Arc;

use parley::fontique::{Blob, Collection, FontInfoOverride};
use parley::style::{FontFamily, FontFamilyName};

use crate::draw::font::FontFile;

/// A cut of the embedded family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FontCut {
    /// Running text and figures on panels.
    Regular,
    /// Headings on panels, and text on the picture, where halos thin the letters.
    Medium,
    /// Titles, and names of places and summits.
    Bold,
    /// Names of waters.
    Italic,
    /// Names along roads, and numbers on contour lines.
    Condensed,
}

impl FontCut {
    const ALL: [Self; 5] = [Self::Regular, Self::Medium, Self::Bold, Self::Italic, Self::Condensed];

    const fn family(self) -> &'static str {
        match self {
            Self::Regular => "sandtable regular",
            Self::Medium => "sandtable medium",
            Self::Bold => "sandtable bold",
            Self::Italic => "sandtable italic",
            Self::Condensed => "sandtable condensed",
        }
    }

    const fn bytes(self) -> &'static [u8] {
        match self {
            Self::Regular => include_bytes!("../../assets/fonts/NotoSans-Regular.ttf"),
            Self::Medium => include_bytes!("../../assets/fonts/NotoSans-Medium.ttf"),
            Self::Bold => include_bytes!("../../assets/fonts/NotoSans-Bold.ttf"),
            Self::Italic => include_bytes!("../../assets/fonts/NotoSans-Italic.ttf"),
            Self::Condensed => include_bytes!("../../assets/fonts/NotoSans-Condensed.ttf"),
        }
    }

    /// The families in which a character is looked up: this cut, the signs, the font given.
    pub fn families(self) -> FontFamily<'static> {
        let names = [self.family(), SIGNS, GIVEN].map(FontFamilyName::named);
        FontFamily::List(names.to_vec().into())
    }
}

/// Arrows, triangles, and signs of comparison.
const SIGNS: &str = "sandtable signs";
const SIGNS_BYTES: &[u8] = include_bytes!("../../assets/fonts/NotoSansMath-Signs.ttf");
/// The font that the scene names.
const GIVEN: &str = "sandtable given";

/// Registers the embedded fonts, and `given` for characters that they lack.
pub fn register_fonts(collection: &mut Collection, given: Option<&FontFile>) {
    let mut register = |blob: Blob<u8>, name: &str| {
        let naming = FontInfoOverride { family_name: Some(name), ..FontInfoOverride::default() };
        collection.register_fonts(blob, Some(naming));
    };
    for cut in FontCut::ALL {
        register(Blob::new(Arc::new(cut.bytes())), cut.family());
    }
    register(Blob::new(Arc::new(SIGNS_BYTES)), SIGNS);
    if let Some(font) = given {
        register(Blob::new(font.bytes()), GIVEN);
    }
}
