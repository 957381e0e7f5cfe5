//! The course of a feature's name on the ground: a line, or the outline of an area.

use glam::{DVec2, Vec3};

use crate::near::MERGE_M;
use crate::world_frame::WorldFrame;
use sandtable_geom::join::joined;
use sandtable_geom::polyline::Polyline;
use sandtable_terrain::lattice::Lattice;
use sandtable_vector::feature::Polygon;

/// Vertices of one line or outline on the ground: more than the pixels across a picture help no name.
const MOST_VERTICES: f64 = 600.0;

/// The course that a name follows; places on the ground in world space, displayed height.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LabelCourse {
    /// A place alone.
    #[default]
    Place,
    /// Lines, along which the name stands.
    Along(Vec<Vec<Vec3>>),
    /// The outer rings of polygons, over which the name is spread.
    Across(Vec<Vec<Vec3>>),
}

impl LabelCourse {
    /// The course with each of its places as `place` gives it.
    pub fn map(&self, place: impl Fn(Vec3) -> Vec3) -> Self {
        let moved = |lines: &[Vec<Vec3>]| -> Vec<Vec<Vec3>> {
            lines.iter().map(|line| line.iter().map(|&at| place(at)).collect()).collect()
        };
        match self {
            Self::Place => Self::Place,
            Self::Along(lines) => Self::Along(moved(lines)),
            Self::Across(rings) => Self::Across(moved(rings)),
        }
    }
}

/// World lines on the ground, joined where they share an end; parts off the ground are left out.
pub fn along(lines: Vec<Vec<DVec2>>, frame: &WorldFrame<'_>, lattice: &Lattice) -> LabelCourse {
    let extent = lattice.extent();
    let lines = joined(lines).into_iter().filter_map(|line| Polyline::new(line, MERGE_M));
    let pieces = lines.flat_map(|line| line.clip(&extent));
    LabelCourse::Along(pieces.flat_map(|piece| on_ground(&piece, frame, lattice)).collect())
}

/// The outer rings of world polygons on the ground.
pub fn across(polygons: &[Polygon], frame: &WorldFrame<'_>, lattice: &Lattice) -> LabelCourse {
    let rings = polygons.iter().filter_map(|polygon| {
        let first = polygon.exterior.first().copied();
        Polyline::new(polygon.exterior.iter().copied().chain(first), MERGE_M)
    });
    LabelCourse::Across(rings.map(|ring| on_ground(&ring, frame, lattice).concat()).collect())
}

/// A line with vertices close enough to follow the ground; a new part after every place without ground.
fn on_ground(line: &Polyline, frame: &WorldFrame<'_>, lattice: &Lattice) -> Vec<Vec<Vec3>> {
    let cell = lattice.cell();
    let step = cell.x.min(cell.y).max(line.length() / MOST_VERTICES);
    let legs = (line.length() / step).ceil().max(1.0) as usize;
    let mut parts = vec![Vec::new()];
    for leg in 0..=legs {
        let at = line.at(line.length() * leg as f64 / legs as f64);
        match frame.ground_at(lattice, at) {
            Some(at) => parts.last_mut().expect("there is always a part").push(at),
            None => parts.push(Vec::new()),
        }
    }
    parts.retain(|part| part.len() >= 2);
    parts
}
