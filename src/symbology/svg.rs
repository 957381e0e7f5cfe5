//! A symbol as the text of an SVG picture, its letters as text in whatever bold font the reader has.

use std::fmt::Write;

use glam::Vec2;
use sandtable_base::message::xml::escaped;

use crate::drawing::{PathStep, SymbolMark, SymbolPen};
use crate::frame::SymbolBox;
use crate::labeled::LabeledSymbol;
use crate::symbol::MilitarySymbol;
use crate::texts::{ROW_PITCH, SymbolNote, TEXT_GAP, TEXT_SIZE, TextPlace};

/// The font that symbols are measured with, and what else is bold and upright.
const FONT: &str = "font-family=\"Noto Sans, Arial, sans-serif\" font-weight=\"bold\"";
/// The height of capitals in sizes of the em, so that texts are centered without asking for a font.
const CAPITAL: f32 = 0.714;
/// A letter is no wider than this in sizes of the em; ideographs are as wide as high.
const LETTER_WIDTH: f32 = 0.72;
const IDEOGRAPH_WIDTH: f32 = 1.0;
/// Round all: half the widest line, and a little.
pub const MARGIN: f32 = 4.0;

impl LabeledSymbol {
    /// The text of an SVG picture, in which the frame of a friendly unit is `frame_px` high, on nothing.
    pub fn svg(&self, frame_px: f32) -> String {
        let mut body = String::new();
        self.symbol.marks.iter().for_each(|mark| write_mark(mark, &mut body));
        let mut bounds = self.symbol.bounds;
        for note in &self.texts {
            let line = SvgLine::new(note, &self.symbol);
            line.write(&mut body);
            bounds = bounds.union(line.bounds());
        }
        let title = format!("<title>{}</title>\n", escaped(&self.description()));
        document(&(title + &body), bounds, frame_px)
    }
}

impl MilitarySymbol {
    /// The text of an SVG picture without texts round the frame, in which the frame of a friendly unit is `frame_px` high.
    pub fn svg(&self, frame_px: f32) -> String {
        let mut body = String::new();
        self.marks.iter().for_each(|mark| write_mark(mark, &mut body));
        document(&body, self.bounds, frame_px)
    }
}

/// The picture of what lies within bounds, with a margin.
fn document(body: &str, bounds: SymbolBox, frame_px: f32) -> String {
    let (min, size) = (bounds.min - MARGIN, bounds.max - bounds.min + 2.0 * MARGIN);
    let pixels = size * frame_px / 100.0;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.2}\" height=\"{:.2}\" \
         viewBox=\"{:.2} {:.2} {:.2} {:.2}\">\n{body}</svg>\n",
        pixels.x, pixels.y, min.x, min.y, size.x, size.y
    )
}

/// A line of text round a frame: where its baseline begins, is centered, or ends.
struct SvgLine<'a> {
    text: &'a str,
    at: Vec2,
    anchor: &'static str,
}

impl<'a> SvgLine<'a> {
    fn new(note: &'a SymbolNote, symbol: &MilitarySymbol) -> Self {
        let frame = symbol.frame;
        let capital = CAPITAL * TEXT_SIZE;
        let middle = (frame.min.y + frame.max.y + capital) * 0.5;
        let row = |row: u8| middle + (f32::from(row) - 2.0) * TEXT_SIZE * ROW_PITCH;
        let (at, anchor) = match note.place {
            TextPlace::Left(place) => (Vec2::new(frame.min.x - TEXT_GAP, row(place)), "end"),
            TextPlace::Right(place) => (Vec2::new(frame.max.x + TEXT_GAP, row(place)), "start"),
            TextPlace::Above => (Vec2::new(100.0, symbol.bounds.min.y - TEXT_GAP), "middle"),
            TextPlace::Below => (Vec2::new(100.0, symbol.bounds.max.y + TEXT_GAP + capital), "middle"),
            TextPlace::Inside | TextPlace::Bar => (Vec2::new(100.0, middle), "middle"),
        };
        Self { text: &note.text, at, anchor }
    }

