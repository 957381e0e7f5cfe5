//! Coordinates along the two near edges of the block, where a picture shows it as a block on a table.

use glam::{Vec2, Vec3};

use crate::annotate::nice::{Ticks, format_number, grouped};
use crate::annotate::rim::RimMark;
use crate::scene::SceneModel;
use crate::scene::picture::shows_table;
use crate::scene::plinth::base_z;
use crate::terrain::full_resolution::FullResolution;
use crate::terrain::triangle_surface::TriangleSurface;
use crate::view::camera::Camera;

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

/// The coordinates along the near edges; none where the block is not on a table.
///
/// At the foot of an edge that faces the eye; at the ground above an edge that does not.
pub fn rim_marks(scene: &SceneModel, camera: &Camera) -> Vec<RimMark> {
    if !shows_table(scene, camera) {
        return Vec::new();
    }
    near_edges(scene, camera).iter().flat_map(|edge| edge_marks(edge, scene, camera)).collect()
}

/// The edge across the view and the one along it that are nearer to the eye; of two equally near, the western.
fn near_edges(scene: &SceneModel, camera: &Camera) -> [BlockEdge; 2] {
    let (min, max) = scene.bounds;
    let ahead = camera.forward();
    let is_at_max = [ahead.x < -1e-3, ahead.y < 0.0];
    [(0, 1), (1, 0)].map(|(axis, across)| {
        let sign = if is_at_max[across] { 1.0 } else { -1.0 };
        let mut outward = Vec3::ZERO;
        outward[across] = sign;
        BlockEdge { axis, at: if is_at_max[across] { max[across] } else { min[across] }, outward }
    })
}

fn edge_marks(edge: &BlockEdge, scene: &SceneModel, camera: &Camera) -> Vec<RimMark> {
    let (min, max) = scene.bounds;
    let origin = scene.lattice.origin()[edge.axis];
    let (low, high) = (origin + f64::from(min[edge.axis]), origin + f64::from(max[edge.axis]));
    let ticks = Ticks::new(low, high, MOST_MARKS);
    let side_m = (max - min).truncate().max_element();
    let ground = FullResolution { lattice: scene.ground().lattice() };
    let mark = |&value: &f64| {
        let mut border = Vec3::splat(edge.at);
        border[edge.axis] = (value - origin) as f32;
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
        Some(RimMark { at_px, outward, text: coordinate(value, ticks.decimals, ["E", "N"][edge.axis]) })
    };
    ticks.values.iter().filter_map(mark).collect()
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
