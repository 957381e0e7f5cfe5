//! A sheet as PDF: the picture as an image, letters and lines over it as vectors; with `pdf_font` the one user of
//! `pdf-writer`. `pdf_stream` packs.
//!
//! Letters are the outlines that the sheet was laid out with, so that the print is the picture. Under them lie the same
//! texts without ink, in the embedded font: they can be searched, and copied.

use std::collections::BTreeSet;

use pdf_writer::types::TextRenderingMode;
use pdf_writer::writers::ExtGraphicsState;
use pdf_writer::{Content, Filter, Name, Pdf, Rect, Ref, Str, TextStr};
use tiny_skia::{Path, PathSegment, Point, Size};

use crate::drawing::{Drawing, PaintedPath};
use crate::paint::ComposedSheet;
use crate::pdf_font::{FIRST_FONT_OBJECT, PdfFont};
use crate::pdf_stream::{check, deflated};
use sandtable_base::message::xml::escaped;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;

/// Points per inch.
const POINTS: f32 = 72.0;
/// The size of texts without ink, in points.
const HIDDEN_POINTS: f32 = 8.0;
const CREATOR: &str = "sandtable";

const CATALOG: Ref = Ref::new(1);
const INFO: Ref = Ref::new(2);
const METADATA: Ref = Ref::new(3);
const PAGES: Ref = Ref::new(4);
const PAGE: Ref = Ref::new(5);
const MARKS: Ref = Ref::new(6);
const PICTURE: Ref = Ref::new(7);
const FONT: Ref = Ref::new(FIRST_FONT_OBJECT);
/// The picture and the font, as the marks on the page name them.
const PICTURE_NAME: Name<'_> = Name(b"picture");
const FONT_NAME: Name<'_> = Name(b"font");

/// A sheet that cannot be written as PDF.
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
        let page = Size::from_wh(width * scale, height * scale).ok_or(PdfError)?;
        let mut font = PdfFont::new().ok_or(PdfError)?;
        let mut marks = Marks::new();
        marks.picture(page);
        // Pixels from the upper left corner down; a PDF counts from the lower left corner up.
        marks.content.transform([scale, 0.0, 0.0, -scale, 0.0, page.height()]);
        for drawing in &self.drawings {
            marks.hidden_texts(drawing, scale, &mut font)?;
            drawing.marks.iter().for_each(|mark| marks.path(mark));
        }

        let mut pdf = Pdf::new();
        pdf.catalog(CATALOG).pages(PAGES).metadata(METADATA);
        let mut info = pdf.document_info(INFO);
        info.creator(TextStr(CREATOR));
        title.map(|title| info.title(TextStr(title)));
        drop(info);
        pdf.metadata(METADATA, metadata(title).as_bytes());
        pdf.pages(PAGES).kids([PAGE]).count(1);
        write_page(page, &marks.alphas, &mut pdf);
        let marks = deflated(&marks.content.finish()).ok_or(PdfError)?;
        pdf.stream(MARKS, &marks).filter(Filter::FlateDecode);
        let picture = write_picture(&self.pixels, &mut pdf)?;
        font.write(&mut pdf).ok_or(PdfError)?;
        let id = [picture, check(&marks)].concat();
        pdf.set_file_id((id.clone(), id));
        Ok(pdf.finish())
    }
}

/// A page of one size, with the opacities of its marks.
fn write_page(size: Size, alphas: &BTreeSet<u8>, pdf: &mut Pdf) {
    let mut page = pdf.page(PAGE);
    page.parent(PAGES).media_box(Rect::new(0.0, 0.0, size.width(), size.height())).contents(MARKS);
    let mut resources = page.resources();
    resources.x_objects().pair(PICTURE_NAME, PICTURE);
    resources.fonts().pair(FONT_NAME, FONT);
    let mut states = resources.ext_g_states();
    for &alpha in alphas {
        let mut state: ExtGraphicsState<'_> = states.insert(Name(alpha_name(alpha).as_bytes())).start();
        state.non_stroking_alpha(f32::from(alpha) / 255.0);
    }
}

/// Writes a picture, whose pixels are opaque; returns its check.
fn write_picture(pixels: &Pixels, pdf: &mut Pdf) -> Result<[u8; 4], PdfError> {
    let side = |pixels: u32| i32::try_from(pixels).map_err(|_| PdfError);
    let (width, height) = (side(pixels.width())?, side(pixels.height())?);
    let channels: Vec<u8> =
        pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    let packed = deflated(&channels).ok_or(PdfError)?;
    let mut image = pdf.image_xobject(PICTURE, &packed);
    image.filter(Filter::FlateDecode);
    image.width(width).height(height).bits_per_component(8).color_space().device_rgb();
    Ok(check(&packed))
}

