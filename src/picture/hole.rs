//! Cuts a rectangle out of draw lists, and makes the skirts along its border.

use glam::{DVec2, Mat4, Vec3};

use crate::nested_plan::is_within;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MeshId};
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::{MeshSink, VertexId};

/// How far off the border of a rectangle a vertex may be that lies on it, in meters: rounding of f32 positions.
const ON_BORDER_M: f64 = 0.05;

/// Calls `visit` with the parts of a triangle outside the rectangle, as triangles. `place` gives a corner's place, and `blend`
/// a corner between two.
pub(super) fn outside<V: Copy>(
    hole: &Rect,
    triangle: [V; 3],
    place: impl Fn(&V) -> Vec3,
    blend: impl Fn(V, V, f32) -> V,
    visit: &mut dyn FnMut(&[V; 3]),
) {
    let at = |corner: &V| place(corner).truncate().as_dvec2();
    let plan = triangle.map(|corner| at(&corner));
    let beside = |axis: usize| {
        plan.iter().all(|at| at[axis] <= hole.min[axis] + ON_BORDER_M)
            || plan.iter().all(|at| at[axis] >= hole.max[axis] - ON_BORDER_M)
    };
    if beside(0) || beside(1) {
        return visit(&triangle);
    }
    let mut rest = triangle.to_vec();
    let sides = [(0, hole.min.x, -1.0), (0, hole.max.x, 1.0), (1, hole.min.y, -1.0), (1, hole.max.y, 1.0)];
    for (axis, border, outward) in sides {
        let distance = |corner: &V| (at(corner)[axis] - border) * outward;
        let part = half(&rest, &distance, &blend);
        rest = half(&rest, &|corner| -distance(corner), &blend);
        for corner in 2..part.len() {
            visit(&[part[0], part[corner - 1], part[corner]]);
        }
    }
}

/// The part of a convex ring where `side` is not negative.
fn half<V: Copy>(ring: &[V], side: &dyn Fn(&V) -> f64, blend: &impl Fn(V, V, f32) -> V) -> Vec<V> {
    let mut kept = Vec::with_capacity(ring.len() + 1);
    let Some(&last) = ring.last() else { return kept };
    let (mut before, mut side_before) = (last, side(&last));
    for &here in ring {
        let side_here = side(&here);
        if (side_before < 0.0) != (side_here < 0.0) {
            kept.push(blend(before, here, (side_before / (side_before - side_here)) as f32));
        }
        if side_here >= 0.0 {
            kept.push(here);
        }
        (before, side_before) = (here, side_here);
    }
    kept
}

/// Removes what lies in the rectangle: the ground and what is draped on it are cut at its border, solids triangle by triangle,
/// and models stay whole.
pub(super) fn cut_hole(list: &mut DrawList, hole: &Rect) {
    let mut items = Vec::with_capacity(list.items.len());
    for item in std::mem::take(&mut list.items) {
        if item.world_from_mesh != Mat4::IDENTITY {
            let at = item.world_from_mesh.w_axis.truncate().truncate().as_dvec2();
            items.extend((!is_within(hole, at)).then_some(item));
            continue;
        }
        let mesh = &list.meshes[item.mesh.0 as usize];
        let triangles = &mesh.triangles[item.triangles.start as usize..item.triangles.end as usize];
        let meets = |triangle: &[VertexId; 3]| hole.meets(&Rect::around(triangle.map(|id| plan(mesh, id))));
        if !triangles.iter().any(meets) {
            items.push(item);
            continue;
        }
        let kept = if item.layer == DepthLayer::Solid {
            solid_outside(mesh, triangles, hole)
        } else {
            cut_mesh(mesh, triangles, hole)
        };
        if !kept.triangles.is_empty() {
            let triangles = 0..kept.triangles.len() as u32;
            let mesh = list.add_mesh(kept);
            items.push(DrawItem { mesh, triangles, ..item });
        }
    }
    list.items = items;
    drop_unused(list);
}

/// Empties the meshes that no item draws: their numbers stay.
fn drop_unused(list: &mut DrawList) {
    let mut is_used = vec![false; list.meshes.len()];
    list.items.iter().for_each(|item| is_used[item.mesh.0 as usize] = true);
    for (mesh, _) in list.meshes.iter_mut().zip(is_used).filter(|(_, is_used)| !is_used) {
        *mesh = DrawMesh::default();
    }
}

fn plan(mesh: &DrawMesh, id: VertexId) -> DVec2 {
    Vec3::from(mesh.vertices[id.index()].position).truncate().as_dvec2()
}

/// The triangles whose middles are outside the rectangle.
fn solid_outside(mesh: &DrawMesh, triangles: &[[VertexId; 3]], hole: &Rect) -> DrawMesh {
    let middle = |triangle: &[VertexId; 3]| triangle.map(|id| plan(mesh, id)).iter().sum::<DVec2>() / 3.0;
    let kept = triangles.iter().filter(|triangle| !is_within(hole, middle(triangle)));
    DrawMesh { vertices: mesh.vertices.clone(), triangles: kept.copied().collect() }
}

