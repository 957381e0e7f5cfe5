//! Ways across the triangles of the ground: from a point of the far side of a triangle straight to its corner.
//!
//! ```text
//!   q            A post q lies in eight triangles with its ring of neighbors: q, the post a straight beside it, and a
//!   |\ \         diagonal one b. A way to q may begin at a point of the side from a to b, where the time is that between
//!   | \  \       the times of a and b (Gonzalez and Rofman 1985; Sethian and Vladimirsky 2003). Its grade is that of the
//!   a--*---b     triangle's plane, its pace lies between those of a and b.
//! ```
//!
//! The points are a few fixed ones, and one where the grade is the best there is, or the slope across the greatest that is
//! passed: costs have corners there, and the quickest zigzags follow them. Which points there are depends on the ground
//! alone, so that an arrival never falls as the times of a and b rise, in f32 too: the least times are the same in whatever
//! order posts are reached.

use crate::movement::grade::GradeTable;
use glam::DVec2;

/// The shares of the side at which ways begin: the first [`FEW`] nearly as far apart as the directions of steps beside
/// them, all where slopes across slow a vehicle.
const SHARES: [f32; 8] = [0.16, 0.33, 0.73, 0.08, 0.24, 0.42, 0.62, 0.86];

/// The shares that are tried everywhere.
const FEW: usize = 3;

/// The corners of a triangle: of the side from which ways lead, `a` straight beside the post `q` and `b` diagonal to it.
#[derive(Clone, Copy)]
pub(super) struct TravelTriangle {
    /// The times of a and b, seconds.
    pub times_s: [f32; 2],
    /// The heights of a, b and q, meters.
    pub heights_m: [f32; 3],
    /// The mean paces from a to q and from b to q, seconds per meter.
    pub paces: [f32; 2],
    /// Whether it lies on a road, a bridge or a ford.
    pub is_way: bool,
}

/// The triangles of a lattice, by the axis along which a lies beside q.
pub(super) struct TriangleTable {
    axes: [TriangleAxis; 2],
}

struct TriangleAxis {
    /// From a to q, meters.
    straight_m: f32,
    /// From a to b, meters.
    side_m: f32,
    few: [SidePoint; FEW],
    more: [SidePoint; SHARES.len() - FEW],
    /// The reciprocal of the length from b to q.
    per_diagonal_m: f32,
}

/// A point of a side.
#[derive(Clone, Copy)]
struct SidePoint {
    share: f32,
    rest: f32,
    length_m: f32,
    per_length_m: f32,
}

impl TriangleTable {
    /// The triangles of a lattice with cells of this size.
    pub fn new(cell: DVec2) -> Self {
        let axis = |straight_m: f64, side_m: f64| {
            let point = |share: f32| {
                let length_m = libm::hypot(straight_m, f64::from(share) * side_m);
                let [length_m, per_length_m] = [length_m as f32, (1.0 / length_m) as f32];
                SidePoint { share, rest: 1.0 - share, length_m, per_length_m }
            };
            TriangleAxis {
                straight_m: straight_m as f32,
                side_m: side_m as f32,
                few: std::array::from_fn(|index| point(SHARES[index])),
                more: std::array::from_fn(|index| point(SHARES[FEW + index])),
                per_diagonal_m: (1.0 / libm::hypot(straight_m, side_m)) as f32,
            }
        };
        Self { axes: [axis(cell.x, cell.y), axis(cell.y, cell.x)] }
    }

    /// The least time at q over the points of its side; `axis` is 0 where a lies beside q in its row, else 1. `ACROSS` where
    /// slopes across slow the vehicle.
    #[inline(always)]
    pub fn arrival_s<const ACROSS: bool>(
        &self,
        triangle: &TravelTriangle,
        axis: usize,
        grades: &GradeTable,
    ) -> f32 {
        let axis = &self.axes[axis];
        let [height_a, height_b, height_q] = triangle.heights_m;
        let (rise, side_rise) = (height_q - height_a, height_b - height_a);
        if triangle.is_way {
            let arrival = |point: &SidePoint| {
                let grade = (rise - point.share * side_rise) * point.per_length_m;
                triangle.arrival_s(point, grades.on_way(grade))
            };
            return axis.few.iter().map(arrival).fold(f32::INFINITY, f32::min);
        }
        // Cross products of the gradient with the way are these two, times the share and 1.
        let (across_side, across_straight) = match ACROSS {
            true => (rise * (axis.side_m / axis.straight_m), side_rise * (axis.straight_m / axis.side_m)),
            false => (0.0, 0.0),
        };
        let arrival = |point: &SidePoint| {
            let grade = (rise - point.share * side_rise) * point.per_length_m;
            let mut factor = grades.open(grade);
            if ACROSS {
                let across = (point.share * across_side + across_straight) * point.per_length_m;
                factor *= grades.across(across.abs());
            }
            triangle.arrival_s(point, factor)
        };
        let mut least_s = f32::INFINITY;
        for point in &axis.few {
            least_s = least_s.min(arrival(point));
        }
        if !ACROSS {
            if let Some(share) = axis.share_of_grade(rise, side_rise, grades.best_grade()) {
                least_s = least_s.min(arrival(&axis.point(share)));
            }
            return least_s;
        }
        let gradient = [rise / axis.straight_m, side_rise / axis.side_m];
        let slope2 = gradient[0] * gradient[0] + gradient[1] * gradient[1];
        if grades.is_slowed_across(slope2) {
            for point in &axis.more {
                least_s = least_s.min(arrival(point));
            }
            let limit = grades.across_limit();
            if let Some(share) = axis.share_of_across([across_side, across_straight], gradient, limit) {
                least_s = least_s.min(arrival(&axis.point(share)));
            }
        }
        least_s
    }
}

