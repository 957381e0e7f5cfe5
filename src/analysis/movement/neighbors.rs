//! The neighbors of a post: the steps that lead to them, and the triangles between them.

use crate::movement::grade::GradeTable;
use glam::DVec2;
use sandtable_terrain::lattice::Lattice;

/// Sixteen neighbors: columns and rows. The ring of eight comes first, straight ones before diagonal ones.
const NEIGHBORS: [[i32; 2]; 16] = [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
    [2, 1],
    [1, 2],
    [-1, 2],
    [-2, 1],
    [-2, -1],
    [-1, -2],
    [1, -2],
    [2, -1],
];

/// The neighbors of a post that come first in [`NEIGHBORS`].
pub(super) const RING: usize = 8;

/// The triangles that have a post p and a straight neighbor as corners: for each such neighbor, the four posts to which
/// they lead.
pub(super) const SIDES: [[RingTriangle; 4]; 4] = [
    [
        RingTriangle { to: 1, is_from_straight: true, axis: 1 },
        RingTriangle { to: 4, is_from_straight: false, axis: 1 },
        RingTriangle { to: 3, is_from_straight: true, axis: 1 },
        RingTriangle { to: 7, is_from_straight: false, axis: 1 },
    ],
    [
        RingTriangle { to: 0, is_from_straight: true, axis: 0 },
        RingTriangle { to: 4, is_from_straight: false, axis: 0 },
        RingTriangle { to: 2, is_from_straight: true, axis: 0 },
        RingTriangle { to: 5, is_from_straight: false, axis: 0 },
    ],
    [
        RingTriangle { to: 1, is_from_straight: true, axis: 1 },
        RingTriangle { to: 5, is_from_straight: false, axis: 1 },
        RingTriangle { to: 3, is_from_straight: true, axis: 1 },
        RingTriangle { to: 6, is_from_straight: false, axis: 1 },
    ],
    [
        RingTriangle { to: 0, is_from_straight: true, axis: 0 },
        RingTriangle { to: 7, is_from_straight: false, axis: 0 },
        RingTriangle { to: 2, is_from_straight: true, axis: 0 },
        RingTriangle { to: 6, is_from_straight: false, axis: 0 },
    ],
];

/// A triangle among the ring of a post, by indices of the ring.
#[derive(Clone, Copy)]
pub(super) struct RingTriangle {
    pub to: usize,
    /// Whether p lies straight beside that post, and its neighbor diagonal to it; else the other way around.
    pub is_from_straight: bool,
    /// 0 where what lies straight beside that post lies in its row, else 1.
    pub axis: usize,
}

/// A step to a neighbor.
#[derive(Clone, Copy)]
pub(super) struct TravelStep {
    pub columns: i32,
    pub rows: i32,
    pub offset: isize,
    /// The two posts that it passes between or beside; unused for the four straight ones.
    pub flanks: [isize; 2],
    /// From its beginning to the post at a right angle on the left.
    pub left: isize,
    pub length_m: f32,
    pub per_length_m: f32,
    /// The reciprocal of the distance between the posts at right angles on either side.
    pub per_span_m: f32,
    /// The least seconds that it takes anywhere on the ground, at a pace of 1.
    pub least_per_pace_s: f32,
}

/// The steps to the sixteen neighbors in rows of so many posts.
pub(super) fn steps(ground: &Lattice, width: usize, grades: &GradeTable) -> Vec<TravelStep> {
    let cell = ground.cell();
    let length_m = |east: i32, north: i32| (cell * DVec2::new(f64::from(east), f64::from(north))).length();
    let offset = |east: i32, north: i32| north as isize * width as isize + east as isize;
    let step = |[east, north]: [i32; 2]| {
        let flanks = match (east.abs(), north.abs()) {
            (2, 1) => [offset(east / 2, 0), offset(east / 2, north)],
            (1, 2) => [offset(0, north / 2), offset(east, north / 2)],
            _ => [offset(east, 0), offset(0, north)],
        };
        let length = length_m(east, north);
        TravelStep {
            columns: east,
            rows: north,
            offset: offset(east, north),
            flanks,
            left: offset(-north, east),
            length_m: length as f32,
            per_length_m: (1.0 / length) as f32,
            per_span_m: (0.5 / length_m(north, east)) as f32,
            // A ten-thousandth less, for rounding.
            least_per_pace_s: length as f32 * grades.least() * 0.9999,
        }
    };
    NEIGHBORS.map(step).into()
}
