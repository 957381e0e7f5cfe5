//! The border of a mesh: the edges that one triangle alone has.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use rayon::iter::repeat_n;
use rayon::prelude::*;

use crate::list::DrawMesh;
use sandtable_base::split_mix::split_mix64;
use sandtable_mesh::sink::VertexId;

/// Returns the edges that belong to one triangle only, its inside on their left, in a fixed order.
///
/// `mesh` has fewer than 2³¹ vertices. Costs eight bytes a vertex and two passes over the triangles.
pub fn border_edges(mesh: &DrawMesh) -> Vec<(Vec3, Vec3)> {
    let ends = BorderEnds::new(mesh);
    let edges_of = |&[a, b, c]: &[VertexId; 3]| {
        let edges = [(a.0, b.0), (b.0, c.0), (c.0, a.0)].into_iter();
        edges.filter(|&(from, to)| ends.holds(from) && ends.holds(to)).map(|(from, to)| edge_key(from, to))
    };
    let mut edges: Vec<u64> = mesh.triangles.par_iter().flat_map_iter(edges_of).collect();
    edges.par_sort_unstable();
    let at = |index: u64| Vec3::from(mesh.vertices[index as usize].position);
    edges
        .chunk_by(|a, b| a >> 1 == b >> 1)
        .filter(|uses| uses.len() == 1)
        .map(|uses| (uses[0] >> 33, uses[0] >> 1 & 0xffff_ffff, uses[0] & 1 == 1))
        .map(|(low, high, rising)| if rising { (at(low), at(high)) } else { (at(high), at(low)) })
        .collect()
}

/// The vertices at which an edge of one triangle alone ends, and seldom others.
///
/// ```text
///        d───c         a vertex sums, over its triangles, a number of the corner after it less one of the corner before:
///       ╱ ╲ ╱ ╲        around v  (a − b) + (b − c) + … = 0; at the border the first and the last of them are left
///      e───v───b
///       ╲ ╱ ╲ ╱
///        f───a
/// ```
///
/// With random numbers of 64 bits no other sum is 0 in practice.
struct BorderEnds(Vec<AtomicU64>);

impl BorderEnds {
    fn new(mesh: &DrawMesh) -> Self {
        let sums: Vec<AtomicU64> = repeat_n(0, mesh.vertices.len()).map(AtomicU64::new).collect();
        mesh.triangles.par_iter().for_each(|corners| {
            let [a, b, c] = corners.map(|corner| mixed(corner.0));
            for (corner, (after, before)) in corners.iter().zip([(b, c), (c, a), (a, b)]) {
                sums[corner.index()].fetch_add(after.wrapping_sub(before), Ordering::Relaxed);
            }
        });
        Self(sums)
    }

    fn holds(&self, vertex: u32) -> bool {
        self.0[vertex as usize].load(Ordering::Relaxed) != 0
    }
}

/// A number for each vertex that looks random.
fn mixed(vertex: u32) -> u64 {
    split_mix64(u64::from(vertex) + 1)
}

/// An edge as one number: its lower vertex, its higher, and whether it runs upward.
fn edge_key(from: u32, to: u32) -> u64 {
    u64::from(from.min(to)) << 33 | u64::from(from.max(to)) << 1 | u64::from(from < to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Srgba;
    use crate::list::DrawVertex;
    use std::collections::BTreeMap;

    const SIDE: u32 = 40;

    /// A grid with holes, some of which meet at a corner.
    fn sieve() -> DrawMesh {
        let mut mesh = DrawMesh::default();
        mesh.vertices.extend((0..SIDE * SIDE).map(|at| DrawVertex {
            position: [(at % SIDE) as f32, (at / SIDE) as f32, 0.0],
            normal: [0.0, 0.0, 1.0],
            uv: [0.0; 2],
            color: Srgba::WHITE,
        }));
        for at in (0..SIDE * (SIDE - 1)).filter(|at| at % SIDE + 1 < SIDE && !mixed(*at).is_multiple_of(5)) {
            let [a, b, c, d] = [at, at + 1, at + SIDE + 1, at + SIDE].map(VertexId);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
        mesh
    }

    #[test]
    fn the_border_is_made_of_the_edges_that_are_used_once() {
        let mesh = sieve();
        let mut uses: BTreeMap<[u32; 2], Vec<[u32; 2]>> = BTreeMap::new();
        for [a, b, c] in mesh.triangles.iter().map(|corners| corners.map(|corner| corner.0)) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                uses.entry([from.min(to), from.max(to)]).or_default().push([from, to]);
            }
        }
        let at = |index: u32| Vec3::from(mesh.vertices[index as usize].position);
        let expected: Vec<_> = uses
            .into_values()
            .filter(|uses| uses.len() == 1)
            .map(|uses| uses[0].map(at))
            .map(|[from, to]| (from, to))
            .collect();
        assert!(expected.len() > 4 * SIDE as usize);
        assert_eq!(border_edges(&mesh), expected);
        let inside = (0..SIDE * SIDE).filter(|&vertex| !BorderEnds::new(&mesh).holds(vertex));
        assert!(inside.count() > 100, "vertices inside are passed over");
    }
}
