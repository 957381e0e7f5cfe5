//! What to paint on a picture, in the picture's own coordinates.
//!
//! Whoever fills these in has projected places to pixels and tested them against the depth buffer: nothing
//! here knows a scene or its terrain.

use glam::Vec2;

use crate::annotate::legend::Legend;
use crate::annotate::north::NorthArrow;
use crate::annotate::scale_bar::ScaleBar;

/// Everything to paint on one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotations {
    /// Names and heights, in any order.
    pub labels: Vec<PictureLabel>,
    /// The title, upper left.
    pub title: Option<String>,
    /// A second line under the title.
    pub subtitle: Option<String>,
    /// The north arrow, upper right.
    pub north: Option<NorthArrow>,
    /// The scale bar, lower left.
    pub scale_bar: Option<ScaleBar>,
    /// The elevation legend, lower right.
    pub legend: Option<Legend>,
    /// Where the data come from, small along the lower border.
    pub credit: Option<String>,
}

/// A name at a place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLabel {
    /// What it says: a name, and smaller on further lines what is to be known about it.
    pub text: String,
    /// The place on the ground: pixels from the picture's upper left corner, Y down.
    pub anchor_px: Vec2,
    /// The upper end of the leader line; `None`, or a point not above the anchor, leaves its length to
    /// the placement.
    pub top_px: Option<Vec2>,
    /// Meters from the eye to the place; among labels of a kind the nearer are placed first.
    pub depth_m: f32,
    /// Whether the place is seen, not hidden behind terrain.
    pub visible: bool,
    /// What is named.
    pub kind: LabelClass,
}

/// What a label names, by falling importance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LabelClass {
    /// A summit: a triangle, name and height.
    Summit,
    /// A settlement, building or other place: a dot and a name.
    #[default]
    Place,
    /// A lake, river or bay: blue and slanted, on the water itself where there is room.
    Water,
    /// A point of interest: a small dot and a small name.
    Point,
}
