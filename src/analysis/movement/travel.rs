//! The ground as a vehicle travels it: steps to sixteen neighbors, the eight around a post and the eight knight's moves.
//!
//! A step takes the mean pace of the posts that it passes, times the factor of its grade, which differs between up and down.
//! A diagonal step does not pass between two posts that stop the vehicle, nor a knight's move beside one, so that a chain
//! of posts, such as a river or a wall, has no gaps; along a road or a bridge both may lie beside it.

use crate::error::AnalysisError;
use crate::land::Land;
use crate::movement::going::{Going, SEVERELY_RESTRICTED};
use crate::movement::grade::GradeTable;
use crate::movement::vehicle::Vehicle;
use crate::outcome::PostValues;
use crate::place::nearest_post;
use glam::DVec2;
use sandtable_base::limits::memory::check_memory;
use sandtable_terrain::lattice::Lattice;

/// Sixteen neighbors: columns and rows.
const NEIGHBORS: [[i32; 2]; 16] = [
    [1, 0],
    [0, 1],
    [-1, 0],
    [0, -1],
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
    [2, 1],
    [1, 2],
    [-1, 2],
    [-2, 1],
    [-2, -1],
    [-1, -2],
    [1, -2],
    [2, -1],
];

/// The ground as a vehicle travels it.
pub(crate) struct TravelGround<'a> {
    pub(super) ground: &'a Lattice,
    pub(super) posts: Vec<TravelPost>,
    pub(super) grades: GradeTable,
    /// To the sixteen neighbors; the eight around a post come first.
    pub(super) steps: Vec<TravelStep>,
    pub(super) least_pace: f32,
    pub(super) greatest_pace: f32,
    /// Posts that are slowed, each with its signed pace before, in the order in which they were slowed.
    slowed: Vec<(u32, f32)>,
}

/// A post as a vehicle travels it; what a step needs lies together.
#[derive(Clone, Copy)]
pub(super) struct TravelPost {
    /// Its height in meters, gaps closed that the vehicle crosses.
    height_m: f32,
    /// Seconds per meter on the level; infinite where the vehicle cannot go, below 0 on a road, a bridge or a ford.
    pace_or_way: f32,
}

impl TravelPost {
    /// Seconds per meter on the level; infinite where the vehicle cannot go.
    #[inline]
    fn pace(self) -> f32 {
        self.pace_or_way.abs()
    }

    #[inline]
    fn is_way(self) -> bool {
        self.pace_or_way < 0.0
    }
}

