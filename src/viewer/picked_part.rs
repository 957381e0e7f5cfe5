//! The picked part of the scene file, and the place to which it is dragged.

use glam::DVec2;

use sandtable_draw::list::FeatureId;
use sandtable_editing::edit::EditPlace;
use sandtable_geom::azimuth::azimuth_deg;

/// The table that states the picked thing.
#[derive(Clone, Debug, PartialEq)]
pub struct PickedPart {
    /// The table.
    pub place: EditPlace,
    /// The part that can be dragged; `None` for draped features.
    pub grab: Option<GrabTarget>,
    /// The map coordinates of what can be dragged.
    pub at: DVec2,
    /// Its width in meters, where its table states one or may.
    pub width_m: Option<f64>,
    /// The file that its table names, with others in it.
    pub file: Option<String>,
}

/// A thing that can be moved by dragging.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrabTarget {
    /// A model.
    Model(FeatureId),
    /// A label, by its number.
    Label(usize),
}

/// The target of a drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragTarget {
    /// Map coordinates of the ground under the pointer.
    pub to: DVec2,
    /// Whether what is dragged turns where it is.
    pub turns: bool,
}

/// The heading from a place toward another, whole degrees clockwise from north.
pub fn heading_deg(from: DVec2, to: DVec2) -> f64 {
    azimuth_deg(to - from).round()
}
