//! Coordinates along the two near edges of the block, where a picture shows it as a block on a table; of a grid on a plan,
//! along all four.

use glam::{DVec2, Vec2, Vec3};

use crate::grid::lines::{GroundGrid, GroundLine};
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::nice::{Ticks, format_number, grouped};
use sandtable_annotate::rim::RimMark;
use sandtable_picture::setting::PictureSetting;
use sandtable_picture::shows_table;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// Coordinates along one edge at most: more than these run together.
const MOST_MARKS: usize = 8;

/// Where there is no ground at the border, the block ends further in: it is looked for in steps of this share of the
/// block's longer side, so many times.
const INWARD_STEP: f32 = 0.0025;
const MOST_INWARD: u16 = 60;

/// An edge of the block in plan.
#[derive(Clone, Copy, Debug)]
struct BlockEdge {
    /// 0 where its coordinates are eastings, 1 where they are northings.
    axis: usize,
    /// World X or Y of the edge itself.
    at: f32,
    /// Away from the block.
    outward: Vec3,
}

/// A coordinate on an edge.
struct RimTick {
    /// World X or Y along the edge.
    along: f32,
    figure: CoordinateFigure,
    full: Option<CoordinateFigure>,
}

/// The coordinates along the near edges: where the lines of `grid` meet them or, without one, those of the scene's own
/// system. In plan those of a grid along all edges. None where the block is not on a table.
///
/// At the foot of an edge that faces the eye; at the ground above an edge that does not.
pub fn rim_marks(scene: &SceneModel, camera: &Camera, grid: Option<&GroundGrid>) -> Vec<RimMark> {
    let is_plan = PictureSetting::new(camera, scene.bounds) == PictureSetting::Plan;
    let edges: Vec<BlockEdge> = if shows_table(scene, camera) {
        near_edges(scene, camera).into()
    } else if is_plan && grid.is_some() {
        [(0, false), (0, true), (1, false), (1, true)]
            .map(|(axis, is_at_max)| BlockEdge::new(scene, axis, is_at_max))
            .into()
    } else {
        return Vec::new();
    };
    let marks = edges.iter().enumerate().flat_map(|(number, edge)| {
        let ticks = match grid {
            Some(grid) => grid_ticks(edge, scene, grid),
            None => own_ticks(edge, scene),
        };
        ticks.into_iter().filter_map(|tick| mark((number, edge), tick, scene, camera)).collect::<Vec<_>>()
    });
    marks.collect()
}

impl BlockEdge {
    fn new(scene: &SceneModel, axis: usize, is_at_max: bool) -> Self {
        let ((min, max), across) = (scene.bounds, 1 - axis);
        let mut outward = Vec3::ZERO;
        outward[across] = if is_at_max { 1.0 } else { -1.0 };
        Self { axis, at: if is_at_max { max[across] } else { min[across] }, outward }
    }
}

/// The edge across the view and the one along it that are nearer to the eye; of two equally near, the western.
fn near_edges(scene: &SceneModel, camera: &Camera) -> [BlockEdge; 2] {
    let ahead = camera.forward();
    let is_at_max = [ahead.x < -1e-3, ahead.y < 0.0];
    [0, 1].map(|axis| BlockEdge::new(scene, axis, is_at_max[1 - axis]))
}

/// Round coordinates of the scene's own system.
fn own_ticks(edge: &BlockEdge, scene: &SceneModel) -> Vec<RimTick> {
    let (min, max) = scene.bounds;
    let origin = scene.lattice.origin()[edge.axis];
    let (low, high) = (origin + f64::from(min[edge.axis]), origin + f64::from(max[edge.axis]));
    let ticks = Ticks::new(low, high, MOST_MARKS);
    let tick = |&value: &f64| RimTick {
        along: (value - origin) as f32,
        figure: coordinate(value, ticks.decimals, ["E", "N"][edge.axis]).into(),
        full: None,
    };
    ticks.values.iter().map(tick).collect()
}

/// Where the lines of a grid meet the edge: the first, then those of index lines, so that they stay where there is
/// no place for all.
fn grid_ticks(edge: &BlockEdge, scene: &SceneModel, grid: &GroundGrid) -> Vec<RimTick> {
    let (min, max) = scene.bounds;
    let near = 1e-4 * (max - min).truncate().max_element();
    let meets = |line: &GroundLine| {
        let ends = line.parts.iter().flat_map(|part| [part.first(), part.last()]).flatten();
        let on_edge = |end: &&DVec2| (end[1 - edge.axis] as f32 - edge.at).abs() < near;
        ends.filter(on_edge).map(|end| end[edge.axis] as f32).next()
    };
    let of_axis = grid.lines.iter().filter(|line| line.axis as usize == edge.axis);
    let mut met: Vec<(f32, &GroundLine)> = of_axis.filter_map(|line| Some((meets(line)?, line))).collect();
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    let order = |index: usize| (index > 0, index > 0 && !met[index].1.is_index);
    let mut indices: Vec<usize> = (0..met.len()).collect();
    indices.sort_by_key(|&index| order(index));
    let tick = |index: usize| {
        let (along, line) = met[index];
        RimTick { along, figure: line.figure.clone(), full: Some(line.full.clone()) }
    };
    indices.into_iter().map(tick).collect()
}

fn mark(
    (number, edge): (usize, &BlockEdge),
    tick: RimTick,
    scene: &SceneModel,
    camera: &Camera,
) -> Option<RimMark> {
    let (min, max) = scene.bounds;
    let side_m = (max - min).truncate().max_element();
    let ground = FullResolution { lattice: scene.ground().lattice() };
    let mut border = Vec3::splat(edge.at);
    border[edge.axis] = tick.along;
    let inward = |step: u16| border - edge.outward * (side_m * (f32::from(step) * INWARD_STEP + 1e-5));
    let (at, ground_z) = (0..MOST_INWARD)
        .map(inward)
        .find_map(|at| Some((at, ground.displayed_z(at.truncate().as_dvec2())? as f32)))?;
    let foot = at.with_z(base_z(scene.bounds));
    let faces_eye = edge.outward.dot(camera.toward_eye(foot)) > 0.0;
    let at = if faces_eye { foot } else { at.with_z(ground_z) };
    let step = edge.outward * side_m * 0.01;
    let [here, beyond] = [at, at + step].map(|point| camera.project(point).map(|seen| seen.pixel));
    let (at_px, outward): (Vec2, Vec2) = (here?, beyond? - here?);
    Some(RimMark { at_px, outward, figure: tick.figure, full: tick.full.map(|full| (full, number)) })
}

/// A coordinate with its thousands apart, such as `4 650 000 N`.
fn coordinate(value: f64, decimals: usize, letter: &str) -> String {
    format!("{} {letter}", grouped(&format_number(value, decimals)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_have_their_thousands_apart() {
        assert_eq!(coordinate(4_650_000.0, 0, "N"), "4 650 000 N");
        assert_eq!(coordinate(-500.0, 0, "E"), "−500 E");
        assert_eq!(coordinate(1000.5, 1, "E"), "1 000.5 E");
    }
}
