//! One road between two places: the cheapest way over the ground, then bent to follow the slope.
//!
//! The way is searched by Dijkstra's algorithm (1959) from post to post, with moves to sixteen neighbors so
//! that it can take gentle diagonals. A meter costs more the steeper it is, with the square of the grade,
//! and far more above the road's limit; crossing a stream costs a bridge, and standing water cannot be
//! crossed. Turning costs too, so what is searched is not the post but the post and the direction it is
//! reached in: without that a steep slope is climbed in zigzags as narrow as the posts, with it in a few
//! long legs.
//!
//! Then the line is resampled and relaxed: each vertex is drawn toward the middle of its neighbors, which
//! rounds the bends, and along the slope to where the ground has the height of a smoothed profile, which
//! takes out humps and dips as a surveyor's grade line does.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::DVec2;

use super::flow::Flow;
use super::ground::Ground;
use super::line;

/// How a road is laid out.
#[derive(Clone, Copy)]
pub struct Design {
    /// The grade the way is planned for, rise over run.
    pub grade: f64,
    /// Extra cost of a meter at that grade, in meters: high values wind more and climb less steeply.
    pub climb_cost: f64,
    /// Extra cost of a meter on a slope of one, in meters: high values keep to gentle ground.
    pub slope_cost: f64,
    /// How often the line is relaxed: more rounds give wider bends.
    pub rounds: usize,
    /// How eagerly relaxing follows the slope, from 0 to 0.5: high values keep the grade, low ones the line.
    pub grading: f64,
}

/// Cost of a meter that is steeper than planned: steep enough to wind instead, not so much as to have no way.
const TOO_STEEP: f64 = 40.0;
/// Cost of a right angle, in meters of way; it grows with the square of 1 − cos, so that half a turn costs
/// four times as much and the least turn next to nothing.
const TURN_M: f64 = 120.0;
/// Cost of stepping into a stream, in meters of way.
const BRIDGE_M: f64 = 500.0;
/// Extra cost of a meter along a stream's posts, and on those beside it, in meters: a road keeps to one bank.
const IN_STREAM: f64 = 4.0;
const BESIDE_STREAM: f64 = 0.8;
/// Ground that a stream must drain for the road to mind it, in square kilometers.
const MINDED_KM2: f64 = 3.0;
/// How many posts round two stops are searched for a way between them.
const MARGIN: usize = 30;
/// Distance between vertices while the line is relaxed, in meters.
const SPACING_M: f64 = 45.0;
/// How much of the line's detail is dropped, in meters.
const DETAIL_M: f64 = 2.0;
/// Moves to the eight neighbors and the eight knight's moves.
const MOVES: [(isize, isize); 16] = [
    (-1, 0),
    (1, 0),
    (0, -1),
    (0, 1),
    (-1, -1),
    (-1, 1),
    (1, -1),
    (1, 1),
    (-2, -1),
    (-2, 1),
    (2, -1),
    (2, 1),
    (-1, -2),
    (-1, 2),
    (1, -2),
    (1, 2),
];

/// The ground as roads see it.
pub struct Planner<'a> {
    ground: &'a Ground,
    water: &'a [bool],
    stream: Vec<bool>,
    beside: Vec<bool>,
    steepness: Vec<f64>,
}

/// A window of posts: first column, first row, columns, rows.
struct Window {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Window {
    fn around(ground: &Ground, a: usize, b: usize) -> Self {
        let span = |a: usize, b: usize, end: usize| {
            let from = a.min(b).saturating_sub(MARGIN);
            (from, (a.max(b) + MARGIN + 1).min(end) - from)
        };
        let (left, width) = span(a % ground.width, b % ground.width, ground.width);
        let (top, height) = span(a / ground.width, b / ground.width, ground.height);
        Self { left, top, width, height }
    }
}

impl<'a> Planner<'a> {
    /// A planner over a ground.
    pub fn over(ground: &'a Ground, flow: &Flow, water: &'a [bool]) -> Self {
        let stream: Vec<bool> = flow.area_km2.iter().map(|&area| area >= MINDED_KM2).collect();
        let near = |post| ground.neighbors(post).any(|(neighbor, _)| stream[neighbor]);
        let beside = (0..stream.len()).map(near).collect();
        let reach = ground.post_m.x;
        let slope = |post| ground.gradient(ground.place(post), reach).length();
        Self { ground, water, stream, beside, steepness: (0..ground.z.len()).map(slope).collect() }
    }

    /// A road through `stops` in their order, laid out by `design`; its ends are the first and last stop,
    /// the ones between are passed near by.
    pub fn road(&self, stops: &[DVec2], design: Design) -> Vec<DVec2> {
        let mut way = vec![stops[0]];
        for pair in stops.windows(2) {
            let posts = self.cheapest(self.ground.post_at(pair[0]), self.ground.post_at(pair[1]), design);
            way.extend(posts.iter().skip(1).map(|&post| self.ground.place(post)));
        }
        *way.last_mut().expect("a way has vertices") = stops[stops.len() - 1];
        self.relax(&way, design)
    }

