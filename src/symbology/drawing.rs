//! Drawings in a box of 200 × 200 units, X right, Y down, the icon round (100, 100); and the text that they are written in.
//!
//! ```text
//! drawing   := statement { ";" statement }
//! statement := { style } ( path | circle | text | piece )
//! style     := "fill" | "solid" | "pale" | "light" | "fine" | "thin" | "bold" | "broad" | "dashed" | "rimless" | COLOR | COLOR "-line"
//! path      := "M" x,y { "M" x,y | "L" x,y | "Q" x,y x,y | "C" x,y x,y x,y | "A" center radii from to | "Z" }
//! circle    := "circle" x,y radius
//! text      := "text" size [ x,y ] WORD        centered; size of the em
//! piece     := "@" name [ dx,dy [ factor ] ]   a drawing of `pieces`, scaled about (100, 100), then moved
//! ```
//!
//! `A` is an arc of an axis-parallel ellipse, from one angle to another in degrees, clockwise from the right; a straight
//! line leads to its start. A path is stroked in black; `fill` fills it in black instead, `solid` fills it in black under its
//! stroke, `pale` in near white under its stroke and `light` in near white alone, a color in that color under its stroke or,
//! after `rimless`, alone; the others change the stroke. Of a text a color is that of its letters. A piece may hold other
//! pieces.

use std::f32::consts::FRAC_PI_4;

use glam::Vec2;

use crate::frame::FrameShape;
use crate::pieces::piece;

/// Width of the lines of an icon. The figures of the standard have about this share of the frame's height.
const LINE: f32 = 3.0;
const FINE: f32 = 1.2;
const THIN: f32 = 2.0;
const BOLD: f32 = 4.0;
const BROAD: f32 = 6.0;

/// Black ink.
pub const BLACK: [u8; 3] = [0, 0, 0];
/// The light parts of civilian icons.
pub const PALE: [u8; 3] = [239, 239, 239];

/// Red, orange, yellow, green, bright green, cyan of mines, and the yellow of what is unknown.
const COLORS: [(&str, [u8; 3]); 8] = [
    ("red", [255, 0, 0]),
    ("orange", [255, 141, 42]),
    ("yellow", [255, 255, 0]),
    ("green", [0, 130, 24]),
    ("lime", [0, 255, 0]),
    ("cyan", [0, 255, 255]),
    ("cream", [255, 255, 128]),
    ("pale", PALE),
];
/// Lengths of dash and gap of a dashed line.
const DASH: [f32; 2] = [8.0, 4.0];

/// Where a centered text stands that states no place: capitals look centered a little above the middle.
const TEXT_CENTER: Vec2 = Vec2::new(100.0, 99.5);

/// The middle of the box.
const BOX_CENTER: Vec2 = Vec2::splat(100.0);

/// Pieces hold pieces no deeper than this, so that a piece that holds itself is none. The tables need three levels.
const MOST_LEVELS: usize = 4;

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathStep {
    /// Begins a line.
    Move(Vec2),
    /// Straight to a point.
    Line(Vec2),
    /// A quadratic curve: control point, end.
    Quad(Vec2, Vec2),
    /// A cubic curve: two control points, end.
    Cubic(Vec2, Vec2, Vec2),
    /// Straight back to where the line began.
    Close,
}

/// The pen that strokes a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymbolPen {
    /// In units of the box.
    pub width: f32,
    /// Red, green, blue.
    pub color: [u8; 3],
    /// Lengths of dash and gap; `None` for an unbroken line.
    pub dash: Option<[f32; 2]>,
}

impl SymbolPen {
    /// An unbroken black line.
    pub fn black(width: f32) -> Self {
        Self { width, color: BLACK, dash: None }
    }
}

/// A part of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum SymbolMark {
    /// A path, filled first and then stroked.
    Shape {
        /// The path.
        steps: Vec<PathStep>,
        /// The color inside.
        fill: Option<[u8; 3]>,
        /// The line along it.
        stroke: Option<SymbolPen>,
    },
    /// A short text in heavy capitals.
    Text {
        /// The text.
        text: String,
        /// The middle of its capitals.
        center: Vec2,
        /// The size of the em.
        size: f32,
        /// Red, green, blue.
        color: [u8; 3],
    },
}

impl SymbolMark {
    /// A stroked path.
    pub fn stroke(steps: Vec<PathStep>, pen: SymbolPen) -> Self {
        Self::Shape { steps, fill: None, stroke: Some(pen) }
    }

    /// A filled path.
    pub fn filled(steps: Vec<PathStep>, color: [u8; 3]) -> Self {
        Self::Shape { steps, fill: Some(color), stroke: None }
    }
}

impl SymbolMark {
    /// The mark scaled about the middle of the box and then moved; its line stays as wide.
    pub(super) fn placed(self, offset: Vec2, factor: f32) -> Self {
        let place = |at: Vec2| BOX_CENTER + (at - BOX_CENTER) * factor + offset;
        match self {
            Self::Shape { steps, fill, stroke } => {
                let steps = steps.into_iter().map(|step| step.map(place)).collect();
                Self::Shape { steps, fill, stroke }
            }
            Self::Text { text, center, size, color } => {
                Self::Text { text, center: place(center), size: size * factor, color }
            }
        }
    }

