//! Occupied ground: roads, water, buildings and models, as triangles in plan.
//!
//! Triangles of a meter and of a lake's length lie in one scene. Each is kept in squares about its own size, a grid for
//! each power of two, so that it lies in few of them and a place looks at few triangles, however they are mixed.

use std::collections::{BTreeSet, HashMap};

use glam::DVec2;

use sandtable_geom::convex;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::segment;

/// A grid's squares have sides of two to this power, in meters.
type Power = i32;

/// The power of the widest grid; a triangle that is wider still lies in several of its squares.
const HIGHEST: Power = 40;
/// Ground lies no farther from the origin than this, in meters, and what lies beyond takes none: some twenty squares of
/// the widest grid.
const FARTHEST_M: f64 = 1e13;

/// Finds out whether a place is free.
#[derive(Default)]
pub struct Taken {
    triangles: Vec<[DVec2; 3]>,
    powers: BTreeSet<Power>,
    squares: HashMap<(Power, i64, i64), Vec<u32>>,
}

impl Taken {
    /// Takes a triangle's ground; one without area, or running clockwise, takes none.
    pub fn add(&mut self, triangle: [DVec2; 3]) {
        let has_area = polygon::doubled_triangle_area(triangle) > 0.0;
        if !has_area {
            return;
        }
        let bounds = polygon::bounds(&triangle);
        let power = power_of(bounds.size().max_element());
        let index = self.triangles.len() as u32;
        self.triangles.push(triangle);
        self.powers.insert(power);
        for (x, y) in squares(&bounds, power) {
            self.squares.entry((power, x, y)).or_default().push(index);
        }
    }

    /// Takes a convex counter-clockwise polygon's ground.
    pub fn add_convex(&mut self, polygon: &[DVec2]) {
        polygon::fan(polygon).for_each(|triangle| self.add(triangle));
    }

    /// Whether nothing is taken within `clear_m` of a place.
    pub fn is_free(&self, at: DVec2, clear_m: f64) -> bool {
        let reach = Rect { min: at, max: at }.grown(clear_m);
        self.powers.iter().all(|&power| {
            squares(&reach, power)
                .filter_map(|(x, y)| self.squares.get(&(power, x, y)))
                .flatten()
                .all(|&index| !is_near(&self.triangles[index as usize], at, clear_m))
        })
    }
}

/// The least power of two that is at least `size`.
fn power_of(size: f64) -> Power {
    let mut power = 0;
    while power < HIGHEST && libm::ldexp(1.0, power) < size {
        power += 1;
    }
    power
}

/// The squares of a grid that a rectangle meets.
fn squares(rect: &Rect, power: Power) -> impl Iterator<Item = (i64, i64)> + use<> {
    let side = libm::ldexp(1.0, power);
    let reach = DVec2::splat(FARTHEST_M);
    let square = |at: DVec2| (at.clamp(-reach, reach) / side).floor();
    let (low, high) = (square(rect.min), square(rect.max));
    (low.y as i64..=high.y as i64).flat_map(move |y| (low.x as i64..=high.x as i64).map(move |x| (x, y)))
}

/// Whether a place lies in a counter-clockwise triangle or no farther from it than `clear_m`.
fn is_near(triangle: &[DVec2; 3], at: DVec2, clear_m: f64) -> bool {
    convex::contains(triangle, at)
        || polygon::edges(triangle).any(|edge| segment::distance_squared(edge, at) < clear_m * clear_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn great_and_small_triangles_take_their_ground_and_a_margin() {
        let mut taken = Taken::default();
        taken.add([DVec2::ZERO, DVec2::new(9000.0, 0.0), DVec2::new(0.0, 9000.0)]);
        taken.add_convex(&[(-30.0, 5.0), (-20.0, 5.0), (-20.0, 9.0), (-30.0, 9.0)].map(DVec2::from));
        assert!(!taken.is_free(DVec2::new(4000.0, 4000.0), 0.0));
        assert!(taken.is_free(DVec2::new(4600.0, 4600.0), 100.0));
        assert!(!taken.is_free(DVec2::new(4600.0, 4600.0), 150.0));
        assert!(!taken.is_free(DVec2::new(-25.0, 7.0), 0.0));
        assert!(taken.is_free(DVec2::new(-25.0, 12.0), 2.9) && !taken.is_free(DVec2::new(-25.0, 12.0), 3.1));
    }

    #[test]
    fn what_has_no_area_takes_nothing() {
        let mut taken = Taken::default();
        taken.add([DVec2::ZERO, DVec2::X, DVec2::X * 2.0]);
        taken.add([DVec2::NAN, DVec2::X, DVec2::Y]);
        taken.add([DVec2::ZERO, DVec2::Y, DVec2::X]);
        assert!(taken.is_free(DVec2::splat(0.1), 5.0));
    }
}
