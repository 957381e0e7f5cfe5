//! Intersections of rays with the ground.
//!
//! A ray is cut to its part over the lattice and between its lowest and highest post. That part runs over the finest
//! triangles as a line of sight does, and between two neighboring crossings both it and the ground are straight: it meets
//! the ground where its height over the ground changes sign, at a position that follows exactly.
//!
//! Triangles have two sides; a ray from below meets the ground as one from above does. Triangles with a corner without
//! data are holes. The model has no sides and no bottom: a ray that enters below the ground may meet it from below.

use std::ops::ControlFlow;

use glam::{DVec2, DVec3};

use crate::cell_triangle::{CellTriangle, Diagonal};
use crate::lattice::{Lattice, Post};
use crate::query::{Interpolation, ground_height};
use crate::sight::crossings::{LineCrossing, LinePart};
use crate::sight::descent::{Probe, descend};
use crate::sight::ground::SightGround;

/// A half-line in world space, meters from the lattice's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Its direction; of any length but 0.
    pub direction: DVec3,
}

/// The first intersection of a ray with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Meters along the ray.
    pub distance_m: f64,
    /// World space, meters; its Z is the ground's height.
    pub at: DVec3,
    /// The triangle's normal, of length 1 and upward whichever side was met.
    pub normal: DVec3,
}

impl SightGround {
    /// The point where `ray` first meets a finest triangle, borders included, at most `farthest_m` along it; `None`
    /// where it does not, or where the ray is not finite or has no direction.
    ///
    /// A ray within a triangle's plane meets it where it enters it.
    pub fn pick(&self, ray: Ray, farthest_m: f64) -> Option<RayHit> {
        let span = RaySpan::new(self, ray, farthest_m)?;
        let lattice = self.lattice();
        if span.grid.0 == span.grid.1 {
            return span.plumb_hit(lattice, ray);
        }
        let mut search = RaySearch { lattice, span: &span, before: None, reaches_end: false };
        let met = match descend(lattice, self.pyramid(), span.grid, &mut search) {
            ControlFlow::Break(met) => met,
            ControlFlow::Continue(()) => search.at_end()?,
        };
        Some(span.hit(lattice, met))
    }
}

/// The part of a ray that can meet the ground.
struct RaySpan {
    /// Meters along the ray, where it begins and ends.
    meters: (f64, f64),
    /// Both ends' grid positions, on the lattice.
    grid: (DVec2, DVec2),
    /// Both ends' heights.
    z: (f64, f64),
    /// The error of the ray and of the ground under it, in meters.
    margin_m: f64,
}

/// A triangle that a ray meets, and at which part of its span.
struct Met {
    part: f64,
    plane: TrianglePlane,
}

impl RaySpan {
    fn new(ground: &SightGround, ray: Ray, farthest_m: f64) -> Option<Self> {
        let lattice = ground.lattice();
        let direction = ray.direction.try_normalize()?;
        if !ray.origin.is_finite() || farthest_m.is_nan() {
            return None;
        }
        let extent = lattice.extent();
        let (low, high) = ground.pyramid().height_range();
        let (low, high) = (f64::from(low), f64::from(high));
        // More than rounding, so that the highest post's plane is not cut away.
        let room = 1e-3 + 1e-9 * (low.abs().max(high.abs()) + ray.origin.z.abs());
        let (min, max) = (extent.min.extend(low - room), extent.max.extend(high + room));
        let meters = clip_to_box(ray.origin, direction, (min, max), (0.0, farthest_m))?;
        let at = |meters: f64| ray.origin + direction * meters;
        let (first, end) = (at(meters.0), at(meters.1));
        // Rounding may leave an end on the border just beside it.
        let grid = |at: DVec3| lattice.grid_at(at.truncate()).clamp(DVec2::ZERO, lattice.last_grid());
        let z = (first.z, end.z);
        let margin_m = ground.slack_m() + 8.0 * f64::EPSILON * (z.0.abs() + z.1.abs());
        Some(Self { meters, grid: (grid(first), grid(end)), z, margin_m })
    }

    /// The ray's height at a part of the span.
    #[inline]
    fn z(&self, part: f64) -> f64 {
        self.z.0 + (self.z.1 - self.z.0) * part
    }

    fn grid(&self, part: f64) -> DVec2 {
        self.grid.0 + (self.grid.1 - self.grid.0) * part
    }

    /// Where a ray straight up or down meets the ground.
    fn plumb_hit(&self, lattice: &Lattice, ray: Ray) -> Option<RayHit> {
        let grid = self.grid.0;
        let map = lattice.origin() + (grid + lattice.first().grid()) * lattice.cell();
        // On an edge the height is that of the posts it joins alone.
        let height = ground_height(lattice, Interpolation::Planar, map).height_m()?;
        let (low, high) = (self.z.0.min(self.z.1), self.z.0.max(self.z.1));
        if !(low..=high).contains(&height) {
            return None;
        }
        let distance_m = (height - ray.origin.z) / ray.direction.try_normalize()?.z;
        let normal = TrianglePlane::near(lattice, grid)?.normal(lattice);
        Some(RayHit { distance_m, at: ray.origin.truncate().extend(height), normal })
    }

    fn hit(&self, lattice: &Lattice, met: Met) -> RayHit {
        let grid = self.grid(met.part);
        let world = (grid + lattice.first().grid()) * lattice.cell();
        RayHit {
            distance_m: self.meters.0 + (self.meters.1 - self.meters.0) * met.part,
            at: world.extend(met.plane.height_m(grid)),
            normal: met.plane.normal(lattice),
        }
    }
}

