//! The time that a vehicle takes from places to every post, or to a goal: shortest ways over the steps of the ground.
//!
//! Times are sums of f32. Such a sum never falls as a summand rises, so the least time of each post is one number, whatever
//! the order in which posts are reached. The way back is found from the times alone, ties by the order of neighbors.
//!
//! One thread does it: sharing the posts of a bucket between two gained nothing when it was measured.

use crate::movement::queue::{BucketQueue, QueuedPost};
use crate::movement::travel::{TravelGround, is_on};
use sandtable_terrain::stop_flag::StopFlag;

/// The posts taken from the queue between two looks at the stop flag.
const POSTS_PER_LOOK: usize = 1 << 16;

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

/// A post that was reached, with when it is expected at the goal.
type ReachedPost = (QueuedPost, f32);

/// A search over the ground.
struct TravelFront<'a, 'b> {
    ground: &'a TravelGround<'b>,
    times: Vec<f32>,
    onward: Option<OnwardTime>,
    goal: TravelGoal<'a>,
    ends_s: f32,
}

impl TravelFront<'_, '_> {
    /// Whether the search ends at this post: it then goes no further than posts that are as near.
    fn ends_at(&mut self, post: QueuedPost) -> bool {
        let Some(goals) = self.goal.any_of else { return false };
        let is_end = self.times[post.index as usize] == post.time_s
            && goals.binary_search(&(post.index as usize)).is_ok();
        if is_end {
            self.ends_s = self.ends_s.min(post.time_s);
        }
        is_end
    }

    #[inline]
    fn onward_s(&self, column: i32, row: i32) -> f32 {
        self.onward.map_or(0.0, |onward| onward.seconds(column, row))
    }

    /// Goes on from a post to its neighbors; what is reached sooner than before is added to `reached`.
    #[inline]
    fn go_on(&mut self, post: QueuedPost, reached: &mut Vec<ReachedPost>) {
        let ground = self.ground;
        let (columns, rows) = (ground.ground.columns(), ground.ground.rows());
        let (from, time_s) = (post.index as usize, post.time_s);
        let (column, row) = ((post.index % columns) as i32, (post.index / columns) as i32);
        if self.times[from] != time_s || time_s + self.onward_s(column, row) > self.ends_s {
            return;
        }
        let is_inner = column >= 2 && row >= 2 && column + 2 < columns as i32 && row + 2 < rows as i32;
        for step in &ground.steps {
            if !is_inner && !is_on(columns, rows, column + step.columns, row + step.rows) {
                continue;
            }
            let to = from.wrapping_add_signed(step.offset);
            let before_s = self.times[to];
            // No step is quicker than its least time.
            if before_s <= time_s + step.least_s {
                continue;
            }
            let arrival_s = time_s + ground.seconds(from, column, row, step);
            if arrival_s >= before_s {
                continue;
            }
            let expected_s = arrival_s + self.onward_s(column + step.columns, row + step.rows);
            if expected_s <= self.ends_s {
                self.times[to] = arrival_s;
                reached.push((QueuedPost { index: to as u32, time_s: arrival_s }, expected_s));
            }
        }
    }
}

impl TravelGround<'_> {
    /// Seconds from the nearest in time of the starts to each post; infinite where none is reached. With a goal, the posts on
    /// the quickest way to the nearest of its posts have their times, and others may have later ones: the search looks first
    /// where the least time on to the goal is the least (Hart, Nilsson and Raphael 1968).
    pub fn times(&self, starts: &[usize], goal: TravelGoal<'_>, stop: &StopFlag) -> Vec<f32> {
        if !self.least_pace.is_finite() {
            return vec![f32::INFINITY; self.posts.len()];
        }
        let onward = goal.any_of.and_then(|posts| OnwardTime::new(self, posts));
        let mut queue = self.queue(onward.is_some());
        let times = vec![f32::INFINITY; self.posts.len()];
        let mut front = TravelFront { ground: self, times, onward, goal, ends_s: goal.most_s };
        for &start in starts.iter().filter(|&&start| self.is_open(start)) {
            if front.times[start] > 0.0 {
                front.times[start] = 0.0;
                queue.push(QueuedPost { index: start as u32, time_s: 0.0 }, 0.0);
            }
        }
        let mut reached = Vec::new();
        let mut looks = 0usize;
        while let Some(bucket) = queue.take_bucket() {
            looks += bucket.len();
            if looks >= POSTS_PER_LOOK {
                stop.did(looks);
                looks = 0;
                if stop.is_stopped() {
                    break;
                }
            }
            for &post in &bucket {
                if !front.ends_at(post) {
                    front.go_on(post, &mut reached);
                }
            }
            reached.drain(..).for_each(|(post, expected_s)| queue.push(post, expected_s));
            queue.give_back(bucket);
        }
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
