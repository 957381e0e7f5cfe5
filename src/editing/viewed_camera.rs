//! The view of a window, as a scene file states a camera.

use glam::DVec2;

/// A camera in perspective as a scene file states it. Places are map coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewedCamera {
    /// Where the eye is.
    pub eye: DVec2,
    /// Its elevation in meters, true to scale.
    pub eye_elevation_m: f64,
    /// What it looks at.
    pub look_at: DVec2,
    /// Meters above the ground there, as drawn.
    pub look_at_height_m: f64,
    /// The vertical field of view, degrees.
    pub field_of_view_deg: f64,
}
