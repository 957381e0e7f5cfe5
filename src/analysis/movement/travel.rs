//! The ground as a vehicle travels it: steps to sixteen neighbors, the eight around a post and the eight knight's moves, and
//! ways across the triangles between them.
//!
//! A step takes the mean pace of the posts that it passes, times the factor of its grade, which differs between up and down.
//! A diagonal step does not pass between two posts that stop the vehicle, nor a knight's move beside one, so that a chain
//! of posts, such as a river or a wall, has no gaps; along a road or a bridge both may lie beside it. A triangle with such a
//! post is not crossed.
//!
//! Posts lie in rows with a border of closed ones, so that no neighbor lies beyond them; [`TravelGround::framed`] is the
//! index there of a post of the lattice.

use std::ops::Range;

use crate::error::AnalysisError;
use crate::land::Land;
use crate::movement::going::{Going, SEVERELY_RESTRICTED};
use crate::movement::grade::GradeTable;
use crate::movement::neighbors::{TravelStep, steps};
use crate::movement::triangles::{TravelTriangle, TriangleTable};
use crate::movement::vehicle::Vehicle;
use crate::outcome::PostValues;
use crate::place::nearest_post;
use glam::DVec2;
use rayon::prelude::*;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;

/// Closed posts around the ground, as far as the longest step leads.
const BORDER: usize = 2;

/// The ground as a vehicle travels it.
pub(crate) struct TravelGround<'a> {
    pub(super) ground: &'a Lattice,
    /// Posts in a row with its border.
    pub(super) width: usize,
    /// Heights in meters, gaps closed that the vehicle crosses; NaN on the border.
    heights_m: Vec<f32>,
    /// Seconds per meter on the level; infinite where the vehicle cannot go, below 0 on a road, a bridge or a ford.
    paces: Vec<f32>,
    /// A bit for each post: whether its pace is that of all posts up to two columns and rows away, and none is a way.
    alike: Vec<u64>,
    pub(super) grades: GradeTable,
    pub(super) triangles: TriangleTable,
    /// Whether ways lead across triangles too; tests compare steps alone with those of other programs.
    pub(super) has_triangles: bool,
    /// To the sixteen neighbors; the eight around a post come first.
    pub(super) steps: Vec<TravelStep>,
    pub(super) least_pace: f32,
    pub(super) greatest_pace: f32,
    /// Posts that are slowed, each with its signed pace before, in the order in which they were slowed.
    slowed: Vec<(u32, f32)>,
}