    fn bounds(&self) -> SymbolBox {
        let letter = |letter: char| if letter < '\u{2e80}' { LETTER_WIDTH } else { IDEOGRAPH_WIDTH };
        let width = self.text.chars().map(letter).sum::<f32>() * TEXT_SIZE;
        let left = match self.anchor {
            "end" => self.at.x - width,
            "middle" => self.at.x - width * 0.5,
            _ => self.at.x,
        };
        let (top, bottom) = (self.at.y - TEXT_SIZE, self.at.y + TEXT_SIZE * 0.3);
        SymbolBox { min: Vec2::new(left, top), max: Vec2::new(left + width, bottom) }
    }

    fn write(&self, svg: &mut String) {
        let (Vec2 { x, y }, anchor, text) = (self.at, self.anchor, escaped(self.text));
        // Writing to a string never fails.
        let _ = writeln!(
            svg,
            "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" font-size=\"{TEXT_SIZE}\" {FONT} \
             stroke=\"white\" stroke-width=\"5\" stroke-linejoin=\"round\" paint-order=\"stroke\">{text}</text>"
        );
    }
}

fn write_mark(mark: &SymbolMark, svg: &mut String) {
    let _ = match mark {
        SymbolMark::Shape { steps, fill, stroke } => {
            let fill = fill.map_or("none".to_owned(), hexadecimal);
            let stroke = stroke.map(|pen| stroked(&pen)).unwrap_or_default();
            writeln!(svg, "<path d=\"{}\" fill=\"{fill}\"{stroke}/>", path_data(steps))
        }
        SymbolMark::Text { text, center, size, color } => writeln!(
            svg,
            "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"middle\" font-size=\"{size}\" {FONT} fill=\"{}\">{}</text>",
            center.x,
            center.y + CAPITAL * 0.5 * size,
            hexadecimal(*color),
            escaped(text)
        ),
    };
}

fn stroked(pen: &SymbolPen) -> String {
    let dash = pen.dash.map(|[dash, gap]| format!(" stroke-dasharray=\"{dash},{gap}\"")).unwrap_or_default();
    format!(" stroke=\"{}\" stroke-width=\"{}\"{dash}", hexadecimal(pen.color), pen.width)
}

fn hexadecimal([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn path_data(steps: &[PathStep]) -> String {
    let mut data = String::new();
    for step in steps {
        let _ = match step {
            PathStep::Move(at) => write!(data, "M{:.2},{:.2}", at.x, at.y),
            PathStep::Line(at) => write!(data, "L{:.2},{:.2}", at.x, at.y),
            PathStep::Quad(by, at) => write!(data, "Q{:.2},{:.2} {:.2},{:.2}", by.x, by.y, at.x, at.y),
            PathStep::Cubic(one, two, at) => {
                write!(data, "C{:.2},{:.2} {:.2},{:.2} {:.2},{:.2}", one.x, one.y, two.x, two.y, at.x, at.y)
            }
            PathStep::Close => write!(data, "Z"),
        };
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_every_mark_and_text_within_its_box_and_nothing_that_marks_up() {
        let fields = [("unique_designation", "<1> & \"2\""), ("higher_formation", "3 BDE")];
        let labeled = LabeledSymbol::new("10031000161211020000", &fields).expect("a symbol");
        let svg = labeled.svg(100.0);
        let shapes = labeled.symbol.marks.len();
        assert_eq!(svg.matches("<path").count() + svg.matches("<text").count(), shapes + 2);
        assert!(
            svg.contains("&lt;1&gt; &amp; &quot;2&quot;</text>") && svg.contains("<title>friend, land unit")
        );
        let width = |svg: &str| -> f32 {
            let text = svg.split("width=\"").nth(1).and_then(|rest| rest.split('"').next());
            text.and_then(|text| text.parse().ok()).expect("a width")
        };
        assert_eq!(width(&labeled.svg(50.0)), width(&svg) / 2.0);
        let bare = LabeledSymbol::new("10031000161211020000", &[]).expect("a symbol").svg(100.0);
        assert_eq!(width(&bare), 150.0 + 2.0 * MARGIN);
        assert!(width(&svg) > 300.0);
    }
}
