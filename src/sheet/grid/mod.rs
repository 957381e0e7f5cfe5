//! The coordinate grid of a picture: its lines on the ground, projected, and cut where something hides them.
//!
//! ```text
//!  extent: what coordinates the scene has ─┐
//!  system: which lines, how far apart ─────┴► lines: each in world X and Y ─┬─► trace: what of it shows ─► PictureGrid
//!                                             (curve)                       └─► rim: where it leaves the ground
//! ```
//!
//! The lines are not part of the rendered scene: what shows of them is decided by the picture's depths, as for labels.
//! So they have one width from the foreground to the horizon, and cost what they show.

pub mod check;
mod curve;
mod extent;
pub mod lines;
pub mod squares;
pub mod system;
mod trace;

use rayon::prelude::*;

use crate::grid::lines::{GroundGrid, ground_grid};
use crate::grid::squares::square_names;
use crate::grid::trace::LineTracer;
use sandtable_annotate::grid::{GridLine, PictureGrid};
use sandtable_description::words::GridName;
use sandtable_picture::nested_ground::NestedHeights;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// How far apart lines are in the middle of a picture 1080 pixels high where no interval is stated, in pixels: nearer
/// they hide the relief, farther no place is near one.
const APART_PX: f64 = 100.0;

/// The lines of the scene's grid over its ground, as dense as suits `camera`; `None` where it has no grid, or its
/// system has no place on Earth.
pub fn grid_over(scene: &SceneModel, camera: &Camera, picture: &Rendering) -> Option<GroundGrid> {
    if scene.grid == GridName::None {
        return None;
    }
    let (width, height) = camera.size();
    let (middle, rows) = (width as usize / 2, height as usize);
    let column = (rows / 2..rows).map(|row| picture.depth_m[row * width as usize + middle]);
    let depth_m = column.into_iter().find(|depth| depth.is_finite()).unwrap_or(1000.0);
    let pixels_per_m = f64::from(camera.pixels_per_meter(depth_m)) * (1080.0 / f64::from(height)).max(0.25);
    ground_grid(scene, APART_PX / pixels_per_m)
}

/// The part of a grid that a picture shows.
pub fn picture_grid(
    grid: &GroundGrid,
    scene: &SceneModel,
    nested: &NestedHeights,
    camera: &Camera,
    picture: &Rendering,
) -> PictureGrid {
    let tracer = LineTracer::new(scene, nested, camera, picture);
    let lines = grid.lines.par_iter().enumerate().map(|(number, line)| GridLine {
        line: number,
        axis: line.axis,
        runs: tracer.runs(line, grid),
        is_index: line.is_index,
        figure: line.figure.clone(),
        full: line.full.clone(),
    });
    let lines: Vec<GridLine> = lines.collect();
    PictureGrid {
        lines: lines.into_iter().filter(|line| !line.runs.is_empty()).collect(),
        squares: if grid.has_squares { square_names(scene, camera, picture) } else { Vec::new() },
        note: Some(grid.note.clone()),
    }
}
