//! The time that a vehicle takes from places to every post, or to a goal: shortest ways over the ground.
//!
//! Times are sums of f32. Such a sum never falls as a summand rises, so the least time of each post is one number, whatever
//! the order in which posts are reached. Threads share the posts in blocks of rows, each with a queue for its own, and go
//! through the buckets together: what one reaches in a block of another, it hands over before the next bucket. Only posts
//! whose bucket was emptied or is being emptied lead on, and a search ends between buckets: what it found by then is one set
//! of numbers, too.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::movement::neighbors::{RING, RingTriangle, SIDES, TravelStep};
use crate::movement::queue::{BucketQueue, QueuedPost};
use crate::movement::travel::TravelGround;
use crate::movement::triangles::TravelTriangle;
use sandtable_terrain::stop_flag::StopFlag;

/// The posts taken from the queue between two looks at the stop flag.
const POSTS_PER_LOOK: usize = 1 << 16;

/// Fewer posts than this are searched by one thread: buckets are then too small to share.
const LEAST_SHARED: usize = 1 << 20;

/// The most threads: blocks and buckets become too small for more.
const MOST_LANES: usize = 8;

/// The most rows of a block, and how many blocks each lane has at least: fewer rows share the work more evenly, more have
/// fewer posts at the edges of blocks.
const ROWS_PER_BLOCK: usize = 96;
const BLOCKS_PER_LANE: usize = 8;

/// A bucket with fewer posts is emptied by one thread: waking another takes as long.
const LEAST_SHARED_BUCKET: usize = 512;

/// What a journey ends at.
#[derive(Clone, Copy)]
pub(crate) struct TravelGoal<'a> {
    /// No post is reached later, seconds.
    most_s: f32,
    /// It ends as soon as one of these posts is reached for certain; `None` to reach all.
    any_of: Option<&'a [usize]>,
}

impl<'a> TravelGoal<'a> {
    /// All posts that are reached in so many seconds.
    pub fn within(most_s: f32) -> Self {
        Self { most_s, any_of: None }
    }

    /// One of these posts, which rise, whenever it is reached.
    pub fn any_of(posts: &'a [usize]) -> Self {
        Self { most_s: f32::INFINITY, any_of: Some(posts) }
    }
}

/// The least time from a post to a goal: straight to the rectangle of its posts, on the best ground there is.
#[derive(Clone, Copy)]
struct OnwardTime {
    least: [f32; 2],
    greatest: [f32; 2],
    /// The least seconds from a column to the next, and from a row to the next.
    pace_s: [f32; 2],
}

impl OnwardTime {
    /// To posts of the ground; `None` where there are none.
    fn new(ground: &TravelGround<'_>, posts: &[usize]) -> Option<Self> {
        let columns = ground.ground.columns() as usize;
        let range = |of: fn(usize, usize) -> usize| {
            let at = || posts.iter().map(move |&post| of(post, columns));
            Some((at().min()? as f32, at().max()? as f32))
        };
        let (west, east) = range(|post, columns| post % columns)?;
        let (south, north) = range(|post, columns| post / columns)?;
        // A thousandth less, for the rounding of times that are sums.
        let pace_s = ground.least_pace * ground.grades.least() * 0.999;
        let cell = ground.ground.cell().as_vec2() * pace_s;
        Some(Self { least: [west, south], greatest: [east, north], pace_s: [cell.x, cell.y] })
    }

    #[inline]
    fn seconds(self, column: i32, row: i32) -> f32 {
        let beyond = |axis: usize, at: i32| {
            let at = at as f32;
            (self.least[axis] - at).max(at - self.greatest[axis]).max(0.0) * self.pace_s[axis]
        };
        let (east, north) = (beyond(0, column), beyond(1, row));
        (east * east + north * north).sqrt()
    }
}

/// The part of a thread in a search: the posts of some blocks.
struct SearchLane {
    number: usize,
    queue: BucketQueue,
    /// Posts of other lanes that were reached, by lane.
    outboxes: Vec<Vec<QueuedPost>>,
    /// The time of the first of the goal's posts that was taken from the queue.
    ends_s: f32,
    looks: usize,
}

/// Seconds to posts, by their bits and by the indices of posts with the border; infinite where none is reached.
pub(super) struct TravelTimes(Vec<AtomicU32>);

impl TravelTimes {
    /// The time of a post.
    #[inline]
    pub fn time_s(&self, post: usize) -> f32 {
        f32::from_bits(self.0[post].load(Ordering::Relaxed))
    }
}

