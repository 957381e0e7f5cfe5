//! Level ground within an outline of any shape, with batters down and up to the ground around it: a brush.
//!
//! Unlike a pad ([`crate::pad`]) it pins no post, so that it can be made while the terrain is in use, and its
//! outline may be concave. From the outline the batters are followed outward from post to post, and end where they come
//! to daylight: a hill that rises behind it stays.

use std::collections::VecDeque;

use glam::DVec2;

use crate::brush::BrushChanges;
use crate::leveling::posts_touched;
use crate::pad::Batters;
use sandtable_geom::polygon;
use sandtable_geom::rect::Rect;
use sandtable_geom::rect_tree::RectTree;
use sandtable_geom::segment;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The most cells that a batter reaches, to bound the cost: a longer one ends in a step.
const MAX_REACH: u32 = 64;

/// Ground to be leveled.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelGround {
    /// The outline and its holes, world X and Y, meters.
    pub rings: Vec<Vec<DVec2>>,
    /// Its elevation, meters; `None` for the mean of the ground in the outline.
    pub level_m: Option<f64>,
    /// The slopes beside it. A cutting of 0 is a wall.
    pub batters: Batters,
}

impl LevelGround {
    /// Changes the lattice: the corners of all cells that the outline touches get the level, and posts beside them the
    /// height of a batter where that is nearer to the level than their own. Nothing where the outline holds no data.
    pub fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        let mut changes = BrushChanges::default();
        if let Some(plan) = LevelPlan::new(self, lattice) {
            changes.write(lattice, plan.window, |post, before| match plan.heights[plan.window.index(post)] {
                height if height.is_nan() => before,
                height => height,
            });
        }
        changes
    }

    /// The posts that may change: those of the outline and of the longest batters; `None` off the lattice.
    pub fn window(&self, lattice: &Lattice) -> Option<PostRect> {
        let bounds = Rect::around(self.rings.iter().flatten().copied());
        // The corners of the cells that it touches lie up to a cell outside.
        let core = PostRect::within(lattice, &bounds.grown(lattice.cell().max_element()))?;
        Some(core.grown((MAX_REACH, MAX_REACH), lattice))
    }
}

/// The new heights of the posts of a window, NaN for those that stay.
struct LevelPlan {
    window: PostRect,
    heights: Vec<f32>,
}

impl LevelPlan {
    fn new(ground: &LevelGround, lattice: &Lattice) -> Option<Self> {
        let inside = posts_touched(lattice, &ground.rings);
        let window = ground.window(lattice)?;
        let level_m = ground.level_m.or_else(|| mean_m(lattice, &inside))?;
        let heights = vec![f32::NAN; window.posts().count()];
        let mut plan = Self { window, heights };
        for &post in &inside {
            let index = plan.window.index(post);
            plan.heights[index] = level_m as f32;
        }
        plan.follow_batters(ground, lattice, level_m, inside.into());
        Some(plan)
    }

    /// Visits the posts beside those in `front`, and beside every post that a batter moves, until none moves.
    fn follow_batters(
        &mut self,
        ground: &LevelGround,
        lattice: &Lattice,
        level_m: f64,
        mut front: VecDeque<Post>,
    ) {
        let edges: Vec<(DVec2, DVec2)> = ground
            .rings
            .iter()
            .flat_map(|ring| polygon::edges(ring))
            .filter(|(from, to)| from != to)
            .collect();
        let rects: Vec<Rect> = edges.iter().map(|&(from, to)| Rect::around([from, to])).collect();
        let tree = RectTree::new(&rects);
        let mut is_seen: Vec<bool> = self.heights.iter().map(|height| !height.is_nan()).collect();
        while let Some(post) = front.pop_front() {
            for beside in neighbors(post).filter(|&beside| self.window.contains(beside)) {
                let index = self.window.index(beside);
                if std::mem::replace(&mut is_seen[index], true) {
                    continue;
                }
                let height_m = f64::from(lattice.height(beside));
                let run = if height_m > level_m { ground.batters.cut } else { ground.batters.fill };
                // A batter reaches a post only from edges nearer than this.
                let reach_m = run * (height_m - level_m).abs();
                let at = (lattice.first().grid() + beside.grid()) * lattice.cell();
                let near = tree.meeting(&Rect { min: at, max: at }.grown(reach_m));
                let squares = near.map(|edge| segment::distance_squared(edges[edge], at));
                let distance_m = squares.fold(f64::INFINITY, f64::min).sqrt();
                if distance_m < reach_m {
                    let rise_m = distance_m / run;
                    let batter_m = if height_m > level_m { level_m + rise_m } else { level_m - rise_m };
                    self.heights[index] = batter_m as f32;
                    front.push_back(beside);
                }
            }
        }
    }
}

