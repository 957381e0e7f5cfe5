//! Eaves: the part of a roof that reaches out over the walls, a board along its edge and the shade it casts below.
//!
//! ```text
//!        ╱ roof
//!      ╱│
//!    ╱  │ wall
//!   ▕▁▁▁│        from the wall's top outward, down the roof's slope; level beyond a gable
//!    ◀──▶ OVERHANG_M
//! ```
//!
//! They are a closed solid of their own around the walls, so that the building stays one without them. A flat roof has
//! none, nor has one over a footprint with sides too short to be set outward.

use glam::{DVec2, DVec3, Vec3};

use crate::building::{BuildingLevels, Paint};
use crate::faces::Faces;
use crate::fence_band::shaded;
use crate::unit_roof::UnitRoof;
use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon;

/// How far a roof reaches out over the walls, meters.
const OVERHANG_M: f64 = 0.45;

/// The thickness of its edge, meters.
const BOARD_M: f64 = 0.18;

/// The underside's lightness over the roof's, in steps of 255: it is always in shade.
const UNDER: f32 = -40.0;

/// The sharpest corner that is set outward, as the share of the overhang's length that its bisector must keep: at less, a
/// corner would reach out like a beak.
const LEAST_COSINE: f64 = 0.5;

/// A vertex of the roof's edge with less rise is at the eaves.
const LEVEL: f64 = 0.05;

/// The eaves of a building as a closed solid; `None` where it has none.
pub fn eaves(roof: &UnitRoof, levels: BuildingLevels, paint: Paint) -> Option<DrawMesh> {
    let [edge] = &roof.edge[..] else { return None };
    let rise_m = levels.top_z - levels.eaves_z;
    if roof.run_m <= 0.0 || rise_m <= 0.0 || shortest_side_m(edge) < 2.0 * OVERHANG_M {
        return None;
    }
    let pitch = rise_m / roof.run_m;
    let drawn = |at: DVec3| DVec3 { z: levels.eaves_z + at.z * rise_m, ..at };
    let (mut inner, mut outer) = (Vec::with_capacity(edge.len()), Vec::with_capacity(edge.len()));
    for index in 0..edge.len() {
        let (at, out) = (drawn(edge[index]), outward(edge, index)?);
        let fall = if edge[index].z < LEVEL { pitch * OVERHANG_M } else { 0.0 };
        inner.push(at);
        outer.push(at + (out * OVERHANG_M).extend(-fall));
    }
    let lowered = |ring: &[DVec3]| -> Vec<Vec3> {
        ring.iter().map(|at| DVec3 { z: at.z - BOARD_M, ..*at }.as_vec3()).collect()
    };
    let [inner_low, outer_low] = [lowered(&inner), lowered(&outer)];
    let [inner, outer] = [inner, outer].map(|ring| ring.iter().map(|at| at.as_vec3()).collect::<Vec<_>>());
    let mut faces = Faces::default();
    let under = shaded(paint.roof, UNDER);
    for (near, far, color) in [
        (&outer, &inner, paint.roof),
        (&outer_low, &outer, shaded(paint.roof, UNDER / 2.0)),
        (&inner_low, &outer_low, under),
        (&inner, &inner_low, under),
    ] {
        for ((a, b), (d, c)) in polygon::edges(near).zip(polygon::edges(far)) {
            // Not always flat.
            faces.polygon(&[a, b, c], color);
            faces.polygon(&[a, c, d], color);
        }
    }
    Some(faces.into_mesh())
}

fn shortest_side_m(edge: &[DVec3]) -> f64 {
    let lengths = polygon::edges(edge).map(|(from, to)| (to - from).truncate().length());
    lengths.fold(f64::INFINITY, f64::min)
}

/// Where the sides around a vertex of a counter-clockwise ring meet when both are set outward by one; `None` at a corner
/// too sharp for that.
fn outward(edge: &[DVec3], index: usize) -> Option<DVec2> {
    let count = edge.len();
    let [before, at, after] =
        [index + count - 1, index, index + 1].map(|vertex| edge[vertex % count].truncate());
    let normal = |from: DVec2, to: DVec2| (from - to).perp().try_normalize();
    let (first, second) = (normal(before, at)?, normal(at, after)?);
    let bisector = (first + second).try_normalize()?;
    let cosine = bisector.dot(first);
    (cosine >= LEAST_COSINE).then(|| bisector / cosine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::check;
    use crate::building_footprint::BuildingFootprint;
    use crate::roof::roof;
    use sandtable_description::words;

    fn built(ring: &[(f64, f64)], shape: words::RoofShape) -> Option<DrawMesh> {
        let ring: Vec<DVec2> = ring.iter().map(|&at| DVec2::from(at)).collect();
        let footprint = BuildingFootprint::parts(&ring, &[]).remove(0);
        let roof = roof(&footprint, shape);
        let levels = BuildingLevels { foot_z: -1.0, base_z: 0.0, floor_z: 0.0, eaves_z: 6.0, top_z: 9.0 };
        eaves(&roof, levels, Paint::by_place(&footprint, &roof))
    }

    #[test]
    fn eaves_are_closed_reach_out_on_all_sides_and_lie_below_the_walls_top() {
        for shape in [words::RoofShape::Gabled, words::RoofShape::Hipped, words::RoofShape::Pyramidal] {
            let mesh = built(&[(0.0, 0.0), (12.0, 0.0), (12.0, 8.0), (0.0, 8.0)], shape).expect("eaves");
            assert!(check(&mesh).is_ok(), "{shape:?}: {:?}", check(&mesh));
            let reach = |axis: usize| {
                let along = mesh.vertices.iter().map(|vertex| f64::from(vertex.position[axis]));
                along.fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(at), high.max(at)])
            };
            assert!(
                (reach(0)[0] + OVERHANG_M).abs() < 1e-5 && (reach(0)[1] - 12.0 - OVERHANG_M).abs() < 1e-5
            );
            assert!((reach(1)[0] + OVERHANG_M).abs() < 1e-5 && (reach(1)[1] - 8.0 - OVERHANG_M).abs() < 1e-5);
            // Three meters over a run of four.
            assert!((reach(2)[0] - (6.0 - 0.75 * OVERHANG_M - BOARD_M)).abs() < 1e-5, "{:?}", reach(2));
        }
    }

    #[test]
    fn a_flat_roof_and_one_with_short_sides_or_a_sharp_corner_have_none() {
        let square = [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)];
        assert!(built(&square, words::RoofShape::Flat).is_none());
        let chipped = [(0.0, 0.0), (9.0, 0.0), (9.0, 8.5), (8.5, 9.0), (0.0, 9.0)];
        assert!(built(&chipped, words::RoofShape::Pyramidal).is_none());
        let sharp = [(0.0, 0.0), (30.0, -3.0), (30.0, 3.0)];
        assert!(built(&sharp, words::RoofShape::Hipped).is_none());
    }
}