impl<'a> TravelGround<'a> {
    /// The ground of a land for a vehicle.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn new(
        land: &'a Land,
        going: Going,
        vehicle: &Vehicle,
        is_langmuir: bool,
    ) -> Result<Self, AnalysisError> {
        let ground = &*land.ground;
        let (columns, rows) = (ground.columns() as usize, ground.rows() as usize);
        // Rows of whole words of `alike`.
        let width = (columns + 2 * BORDER).next_multiple_of(u64::BITS as usize);
        let count = width * (rows + 2 * BORDER);
        check_memory(count as u64 * 28, "the analysis", "name a smaller `extent`")?;
        if u32::try_from(count).is_err() {
            return Err(AnalysisError::argument(
                "extent",
                "has more posts than ways are found on; name a smaller one",
            ));
        }
        let heights = going.closed.as_ref().unwrap_or(ground).heights();
        let (mut heights_m, mut paces) = (vec![f32::NAN; count], vec![f32::INFINITY; count]);
        let framed_rows = heights_m.par_chunks_mut(width).zip(paces.par_chunks_mut(width)).skip(BORDER);
        let range = |(row, (heights_m, paces)): (usize, (&mut [f32], &mut [f32]))| {
            let posts = row * columns..(row + 1) * columns;
            heights_m[BORDER..BORDER + columns].copy_from_slice(&heights[posts.clone()]);
            let of_way = going.speed_kmh[posts.clone()].iter().zip(&going.is_way[posts]);
            let (mut least, mut greatest) = (f32::INFINITY, 0.0_f32);
            for (pace, (&speed, &is_way)) in paces[BORDER..].iter_mut().zip(of_way) {
                let level = if speed > 0.0 { 3.6 / speed } else { f32::INFINITY };
                *pace = if is_way { -level } else { level };
                least = least.min(level);
                greatest = greatest.max(if level.is_finite() { level } else { 0.0 });
            }
            (least, greatest)
        };
        let wider = |one: (f32, f32), other: (f32, f32)| (one.0.min(other.0), one.1.max(other.1));
        let (least_pace, greatest_pace) =
            framed_rows.take(rows).enumerate().map(range).reduce(|| (f32::INFINITY, 0.0), wider);
        drop(going);
        let grades = GradeTable::new(vehicle, is_langmuir);
        let mut alike = vec![0u64; count / u64::BITS as usize];
        mark_alike(&mut alike, &paces, width, 0..rows + 2 * BORDER);
        Ok(Self {
            ground,
            width,
            heights_m,
            alike,
            paces,
            steps: steps(ground, width, &grades),
            grades,
            triangles: TriangleTable::new(ground.cell()),
            has_triangles: true,
            least_pace,
            greatest_pace,
            slowed: Vec::new(),
        })
    }

    /// The index of a post of the lattice among the posts with their border.
    #[inline]
    pub(super) fn framed(&self, index: usize) -> usize {
        let columns = self.ground.columns() as usize;
        (index / columns + BORDER) * self.width + index % columns + BORDER
    }

    /// The index of a post of the lattice by that with the border.
    pub(super) fn inner(&self, framed: usize) -> usize {
        let [column, row] = [framed % self.width - BORDER, framed / self.width - BORDER];
        row * self.ground.columns() as usize + column
    }

    /// The column and the row of a post by its index with the border.
    #[inline]
    pub(super) fn column_and_row(&self, framed: usize) -> [i32; 2] {
        [framed % self.width, framed / self.width].map(|at| at as i32 - BORDER as i32)
    }

    /// The part of a row with its border that holds the posts of a row of the lattice.
    pub(super) fn framed_row(&self, row: usize) -> Range<usize> {
        let first = (row + BORDER) * self.width + BORDER;
        first..first + self.ground.columns() as usize
    }

    /// How many posts there are with the border.
    pub(super) fn framed_count(&self) -> usize {
        self.paces.len()
    }

    /// Multiplies the pace of posts, to keep a later way off them.
    pub fn slow_down(&mut self, posts: impl IntoIterator<Item = usize>, factor: f32) {
        let known = self.slowed.len();
        for index in posts {
            let index = self.framed(index);
            let pace = &mut self.paces[index];
            self.slowed.push((index as u32, *pace));
            *pace *= factor;
            if pace.is_finite() {
                self.greatest_pace = self.greatest_pace.max(pace.abs());
            }
        }
        self.mark_alike_since(known);
    }

    /// Finds anew which posts are alike around those that were slowed after so many others.
    fn mark_alike_since(&mut self, known: usize) {
        let rows = || self.slowed[known..].iter().map(|&(index, _)| index as usize / self.width);
        let (Some(first), Some(last)) = (rows().min(), rows().max()) else { return };
        // Slowed posts lie within the border.
        mark_alike(&mut self.alike, &self.paces, self.width, first - BORDER..last + BORDER + 1);
    }

    /// Gives all posts their paces from before [`TravelGround::slow_down`].
    pub fn undo_slowing(&mut self) {
        for &(index, pace) in self.slowed.iter().rev() {
            self.paces[index as usize] = pace;
        }
        self.mark_alike_since(0);
        self.slowed.clear();
    }

    /// Whether the vehicle can be at a post.
    #[inline]
    pub fn is_open(&self, index: usize) -> bool {
        self.paces[self.framed(index)].is_finite()
    }

    /// The post nearest to map coordinates.
    ///
    /// # Errors
    /// It lies beyond the ground, has no data, or the vehicle cannot be there.
    pub fn post_near(&self, key: &'static str, at: DVec2) -> Result<usize, AnalysisError> {
        let fault = |problem| AnalysisError::Place { key, at, problem };
        let index = nearest_post(self.ground, at).ok_or_else(|| fault("it lies beyond the ground"))?;
        match self.ground.heights()[index].is_nan() {
            true => Err(fault("the ground has no data there")),
            false if !self.is_open(index) => {
                Err(fault("the vehicle cannot be there: water, a building, or other ground that stops it"))
            }
            false => Ok(index),
        }
    }

    /// Whether a post and all that steps from it lead to or past have one pace, and none is a way.
    #[inline(always)]
    pub(super) fn is_alike(&self, framed: usize) -> bool {
        self.alike[framed / u64::BITS as usize] >> (framed % u64::BITS as usize) & 1 == 1
    }

    /// Seconds per meter on the level at a post.
    #[inline(always)]
    pub(super) fn pace(&self, framed: usize) -> f32 {
        self.paces[framed].abs()
    }

    /// Whether a road, a bridge or a ford is at a post.
    #[inline(always)]
    pub(super) fn is_way(&self, framed: usize) -> bool {
        self.paces[framed] < 0.0
    }

    /// Seconds from a post to a neighbor; infinite where the step is not passable. Indices are those with the border.
    #[inline]
    pub(super) fn seconds(&self, from: usize, step: &TravelStep) -> f32 {
        let (here, there) = (self.paces[from], self.paces[from.wrapping_add_signed(step.offset)]);
        let is_along_way = here < 0.0 && there < 0.0;
        let mut pace = (here.abs() + there.abs()) * 0.5;
        let reach = step.columns.abs() + step.rows.abs();
        if reach > 1 {
            let flank = |index: usize| self.pace(from.wrapping_add_signed(step.flanks[index]));
            let flanks = [flank(0), flank(1)];
            match reach {
                2 if !is_along_way && flanks[0].is_infinite() && flanks[1].is_infinite() => {
                    return f32::INFINITY;
                }
                2 => {}
                _ => pace = ((here.abs() + there.abs()) + (flanks[0] + flanks[1])) * 0.25,
            }
        }
        if pace.is_infinite() {
            return pace;
        }
        match is_along_way {
            true => pace * step.length_m * self.grades.on_way(self.grade(from, step)),
            false if self.grades.has_across() => self.open_seconds::<true>(from, pace, step),
            false => self.open_seconds::<false>(from, pace, step),
        }
    }

    /// Seconds of a step off the roads at a pace. `ACROSS` where slopes across slow the vehicle.
    #[inline(always)]
    pub(super) fn open_seconds<const ACROSS: bool>(&self, from: usize, pace: f32, step: &TravelStep) -> f32 {
        let factor = self.grades.open(self.grade(from, step));
        pace * step.length_m * if ACROSS { factor * self.across_factor(from, step) } else { factor }
    }

    #[inline(always)]
    fn grade(&self, from: usize, step: &TravelStep) -> f32 {
        (self.height(from.wrapping_add_signed(step.offset)) - self.height(from)) * step.per_length_m
    }

    /// The factor of the slope across a step, between the two posts beside its beginning.
    #[inline(always)]
    fn across_factor(&self, from: usize, step: &TravelStep) -> f32 {
        let own = self.height(from);
        let left = self.height(from.wrapping_add_signed(step.left));
        let right = self.height(from.wrapping_add_signed(-step.left));
        let rise = match (left.is_nan(), right.is_nan()) {
            (false, false) => left - right,
            (false, true) => (left - own) * 2.0,
            (true, false) => (own - right) * 2.0,
            (true, true) => 0.0,
        };
        self.grades.across((rise * step.per_span_m).abs())
    }

    /// The height of a post in meters, by its index with the border; NaN on the border.
    #[inline(always)]
    pub(super) fn height(&self, framed: usize) -> f32 {
        self.heights_m[framed]
    }

    /// The triangle with these corners, by their indices with the border, and the times of the first two; `None` where it is
    /// not crossed.
    #[inline]
    pub(super) fn triangle(&self, [a, b, q]: [usize; 3], times_s: [f32; 2]) -> Option<TravelTriangle> {
        let (at_a, at_b, at_q) = (self.paces[a], self.paces[b], self.paces[q]);
        let paces = [(at_a.abs() + at_q.abs()) * 0.5, (at_b.abs() + at_q.abs()) * 0.5];
        let is_way = at_a < 0.0 && at_b < 0.0 && at_q < 0.0;
        let heights_m = [self.height(a), self.height(b), self.height(q)];
        let is_crossed = paces[0].is_finite() && paces[1].is_finite();
        is_crossed.then_some(TravelTriangle { times_s, heights_m, paces, is_way })
    }

    /// The time at the third corner of a triangle.
    #[inline]
    pub(super) fn arrival_s(&self, triangle: &TravelTriangle, axis: usize) -> f32 {
        match self.grades.has_across() {
            true => self.triangles.arrival_s::<true>(triangle, axis, &self.grades),
            false => self.triangles.arrival_s::<false>(triangle, axis, &self.grades),
        }
    }

    /// The ground.
    pub fn lattice(&self) -> &'a Lattice {
        self.ground
    }
}

