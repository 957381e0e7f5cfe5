//! Cameras with parallel rays: a stated scale, or the largest round one at which what is shown fits the picture.

use glam::{DVec2, Vec2};

use crate::framing::fit::ParallelSpan;
use crate::framing::fitted_view::{ABOVE, BELOW, LEFT_RIGHT, silhouette};
use crate::plinth::base_z;
use crate::scene_model::SceneModel;
use crate::scene_view::ParallelView;
use sandtable_geom::aabb::Aabb;
use sandtable_view::axes::DirectionAxes;
use sandtable_view::camera::{Camera, CameraError, INCH_M, ParallelFrame};

/// How far before and behind the block things may be drawn, as a share of its longer side: its table, and what stands
/// high above the ground.
const MARGIN: f32 = 0.75;

/// The camera of a view on a picture of `size` pixels. In its middle is the middle of what it shows or, where the scale
/// is fitted, the middle between title and scale bar.
///
/// # Errors
/// See [`CameraError`].
pub fn parallel_camera(
    scene: &SceneModel,
    view: &ParallelView,
    size: (u32, u32),
) -> Result<Camera, CameraError> {
    let axes = DirectionAxes::new(view.azimuth_rad, view.pitch_rad);
    let shown = ParallelSpan::new(silhouette(scene, view.shown), &axes);
    let picture = DVec2::new(f64::from(size.0), f64::from(size.1));
    let px_per_m = pixels_per_meter(view, &shown, size);
    let half_m = (picture / (2.0 * px_per_m)).as_vec2();
    let middle = view.middle.map_or((shown.min + shown.max).truncate() / 2.0, |at| {
        ParallelSpan::new([at.as_vec2().extend(0.0)], &axes).min.truncate()
    });
    let lowered = if view.scale.is_none() { Vec2::Y * (ABOVE - BELOW) * half_m.y } else { Vec2::ZERO };
    let (min, max) = scene.bounds;
    let margin_m = (max - min).max_element() * MARGIN + 100.0;
    let block = Aabb { min: min.with_z(base_z(scene.bounds)), max };
    let block = ParallelSpan::new(block.corners(), &axes);
    let [near, far] = [block.min.z - margin_m, block.max.z + margin_m];
    let at = (middle + lowered).extend(near).as_dvec3();
    let eye = axes.right.as_dvec3() * at.x + axes.up.as_dvec3() * at.y + axes.forward.as_dvec3() * at.z;
    let frame = ParallelFrame { half_m, dpi: view.dpi as f32 };
    Camera::parallel(eye.as_vec3(), &axes, frame, size, (0.5, far - near))
}

/// Pixels per meter across and up the picture of a view of `shown` on a picture of `size` pixels.
pub(super) fn pixels_per_meter(view: &ParallelView, shown: &ParallelSpan, size: (u32, u32)) -> DVec2 {
    let scale =
        view.scale.unwrap_or_else(|| round_scale(view.dpi / INCH_M / fitted_px_per_m(view, shown, size)));
    view.dpi / (INCH_M * scale) * stretch(view)
}

/// Pixels per meter across a picture of `size` pixels whose part free of title and scale bar `shown` fills.
pub(super) fn fitted_px_per_m(view: &ParallelView, shown: &ParallelSpan, size: (u32, u32)) -> f64 {
    let picture = DVec2::new(f64::from(size.0), f64::from(size.1));
    let free = picture * DVec2::new(1.0 - 2.0 * f64::from(LEFT_RIGHT), f64::from(1.0 - BELOW - ABOVE));
    let span_m = (shown.max - shown.min).truncate().as_dvec2() * stretch(view);
    (span_m / free).max_element().max(1e-6).recip()
}

/// Pixels across and up the picture, per pixel across it.
fn stretch(view: &ParallelView) -> DVec2 {
    DVec2::new(1.0, f64::from(view.stretch))
}

/// The least number of two significant figures that is not below `scale`: at most a tenth of the size is lost.
fn round_scale(scale: f64) -> f64 {
    let unit = (0..libm::floor(libm::log10(scale)).max(1.0) as i32 - 1).fold(1.0, |unit, _| unit * 10.0);
    libm::ceil(scale / unit - 1e-9) * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fitted_scales_are_round_and_never_too_large() {
        let cases =
            [(151_392.0, 160_000.0), (9_999.0, 10_000.0), (25_000.0, 25_000.0), (7.2, 8.0), (0.3, 1.0)];
        for (scale, expected) in cases {
            assert_eq!(round_scale(scale), expected, "{scale}");
        }
    }
}
