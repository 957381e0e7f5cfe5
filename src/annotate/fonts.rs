//! The fonts embedded in the program: five cuts of Noto Sans, and the signs of Noto Sans Math that they lack.
//!
//! The files in `assets/fonts/` are subsets (Latin, Greek and Cyrillic; kerning and marks kept, hinting dropped);
//! `assets/README.md` says how they are made. The four cuts for names are a little narrower than the family's normal
//! width, so that more names find a place.

use std::sync::Arc;

use parley::fontique::{Blob, Collection, FontInfoOverride};
use parley::style::{FontFamily, FontFamilyName};

use sandtable_draw::font::FontFile;

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

    /// The bytes of its file.
    pub const fn bytes(self) -> &'static [u8] {
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

/// Whether `text` has letters that touch each other: Arabic, Syriac, Mongolian, and the scripts of India that hang from a
/// line.
pub fn is_joined(text: &str) -> bool {
    text.chars().any(|letter| {
        matches!(u32::from(letter), 0x600..=0x8ff | 0x900..=0xdff | 0x1800..=0x18af | 0xfb50..=0xfdff | 0xfe70..=0xfefe)
    })
}

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

#[cfg(test)]
mod tests {
    use parley::layout::PositionedLayoutItem;

    use super::*;
    use crate::composer::Composer;
    use crate::text::TextStyle;

    const HAN: &[u8] = include_bytes!("../../tests/fonts/han.ttf");
    const ARABIC: &[u8] = include_bytes!("../../tests/fonts/arabic.ttf");
    const DEVANAGARI: &[u8] = include_bytes!("../../tests/fonts/devanagari.ttf");

    /// A shaped text: the font, the text, and glyph and advance in thousandths of the em from left to right.
    type Shaped = (&'static [u8], &'static str, &'static [(u32, u32)]);

    /// As HarfBuzz shapes these fonts (`uharfbuzz` 0.57.0, default features), Arabic from right to left: letters in their
    /// initial, medial and final forms with dots as marks; Devanagari with its i before the consonant, conjuncts, and r
    /// moved behind the syllable.
    const AS_HARFBUZZ: &[Shaped] = &[
        (HAN, "富士山", &[(2, 1000), (1, 1000), (3, 1000)]),
        (HAN, "黄河", &[(9, 1000), (6, 1000)]),
        (ARABIC, "جبل", &[(23, 748), (37, 0), (8, 355), (37, 0), (15, 601)]),
        (ARABIC, "لبنان", &[(34, 0), (28, 702), (3, 299), (34, 0), (8, 355), (37, 0), (8, 355), (26, 271)]),
        (ARABIC, "الشيخ", &[(34, 0), (13, 676), (38, 0), (9, 384), (36, 0), (20, 900), (26, 271), (2, 248)]),
        (DEVANAGARI, "हिमालय", &[(63, 269), (14, 541), (9, 614), (2, 269), (12, 696), (10, 596)]),
        (DEVANAGARI, "दिल्ली", &[(63, 269), (8, 540), (21, 462), (12, 696), (4, 269)]),
        (DEVANAGARI, "क्षेत्र", &[(15, 740), (5, 0), (26, 567)]),
        (DEVANAGARI, "कार्की", &[(6, 786), (2, 269), (6, 786), (93, 269)]),
    ];

    #[test]
    fn chinese_arabic_and_devanagari_are_shaped_as_harfbuzz_shapes_them() {
        for (font, text, expected) in AS_HARFBUZZ {
            let font = FontFile::new(font.to_vec()).expect("a font");
            let mut composer = Composer::with_font(100, 100, Some(&font));
            // Small type is spaced; joined letters must not be.
            let layout =
                composer.shape(text, TextStyle { tracking: 0.0, ..TextStyle::new(20.0, FontCut::Bold) });
            let mut shaped = Vec::new();
            for item in layout.lines().next().expect("a line").items() {
                if let PositionedLayoutItem::GlyphRun(run) = item {
                    shaped
                        .extend(run.glyphs().map(|glyph| (glyph.id, (glyph.advance * 50.0).round() as u32)));
                }
            }
            assert_eq!(shaped, *expected, "{text}");
        }
    }

    #[test]
    fn the_built_in_cut_keeps_its_own_letters_and_the_given_font_adds_those_it_lacks() {
        let font = FontFile::new(HAN.to_vec()).expect("a font");
        let mut composer = Composer::with_font(100, 100, Some(&font));
        let style = TextStyle::new(20.0, FontCut::Medium);
        assert_eq!(composer.line("富士山 Fuji 3776 m", style).missing, 0);
        assert_eq!(composer.line("जबल", style).missing, 3, "what both lack is still reported");
        let latin = Composer::new(100, 100).line("Fuji 3776 m", style).advance;
        assert!((composer.line("Fuji 3776 m", style).advance - latin).abs() < 1e-3);
    }

    #[test]
    fn joined_letters_are_never_spaced() {
        let font = FontFile::new(ARABIC.to_vec()).expect("a font");
        let mut composer = Composer::with_font(100, 100, Some(&font));
        let plain = TextStyle::new(20.0, FontCut::Italic);
        let spaced = TextStyle { tracking: 0.3, ..plain };
        assert_eq!(composer.line("لبنان", spaced).advance, composer.line("لبنان", plain).advance);
        assert!(composer.line("Fuji", spaced).advance > composer.line("Fuji", plain).advance + 10.0);
    }
}
