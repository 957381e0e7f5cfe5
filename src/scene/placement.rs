//! The pose of a model on the ground, and the plinth under it.
//!
//! Poses are computed for each picture on its displayed triangles, so that no model floats or sinks where the ground is
//! coarser; where those are out of view, on the finest. The report uses the finest triangles alone.
//!
//! ```text
//!          ┌─────┐  base: the model's lowest point, under its origin
//!          │     │
//!      ────┴──○──┴────   lean: a plane through the base, toward the ground's mean gradient by at most `tilt`
//!   ▔▔▔▔╲_     │         anchor: how high that plane lies, so that it touches the ground under the origin, or the
//!         ╲____│_____    lowest, the highest or the mean of what the ground rises above the plane
//! ```

use glam::{DVec2, Mat4, Quat, Vec2, Vec3};

use crate::footprint::{ModelFootprint, Under};
use crate::placed_model::Placement;
use sandtable_description::words::{Anchor, Clamp, Footing};
use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon;
use sandtable_structure::plinth;
use sandtable_terrain::support_surface::SupportSurface;

/// The margin of a plinth around the footprint, as a part of the longer side: visible as a step.
pub const PLINTH_REACH: f32 = 0.05;
/// The depth of a plinth below the lowest ground under it, in displayed meters: no gap remains.
const PLINTH_DEPTH_M: f64 = 0.5;
/// The part of a footprint that must be displayed for its displayed ground to count; the rest is rounding.
const WHOLE: f64 = 0.999;

/// A model on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelPose {
    /// Model space to world space.
    pub world_from_model: Mat4,
    /// World Z of the ground at the anchor.
    pub anchor_z: f64,
    /// The angle of its lean, in radians.
    pub tilt_rad: f64,
}

/// The ground under an outline, seen from `at`: as displayed, or at full resolution where not all of that is in view.
fn under(ground: SupportSurface<'_>, outline: &[DVec2; 4], at: DVec2) -> Option<Under> {
    let local = outline.map(|corner| corner - at);
    let area_m2 = polygon::doubled_area(&local) / 2.0;
    Under::cut(ground.displayed, outline, at)
        .filter(|under| under.area_m2() >= area_m2 * WHOLE)
        .or_else(|| Under::cut(ground.ground, outline, at))
}

/// The pose of a model on the ground; `None` where there is no ground.
pub fn stand(
    placement: &Placement,
    footprint: &ModelFootprint,
    ground: SupportSurface<'_>,
) -> Option<ModelPose> {
    let at = placement.at.as_dvec2();
    let whole =
        if placement.needs_footprint() { under(ground, &outline(placement, footprint), at) } else { None };
    let lean = whole
        .as_ref()
        .map_or(DVec2::ZERO, |under| leaning(under.gradient(), f64::from(placement.standing.tilt_rad)));
    let anchor_z = match (placement.standing.anchor, &whole) {
        (Anchor::Lowest, Some(under)) => under.lowest(lean),
        (Anchor::Highest, Some(under)) => under.highest(lean),
        (Anchor::Mean, Some(under)) => under.mean(lean),
        (Anchor::Origin, _) | (_, None) => ground.z(at)?,
    };
    let tilt_rad = libm::atan(lean.length());
    Some(ModelPose { world_from_model: pose(placement, footprint, anchor_z, lean), anchor_z, tilt_rad })
}

impl ModelPose {
    /// The footprint's corners in world space.
    pub fn base(&self, footprint: &ModelFootprint) -> [Vec3; 4] {
        footprint.corners().map(|corner| self.world_from_model.transform_point3(corner))
    }

    /// The plinth in world space; `None` without one, or where all of it would be buried.
    pub fn plinth(
        &self,
        placement: &Placement,
        footprint: &ModelFootprint,
        ground: SupportSurface<'_>,
    ) -> Option<DrawMesh> {
        let foot_z = self.plinth_foot_z(placement, footprint, ground)? - PLINTH_DEPTH_M;
        Some(plinth::block(&self.base(&footprint.grown(PLINTH_REACH)), foot_z as f32))
    }

    /// The plinth's height above the lowest ground under it; `None` as for [`ModelPose::plinth`].
    pub fn plinth_height_m(
        &self,
        placement: &Placement,
        footprint: &ModelFootprint,
        ground: SupportSurface<'_>,
    ) -> Option<f64> {
        let foot_z = self.plinth_foot_z(placement, footprint, ground)?;
        Some(top_z(&self.base(&footprint.grown(PLINTH_REACH))) - foot_z)
    }

    /// The lowest ground under the plinth.
    fn plinth_foot_z(
        &self,
        placement: &Placement,
        footprint: &ModelFootprint,
        ground: SupportSurface<'_>,
    ) -> Option<f64> {
        if placement.standing.footing != Footing::Plinth {
            return None;
        }
        let base = self.base(&footprint.grown(PLINTH_REACH));
        let outline = base.map(|corner| corner.truncate().as_dvec2());
        let foot_z = under(ground, &outline, placement.at.as_dvec2())?.lowest(DVec2::ZERO);
        (top_z(&base) > foot_z).then_some(foot_z)
    }
}

