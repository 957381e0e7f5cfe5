//! Level ground at the height of a contour line, moved off that height.
//!
//! A renderer draws a contour line where a pixel's height is near that of the line, by the change of height across the
//! pixel. Ground that is level at the height of a line has no such change: half of the line is missing at its border, the
//! other half follows the cells, and rounding decides where. Such ground belongs to what is above the line, as elsewhere in
//! contouring (a post is high where its height is not below the level): it is lifted a little, so that one closed line goes
//! round it where ground falls from it, and none where it rises.
//!
//! ```text
//!   heights at a line L       lifted                      The line crosses the slope beside level ground, in ground with
//!   ────────L────╮            ────────────╮               a change of height on both its sides. Where ground only rises
//!                 ╲                        ╲ L            from L there is no crossing.
//! ```
//!
//! Nothing else moves: ground that slopes through the height of a line has the heights that it has.

use rayon::prelude::*;

use crate::ground::{Contours, GroundPost};
use crate::ground_levels::PostCount;

/// How far level ground is lifted at least, of the interval between lines.
const LIFT: f32 = 1.0 / 9.0;
/// How far it is lifted at most: less than half, so that the line nearest to it stays the same.
const MOST_LIFT: f32 = 0.4;
/// It is lifted by this share of the rise beside it, so that the steep foot of a hill does not come near the line.
const RISE_SHARE: f32 = 1.0 / 3.0;
/// Ground that falls from level ground by less than this, of the interval, is part of it: smoothed ground comes to the
/// height of a line ever more slowly, and where it reaches it says nothing.
const LEAST_FALL: f32 = 0.02;
/// The same at most, whatever the heights were rounded to.
const MOST_FALL: f32 = 0.3;
/// How near to the height of a line ground is level with it, of the interval, and of the height: some roundings of it.
const LEVEL: [f32; 2] = [1e-3, 5e-7];

/// Moves posts of level ground off the heights of contour lines. `step_m` is the step that heights were rounded to before
/// they were smoothed, 0 for none: what falls by less than half of it was level.
///
/// Posts under water stay: no line is drawn on them.
pub fn lift_level_ground(posts: &mut [GroundPost], size: PostCount, contours: &Contours, step_m: f32) {
    if !(contours.interval_m.is_finite() && contours.interval_m > 0.0) || posts.is_empty() {
        return;
    }
    let interval_m = contours.interval_m;
    let least_fall_m = (0.49 * step_m).min(MOST_FALL * interval_m).max(LEAST_FALL * interval_m);
    let ground = ContourGround { posts, size, interval_m, least_fall_m };
    let found: Vec<(usize, LevelPost)> = (0..ground.posts.len())
        .into_par_iter()
        .filter_map(|index| Some((index, ground.level_post(index)?)))
        .collect();
    let is_broad = |kind: &LevelPost| [LevelPost::Inner, LevelPost::Rim].contains(kind);
    if !found.iter().any(|(_, kind)| is_broad(kind) || *kind == LevelPost::Crest) {
        return;
    }
    let broad = found.iter().filter(|(_, kind)| is_broad(kind)).map(|(index, _)| *index);
    let slopes = found.iter().filter(|(_, kind)| *kind == LevelPost::Slope).map(|(index, _)| *index);
    let beside = ground.level_beside(broad.collect(), slopes);
    let seeds = found.iter().filter(|(_, kind)| *kind == LevelPost::Inner).map(|(index, _)| *index);
    let lifted = ground.connected(seeds.collect());
    let outer: Vec<(usize, f32)> = found
        .par_iter()
        .filter(|(index, _)| !lifted.holds(*index))
        .filter(|(index, kind)| *kind != LevelPost::Slope || beside.holds(*index))
        .filter_map(|(index, kind)| Some((*index, ground.moved(*index, *kind)?)))
        .collect();
    for index in lifted.rising() {
        let ground = ContourGround { posts, size, interval_m, least_fall_m };
        let height_m = ground.lifted(index, LIFT * interval_m);
        posts[index].height_m = height_m;
    }
    outer.into_iter().for_each(|(index, height_m)| posts[index].height_m = height_m);
}

