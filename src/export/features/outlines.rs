//! The outlines of meshes in plan: of ribbons, and of what solids cover seen from above.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};

use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon::doubled_area;
use sandtable_ribbon::plan::PlanMesh;

/// Places nearer than this are one, meters.
const MERGE_M: f64 = 1e-3;

/// The polygons that counter-clockwise triangles in plan cover, each its outer ring and its holes.
pub(super) fn of_plan(plan: &PlanMesh) -> Vec<Vec<Vec<DVec2>>> {
    let triangles = plan.corners().map(|corners| corners.map(|corner| corner.at));
    polygons(triangles)
}

/// The polygons that the upward triangles of a solid cover, with its least and greatest height.
pub(super) fn of_solid(mesh: &DrawMesh) -> (Vec<Vec<Vec<DVec2>>>, [f64; 2]) {
    let position = |index: usize| Vec3::from(mesh.vertices[index].position);
    let corners = mesh.triangles.iter().map(|triangle| triangle.map(|id| position(id.index()).as_dvec3()));
    let is_upward = |[a, b, c]: &[DVec3; 3]| {
        let normal = (*b - *a).cross(*c - *a);
        normal.z > 1e-6 * normal.length()
    };
    let upward = corners.filter(is_upward).map(|corners| corners.map(DVec3::truncate));
    let heights = mesh.vertices.iter().map(|vertex| f64::from(vertex.position[2]));
    let range = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)]);
    (polygons(upward), range)
}

type Key = (i64, i64);

fn key(at: DVec2) -> Key {
    let cell = (at / MERGE_M).round();
    (cell.x as i64, cell.y as i64)
}

/// Edges that one triangle alone has, joined to rings, the holes with the ring around them.
fn polygons(triangles: impl Iterator<Item = [DVec2; 3]>) -> Vec<Vec<Vec<DVec2>>> {
    let mut places: BTreeMap<Key, DVec2> = BTreeMap::new();
    let mut edges: BTreeMap<(Key, Key), usize> = BTreeMap::new();
    for corners in triangles {
        let keys = corners.map(key);
        let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        if area <= 0.0 || keys[0] == keys[1] || keys[1] == keys[2] || keys[2] == keys[0] {
            continue;
        }
        keys.iter().zip(corners).for_each(|(key, at)| drop(places.entry(*key).or_insert(at)));
        for side in 0..3 {
            let (from, to) = (keys[side], keys[(side + 1) % 3]);
            match edges.get_mut(&(to, from)) {
                Some(count) if *count > 1 => *count -= 1,
                Some(_) => drop(edges.remove(&(to, from))),
                None => *edges.entry((from, to)).or_default() += 1,
            }
        }
    }
    let mut next: BTreeMap<Key, Vec<Key>> = BTreeMap::new();
    for ((from, to), count) in edges {
        next.entry(from).or_default().extend(std::iter::repeat_n(to, count));
    }
    let (mut outer, mut holes) = (Vec::new(), Vec::new());
    while let Some(ring) = next_ring(&mut next, &places) {
        let area = doubled_area(&ring);
        if area > 0.0 {
            outer.push(vec![ring]);
        } else if area < 0.0 {
            holes.push(ring);
        }
    }
    for hole in holes {
        // The smallest ring around it.
        let around = outer
            .iter_mut()
            .filter(|polygon: &&mut Vec<Vec<DVec2>>| holds(&polygon[0], &hole))
            .min_by(|a, b| doubled_area(&a[0]).total_cmp(&doubled_area(&b[0])));
        if let Some(polygon) = around {
            polygon.push(hole);
        }
    }
    outer
}

/// Takes a ring off the edges; at a place of several ways it turns to the right, so that outlines that touch there are parted.
fn next_ring(next: &mut BTreeMap<Key, Vec<Key>>, places: &BTreeMap<Key, DVec2>) -> Option<Vec<DVec2>> {
    let start = *next.keys().next()?;
    let (mut at, mut before) = (start, None);
    let mut ring = Vec::new();
    loop {
        let here = *places.get(&at)?;
        let Some(ways) = next.get_mut(&at) else { break };
        let turn = |to: &Key| {
            let Some(direction) = before else { return 0.0 };
            let along: DVec2 = places.get(to).map_or(DVec2::ZERO, |to| *to - here);
            direction_turn(direction, along)
        };
        let index = (0..ways.len()).min_by(|&a, &b| turn(&ways[a]).total_cmp(&turn(&ways[b])))?;
        let to = ways.swap_remove(index);
        if ways.is_empty() {
            next.remove(&at);
        }
        ring.push(here);
        before = places.get(&to).map(|to| *to - here);
        at = to;
        if at == start {
            break;
        }
    }
    Some(ring)
}

/// The angle by which a way turns to the left.
fn direction_turn(before: DVec2, along: DVec2) -> f64 {
    libm::atan2(before.perp_dot(along), before.dot(along))
}

/// Whether most corners of `hole` lie within `ring`.
fn holds(ring: &[DVec2], hole: &[DVec2]) -> bool {
    let inside = hole.iter().filter(|at| is_inside(ring, **at)).count();
    inside * 2 > hole.len()
}

fn is_inside(ring: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for index in 0..ring.len() {
        let (a, b) = (ring[index], ring[(index + 1) % ring.len()]);
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> [[DVec2; 3]; 2] {
        let [a, b, c, d] =
            [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)].map(|(x, y)| DVec2::new(x, y));
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn triangles_become_one_outline_with_its_holes() {
        let cells = (0..9)
            .filter(|cell| *cell != 4)
            .flat_map(|cell| square(f64::from(cell % 3), f64::from(cell / 3)));
        let [polygon] = &polygons(cells)[..] else { panic!("one polygon") };
        assert_eq!(polygon.len(), 2);
        assert_eq!([doubled_area(&polygon[0]), doubled_area(&polygon[1])], [18.0, -2.0]);
    }

    #[test]
    fn parts_that_touch_at_a_corner_are_polygons_of_their_own() {
        let cells = square(0.0, 0.0).into_iter().chain(square(1.0, 1.0));
        assert_eq!(polygons(cells).len(), 2);
    }
}
