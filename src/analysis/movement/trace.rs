//! The way that led to a post, traced back through the triangles from the times of posts.
//!
//! From a point the way goes back to where its time and the time of the piece between are the least, over the sixteen
//! neighbors of a post, the sides of the triangles around it, and the sides of the two cells beside a point of a side. Times
//! fall with every piece. Where all that leads to a point is closed, though both ends of its side were reached, the trace
//! takes the next best. Where nothing is left, it goes along sides that are too steep.
//!
//! Times on a side are those between its ends, and on rough ground the way takes longer. So its points are moved along their
//! sides, and where that is not enough it is searched again over fine points beside the trace. Where it still takes longer
//! than the search said, a way by steps might be quicker, and is looked for.

use std::collections::BTreeSet;

use crate::error::AnalysisError;
use crate::movement::refine::{WayChoice, quickest_way};
use crate::movement::search::{TravelGoal, TravelTimes};
use crate::movement::travel::TravelGround;
use crate::movement::way::WayPoint;
use sandtable_terrain::stop_flag::StopFlag;

/// How many parts the sides of cells are cut into where a way goes on from a point of a side.
const PARTS: usize = 16;

/// How many parts the sides of cells beside a trace are cut into for the search that refines it.
const FINE_PARTS: usize = 4;

/// How often the points of a way are moved along their sides.
const PULLS: usize = 2;

/// A way that takes at most this many times what the search said is not searched again over fine points.
const CLOSE: f64 = 1.002;

/// A way that takes no longer than this many times what the search said is as quick as one by steps, but for rounding.
const ROUNDING: f64 = 1.0 + 1e-6;

impl TravelGround<'_> {
    /// The quickest way from any of the starts to the nearest in time of the ends, which rise; `None` where none is reached.
    ///
    /// # Errors
    /// [`AnalysisError::Stopped`].
    pub fn quickest_way(
        &self,
        starts: &[usize],
        ends: &[usize],
        stop: &StopFlag,
    ) -> Result<Option<Vec<WayPoint>>, AnalysisError> {
        let times = self.search(starts, TravelGoal::any_of(ends), stop);
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        let reached = ends.iter().map(|&end| self.framed(end)).filter(|&end| times.time_s(end).is_finite());
        let nearest = reached.min_by(|&one, &other| times.time_s(one).total_cmp(&times.time_s(other)));
        Ok(nearest.map(|end| self.way_to(&times, end)))
    }

    /// The way to a post that a search reached, by its index with the border.
    pub(super) fn way_to(&self, times: &TravelTimes, end: usize) -> Vec<WayPoint> {
        let trace = |passes| WayTrace { ground: self, times, closed: BTreeSet::new(), passes }.back_from(end);
        let mut way = trace(SidePasses::Passable);
        if way.is_empty() {
            way = trace(SidePasses::All);
        }
        if self.has_triangles {
            self.pull(&mut way, PULLS);
            let seconds = self.seconds_along(&way);
            let mut fine = Vec::new();
            if seconds > f64::from(times.time_s(end)) * CLOSE {
                let choice = WayChoice { parts: FINE_PARTS, posts: Some(self.posts_beside(&way)) };
                fine = quickest_way(self, times, end, seconds, &choice);
            }
            if !fine.is_empty() {
                way = fine;
                self.pull(&mut way, PULLS);
            }
        }
        let seconds = if way.is_empty() { f64::INFINITY } else { self.seconds_along(&way) };
        if seconds > f64::from(times.time_s(end)) * ROUNDING {
            let by_steps = quickest_way(self, times, end, seconds, &WayChoice { parts: 1, posts: None });
            if !by_steps.is_empty() {
                way = by_steps;
            }
        }
        if way.is_empty() {
            // Times so long that the last piece has no effect on them.
            way.push(WayPoint::at(end));
        }
        way
    }

    /// The ends of the sides of a way and the posts around them, which rise.
    fn posts_beside(&self, way: &[WayPoint]) -> Vec<usize> {
        let width = self.width as isize;
        let around = |post: usize| {
            [-width, 0, width].map(|row| [-1, 0, 1].map(|column| post.wrapping_add_signed(row + column)))
        };
        let mut posts: Vec<usize> = way
            .iter()
            .flat_map(|point| point.ends())
            .flat_map(|post| around(post).into_iter().flatten())
            .collect();
        posts.sort_unstable();
        posts.dedup();
        posts
    }
}

