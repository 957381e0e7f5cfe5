//! Emitters: triangles from the active vertices, one file each.
//!
//! An emitter calls a closure with triples of grid vertices, counter-clockwise seen from above, and does not read heights:
//! the closure of `world::placing` writes the triples into a mesh in world space, others count or collect them.
//!
//! | file | source | from |
//! |---|---|---|
//! | `bintree` | Duchaineau et al. 1997 | active vertices |
//! | `quadtree` | the restricted quadtree of five-vertex nodes; fans | active vertices |
//! | `strips` | triangle strips in the bintree's order | any triangles in order |
//! | `geomipmap` | de Boer 2000, GeoMipMap | a level a patch |
//! | `full` | – | the posts alone |
//!
//! The first three make the same triangles from the same bits. `walk` visits the leaves of a patch's bintree, `part` those of
//! one part of the ground after the other.

pub mod bintree;
pub mod full;
pub mod geomipmap;
pub mod part;
pub mod quadtree;
pub mod strips;
pub mod walk;
pub mod world;

#[cfg(test)]
mod examples {
    //! What the emitters' tests share: grounds, active sets, and triangle sets to compare.

    use glam::DVec2;
    use proptest::prelude::Strategy;

    use crate::active::ActiveSet;
    use crate::emit::{full, world};
    use crate::graph::Vertex;
    use crate::layout::PatchLayout;
    use crate::patched_ground::PatchedGround;
    use sandtable_mesh::trimesh::TriMesh;
    use sandtable_terrain::lattice::Lattice;

    /// Columns, rows and vertices to activate, some of them beyond the borders.
    pub type Activations = (u32, u32, Vec<(i32, i32)>);

    /// Grounds of any shape up to 3 × 3 patches of 16, with up to 60 activations.
    pub fn activations() -> impl Strategy<Value = Activations> {
        (2u32..49, 2u32..49, proptest::collection::vec((0..49i32, 0..49i32), 0..60))
    }

    /// The closure of the listed vertices.
    pub fn active_set(columns: u32, rows: u32, patch: u32, vertices: &[(i32, i32)]) -> ActiveSet {
        let mut active = ActiveSet::new(PatchLayout::new(columns, rows, patch).expect("sound"));
        vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
        active
    }

    /// A wavy ground with cells of 3 × 5 m; the posts listed, modulo their number, have no data.
    pub fn lattice(columns: u32, rows: u32, holes: &[usize]) -> Lattice {
        let mut heights: Vec<f32> =
            (0..columns * rows).map(|index| libm::sinf(index as f32 * 0.37) * 4.0).collect();
        let last = heights.len() - 1;
        // The last post keeps its data: a lattice without any is refused.
        holes.iter().for_each(|hole| heights[hole % last] = f32::NAN);
        Lattice::new(DVec2::ZERO, DVec2::new(3.0, 5.0), columns, heights).expect("sound")
    }

    /// The mesh in world space of what `emit` emits.
    pub fn mesh_of(
        lattice: &Lattice,
        layout: &PatchLayout,
        emit: impl FnOnce(&mut dyn FnMut([Vertex; 3])),
    ) -> TriMesh {
        let mut mesh = TriMesh::default();
        emit(&mut world::placing(PatchedGround { lattice, layout }, &mut mesh));
        mesh
    }

    /// The plan area of the full mesh, square meters.
    pub fn full_area_m2(lattice: &Lattice, layout: &PatchLayout) -> f64 {
        let mesh = mesh_of(lattice, layout, |place| full::triangles(layout, layout.patches(), place));
        sandtable_mesh::check::check(&mesh).expect("the full mesh is conforming").plan_area_m2
    }

    /// The triangles of `emit` as a set: rotated to start at their least corner, in order.
    pub fn sorted(emit: impl FnOnce(&mut dyn FnMut([Vertex; 3]))) -> Vec<[Vertex; 3]> {
        let mut found = Vec::new();
        emit(&mut |corners| found.push(turned(corners)));
        found.sort();
        found
    }

    /// The corners from the least on, in the same sense.
    pub fn turned([a, b, c]: [Vertex; 3]) -> [Vertex; 3] {
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three ways")
    }

    /// Whether two triangles have two corners in common.
    pub fn shares_edge(a: [Vertex; 3], b: [Vertex; 3]) -> bool {
        a.iter().filter(|corner| b.contains(corner)).count() == 2
    }
}
