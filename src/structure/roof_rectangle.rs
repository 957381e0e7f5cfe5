//! The rectangle that a footprint fills best, and how a roof is turned on it.

use glam::DVec2;

use sandtable_geom::polygon;

/// How much of its best-fitting rectangle a footprint must fill to be roofed like one.
const RECTANGULAR: f64 = 0.82;

/// The most vertices of a footprint for which its best-fitting rectangle is looked for.
const MOST_VERTICES: usize = 400;

/// How a roof is turned on its footprint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum RoofTurn {
    /// Its ridge runs along the longer sides; a single slope falls to one of them.
    #[default]
    Along,
    /// Its ridge runs along the shorter sides.
    Across,
    /// A slope falls in this direction, a unit vector in plan; the ridge runs along the sides that are nearer to square to
    /// it.
    Facing(DVec2),
}

/// The smallest rectangle around a ring that has a side along one of its edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoofRectangle {
    pub center: DVec2,
    /// A unit vector along the ridge: along the longer sides unless it is turned.
    pub along: DVec2,
    /// Half the side along the ridge and half the other.
    half: DVec2,
}

impl RoofRectangle {
    /// The rectangle around a ring; `None` where the ring has too many vertices, or no sides.
    pub fn around(ring: &[DVec2]) -> Option<Self> {
        if ring.len() > MOST_VERTICES {
            return None;
        }
        let frames = polygon::edges(ring).filter_map(|(from, to)| (to - from).try_normalize());
        frames.map(|along| Self::along(ring, along)).min_by(|a, b| a.area_m2().total_cmp(&b.area_m2()))
    }

    /// The rectangle around a ring that encloses `area_m2`, turned as stated; `None` where the ring does not fill it.
    pub fn filled(ring: &[DVec2], area_m2: f64, turn: RoofTurn) -> Option<Self> {
        let frame = Self::around(ring)?;
        (area_m2 >= RECTANGULAR * frame.area_m2()).then(|| frame.turned(turn))
    }

    fn along(ring: &[DVec2], along: DVec2) -> Self {
        let spans = |way: DVec2| {
            let reach = ring.iter().map(|at| (at - ring[0]).dot(way));
            reach.fold((0.0, 0.0), |(low, high), at| (f64::min(low, at), f64::max(high, at)))
        };
        let ((x0, x1), (y0, y1)) = (spans(along), spans(along.perp()));
        let center = ring[0] + along * (x0 + x1) / 2.0 + along.perp() * (y0 + y1) / 2.0;
        let half = DVec2::new(x1 - x0, y1 - y0) / 2.0;
        if half.x >= half.y {
            Self { center, along, half }
        } else {
            Self { center, along: along.perp(), half: DVec2::new(half.y, half.x) }
        }
    }

    /// The same rectangle with the ridge as `turn` has it.
    fn turned(self, turn: RoofTurn) -> Self {
        let is_across = match turn {
            RoofTurn::Along => false,
            RoofTurn::Across => true,
            RoofTurn::Facing(way) => way.dot(self.along).abs() > way.perp_dot(self.along).abs(),
        };
        match is_across {
            true => Self { along: self.along.perp(), half: DVec2::new(self.half.y, self.half.x), ..self },
            false => self,
        }
    }

    /// How far a point lies to the left of the ridge.
    pub fn aside(&self, at: DVec2) -> f64 {
        (at - self.center).dot(self.along.perp())
    }

    fn area_m2(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }
}