/// A search over the ground; indices are those with the border.
struct TravelFront<'a, 'b> {
    ground: &'a TravelGround<'b>,
    /// A thread writes those of its own blocks alone, and reads all.
    times: TravelTimes,
    onward: Option<OnwardTime>,
    /// The goal's posts, which rise.
    goals: Vec<usize>,
    /// No post is reached that is expected at the goal later, seconds.
    ends_s: f32,
    /// How much later than the goal posts are looked at, seconds: the side of a triangle that leads to a post may have its
    /// diagonal end expected later by as much as that end is farther.
    slack_s: f32,
    /// A block has two to the power of this many posts.
    block_bits: u32,
    lanes: usize,
}

impl TravelFront<'_, '_> {
    #[inline]
    fn time_s(&self, post: usize) -> f32 {
        self.times.time_s(post)
    }

    #[inline]
    fn lane_of(&self, post: usize) -> usize {
        (post >> self.block_bits) & (self.lanes - 1)
    }

    #[inline]
    fn onward_s(&self, post: usize) -> f32 {
        self.onward.map_or(0.0, |onward| {
            let [column, row] = self.ground.column_and_row(post);
            onward.seconds(column, row)
        })
    }

    /// The same for the end of a step from a post whose column and row are known.
    #[inline]
    fn onward_by_s(&self, [column, row]: [i32; 2], step: &TravelStep) -> f32 {
        self.onward.map_or(0.0, |onward| onward.seconds(column + step.columns, row + step.rows))
    }

    /// Empties the bucket of a lane; posts of the lane that are pushed into it meanwhile are left there.
    fn empty_bucket(&self, lane: &mut SearchLane, bucket: u64) {
        let posts = lane.queue.take_bucket(bucket);
        lane.looks += posts.len();
        for &post in &posts {
            self.go_on(post, lane);
        }
        lane.queue.give_back(posts);
    }

    /// A post is reached at a time: where that is sooner than before, it goes into the queue of its lane.
    #[inline]
    fn reach(&self, to: usize, time_s: f32, lane: &mut SearchLane) {
        self.reach_with(to, time_s, || self.onward_s(to), lane);
    }

    /// [`TravelFront::reach`] with what gives the least time on from the post.
    #[inline]
    fn reach_with(&self, to: usize, time_s: f32, onward_s: impl Fn() -> f32, lane: &mut SearchLane) {
        let before_s = self.time_s(to);
        if time_s >= before_s || time_s.is_nan() {
            return;
        }
        let onward_s = onward_s();
        if time_s + onward_s > self.ends_s {
            return;
        }
        let post = QueuedPost { index: to as u32, time_s };
        let owner = self.lane_of(to);
        if owner == lane.number {
            self.times.0[to].store(time_s.to_bits(), Ordering::Relaxed);
            lane.queue.push(post, time_s + onward_s, before_s + onward_s);
        } else {
            lane.outboxes[owner].push(post);
        }
    }

    /// Goes on from a post to its neighbors.
    #[inline]
    fn go_on(&self, entry: QueuedPost, lane: &mut SearchLane) {
        let from = entry.index as usize;
        let time_s = self.time_s(from);
        let expected_s = time_s + self.onward_s(from);
        if !lane.queue.holds(entry, time_s, expected_s) || expected_s > self.ends_s {
            return;
        }
        if expected_s >= lane.queue.emptied_to_s() {
            lane.queue.put_back(entry, expected_s);
            return;
        }
        if self.goals.binary_search(&from).is_ok() {
            lane.ends_s = lane.ends_s.min(time_s);
        }
        match (self.ground.is_alike(from), self.ground.grades.has_across()) {
            (true, false) => self.go_on_over::<true, false>(from, time_s, lane),
            (true, true) => self.go_on_over::<true, true>(from, time_s, lane),
            (false, _) => self.go_on_over::<false, false>(from, time_s, lane),
        }
    }

