//! The outlines of meshes in plan: of ribbons, and of what solids cover seen from above.

use glam::{DVec2, DVec3, Vec3};

use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon::doubled_triangle_area;
use sandtable_geom::region::{PolygonRings, union};
use sandtable_ribbon::plan::PlanMesh;

/// Smaller triangles, and holes, are slivers between triangles that meet: square meters.
const LEAST_M2: f64 = 1e-4;

/// The polygons that counter-clockwise triangles in plan cover, each its outer ring and its holes.
pub(super) fn of_plan(plan: &PlanMesh) -> Vec<PolygonRings> {
    polygons(plan.convex_parts())
}

/// The polygons that the upward triangles of a solid cover, with its least and greatest height.
pub(super) fn of_solid(mesh: &DrawMesh) -> (Vec<PolygonRings>, [f64; 2]) {
    let position = |index: usize| Vec3::from(mesh.vertices[index].position);
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|id| position(id.index()).as_dvec3()));
    let flat = corners.map(|corners| corners.map(DVec3::truncate));
    let upward = flat.filter(|corners| doubled_triangle_area(*corners) > 2.0 * LEAST_M2);
    let heights = mesh.vertices.iter().map(|vertex| f64::from(vertex.position[2]));
    let range = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
    (polygons(upward.map(Vec::from).collect()), range)
}

/// The union of convex polygons, without slivers.
fn polygons(parts: Vec<Vec<DVec2>>) -> Vec<PolygonRings> {
    let area = |ring: &Vec<DVec2>| sandtable_geom::polygon::doubled_area(ring).abs() * 0.5;
    let mut polygons = union(parts.iter().map(Vec::as_slice));
    polygons.retain(|rings| rings.first().is_some_and(|outer| area(outer) > LEAST_M2));
    for rings in &mut polygons {
        let mut index = 0;
        rings.retain(|ring| {
            index += 1;
            index == 1 || area(ring) > LEAST_M2
        });
    }
    polygons
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_geom::polygon::doubled_area;

    fn square(x: f64, y: f64) -> Vec<DVec2> {
        [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)].map(|(x, y)| DVec2::new(x, y)).to_vec()
    }

    #[test]
    fn parts_become_one_outline_with_its_holes() {
        let cells =
            (0..9).filter(|cell| *cell != 4).map(|cell| square(f64::from(cell % 3), f64::from(cell / 3)));
        let [polygon] = &polygons(cells.collect())[..] else { panic!("one polygon") };
        let areas: Vec<f64> = polygon.iter().map(|ring| doubled_area(ring).abs().round()).collect();
        assert_eq!(areas, [18.0, 2.0]);
    }

    #[test]
    fn parts_that_lie_over_each_other_count_once() {
        let [polygon] = &polygons(vec![square(0.0, 0.0), square(0.5, 0.0)])[..] else {
            panic!("one polygon")
        };
        assert!((doubled_area(&polygon[0]).abs() - 3.0).abs() < 1e-6);
    }
}