/// A post at the height of a line where that makes no sound line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LevelPost {
    /// Nothing beside it is lower.
    Inner,
    /// At the border of level ground, or on a pass: some ground beside it is lower.
    Rim,
    /// Of a crest as narrow as a post: nothing beside it is higher.
    Crest,
    /// Of a slope: it is lifted where level ground narrows to it, so that the line goes on beside it.
    Slope,
}

struct ContourGround<'a> {
    posts: &'a [GroundPost],
    size: PostCount,
    interval_m: f32,
    /// What falls from level ground by less is part of it, meters.
    least_fall_m: f32,
}

/// The eight posts round one, in order; `None` beyond the border.
const ROUND: [[i64; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]];

impl ContourGround<'_> {
    fn round(&self, index: usize) -> [Option<usize>; 8] {
        let (columns, rows) = (i64::from(self.size.columns), i64::from(self.size.rows));
        let (column, row) = (index as i64 % columns, index as i64 / columns);
        ROUND.map(|[x, y]| {
            let (column, row) = (column + x, row + y);
            let is_there = (0..columns).contains(&column) && (0..rows).contains(&row);
            is_there.then_some((row * columns + column) as usize)
        })
    }

    /// The height of the line that is nearest to a post's, meters.
    fn line_m(&self, index: usize) -> f32 {
        (self.posts[index].height_m / self.interval_m).round() * self.interval_m
    }

    fn is_dry(&self, index: usize) -> bool {
        self.posts[index].water < 0.5
    }

    /// What is level with `line_m`, meters.
    fn level_m(&self, line_m: f32) -> f32 {
        (self.interval_m * LEVEL[0]).max(line_m.abs() * LEVEL[1])
    }

    /// The differences of the posts round one from `line_m`.
    fn rises(&self, index: usize, line_m: f32) -> [Option<f32>; 8] {
        self.round(index).map(|near| near.map(|near| self.posts[near].height_m - line_m))
    }

    fn level_post(&self, index: usize) -> Option<LevelPost> {
        let line_m = self.line_m(index);
        let level_m = self.level_m(line_m);
        let is_level = (self.posts[index].height_m - line_m).abs() <= level_m;
        if !is_level || !self.is_dry(index) {
            return None;
        }
        let rises = self.rises(index, line_m);
        let signs = rises.map(|rise| rise.map(|rise| i8::from(rise > level_m) - i8::from(rise < -level_m)));
        let has = |sign: i8| signs.contains(&Some(sign));
        if !has(-1) {
            return Some(LevelPost::Inner);
        }
        // Three neighbors in a row, the middle one at a corner, are a cell with the post.
        let is_flat_cell =
            |corner: usize| [corner, corner + 1, corner + 2].iter().all(|place| signs[place % 8] == Some(0));
        if [7, 1, 3, 5].into_iter().any(is_flat_cell) || is_pass(&signs) {
            return Some(LevelPost::Rim);
        }
        Some(if has(1) { LevelPost::Slope } else { LevelPost::Crest })
    }

    /// The posts of `slopes` at the height of a line that hang together with level ground.
    fn level_beside(&self, broad: Vec<usize>, slopes: impl Iterator<Item = usize>) -> PostSet {
        let mut is_slope = PostSet::new(self.posts.len());
        slopes.for_each(|post| {
            is_slope.insert(post);
        });
        let mut set = PostSet::new(self.posts.len());
        let mut open: Vec<usize> = broad.into_iter().filter(|&post| set.insert(post)).collect();
        while let Some(index) = open.pop() {
            let line_m = self.line_m(index);
            for near in self.round(index).into_iter().flatten() {
                if is_slope.holds(near) && !set.holds(near) && self.line_m(near) == line_m {
                    set.insert(near);
                    open.push(near);
                }
            }
        }
        set
    }

    /// The posts that are one level ground with `seeds`: hardly lower than the line, less than a lift above it, and not
    /// beside lower ground.
    fn connected(&self, seeds: Vec<usize>) -> PostSet {
        let mut set = PostSet::new(self.posts.len());
        let mut open: Vec<usize> = seeds.into_iter().filter(|&seed| set.insert(seed)).collect();
        while let Some(index) = open.pop() {
            let line_m = self.line_m(index);
            for near in self.round(index).into_iter().flatten() {
                if !set.holds(near) && self.is_part(near, line_m) {
                    set.insert(near);
                    open.push(near);
                }
            }
        }
        set
    }

    fn is_part(&self, index: usize, line_m: f32) -> bool {
        let least = -self.least_fall_m;
        let own = self.posts[index].height_m - line_m;
        self.is_dry(index)
            && (least..LIFT * self.interval_m).contains(&own)
            && self.rises(index, line_m).into_iter().flatten().all(|rise| rise >= least)
    }

    /// The height of a post of level ground that is lifted by `least_m` or more.
    fn lifted(&self, index: usize, least_m: f32) -> f32 {
        let line_m = self.line_m(index);
        let steepest = self.rises(index, line_m).into_iter().flatten().fold(0.0, f32::max);
        let lift = (steepest * RISE_SHARE).min(MOST_LIFT * self.interval_m).max(least_m);
        self.posts[index].height_m.max(line_m + lift)
    }

    /// The height of a post that is not within level ground.
    fn moved(&self, index: usize, kind: LevelPost) -> Option<f32> {
        let line_m = self.line_m(index);
        let falls = self.rises(index, line_m).into_iter().flatten().filter(|rise| *rise < 0.0);
        let (count, sum) = falls.fold((0u8, 0.0), |(count, sum), rise| (count + 1, sum - rise));
        // Halfway to what falls from it, so that a line runs in the middle of the slope and not along the cells.
        let half_m = sum / f32::from(count.max(1)) / 2.0;
        let away_m = half_m.clamp(2.0 * self.level_m(line_m), LIFT * self.interval_m);
        match kind {
            LevelPost::Inner => None,
            LevelPost::Rim | LevelPost::Slope => Some(self.lifted(index, away_m)),
            LevelPost::Crest => Some(line_m - away_m),
        }
    }
}