/// The mean height of the posts that have data, meters; `None` where none has.
fn mean_m(lattice: &Lattice, posts: &[Post]) -> Option<f64> {
    let heights = posts.iter().map(|&post| f64::from(lattice.height(post))).filter(|height| !height.is_nan());
    let (sum, count) = heights.fold((0.0, 0.0), |(sum, count), height| (sum + height, count + 1.0));
    (count > 0.0).then_some(sum / count)
}

/// The posts beside a post, diagonals included; some may be off the lattice.
fn neighbors(post: Post) -> impl Iterator<Item = Post> {
    let range = |at: u32| at.saturating_sub(1)..=at.saturating_add(1);
    let all = range(post.row).flat_map(move |row| range(post.column).map(move |column| Post { column, row }));
    all.filter(move |&beside| beside != post)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::tests::slope;

    /// An L with its inner corner at (50, 50).
    fn corner() -> Vec<DVec2> {
        [(40.0, 40.0), (60.0, 40.0), (60.0, 50.0), (50.0, 50.0), (50.0, 60.0), (40.0, 60.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec()
    }

    fn leveled(lattice: &mut Lattice, level_m: Option<f64>, batters: Batters) -> BrushChanges {
        LevelGround { rings: vec![corner()], level_m, batters }.apply(lattice)
    }

    #[test]
    fn an_outline_is_level_and_no_batter_is_steeper_than_stated() {
        let mut lattice = slope(DVec2::new(0.2, 0.1));
        let changes = leveled(&mut lattice, Some(115.0), Batters::default());
        assert!(changes.volumes.cut_m3 > 50.0 && changes.volumes.fill_m3 > 50.0, "{:?}", changes.volumes);
        let outline = corner();
        for post in lattice.posts() {
            let (at, height) = (lattice.position(post).as_dvec2(), f64::from(lattice.height(post)));
            let squares = polygon::edges(&outline).map(|edge| segment::distance_squared(edge, at));
            let distance = squares.fold(f64::INFINITY, f64::min).sqrt();
            if polygon::contains([&outline[..]], at) {
                assert_eq!(height, 115.0, "at {at}");
            } else {
                assert!(height <= 115.0 + distance + 1e-4 && height >= 115.0 - distance / 1.5 - 1e-4);
            }
        }
        assert!(lattice.pinned().iter().all(|pin| !pin));
    }

    #[test]
    fn without_a_level_cut_and_fill_within_the_outline_balance() {
        let mut lattice = slope(DVec2::new(0.2, 0.1));
        let wall = Batters { cut: 1e-6, fill: 1e-6 };
        let volumes = leveled(&mut lattice, None, wall).volumes;
        assert!((volumes.cut_m3 - volumes.fill_m3).abs() < 1e-2 && volumes.cut_m3 > 100.0, "{volumes:?}");
    }

    #[test]
    fn a_hill_behind_the_daylight_line_stays() {
        let mut lattice = slope(DVec2::ZERO);
        let tower = Post { column: 75, row: 45 };
        lattice.heights_mut(tower, 75)[0] = 180.0;
        leveled(&mut lattice, Some(95.0), Batters::default());
        assert_eq!(lattice.height(tower), 180.0);
        assert_eq!(lattice.height(Post { column: 45, row: 45 }), 95.0);
    }

    #[test]
    fn an_outline_off_the_ground_or_without_data_changes_nothing() {
        let mut lattice = slope(DVec2::ZERO);
        let far = corner().iter().map(|corner| corner + 1e6).collect();
        let off = LevelGround { rings: vec![far], level_m: Some(5.0), batters: Batters::default() };
        assert!(off.apply(&mut lattice).pieces.is_empty());
        for row in 30..71 {
            lattice.heights_mut(Post { column: 30, row }, 70).fill(f32::NAN);
        }
        assert!(leveled(&mut lattice, None, Batters::default()).pieces.is_empty());
    }
}
