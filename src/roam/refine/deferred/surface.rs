//! The displayed triangles of a deferred mesh as a surface for features: only the listed patches, as they were updated
//! last.

use glam::{DVec2, Vec3};

use crate::block::BlockSource;
use crate::graph::Vertex;
use crate::refine::deferred::Deferred;
use crate::refine::deferred::patch::PatchMesh;
use crate::refine::deferred::topology::{NONE, Topology, triangle};
use sandtable_geom::rect::Rect;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// The displayed triangles of the listed patches.
pub struct DeferredSurface<'a, S> {
    mesh: &'a Deferred<S>,
    /// Meters between posts, eastward and northward.
    cell: DVec2,
    /// One a patch, in the layout's order.
    listed: Vec<bool>,
}

impl<'a, S: BlockSource> DeferredSurface<'a, S> {
    /// The surface of the patches that `mesh` listed last; `cell` is meters between posts, eastward and northward.
    pub fn new(mesh: &'a Deferred<S>, cell: DVec2) -> Self {
        let mut listed = vec![false; mesh.layout.patch_count()];
        mesh.visible.iter().for_each(|&corner| listed[mesh.layout.patch_index(corner)] = true);
        Self { mesh, cell, listed }
    }

    /// The surface of all patches, as they were updated last.
    pub fn everywhere(mesh: &'a Deferred<S>, cell: DVec2) -> Self {
        Self { mesh, cell, listed: vec![true; mesh.layout.patch_count()] }
    }

    /// Calls `visit` with every displayed triangle of a listed patch that meets the rectangle.
    fn visit_patch(&self, corner: Vertex, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        let topology = self.mesh.topology(corner);
        let Some(mesh) = self.mesh.mesh(corner) else {
            let position = |&number: &u16| self.mesh.corner_position(corner, number);
            for root in topology.roots() {
                let facet = [position(&root[0]), position(&root[1]), position(&root[2])];
                if facet.iter().all(|at| !at.z.is_nan()) && plan_bounds(&facet).meets(rect) {
                    visit(&facet);
                }
            }
            return;
        };
        let descent = FacetDescent { mesh, topology, rect };
        for &root in topology.roots() {
            let facet = root.map(|number| position(mesh, topology, number));
            descent.visit(triangle(root[0], 0), root, facet, visit);
        }
    }
}

/// A way down the bintree of a patch to the displayed triangles that meet a rectangle.
struct FacetDescent<'a> {
    mesh: &'a PatchMesh,
    topology: &'a Topology,
    rect: &'a Rect,
}

impl FacetDescent<'_> {
    /// Visits what is displayed of the triangle `at` with these corners, apex first, counter-clockwise.
    fn visit(
        &self,
        at: u32,
        corners: [u16; 3],
        facet: SurfaceTriangle,
        visit: &mut dyn FnMut(&SurfaceTriangle),
    ) {
        if !plan_bounds(&facet).meets(self.rect) {
            return;
        }
        let middle = self.topology.middle(at);
        if middle == NONE || !self.mesh.is_active(middle) {
            if self.mesh.is_displayed(self.topology, corners) {
                visit(&facet);
            }
            return;
        }
        let side = usize::from(self.topology.nodes()[middle as usize].ring[3] == corners[0]);
        let split = position(self.mesh, self.topology, middle);
        let half =
            |[of, next]: [usize; 2]| ([middle, corners[of], corners[next]], [split, facet[of], facet[next]]);
        for (half, (corners, facet)) in [(1, half([0, 1])), (0, half([2, 0]))] {
            self.visit(triangle(middle, 2 * side + half), corners, facet, visit);
        }
    }
}

fn position(mesh: &PatchMesh, topology: &Topology, number: u16) -> Vec3 {
    let [x, y, z, _] = mesh.sphere(topology, number);
    Vec3::new(x, y, z)
}

fn plan_bounds(facet: &SurfaceTriangle) -> Rect {
    let [a, b, c] = facet.map(Vec3::truncate);
    Rect { min: a.min(b).min(c).as_dvec2(), max: a.max(b).max(c).as_dvec2() }
}

