//! A pad: ground leveled for something to stand on, with batters down and up to the ground around it.
//!
//! ```text
//!        ____ ground          level ± distance / slope: between the two the ground stays as it is,
//!       ╱                     beyond them it is cut or filled to the nearer, out to the daylight line,
//!  ────●─── pad ───●          where neither changes anything
//!                   ╲______
//! ```

use glam::DVec2;

use crate::earthworks::leveling;
use crate::geom::polygon;
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::volumes::Volumes;

/// How steep the earth stands beside a pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Batters {
    /// Meters out for each meter up, where the pad is cut into the ground; above 0.
    pub cut: f64,
    /// Meters out for each meter down, where it stands above the ground; above 0.
    pub fill: f64,
}

impl Default for Batters {
    /// One to one in a cutting, one and a half to one on an embankment: what firm and what heaped soil hold.
    fn default() -> Self {
        Self { cut: 1.0, fill: 1.5 }
    }
}

/// How many cells a batter reaches at most: a level far above or below the ground ends there in a step, and the cost of
/// a pad has a bound.
const MAX_REACH: u32 = 64;

/// Levels the ground within a convex counter-clockwise `outline` to `level_m`, as [`leveling::level`] does, and brings
/// the ground around it up or down to the batters; the volumes are those of both.
///
/// All that changes is pinned. Posts that were pinned before, a road's or a lake's, are left as they are beside the pad.
pub fn pad(lattice: &mut Lattice, outline: &[DVec2], level_m: f64, batters: Batters) -> Volumes {
    let mut volumes = leveling::level(lattice, &[outline.to_vec()], level_m as f32);
    let bounds = polygon::bounds(outline);
    let (low, high) = (lattice.grid_at(bounds.min).floor(), lattice.grid_at(bounds.max).ceil());
    for reach in 0..=MAX_REACH {
        let mut changed = reach == 0;
        for post in frame(lattice, (low, high), reach) {
            let moved = batter(lattice, post, (outline, level_m), batters);
            changed |= moved != Volumes::default();
            volumes.cut_m3 += moved.cut_m3;
            volumes.fill_m3 += moved.fill_m3;
        }
        if !changed {
            break;
        }
    }
    volumes
}

/// The posts on the border of a rectangle in grid coordinates grown by `reach`, all of them where that is 0; as far as the
/// lattice has them.
fn frame(lattice: &Lattice, (low, high): (DVec2, DVec2), reach: u32) -> Vec<Post> {
    let (low, high) = (low - f64::from(reach), high + f64::from(reach));
    let last = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
    let (first, end) = (low.max(DVec2::ZERO), high.min(last));
    let mut posts = Vec::new();
    if !first.cmple(end).all() {
        return posts;
    }
    let columns = first.x as u32..=end.x as u32;
    for row in first.y as u32..=end.y as u32 {
        let mut take = |column: u32| posts.push(Post { column, row });
        if reach == 0 || f64::from(row) == low.y || f64::from(row) == high.y {
            columns.clone().for_each(take);
        } else {
            let sides = [low.x, high.x].into_iter().filter(|&side| (0.0..=last.x).contains(&side));
            sides.for_each(|side| take(side as u32));
        }
    }
    posts
}

/// Brings one post to the batters.
fn batter(
    lattice: &mut Lattice,
    post: Post,
    (outline, level_m): (&[DVec2], f64),
    batters: Batters,
) -> Volumes {
    let ground = f64::from(lattice.height(post));
    if lattice.is_pinned(post) || ground.is_nan() {
        return Volumes::default();
    }
    let at = lattice.position(post).as_dvec2();
    let distance = polygon::edges(outline).map(|edge| distance_to(edge, at)).fold(f64::INFINITY, f64::min);
    let batter = ground.clamp(level_m - distance / batters.fill, level_m + distance / batters.cut);
    if batter == ground {
        return Volumes::default();
    }
    lattice.pin(post, batter as f32);
    let cell_area = lattice.cell().x * lattice.cell().y;
    let rise = batter - ground;
    Volumes { cut_m3: (-rise).max(0.0) * cell_area, fill_m3: rise.max(0.0) * cell_area }
}

fn distance_to((from, to): (DVec2, DVec2), at: DVec2) -> f64 {
    let way = to - from;
    let part = (at - from).dot(way) / way.length_squared();
    at.distance(from + way * part.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat2;

    /// 101 × 101 posts 1 m apart, rising east and north.
    fn slope(rise: DVec2) -> Lattice {
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
    fn within_the_outline_it_is_level_and_beside_it_no_batter_is_steeper_than_stated() {
        for quarter in 0..4 {
            let mut lattice = slope(DVec2::new(0.2, 0.1));
            let outline = outline(f64::from(quarter) * 0.4);
            let level = 115.0;
            let volumes = pad(&mut lattice, &outline, level, Batters::default());
            assert!(volumes.cut_m3 > 50.0 && volumes.fill_m3 > 50.0, "{volumes:?}");
            for post in lattice.posts() {
                let at = lattice.position(post).as_dvec2();
                let height = f64::from(lattice.height(post));
                let distance =
                    polygon::edges(&outline).map(|edge| distance_to(edge, at)).fold(f64::INFINITY, f64::min);
                if polygon::contains([&outline[..]], at) {
                    assert_eq!(height, level, "at {at}");
                } else {
                    assert!(height <= level + distance + 1e-4 && height >= level - distance / 1.5 - 1e-4);
                }
            }
        }
    }

    #[test]
    fn volumes_are_the_difference_of_the_heights() {
        let before = slope(DVec2::new(0.3, 0.0));
        let mut lattice = before.clone();
        let volumes = pad(&mut lattice, &outline(0.3), 116.0, Batters::default());
        let moved = |sign: f64| -> f64 {
            let rises = lattice.heights().iter().zip(before.heights());
            rises.map(|(now, then)| (f64::from(now - then) * sign).max(0.0)).sum()
        };
        assert!((volumes.fill_m3 - moved(1.0)).abs() < 1e-2 && (volumes.cut_m3 - moved(-1.0)).abs() < 1e-2);
    }

    #[test]
    fn what_was_pinned_beside_it_stays() {
        let mut lattice = slope(DVec2::new(0.5, 0.0));
        let road = Post { column: 60, row: 50 };
        lattice.pin(road, 130.0);
        pad(&mut lattice, &outline(0.0), 125.0, Batters::default());
        assert_eq!(lattice.height(road), 130.0);
    }

    #[test]
    fn a_pad_off_the_ground_or_far_above_it_ends() {
        let mut lattice = slope(DVec2::ZERO);
        let far: Vec<DVec2> = outline(0.0).iter().map(|corner| corner + 1e6).collect();
        assert_eq!(pad(&mut lattice, &far, 5.0, Batters::default()), Volumes::default());
        assert!(pad(&mut lattice, &outline(0.0), 1e6, Batters::default()).fill_m3 > 1e6);
    }
}
