//! From bits to triangles: the bintree read off an active set.

use std::sync::Arc;

use glam::Vec3;

use crate::geom::rect::Rect;
use crate::mesh::sink::{MeshSink, VertexId};
use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::graph::Vertex;
use crate::terrain::facets::{Facet, Facets};
use crate::terrain::lattice::{Lattice, Post};

/// A displayed terrain: the ground and the bits that say how finely it is shown.
#[derive(Clone, Debug)]
pub struct DisplayedTerrain {
    lattice: Arc<Lattice>,
    active: ActiveSet,
    exaggeration: f32,
    patches: Vec<Vertex>,
    shown: Vec<bool>,
}

impl DisplayedTerrain {
    /// The terrain that `active` shows of `lattice`, heights drawn times `exaggeration`, in the patches whose
    /// south-west corners are listed.
    pub fn new(lattice: Arc<Lattice>, active: ActiveSet, exaggeration: f32, patches: Vec<Vertex>) -> Self {
        let mut shown = vec![false; active.layout().patch_count()];
        for &corner in &patches {
            shown[active.layout().patch_index(corner)] = true;
        }
        Self { lattice, active, exaggeration, patches, shown }
    }

    /// The bits.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// Writes the displayed triangles to `sink`, one vertex a post, counter-clockwise seen from above.
    pub fn emit(&self, sink: &mut impl MeshSink<Vec3>) {
        let mut ids: Vec<Option<VertexId>> = vec![None; self.lattice.heights().len()];
        for triangle in self.patches.iter().flat_map(|&corner| self.leaves(corner)) {
            let Some(posts) = self.drawn_posts(&triangle) else {
                continue;
            };
            let corners = posts.map(|post| {
                *ids[self.lattice.index(post)].get_or_insert_with(|| sink.vertex(self.position(post)))
            });
            sink.triangle(corners);
        }
    }

    /// The leaf triangles of one patch.
    fn leaves(&self, corner: Vertex) -> impl Iterator<Item = Triangle> {
        let mut stack: Vec<Triangle> = Triangle::roots(corner, self.active.layout().patch()).to_vec();
        std::iter::from_fn(move || {
            while let Some(triangle) = stack.pop() {
                if self.is_leaf(&triangle) {
                    return Some(triangle);
                }
                stack.extend(triangle.split());
            }
            None
        })
    }

    fn is_leaf(&self, triangle: &Triangle) -> bool {
        triangle.is_finest() || !self.active.is_active(triangle.split_vertex())
    }