fn top_z(base: &[Vec3; 4]) -> f64 {
    base.iter().map(|corner| f64::from(corner.z)).fold(f64::NEG_INFINITY, f64::max)
}

/// The footprint in plan, in world space, of a model that stands upright.
pub fn outline(placement: &Placement, footprint: &ModelFootprint) -> [DVec2; 4] {
    let rotation = heading(placement.heading_rad);
    footprint.corners().map(|corner| {
        let local = rotation * (corner * placement.scale);
        placement.at.as_dvec2() + local.truncate().as_dvec2()
    })
}

/// The gradient of a plane that leans toward `gradient`, by at most `tilt_rad`.
fn leaning(gradient: DVec2, tilt_rad: f64) -> DVec2 {
    let steep = gradient.length();
    if libm::atan(steep) <= tilt_rad { gradient } else { gradient * (libm::tan(tilt_rad) / steep) }
}

/// Model space to world space, given world Z at the anchor and the gradient of the lean.
fn pose(placement: &Placement, footprint: &ModelFootprint, anchor_z: f64, lean: DVec2) -> Mat4 {
    let rotation = tilted(lean.as_vec2()) * heading(placement.heading_rad);
    let sink_m = f64::from(placement.standing.sink_m);
    let foot = Vec3::Z * footprint.min.z;
    let (held, z) = match placement.clamp {
        Clamp::Ground => (foot, anchor_z - sink_m),
        Clamp::Relative => (Vec3::ZERO, anchor_z + placement.height - sink_m),
        Clamp::Absolute => (Vec3::ZERO, placement.height),
    };
    let origin = placement.at.extend(z as f32) - rotation * (held * placement.scale);
    Mat4::from_scale_rotation_translation(Vec3::splat(placement.scale), rotation, origin)
}

/// Turns a model's front, −Y, to a heading.
fn heading(heading_rad: f32) -> Quat {
    let half = (std::f32::consts::PI - heading_rad) * 0.5;
    Quat::from_xyzw(0.0, 0.0, libm::sinf(half), libm::cosf(half))
}