    /// Goes on from a post; `ALIKE` where the ground has one pace all around it, with `ACROSS` where slopes across slow the
    /// vehicle.
    #[inline]
    fn go_on_over<const ALIKE: bool, const ACROSS: bool>(
        &self,
        from: usize,
        time_s: f32,
        lane: &mut SearchLane,
    ) {
        let ground = self.ground;
        let pace = ground.pace(from);
        let least_pace = if ALIKE { pace } else { ground.least_pace };
        let at = if self.onward.is_some() { ground.column_and_row(from) } else { [0; 2] };
        // No step is quicker than its least time.
        let least_s = |step: &TravelStep| time_s + step.least_per_pace_s * least_pace;
        let arrival_s = |step: &TravelStep| match ALIKE {
            true => time_s + ground.open_seconds::<ACROSS>(from, pace, step),
            false => time_s + ground.seconds(from, step),
        };
        let (ring, knights) = ground.steps.split_at(RING);
        for step in knights {
            let to = from.wrapping_add_signed(step.offset);
            if least_s(step) < self.time_s(to) {
                self.reach_with(to, arrival_s(step), || self.onward_by_s(at, step), lane);
            }
        }
        let mut before_s = [f32::INFINITY; RING];
        let mut posts = [0usize; RING];
        for (index, step) in ring.iter().enumerate() {
            posts[index] = from.wrapping_add_signed(step.offset);
            before_s[index] = self.time_s(posts[index]);
        }
        let mut reached_s = before_s;
        for (step, reached_s) in ring.iter().zip(&mut reached_s) {
            if least_s(step) < *reached_s {
                *reached_s = reached_s.min(arrival_s(step));
            }
        }
        if ground.has_triangles {
            let paces = [pace; 2];
            let mut heights_m = [0.0; RING];
            if ALIKE {
                for index in 0..RING {
                    heights_m[index] = ground.height(posts[index]);
                }
            }
            let own_m = ground.height(from);
            // Of a side, the post that is taken later leads on across its triangles.
            let emptied_to_s = lane.queue.emptied_to_s();
            for (side, triangles) in SIDES.iter().enumerate() {
                if before_s[side] + self.onward_by_s(at, &ring[side]) >= emptied_to_s {
                    continue;
                }
                let first_s = before_s[side].min(time_s);
                for &RingTriangle { to, is_from_straight, axis } in triangles {
                    if first_s + ring[axis].least_per_pace_s * least_pace >= reached_s[to] {
                        continue;
                    }
                    let (times_s, corners) = match is_from_straight {
                        true => ([time_s, before_s[side]], [from, posts[side]]),
                        false => ([before_s[side], time_s], [posts[side], from]),
                    };
                    let arrival_s = if ALIKE {
                        let [height_a, height_b] = match is_from_straight {
                            true => [own_m, heights_m[side]],
                            false => [heights_m[side], own_m],
                        };
                        let heights_m = [height_a, height_b, heights_m[to]];
                        let triangle = TravelTriangle { times_s, heights_m, paces, is_way: false };
                        ground.triangles.arrival_s::<ACROSS>(&triangle, axis, &ground.grades)
                    } else {
                        let triangle = ground.triangle([corners[0], corners[1], posts[to]], times_s);
                        triangle.map_or(f32::INFINITY, |triangle| ground.arrival_s(&triangle, axis))
                    };
                    reached_s[to] = reached_s[to].min(arrival_s);
                }
            }
        }
        for index in 0..RING {
            if reached_s[index] < before_s[index] {
                let onward_s = || self.onward_by_s(at, &ring[index]);
                self.reach_with(posts[index], reached_s[index], onward_s, lane);
            }
        }
    }

    /// Goes on until nothing is reached any more.
    fn run(&mut self, lanes: &mut [SearchLane], stop: &StopFlag) {
        let mut emptied = 0;
        while let Some(bucket) = lanes.iter().filter_map(|lane| lane.queue.first_bucket()).min() {
            if bucket > emptied {
                emptied = bucket;
                self.ends_s = lanes.iter().map(|lane| lane.ends_s + self.slack_s).fold(self.ends_s, f32::min);
                if lanes[0].queue.start_s(bucket) > f64::from(self.ends_s) {
                    break;
                }
            }
            let front = &*self;
            let posts: usize = lanes.iter().map(|lane| lane.queue.posts_in(bucket)).sum();
            if posts < LEAST_SHARED_BUCKET || lanes.len() == 1 {
                lanes.iter_mut().for_each(|lane| front.empty_bucket(lane, bucket));
            } else {
                lanes.par_iter_mut().for_each(|lane| front.empty_bucket(lane, bucket));
            }
            for lane in 0..lanes.len() {
                for other in 0..lanes.len() {
                    let mut posts = std::mem::take(&mut lanes[other].outboxes[lane]);
                    for post in posts.drain(..) {
                        front.reach(post.index as usize, post.time_s, &mut lanes[lane]);
                    }
                    lanes[other].outboxes[lane] = posts;
                }
            }
            let looks = lanes.iter().map(|lane| lane.looks).sum::<usize>();
            if looks >= POSTS_PER_LOOK {
                stop.did(looks);
                lanes.iter_mut().for_each(|lane| lane.looks = 0);
                if stop.is_stopped() {
                    break;
                }
            }
        }
    }
}