/// The part of a ray, out of `meters` along it, in a box; `None` where there is none.
fn clip_to_box(
    origin: DVec3,
    direction: DVec3,
    (min, max): (DVec3, DVec3),
    mut meters: (f64, f64),
) -> Option<(f64, f64)> {
    for axis in 0..3 {
        let (at, along) = (origin[axis], direction[axis]);
        if along == 0.0 {
            if !(at >= min[axis] && at <= max[axis]) {
                return None;
            }
            continue;
        }
        let (near, far) = if along > 0.0 { (min[axis], max[axis]) } else { (max[axis], min[axis]) };
        meters = (f64::max(meters.0, (near - at) / along), f64::min(meters.1, (far - at) / along));
    }
    (meters.0 <= meters.1).then_some(meters)
}

/// The search for the first triangle that a ray meets.
struct RaySearch<'a> {
    lattice: &'a Lattice,
    span: &'a RaySpan,
    /// The part of the crossing before, and the ray's height over the ground there.
    before: Option<(f64, f64)>,
    /// Whether that crossing is the last of the span.
    reaches_end: bool,
}

impl RaySearch<'_> {
    /// Where the ray meets the triangle between the crossing before and a part with the ray's height over the ground,
    /// `None` for one that is not a crossing.
    fn between(&self, (end, over): (f64, Option<f64>)) -> Option<Met> {
        let start = self.before.map_or(0.0, |(part, _)| part);
        let plane = || TrianglePlane::between(self.lattice, self.span.grid(start), self.span.grid(end));
        // The span's ends lie within a triangle, whose plane gives the ground there.
        let over_at = |part: f64| Some(self.span.z(part) - plane()?.height_m(self.span.grid(part)));
        let first = self.before.map(|(_, over)| over).or_else(|| over_at(start))?;
        let second = over.or_else(|| over_at(end))?;
        let changes_side = (first <= 0.0 && second >= 0.0) || (first >= 0.0 && second <= 0.0);
        if !changes_side {
            return None;
        }
        let share = if first == second { 0.0 } else { first / (first - second) };
        Some(Met { part: start + (end - start) * share, plane: plane()? })
    }

    /// Where the ray meets the last triangle of its span.
    fn at_end(&self) -> Option<Met> {
        if self.reaches_end { self.between((1.0, None)) } else { None }
    }
}

impl Probe for RaySearch<'_> {
    type Found = Met;

    #[inline]
    fn rules_out(&self, part: LinePart, highest_m: f64, lowest_m: impl FnOnce() -> f64) -> bool {
        let ends = (self.span.z(part.0), self.span.z(part.1));
        let margin_m = self.span.margin_m;
        ends.0.min(ends.1) > highest_m + margin_m || ends.0.max(ends.1) < lowest_m() - margin_m
    }

    fn resume(&mut self, part: f64) {
        self.before = (part > 0.0).then_some((part, f64::NAN));
    }

    fn finish(&mut self) {
        self.reaches_end = true;
    }

    #[inline]
    fn visit(&mut self, crossing: LineCrossing) -> ControlFlow<Met> {
        let over = self.span.z(crossing.part) - crossing.height_m;
        let may_change_side = self.before.is_none_or(|(_, before)| before * over <= 0.0);
        if may_change_side && let Some(met) = self.between((crossing.part, Some(over))) {
            return ControlFlow::Break(met);
        }
        self.before = Some((crossing.part, over));
        ControlFlow::Continue(())
    }
}

/// The plane of a finest triangle, over grid positions.
struct TrianglePlane {
    corner: DVec2,
    south_west_m: f64,
    /// Meters of rise per cell, eastward and northward.
    slope: DVec2,
}

impl TrianglePlane {
    /// The triangle under a line between two grid positions that meets no edge between them; `None` where it has no data.
    /// Under a line along an edge, one of the two that has data.
    fn between(lattice: &Lattice, from: DVec2, to: DVec2) -> Option<Self> {
        let aside = (to - from).perp().normalize_or_zero() * BESIDE;
        let middle = 0.5 * (from + to);
        [middle, middle + aside, middle - aside].into_iter().find_map(|at| Self::at(lattice, at))
    }

    /// The triangle at a grid position; on an edge or at a post any that has data.
    fn near(lattice: &Lattice, at: DVec2) -> Option<Self> {
        // Two directions in each quadrant, on both sides of a diagonal.
        let aside =
            [DVec2::new(2.0, 1.0), DVec2::new(1.0, 2.0), DVec2::new(-1.0, 2.0), DVec2::new(-2.0, 1.0)];
        let around = aside.into_iter().chain(aside.map(|aside| -aside)).map(|aside| at + aside * BESIDE);
        std::iter::once(at).chain(around).find_map(|at| Self::at(lattice, at))
    }

    /// The triangle at a grid position; on an edge the one to the south or east.
    fn at(lattice: &Lattice, at: DVec2) -> Option<Self> {
        let corner = at.floor().clamp(DVec2::ZERO, lattice.last_grid() - 1.0);
        let cell = Post::at_grid(corner);
        let corners = lattice.corner_heights(cell).map(f64::from);
        let triangle = CellTriangle::holding(Diagonal::of_cell(cell), at - corner);
        let [sw, se, nw, ne] = corners;
        let south_west_m = if triangle == CellTriangle::NorthEast { se + nw - ne } else { sw };
        let plane = Self { corner, south_west_m, slope: triangle.slope(corners) };
        (!plane.south_west_m.is_nan() && !plane.slope.is_nan()).then_some(plane)
    }

    fn height_m(&self, grid: DVec2) -> f64 {
        self.south_west_m + self.slope.dot(grid - self.corner)
    }

    fn normal(&self, lattice: &Lattice) -> DVec3 {
        (-self.slope / lattice.cell()).extend(1.0).normalize()
    }
}

/// How far beside an edge, in cells, its triangles are looked up: more than rounding, less than any triangle.
const BESIDE: f64 = 1e-6;
