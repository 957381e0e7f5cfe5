//! Leaves out features that do not come near the ground.

use glam::DVec2;
use rayon::prelude::*;

use crate::attributes::Attributes;
use crate::scene_findings::{FeatureTable, SceneFindings};
use crate::sources::Sourced;
use sandtable_geom::polyline::{Polyline, kept};
use sandtable_geom::rect::Rect;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_ribbon::plan::{PlanMesh, PlanVertex};

/// Vertices nearer to each other than this have no direction worth a joint, in meters.
pub const MERGE_M: f64 = 0.01;

/// The lines that a thread looks at in one go.
const LINES: usize = 64;

/// The lines of `table` of which some part lies within `reach_m` of the ground's `extent`, with their attributes; the
/// others, and those that are a single point, are found.
pub fn lines(
    lines: Vec<Sourced<Vec<DVec2>>>,
    extent: &Rect,
    reach_m: f64,
    table: &FeatureTable<'_>,
    findings: &mut SceneFindings,
) -> Vec<(Attributes, Polyline)> {
    let count = lines.len();
    let made = |Sourced { attributes, shape, .. }: Sourced<Vec<DVec2>>| {
        let is_near = Rect::around(shape.iter().copied()).grown(reach_m).meets(extent);
        is_near.then(|| (attributes, Polyline::new(shape, MERGE_M)))
    };
    let made: Vec<(Attributes, Option<Polyline>)> =
        lines.into_par_iter().with_min_len(LINES).filter_map(made).collect();
    let points = made.iter().filter(|(_, line)| line.is_none()).count();
    let near: Vec<_> = made.into_iter().filter_map(|(attributes, line)| Some((attributes, line?))).collect();
    findings.left_out(count - near.len() - points, table, "off the elevation model");
    findings.without_extent(points, table, "all of their points are one place");
    near
}

/// The widths stated for the points of an inline line, at the vertices that are left of it.
pub fn widths_m(stated: Option<&Vec<f64>>, shape: &[DVec2]) -> Option<Vec<f64>> {
    let stated = stated?;
    let widths_m = kept(shape, MERGE_M).into_iter().map(|index| stated.get(index).copied());
    widths_m.collect::<Option<Vec<f64>>>().filter(|widths_m| widths_m.len() >= 2)
}

/// A plan mesh that leaves out triangles that cannot meet the ground.
pub struct Clipped<'a> {
    /// The triangles that are kept.
    pub plan: PlanMesh,
    /// Where the ground is.
    pub extent: &'a Rect,
}

impl MeshSink<PlanVertex> for Clipped<'_> {
    fn vertex(&mut self, vertex: PlanVertex) -> VertexId {
        self.plan.vertex(vertex)
    }

    fn triangle(&mut self, corners: [VertexId; 3]) {
        let reach = Rect::around(corners.map(|id| self.plan.vertices[id.index()].at));
        if reach.meets(self.extent) {
            self.plan.triangle(corners);
        }
    }
}