impl TravelGround<'_> {
    /// Seconds from the nearest in time of the starts to each post; infinite where none is reached. With a goal, the posts on
    /// the quickest way to the nearest of its posts have their times, and others may have later ones: the search looks first
    /// where the least time on to the goal is the least (Hart, Nilsson and Raphael 1968).
    pub fn times(&self, starts: &[usize], goal: TravelGoal<'_>, stop: &StopFlag) -> Vec<f32> {
        self.inner_times(&self.search(starts, goal, stop))
    }

    /// The times of posts without their border.
    pub(super) fn inner_times(&self, found: &TravelTimes) -> Vec<f32> {
        let mut times = vec![f32::INFINITY; self.ground.heights().len()];
        times.par_chunks_mut(self.ground.columns() as usize).enumerate().for_each(|(row, times)| {
            let posts = self.framed_row(row);
            times.iter_mut().zip(posts).for_each(|(time, post)| *time = found.time_s(post));
        });
        times
    }

    /// The search for [`TravelGround::times`].
    pub(super) fn search(&self, starts: &[usize], goal: TravelGoal<'_>, stop: &StopFlag) -> TravelTimes {
        let lanes = match self.framed_count() {
            ..LEAST_SHARED => 1,
            _ => rayon::current_num_threads().min(MOST_LANES),
        };
        // Rounded down to a power of two.
        self.search_in_lanes(starts, goal, stop, 1 << lanes.max(1).ilog2())
    }

    /// [`TravelGround::search`] by so many threads, a power of two.
    pub(super) fn search_in_lanes(
        &self,
        starts: &[usize],
        goal: TravelGoal<'_>,
        stop: &StopFlag,
        lanes: usize,
    ) -> TravelTimes {
        let unreached = || AtomicU32::new(f32::INFINITY.to_bits());
        let times = TravelTimes((0..self.framed_count()).into_par_iter().map(|_| unreached()).collect());
        if !self.least_pace.is_finite() {
            return times;
        }
        let rows = self.ground.rows() as usize / (BLOCKS_PER_LANE * lanes);
        let mut front = TravelFront {
            ground: self,
            times,
            onward: goal.any_of.and_then(|posts| OnwardTime::new(self, posts)),
            goals: goal.any_of.iter().copied().flatten().map(|&post| self.framed(post)).collect(),
            ends_s: goal.most_s,
            slack_s: self.steps.iter().take(RING).map(|step| step.least_per_pace_s).fold(0.0, f32::max)
                * self.least_pace,
            block_bits: (self.width * rows.clamp(1, ROWS_PER_BLOCK)).ilog2(),
            lanes,
        };
        let lane = |number| SearchLane {
            number,
            queue: self.queue(front.onward.is_some()),
            outboxes: vec![Vec::new(); lanes],
            ends_s: f32::INFINITY,
            looks: 0,
        };
        let mut lanes: Vec<SearchLane> = (0..lanes).map(lane).collect();
        for &start in starts.iter().filter(|&&start| self.is_open(start)) {
            let post = self.framed(start);
            let lane = front.lane_of(post);
            front.reach(post, 0.0, &mut lanes[lane]);
        }
        // Within the pool, threads wait for each other without going to sleep.
        rayon::scope(|_| front.run(&mut lanes, stop));
        front.times
    }

    /// A queue for the steps on this ground.
    fn queue(&self, is_toward_goal: bool) -> BucketQueue {
        let length =
            |of: fn(f32, f32) -> f32, first: f32| self.steps.iter().map(|step| step.length_m).fold(first, of);
        let shortest = length(f32::min, f32::INFINITY) * self.grades.least();
        let longest = length(f32::max, 0.0) * self.grades.greatest();
        // A tenth less, for rounding. Toward a goal, steps take as little as nothing more than was expected.
        let (least, most) = if is_toward_goal { (0.2, 2.2) } else { (0.9, 1.1) };
        let shortest_s = f64::from(shortest * self.least_pace) * least;
        BucketQueue::new(shortest_s, f64::from(longest) * f64::from(self.greatest_pace) * most)
    }
}
