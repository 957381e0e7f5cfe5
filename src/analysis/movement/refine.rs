//! The quickest way to a post over chosen points, searched back from it (Hart, Nilsson and Raphael 1968).
//!
//! The times of a search from the starts estimate what is left of the way back, so that hardly more is looked at than points
//! near the quickest way. Over posts alone these times are never longer than what is left: the way that is found is the
//! quickest by steps.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::hash::{BuildHasherDefault, Hasher};

use crate::movement::search::TravelTimes;
use crate::movement::travel::TravelGround;
use crate::movement::way::WayPoint;

/// The points over which a way is searched.
pub(super) struct WayChoice {
    /// How many parts the sides of cells are cut into by points; 1 for posts alone.
    pub parts: usize,
    /// The posts at which points may lie or on whose sides to the north and east, which rise; `None` for all.
    pub posts: Option<Vec<usize>>,
}

/// A point that was reached from the end.
#[derive(Clone, Copy)]
struct ReachedPoint {
    /// Seconds from it to the end.
    left_s: f64,
    /// The number of the point that follows.
    next: u64,
}

/// A hash of numbers of points, which are alike in their upper bits.
#[derive(Default)]
struct PointHasher(u64);

impl Hasher for PointHasher {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u64(&mut self, number: u64) {
        let mixed = (self.0 ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ mixed >> 32;
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

struct BackFront<'a, 'b> {
    ground: &'a TravelGround<'b>,
    times: &'a TravelTimes,
    choice: &'a WayChoice,
    reached: HashMap<u64, ReachedPoint, BuildHasherDefault<PointHasher>>,
    queue: BinaryHeap<Reverse<(u64, u64)>>,
    most_s: f64,
}

impl BackFront<'_, '_> {
    fn number(&self, point: WayPoint) -> u64 {
        let parts = self.choice.parts;
        let [post, other] = point.ends();
        let part = (point.share() * parts as f32).round() as usize;
        let slot = match other - post {
            0 => 0,
            1 => part,
            _ => parts + part,
        };
        (post * 2 * parts + slot) as u64
    }

    fn point(&self, number: u64) -> WayPoint {
        let parts = self.choice.parts;
        let (post, slot) = (number as usize / (2 * parts), number as usize % (2 * parts));
        match slot {
            0 => WayPoint::at(post),
            east if east < parts => WayPoint::between(post, post + 1, east as f32 / parts as f32),
            north => WayPoint::between(post, post + self.ground.width, (north - parts) as f32 / parts as f32),
        }
    }

    fn is_allowed(&self, post: usize) -> bool {
        self.choice.posts.as_ref().is_none_or(|posts| posts.binary_search(&post).is_ok())
    }

    /// A way leads from a point to another, from which so many seconds are left.
    fn reach(&mut self, from: WayPoint, to: WayPoint, to_left_s: f64) {
        let time_s = f64::from(from.mix(|post| self.times.time_s(post)));
        if to_left_s + time_s >= self.most_s {
            return;
        }
        let left_s = to_left_s + f64::from(self.ground.piece_s(from, to));
        if left_s + time_s >= self.most_s {
            return;
        }
        let number = self.number(from);
        let next = self.number(to);
        let point = self.reached.entry(number).or_insert(ReachedPoint { left_s: f64::INFINITY, next });
        if left_s < point.left_s {
            *point = ReachedPoint { left_s, next };
            self.queue.push(Reverse(((left_s + time_s).to_bits(), number)));
        }
    }

    /// Reaches all from which a piece leads to a point.
    fn reach_around(&mut self, at: WayPoint, left_s: f64) {
        let (ground, width) = (self.ground, self.ground.width);
        let [post, other] = at.ends();
        if at.is_post() {
            for step in &ground.steps {
                let from = post.wrapping_add_signed(-step.offset);
                if self.is_allowed(from) {
                    self.reach(WayPoint::at(from), at, left_s);
                }
            }
        }
        let parts = self.choice.parts;
        if parts == 1 {
            return;
        }
        let cells = match other - post {
            0 => &[post, post - 1, post - width, post - width - 1][..],
            1 => &[post, post - width],
            _ => &[post, post - 1],
        };
        for &cell in cells {
            let corners = [cell, cell + 1, cell + width, cell + width + 1];
            let is_open = corners.map(|post| ground.pace(post).is_finite() && self.is_allowed(post));
            for [one, other] in [[0, 1], [0, 2], [1, 3], [2, 3]] {
                if is_open[one] && is_open[other] {
                    for part in 1..parts {
                        let share = part as f32 / parts as f32;
                        let point = WayPoint::between(corners[one], corners[other], share);
                        self.reach(point, at, left_s);
                    }
                }
            }
            if !at.is_post() {
                for (&corner, is_open) in corners.iter().zip(is_open) {
                    if is_open {
                        self.reach(WayPoint::at(corner), at, left_s);
                    }
                }
            }
        }
    }
}

/// The points of the quickest way to a post from where times are 0; empty where none takes less than so many seconds.
pub(super) fn quickest_way(
    ground: &TravelGround<'_>,
    times: &TravelTimes,
    end: usize,
    most_s: f64,
    choice: &WayChoice,
) -> Vec<WayPoint> {
    let (reached, queue) = (HashMap::default(), BinaryHeap::new());
    let mut front = BackFront { ground, times, choice, reached, queue, most_s };
    let end = WayPoint::at(end);
    let number = front.number(end);
    front.reached.insert(number, ReachedPoint { left_s: 0.0, next: number });
    front.queue.push(Reverse((f64::from(end.mix(|post| times.time_s(post))).to_bits(), number)));
    while let Some(Reverse((expected, number))) = front.queue.pop() {
        let at = front.point(number);
        let ReachedPoint { left_s, .. } = front.reached[&number];
        let time_s = f64::from(at.mix(|post| times.time_s(post)));
        if (left_s + time_s).to_bits() != expected {
            continue;
        }
        if time_s == 0.0 {
            let mut points = vec![at];
            let mut number = number;
            while front.reached[&number].next != number {
                number = front.reached[&number].next;
                points.push(front.point(number));
            }
            return points;
        }
        front.reach_around(at, left_s);
    }
    Vec::new()
}
