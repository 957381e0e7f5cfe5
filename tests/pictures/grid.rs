//! Grids on pictures: lines lie where their numbers say, and what is before them hides them.

use std::path::Path;

use glam::Vec2;
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::{GridAxis, GridLine, PictureGrid};
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::grid::{grid_over, picture_grid};
use sandtable_sheet::picture::{DrawnView, PictureSize, draw_view};

fn scene() -> SceneModel {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/grid.toml");
    open_scene(&path, &[], &|_| ()).expect("a scene of the gallery")
}

fn drawn(scene: &SceneModel, camera: &str) -> DrawnView {
    let view = scene.view(Some(camera)).expect("a camera of the scene");
    let size = PictureSize { width: 640, height: 480 };
    draw_view(scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound")
}

fn grid(scene: &SceneModel, view: &DrawnView) -> PictureGrid {
    let lines = grid_over(scene, &view.camera, &view.picture).expect("the scene has a grid");
    picture_grid(&lines, scene, &view.drawn.nested, &view.camera, &view.picture)
}

/// The coordinate that a line's number stands for, meters.
fn value_m(line: &GridLine) -> f64 {
    let CoordinateFigure::Military { before, principal, after } = &line.full else { panic!("{line:?}") };
    let zeros = after.chars().filter(|digit| *digit == '0').collect::<String>();
    format!("{before}{principal}{zeros}").parse().expect("digits")
}

#[test]
fn lines_in_plan_lie_at_the_coordinates_that_their_numbers_say() {
    let scene = scene();
    let view = drawn(&scene, "plan");
    let grid = grid(&scene, &view);
    assert!(grid.lines.len() >= 8, "{} lines", grid.lines.len());
    for line in &grid.lines {
        let axis = if line.axis == GridAxis::East { 0 } else { 1 };
        let mut world = (scene.bounds.0 + scene.bounds.1) / 2.0;
        world[axis] = (value_m(line) - scene.lattice.origin()[axis]) as f32;
        let expected = view.camera.project(world).expect("in view").pixel[axis];
        for at in line.runs.iter().flatten() {
            assert!((at[axis] - expected).abs() < 0.3, "{:?}: {at}, not {expected}", line.full);
        }
    }
}

#[test]
fn hills_hide_the_lines_behind_them() {
    let scene = scene();
    let mut view = drawn(&scene, "east");
    let length = |grid: &PictureGrid| -> f32 {
        let runs = grid.lines.iter().flat_map(|line| &line.runs);
        runs.flat_map(|run| run.windows(2)).map(|pair| Vec2::distance(pair[0], pair[1])).sum()
    };
    let seen = length(&grid(&scene, &view));
    view.picture.depth_m.fill(f32::INFINITY);
    let all = length(&grid(&scene, &view));
    assert!(seen > 1000.0 && seen < 0.95 * all, "{seen} of {all} pixels");
}
