//! The lattice turned and mirrored so that an eighth of the circle around the observer lies as one picture shows it.
//!
//! In a frame, rings run outward along one axis of the lattice and posts along the rings; both count away from the
//! observer. Parities go through unchanged, and with them which way a cell's diagonal runs.

use glam::DVec2;

use crate::terrain::lattice::{Lattice, Post};

/// One eighth of the circle.
#[derive(Clone, Copy, Debug)]
pub(super) struct OctantFrame {
    ring_axis: OctantAxis,
    ring_sign: i64,
    cross_sign: i64,
    /// Grid position of the observer along the ring axis.
    eye: f64,
    /// Where ring 0 and post 0 of a ring lie: at the observer, or the first behind it.
    ring_start: i64,
    cross_start: i64,
    columns: i64,
    /// Rings, ring 0 included, as far as the lattice goes.
    pub rings: usize,
    /// The last post of a ring on the lattice.
    pub last: i64,
    /// How far the observer stands beyond post 0 of a ring, in posts: 0..1.
    pub offset: f64,
    /// From a ring to the next, and from a post of a ring to the next, in the order of the lattice's heights.
    pub ring_step: i64,
    pub cross_step: i64,
    pub ring_cell_m: f64,
    pub cross_cell_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OctantAxis {
    Columns,
    Rows,
}

impl OctantFrame {
    /// The frames around an observer at grid position `eye` on the lattice: eight, or fewer on its border, where a
    /// frame without a cell is left out; its one row of posts lies in the next frame too.
    pub fn all(lattice: &Lattice, eye: DVec2) -> impl Iterator<Item = Self> {
        const SIGNS: [(i64, i64); 4] = [(1, 1), (1, -1), (-1, 1), (-1, -1)];
        let frame = move |axis, signs| Self::new(lattice, eye, axis, signs);
        let frames = [OctantAxis::Columns, OctantAxis::Rows]
            .into_iter()
            .flat_map(move |axis| SIGNS.map(|signs| frame(axis, signs)));
        frames.filter(|frame| frame.rings > 1 && frame.last > 0)
    }

    fn new(
        lattice: &Lattice,
        eye: DVec2,
        ring_axis: OctantAxis,
        (ring_sign, cross_sign): (i64, i64),
    ) -> Self {
        let counts = [i64::from(lattice.columns()), i64::from(lattice.rows())];
        let (steps, cells) = ([1, counts[0]], lattice.cell().to_array());
        let (ring, cross) = if ring_axis == OctantAxis::Columns { (0, 1) } else { (1, 0) };
        let behind = |at: f64, sign: i64| if sign > 0 { at.floor() as i64 } else { at.ceil() as i64 };
        let left = |start: i64, sign: i64, count: i64| if sign > 0 { count - 1 - start } else { start };
        let eye = eye.to_array();
        let (ring_start, cross_start) = (behind(eye[ring], ring_sign), behind(eye[cross], cross_sign));
        Self {
            ring_axis,
            ring_sign,
            cross_sign,
            eye: eye[ring],
            ring_start,
            cross_start,
            columns: counts[0],
            rings: left(ring_start, ring_sign, counts[ring]) as usize + 1,
            last: left(cross_start, cross_sign, counts[cross]),
            offset: (eye[cross] - cross_start as f64).abs(),
            ring_step: steps[ring] * ring_sign,
            cross_step: steps[cross] * cross_sign,
            ring_cell_m: cells[ring],
            cross_cell_m: cells[cross],
        }
    }

    /// How far a ring lies from the observer, in cells; for ring 0 as far behind, or 0.
    pub fn x_of(&self, ring: usize) -> f64 {
        let at = self.ring_start + self.ring_sign * ring as i64;
        self.ring_sign as f64 * (at as f64 - self.eye)
    }

    /// Where post `j` of a ring stands in the order of the lattice's heights.
    pub fn index(&self, ring: usize, j: i64) -> usize {
        let Post { column, row } = self.post(ring, j);
        (i64::from(row) * self.columns + i64::from(column)) as usize
    }

    /// Post `j` of a ring.
    pub fn post(&self, ring: usize, j: i64) -> Post {
        let ring = (self.ring_start + self.ring_sign * ring as i64) as u32;
        let cross = (self.cross_start + self.cross_sign * j) as u32;
        match self.ring_axis {
            OctantAxis::Columns => Post { column: ring, row: cross },
            OctantAxis::Rows => Post { column: cross, row: ring },
        }
    }

    /// 0 where the even posts of a ring are those that diagonals join, 1 where the odd ones are.
    pub fn parity(&self, ring: usize) -> i64 {
        (self.ring_start + self.ring_sign * ring as i64 + self.cross_start).rem_euclid(2)
    }

    /// The directions of the rays `from` and `to` on the map, meters east and north.
    pub fn directions(&self, (from, to): (f64, f64)) -> [DVec2; 2] {
        [from, to].map(|u| {
            let ring = self.ring_sign as f64 * self.ring_cell_m;
            let cross = self.cross_sign as f64 * self.cross_cell_m * u;
            match self.ring_axis {
                OctantAxis::Columns => DVec2::new(ring, cross),
                OctantAxis::Rows => DVec2::new(cross, ring),
            }
        })
    }
}
