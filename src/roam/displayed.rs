//! The displayed terrain: the mesh of the bits, and a surface for features.

use std::sync::Arc;

use glam::Vec3;

use crate::active::ActiveSet;
use crate::emit::{bintree, world};
use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::MeshSink;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// A displayed terrain: a lattice and the active vertices.
#[derive(Clone, Debug)]
pub struct DisplayedTerrain {
    lattice: Arc<Lattice>,
    active: ActiveSet,
    patches: Vec<Vertex>,
    shown: Vec<bool>,
}

impl DisplayedTerrain {
    /// The terrain that `active` shows of `lattice` in the patches whose south-west corners are listed.
    pub fn new(lattice: Arc<Lattice>, active: ActiveSet, patches: Vec<Vertex>) -> Self {
        let mut shown = vec![false; active.layout().patch_count()];
        for &corner in &patches {
            shown[active.layout().patch_index(corner)] = true;
        }
        Self { lattice, active, patches, shown }
    }

    /// The active vertices.
    pub fn active(&self) -> &ActiveSet {
        &self.active
    }

    /// Writes the displayed triangles to `sink`, one vertex a post, counter-clockwise seen from above.
    pub fn emit(&self, sink: &mut impl MeshSink<Vec3>) {
        bintree::triangles(&self.active, self.patches.iter().copied(), world::placing(self.ground(), sink));
    }

    #[inline]
    fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: self.active.layout() }
    }

    /// The rectangle around a triangle; called for every triangle that a walk comes to.
    #[inline]
    fn plan_bounds(&self, [apex, entry, exit]: [Vertex; 3]) -> Rect {
        let ground = self.ground();
        let (a, b, c) = (ground.plan(apex), ground.plan(entry), ground.plan(exit));
        Rect { min: a.min(b).min(c).as_dvec2(), max: a.max(b).max(c).as_dvec2() }
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

impl TriangleSurface for DisplayedTerrain {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        let ground = self.ground();
        for corner in self.patches_meeting(rect) {
            let meets = |corners| self.plan_bounds(corners).meets(rect);
            bintree::triangles_where(&self.active, corner, meets, |corners| {
                if let Some([apex, entry, exit]) = world::drawn_posts(ground, corners) {
                    let at = |post| world::position(ground, post);
                    visit(&[at(apex), at(entry), at(exit)]);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::PatchLayout;
    use glam::DVec2;
    use proptest::prelude::*;
    use sandtable_mesh::check;
    use sandtable_mesh::trimesh::TriMesh;

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
            let layout = PatchLayout::new(columns, rows, 16).expect("sound");
            let mut active = ActiveSet::new(layout);
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            let lattice = lattice(columns, rows, &[]);
            let area = lattice.extent().size().x * lattice.extent().size().y;
            let terrain = DisplayedTerrain::new(lattice, active, layout.patches().collect());
            prop_assert_eq!(check::check_with_area(&emitted(&terrain), area).err(), None);
        }

        #[test]
        fn a_point_lies_on_one_facet_and_its_height_is_that_of_the_mesh(
            vertices in proptest::collection::vec((0..48i32, 0..48i32), 0..30),
            x in 0.0..1.0f64, y in 0.0..1.0f64,
        ) {
            let layout = PatchLayout::new(41, 37, 16).expect("sound");
            let mut active = ActiveSet::new(layout);
            vertices.iter().for_each(|&(x, y)| active.activate(Vertex::new(x, y)));
            let lattice = lattice(41, 37, &[]);
            let at = DVec2::new(x, y) * lattice.extent().max;
            let terrain = DisplayedTerrain::new(lattice, active, layout.patches().collect());
            let mut strictly_inside = 0;
            terrain.visit_facets(&Rect { min: at, max: at }, &mut |facet| {
                strictly_inside += usize::from(sandtable_terrain::triangle_surface::facet_contains(facet, at));
            });
            prop_assert!((1..=6).contains(&strictly_inside), "{} facets", strictly_inside);
            prop_assert!(terrain.displayed_z(at).is_some());
        }
    }

    #[test]
    fn fully_refined_ground_leaves_out_just_the_triangles_at_a_hole() {
        let layout = PatchLayout::new(17, 17, 16).expect("sound");
        let lattice = lattice(17, 17, &[8 * 17 + 8]);
        let errors = crate::errors::ErrorMap::exact(&lattice, &layout);
        let criterion = crate::criterion::flat::Flat::new(&layout, &errors, 0.0);
        let active = crate::refine::rebuild::rebuild(&layout, &criterion, layout.patches());
        let terrain = DisplayedTerrain::new(Arc::clone(&lattice), active, layout.patches().collect());
        let mesh = emitted(&terrain);
        assert_eq!(mesh.triangles.len(), 2 * 16 * 16 - 8);
        check::check(&mesh).expect("conforming round the hole");
    }
}
