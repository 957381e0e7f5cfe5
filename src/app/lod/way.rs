//! The way of a flight: from what is said on the command line to cameras.

use std::convert::Infallible;
use std::fmt::{self, Display};
use std::path::PathBuf;
use std::str::FromStr;

use glam::{DVec2, Vec2, Vec3};

use crate::app::failure::CliError;
use crate::app::files;
use crate::app::lod::stations;
use crate::geom::rect::Rect;
use crate::terrain::lattice::Lattice;
use crate::terrain::query::{Interpolation, ground_height};
use crate::view::camera::Camera;
use crate::view::flight::{self, CircularFlight, FlightStation, GroundClearance, StraightFlight};

/// Posts along a side of the block about whose middle the circle is flown.
const BLOCK: u32 = 513;

/// The circle's radius as a share of the block's side.
const RADIUS: f32 = 0.3;

/// Cells of the eye above the smoothed ground.
const ABOVE: f32 = 30.0;

/// The part of a diagonal that a line leaves out at either end: at the very corner half the picture is empty.
const MARGIN: f32 = 0.05;

/// Which way is flown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FlightPath {
    /// Round the middle of the south-western block, one cell a frame.
    Circle,
    /// From the south-west to the north-east.
    Line,
    /// Along the stations of a file.
    File(PathBuf),
}

impl FromStr for FlightPath {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "circle" => Self::Circle,
            "line" => Self::Line,
            file => Self::File(file.into()),
        })
    }
}

impl Display for FlightPath {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Circle => out.write_str("a circle"),
            Self::Line => out.write_str("a line"),
            Self::File(path) => write!(out, "the way of {}", path.display()),
        }
    }
}

/// The cameras of `frames` frames over `lattice`.
///
/// # Errors
/// The file of stations cannot be had or read; a camera looks nowhere.
pub fn cameras(way: &FlightPath, frames: usize, lattice: &Lattice) -> Result<Vec<Camera>, CliError> {
    let (low, high) = lattice.height_range();
    let stations = stations(way, frames, lattice, (low + high) * 0.5)?;
    let Rect { min, max } = lattice.extent();
    let corners = (min.as_vec2().extend(low), max.as_vec2().extend(high));
    let camera = |(frame, station): (usize, &FlightStation)| {
        let camera = station.camera(0.5, far_m(corners, station.eye));
        camera.map_err(|error| CliError::input(format!("{way}, frame {}: {error}", frame + 1)))
    };
    stations.iter().enumerate().map(camera).collect()
}

/// The stations of a flight; where there is no data it is flown over ground at `missing_m`.
fn stations(
    way: &FlightPath,
    frames: usize,
    lattice: &Lattice,
    missing_m: f32,
) -> Result<Vec<FlightStation>, CliError> {
    let cell = lattice.cell().as_vec2();
    let size_m = (cell.x * cell.y).sqrt();
    let keeping = GroundClearance { height_m: ABOVE * size_m, smoothing_m: 2.0 * size_m };
    let ground = |at: Vec2| drawn_z(lattice, at, missing_m);
    Ok(match way {
        FlightPath::Circle => {
            let side = (lattice.columns().min(lattice.rows()).min(BLOCK) - 1) as f32;
            let (center, radius_m) = (cell * side * 0.5, RADIUS * side * size_m);
            CircularFlight { center, radius_m, step_m: size_m, clearance: keeping }.stations(frames, &ground)
        }
        FlightPath::Line => {
            let far = lattice.extent().max.as_vec2();
            StraightFlight { from: far * MARGIN, to: far * (1.0 - MARGIN), clearance: keeping }
                .stations(frames, &ground)
        }
        FlightPath::File(path) => {
            let text = files::read_text(path)?;
            flight::evenly_spaced(&stations::parse(&files::text_name(path), &text)?, frames)
        }
    })
}

/// The ground's height at a place or at the nearest one that is on the ground; `missing_m` where it has no data.
fn drawn_z(lattice: &Lattice, at: Vec2, missing_m: f32) -> f32 {
    let Rect { min, max } = lattice.extent();
    let at: DVec2 = at.as_dvec2().clamp(min, max);
    let height = ground_height(lattice, Interpolation::Bilinear, at).height_m();
    height.map_or(missing_m, |height| height as f32)
}

/// Behind the box of all ground, wherever the eye looks.
fn far_m((min, max): (Vec3, Vec3), eye: Vec3) -> f32 {
    let farthest = Vec3::select((eye - min).abs().cmpgt((eye - max).abs()), min, max);
    eye.distance(farthest) * 1.5 + 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(columns: u32, rows: u32) -> Lattice {
        let heights = vec![50.0; (columns * rows) as usize];
        Lattice::new(DVec2::new(4e5, 5e6), DVec2::new(10.0, 20.0), columns, heights).expect("sound")
    }

    #[test]
    fn flights_stay_over_the_ground_and_see_all_of_it() {
        let lattice = lattice(40, 90);
        for way in [FlightPath::Circle, FlightPath::Line] {
            let cameras = cameras(&way, 50, &lattice).expect("sound");
            assert_eq!(cameras.len(), 50);
            for camera in cameras {
                let at = camera.eye().truncate().as_dvec2();
                assert!(lattice.cell_at(at).is_some(), "{way}: {at}");
                assert!(camera.eye().z > 50.0 && camera.planes().1 > 1000.0);
            }
        }
    }

    #[test]
    fn the_smallest_ground_can_be_flown_over() {
        for way in [FlightPath::Circle, FlightPath::Line] {
            assert_eq!(cameras(&way, 2, &lattice(2, 2)).expect("sound").len(), 2, "{way}");
        }
    }
}
