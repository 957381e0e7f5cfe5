//! The points of a way over the ground, on posts and on the sides between them, and the time from one to the next.
//!
//! ```text
//!   c----y---d     Between points of one cell a way is straight. Heights, paces and times on a side lie on the line between
//!   |   /    |     those of its ends. A piece from post to post is a step, one along a side a share of the step along it. All
//!   |  /     |     others cross the plane of the posts whose sides they touch: of a triangle as the times across triangles
//!   a-x------b     have it, or, from a side to the one opposite, the mean plane of the four.
//! ```

use crate::movement::travel::TravelGround;
use glam::{DVec2, Vec2};

/// A point of a way: a post, or a point of a side between two. Indices are those with the border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WayPoint {
    /// The post, or the western or southern end of the side.
    post: usize,
    /// From there to the other end of the side; 0 at a post.
    offset: usize,
    /// The share of the side up to the point, above 0 and below 1; 0 at a post.
    share: f32,
}

impl WayPoint {
    /// A post.
    pub fn at(post: usize) -> Self {
        Self { post, offset: 0, share: 0.0 }
    }

    /// The point at a share, above 0 and below 1, of the side from one post to a straight neighbor.
    pub fn between(one: usize, other: usize, share: f32) -> Self {
        match one < other {
            true => Self { post: one, offset: other - one, share },
            false => Self { post: other, offset: one - other, share: 1.0 - share },
        }
    }

    /// Whether it is a post.
    pub fn is_post(self) -> bool {
        self.offset == 0
    }

    /// The ends of its side; a post twice.
    pub fn ends(self) -> [usize; 2] {
        [self.post, self.post + self.offset]
    }

    /// The nearest post.
    pub fn nearest(self) -> usize {
        if self.share < 0.5 { self.post } else { self.post + self.offset }
    }

    /// What lies between the values of the ends.
    #[inline]
    pub fn mix(self, value: impl Fn(usize) -> f32) -> f32 {
        match self.is_post() {
            true => value(self.post),
            false => (1.0 - self.share) * value(self.post) + self.share * value(self.post + self.offset),
        }
    }

    /// The share of its side from the western or southern end; 0 at a post.
    pub fn share(self) -> f32 {
        self.share
    }

    /// By which it is told from other points.
    pub fn key(self) -> (usize, usize, u32) {
        (self.post, self.offset, self.share.to_bits())
    }
}

