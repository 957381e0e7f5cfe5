//! The cameras of a flight over a lattice.

use std::convert::Infallible;
use std::fmt::{self, Display};
use std::path::PathBuf;
use std::str::FromStr;

use glam::{DVec2, Vec2};

use crate::lod::station_file::{self, StationFileError};
use sandtable_files::disk::{self, ReadFileError};
use sandtable_geom::aabb::Aabb;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_view::camera::{Camera, CameraError, far_m};
use sandtable_view::flight::{self, CircularFlight, FlightStation, GroundClearance, StraightFlight};

/// Posts along a side of the block around whose center the circle is flown.
const BLOCK: u32 = 513;

/// The circle's radius as a share of the block's side.
const RADIUS: f32 = 0.3;

/// The height of the eye above the smoothed ground, in cells.
const ABOVE: f32 = 30.0;

/// The share of the diagonal that a line leaves out at either end: at the very corner half the picture is empty.
const MARGIN: f32 = 0.05;

/// A path of a flight.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FlightPath {
    /// Around the center of the south-western block, one cell a frame.
    Circle,
    /// From the south-west to the north-east.
    Line,
    /// Along the stations of a file.
    File(PathBuf),
}

/// A path that cannot be flown.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum FlightError {
    #[error(transparent)]
    File(#[from] ReadFileError),
    #[error(transparent)]
    Stations(#[from] StationFileError),
    #[error("{path}, frame {frame}")]
    Camera {
        path: FlightPath,
        /// From 1.
        frame: usize,
        source: CameraError,
    },
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
            Self::File(path) => write!(out, "the path of {}", path.display()),
        }
    }
}

impl FlightPath {
    /// The cameras of `frames` frames over `lattice`.
    ///
    /// # Errors
    /// See [`FlightError`].
    pub fn cameras(&self, frames: usize, lattice: &Lattice) -> Result<Vec<Camera>, FlightError> {
        let (low, high) = lattice.height_range();
        let Rect { min, max } = lattice.extent();
        let (min, max) = (min.as_vec2().extend(low), max.as_vec2().extend(high));
        let camera = |(station, frame): (FlightStation, usize)| {
            let camera = station.camera(0.5, far_m(&Aabb { min, max }, station.eye));
            camera.map_err(|source| FlightError::Camera { path: self.clone(), frame, source })
        };
        self.stations(frames, lattice, (low + high) * 0.5)?.into_iter().zip(1..).map(camera).collect()
    }

    /// The stations; ground without data is flown over as if at `missing_m`.
    fn stations(
        &self,
        frames: usize,
        lattice: &Lattice,
        missing_m: f32,
    ) -> Result<Vec<FlightStation>, FlightError> {
        let cell = lattice.cell().as_vec2();
        let size_m = (cell.x * cell.y).sqrt();
        let clearance = GroundClearance { height_m: ABOVE * size_m, smoothing_m: 2.0 * size_m };
        let ground = |at: Vec2| ground_z(lattice, at, missing_m);
        Ok(match self {
            Self::Circle => {
                let side = (lattice.columns().min(lattice.rows()).min(BLOCK) - 1) as f32;
                let (center, radius_m) = (cell * side * 0.5, RADIUS * side * size_m);
                CircularFlight { center, radius_m, step_m: size_m, clearance }.stations(frames, &ground)
            }
            Self::Line => {
                let far = lattice.extent().max.as_vec2();
                let (from, to) = (far * MARGIN, far * (1.0 - MARGIN));
                StraightFlight { from, to, clearance }.stations(frames, &ground)
            }
            Self::File(path) => {
                let text = disk::read_text(path)?;
                flight::evenly_spaced(&station_file::parse(&disk::display_name(path), &text)?, frames)
            }
        })
    }
}

/// The ground's height at the nearest position on the model; `missing_m` where it has no data.
fn ground_z(lattice: &Lattice, at: Vec2, missing_m: f32) -> f32 {
    let Rect { min, max } = lattice.extent();
    let at: DVec2 = at.as_dvec2().clamp(min, max);
    let height = ground_height(lattice, Interpolation::Bilinear, at).height_m();
    height.map_or(missing_m, |height| height as f32)
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
        for path in [FlightPath::Circle, FlightPath::Line] {
            let cameras = path.cameras(50, &lattice).expect("sound");
            assert_eq!(cameras.len(), 50);
            for camera in cameras {
                let at = camera.eye().truncate().as_dvec2();
                assert!(lattice.cell_at(at).is_some(), "{path}: {at}");
                assert!(camera.eye().z > 50.0 && camera.planes().1 > 1000.0);
            }
        }
    }

    #[test]
    fn the_smallest_ground_can_be_flown_over() {
        for path in [FlightPath::Circle, FlightPath::Line] {
            assert_eq!(path.cameras(2, &lattice(2, 2)).expect("sound").len(), 2, "{path}");
        }
    }
}
