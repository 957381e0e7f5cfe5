//! The font of the invisible, searchable texts of a PDF: those glyphs of the embedded font that the texts use.
//!
//! Each character has a code of its own, also where several share a glyph, or the box of a missing one where the font lacks
//! them: what is searched and copied is the text, whatever the font holds.

use std::collections::BTreeMap;

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, Str};
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use subsetter::GlyphRemapper;

use crate::fonts::FontCut;
use crate::pdf_stream::{check, deflated};

/// The number of the font among the objects of a PDF; its parts follow.
pub const FIRST_FONT_OBJECT: i32 = 8;

const FONT: Ref = Ref::new(FIRST_FONT_OBJECT);
const CHARACTER_FONT: Ref = Ref::new(FIRST_FONT_OBJECT + 1);
const DESCRIPTOR: Ref = Ref::new(FIRST_FONT_OBJECT + 2);
const GLYPHS: Ref = Ref::new(FIRST_FONT_OBJECT + 3);
const TEXTS: Ref = Ref::new(FIRST_FONT_OBJECT + 4);
const FILE: Ref = Ref::new(FIRST_FONT_OBJECT + 5);

/// The name of [`FontCut::Regular`].
const NAME: &str = "NotoSans-Regular";
/// The width of its stems, in thousandths of the em.
const STEM: f32 = 95.0;
const SYSTEM: SystemInfo<'_> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The font and the characters that the texts use.
pub struct PdfFont {
    tables: FontRef<'static>,
    /// The first has the code 1; 0 is that of no character.
    characters: Vec<char>,
    codes: BTreeMap<char, u16>,
}

impl PdfFont {
    pub fn new() -> Option<Self> {
        let tables = FontRef::from_index(FontCut::Regular.bytes(), 0).ok()?;
        Some(Self { tables, characters: Vec::new(), codes: BTreeMap::new() })
    }

    /// The codes of a text, two bytes for each character; `None` where texts have more characters than a font has codes.
    pub fn codes(&mut self, text: &str) -> Option<Vec<u8>> {
        let mut codes = Vec::with_capacity(text.len() * 2);
        for character in text.chars() {
            let code = match self.codes.get(&character) {
                Some(&code) => code,
                None => {
                    self.characters.push(character);
                    let code = u16::try_from(self.characters.len()).ok()?;
                    self.codes.insert(character, code);
                    code
                }
            };
            codes.extend(code.to_be_bytes());
        }
        Some(codes)
    }

    /// Writes the font as [`FIRST_FONT_OBJECT`] and those after it; `None` where its file is no font of the kind that PDF
    /// embeds.
    pub fn write(&self, pdf: &mut Pdf) -> Option<()> {
        let name = format!("{}+{NAME}", self.tag());
        let name = Name(name.as_bytes());
        pdf.type0_font(FONT)
            .base_font(name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(CHARACTER_FONT)
            .to_unicode(TEXTS);
        let mut font = pdf.cid_font(CHARACTER_FONT);
        font.subtype(CidFontType::Type2).base_font(name).system_info(SYSTEM).font_descriptor(DESCRIPTOR);
        font.default_width(0.0).cid_to_gid_map_stream(GLYPHS);
        font.widths().consecutive(1, self.widths());
        font.finish();
        self.write_descriptor(name, pdf);
        self.write_glyphs(pdf)?;
        let mut texts = UnicodeCmap::new(Name(b"Custom"), SYSTEM);
        (1_u16..).zip(&self.characters).for_each(|(code, &character)| texts.pair(code, character));
        pdf.cmap(TEXTS, &deflated(&texts.finish())?).filter(Filter::FlateDecode);
        Some(())
    }

    /// Six letters that tell these characters of the font from others.
    fn tag(&self) -> String {
        let characters: String = self.characters.iter().collect();
        let mut number = u32::from_be_bytes(check(characters.as_bytes()));
        let mut letter = || {
            let letter = b'A' + (number % 26) as u8;
            number /= 26;
            char::from(letter)
        };
        (0..6).map(|_| letter()).collect()
    }

    /// Thousandths of the em for each unit of the font.
    fn thousandths(&self) -> f32 {
        let units_per_em = self.tables.metrics(Size::unscaled(), LocationRef::default()).units_per_em;
        1000.0 / f32::from(units_per_em).max(1.0)
    }

    /// The glyph of each character; that of a missing one where the font lacks it.
    fn glyphs(&self) -> impl Iterator<Item = GlyphId> {
        let glyphs = self.tables.charmap();
        self.characters.iter().map(move |&character| glyphs.map(character).unwrap_or_default())
    }

    fn widths(&self) -> impl Iterator<Item = f32> {
        let (widths, scale) =
            (self.tables.glyph_metrics(Size::unscaled(), LocationRef::default()), self.thousandths());
        self.glyphs().map(move |glyph| widths.advance_width(glyph).unwrap_or_default() * scale)
    }

    fn write_descriptor(&self, name: Name<'_>, pdf: &mut Pdf) {
        let (metrics, scale) =
            (self.tables.metrics(Size::unscaled(), LocationRef::default()), self.thousandths());
        let bounds = metrics.bounds.unwrap_or_default();
        let sides = [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|side| side * scale);
        pdf.font_descriptor(DESCRIPTOR)
            .name(name)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(sides[0], sides[1], sides[2], sides[3]))
            .italic_angle(metrics.italic_angle)
            .ascent(metrics.ascent * scale)
            .descent(metrics.descent * scale)
            .cap_height(metrics.cap_height.unwrap_or(metrics.ascent) * scale)
            .stem_v(STEM)
            .font_file2(FILE);
    }

    /// Writes the glyphs themselves, and which of them each code shows.
    fn write_glyphs(&self, pdf: &mut Pdf) -> Option<()> {
        let mut kept = GlyphRemapper::new();
        let mut glyphs = vec![0, 0];
        for glyph in self.glyphs() {
            let glyph = u16::try_from(glyph.to_u32()).ok()?;
            glyphs.extend(kept.remap(glyph).to_be_bytes());
        }
        pdf.stream(GLYPHS, &deflated(&glyphs)?).filter(Filter::FlateDecode);
        let file = subsetter::subset(FontCut::Regular.bytes(), 0, &kept).ok()?;
        let packed = deflated(&file)?;
        let mut stream = pdf.stream(FILE, &packed);
        stream.filter(Filter::FlateDecode);
        stream.pair(Name(b"Length1"), i32::try_from(file.len()).ok()?);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_character_has_one_code_and_those_that_the_font_lacks_have_their_own() {
        let mut font = PdfFont::new().expect("the embedded font");
        assert_eq!(font.codes("Höhe").expect("few"), [0, 1, 0, 2, 0, 3, 0, 4]);
        assert_eq!(font.codes("富士h").expect("few"), [0, 5, 0, 6, 0, 3]);
        let glyphs: Vec<u32> = font.glyphs().map(GlyphId::to_u32).collect();
        assert!(glyphs[..4].iter().all(|&glyph| glyph > 0), "{glyphs:?}");
        assert_eq!(glyphs[4..], [0, 0]);
    }

    #[test]
    fn other_characters_give_the_font_another_name() {
        let tag = |text: &str| {
            let mut font = PdfFont::new().expect("the embedded font");
            font.codes(text).expect("few");
            font.tag()
        };
        assert_ne!(tag("Cove"), tag("Lake"));
        assert!(tag("Cove").len() == 6 && tag("Cove").bytes().all(|letter| letter.is_ascii_uppercase()));
    }
}