    /// The cheapest way from one post to another, both included.
    fn cheapest(&self, from: usize, to: usize, design: Design) -> Vec<usize> {
        let window = Window::around(self.ground, from, to);
        let states = window.width * window.height * MOVES.len();
        let state = |post: usize, heading: usize| {
            let (row, column) =
                (post / self.ground.width - window.top, post % self.ground.width - window.left);
            (row * window.width + column) * MOVES.len() + heading
        };
        let mut cost = vec![u64::MAX; states];
        let mut before = vec![(from, 0); states];
        let mut queue: BinaryHeap<_> =
            (0..MOVES.len()).map(|heading| Reverse((0u64, from, heading))).collect();
        let mut end = (from, 0);
        while let Some(Reverse((reached, post, heading))) = queue.pop() {
            if post == to {
                end = (post, heading);
                break;
            }
            if reached > cost[state(post, heading)] {
                continue;
            }
            for (next, turned, run) in self.moves(&window, post) {
                let total = reached + self.price(post, next, run, design) + self.turn(heading, turned);
                if !self.water[next] && total < cost[state(next, turned)] {
                    cost[state(next, turned)] = total;
                    before[state(next, turned)] = (post, heading);
                    queue.push(Reverse((total, next, turned)));
                }
            }
        }
        assert_eq!(end.0, to, "there is a way between two stops");
        let mut way = vec![end.0];
        while end.0 != from {
            end = before[state(end.0, end.1)];
            way.push(end.0);
        }
        way.reverse();
        way
    }

    /// The posts in the window that one move leads to, with the move's number and length in meters.
    fn moves(&self, window: &Window, post: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        let (row, column) = (post / self.ground.width, post % self.ground.width);
        let (rows, columns) =
            (window.top..window.top + window.height, window.left..window.left + window.width);
        MOVES.iter().enumerate().filter_map(move |(heading, &(down, right))| {
            let row = row.checked_add_signed(down).filter(|row| rows.contains(row))?;
            let column = column.checked_add_signed(right).filter(|column| columns.contains(column))?;
            Some((row * self.ground.width + column, heading, self.step(heading).length()))
        })
    }

    /// A move in meters.
    fn step(&self, heading: usize) -> DVec2 {
        let (down, right) = MOVES[heading];
        DVec2::new(right as f64, -(down as f64)) * self.ground.post_m
    }

    /// What a move costs, in millimeters of level way: whole numbers, so that sums do not depend on order.
    fn price(&self, from: usize, to: usize, run: f64, design: Design) -> u64 {
        let part = (self.ground.z[to] - self.ground.z[from]).abs() / run / design.grade;
        let climb = if part <= 1.0 { design.climb_cost * part * part } else { TOO_STEEP * part * part };
        let slope = design.slope_cost * self.steepness[to];
        let bank = match (self.stream[to], self.beside[to]) {
            (true, _) => IN_STREAM,
            (false, true) => BESIDE_STREAM,
            (false, false) => 0.0,
        };
        let bridge = if self.stream[to] && !self.stream[from] { BRIDGE_M } else { 0.0 };
        ((run * (1.0 + climb + slope + bank) + bridge) * 1e3) as u64
    }

    /// What turning from one heading to another costs, in millimeters of way.
    fn turn(&self, from: usize, to: usize) -> u64 {
        let (from, to) = (self.step(from), self.step(to));
        let bend = 1.0 - from.dot(to) / (from.length() * to.length());
        (TURN_M * bend * bend * 1e3) as u64
    }

    /// Rounds the bends and evens the grade.
    fn relax(&self, way: &[DVec2], design: Design) -> Vec<DVec2> {
        let mut road = line::resample(way, SPACING_M);
        for _ in 0..design.rounds {
            road = self.relax_once(&road, design.grading);
            road = line::resample(&road, SPACING_M);
        }
        line::simplify(&road, DETAIL_M)
    }

    fn relax_once(&self, road: &[DVec2], grading: f64) -> Vec<DVec2> {
        /// How far one round may move a vertex along the slope, in meters.
        const STRIDE_M: f64 = 9.0;
        /// Squared slope below which there is no height to be gained by moving.
        const FLAT: f64 = 0.004;
        let target = smooth_profile(road.iter().map(|&at| self.ground.at(at)).collect());
        let mut moved = road.to_vec();
        for at in 1..road.len() - 1 {
            let bend = (road[at - 1] + road[at + 1]) / 2.0 - road[at];
            let rise = self.ground.gradient(road[at], 30.0);
            let lack = target[at] - self.ground.at(road[at]);
            let climb = rise * (lack / (rise.length_squared() + FLAT));
            let next = road[at] + bend * 0.3 + (climb * grading).clamp_length_max(STRIDE_M);
            let (from, to) = (self.ground.post_at(road[at]), self.ground.post_at(next));
            let into_stream = self.stream[to] && !self.stream[from];
            if !self.water[to] && !into_stream {
                moved[at] = next;
            }
        }
        moved
    }
}

/// A profile averaged over about four hundred meters, its ends kept.
fn smooth_profile(mut z: Vec<f64>) -> Vec<f64> {
    for _ in 0..8 {
        let before = z.clone();
        for at in 1..z.len().saturating_sub(1) {
            z[at] = (before[at - 1] + 2.0 * before[at] + before[at + 1]) / 4.0;
        }
    }
    z
}
