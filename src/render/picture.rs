//! The result of a renderer.

use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;

/// The least alpha of a transparent surface that the depth and feature buffers show; under a more transparent one
/// they show the surface behind it.
pub const LEAST_VISIBLE_ALPHA: f32 = 0.5;

/// A rendered picture with its buffers, all of the same size, rows from the top.
///
/// Where a transparent surface covers a pixel, depth and feature are its own from an alpha of ½ on, and those of the
/// surface behind it below that.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// Colors, opaque.
    pub pixels: Pixels,
    /// Meters from the eye along the viewing direction at the pixel's center; infinite for sky.
    pub depth_m: Vec<f32>,
    /// The feature at the pixel's center; [`FeatureId::NONE`] for sky.
    pub features: Vec<FeatureId>,
}
