//! The block under the ground: walls from the edge of the displayed ground down to a level base, so that a terrain seen
//! whole looks like a sand table, not like a sheet in the air.

use glam::{DVec2, Vec2, Vec3};
use rayon::prelude::*;

use crate::dem::answer::Answer;
use crate::draw::color::Srgba;
use crate::draw::list::{DrawMesh, DrawVertex};
use crate::mesh::sink::MeshSink;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};

/// The depth of the base below the lowest ground, as a part of the ground's longer side.
const DEPTH: f64 = 0.02;

/// The wall's color at the ground and at the base: a cut through soil.
const TOP: Srgba = Srgba::opaque(196, 168, 136);
const FOOT: Srgba = Srgba::opaque(132, 110, 90);

/// World Z of the foot of the walls under a ground that is drawn over `bounds`.
pub fn base_z((min, max): (Vec3, Vec3)) -> f32 {
    min.z - (f64::from((max - min).truncate().max_element()) * DEPTH) as f32
}

/// Walls under the border edges of `ground`, a mesh of the displayed heights in `lattice`, down to world Z `base`.
///
/// A border edge gets a wall where there is no ground beyond it: at the lattice's border and around holes, not
/// where a neighboring patch is merely out of view.
pub fn plinth(ground: &DrawMesh, lattice: &Lattice, base: f32) -> DrawMesh {
    let mut walls = DrawMesh::default();
    for (from, to) in border_edges(ground) {
        let along = to.truncate() - from.truncate();
        let Some(outward) = Vec2::new(along.y, -along.x).try_normalize() else {
            continue;
        };
        if !is_ground_beyond(lattice, (from + to).truncate() / 2.0, outward) {
            add_wall(&mut walls, (from, to), base, outward);
        }
    }
    walls
}

/// The edges that belong to one triangle only, ground on their left, in a fixed order.
fn border_edges(mesh: &DrawMesh) -> Vec<(Vec3, Vec3)> {
    let mut edges: Vec<u64> = mesh
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a.0, b.0), (b.0, c.0), (c.0, a.0)])
        .map(|(from, to)| edge_key(from, to))
        .collect();
    edges.par_sort_unstable();
    let at = |index: u64| Vec3::from(mesh.vertices[index as usize].position);
    edges
        .chunk_by(|a, b| a >> 1 == b >> 1)
        .filter(|uses| uses.len() == 1)
        .map(|uses| (uses[0] >> 33, uses[0] >> 1 & 0xffff_ffff, uses[0] & 1 == 1))
        .map(|(low, high, rising)| if rising { (at(low), at(high)) } else { (at(high), at(low)) })
        .collect()
}

/// An edge as one number: its lower vertex, its higher, and whether it runs upward. A mesh of the ground has
/// fewer than 2³¹ vertices, so nothing is lost.
fn edge_key(from: u32, to: u32) -> u64 {
    u64::from(from.min(to)) << 33 | u64::from(from.max(to)) << 1 | u64::from(from < to)
}

fn is_ground_beyond(lattice: &Lattice, middle: Vec2, outward: Vec2) -> bool {
    let step = lattice.cell().min_element() * 0.25;
    let beyond: DVec2 = lattice.origin() + middle.as_dvec2() + outward.as_dvec2() * step;
    matches!(ground_height(lattice, Interpolation::Planar, beyond), Answer::Height(_))
}

fn add_wall(walls: &mut DrawMesh, (from, to): (Vec3, Vec3), base: f32, outward: Vec2) {
    let mut corner = |at: Vec3, color: Srgba| {
        let normal = outward.extend(0.0).to_array();
        walls.vertex(DrawVertex { position: at.to_array(), normal, uv: [0.0; 2], color })
    };
    let corners =
        [corner(from.with_z(base), FOOT), corner(to.with_z(base), FOOT), corner(to, TOP), corner(from, TOP)];
    walls.triangle([corners[0], corners[1], corners[2]]);
    walls.triangle([corners[0], corners[2], corners[3]]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::sink::VertexId;

    /// Two by one cells; the eastern one is left out of the mesh, as if it were out of view.
    fn western_cell(lattice: &Lattice) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        let plan = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let ids: Vec<VertexId> = plan
            .iter()
            .map(|&(column, row)| {
                let position = lattice.position(crate::terrain::lattice::Post { column, row }).extend(5.0);
                mesh.vertex(DrawVertex {
                    position: position.to_array(),
                    normal: [0.0, 0.0, 1.0],
                    uv: [0.0; 2],
                    color: Srgba::WHITE,
                })
            })
            .collect();
        mesh.triangle([ids[0], ids[1], ids[2]]);
        mesh.triangle([ids[0], ids[2], ids[3]]);
        mesh
    }

    #[test]
    fn walls_stand_at_the_world_s_edge_and_face_outward_but_not_at_the_edge_of_view() {
        let lattice =
            Lattice::new(DVec2::new(700.0, 900.0), DVec2::splat(10.0), 3, vec![5.0; 6]).expect("sound");
        let walls = plinth(&western_cell(&lattice), &lattice, 0.0);
        assert_eq!(walls.triangles.len(), 6, "south, west and north");
        for triangle in &walls.triangles {
            let [a, b, c] = triangle.map(|id| Vec3::from(walls.vertices[id.index()].position));
            let normal = Vec3::from(walls.vertices[triangle[0].index()].normal);
            assert!((b - a).cross(c - a).dot(normal) > 0.0, "{a} {b} {c} faces {normal}");
        }
    }
}
