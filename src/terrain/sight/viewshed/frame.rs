//! The lattice turned and mirrored so that all eight octants around the observer are swept by the same code.
//!
//! In a frame, rings run outward along one axis of the lattice and posts along the rings; both count away from the
//! observer. Parities are unchanged, and with them the direction of each cell's diagonal.

use glam::DVec2;

use crate::lattice::{Lattice, Post};

/// One octant of the circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct OctantFrame {
    /// The axis of the lattice that rings count along: 0 for columns, 1 for rows.
    ring_axis: usize,
    ring_sign: i64,
    cross_sign: i64,
    /// Grid position of the observer along the ring axis.
    eye: f64,
    /// The position of ring 0 and of post 0 of a ring: at the observer, or the first behind it.
    ring_start: i64,
    cross_start: i64,
    /// The first of the lattice's held posts, and how many a row has.
    held_first: [i64; 2],
    held_columns: i64,
    /// Rings on the held part of the lattice, ring 0 included.
    pub rings: usize,
    /// The last post of a ring on the held part of the lattice.
    pub last: i64,
    /// How far the observer stands beyond post 0 of a ring, in posts: 0..1.
    pub offset: f64,
    /// The distance between rings in the order of the lattice's held heights.
    pub ring_step: i64,
    pub ring_cell_m: f64,
    pub cross_cell_m: f64,
}

impl OctantFrame {
    /// The frames around an observer at grid position `eye` among the held posts of the lattice: eight, or fewer on their
    /// border, where a frame without a cell is left out; its one row of posts lies in the next frame too.
    pub fn all(lattice: &Lattice, eye: DVec2) -> impl Iterator<Item = Self> {
        const SIGNS: [(i64, i64); 4] = [(1, 1), (1, -1), (-1, 1), (-1, -1)];
        let frame = move |ring_axis, signs| Self::new(lattice, eye, ring_axis, signs);
        let frames = (0..2).flat_map(move |ring_axis| SIGNS.map(|signs| frame(ring_axis, signs)));
        frames.filter(|frame| frame.rings > 1 && frame.last > 0)
    }

    fn new(lattice: &Lattice, eye: DVec2, ring: usize, (ring_sign, cross_sign): (i64, i64)) -> Self {
        let cross = 1 - ring;
        let held = lattice.held();
        let first = [held.first.column, held.first.row].map(i64::from);
        let last = [held.last.column, held.last.row].map(i64::from);
        let held_columns = held.width() as i64;
        let (steps, cell) = ([1, held_columns], lattice.cell());
        let behind = |at: f64, sign: i64| if sign > 0 { at.floor() as i64 } else { at.ceil() as i64 };
        let left = |start: i64, sign: i64, axis: usize| {
            if sign > 0 { last[axis] - start } else { start - first[axis] }
        };
        let (ring_start, cross_start) = (behind(eye[ring], ring_sign), behind(eye[cross], cross_sign));
        Self {
            ring_axis: ring,
            ring_sign,
            cross_sign,
            eye: eye[ring],
            ring_start,
            cross_start,
            held_first: first,
            held_columns,
            rings: left(ring_start, ring_sign, ring) as usize + 1,
            last: left(cross_start, cross_sign, cross),
            offset: (eye[cross] - cross_start as f64).abs(),
            ring_step: steps[ring] * ring_sign,
            ring_cell_m: cell[ring],
            cross_cell_m: cell[cross],
        }
    }

    /// About how many rings lie on the held part of the lattice on a ray.
    pub fn rings_before(&self, ray: f64) -> usize {
        self.rings.min((self.last as f64 / ray) as usize)
    }

    /// The distance of a ring from the observer, in cells; for ring 0 that behind the observer as a negative one, or 0.
    pub fn distance(&self, ring: usize) -> f64 {
        self.ring_sign as f64 * (self.ring_position(ring) as f64 - self.eye)
    }

    /// The index of post `j` of a ring in the lattice's held heights.
    pub fn index(&self, ring: usize, j: i64) -> usize {
        let Post { column, row } = self.post(ring, j);
        let [first, south] = self.held_first;
        ((i64::from(row) - south) * self.held_columns + i64::from(column) - first) as usize
    }

    /// Post `j` of a ring.
    pub fn post(&self, ring: usize, j: i64) -> Post {
        let (ring, cross) =
            (self.ring_position(ring) as u32, (self.cross_start + self.cross_sign * j) as u32);
        if self.ring_axis == 0 {
            Post { column: ring, row: cross }
        } else {
            Post { column: cross, row: ring }
        }
    }

    /// 0 where diagonals join the even posts of a ring, 1 where they join the odd ones.
    pub fn parity(&self, ring: usize) -> i64 {
        (self.ring_position(ring) + self.cross_start).rem_euclid(2)
    }

    /// The directions of the rays `from` and `to` on the map, meters east and north.
    pub fn directions(&self, (from, to): (f64, f64)) -> [DVec2; 2] {
        [from, to].map(|u| {
            let ring = self.ring_sign as f64 * self.ring_cell_m;
            let cross = self.cross_sign as f64 * self.cross_cell_m * u;
            if self.ring_axis == 0 { DVec2::new(ring, cross) } else { DVec2::new(cross, ring) }
        })
    }

    fn ring_position(&self, ring: usize) -> i64 {
        self.ring_start + self.ring_sign * ring as i64
    }
}