/// Whether higher and lower ground alternate round a post at least twice.
fn is_pass(signs: &[Option<i8>; 8]) -> bool {
    let sides: Vec<i8> = signs.iter().flatten().copied().filter(|sign| *sign != 0).collect();
    let turns = (0..sides.len()).filter(|&at| sides[at] != sides[(at + 1) % sides.len()]).count();
    turns >= 4
}

/// A set of posts, one bit each.
struct PostSet(Vec<u64>);

impl PostSet {
    fn new(count: usize) -> Self {
        Self(vec![0; count.div_ceil(64)])
    }

    fn holds(&self, index: usize) -> bool {
        self.0[index / 64] >> (index % 64) & 1 == 1
    }

    /// The posts, rising.
    fn rising(&self) -> impl Iterator<Item = usize> + '_ {
        let some = self.0.iter().enumerate().filter(|(_, word)| **word != 0);
        some.flat_map(|(place, word)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| place * 64 + bit)
        })
    }

    /// Adds a post; returns whether it is new.
    fn insert(&mut self, index: usize) -> bool {
        let is_new = !self.holds(index);
        self.0[index / 64] |= 1 << (index % 64);
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Srgba;

    const SIZE: PostCount = PostCount { columns: 41, rows: 31 };
    const CONTOURS: Contours =
        Contours { interval_m: 10.0, major_every: 5, color: Srgba::WHITE, width_px: 1.0, lit: None };

    /// Heights before and after.
    fn lifted(height: impl Fn(f32, f32) -> f32) -> (Vec<f32>, Vec<f32>) {
        let post = |index: u32| {
            let (column, row) = (index % SIZE.columns, index / SIZE.columns);
            GroundPost { height_m: height(column as f32, row as f32), ..GroundPost::default() }
        };
        let mut posts: Vec<GroundPost> = (0..SIZE.columns * SIZE.rows).map(post).collect();
        let heights = |posts: &[GroundPost]| posts.iter().map(|post| post.height_m).collect::<Vec<f32>>();
        let before = heights(&posts);
        lift_level_ground(&mut posts, SIZE, &CONTOURS, 0.0);
        (before, heights(&posts))
    }

    fn hill(x: f32, y: f32) -> f32 {
        (60.0 - 6.0 * (x - 20.0).hypot(y - 15.0)).max(0.0)
    }

    #[test]
    fn a_plain_under_a_hill_has_no_line_and_one_round_a_hole_has_a_ring() {
        let (before, after) = lifted(|x, y| 100.0 + hill(x, y));
        assert!(after.iter().all(|height| *height > 101.0), "all is above the line");
        assert!(before.iter().zip(&after).all(|(before, after)| (after - before).abs() <= 4.0));
        let (before, after) = lifted(|x, y| 100.0 - hill(x, y));
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(*before >= 100.0, *after > 100.0, "{before} became {after}");
        }
    }

    #[test]
    fn no_two_neighbors_of_level_ground_are_at_the_height_of_the_line() {
        let shapes: [fn(f32, f32) -> f32; 6] = [
            |x, y| 100.0 + hill(x, y),
            |x, y| 100.0 - hill(x, y),
            |x, y| 130.0 - hill(x, y).min(30.0),
            |x, y| (100.0 + (x - 20.0) * 2.0).clamp(80.0, 100.0) + (y - 25.0).max(0.0),
            |x, _| if (10.0..30.0).contains(&x) { 100.0 } else { 95.0 + 10.0 * (x / 20.0).floor().min(1.0) },
            |x, y| if x == 12.0 || y == 9.0 { 100.0 } else { 97.0 },
        ];
        for (number, shape) in shapes.into_iter().enumerate() {
            let (_, after) = lifted(shape);
            let columns = SIZE.columns as usize;
            for index in (0..after.len() - columns).filter(|index| index % columns + 1 < columns) {
                let cell = [index, index + 1, index + columns, index + columns + 1];
                let is_level = cell.iter().all(|&post| (after[post] - 100.0).abs() < 0.01);
                assert!(!is_level, "shape {number}, post {index}");
            }
        }
    }

    #[test]
    fn ground_that_slopes_through_the_height_of_a_line_stays() {
        let slopes: [fn(f32, f32) -> f32; 4] = [
            |x, _| x * 10.0,
            |x, y| 2.0 * x + 3.0 * y,
            |x, y| 0.05 * x - 0.03 * y,
            |x, y| 100.0 + (x - 20.0) * 0.7 + libm::sinf(y) * 3.0,
        ];
        for slope in slopes {
            let (before, after) = lifted(slope);
            // At the border nothing says how the ground goes on.
            let columns = SIZE.columns as usize;
            let inner =
                (columns..before.len() - columns).filter(|at| (1..columns - 1).contains(&(at % columns)));
            for index in inner {
                assert_eq!(before[index], after[index], "post {index}");
            }
        }
    }

    #[test]
    fn a_crest_as_narrow_as_a_post_has_no_line_and_a_channel_has_none() {
        let (_, crest) = lifted(|x, _| 100.0 - (x - 20.0).abs() * 3.0);
        assert!(crest.iter().all(|height| *height < 100.0));
        let (_, channel) = lifted(|x, _| 100.0 + (x - 20.0).abs() * 3.0);
        assert!(channel.iter().all(|height| *height > 100.0));
    }

    #[test]
    fn what_is_under_water_stays_and_odd_intervals_move_nothing() {
        let level = GroundPost { height_m: 100.0, ..GroundPost::default() };
        let size = PostCount { columns: 5, rows: 5 };
        let moved = |post: GroundPost, interval_m: f32| {
            let mut posts = vec![post; 25];
            lift_level_ground(&mut posts, size, &Contours { interval_m, ..CONTOURS }, 0.0);
            posts[12].height_m
        };
        assert!(moved(level, 10.0) > 101.0);
        assert_eq!(moved(GroundPost { water: 0.9, ..level }, 10.0), 100.0);
        for interval_m in [0.0, -10.0, f32::NAN, f32::INFINITY] {
            assert_eq!(moved(level, interval_m), 100.0);
        }
    }
}