/// A trace through the times of a search.
struct WayTrace<'a, 'b> {
    ground: &'a TravelGround<'b>,
    times: &'a TravelTimes,
    /// Points to which no way was found.
    closed: BTreeSet<(usize, usize, u32)>,
    passes: SidePasses,
}

/// The sides along which a trace goes.
#[derive(Clone, Copy, PartialEq)]
enum SidePasses {
    /// Those that the vehicle passes.
    Passable,
    /// All between posts that were reached.
    All,
}

impl WayTrace<'_, '_> {
    #[inline]
    fn time_s(&self, point: WayPoint) -> f32 {
        point.mix(|post| self.times.time_s(post))
    }

    /// The points of the way from a start to a reached post; empty where none was found.
    fn back_from(&mut self, end: usize) -> Vec<WayPoint> {
        let mut points = vec![WayPoint::at(end)];
        while let Some(&at) = points.last() {
            if self.time_s(at) <= 0.0 {
                break;
            }
            match self.before(at) {
                Some(before) => points.push(before),
                None => {
                    self.closed.insert(at.key());
                    points.pop();
                }
            }
        }
        points.reverse();
        points
    }

    /// The point from which a way leads to another in the least time.
    fn before(&self, at: WayPoint) -> Option<WayPoint> {
        let own_s = self.time_s(at);
        let mut best = None;
        let mut least_s = f32::INFINITY;
        let mut visit = |point: WayPoint| {
            let time_s = self.time_s(point);
            if time_s >= own_s || time_s >= least_s {
                return;
            }
            let arrival_s = time_s + self.ground.piece_s(point, at);
            if arrival_s < least_s && !self.closed.contains(&point.key()) {
                (best, least_s) = (Some(point), arrival_s);
            }
        };
        match at.is_post() {
            true => self.around_post(at.nearest(), &mut visit),
            false => self.beside(at, &mut visit),
        }
        if best.is_none() && self.passes == SidePasses::All && !at.is_post() {
            let [one, other] = at.ends();
            let is_first = self.times.time_s(one) <= self.times.time_s(other);
            best = Some(WayPoint::at(if is_first { one } else { other }));
        }
        best
    }

    fn around_post(&self, post: usize, visit: &mut impl FnMut(WayPoint)) {
        let ground = self.ground;
        for step in &ground.steps {
            visit(WayPoint::at(post.wrapping_add_signed(-step.offset)));
        }
        if !ground.has_triangles {
            return;
        }
        let width = ground.width as isize;
        for (axis, straight, side) in [(0, 1, width), (0, -1, width), (1, width, 1), (1, -width, 1)] {
            let a = post.wrapping_add_signed(straight);
            for b in [side, -side].map(|side| a.wrapping_add_signed(side)) {
                if !(self.times.time_s(a) + self.times.time_s(b)).is_finite() {
                    continue;
                }
                let Some(triangle) = ground.triangle([a, b, post], [0.0; 2]) else { continue };
                for share in ground.triangles.shares(&triangle, axis, &ground.grades) {
                    visit(WayPoint::between(a, b, share));
                }
            }
        }
    }

    fn beside(&self, at: WayPoint, visit: &mut impl FnMut(WayPoint)) {
        let ends = at.ends();
        ends.into_iter().for_each(|end| visit(WayPoint::at(end)));
        let beside = if ends[1] - ends[0] == 1 { self.ground.width as isize } else { 1 };
        for offset in [beside, -beside] {
            let others = ends.map(|end| end.wrapping_add_signed(offset));
            others.into_iter().for_each(|end| visit(WayPoint::at(end)));
            for [one, other] in [[ends[0], others[0]], [ends[1], others[1]], others] {
                if (self.times.time_s(one) + self.times.time_s(other)).is_finite() {
                    for part in 1..PARTS {
                        visit(WayPoint::between(one, other, part as f32 / PARTS as f32));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "way_tests.rs"]
mod way_tests;
