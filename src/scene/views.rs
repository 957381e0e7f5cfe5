//! Labels and cameras in world space.

use glam::Vec3;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::{CameraTable, LabelTable};
use crate::scene::vertical_scale::DrawnGround;
use crate::scene::world_frame::WorldFrame;
use crate::scene::{SceneLabel, SceneView};
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};

/// The document's labels, `{height}` filled in.
///
/// # Errors
/// A label lies off the ground.
pub fn labels(frame: &WorldFrame<'_>, lattice: &Lattice) -> Result<Vec<SceneLabel>, Diagnostic> {
    let label = |table: &LabelTable| {
        let world = frame.point(&table.at, table.crs.as_ref())?;
        let ground = frame.on_ground(lattice, &table.at, world)?;
        let elevation = whole_meters(frame.scale.elevation_m(ground.z));
        Ok(SceneLabel {
            text: table.text.replace("{height}", &elevation),
            ground,
            anchor: ground + Vec3::Z * table.height as f32,
            kind: table.kind,
        })
    };
    frame.document.labels.iter().map(label).collect()
}

/// A height in whole meters, without a sign before 0.
pub fn whole_meters(height_m: f32) -> String {
    let rounded = height_m.round();
    format!("{:.0}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// The document's cameras; without any, one that sees all of the drawn ground's `bounds`.
///
/// # Errors
/// The eye of a camera without `eye_elevation` lies off the ground, its target does, or the two coincide.
pub fn cameras(
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    bounds: (Vec3, Vec3),
) -> Result<Vec<SceneView>, Diagnostic> {
    if frame.document.cameras.is_empty() {
        return Ok(vec![overview(bounds)]);
    }
    frame.document.cameras.iter().map(|table| camera(table, frame, lattice)).collect()
}

fn camera(table: &CameraTable, frame: &WorldFrame<'_>, lattice: &Lattice) -> Result<SceneView, Diagnostic> {
    let eye_world = frame.point(&table.eye, table.crs.as_ref())?;
    let eye = match table.eye_elevation {
        Some(elevation) => eye_world.as_vec2().extend(frame.scale.world_z(elevation as f32)),
        None => {
            let ground = frame.on_ground(lattice, &table.eye, eye_world).map_err(|error| {
                error.with_help("give the camera an eye_elevation where its eye is not above the model")
            })?;
            ground + Vec3::Z * table.eye_height as f32
        }
    };
    let target_world = frame.point(&table.look_at, table.crs.as_ref())?;
    let target = frame.on_ground(lattice, &table.look_at, target_world)?;
    let target = target + Vec3::Z * table.look_at_height as f32;
    if (target - eye).try_normalize().is_none() {
        let message = "the camera looks at the place where its eye is";
        let help = "move look_at, or give it another look_at_height";
        return Err(frame.document.error(&table.look_at, message).with_help(help));
    }
    Ok(SceneView {
        name: table.name.to_string(),
        eye,
        target,
        fov_y_rad: (table.field_of_view as f32).to_radians(),
    })
}

/// A note for each camera whose eye is under the ground.
pub fn buried(cameras: &[SceneView], ground: DrawnGround<'_>) -> Vec<String> {
    let lattice = ground.lattice;
    let depth_m = |view: &SceneView| {
        let at = lattice.origin() + view.eye.truncate().as_dvec2();
        let height = ground_height(lattice, Interpolation::Planar, at).height_m()?;
        Some(height - f64::from(ground.scale.elevation_m(view.eye.z))).filter(|&depth| depth > 0.0)
    };
    cameras
        .iter()
        .filter_map(|view| Some((view, depth_m(view)?)))
        .map(|(view, depth)| format!("camera '{}' has its eye {depth:.1} m under the ground", view.name))
        .collect()
}

/// The overview's field of view.
const OVERVIEW_FOV_DEG: f32 = 40.0;
/// The narrowest picture, width to height, that shows the overview's whole ground.
const OVERVIEW_ASPECT: f32 = 4.0 / 3.0;
/// A factor of the eye's distance, which leaves space for the plinth and the furniture.
const OVERVIEW_MARGIN: f32 = 1.1;

/// A view from the south, 36° down, as near as the whole ground fits in.
fn overview((min, max): (Vec3, Vec3)) -> SceneView {
    let target = (min + max) / 2.0;
    let back = Vec3::new(0.0, -0.8, 0.6);
    let up = Vec3::new(0.0, 0.6, 0.8);
    let fov_y_rad = OVERVIEW_FOV_DEG.to_radians();
    let tan = libm::tanf(fov_y_rad / 2.0);
    // Each corner of the box has a least distance at which it lies within the picture.
    let distance = (0..8)
        .map(|corner| {
            let side = |bit: i32| if corner & bit == 0 { -0.5 } else { 0.5 };
            let offset = (max - min) * Vec3::new(side(1), side(2), side(4));
            offset.dot(back) + (offset.dot(up).abs() / tan).max(offset.x.abs() / (tan * OVERVIEW_ASPECT))
        })
        .fold(0.0, f32::max);
    SceneView {
        name: "overview".into(),
        eye: target + back * (distance * OVERVIEW_MARGIN),
        target,
        fov_y_rad,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_height_is_written_as_minus_nothing() {
        let written = [-0.3, 0.0, 0.4, -0.6, 311.5].map(whole_meters);
        assert_eq!(written, ["0", "0", "0", "-1", "312"]);
    }
}
