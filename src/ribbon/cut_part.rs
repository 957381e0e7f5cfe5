//! One ribbon's part in a patch, cut to the ground triangle by triangle, so that pieces that still fit are kept.

use std::sync::Arc;

use crate::drape::Draper;
use crate::plan::{PlanMesh, PlanVertex};
use sandtable_draw::list::DrawMesh;
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// A part cut to the ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CutPart {
    /// Shared with what shows it, which knows it by its memory.
    mesh: Arc<DrawMesh>,
    /// The numbers of vertices and triangles in `mesh` up to the end of each triangle of the part.
    ends: Vec<[u32; 2]>,
}

impl CutPart {
    /// `plan` cut to the ground.
    pub fn of(plan: &PlanMesh, ground: &dyn TriangleSurface) -> Self {
        Self::default().renewed(plan, ground, |_| true)
    }

    /// This cut of `plan`, cut again where the displayed triangles have changed, which is within `areas`; `None` where no
    /// part of it lies there. The same as [`CutPart::of`], bit for bit.
    pub fn recut(&self, plan: &PlanMesh, ground: &dyn TriangleSurface, areas: &[Rect]) -> Option<Self> {
        let is_stale = |corners: [PlanVertex; 3]| {
            let bounds = bounds(corners);
            areas.iter().any(|area| area.meets(&bounds))
        };
        plan.corners().any(is_stale).then(|| self.renewed(plan, ground, is_stale))
    }

    /// The triangles.
    pub fn mesh(&self) -> &Arc<DrawMesh> {
        &self.mesh
    }

    fn renewed(
        &self,
        plan: &PlanMesh,
        ground: &dyn TriangleSurface,
        is_stale: impl Fn([PlanVertex; 3]) -> bool,
    ) -> Self {
        let mut draper = Draper::default();
        let mut mesh = DrawMesh {
            vertices: Vec::with_capacity(self.mesh.vertices.len()),
            triangles: Vec::with_capacity(self.mesh.triangles.len()),
        };
        let mut ends = Vec::with_capacity(plan.triangles.len());
        for (at, corners) in plan.corners().enumerate() {
            if is_stale(corners) {
                draper.lay(corners, ground, &mut mesh);
            } else {
                self.copy(at, &mut mesh);
            }
            ends.push([mesh.vertices.len() as u32, mesh.triangles.len() as u32]);
        }
        Self { mesh: Arc::new(mesh), ends }
    }

    /// Copies what was cut of one triangle of the part.
    fn copy(&self, at: usize, sink: &mut DrawMesh) {
        let [from, end] = [at.checked_sub(1).map_or([0; 2], |before| self.ends[before]), self.ends[at]]
            .map(|[vertices, triangles]| [vertices as usize, triangles as usize]);
        let first = sink.vertices.len();
        let moved = |id: VertexId| VertexId::new(id.index() - from[0] + first);
        sink.vertices.extend_from_slice(&self.mesh.vertices[from[0]..end[0]]);
        self.mesh.triangles[from[1]..end[1]].iter().for_each(|corners| sink.triangle(corners.map(moved)));
    }
}

/// The box around a triangle.
pub(super) fn bounds(corners: [PlanVertex; 3]) -> Rect {
    Rect::around(corners.map(|corner| corner.at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, Vec2, Vec3};
    use proptest::prelude::*;

    /// A square of two triangles a cell, 8 × 8 cells of 10 m; the cells in `fine` have four.
    struct Checkers<'a> {
        fine: &'a [bool],
    }

    impl TriangleSurface for Checkers<'_> {
        fn visit_facets(&self, rect: &Rect, visit: &mut dyn FnMut(&[Vec3; 3])) {
            for (cell, &is_fine) in self.fine.iter().enumerate() {
                let south_west = DVec2::new((cell % 8) as f64, (cell / 8) as f64) * 10.0;
                let corner = |east: f64, north: f64| {
                    let at = (south_west + DVec2::new(east, north)).as_vec2();
                    at.extend((at.x * 0.3).sin() * 5.0 + if is_fine && east == 5.0 { 2.0 } else { 0.0 })
                };
                let ring = [corner(0.0, 0.0), corner(10.0, 0.0), corner(10.0, 10.0), corner(0.0, 10.0)];
                let facets = if is_fine {
                    let middle = corner(5.0, 5.0);
                    (0..4).map(|side| [middle, ring[side], ring[(side + 1) % 4]]).collect()
                } else {
                    vec![[ring[0], ring[1], ring[2]], [ring[0], ring[2], ring[3]]]
                };
                let own = Rect { min: south_west, max: south_west + 10.0 };
                facets.iter().filter(|_| own.meets(rect)).for_each(&mut *visit);
            }
        }

        fn displayed_z(&self, _: DVec2) -> Option<f64> {
            None
        }
    }

    proptest! {
        #[test]
        fn a_part_cut_again_where_the_ground_changed_is_the_part_cut_anew(
            before in proptest::collection::vec(any::<bool>(), 64),
            changed in proptest::collection::btree_set(0usize..64, 0..5),
            line in proptest::collection::vec((0.0..80.0f64, 0.0..80.0f64), 3..12),
        ) {
            let mut plan = PlanMesh::default();
            let ids: Vec<VertexId> = line
                .iter()
                .map(|&(x, y)| plan.vertex(PlanVertex { at: DVec2::new(x, y), uv: Vec2::ZERO }))
                .collect();
            for corners in ids.windows(3) {
                let [a, b, c] = [0, 1, 2].map(|at| plan.vertices[corners[at].index()].at);
                let left = (b - a).perp_dot(c - a) > 0.0;
                plan.triangle(if left { [corners[0], corners[1], corners[2]] } else { [corners[0], corners[2], corners[1]] });
            }
            let mut after = before.clone();
            changed.iter().for_each(|&cell| after[cell] = !after[cell]);
            let areas: Vec<Rect> = changed
                .iter()
                .map(|cell| DVec2::new((cell % 8) as f64, (cell / 8) as f64) * 10.0)
                .map(|min| Rect { min, max: min + 10.0 })
                .collect();
            let first = CutPart::of(&plan, &Checkers { fine: &before });
            let anew = CutPart::of(&plan, &Checkers { fine: &after });
            let again = first.recut(&plan, &Checkers { fine: &after }, &areas).unwrap_or(first);
            prop_assert_eq!(again, anew);
        }
    }
}
