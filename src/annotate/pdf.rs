//! A sheet as PDF: the picture as an image, letters and lines over it as vectors; the one user of `krilla`.
//!
//! Letters are the outlines that the sheet was laid out with, so that the print is the picture. Under them lie the same
//! texts without ink, in the embedded font: they can be searched, and copied.

use krilla::color::rgb;
use krilla::geom::{Path, PathBuilder, Point, Size, Transform};
use krilla::image::Image;
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use krilla::{Data, Document};
use skrifa::instance::{LocationRef, Size as FontSize};
use skrifa::{FontRef, MetadataProvider};
use tiny_skia::PathSegment;

use crate::drawing::{Drawing, PaintedPath};
use crate::fonts::FontCut;
use crate::paint::ComposedSheet;
use sandtable_draw::color::Srgba;

/// Points per inch.
const POINTS: f32 = 72.0;
/// The size of texts without ink, in points.
const HIDDEN_POINTS: f32 = 8.0;

/// A sheet that is no PDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the sheet cannot be written as PDF: its size or a part of it is out of the format's range")]
pub struct PdfError;

impl ComposedSheet {
    /// The bytes of a PDF of one page, printed at `dpi` pixels per inch. The same sheet gives the same bytes.
    ///
    /// # Errors
    /// [`PdfError`] where a size is beyond what PDF holds.
    pub fn pdf(&self, dpi: f32, title: Option<&str>) -> Result<Vec<u8>, PdfError> {
        let (width, height) = (self.pixels.width() as f32, self.pixels.height() as f32);
        let scale = POINTS / dpi;
        let page = PageSettings::from_wh(width * scale, height * scale).ok_or(PdfError)?;
        let mut document = Document::new();
        let metadata = Metadata::new().creator("sandtable".to_owned());
        document.set_metadata(match title {
            Some(title) => metadata.title(title.to_owned()),
            None => metadata,
        });
        let mut page = document.start_page_with(page);
        let mut surface = page.surface();
        surface.push_transform(&Transform::from_scale(scale, scale));
        let image =
            Image::from_rgba8(self.pixels.bytes().to_vec(), self.pixels.width(), self.pixels.height());
        surface.draw_image(image, Size::from_wh(width, height).ok_or(PdfError)?);
        let font = HiddenFont::new().ok_or(PdfError)?;
        for drawing in &self.drawings {
            font.write(drawing, scale, &mut surface);
            drawing.marks.iter().for_each(|mark| paint(mark, &mut surface));
        }
        surface.pop();
        surface.finish();
        page.finish();
        document.finish().map_err(|_| PdfError)
    }
}

fn paint(mark: &PaintedPath, surface: &mut Surface<'_>) {
    let Some(path) = path(&mark.path) else { return };
    surface.set_stroke(None);
    surface.set_fill(Some(fill(mark.color)));
    surface.draw_path(&path);
}

fn fill(color: Srgba) -> Fill {
    let [red, green, blue, _] = color.0;
    let opacity = NormalizedF32::new(color.alpha()).unwrap_or(NormalizedF32::ONE);
    Fill { paint: rgb::Color::new(red, green, blue).into(), opacity, rule: FillRule::NonZero }
}

fn path(path: &tiny_skia::Path) -> Option<Path> {
    let mut built = PathBuilder::new();
    for segment in path.segments() {
        match segment {
            PathSegment::MoveTo(to) => built.move_to(to.x, to.y),
            PathSegment::LineTo(to) => built.line_to(to.x, to.y),
            PathSegment::QuadTo(by, to) => built.quad_to(by.x, by.y, to.x, to.y),
            PathSegment::CubicTo(by, then, to) => built.cubic_to(by.x, by.y, then.x, then.y, to.x, to.y),
            PathSegment::Close => built.close(),
        }
    }
    built.finish()
}

/// The font of texts without ink.
struct HiddenFont {
    font: Font,
    tables: FontRef<'static>,
    units_per_em: f32,
}

impl HiddenFont {
    fn new() -> Option<Self> {
        let bytes = FontCut::Regular.bytes();
        let tables = FontRef::from_index(bytes, 0).ok()?;
        let metrics = tables.metrics(FontSize::unscaled(), LocationRef::default());
        let font = Font::new(Data::from(bytes), 0)?;
        Some(Self { font, tables, units_per_em: f32::from(metrics.units_per_em).max(1.0) })
    }

    /// Writes the texts of a drawing from its upper left corner down.
    fn write(&self, drawing: &Drawing, scale: f32, surface: &mut Surface<'_>) {
        let texts = drawing.texts.iter().map(|text| text.text.as_str()).flat_map(str::lines);
        let texts = texts.filter(|text| !text.trim().is_empty());
        let (start, size) = (drawing.bounds().min, HIDDEN_POINTS / scale);
        surface.set_stroke(None);
        surface.set_fill(Some(Fill { opacity: NormalizedF32::ZERO, ..Fill::default() }));
        for (number, text) in texts.enumerate().filter(|_| start.is_finite()) {
            let glyphs = self.glyphs(text);
            let at = Point::from_xy(start.x, start.y + size * (number + 1) as f32);
            surface.draw_glyphs(at, &glyphs, self.font.clone(), text, size, false);
        }
    }

    /// A glyph for each character; the box of a missing one where the font lacks it.
    fn glyphs(&self, text: &str) -> Vec<KrillaGlyph> {
        let characters = self.tables.charmap();
        let widths = self.tables.glyph_metrics(FontSize::unscaled(), LocationRef::default());
        let glyph = |(start, character): (usize, char)| {
            let id = characters.map(character).unwrap_or_default();
            let advance = widths.advance_width(id).unwrap_or_default() / self.units_per_em;
            let range = start..start + character.len_utf8();
            KrillaGlyph::new(GlyphId::new(id.to_u32()), advance, 0.0, 0.0, 0.0, range, None)
        };
        text.char_indices().map(glyph).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::annotation::Annotations;
    use crate::paint::compose_sheet;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::pixels::Pixels;

    #[test]
    fn a_sheet_gives_the_same_bytes_twice_and_its_size_is_that_of_the_print() {
        let pdf = || {
            let annotations = Annotations { title: Some("Cove Lake".into()), ..Annotations::default() };
            let picture = Pixels::filled(480, 270, Srgba::opaque(200, 210, 220));
            let (sheet, _) = compose_sheet(picture, &annotations);
            sheet.pdf(96.0, Some("Cove Lake")).expect("a small sheet")
        };
        let bytes = pdf();
        assert!(bytes.starts_with(b"%PDF") && bytes == pdf());
        let text = String::from_utf8_lossy(&bytes);
        // 480 × 270 pixels at 96 per inch.
        assert!(text.contains("360 202.5"), "no such page");
    }
}
