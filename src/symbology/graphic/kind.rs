//! A kind of graphic: its word and code, draw rule, points and fields; [`crate::graphic::kind_table`] lists them all.

use glam::DVec2;

use crate::graphic::area;
use crate::graphic::drawing::{GraphicDrawing, GraphicInput};

/// The most points of a graphic: more than any staff plots, and few enough to check every pair of legs.
pub const MOST_POINTS: usize = 2000;

/// Draws a graphic from its points.
pub(super) type DrawRule = fn(&GraphicKind, &GraphicInput<'_>, &mut GraphicDrawing);

/// A kind of graphic.
#[derive(Clone, Copy, Debug)]
pub struct GraphicKind {
    /// The word in a scene file.
    pub word: &'static str,
    /// Its symbol set: 25 for control measures, 45 and 46 for weather and for the sea.
    pub set: u8,
    /// Entity, type and subtype: digits 11 to 16 of a code.
    pub code: &'static str,
    /// Its name in the standard.
    pub name: &'static str,
    /// The draw rule of MIL-STD-2525D, appendix H, that says where its points go.
    pub rule: &'static str,
    /// What its points are.
    pub shape: GraphicShape,
    /// The least and the greatest number of points.
    pub points: [usize; 2],
    /// The letters of the fields that it shows, separated by spaces.
    pub fields: &'static str,
    /// Its own text, with `{}` for the designation.
    pub label: &'static str,
    /// What colors it.
    pub tint: GraphicTint,
    /// The drawing of a point's icon; empty for lines and areas.
    pub icon: &'static str,
    pub(super) rule_fn: DrawRule,
}

/// The meaning of a graphic's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphicShape {
    /// A line.
    Line,
    /// A line around ground.
    Area,
    /// One place.
    Point,
    /// Points with a meaning each.
    Figure,
    /// A center line from the tip, then a corner of the arrowhead unless a width is stated.
    Axis,
    /// A center line, then a point at the side unless a width is stated.
    Wide,
    /// A center line with a stated width.
    Corridor,
    /// A center with stated radii.
    Circle,
    /// A center with stated radii and azimuths.
    Sector,
    /// A center with two stated distances, along an azimuth and across.
    Ellipse,
}

/// The source of a graphic's color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphicTint {
    /// The color of its side.
    Own,
    /// The color of obstacles, whatever the side.
    Obstacle,
    /// A color of its own: red, green, blue.
    Fixed([u8; 3]),
    /// Two colors: its own, and that of what is opposite in it.
    Pair([u8; 3], [u8; 3]),
}

impl GraphicKind {
    /// Whether its points are the corners of an outline.
    pub fn is_area(&self) -> bool {
        self.shape == GraphicShape::Area
    }

    /// Whether its draw rule has places of its own for the mark of the enemy.
    fn places_hostile(&self) -> bool {
        matches!(self.code, "270800" | "270801")
    }

    /// Whether it shows a field.
    pub fn shows(&self, letters: &str) -> bool {
        self.fields.split(' ').any(|field| field == letters)
    }

    /// Whether its draw rule leads from a tip backward, so that a person draws it the other way.
    pub fn leads_from_tip(&self) -> bool {
        let is_arrow = matches!(self.rule, "LINE9" | "LINE24" | "LINE25" | "LINE28");
        let is_line = matches!(self.code, "140601" | "140602" | "140603" | "140605" | "140300" | "140400");
        match self.shape {
            GraphicShape::Axis => true,
            GraphicShape::Figure => is_arrow,
            GraphicShape::Line => is_line && (self.set == 45 || self.code.starts_with("1406")),
            _ => false,
        }
    }

    /// Puts points that lead from start to tip in the order of the draw rule; the last point of an axis without a stated width
    /// stays the last, a corner of its head.
    pub fn turn_to_standard(&self, points: &mut [DVec2], has_width: bool) {
        let corner = usize::from(self.shape == GraphicShape::Axis && !has_width);
        let end = points.len().saturating_sub(corner);
        points[..end].reverse();
    }

    /// The least and the greatest number of points where a width is stated, or not.
    pub fn point_range(&self, has_width: bool) -> [usize; 2] {
        let side = usize::from(has_width && matches!(self.shape, GraphicShape::Axis | GraphicShape::Wide));
        self.points.map(|count| count - side)
    }

    /// Draws it from checked points.
    pub fn draw(&self, input: &GraphicInput<'_>) -> GraphicDrawing {
        let mut drawing = GraphicDrawing::default();
        (self.rule_fn)(self, input, &mut drawing);
        if self.is_area() && !self.places_hostile() {
            area::mark_hostile(input, &mut drawing);
        }
        drawing
    }
}
