//! A sheet as SVG: the picture as an embedded image, letters and lines over it as paths.

use std::fmt::Write;

use base64::prelude::{BASE64_STANDARD, Engine};
use tiny_skia::PathSegment;

use crate::drawing::PaintedPath;
use crate::paint::ComposedSheet;
use sandtable_base::message::xml::escaped;

/// Millimeters per inch.
const INCH_MM: f32 = 25.4;

impl ComposedSheet {
    /// The text of an SVG file, as large in print as `dpi` pixels per inch make it; `png` is the picture's file.
    pub fn svg(&self, dpi: f32, png: &[u8]) -> String {
        let (width, height) = (self.pixels.width(), self.pixels.height());
        let mm = |pixels: u32| pixels as f32 / dpi * INCH_MM;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.3}mm\" height=\"{:.3}mm\" \
             viewBox=\"0 0 {width} {height}\">\n<image width=\"{width}\" height=\"{height}\" \
             href=\"data:image/png;base64,",
            mm(width),
            mm(height)
        );
        BASE64_STANDARD.encode_string(png, &mut svg);
        svg.push_str("\"/>\n");
        for drawing in &self.drawings {
            svg.push_str("<g>\n");
            for text in &drawing.texts {
                svg.push_str("<desc>");
                svg.push_str(&escaped(&text.text));
                svg.push_str("</desc>\n");
            }
            drawing.marks.iter().for_each(|mark| write_path(mark, &mut svg));
            svg.push_str("</g>\n");
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn write_path(mark: &PaintedPath, svg: &mut String) {
    let [red, green, blue, alpha] = mark.color.0;
    svg.push_str("<path d=\"");
    // Writing to a string never fails.
    for segment in mark.path.segments() {
        let _ = match segment {
            PathSegment::MoveTo(to) => write!(svg, "M{:.2} {:.2}", to.x, to.y),
            PathSegment::LineTo(to) => write!(svg, "L{:.2} {:.2}", to.x, to.y),
            PathSegment::QuadTo(by, to) => write!(svg, "Q{:.2} {:.2} {:.2} {:.2}", by.x, by.y, to.x, to.y),
            PathSegment::CubicTo(by, then, to) => {
                write!(svg, "C{:.2} {:.2} {:.2} {:.2} {:.2} {:.2}", by.x, by.y, then.x, then.y, to.x, to.y)
            }
            PathSegment::Close => write!(svg, "Z"),
        };
    }
    let _ = write!(svg, "\" fill=\"#{red:02x}{green:02x}{blue:02x}\"");
    if alpha < 255 {
        let _ = write!(svg, " fill-opacity=\"{:.3}\"", f32::from(alpha) / 255.0);
    }
    svg.push_str("/>\n");
}

#[cfg(test)]
mod tests {
    use crate::annotation::Annotations;
    use crate::paint::compose_sheet;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::pixels::Pixels;

    #[test]
    fn texts_that_look_like_markup_are_escaped_and_sizes_are_those_of_the_print() {
        let annotations = Annotations { title: Some("A <b> & \"c\"\u{1}".into()), ..Annotations::default() };
        let (sheet, _) = compose_sheet(Pixels::filled(960, 540, Srgba::WHITE), &annotations);
        let svg = sheet.svg(96.0, b"png");
        assert!(svg.contains("<desc>A &lt;b&gt; &amp; &quot;c&quot; </desc>"), "{svg}");
        assert!(svg.contains("width=\"254.000mm\"") && svg.matches("<path").count() > 2);
    }
}