    fn with_line_scaled(mut self, factor: f32) -> Self {
        if let Self::Shape { stroke: Some(pen), .. } = &mut self {
            pen.width *= factor;
            pen.dash = pen.dash.map(|dash| dash.map(|length| length * factor));
        }
        self
    }
}

impl PathStep {
    fn map(self, place: impl Fn(Vec2) -> Vec2) -> Self {
        match self {
            Self::Move(at) => Self::Move(place(at)),
            Self::Line(at) => Self::Line(place(at)),
            Self::Quad(control, end) => Self::Quad(place(control), place(end)),
            Self::Cubic(one, two, end) => Self::Cubic(place(one), place(two), place(end)),
            Self::Close => Self::Close,
        }
    }
}

/// The marks of a drawing in a frame of a shape; `None` where the text is none.
pub fn parse(drawing: &str, shape: FrameShape) -> Option<Vec<SymbolMark>> {
    let mut marks = Vec::new();
    add(drawing, DrawingStyle::default(), shape, MOST_LEVELS, &mut marks)?;
    Some(marks)
}

/// The steps of one path of the drawing text.
pub fn path(text: &str) -> Vec<PathStep> {
    steps(&text.split_whitespace().collect::<Vec<_>>()).unwrap_or_default()
}

/// A circle as a path.
pub fn circle(center: Vec2, radius: f32) -> Vec<PathStep> {
    let mut steps = Vec::new();
    arc(center, Vec2::splat(radius), 0.0, 360.0, &mut steps);
    steps.push(PathStep::Close);
    steps
}

#[derive(Clone, Copy)]
struct DrawingStyle {
    fill: Option<[u8; 3]>,
    has_stroke: bool,
    pen: SymbolPen,
}

impl Default for DrawingStyle {
    fn default() -> Self {
        Self { fill: None, has_stroke: true, pen: SymbolPen::black(LINE) }
    }
}

impl DrawingStyle {
    fn with(self, word: &str) -> Option<Self> {
        let color = |name: &str| COLORS.iter().find(|row| row.0 == name).map(|row| row.1);
        let pen = |pen: SymbolPen| Self { pen, ..self };
        Some(match word {
            "fill" => Self { fill: Some(BLACK), has_stroke: false, ..self },
            "solid" => Self { fill: Some(BLACK), has_stroke: true, ..self },
            "light" => Self { fill: Some(PALE), has_stroke: false, ..self },
            "fine" => pen(SymbolPen { width: FINE, ..self.pen }),
            "thin" => pen(SymbolPen { width: THIN, ..self.pen }),
            "bold" => pen(SymbolPen { width: BOLD, ..self.pen }),
            "broad" => pen(SymbolPen { width: BROAD, ..self.pen }),
            "dashed" => pen(SymbolPen { dash: Some(DASH), ..self.pen }),
            "rimless" => Self { has_stroke: false, ..self },
            _ => match word.strip_suffix("-line") {
                Some(name) => pen(SymbolPen { color: color(name)?, ..self.pen }),
                None => Self { fill: Some(color(word)?), ..self },
            },
        })
    }

    fn mark(self, steps: Vec<PathStep>) -> SymbolMark {
        let stroke = self.has_stroke.then_some(self.pen);
        SymbolMark::Shape { steps, fill: self.fill, stroke }
    }

    /// A text; pale letters are written in black, so that they can be read on every fill.
    fn text(self, text: &str, center: Vec2, size: &str) -> Option<SymbolMark> {
        let color = self.fill.filter(|color| *color != PALE).unwrap_or(BLACK);
        Some(SymbolMark::Text { text: text.to_owned(), center, size: size.parse().ok()?, color })
    }
}

fn add(
    drawing: &str,
    style: DrawingStyle,
    shape: FrameShape,
    levels: usize,
    marks: &mut Vec<SymbolMark>,
) -> Option<()> {
    for statement in drawing.split(';') {
        let words: Vec<&str> = statement.split_whitespace().collect();
        let (mut words, mut style) = (words.as_slice(), style);
        while let Some(styled) = words.first().and_then(|word| style.with(word)) {
            (words, style) = (words.get(1..)?, styled);
        }
        match words {
            ["circle", center, radius] => {
                marks.push(style.mark(circle(point(center)?, radius.parse().ok()?)))
            }
            ["text", size, text] => marks.push(style.text(text, TEXT_CENTER, size)?),
            ["text", size, center, text] => marks.push(style.text(text, point(center)?, size)?),
            [name, placement @ ..] if name.starts_with('@') => {
                let drawing = piece(name.strip_prefix('@')?, shape)?;
                let levels = levels.checked_sub(1)?;
                let (offset, factor) = match placement {
                    [] => {
                        add(drawing, style, shape, levels, marks)?;
                        continue;
                    }
                    [offset] => (point(offset)?, 1.0),
                    [offset, factor] => (point(offset)?, factor.parse().ok()?),
                    _ => return None,
                };
                let start = marks.len();
                add(drawing, style, shape, levels, marks)?;
                let piece = marks.split_off(start).into_iter();
                marks.extend(piece.map(|mark| mark.placed(offset, factor).with_line_scaled(factor)));
            }
            _ => marks.push(style.mark(steps(words)?)),
        }
    }
    Some(())
}