/// A step to a neighbor.
#[derive(Clone, Copy)]
pub(super) struct TravelStep {
    pub columns: i32,
    pub rows: i32,
    pub offset: isize,
    /// The two posts that it passes between or beside; unused for the four straight ones.
    flanks: [isize; 2],
    pub length_m: f32,
    /// The least seconds that it takes anywhere on the ground.
    pub least_s: f32,
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
        let count = ground.heights().len();
        check_memory(count as u64 * 28, "the analysis", "name a smaller `extent`")?;
        if u32::try_from(count).is_err() {
            return Err(AnalysisError::argument(
                "extent",
                "has more posts than ways are found on; name a smaller one",
            ));
        }
        let pace = |speed: f32| if speed > 0.0 { 3.6 / speed } else { f32::INFINITY };
        let heights = going.closed.as_ref().unwrap_or(ground).heights();
        let of_way = going.speed_kmh.iter().zip(&going.is_way);
        let post = |(&height_m, (&speed, &is_way)): (&f32, (&f32, &bool))| TravelPost {
            height_m,
            pace_or_way: if is_way { -pace(speed) } else { pace(speed) },
        };
        let posts: Vec<TravelPost> = heights.iter().zip(of_way).map(post).collect();
        let finite = || posts.iter().map(|post| post.pace()).filter(|pace| pace.is_finite());
        let (least_pace, greatest_pace) =
            (finite().fold(f32::INFINITY, f32::min), finite().fold(0.0, f32::max));
        let grades = GradeTable::new(vehicle, is_langmuir);
        // A ten-thousandth less, for rounding.
        let least_s_per_m = least_pace * grades.least() * 0.9999;
        let columns = ground.columns() as isize;
        let steps = NEIGHBORS.map(|[east, north]| {
            let offset = |east: i32, north: i32| north as isize * columns + east as isize;
            let flanks = match (east.abs(), north.abs()) {
                (2, 1) => [offset(east / 2, 0), offset(east / 2, north)],
                (1, 2) => [offset(0, north / 2), offset(east, north / 2)],
                _ => [offset(east, 0), offset(0, north)],
            };
            let length_m = (ground.cell() * DVec2::new(f64::from(east), f64::from(north))).length() as f32;
            TravelStep {
                columns: east,
                rows: north,
                offset: offset(east, north),
                flanks,
                length_m,
                least_s: length_m * least_s_per_m,
            }
        });
        Ok(Self { ground, posts, grades, steps: steps.into(), least_pace, greatest_pace, slowed: Vec::new() })
    }

    /// Multiplies the pace of posts, to keep a later way off them.
    pub fn slow_down(&mut self, posts: impl IntoIterator<Item = usize>, factor: f32) {
        for index in posts {
            let post = &mut self.posts[index];
            self.slowed.push((index as u32, post.pace_or_way));
            post.pace_or_way *= factor;
            if post.pace().is_finite() {
                self.greatest_pace = self.greatest_pace.max(post.pace());
            }
        }
    }

    /// Gives all posts their paces from before [`TravelGround::slow_down`].
    pub fn undo_slowing(&mut self) {
        while let Some((index, pace)) = self.slowed.pop() {
            self.posts[index as usize].pace_or_way = pace;
        }
    }

    /// Whether the vehicle can be at a post.
    #[inline]
    pub fn is_open(&self, index: usize) -> bool {
        self.posts[index].pace_or_way.is_finite()
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

    /// Seconds from a post to a neighbor; infinite where the step is not passable. The neighbor must be on the lattice.
    #[inline]
    pub(super) fn seconds(&self, from: usize, column: i32, row: i32, step: &TravelStep) -> f32 {
        let to = from.wrapping_add_signed(step.offset);
        let (here, there) = (self.posts[from], self.posts[to]);
        let is_along_way = here.is_way() && there.is_way();
        let mut pace = (here.pace() + there.pace()) * 0.5;
        let reach = step.columns.abs() + step.rows.abs();
        if reach > 1 {
            let flanks = step.flanks.map(|offset| self.posts[from.wrapping_add_signed(offset)].pace());
            match reach {
                2 if !is_along_way && flanks[0].is_infinite() && flanks[1].is_infinite() => {
                    return f32::INFINITY;
                }
                2 => {}
                _ => pace = (pace * 2.0 + flanks[0] + flanks[1]) * 0.25,
            }
        }
        if pace.is_infinite() {
            return pace;
        }
        let grade = (there.height_m - here.height_m) / step.length_m;
        let factor = match is_along_way {
            true => self.grades.on_way(grade),
            false => self.grades.open(grade) * self.across_factor(from, column, row, step),
        };
        pace * step.length_m * factor
    }

    /// The factor of the slope across a step, between the two posts beside its beginning.
    #[inline]
    fn across_factor(&self, from: usize, column: i32, row: i32, step: &TravelStep) -> f32 {
        if !self.grades.has_across() {
            return 1.0;
        }
        let (columns, rows) = (self.ground.columns(), self.ground.rows());
        let own = self.posts[from].height_m;
        let height = |sign: i32| {
            let (east, north) = (column - sign * step.rows, row + sign * step.columns);
            let height = is_on(columns, rows, east, north)
                .then(|| self.posts[(north * columns as i32 + east) as usize].height_m);
            height.filter(|height| !height.is_nan())
        };
        let cell = self.ground.cell().as_vec2();
        let span = glam::Vec2::new(step.rows as f32 * cell.x, step.columns as f32 * cell.y).length();
        let slope = match (height(1), height(-1)) {
            (Some(left), Some(right)) => (left - right) / (2.0 * span),
            (Some(one), None) | (None, Some(one)) => (one - own) / span,
            (None, None) => 0.0,
        };
        self.grades.across(slope.abs())
    }

    /// The posts of the quickest way that ends at a reached post, from the start on.
    pub fn way_to(&self, times: &[f32], end: usize) -> Vec<usize> {
        let (columns, rows) = (self.ground.columns(), self.ground.rows());
        let mut way = vec![end];
        let mut at = end;
        while times[at] > 0.0 && times[at].is_finite() {
            let before = self.steps.iter().find_map(|step| {
                let (column, row) = (at as i64 % i64::from(columns), at as i64 / i64::from(columns));
                let (column, row) = (column as i32 - step.columns, row as i32 - step.rows);
                let before = at.wrapping_add_signed(-step.offset);
                let leads = is_on(columns, rows, column, row)
                    && times[before] < times[at]
                    && times[before] + self.seconds(before, column, row, step) == times[at];
                leads.then_some(before)
            });
            // Every reached post but a start has one.
            let Some(before) = before else { break };
            way.push(before);
            at = before;
        }
        way.reverse();
        way
    }

    /// Seconds along posts that follow each other as neighbors.
    pub fn seconds_along(&self, way: &[usize]) -> Vec<f64> {
        let columns = self.ground.columns() as i32;
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for ends in way.windows(2) {
            let offset = ends[1] as isize - ends[0] as isize;
            let (column, row) = (ends[0] as i32 % columns, ends[0] as i32 / columns);
            if let Some(step) = self.steps.iter().find(|step| {
                step.offset == offset
                    && is_on(columns as u32, self.ground.rows(), column + step.columns, row + step.rows)
            }) {
                sum += f64::from(self.seconds(ends[0], column, row, step));
            }
            sums.push(sum);
        }
        sums
    }

    /// The height of a post as the vehicle travels it, meters.
    pub fn height_m(&self, index: usize) -> f32 {
        self.posts[index].height_m
    }

    /// The ground.
    pub fn lattice(&self) -> &'a Lattice {
        self.ground
    }
}