/// The document's title and creator in XMP, which programs read that no longer look into the dictionary of PDF 1.
fn metadata(title: Option<&str>) -> String {
    let title = title.map(escaped).map(|title| {
        format!("<dc:title><rdf:Alt><rdf:li xml:lang=\"x-default\">{title}</rdf:li></rdf:Alt></dc:title>")
    });
    format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?><x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" \
         xmlns:dc=\"http://purl.org/dc/elements/1.1/\" xmlns:xmp=\"http://ns.adobe.com/xap/1.0/\">{}\
         <dc:format>application/pdf</dc:format><xmp:CreatorTool>{CREATOR}</xmp:CreatorTool>\
         </rdf:Description></rdf:RDF></x:xmpmeta><?xpacket end=\"r\"?>",
        title.unwrap_or_default()
    )
}

/// What a page shows, in order.
struct Marks {
    content: Content,
    /// The color that the next path is filled with.
    ink: Srgba,
    /// The opacities that the page must hold.
    alphas: BTreeSet<u8>,
}

impl Marks {
    /// Nothing, with the ink that a page begins with.
    fn new() -> Self {
        Self { content: Content::new(), ink: Srgba::opaque(0, 0, 0), alphas: BTreeSet::new() }
    }

    /// Shows the picture on the whole page.
    fn picture(&mut self, page: Size) {
        self.content.save_state();
        self.content.transform([page.width(), 0.0, 0.0, page.height(), 0.0, 0.0]);
        self.content.x_object(PICTURE_NAME).restore_state();
    }

    /// Writes the texts of a drawing from its upper left corner down, without ink.
    fn hidden_texts(&mut self, drawing: &Drawing, scale: f32, font: &mut PdfFont) -> Result<(), PdfError> {
        let texts = drawing.texts.iter().map(|text| text.text.as_str()).flat_map(str::lines);
        let texts = texts.filter(|text| !text.trim().is_empty());
        let (start, size) = (drawing.bounds().min, HIDDEN_POINTS / scale);
        for (number, text) in texts.enumerate().filter(|_| start.is_finite()) {
            let codes = font.codes(text).ok_or(PdfError)?;
            let baseline = start.y + size * (number + 1) as f32;
            self.content.begin_text().set_text_rendering_mode(TextRenderingMode::Invisible);
            self.content.set_font(FONT_NAME, size);
            self.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, start.x, baseline]);
            self.content.show(Str(&codes)).end_text();
        }
        Ok(())
    }

    fn path(&mut self, mark: &PaintedPath) {
        self.dip(mark.color);
        self.outline(&mark.path);
        self.content.fill_nonzero();
    }

    /// Makes `color` the ink.
    fn dip(&mut self, color: Srgba) {
        let [red, green, blue, alpha] = color.0;
        if alpha != self.ink.0[3] {
            self.alphas.insert(alpha);
            self.content.set_parameters(Name(alpha_name(alpha).as_bytes()));
        }
        if color.0[..3] != self.ink.0[..3] {
            let [red, green, blue] = [red, green, blue].map(|channel| f32::from(channel) / 255.0);
            self.content.set_fill_rgb(red, green, blue);
        }
        self.ink = color;
    }

    fn outline(&mut self, path: &Path) {
        let mut from = Point::zero();
        for segment in path.segments() {
            match segment {
                PathSegment::MoveTo(to) => self.content.move_to(to.x, to.y),
                PathSegment::LineTo(to) => self.content.line_to(to.x, to.y),
                PathSegment::QuadTo(by, to) => {
                    // The same curve: its handles lie two thirds of the way to the one of a quadratic curve.
                    let handle = |end: Point| [end.x + (by.x - end.x) / 1.5, end.y + (by.y - end.y) / 1.5];
                    let ([first_x, first_y], [then_x, then_y]) = (handle(from), handle(to));
                    self.content.cubic_to(first_x, first_y, then_x, then_y, to.x, to.y)
                }
                PathSegment::CubicTo(by, then, to) => {
                    self.content.cubic_to(by.x, by.y, then.x, then.y, to.x, to.y)
                }
                PathSegment::Close => self.content.close_path(),
            };
            // After a closed contour another begins with its own start.
            from = match segment {
                PathSegment::MoveTo(to) | PathSegment::LineTo(to) => to,
                PathSegment::QuadTo(_, to) | PathSegment::CubicTo(_, _, to) => to,
                PathSegment::Close => from,
            };
        }
    }
}

/// The name of an opacity on a page.
fn alpha_name(alpha: u8) -> String {
    format!("alpha{alpha}")
}

#[cfg(test)]
mod tests {
    use crate::annotation::Annotations;
    use crate::paint::compose_sheet;
    use crate::pdf::PdfError;
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

    #[test]
    fn a_print_without_a_size_is_an_error() {
        let picture = Pixels::filled(4, 3, Srgba::WHITE);
        let (sheet, _) = compose_sheet(picture, &Annotations::default());
        for dpi in [f32::INFINITY, f32::NAN, 0.0, -96.0] {
            assert_eq!(sheet.pdf(dpi, None), Err(PdfError), "{dpi} pixels per inch");
        }
    }
}
