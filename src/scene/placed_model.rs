//! A model in its place: its position in plan, and how it meets the ground.

use glam::Vec2;

use sandtable_description::words::{Anchor, Clamp, Footing};
use sandtable_draw::list::FeatureId;

/// A model in its place.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// Which of the scene's models.
    pub model: usize,
    /// World X and Y of its origin.
    pub at: Vec2,
    /// What its height is measured from.
    pub clamp: Clamp,
    /// Meters above the ground, or displayed elevation, as `clamp` says; 0 where it stands on the ground.
    pub height: f64,
    /// The heading of its front, radians clockwise from north.
    pub heading_rad: f32,
    /// Meters per unit of the model.
    pub scale: f32,
    /// How it meets the ground.
    pub standing: GroundFit,
    /// The feature it is.
    pub feature: FeatureId,
}

/// How a model meets the ground it stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundFit {
    /// The ground under it that decides its height.
    pub anchor: Anchor,
    /// The most that it leans with the ground, in radians.
    pub tilt_rad: f32,
    /// How deep it stands in the ground, in meters.
    pub sink_m: f32,
    /// What fills the gap.
    pub footing: Footing,
}

impl Placement {
    /// Whether its pose depends on the ground under its whole footprint, not only under its origin.
    pub fn needs_footprint(&self) -> bool {
        self.standing.anchor != Anchor::Origin || self.standing.tilt_rad > 0.0
    }
}