pub(super) fn is_on(columns: u32, rows: u32, column: i32, row: i32) -> bool {
    column >= 0 && row >= 0 && column < columns as i32 && row < rows as i32
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
    use crate::land::Step;
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
    fn on_level_ground_times_are_at_most_2_point_8_percent_too_long() {
        let land = flat(41, 41, 10.0);
        let ground = travel(&land, &built_in("truck"));
        let center = 20 * 41 + 20;
        let times = everywhere(&ground, &[center]);
        let pace = 3.6 / 15.0;
        for post in land.ground.posts() {
            let straight = (post.grid() - 20.0).length() * 10.0 * pace;
            let found = f64::from(times[land.ground.index(post)]);
            assert!(
                found >= straight * 0.99999 && found <= straight * 1.0276,
                "{post:?}: {found} {straight}"
            );
        }
        let exact = |column: u32, row: u32| f64::from(times[land.ground.index(Post { column, row })]);
        assert!((exact(40, 30) - 500f64.sqrt() * 10.0 * pace).abs() < 1e-3);
        assert!((exact(40, 20) - 200.0 * pace).abs() < 1e-3);
    }

    #[test]
    fn times_are_those_of_relaxing_every_step_until_nothing_changes() {
        let mut land = shaped(17, 13, 10.0, |column, row| {
            let wave = ((column * 7 + row * 13 + column * row) % 11) as f32;
            if (column, row) == (5, 5) { f32::NAN } else { wave * 0.35 }
        });
        let line = vec![DVec2::new(80.0, 0.0), DVec2::new(110.0, 90.0)];
        land.steps = vec![Step { line, height_m: 3.0 }];
        for name in ["foot", "tracked", "truck"] {
            let ground = travel(&land, &built_in(name));
            let times = everywhere(&ground, &[0, 20]);
            let mut slow = vec![f32::INFINITY; times.len()];
            (slow[0], slow[20]) = (0.0, 0.0);
            loop {
                let before = slow.clone();
                for from in 0..slow.len() {
                    let (column, row) = ((from % 17) as i32, (from / 17) as i32);
                    for step in &ground.steps {
                        if is_on(17, 13, column + step.columns, row + step.rows) {
                            let to = from.wrapping_add_signed(step.offset);
                            slow[to] = slow[to].min(slow[from] + ground.seconds(from, column, row, step));
                        }
                    }
                }
                if slow == before {
                    break;
                }
            }
            assert_eq!(times, slow, "{name}");
            let end = 12 * 17 + 16;
            let way = ground.way_to(&times, end);
            assert!(times[way[0]] == 0.0 && times[end].is_finite(), "{name}");
            let along = *ground.seconds_along(&way).last().expect("posts");
            assert!((along - f64::from(times[end])).abs() < 1e-3 * along, "{name}");
        }
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
