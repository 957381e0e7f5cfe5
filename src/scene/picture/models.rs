//! Models, each set where it stands.

use glam::{Mat4, Quat, Vec3};
use rayon::prelude::*;

use crate::description::words::Clamp;
use crate::draw::list::DrawList;
use crate::scene::kind::{Placement, Scene};
use crate::scene::picture::detail::{self, Placed, Viewer};
use crate::terrain::facets::Facets;
use crate::terrain::query::{Interpolation, ground_height};

/// Adds every placement that has ground under it and may be seen.
pub(super) fn add(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets, viewer: Viewer<'_>) {
    let lowest_z: Vec<f32> =
        scene.models.iter().map(|model| model.bounds().map_or(0.0, |(min, _)| min.z)).collect();
    let place = |placement: &Placement| {
        let ground_z = foot_z(scene, placement, displayed)? as f32;
        let exaggeration = scene.terrain.exaggeration;
        let world_from_model = transform(placement, lowest_z[placement.model], ground_z, exaggeration);
        Some(Placed { model: placement.model, world_from_model, feature: placement.feature })
    };
    let placed: Vec<Placed> = scene.placements.par_iter().filter_map(place).collect();
    detail::add(list, scene, &placed, viewer);
}

/// World Z of the ground under a model: as displayed, or as it is where the ground there is out of view, since
/// the model's upper parts may be in view all the same. `None` over no data.
fn foot_z(scene: &Scene, placement: &Placement, displayed: &dyn Facets) -> Option<f64> {
    let lattice = &scene.terrain.lattice;
    let at = placement.at.as_dvec2();
    displayed.displayed_z(at).or_else(|| {
        let height_m = ground_height(lattice, Interpolation::Planar, at + lattice.origin()).height_m()?;
        Some(height_m * f64::from(scene.terrain.exaggeration))
    })
}

/// Where a model stands, given its lowest Z and the drawn ground at its origin.
///
/// Its front, −Y, is turned to the heading.
fn transform(placement: &Placement, lowest_z: f32, ground_z: f32, exaggeration: f32) -> Mat4 {
    let z = match placement.clamp {
        Clamp::Ground => ground_z - lowest_z * placement.scale,
        Clamp::Relative => ground_z + placement.height_m,
        Clamp::Absolute => placement.height_m * exaggeration,
    };
    let turn = std::f32::consts::PI - placement.heading_rad;
    let half = turn * 0.5;
    let rotation = Quat::from_xyzw(0.0, 0.0, libm::sinf(half), libm::cosf(half));
    Mat4::from_scale_rotation_translation(Vec3::splat(placement.scale), rotation, placement.at.extend(z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::list::FeatureId;
    use glam::Vec2;

    #[test]
    fn a_model_s_front_turns_to_its_heading_and_its_foot_stands_on_the_ground() {
        for (heading, front) in [(0.0, Vec2::Y), (90.0, Vec2::X), (180.0, Vec2::NEG_Y), (270.0, Vec2::NEG_X)]
        {
            let placement = Placement {
                model: 0,
                at: Vec2::new(100.0, 200.0),
                clamp: Clamp::Ground,
                height_m: 0.0,
                heading_rad: f32::to_radians(heading),
                scale: 2.0,
                feature: FeatureId(2),
            };
            let world_from_mesh = transform(&placement, -1.5, 40.0, 1.0);
            let foot = world_from_mesh.transform_point3(Vec3::new(0.0, 0.0, -1.5));
            assert!((foot - Vec3::new(100.0, 200.0, 40.0)).length() < 1e-4);
            let seen = world_from_mesh.transform_vector3(Vec3::NEG_Y).truncate();
            assert!((seen - front * 2.0).length() < 1e-5, "heading {heading}: {seen}");
        }
    }
}