/// Turns upright to the normal of a plane that rises by `lean`, about the level line in it.
fn tilted(lean: Vec2) -> Quat {
    let Some(uphill) = lean.try_normalize() else { return Quat::IDENTITY };
    let half = libm::atanf(lean.length()) * 0.5;
    let axis = Vec3::new(uphill.y, -uphill.x, 0.0) * libm::sinf(half);
    Quat::from_xyzw(axis.x, axis.y, axis.z, libm::cosf(half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placed_model::GroundFit;
    use crate::vertical_scale::VerticalScale;
    use glam::DVec2;
    use sandtable_draw::list::FeatureId;
    use sandtable_terrain::full_resolution::FullResolution;
    use sandtable_terrain::lattice::Lattice;
    use sandtable_terrain::triangle_surface::TriangleSurface;

    const FOOTPRINT: ModelFootprint =
        ModelFootprint { min: Vec3::new(-6.0, -4.0, -1.5), max: Vec3::new(6.0, 4.0, -1.5) };
    const AT: Vec2 = Vec2::new(100.0, 90.0);

    fn placement(heading_deg: f32, standing: GroundFit) -> Placement {
        Placement {
            model: 0,
            at: AT,
            clamp: Clamp::Ground,
            height: 0.0,
            heading_rad: heading_deg.to_radians(),
            scale: 2.0,
            standing,
            feature: FeatureId(2),
        }
    }

    /// 41 × 41 posts 5 m apart.
    fn ground(height: impl Fn(DVec2) -> f64) -> Lattice {
        let at = |index: u32| DVec2::new(f64::from(index % 41), f64::from(index / 41)) * 5.0;
        let heights = (0..41 * 41).map(|index| height(at(index)) as f32).collect();
        Lattice::new(DVec2::ZERO, DVec2::splat(5.0), 41, heights).expect("sound")
    }

    fn stand_on(lattice: &Lattice, placement: &Placement) -> ModelPose {
        let finest = FullResolution { lattice };
        stand(placement, &FOOTPRINT, SupportSurface { displayed: &finest, ground: &finest })
            .expect("on the ground")
    }

    #[test]
    fn a_model_s_front_turns_to_its_heading_and_its_foot_stands_on_the_ground() {
        let lattice = ground(|_| 40.0);
        for (heading, front) in [(0.0, Vec2::Y), (90.0, Vec2::X), (180.0, Vec2::NEG_Y), (270.0, Vec2::NEG_X)]
        {
            let stand = stand_on(&lattice, &placement(heading, GroundFit::default()));
            let foot = stand.world_from_model.transform_point3(Vec3::new(0.0, 0.0, -1.5));
            assert!((foot - AT.extend(40.0)).length() < 1e-4);
            let seen = stand.world_from_model.transform_vector3(Vec3::NEG_Y).truncate();
            assert!((seen - front * 2.0).length() < 1e-5, "heading {heading}: {seen}");
        }
    }

    /// The gaps under the corners on a plane.
    fn gaps(rise: DVec2, placement: &Placement) -> [f64; 4] {
        let stand = stand_on(&ground(|at| 300.0 + at.dot(rise)), placement);
        stand
            .base(&FOOTPRINT)
            .map(|corner| f64::from(corner.z) - (300.0 + corner.truncate().as_dvec2().dot(rise)))
    }

    #[test]
    fn at_the_lowest_no_corner_floats_and_at_the_highest_none_is_buried() {
        for heading in [0.0, 37.0, 127.0, 217.0, 307.0] {
            let rise = DVec2::new(0.2, -0.35);
            let at = |anchor| gaps(rise, &placement(heading, GroundFit { anchor, ..GroundFit::default() }));
            let (lowest, highest, mean) = (at(Anchor::Lowest), at(Anchor::Highest), at(Anchor::Mean));
            let most = |gaps: [f64; 4]| gaps.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let least = |gaps: [f64; 4]| gaps.into_iter().fold(f64::INFINITY, f64::min);
            assert!(most(lowest).abs() < 1e-3 && least(lowest) < -1.0, "{lowest:?}");
            assert!(least(highest).abs() < 1e-3 && most(highest) > 1.0, "{highest:?}");
            assert!(mean.iter().sum::<f64>().abs() < 1e-2, "{mean:?}");
        }
    }

    #[test]
    fn free_to_lean_it_leaves_no_gap_and_held_it_leans_as_far_as_it_may() {
        for heading in [0.0, 90.0, 180.0, 270.0, 33.0] {
            let rise = DVec2::new(-0.3, 0.4);
            let free = GroundFit { tilt_rad: 1.5, ..GroundFit::default() };
            for gap in gaps(rise, &placement(heading, free)) {
                assert!(gap.abs() < 1e-3, "{gap}");
            }
            let held = placement(heading, GroundFit { tilt_rad: 0.1, ..GroundFit::default() });
            let stand = stand_on(&ground(|at| 300.0 + at.dot(rise)), &held);
            assert!((stand.tilt_rad - 0.1).abs() < 1e-6);
            let up = stand.world_from_model.transform_vector3(Vec3::Z).normalize();
            assert!((libm::acosf(up.z) - 0.1).abs() < 1e-3);
            assert!(
                up.truncate().as_dvec2().dot(rise) < 0.0,
                "it leans downhill, as the ground's normal does"
            );
        }
    }

    #[test]
    fn sinking_lowers_it_and_a_plinth_closes_the_gap_below() {
        let rise = DVec2::new(0.5, 0.0);
        let sunk = GroundFit { sink_m: 0.75, ..GroundFit::default() };
        let (plain, low) =
            (gaps(rise, &placement(0.0, GroundFit::default())), gaps(rise, &placement(0.0, sunk)));
        assert!(plain.iter().zip(low).all(|(plain, low)| (plain - low - 0.75).abs() < 1e-3));
        let lattice = ground(|at| 300.0 + at.dot(rise));
        let finest = FullResolution { lattice: &lattice };
        let ground = SupportSurface { displayed: &finest, ground: &finest };
        let footing = GroundFit { footing: Footing::Plinth, anchor: Anchor::Highest, ..GroundFit::default() };
        let placed = placement(20.0, footing);
        let stand = stand_on(&lattice, &placed);
        let mesh = stand.plinth(&placed, &FOOTPRINT, ground).expect("there is a gap");
        let height = stand.plinth_height_m(&placed, &FOOTPRINT, ground).expect("there is a gap");
        assert!(height > 10.0, "{height}");
        for vertex in &mesh.vertices {
            let [x, y, z] = vertex.position.map(f64::from);
            let above = z - (300.0 + DVec2::new(x, y).dot(rise));
            let is_top = (z - stand.anchor_z).abs() < 1e-3;
            assert!(is_top || above < -0.4, "its foot is in the ground everywhere: {above}");
        }
        let none = placement(20.0, GroundFit { anchor: Anchor::Highest, ..GroundFit::default() });
        assert!(stand.plinth(&none, &FOOTPRINT, ground).is_none());
    }

    #[test]
    fn beside_the_displayed_ground_it_stands_on_the_ground_as_it_is() {
        struct Nothing;
        impl TriangleSurface for Nothing {
            fn visit_facets(
                &self,
                _: &sandtable_geom::rect::Rect,
                _: &mut dyn FnMut(&sandtable_terrain::triangle_surface::SurfaceTriangle),
            ) {
            }
        }
        let lattice = ground(|at| at.x);
        let finest = VerticalScale(3.0).ground(&lattice);
        for anchor in [Anchor::Origin, Anchor::Mean] {
            let placed = placement(0.0, GroundFit { anchor, ..GroundFit::default() });
            let found = stand(&placed, &FOOTPRINT, SupportSurface { displayed: &Nothing, ground: &finest })
                .expect("there is ground");
            assert!((found.anchor_z - 300.0).abs() < 1e-2, "{anchor:?}: {}", found.anchor_z);
        }
    }
}