/// The parts of triangles outside the rectangle. Vertices of triangles that are not cut are shared as before.
fn cut_mesh(mesh: &DrawMesh, triangles: &[[VertexId; 3]], hole: &Rect) -> DrawMesh {
    let mut cut = DrawMesh { vertices: mesh.vertices.clone(), triangles: Vec::new() };
    let inner = hole.grown(-ON_BORDER_M);
    for triangle in triangles {
        let around = Rect::around(triangle.map(|id| plan(mesh, id)));
        if !inner.meets(&around) {
            cut.triangles.push(*triangle);
            continue;
        }
        if hole.contains_rect(&around) {
            continue;
        }
        let corners = triangle.map(|id| mesh.vertices[id.index()]);
        let place = |vertex: &DrawVertex| Vec3::from(vertex.position);
        outside(hole, corners, place, blended, &mut |piece| {
            let ids = piece.map(|vertex| cut.vertex(vertex));
            cut.triangle(ids);
        });
    }
    cut
}

/// The vertex at a part of the way between two, 0..=1.
fn blended(from: DrawVertex, to: DrawVertex, part: f32) -> DrawVertex {
    let mix = |a: f32, b: f32| a + (b - a) * part;
    DrawVertex {
        position: Vec3::from(from.position).lerp(Vec3::from(to.position), part).to_array(),
        normal: Vec3::from(from.normal).lerp(Vec3::from(to.normal), part).to_array(),
        uv: [mix(from.uv[0], to.uv[0]), mix(from.uv[1], to.uv[1])],
        color: if part < 0.5 { from.color } else { to.color },
    }
}

/// Adds walls down from the edges of the ground that lie along the border of a rectangle, `depth_m` deep, in the ground's colors.
pub(super) fn skirt(list: &mut DrawList, border: &Rect, depth_m: f32) {
    let grounds: Vec<DrawItem> = list
        .items
        .iter()
        .filter(|item| item.layer == DepthLayer::Ground && item.feature == FeatureId::GROUND)
        .cloned()
        .collect();
    for item in grounds {
        let mesh = walls(&list.meshes[item.mesh.0 as usize], border, depth_m);
        if mesh.triangles.is_empty() {
            continue;
        }
        let mut material = list.materials[item.material.0 as usize].clone();
        material.two_sided = true;
        let material = list.add_material(material);
        let triangles = 0..mesh.triangles.len() as u32;
        let mesh: MeshId = list.add_mesh(mesh);
        list.items.push(DrawItem { mesh, triangles, material, ..item });
    }
    list.items.sort_by_key(|item| item.layer);
}

fn walls(ground: &DrawMesh, border: &Rect, depth_m: f32) -> DrawMesh {
    let mut walls = DrawMesh::default();
    let is_along = |a: DVec2, b: DVec2| {
        let on = |axis: usize, line: f64| {
            (a[axis] - line).abs() <= ON_BORDER_M && (b[axis] - line).abs() <= ON_BORDER_M
        };
        let beside = border.grown(ON_BORDER_M);
        let is_on = [0, 1].iter().any(|&axis| on(axis, border.min[axis]) || on(axis, border.max[axis]));
        is_on && beside.contains(a) && beside.contains(b)
    };
    for triangle in &ground.triangles {
        for side in 0..3 {
            let [from, to] = [triangle[side], triangle[(side + 1) % 3]];
            if !is_along(plan(ground, from), plan(ground, to)) {
                continue;
            }
            let [from, to] = [from, to].map(|id| ground.vertices[id.index()]);
            let low = |vertex: DrawVertex| {
                let [x, y, z] = vertex.position;
                DrawVertex { position: [x, y, z - depth_m], ..vertex }
            };
            let ids = [from, low(from), low(to), to].map(|vertex| walls.vertex(vertex));
            walls.triangle([ids[0], ids[1], ids[2]]);
            walls.triangle([ids[0], ids[2], ids[3]]);
        }
    }
    walls
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOLE: Rect = Rect { min: DVec2::new(2.0, 3.0), max: DVec2::new(7.0, 9.0) };

    fn pieces(triangle: [Vec3; 3]) -> Vec<[Vec3; 3]> {
        let mut pieces = Vec::new();
        outside(&HOLE, triangle, |corner| *corner, Vec3::lerp, &mut |piece| pieces.push(*piece));
        pieces
    }

    fn area(triangle: &[Vec3; 3]) -> f32 {
        let [a, b, c] = triangle.map(Vec3::truncate);
        (b - a).perp_dot(c - a) / 2.0
    }

    #[test]
    fn a_triangle_around_a_hole_loses_the_area_of_the_hole_and_keeps_its_plane() {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 2.0 * x - y);
        let all = [corner(-20.0, -20.0), corner(40.0, -20.0), corner(-20.0, 60.0)];
        let kept = pieces(all);
        let sum: f32 = kept.iter().map(area).sum();
        assert!((area(&all) - sum - 30.0).abs() < 1e-2, "{sum}");
        for at in kept.iter().flatten() {
            assert!((at.z - (2.0 * at.x - at.y)).abs() < 1e-3, "{at}");
        }
        assert!(kept.iter().all(|piece| area(piece) > -1e-3));
    }

    #[test]
    fn what_is_outside_stays_whole_and_what_is_inside_is_gone() {
        let west = [Vec3::new(0.0, 0.0, 1.0), Vec3::new(2.0, 5.0, 1.0), Vec3::new(0.0, 12.0, 1.0)];
        assert_eq!(pieces(west), [west]);
        let inside = [Vec3::new(3.0, 4.0, 1.0), Vec3::new(5.0, 4.0, 1.0), Vec3::new(4.0, 8.0, 1.0)];
        assert_eq!(pieces(inside).iter().map(area).sum::<f32>(), 0.0);
    }
}
