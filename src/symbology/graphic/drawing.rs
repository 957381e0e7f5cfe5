//! The input and the drawing of a graphic.

use glam::DVec2;

use crate::graphic::fields::GraphicFields;

/// The input from which a graphic is drawn.
#[derive(Clone, Copy, Debug)]
pub struct GraphicInput<'a> {
    /// Its points in meters, in the order of its draw rule, checked by [`crate::graphic::check::check`].
    pub points: &'a [DVec2],
    /// The height of a text in meters, above 0: teeth, dashes and arrowheads are multiples of it.
    pub em_m: f64,
    /// Upward on the picture, in the plane; its length says how many times as tall as wide an upright figure is drawn, so
    /// that it is not flat where the ground is seen at a low angle.
    pub up: DVec2,
    /// The width of a corridor or of an axis in meters, where it is stated.
    pub width_m: Option<f64>,
    /// Its texts and numbers.
    pub fields: &'a GraphicFields,
}

/// A graphic in the plane, in meters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GraphicDrawing {
    /// Lines of one width.
    pub strokes: Vec<GraphicStroke>,
    /// Rings to fill.
    pub fills: Vec<GraphicFill>,
    /// Texts.
    pub texts: Vec<GraphicText>,
}

/// A line of a graphic.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphicStroke {
    /// At least two points; of a closed line the first is repeated.
    pub points: Vec<DVec2>,
    /// Its pattern.
    pub dash: StrokeDash,
    /// Whose line it is.
    pub side: StrokeSide,
}

/// A filled ring of a graphic.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphicFill {
    /// Its corners, without repeating the first.
    pub ring: Vec<DVec2>,
    /// What it is filled with.
    pub ink: FillInk,
}

/// What a ring is filled with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FillInk {
    /// The color of the graphic's lines, as teeth are.
    Own,
    /// The color of the other side's lines.
    Opposing,
    /// A color - red, green, blue - through which the ground shows.
    Ground([u8; 3]),
}

/// Whether the draw rule itself dashes a line; planned graphics are dashed besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeDash {
    /// As the graphic's status says.
    Status,
    /// Dashed whatever the status is.
    Dashed,
    /// Hatching of an area: solid whatever the status is, and no outline.
    Hatch,
}

/// Whose line it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrokeSide {
    /// The side that the graphic belongs to.
    Own,
    /// The other side, as in the line of contact.
    Opposing,
}

/// A text of a graphic.
#[derive(Clone, Debug, PartialEq)]
pub struct GraphicText {
    /// What it says; lines are separated by line feeds.
    pub text: String,
    /// The point it belongs to.
    pub at: DVec2,
    /// On which side of that point it is, of length 1; zero for a text centered on it.
    pub toward: DVec2,
    /// Whether it is there, or where a line leaves it a place.
    pub course: TextCourse,
    /// Whether names of any graphic come before it: a mark of the enemy, or a text that the same line has elsewhere.
    pub is_repeat: bool,
}

/// The place of a text.
#[derive(Clone, Debug, PartialEq)]
pub enum TextCourse {
    /// At its point, level on the picture.
    Level,
    /// On this line at both of its ends.
    Ends(Vec<DVec2>),
    /// Beside this line, once.
    Once(Vec<DVec2>),
    /// Beside this line, again and again.
    Repeated(Vec<DVec2>),
}

impl GraphicDrawing {
    /// Adds a line; nothing for less than two points.
    pub(super) fn line(&mut self, points: impl Into<Vec<DVec2>>) {
        self.stroke(points.into(), StrokeDash::Status, StrokeSide::Own);
    }

    /// Adds a line that is dashed whatever the status.
    pub(super) fn dashed(&mut self, points: impl Into<Vec<DVec2>>) {
        self.stroke(points.into(), StrokeDash::Dashed, StrokeSide::Own);
    }

    /// Adds a line of the other side.
    pub(super) fn opposing(&mut self, points: impl Into<Vec<DVec2>>) {
        self.stroke(points.into(), StrokeDash::Status, StrokeSide::Opposing);
    }

    /// Adds a closed line.
    pub(super) fn ring(&mut self, points: impl Into<Vec<DVec2>>) {
        let mut points = points.into();
        points.extend(points.first().copied());
        self.line(points);
    }

    /// Adds a closed line and fills it.
    pub(super) fn filled(&mut self, points: impl Into<Vec<DVec2>>) {
        let points = points.into();
        self.fill(points.clone(), FillInk::Own);
        self.ring(points);
    }

    /// Fills a ring without a line around it.
    pub(super) fn fill(&mut self, ring: Vec<DVec2>, ink: FillInk) {
        if ring.len() > 2 {
            self.fills.push(GraphicFill { ring, ink });
        }
    }

    /// Adds a line of an area's hatching.
    pub(super) fn hatch(&mut self, points: impl Into<Vec<DVec2>>) {
        self.stroke(points.into(), StrokeDash::Hatch, StrokeSide::Own);
    }

    /// Adds a text centered on a point; nothing for an empty one.
    pub(super) fn text(&mut self, text: impl Into<String>, at: DVec2) {
        self.text_beside(text, at, DVec2::ZERO);
    }

    /// Adds a text on a side of a point.
    pub(super) fn text_beside(&mut self, text: impl Into<String>, at: DVec2, toward: DVec2) {
        let text = text.into();
        if !text.is_empty() {
            self.texts.push(GraphicText { text, at, toward, course: TextCourse::Level, is_repeat: false });
        }
    }

    /// Lets names come before the texts from a number on.
    pub(super) fn yield_texts(&mut self, from: usize) {
        self.texts.iter_mut().skip(from).for_each(|text| text.is_repeat = true);
    }

    /// Adds a text that a line leaves a place.
    pub(super) fn text_on(&mut self, text: impl Into<String>, course: TextCourse) {
        let text = text.into();
        let at = match &course {
            TextCourse::Level => None,
            TextCourse::Ends(line) | TextCourse::Once(line) | TextCourse::Repeated(line) => line.first(),
        };
        if let Some(&at) = at.filter(|_| !text.is_empty()) {
            self.texts.push(GraphicText { text, at, toward: DVec2::ZERO, course, is_repeat: false });
        }
    }

    pub(super) fn stroke(&mut self, points: Vec<DVec2>, dash: StrokeDash, side: StrokeSide) {
        if points.len() > 1 {
            self.strokes.push(GraphicStroke { points, dash, side });
        }
    }
}