fn steps(words: &[&str]) -> Option<Vec<PathStep>> {
    let (mut steps, mut rest) = (Vec::new(), words);
    if !rest.first()?.starts_with('M') {
        return None;
    }
    while let Some((word, after)) = rest.split_first() {
        let operand = word.get(1..)?;
        rest = after;
        match word.get(..1)? {
            "M" => steps.push(PathStep::Move(point(operand)?)),
            "L" => steps.push(PathStep::Line(point(operand)?)),
            "Q" => {
                let (end, after) = rest.split_first()?;
                steps.push(PathStep::Quad(point(operand)?, point(end)?));
                rest = after;
            }
            "C" => {
                let [second, end, after @ ..] = rest else { return None };
                steps.push(PathStep::Cubic(point(operand)?, point(second)?, point(end)?));
                rest = after;
            }
            "A" => {
                let [radii, from, to, after @ ..] = rest else { return None };
                arc(point(operand)?, point(radii)?, from.parse().ok()?, to.parse().ok()?, &mut steps);
                rest = after;
            }
            "Z" => steps.push(PathStep::Close),
            _ => return None,
        }
    }
    Some(steps)
}

fn point(text: &str) -> Option<Vec2> {
    let (x, y) = text.split_once(',')?;
    Some(Vec2::new(x.parse().ok()?, y.parse().ok()?))
}

/// Adds an arc, from one angle to another in degrees, in pieces of at most 45°, whose cubic curves are off by less than
/// 10⁻⁵ of the radius.
fn arc(center: Vec2, radii: Vec2, from: f32, to: f32, steps: &mut Vec<PathStep>) {
    let (start, sweep) = (from.to_radians(), (to - from).to_radians());
    let count = (sweep.abs() / FRAC_PI_4).ceil().max(1.0);
    let step = sweep / count;
    let handle = 4.0 / 3.0 * libm::tanf(step / 4.0);
    let unit = |angle: f32| Vec2::new(libm::cosf(angle), libm::sinf(angle));
    let at = |direction: Vec2| center + radii * direction;
    let begin = at(unit(start));
    steps.push(if steps.is_empty() { PathStep::Move(begin) } else { PathStep::Line(begin) });
    for index in 0..count as usize {
        let (one, two) = (unit(start + step * index as f32), unit(start + step * (index + 1) as f32));
        let (leaving, arriving) = (one + handle * one.perp(), two - handle * two.perp());
        steps.push(PathStep::Cubic(at(leaving), at(arriving), at(two)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drawing_gives_its_marks() {
        let marks = parse("fill circle 100,100 10; bold M1,2 L3,4 Z; text 45 CA; @wheel", FrameShape::Circle);
        let marks = marks.expect("a drawing");
        assert_eq!(marks.len(), 5);
        let expected =
            vec![PathStep::Move(Vec2::new(1.0, 2.0)), PathStep::Line(Vec2::new(3.0, 4.0)), PathStep::Close];
        assert_eq!(marks[1], SymbolMark::stroke(expected, SymbolPen::black(BOLD)));
    }

    #[test]
    fn what_is_no_drawing_gives_none() {
        let placed = ["@wheel 1", "@wheel 1,2 x", "@wheel 1,2 3 4"];
        let texts = ["", "L1,2", "M1", "M1,2 X3,4", "circle 1,2", "@nothing", "text CA", "M1,2 A3,4 5"];
        for text in placed.into_iter().chain(texts) {
            assert_eq!(parse(text, FrameShape::Circle), None, "{text:?}");
        }
    }

    #[test]
    fn a_piece_is_scaled_about_the_middle_and_moved() {
        let marks = parse("@arrow 5,10 0.5", FrameShape::Circle).expect("a drawing");
        let at = |x, y| Vec2::new(x, y);
        let steps = vec![
            PathStep::Move(at(97.5, 97.5)),
            PathStep::Line(at(105.0, 90.0)),
            PathStep::Line(at(112.5, 97.5)),
        ];
        assert_eq!(marks, [SymbolMark::stroke(steps, SymbolPen::black(LINE / 2.0))]);
    }

    #[test]
    fn a_full_arc_is_a_circle_within_a_thousandth() {
        for step in circle(Vec2::new(100.0, 100.0), 50.0) {
            if let PathStep::Cubic(_, _, end) = step {
                assert!((end.distance(Vec2::splat(100.0)) - 50.0).abs() < 1e-3, "{end}");
            }
        }
    }
}