impl TravelGround<'_> {
    /// A post of the lattice as a point of a way.
    pub fn point_at(&self, post: usize) -> WayPoint {
        WayPoint::at(self.framed(post))
    }

    /// The position of a point of a way in map coordinates.
    pub fn position(&self, point: WayPoint) -> DVec2 {
        let [one, other] = point.ends().map(|post| {
            let post = self.lattice().post_at(self.inner(post));
            self.lattice().map_position(post)
        });
        one.lerp(other, f64::from(point.share))
    }

    /// The post of the lattice nearest to a point of a way.
    pub fn nearest_post(&self, point: WayPoint) -> usize {
        self.inner(point.nearest())
    }

    /// The height of a point of a way as the vehicle travels it, meters.
    pub fn height_at_m(&self, point: WayPoint) -> f32 {
        point.mix(|post| self.height(post))
    }

    /// Seconds from a point to another of the same cell, or from a post to one of its sixteen neighbors; infinite where the
    /// vehicle does not go.
    pub(super) fn piece_s(&self, from: WayPoint, to: WayPoint) -> f32 {
        if from.is_post() && to.is_post() {
            let is_between = |offset: isize| from.post.wrapping_add_signed(offset) == to.post;
            let step = self.steps.iter().find(|step| is_between(step.offset));
            return step.map_or(f32::INFINITY, |step| self.seconds(from.post, step));
        }
        // Columns and rows from the post of `from`, without a division.
        let width = self.width as isize;
        let apart = to.post as isize - from.post as isize;
        let rows = isize::from(2 * apart > width) - isize::from(2 * apart < -width);
        let columns = apart - rows * width;
        let [west, south] = [columns.min(0), rows.min(0)];
        let along_side = |point: WayPoint| match point.offset {
            0 => Vec2::ZERO,
            1 => Vec2::new(point.share, 0.0),
            _ => Vec2::new(0.0, point.share),
        };
        // The posts that are touched, from the south-west: by row, then by column.
        let mut touched = [[false; 2]; 2];
        for (point, column, row) in [(from, -west, -south), (to, columns - west, rows - south)] {
            let (column, row) = (column as usize & 1, row as usize & 1);
            touched[row][column] = true;
            match point.offset {
                0 => {}
                1 => touched[row][(column + 1) & 1] = true,
                _ => touched[(row + 1) & 1][column] = true,
            }
        }
        if touched.iter().flatten().filter(|&&is| is).count() == 2 {
            return self.side_s(from, to);
        }
        let first = from.post.wrapping_add_signed(south * width + west);
        let posts = [[first, first + 1], [first + self.width, first + self.width + 1]];
        let of_touched = || {
            let pairs = posts.iter().flatten().zip(touched.iter().flatten());
            pairs.filter(|&(_, &is)| is).map(|(&post, _)| post)
        };
        let pace = (from.mix(|post| self.pace(post)) + to.mix(|post| self.pace(post))) * 0.5;
        if !of_touched().all(|post| self.pace(post).is_finite()) {
            return f32::INFINITY;
        }
        let cell = self.lattice().cell().as_vec2();
        let apart = Vec2::new(columns as f32, rows as f32);
        let along = (apart + along_side(to) - along_side(from)) * cell;
        let length_m = along.length();
        let grade = (self.height_at_m(to) - self.height_at_m(from)) / length_m;
        if of_touched().all(|post| self.is_way(post)) {
            return pace * length_m * self.grades.on_way(grade);
        }
        let mut factor = self.grades.open(grade);
        if self.grades.has_across() {
            // The mean slope between pairs of touched posts.
            let slope = |pairs: [[[usize; 2]; 2]; 2], length_m: f32| {
                let is_touched = |[row, column]: [usize; 2]| touched[row][column];
                let known = pairs.iter().filter(|pair| pair.iter().all(|&at| is_touched(at)));
                let height = |[row, column]: [usize; 2]| self.height(posts[row][column]);
                let rises = known.map(|pair| height(pair[1]) - height(pair[0]));
                let (sum, count) = rises.fold((0.0, 0.0), |(sum, count), rise| (sum + rise, count + 1.0));
                sum / (count * length_m)
            };
            let east = slope([[[0, 0], [0, 1]], [[1, 0], [1, 1]]], cell.x);
            let north = slope([[[0, 0], [1, 0]], [[0, 1], [1, 1]]], cell.y);
            factor *= self.grades.across(((east * along.y - north * along.x) / length_m).abs());
        }
        pace * length_m * factor
    }

    /// Seconds along a way. A piece along a side that is too steep takes the longest that one may.
    pub fn seconds_along(&self, way: &[WayPoint]) -> f64 {
        let seconds = |ends: &[WayPoint]| {
            let piece_s = self.piece_s(ends[0], ends[1]);
            if piece_s.is_finite() { f64::from(piece_s) } else { self.slowest_s(ends[0], ends[1]) }
        };
        way.windows(2).map(seconds).sum()
    }

    fn slowest_s(&self, from: WayPoint, to: WayPoint) -> f64 {
        let paces = [from, to].map(|point| point.mix(|post| self.pace(post)));
        let pace = f64::from((paces[0] + paces[1]) * 0.5 * self.grades.greatest());
        self.position(from).distance(self.position(to)) * pace
    }

    /// Moves each point of a side along it, in so many rounds, to where the pieces on either side take less, by ever smaller
    /// shares.
    pub(super) fn pull(&self, points: &mut [WayPoint], rounds: usize) {
        let inner = 1..points.len().saturating_sub(1);
        for at in (0..rounds).flat_map(|_| inner.clone()) {
            let [before, mut point, after] = [points[at - 1], points[at], points[at + 1]];
            if point.is_post() {
                continue;
            }
            let seconds = |point: WayPoint| self.piece_s(before, point) + self.piece_s(point, after);
            let mut least_s = seconds(point);
            let mut reach = 0.25;
            while reach > 0.01 {
                for share in [point.share - reach, point.share + reach] {
                    let moved = WayPoint { share, ..point };
                    if share > 0.001 && share < 0.999 {
                        let moved_s = seconds(moved);
                        if moved_s < least_s {
                            (point, least_s) = (moved, moved_s);
                        }
                    }
                }
                reach *= 0.5;
            }
            points[at] = point;
        }
    }

    /// Seconds between two points of one side: a share of the step along it.
    fn side_s(&self, from: WayPoint, to: WayPoint) -> f32 {
        let side = if from.is_post() { to } else { from };
        let share = |point: WayPoint| match point.is_post() {
            true => f32::from(u8::from(point.post != side.post)),
            false => point.share,
        };
        let along = share(to) - share(from);
        let [start, offset] = match along >= 0.0 {
            true => [side.post as isize, side.offset as isize],
            false => [(side.post + side.offset) as isize, -(side.offset as isize)],
        };
        let step = self.steps.iter().find(|step| step.offset == offset);
        step.map_or(f32::INFINITY, |step| along.abs() * self.seconds(start as usize, step))
    }
}
