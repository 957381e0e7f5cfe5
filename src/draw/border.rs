//! The border of a mesh: the edges that one triangle alone has.

use glam::Vec3;
use rayon::prelude::*;

use crate::list::DrawMesh;

/// Returns the edges that belong to one triangle only, its inside on their left, in a fixed order.
///
/// `mesh` has fewer than 2³¹ vertices. Costs a sort of three numbers a triangle.
pub fn border_edges(mesh: &DrawMesh) -> Vec<(Vec3, Vec3)> {
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

/// An edge as one number: its lower vertex, its higher, and whether it runs upward.
fn edge_key(from: u32, to: u32) -> u64 {
    u64::from(from.min(to)) << 33 | u64::from(from.max(to)) << 1 | u64::from(from < to)
}