    /// The posts of a leaf; `None` where it lies beyond the border or over no data.
    fn drawn_posts(&self, triangle: &Triangle) -> Option<[Post; 3]> {
        let posts = triangle.corners().map(|vertex| self.active.layout().post(vertex));
        let [a, b, c] = posts.map(|post| (i64::from(post.column), i64::from(post.row)));
        let doubled_area = (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
        let has_data = posts.iter().all(|&post| !self.lattice.height(post).is_nan());
        (doubled_area != 0 && has_data).then_some(posts)
    }

    fn position(&self, post: Post) -> Vec3 {
        self.lattice.position(post).extend(self.lattice.height(post) * self.exaggeration)
    }

    fn plan_bounds(&self, triangle: &Triangle) -> Rect {
        let corner = |vertex| self.lattice.position(self.active.layout().post(vertex)).as_dvec2();
        Rect::around(triangle.corners().map(corner))
    }

    /// The patches, of those displayed, that meet the world rectangle.
    fn patches_meeting(&self, rect: &Rect) -> impl Iterator<Item = Vertex> {
        let layout = self.active.layout();
        let side = f64::from(layout.patch()) * self.lattice.cell();
        // World positions are f32: a patch's own corner may round past its f64 border.
        let rect = rect.grown(1e-6 * side.max_element());
        let (first, last) = ((rect.min / side).floor(), (rect.max / side).floor());
        layout
            .patches_within((first.x as i32, first.y as i32), (last.x as i32, last.y as i32))
            .filter(|&corner| self.shown[layout.patch_index(corner)])
    }
}

impl Facets for DisplayedTerrain {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&Facet)) {
        let mut stack = Vec::new();
        for corner in self.patches_meeting(rect) {
            stack.extend(Triangle::roots(corner, self.active.layout().patch()));
            while let Some(triangle) = stack.pop() {
                if !self.plan_bounds(&triangle).meets(rect) {
                    continue;
                }
                if !self.is_leaf(&triangle) {
                    stack.extend(triangle.split());
                } else if let Some(posts) = self.drawn_posts(&triangle) {
                    visit(&posts.map(|post| self.position(post)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check;
    use crate::mesh::trimesh::TriMesh;
    use crate::roam::layout::Layout;
    use glam::DVec2;
    use proptest::prelude::*;

    fn lattice(columns: u32, rows: u32, holes: &[usize]) -> Arc<Lattice> {
        let mut heights: Vec<f32> =
            (0..columns * rows).map(|index| libm::sinf(index as f32 * 0.37) * 4.0).collect();
        for &hole in holes {
            heights[hole % (columns * rows) as usize] = f32::NAN;
        }
        Arc::new(Lattice::new(DVec2::ZERO, DVec2::new(3.0, 5.0), columns, heights).expect("sound"))
    }

    fn emitted(terrain: &DisplayedTerrain) -> TriMesh {
        let mut mesh = TriMesh::default();
        terrain.emit(&mut mesh);
        mesh
    }

    proptest! {
        #[test]
        fn whatever_is_active_the_mesh_is_conforming_and_covers_the_ground(
            columns in 2u32..70, rows in 2u32..70,
            vertices in proptest::collection::vec((0..96i32, 0..96i32), 0..60),
        ) {
            let layout = Layout::new(columns, rows, 16).expect("sound");
            let mut active = ActiveSet::new(layout);
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            let lattice = lattice(columns, rows, &[]);
            let area = lattice.extent().size().x * lattice.extent().size().y;
            let terrain = DisplayedTerrain::new(lattice, active, 2.0, layout.patches().collect());
            prop_assert_eq!(check::check_with_area(&emitted(&terrain), area).err(), None);
        }

        #[test]
        fn a_point_lies_on_one_facet_and_its_height_is_that_of_the_mesh(
            vertices in proptest::collection::vec((0..48i32, 0..48i32), 0..30),
            x in 0.0..1.0f64, y in 0.0..1.0f64,
        ) {
            let layout = Layout::new(41, 37, 16).expect("sound");
            let mut active = ActiveSet::new(layout);
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            let lattice = lattice(41, 37, &[]);
            let at = DVec2::new(x, y) * lattice.extent().max;
            let terrain = DisplayedTerrain::new(lattice, active, 1.0, layout.patches().collect());
            let mut strictly_inside = 0;
            terrain.visit_facets(&Rect { min: at, max: at }, &mut |facet| {
                strictly_inside += usize::from(crate::terrain::facets::facet_contains(facet, at));
            });
            prop_assert!((1..=6).contains(&strictly_inside), "{} facets", strictly_inside);
            prop_assert!(terrain.displayed_z(at).is_some());
        }
    }

    #[test]
    fn fully_refined_ground_leaves_out_just_the_triangles_at_a_hole() {
        let layout = Layout::new(17, 17, 16).expect("sound");
        let lattice = lattice(17, 17, &[8 * 17 + 8]);
        let errors = crate::roam::errors::ErrorMap::exact(&lattice, &layout);
        let criterion = crate::roam::criterion::flat::Flat::new(&layout, &errors, 0.0);
        let active = crate::roam::refine::rebuild::rebuild(&layout, &criterion, layout.patches());
        let terrain = DisplayedTerrain::new(Arc::clone(&lattice), active, 1.0, layout.patches().collect());
        let mesh = emitted(&terrain);
        assert_eq!(mesh.triangles.len(), 2 * 16 * 16 - 8);
        check::check(&mesh).expect("conforming round the hole");
    }
}
