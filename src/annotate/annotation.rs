//! The annotations of a picture, in picture coordinates.
//!
//! The caller has projected places to pixels and tested them against the depth buffer: annotations know neither scene
//! nor terrain.

use glam::Vec2;

use crate::annotate::class_legend::LegendEntry;
use crate::annotate::cover::SceneCover;
use crate::annotate::grid::PictureGrid;
use crate::annotate::legend::Legend;
use crate::annotate::margin::MarginNotes;
use crate::annotate::north::NorthArrow;
use crate::annotate::rim::RimMark;
use crate::annotate::scale_bar::ScaleBar;
use crate::description::words::LabelKind;

/// Everything to paint on one picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotations {
    /// Names and heights, in any order.
    pub labels: Vec<PictureLabel>,
    /// Coordinates along the edge of the block; those that come first are drawn first.
    pub rim: Vec<RimMark>,
    /// The coordinate grid on the ground, under everything else.
    pub grid: Option<PictureGrid>,
    /// The title, upper left.
    pub title: Option<String>,
    /// A second line under the title.
    pub subtitle: Option<String>,
    /// The north arrow, upper right.
    pub north: Option<NorthArrow>,
    /// The scale bar, lower left or under the title.
    pub scale_bar: Option<ScaleBar>,
    /// The elevation legend, lower right or under the north arrow.
    pub legend: Option<Legend>,
    /// The classes that the picture shows; with a margin, there.
    pub classes: Vec<LegendEntry>,
    /// The source of the data, small along the lower border.
    pub credit: Option<String>,
    /// What stands round the picture on a sheet with a margin; furniture is there then, and not on the picture.
    pub margin: Option<MarginNotes>,
    /// Where the picture shows the scene; scale bar and legend leave their lower corners for the upper ones where they
    /// would cover it there and not here.
    pub cover: Option<SceneCover>,
}

/// A name at a place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLabel {
    /// The name; on further lines, in smaller type, notes on it.
    pub text: String,
    /// The place on the ground: pixels from the picture's upper left corner, Y down.
    pub anchor_px: Vec2,
    /// The upper end of the leader line; `None`, or a point not above the anchor, leaves its length to the placement.
    pub top_px: Option<Vec2>,
    /// Meters from the eye to the place; among labels of a rank and kind the nearer are placed first.
    pub depth_m: f32,
    /// Whether the place is seen, not hidden behind terrain.
    pub visible: bool,
    /// Decides type and symbol, and importance among labels of the same rank.
    pub kind: LabelKind,
    /// The lower, the more important.
    pub rank: f64,
}
