//! Whether the numbers of a grid stand at their lines: a number beside the line that it names is a false coordinate.
//!
//! Nothing of how lines are traced and numbers are placed is used: the place of the picture at which a number points is
//! looked up on the ground, transformed to the grid's system, and compared with what the number's line keeps.

use glam::{DVec2, Vec2};

use crate::grid::lines::{GroundGrid, GroundLine};
use sandtable_annotate::grid::GridAxis;
use sandtable_annotate::placed_figure::PlacedFigure;
use sandtable_render::picture::Rendering;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// By how much a number may miss its line on the picture, in pixels: depths are those of the middles of pixels.
const MOST_PX: f32 = 3.0;

/// A number that is not at its line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the number {figure:?} is {off_px:.1} px off the line of {value}")]
pub struct FigureOffLine {
    /// The number.
    pub figure: Box<PlacedFigure>,
    /// What its line keeps: meters, or degrees.
    pub value: f64,
    /// How far it is from the line, pixels.
    pub off_px: f32,
}

/// Checks that each number of `figures` stands at the line of `grid` that it names, on the picture of `scene` that `camera`
/// sees, and returns how many there are.
///
/// # Errors
/// The first that does not.
pub fn check_figures(
    figures: &[PlacedFigure],
    grid: &GroundGrid,
    scene: &SceneModel,
    (camera, picture): (&Camera, &Rendering),
) -> Result<usize, FigureOffLine> {
    let numbered = || figures.iter().filter_map(|figure| Some((figure, grid.lines.get(figure.line?)?)));
    for (figure, line) in numbered() {
        let missed = MissedLine { grid, scene, camera, picture }.off_px(figure.at_px, line);
        let is_named = [&line.figure, &line.full].contains(&&figure.figure);
        let off_px = if is_named { missed.max(figure.off_px()) } else { f32::INFINITY };
        if off_px > MOST_PX {
            return Err(FigureOffLine { figure: Box::new(figure.clone()), value: line.value, off_px });
        }
    }
    Ok(numbered().count())
}

struct MissedLine<'a> {
    grid: &'a GroundGrid,
    scene: &'a SceneModel,
    camera: &'a Camera,
    picture: &'a Rendering,
}

impl MissedLine<'_> {
    /// How far a place of the picture is from a line: infinite where there is no ground.
    fn off_px(&self, at_px: Vec2, line: &GroundLine) -> f32 {
        let (width, height) = self.camera.size();
        let depth_of = |pixel: Vec2| {
            let is_on = pixel.cmpge(Vec2::ZERO).all() && pixel.x < width as f32 && pixel.y < height as f32;
            let index = pixel.y as usize * width as usize + pixel.x as usize;
            self.picture.depth_m.get(index).copied().filter(|depth| is_on && depth.is_finite())
        };
        // The ground beside the place, and the level of the block's foot under it.
        let around = [-1.5f32, -0.5, 0.5, 1.5].map(|x| [-1.5f32, -0.5, 0.5, 1.5].map(|y| Vec2::new(x, y)));
        let depths = around.into_iter().flatten().filter_map(|step| depth_of(at_px + step));
        let (from, ray) = (self.camera.ray_origin(at_px), self.camera.ray_through(at_px));
        let foot = (base_z(self.scene.bounds) - from.z) / ray.z;
        let places = depths.chain([foot]).map(|depth_m| from + ray * depth_m);
        let off = places.filter_map(|place| {
            let on_line = self.on_line(place.truncate().as_dvec2(), line)?;
            let seen = self.camera.project(on_line.as_vec2().extend(place.z))?;
            Some(seen.pixel.distance(at_px))
        });
        off.fold(f32::INFINITY, f32::min)
    }

    /// A place moved to the coordinate that a line keeps, the other being the same.
    fn on_line(&self, world: DVec2, line: &GroundLine) -> Option<DVec2> {
        let (scene, system) = (self.scene, self.grid.systems.get(line.system)?);
        let mut at = scene.crs.transform(system, world + scene.lattice.origin()).ok()?;
        at[if line.axis == GridAxis::East { 0 } else { 1 }] = line.value;
        Some(system.transform(&scene.crs, at).ok()? - scene.lattice.origin())
    }
}
