//! The result of a survey: points in no order, lines along which the ground breaks, a system for their x and y and a unit for
//! their z. [`crate::gridding`] makes a grid of it.

use glam::DVec3;

use sandtable_geom::crs::Crs;

/// Points and breaklines in one coordinate system.
#[derive(Clone, Debug)]
pub struct PointCloud {
    /// Easting (or longitude), northing (or latitude) and height; finite.
    pub points: Vec<DVec3>,
    /// Lines along which the ground breaks and which it follows, each of at least two vertices.
    pub breaklines: Vec<Vec<DVec3>>,
    /// The system of x and y; `None` where the file names none.
    pub crs: Option<Crs>,
    /// Meters in one unit of the heights.
    pub meters_per_z: f64,
    /// The vertical datum in the file's words; `None` where it is not stated.
    pub vertical_datum: Option<String>,
    /// Notes for the user on omissions and assumptions.
    pub notes: Vec<String>,
}

impl PointCloud {
    /// Points in meters, in no named system.
    pub fn new(points: Vec<DVec3>) -> Self {
        let (breaklines, notes) = (Vec::new(), Vec::new());
        Self { points, breaklines, crs: None, meters_per_z: 1.0, vertical_datum: None, notes }
    }
}

/// Options for reading a file of points.
#[derive(Clone, Debug, Default)]
pub struct PointHints<'a> {
    /// The system of x and y, in place of the file's.
    pub crs: Option<&'a Crs>,
    /// The classes of LAS points that are taken. Empty: ground (class 2) where the file has any, else all.
    pub classes: &'a [u8],
}