impl<S: BlockSource + Send + Sync> TriangleSurface for DeferredSurface<'_, S> {
    fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&SurfaceTriangle)) {
        let layout = &self.mesh.layout;
        let side = f64::from(layout.patch()) * self.cell;
        // World positions are f32: a patch's own corner may round past its f64 border.
        let grown = rect.grown(1e-6 * side.max_element());
        let (first, last) = ((grown.min / side).floor(), (grown.max / side).floor());
        layout
            .patches_within((first.x as i32, first.y as i32), (last.x as i32, last.y as i32))
            .filter(|&corner| self.listed[layout.patch_index(corner)])
            .for_each(|corner| self.visit_patch(corner, rect, visit));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::displayed::DisplayedTerrain;
    use crate::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
    use sandtable_terrain::lattice::Lattice;

    fn facets(surface: &dyn TriangleSurface, rect: &Rect) -> BTreeSet<[[u32; 3]; 3]> {
        let mut seen = BTreeSet::new();
        surface.visit_facets(rect, &mut |facet| {
            let mut key = facet.map(|corner| corner.to_array().map(f32::to_bits));
            key.sort_unstable();
            assert!(seen.insert(key), "{facet:?} twice");
        });
        seen
    }

    /// A mesh over 45 × 37 posts, of which one has no data.
    fn waves(hole: usize) -> (Arc<Lattice>, Deferred<DynamicTerrain>) {
        let mut heights: Vec<f32> = (0..45 * 37).map(|at| libm::sinf(at as f32 * 0.31) * 9.0).collect();
        heights[hole] = f32::NAN;
        let lattice = Arc::new(Lattice::new(DVec2::ZERO, DVec2::new(4.0, 5.0), 45, heights).expect("sound"));
        let options =
            DynamicOptions { patch: 16, measure: ErrorMeasure::Exact, radius: Radius::Bounding, reach: 3.0 };
        let terrain = DynamicTerrain::new(Arc::clone(&lattice), options).expect("sound");
        let mesh = Deferred::new(terrain, 4.0).expect("small patches");
        (lattice, mesh)
    }

    /// The box around a triangle of [`facets`].
    fn bounds(facet: &[[u32; 3]; 3]) -> Rect {
        plan_bounds(&facet.map(|corner| Vec3::from_array(corner.map(f32::from_bits))))
    }

    proptest! {
        #[test]
        fn what_an_update_changes_lies_in_its_changed_areas(
            from in (-0.2..1.2f32, -0.2..1.2f32, 0.0..60.0f32),
            to in (-0.2..1.2f32, -0.2..1.2f32, 0.0..60.0f32),
            hole in 0usize..45 * 37,
        ) {
            let (lattice, mut mesh) = waves(hole);
            let all: Vec<Vertex> = mesh.source().layout().patches().collect();
            let whole = lattice.extent().grown(1.0);
            let mut seen = Vec::new();
            for (x, y, z) in [from, to] {
                mesh.update(Vec3::new(x * 180.0, y * 185.0, z), &all).expect("in memory");
                seen.push(facets(&DeferredSurface::new(&mesh, lattice.cell()), &whole));
            }
            let areas: Vec<Rect> = (0..all.len()).flat_map(|patch| mesh.changed_areas(patch)).collect();
            for facet in seen[0].symmetric_difference(&seen[1]) {
                let bounds = bounds(facet);
                let holds = |area: &Rect| area.min.cmple(bounds.min).all() && bounds.max.cmple(area.max).all();
                prop_assert!(areas.iter().any(holds), "{bounds:?} is in none of {areas:?}");
            }
        }

        #[test]
        fn the_surface_is_the_mesh_of_its_active_vertices(
            x in -0.2..1.2f32, y in -0.2..1.2f32, z in 0.0..300.0f32, hole in 0usize..45 * 37,
        ) {
            let (lattice, mut mesh) = waves(hole);
            let listed: Vec<Vertex> = mesh.source().layout().patches().skip(1).collect();
            mesh.update(Vec3::new(x * 180.0, y * 185.0, z), &listed).expect("in memory");
            let whole = lattice.extent().grown(1.0);
            let displayed = DisplayedTerrain::new(Arc::clone(&lattice), mesh.active_set(), listed.clone());
            let surface = DeferredSurface::new(&mesh, lattice.cell());
            let shown = facets(&surface, &whole);
            prop_assert_eq!(&shown, &facets(&displayed, &whole));
            let at: usize = listed.iter().map(|&corner| mesh.local_triangles(corner).len()).sum();
            prop_assert_eq!(at, shown.len());
        }
    }
}
