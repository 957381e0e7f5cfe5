//! Coordinates along the two near edges of the block, where a picture shows it as a block on a table; of a grid on a plan,
//! wherever a line leaves the ground.

use glam::{DVec2, Vec2, Vec3};

use crate::grid::lines::{GroundGrid, GroundLine};
use crate::line_end::{GroundEnd, ground_end};
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::GridAxis;
use sandtable_annotate::nice::{Ticks, format_number, grouped};
use sandtable_annotate::rim::RimMark;
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_picture::setting::PictureSetting;
use sandtable_picture::shows_table;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// Coordinates along one edge at most: more than these run together.
const MOST_MARKS: usize = 8;

/// A tick reaches from the block by this share of its longer side, before it is drawn at its own length.
const BEYOND: f32 = 0.01;

/// How near to an edge a line ends on it, of the longer side of the block.
const ON_EDGE: f64 = 1e-6;

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

/// A coordinate at the end of a line.
struct RimTick {
    /// The line among those of the grid.
    line: Option<usize>,
    /// World Z at the line's end is that of the ground there.
    end: GroundEnd,
    figure: CoordinateFigure,
    /// The full coordinate, and the row of marks.
    full: Option<(CoordinateFigure, usize)>,
}

/// What the ends of lines are looked for on.
struct RimGround<'a> {
    scene: &'a SceneModel,
    nested: &'a NestedHeights,
}

/// The coordinates along the near edges: where the lines of `grid` that meet them leave the ground or, without one, those of
/// the scene's own system. In plan those of a grid along all edges. None where the block is not on a table.
///
/// At the foot of an edge that faces the eye; at the ground above an edge that does not.
pub fn rim_marks(
    scene: &SceneModel,
    nested: &NestedHeights,
    camera: &Camera,
    grid: Option<&GroundGrid>,
) -> Vec<RimMark> {
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
    let ground = RimGround { scene, nested };
    let ticks = edges.iter().enumerate().flat_map(|(number, edge)| match grid {
        Some(grid) => grid_ticks((number, edge), &ground, grid),
        None => own_ticks(edge, &ground),
    });
    ticks.filter_map(|tick| mark(tick, scene, camera)).collect()
}

impl BlockEdge {
    fn new(scene: &SceneModel, axis: usize, is_at_max: bool) -> Self {
        let ((min, max), across) = (scene.bounds, 1 - axis);
        let mut outward = Vec3::ZERO;
        outward[across] = if is_at_max { 1.0 } else { -1.0 };
        Self { axis, at: if is_at_max { max[across] } else { min[across] }, outward }
    }
}

impl RimGround<'_> {
    /// Where a line that comes from the border of the block has its first ground.
    fn end_of(&self, way: &[DVec2]) -> Option<GroundEnd> {
        let step_m = self.nested.finest(&self.scene.lattice).cell().min_element();
        // On the border itself rounding decides.
        let inset_m = longer_side_m(self.scene) * 1e-5;
        ground_end(way, (inset_m, step_m), &|at| self.nested.drawn_z(self.scene, at))
    }
}

/// The edge across the view and the one along it that are nearer to the eye; of two equally near, the western.
fn near_edges(scene: &SceneModel, camera: &Camera) -> [BlockEdge; 2] {
    let ahead = camera.forward();
    let is_at_max = [ahead.x < -1e-3, ahead.y < 0.0];
    [0, 1].map(|axis| BlockEdge::new(scene, axis, is_at_max[1 - axis]))
}

fn longer_side_m(scene: &SceneModel) -> f64 {
    let (min, max) = scene.bounds;
    f64::from((max - min).truncate().max_element())
}