impl TriangleTable {
    /// The shares of the side at which ways to q begin: all that [`TriangleTable::arrival_s`] may try, and more.
    pub fn shares(
        &self,
        triangle: &TravelTriangle,
        axis: usize,
        grades: &GradeTable,
    ) -> impl Iterator<Item = f32> + use<> {
        let axis = &self.axes[axis];
        let [height_a, height_b, height_q] = triangle.heights_m;
        let (rise, side_rise) = (height_q - height_a, height_b - height_a);
        let of_grade = axis.share_of_grade(rise, side_rise, grades.best_grade());
        let of_across = grades.has_across().then(|| {
            let across =
                [rise * (axis.side_m / axis.straight_m), side_rise * (axis.straight_m / axis.side_m)];
            let gradient = [rise / axis.straight_m, side_rise / axis.side_m];
            axis.share_of_across(across, gradient, grades.across_limit())
        });
        SHARES.into_iter().chain(of_grade).chain(of_across.flatten())
    }
}

impl TravelTriangle {
    /// The time at q of a way that begins at a point, with the factor of its slopes.
    #[inline(always)]
    fn arrival_s(&self, point: &SidePoint, factor: f32) -> f32 {
        let [time_a, time_b] = self.times_s;
        let [pace_a, pace_b] = self.paces;
        let pace = pace_a + point.share * (pace_b - pace_a);
        // Two products, so that it rises with either time.
        (point.rest * time_a + point.share * time_b) + pace * point.length_m * factor
    }
}

impl TriangleAxis {
    #[inline(always)]
    fn point(&self, share: f32) -> SidePoint {
        let along_m = share * self.side_m;
        let length_m = (self.straight_m * self.straight_m + along_m * along_m).sqrt();
        SidePoint { share, rest: 1.0 - share, length_m, per_length_m: 1.0 / length_m }
    }

    /// The share where the way to q has a grade, if it has it once: the gradient, turned by the angle whose cosine is the
    /// grade by the slope.
    #[inline(always)]
    fn share_of_grade(&self, rise: f32, side_rise: f32, grade: f32) -> Option<f32> {
        let at_a = rise - grade * self.straight_m;
        let at_b = (rise - side_rise) * self.per_diagonal_m - grade;
        if (at_a < 0.0) == (at_b < 0.0) {
            return None;
        }
        let (along, beside) = (rise / self.straight_m, side_rise / self.side_m);
        let turned = (along * along + beside * beside - grade * grade).max(0.0).sqrt();
        self.share_of([along, beside], [[grade, turned], [grade, -turned]])
    }

    /// The share where the slope across the way to q is the greatest that is passed, if it is once.
    #[inline]
    fn share_of_across(
        &self,
        [across_side, across_straight]: [f32; 2],
        gradient: [f32; 2],
        limit: f32,
    ) -> Option<f32> {
        let at_a = across_straight / self.straight_m;
        let at_b = (across_side + across_straight) * self.per_diagonal_m;
        let slope2 = gradient[0] * gradient[0] + gradient[1] * gradient[1];
        if (at_a.abs() < limit) == (at_b.abs() < limit) || slope2 <= limit * limit {
            return None;
        }
        let across = -limit.copysign(if at_a.abs() < limit { at_b } else { at_a });
        let grade = (slope2 - limit * limit).sqrt();
        self.share_of(gradient, [[grade, across], [-grade, across]])
    }

    /// The share at which the way has the direction of the gradient, turned and scaled by a complex factor: the first of two
    /// that leads to a point of the side.
    #[inline(always)]
    fn share_of(&self, [along, beside]: [f32; 2], factors: [[f32; 2]; 2]) -> Option<f32> {
        for [real, imaginary] in factors {
            let toward = real * along - imaginary * beside;
            let side = -(real * beside + imaginary * along);
            let share = side / toward * (self.straight_m / self.side_m);
            if toward > 0.0 && share > 0.0 && share < 1.0 {
                return Some(share);
            }
        }
        None
    }
}
