//! Texts of graphics and of sight, on the ground.

use glam::Vec3;

use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;

/// A text of a graphic, on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedText {
    /// What it says; lines are separated by line feeds.
    pub text: String,
    /// The place it belongs to, world space.
    pub at: Vec3,
    /// A place on the side of it on which the text is; the same place for a text centered on it.
    pub toward: Vec3,
    /// How it follows a line.
    pub course: PlacedCourse,
    /// Its color, that of the graphic's lines.
    pub color: Srgba,
    /// The feature it belongs to.
    pub feature: FeatureId,
    /// Whether names of any graphic come before it.
    pub is_repeat: bool,
}

/// The way in which a text follows a line on the ground: the parts of it that are in the frustum, their vertices close
/// together.
#[derive(Clone, Debug, PartialEq)]
pub enum PlacedCourse {
    /// It does not: it is level, at its place.
    Level,
    /// On the line, at both ends.
    Ends(Vec<Vec<Vec3>>),
    /// Beside it, once.
    Once(Vec<Vec<Vec3>>),
    /// Beside it, again and again.
    Repeated(Vec<Vec<Vec3>>),
}
