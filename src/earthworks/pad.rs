//! A pad: leveled ground under a structure, with batters down and up to the ground around it.
//!
//! ```text
//!        ____ ground          level ± distance / slope: between the two the ground stays as it is,
//!       ╱                     beyond them it is cut or filled to the nearer, out to the daylight line,
//!  ────●─── pad ───●          where neither changes anything
//!                   ╲______
//! ```

use glam::DVec2;

use crate::leveling;
use sandtable_geom::polygon;
use sandtable_geom::segment;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::volumes::Volumes;

/// The slopes beside a pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Batters {
    /// Meters out for each meter up, where the pad is cut into the ground; above 0.
    pub cut: f64,
    /// Meters out for each meter down, where it is above the ground; above 0.
    pub fill: f64,
}

impl Default for Batters {
    /// One to one in a cutting, one and a half to one on an embankment: common for firm and for loose soil.
    fn default() -> Self {
        Self { cut: 1.0, fill: 1.5 }
    }
}

/// The most cells that a batter reaches, to bound the cost: a longer one ends in a step.
const MAX_REACH: u32 = 64;

/// A convex counter-clockwise outline and the level of the ground in it.
struct PadShape<'a> {
    outline: &'a [DVec2],
    level_m: f64,
    batters: Batters,
}

/// Levels the ground within a convex counter-clockwise `outline` to `level_m`, as [`leveling::level`] does, and brings the
/// ground around it up or down to the batters; returns the volumes of both.
///
/// All changed posts are pinned. Posts that were pinned before, a road's or a lake's, stay as they are beside the pad.
pub fn build_pad(lattice: &mut Lattice, outline: &[DVec2], level_m: f64, batters: Batters) -> Volumes {
    let shape = PadShape { outline, level_m, batters };
    let mut volumes = leveling::level(lattice, &[outline.to_vec()], level_m as f32);
    for reach in 0..=MAX_REACH {
        let mut is_changed = reach == 0;
        for post in posts_at(lattice, outline, reach) {
            let moved = shape.batter(lattice, post);
            is_changed |= moved != Volumes::default();
            volumes += moved;
        }
        if !is_changed {
            break;
        }
    }
    volumes
}

/// The posts on the border of the outline's rectangle of cells extended by `reach` cells; all posts in it where that is 0.
fn posts_at(lattice: &Lattice, outline: &[DVec2], reach: u32) -> impl Iterator<Item = Post> + use<> {
    let (bounds, reach_cells) = (polygon::bounds(outline), f64::from(reach));
    let low = lattice.grid_at(bounds.min).floor() - reach_cells;
    let high = lattice.grid_at(bounds.max).ceil() + reach_cells;
    let is_border = move |at: f64, axis: usize| reach == 0 || at == low[axis] || at == high[axis];
    PostRect::between(lattice, low, high).into_iter().flat_map(move |rect| {
        (rect.first.row..=rect.last.row).flat_map(move |row| {
            let is_whole = is_border(f64::from(row), 1);
            let step = if is_whole { 1 } else { (rect.width() - 1).max(1) };
            let columns = (rect.first.column..=rect.last.column).step_by(step);
            let columns = columns.filter(move |&column| is_whole || is_border(f64::from(column), 0));
            columns.map(move |column| Post { column, row })
        })
    })
}

impl PadShape<'_> {
    /// Brings one post to the batters.
    fn batter(&self, lattice: &mut Lattice, post: Post) -> Volumes {
        let ground_m = f64::from(lattice.height(post));
        if lattice.is_pinned(post) || ground_m.is_nan() {
            return Volumes::default();
        }
        let distance_m = distance_m(self.outline, lattice.position(post).as_dvec2());
        let lowest_m = self.level_m - distance_m / self.batters.fill;
        let batter_m = ground_m.clamp(lowest_m, self.level_m + distance_m / self.batters.cut);
        if batter_m == ground_m {
            return Volumes::default();
        }
        lattice.pin(post, batter_m as f32);
        Volumes::from_rise(batter_m - ground_m, lattice.cell_m2())
    }
}

/// The distance from a point to the border of an outline.
fn distance_m(outline: &[DVec2], at: DVec2) -> f64 {
    let squares = polygon::edges(outline).map(|edge| segment::distance_squared(edge, at));
    squares.fold(f64::INFINITY, f64::min).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use glam::DMat2;

    /// 101 × 101 posts 1 m apart, rising east and north.
    pub fn slope(rise: DVec2) -> Lattice {
        let at = |index: u32| DVec2::new(f64::from(index % 101), f64::from(index / 101));
        let heights = (0..101 * 101).map(|index| (100.0 + at(index).dot(rise)) as f32).collect();
        Lattice::new(DVec2::ZERO, DVec2::ONE, 101, heights).expect("sound")
    }

    fn outline(turn: f64) -> Vec<DVec2> {
        let turned =
            DMat2::from_cols_array(&[libm::cos(turn), libm::sin(turn), -libm::sin(turn), libm::cos(turn)]);
        let corners = [(-6.0, -4.0), (6.0, -4.0), (6.0, 4.0), (-6.0, 4.0)];
        corners.map(|(x, y)| DVec2::splat(50.0) + turned * DVec2::new(x, y)).to_vec()
    }

    #[test]
    fn a_pad_is_level_and_no_batter_is_steeper_than_stated() {
        for quarter in 0..4 {
            let mut lattice = slope(DVec2::new(0.2, 0.1));
            let outline = outline(f64::from(quarter) * 0.4);
            let level = 115.0;
            let volumes = build_pad(&mut lattice, &outline, level, Batters::default());
            assert!(volumes.cut_m3 > 50.0 && volumes.fill_m3 > 50.0, "{volumes:?}");
            for post in lattice.posts() {
                let at = lattice.position(post).as_dvec2();
                let height = f64::from(lattice.height(post));
                let distance = distance_m(&outline, at);
                if polygon::contains([&outline[..]], at) {
                    assert_eq!(height, level, "at {at}");
                } else {
                    assert!(height <= level + distance + 1e-4 && height >= level - distance / 1.5 - 1e-4);
                }
            }
        }
    }

    #[test]
    fn volumes_are_the_differences_of_the_heights() {
        let before = slope(DVec2::new(0.3, 0.0));
        let mut lattice = before.clone();
        let volumes = build_pad(&mut lattice, &outline(0.3), 116.0, Batters::default());
        let moved = |sign: f64| -> f64 {
            let rises = lattice.heights().iter().zip(before.heights());
            rises.map(|(now, then)| (f64::from(now - then) * sign).max(0.0)).sum()
        };
        assert!((volumes.fill_m3 - moved(1.0)).abs() < 1e-2 && (volumes.cut_m3 - moved(-1.0)).abs() < 1e-2);
    }

    #[test]
    fn pinned_posts_beside_a_pad_stay() {
        let mut lattice = slope(DVec2::new(0.5, 0.0));
        let road = Post { column: 60, row: 50 };
        lattice.pin(road, 130.0);
        build_pad(&mut lattice, &outline(0.0), 125.0, Batters::default());
        assert_eq!(lattice.height(road), 130.0);
    }

    #[test]
    fn a_pad_off_the_ground_or_far_above_it_ends() {
        let mut lattice = slope(DVec2::ZERO);
        let far: Vec<DVec2> = outline(0.0).iter().map(|corner| corner + 1e6).collect();
        assert_eq!(build_pad(&mut lattice, &far, 5.0, Batters::default()), Volumes::default());
        assert!(build_pad(&mut lattice, &outline(0.0), 1e6, Batters::default()).fill_m3 > 1e6);
    }
}