/// Round coordinates of the scene's own system.
fn own_ticks(edge: &BlockEdge, ground: &RimGround<'_>) -> Vec<RimTick> {
    let scene = ground.scene;
    let (min, max) = scene.bounds;
    let origin = scene.lattice.origin()[edge.axis];
    let (low, high) = (origin + f64::from(min[edge.axis]), origin + f64::from(max[edge.axis]));
    let ticks = Ticks::new(low, high, MOST_MARKS);
    let tick = |&value: &f64| {
        let mut border = DVec2::splat(edge.at.into());
        border[edge.axis] = value - origin;
        let across_m = f64::from((max - min)[1 - edge.axis]);
        let way = [border, border - edge.outward.truncate().as_dvec2() * across_m];
        Some(RimTick {
            line: None,
            end: ground.end_of(&way)?,
            figure: coordinate(value, ticks.decimals, ["E", "N"][edge.axis]).into(),
            full: None,
        })
    };
    ticks.values.iter().filter_map(tick).collect()
}

/// Where the lines of a grid that meet the edge leave the ground, those of the edge's own coordinate before the others: of
/// each the first, then those of index lines, so that they stay where there is no place for all.
fn grid_ticks(
    (number, edge): (usize, &BlockEdge),
    ground: &RimGround<'_>,
    grid: &GroundGrid,
) -> Vec<RimTick> {
    let axes = [edge.axis, 1 - edge.axis].map(|axis| [GridAxis::East, GridAxis::North][axis]);
    let of_axis = |axis: GridAxis| {
        let lines = grid.lines.iter().enumerate().filter(move |(_, line)| line.axis == axis);
        let ends = lines.flat_map(|(index, line)| {
            let ends = ends_on(edge, line, ground.scene).into_iter().filter_map(|way| ground.end_of(&way));
            ends.map(move |end| (index, end)).collect::<Vec<_>>()
        });
        let mut ends: Vec<(usize, GroundEnd)> = ends.collect();
        ends.sort_by(|(_, a), (_, b)| a.at[edge.axis].total_cmp(&b.at[edge.axis]));
        let order = |place: usize| (place > 0, place > 0 && !grid.lines[ends[place].0].is_index);
        let mut places: Vec<usize> = (0..ends.len()).collect();
        places.sort_by_key(|&place| order(place));
        let tick = |place: usize| {
            let (index, end) = ends[place];
            let line = &grid.lines[index];
            let row = 2 * number + axis as usize;
            RimTick {
                line: Some(index),
                end,
                figure: line.figure.clone(),
                full: Some((line.full.clone(), row)),
            }
        };
        places.into_iter().map(tick).collect::<Vec<_>>()
    };
    axes.into_iter().flat_map(of_axis).collect()
}

/// The parts of a line that end on an edge, each as the way from there.
fn ends_on(edge: &BlockEdge, line: &GroundLine, scene: &SceneModel) -> Vec<Vec<DVec2>> {
    let near = longer_side_m(scene) * ON_EDGE;
    let is_on = |at: &DVec2| (at[1 - edge.axis] - f64::from(edge.at)).abs() < near;
    let ways = line.parts.iter().flat_map(|part| {
        let (forth, back) = (part.first().is_some_and(is_on), part.last().is_some_and(is_on));
        let reversed = || part.iter().rev().copied().collect::<Vec<DVec2>>();
        [forth.then(|| part.clone()), back.then(reversed)]
    });
    ways.flatten().collect()
}

fn mark(tick: RimTick, scene: &SceneModel, camera: &Camera) -> Option<RimMark> {
    let GroundEnd { at, outward, ground_z } = tick.end;
    let (at, outward) = (at.as_vec2(), outward.as_vec2().extend(0.0));
    let foot = at.extend(base_z(scene.bounds));
    let faces_eye = outward.dot(camera.toward_eye(foot)) > 0.0;
    let at = if faces_eye { foot } else { at.extend(ground_z as f32) };
    let step = outward * longer_side_m(scene) as f32 * BEYOND;
    let [here, beyond] = [at, at + step].map(|point| camera.project(point).map(|seen| seen.pixel));
    let (at_px, outward): (Vec2, Vec2) = (here?, beyond? - here?);
    Some(RimMark { line: tick.line, at_px, outward, figure: tick.figure, full: tick.full })
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