/// Sets the bits of posts in rows: whether the pace of each is that of all posts up to two columns and rows away, and none is
/// a way. Rows are whole words.
fn mark_alike(alike: &mut [u64], paces: &[f32], width: usize, rows: Range<usize>) {
    let bits = u64::BITS as usize;
    let words = width / bits;
    let of_rows = alike.par_chunks_mut(words).enumerate().skip(rows.start).take(rows.len());
    of_rows.for_each(|(row, alike)| {
        if row < BORDER || (row + BORDER + 1) * width > paces.len() {
            return;
        }
        let own = &paces[row * width..][..width];
        let mut is_alike: Vec<bool> = own.iter().map(|&pace| pace > 0.0 && pace.is_finite()).collect();
        for other in row - BORDER..=(row + BORDER).min(paces.len() / width - 1) {
            let other = &paces[other * width..][..width];
            for shift in 0..=2 * BORDER {
                let inner = BORDER..width - BORDER;
                let shifted = &other[shift..shift + inner.len()];
                let pairs = own[inner.clone()].iter().zip(shifted);
                is_alike[inner].iter_mut().zip(pairs).for_each(|(is, (one, other))| *is &= one == other);
            }
        }
        is_alike[..BORDER].fill(false);
        is_alike[width - BORDER..].fill(false);
        for (word, posts) in alike.iter_mut().zip(is_alike.chunks_exact(bits)) {
            *word = posts.iter().rev().fold(0, |word, &is| word << 1 | u64::from(is));
        }
    });
}

/// The ground of a land for a vehicle named by the argument, with the going's codes and notes.
///
/// # Errors
/// `vehicle`, and memory.
pub(crate) fn travel_ground<'a>(
    land: &'a Land,
    arguments: &crate::arguments::AnalysisArguments,
) -> Result<(TravelGround<'a>, Vec<u8>, Vec<String>), AnalysisError> {
    let vehicle = Vehicle::named(land, &arguments.word("vehicle"))?;
    let mut going = Going::new(land, &vehicle)?;
    let codes = std::mem::take(&mut going.codes);
    let notes = std::mem::take(&mut going.notes);
    debug_assert!(codes.iter().all(|&code| code <= SEVERELY_RESTRICTED || code == PostValues::NO_CODE));
    let ground = TravelGround::new(land, going, &vehicle, arguments.word("method") == "langmuir")?;
    Ok((ground, codes, notes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::land::{RoadClass, RoadLine, Step};
    use crate::movement::neighbors::SIDES;
    use crate::movement::search::TravelGoal;
    use crate::test_land::{flat, shaped};
    use sandtable_terrain::lattice::Post;
    use sandtable_terrain::stop_flag::StopFlag;

    pub(super) fn travel<'a>(land: &'a Land, vehicle: &Vehicle) -> TravelGround<'a> {
        let going = Going::new(land, vehicle).expect("memory");
        TravelGround::new(land, going, vehicle, false).expect("memory")
    }

    fn built_in(name: &str) -> Vehicle {
        Vehicle::built_in(name).expect("built in")
    }

    /// The times to all posts.
    pub(super) fn everywhere(ground: &TravelGround<'_>, starts: &[usize]) -> Vec<f32> {
        ground.times(starts, TravelGoal::within(f32::INFINITY), &StopFlag::default())
    }

    #[test]
    fn on_level_ground_times_are_at_most_2_percent_too_long() {
        let land = flat(41, 41, 10.0);
        let mut ground = travel(&land, &built_in("truck"));
        let pace = 3.6 / 15.0;
        // By steps alone they are as long as those of other programs.
        for (has_triangles, bound) in [(true, 1.018), (false, 1.0276)] {
            ground.has_triangles = has_triangles;
            let times = everywhere(&ground, &[20 * 41 + 20]);
            let ratio = |post: Post| {
                let straight = (post.grid() - 20.0).length() * 10.0 * pace;
                if straight > 0.0 { f64::from(times[land.ground.index(post)]) / straight } else { 1.0 }
            };
            let greatest = land.ground.posts().map(ratio).fold(0.0, f64::max);
            assert!(land.ground.posts().map(ratio).all(|ratio| ratio > 0.99999));
            assert!(greatest < bound && greatest > bound - 0.002, "{has_triangles}: {greatest}");
            let exact = |column: u32, row: u32| f64::from(times[land.ground.index(Post { column, row })]);
            assert!((exact(40, 30) - 500f64.sqrt() * 10.0 * pace).abs() < 1e-3);
            assert!((exact(40, 20) - 200.0 * pace).abs() < 1e-3);
        }
    }

    /// The least times with the border, from relaxing every step and triangle until nothing changes.
    fn relaxed(ground: &TravelGround<'_>, starts: &[usize]) -> Vec<f32> {
        let mut times = vec![f32::INFINITY; ground.framed_count()];
        starts.iter().for_each(|&start| times[ground.framed(start)] = 0.0);
        loop {
            let before = times.clone();
            for from in (0..times.len()).filter(|&from| ground.pace(from).is_finite()) {
                let near = |index: usize| from.wrapping_add_signed(ground.steps[index].offset);
                for step in &ground.steps {
                    let to = from.wrapping_add_signed(step.offset);
                    times[to] = times[to].min(times[from] + ground.seconds(from, step));
                }
                let sides = SIDES.iter().enumerate().filter(|_| ground.has_triangles);
                for (side, triangle) in sides.flat_map(|(side, of)| of.iter().map(move |of| (side, of))) {
                    let mut corners = [from, near(side)];
                    if !triangle.is_from_straight {
                        corners.reverse();
                    }
                    let [a, b, to] = [corners[0], corners[1], near(triangle.to)];
                    if let Some(of) = ground.triangle([a, b, to], [times[a], times[b]]) {
                        times[to] = times[to].min(ground.arrival_s(&of, triangle.axis));
                    }
                }
            }
            if times == before {
                return times;
            }
        }
    }

    #[test]
    fn times_are_those_of_relaxing_every_way_in_however_many_lanes() {
        let mut land = shaped(37, 23, 10.0, |column, row| {
            let wave = ((column * 7 + row * 13 + column * row) % 11) as f32;
            if (column, row) == (5, 5) { f32::NAN } else { wave * 0.35 + column as f32 }
        });
        let line = vec![DVec2::new(80.0, 0.0), DVec2::new(110.0, 90.0)];
        land.steps = vec![Step { line, height_m: 3.0 }];
        let line = vec![DVec2::new(150.0, 30.0), DVec2::new(330.0, 200.0)];
        let name = String::new();
        let road = RoadLine { name, line, surface: RoadClass::Main, width_m: 25.0 };
        for (name, has_road) in [("foot", true), ("foot", false), ("tracked", true), ("truck", false)] {
            land.roads = Some(vec![road.clone()]).filter(|_| has_road);
            let mut ground = travel(&land, &built_in(name));
            for has_triangles in [true, false] {
                ground.has_triangles = has_triangles;
                let wanted = relaxed(&ground, &[0, 20]);
                for lanes in [1, 2, 4] {
                    let (all, stop) = (TravelGoal::within(f32::INFINITY), StopFlag::default());
                    let times = ground.inner_times(&ground.search_in_lanes(&[0, 20], all, &stop, lanes));
                    let wanted = (0..times.len()).map(|index| wanted[ground.framed(index)]);
                    assert!(times.iter().copied().eq(wanted), "{name} {has_triangles} {lanes}");
                }
            }
        }
    }

    #[test]
    fn slowing_and_undoing_it_find_anew_which_posts_are_alike() {
        let land = flat(70, 30, 10.0);
        let mut ground = travel(&land, &built_in("truck"));
        let before = ground.alike.clone();
        let all = |ground: &TravelGround<'_>| {
            let mut alike = vec![0; ground.alike.len()];
            mark_alike(&mut alike, &ground.paces, ground.width, 0..30 + 2 * BORDER);
            alike
        };
        for posts in [0..3, 700..790, 2099..2100] {
            ground.slow_down(posts, 3.0);
            assert_eq!(ground.alike, all(&ground));
        }
        assert_ne!(ground.alike, before);
        ground.undo_slowing();
        assert_eq!(ground.alike, before);
    }

    #[test]
    fn a_wall_has_no_gaps_whatever_its_direction() {
        for to in [DVec2::new(90.0, 90.0), DVec2::new(90.0, 40.0), DVec2::new(40.0, 90.0)] {
            let mut land = flat(10, 10, 10.0);
            let line = vec![DVec2::new(0.0, 0.0), to, to * 3.0];
            land.steps = vec![Step { line, height_m: 5.0 }];
            let ground = travel(&land, &built_in("foot"));
            let times = everywhere(&ground, &[9]);
            assert!(times[9 * 10].is_infinite(), "{to}");
            assert!(times[9 * 10 + 9].is_infinite() || to.x != to.y);
        }
    }

    #[test]
    fn uphill_takes_longer_than_down() {
        let land = shaped(9, 3, 10.0, |column, _| column as f32 * 2.0);
        let ground = travel(&land, &built_in("foot"));
        let up = everywhere(&ground, &[9])[17];
        let down = everywhere(&ground, &[17])[9];
        let tobler = |grade: f64| 80.0 * 3.6 / (6.0 * libm::exp(-3.5 * (grade + 0.05f64).abs()));
        assert!((f64::from(up) - tobler(0.2)).abs() < 0.01, "{up}");
        assert!((f64::from(down) - tobler(-0.2)).abs() < 0.01, "{down}");
    }
}

#[cfg(test)]
#[path = "oracle_tests.rs"]
mod oracle_tests;

#[cfg(test)]
#[path = "metrication_tests.rs"]
mod metrication_tests;
