//! Brushes: shapes that change heights while the terrain is in use (craters, trenches, tire tracks, embankments).
//!
//! A brush gives every post a new height from its old one. It returns the changed rectangles of posts with their former
//! heights, so that data derived from heights can be updated instead of rebuilt. A brush neither fills nor makes holes:
//! posts without data keep none, and a height that is not finite is not written.
//!
//! A long stroke changes few of the posts of its bounding rectangle; it is cut into tiles, and a tile's rectangle is that
//! of the posts that changed.

use glam::{DVec2, DVec3};

use crate::held_posts::HeldPosts;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{HIGHEST_M, Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::volumes::Volumes;

/// Posts along a tile's side. Smaller tiles follow a stroke more closely; each costs a walk up the vertex graph.
const TILE: u32 = 64;

/// One rectangle in which heights changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The smallest rectangle around the posts that changed.
    pub posts: PostRect,
    /// The former heights, row by row of the rectangle; NaN where there is no data, before and after.
    pub before: Vec<f32>,
}

impl Change {
    /// The former height of a post of the rectangle.
    #[inline]
    pub fn height_before(&self, post: Post) -> f32 {
        self.before[self.posts.index(post)]
    }

    /// The former and the current heights of one row of the rectangle from column `first` to column `last`.
    pub fn row<'a>(&'a self, lattice: &'a Lattice, row: u32, (first, last): (u32, u32)) -> [&'a [f32]; 2] {
        let (count, post) = ((last - first + 1) as usize, Post { column: first, row });
        [&self.before[self.posts.index(post)..][..count], &lattice.heights()[lattice.index(post)..][..count]]
    }

    /// The posts that changed, with their former heights.
    pub fn changed<'a>(&'a self, lattice: &'a Lattice) -> impl Iterator<Item = (Post, f32)> {
        let posts = self.posts.posts().zip(self.before.iter().copied());
        posts.filter(|&(post, before)| lattice.height(post).to_bits() != before.to_bits())
    }

    /// The part within `bounds`, a rectangle of its posts.
    fn within(self, bounds: PostRect) -> Self {
        if bounds == self.posts {
            return self;
        }
        let before = bounds.posts().map(|post| self.height_before(post)).collect();
        Self { posts: bounds, before }
    }
}

/// The changes that a brush made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BrushChanges {
    /// The rectangles that changed; those of one brush do not overlap.
    pub pieces: Vec<Change>,
    /// The earth moved.
    pub volumes: Volumes,
}

impl BrushChanges {
    /// These changes, followed by others.
    pub fn and(mut self, then: Self) -> Self {
        self.pieces.extend(then.pieces);
        self.volumes += then.volumes;
        self
    }

    /// These changes without the posts in `held`, which get their former heights back. For the changes of one brush,
    /// right after it made them.
    pub fn without_held(self, lattice: &mut Lattice, held: &HeldPosts) -> Self {
        let mut kept = Self::default();
        for piece in self.pieces {
            let moved: Vec<(Post, f32)> = piece.changed(lattice).collect();
            let mut bounds: Option<PostRect> = None;
            for (post, before) in moved {
                let rise_m = f64::from(lattice.height(post)) - f64::from(before);
                if held.holds(lattice, post) {
                    lattice.heights_mut(post, post.column)[0] = before;
                } else {
                    kept.volumes += Volumes::from_rise(rise_m, lattice.cell_m2());
                    let alone = PostRect { first: post, last: post };
                    bounds = Some(bounds.map_or(alone, |bounds| bounds.with(post)));
                }
            }
            kept.pieces.extend(bounds.map(|bounds| piece.within(bounds)));
        }
        kept
    }

    /// The area of the posts that changed, in square meters: a cell for each.
    pub fn area_m2(&self, lattice: &Lattice) -> f64 {
        let posts: usize = self.pieces.iter().map(|piece| piece.changed(lattice).count()).sum();
        posts as f64 * lattice.cell_m2()
    }

    /// Gives every post of `posts` that has data its new height, in meters, from its old one.
    pub(super) fn write(&mut self, lattice: &mut Lattice, posts: PostRect, new: impl Fn(Post, f32) -> f32) {
        let PostRect { first, last } = posts;
        let area_m2 = lattice.cell_m2();
        let mut bounds: Option<PostRect> = None;
        let mut before = Vec::with_capacity(posts.width() * (last.row - first.row + 1) as usize);
        for row in first.row..=last.row {
            let heights = lattice.heights_mut(Post { column: first.column, row }, last.column);
            before.extend_from_slice(heights);
            let mut changed: Option<(u32, u32)> = None;
            for (column, height) in (first.column..).zip(heights) {
                let after = new(Post { column, row }, *height);
                if !height.is_nan() && after.abs() <= HIGHEST_M && after != *height {
                    self.volumes += Volumes::from_rise(f64::from(after) - f64::from(*height), area_m2);
                    changed = Some((changed.map_or(column, |(west, _)| west), column));
                    *height = after;
                }
            }
            if let Some((west, east)) = changed {
                let [west, east] = [west, east].map(|column| Post { column, row });
                let of_row = PostRect { first: west, last: east };
                bounds = Some(bounds.map_or(of_row, |bounds| bounds.with(west).with(east)));
            }
        }
        if let Some(bounds) = bounds {
            self.pieces.push(Change { posts, before }.within(bounds));
        }
    }
}

/// Sets the heights of a rectangle of posts, row by row from the south-west, in meters.
///
/// Posts beyond the lattice are left out, as are values that are missing, not finite or beyond ±[`HIGHEST_M`].
pub fn set_heights(lattice: &mut Lattice, posts: PostRect, heights: &[f32]) -> BrushChanges {
    let mut changes = BrushChanges::default();
    if let Some(inside) = posts.clipped(lattice) {
        let new = |post: Post, _: f32| heights.get(posts.index(post)).copied().unwrap_or(f32::NAN);
        changes.write(lattice, inside, new);
    }
    changes
}

/// A rectangle cut into tiles.
fn tiles(posts: PostRect) -> impl Iterator<Item = PostRect> {
    let steps = |from: u32, to: u32| {
        (from..=to).step_by(TILE as usize).map(move |first| (first, (first + (TILE - 1)).min(to)))
    };
    steps(posts.first.row, posts.last.row).flat_map(move |(south, north)| {
        steps(posts.first.column, posts.last.column).map(move |(west, east)| PostRect {
            first: Post { column: west, row: south },
            last: Post { column: east, row: north },
        })
    })
}

/// A crater with a raised rim.
///
/// With ρ the distance from the center over the radius, the ground rises by
///
/// ```text
/// −depth + (depth + rim)·ρ²   within the crest, ρ ≤ 1
/// rim·(2 − ρ)²                of the ejecta, 1 ≤ ρ ≤ 2
/// ```
///
/// so that it cuts π·radius²·depth²/(2·(depth + rim)) below the old ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crater {
    /// World X and Y, meters.
    pub center: DVec2,
    /// From the center to the crest of the rim, meters, above 0.
    pub radius_m: f64,
    /// From the old ground down to the bottom, meters.
    pub depth_m: f64,
    /// From the old ground up to the crest, meters; 0 for none.
    pub rim_m: f64,
}

impl Crater {
    /// The rise of the ground at a distance from the center, meters; negative where it sinks.
    pub fn rise_m(&self, distance_m: f64) -> f64 {
        let part = distance_m / self.radius_m;
        if part <= 1.0 {
            (self.depth_m + self.rim_m) * part * part - self.depth_m
        } else {
            let left = (2.0 - part).max(0.0);
            self.rim_m * left * left
        }
    }

    /// Changes the lattice.
    pub fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        let bounds = Rect { min: self.center, max: self.center }.grown(2.0 * self.radius_m);
        paint(lattice, bounds, |_| Some(()), |(), at, height| height + self.rise_m(at.distance(self.center)))
    }
}

/// A trench along a line: flat at the bottom, straight sides, rounded ends.
///
/// At the distance d from the line the ground sinks by `depth · clamp((top/2 − d) / (top/2 − bottom/2), 0, 1)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Trench {
    /// World X and Y of its centerline, meters.
    pub line: Vec<DVec2>,
    /// Width at the bottom, meters.
    pub bottom_m: f64,
    /// Width at the old ground, meters, more than at the bottom.
    pub top_m: f64,
    /// Meters below the old ground.
    pub depth_m: f64,
}

impl Trench {
    /// Changes the lattice.
    pub fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        sink_along(lattice, &self.line, self.top_m / 2.0, |near| {
            let side = (self.top_m / 2.0 - near.distance()) / ((self.top_m - self.bottom_m) / 2.0);
            self.depth_m * side.clamp(0.0, 1.0)
        })
    }
}

/// The two ruts that a vehicle leaves.
///
/// Each runs at half the gauge from the line; at the distance u from its middle the ground sinks by
/// `depth · max(0, 1 − (2u / rut)²)`. Beyond the line's ends, at the distance o, it sinks by `max(0, 1 − 2o / rut)` of that.
#[derive(Clone, Debug, PartialEq)]
pub struct TireTrack {
    /// World X and Y of the vehicle's middle, meters.
    pub line: Vec<DVec2>,
    /// From the middle of one rut to that of the other, meters.
    pub gauge_m: f64,
    /// Width of a rut, meters, above 0.
    pub rut_m: f64,
    /// Meters below the old ground.
    pub depth_m: f64,
}

impl TireTrack {
    /// Changes the lattice.
    pub fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        sink_along(lattice, &self.line, (self.gauge_m + self.rut_m) / 2.0, |near| {
            let across = 2.0 * (near.aside_m - self.gauge_m / 2.0) / self.rut_m;
            let rest = 1.0 - 2.0 * near.beyond_m / self.rut_m;
            self.depth_m * (1.0 - across * across).max(0.0) * rest.max(0.0)
        })
    }
}

/// An embankment: a crown at the heights of its line, with side slopes down to the ground. It only fills.
///
/// At the distance d from the line's nearest point, whose height is c, the ground is at least
/// `c − max(0, d − crown/2) / run`; where several legs of the line are near, the highest counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Embankment {
    /// World X and Y of its centerline and the crown's height there, meters; heights are linear in between.
    pub line: Vec<DVec3>,
    /// Width of the crown, meters.
    pub crown_m: f64,
    /// Meters outward for each meter down, above 0; 1.5 is common.
    pub run: f64,
    /// The side slopes end this many meters from the line, whether they reach the ground or not.
    pub reach_m: f64,
}

impl Embankment {
    /// Changes the lattice.
    pub fn apply(&self, lattice: &mut Lattice) -> BrushChanges {
        let crown =
            |near: LegOffset| near.height_m - (near.distance() - self.crown_m / 2.0).max(0.0) / self.run;
        let is_within = |near: &LegOffset| near.distance() <= self.reach_m;
        paint_along(lattice, &self.line, self.reach_m, |legs, at, height| {
            legs.iter().map(|leg| leg.offset(at)).filter(is_within).map(crown).fold(height, f64::max)
        })
    }
}

/// A straight leg of a stroke's line.
#[derive(Clone, Copy, Debug)]
struct StrokeLeg {
    from: DVec3,
    to: DVec3,
    /// Whether the line starts here.
    starts: bool,
    /// Whether the line ends here.
    ends: bool,
}

/// The position of a point relative to a leg.
#[derive(Clone, Copy, Debug)]
struct LegOffset {
    /// Meters from the leg's straight line; from its end where that is a bend and the point lies beyond it.
    aside_m: f64,
    /// Meters beyond the whole line's end; 0 elsewhere.
    beyond_m: f64,
    /// Height of the leg's nearest point.
    height_m: f64,
}

impl StrokeLeg {
    fn offset(&self, at: DVec2) -> LegOffset {
        let (leg, off) = (self.to.truncate() - self.from.truncate(), at - self.from.truncate());
        let length = leg.length();
        let (along, aside_m) = if length > 0.0 {
            (off.dot(leg) / length, off.perp_dot(leg).abs() / length)
        } else {
            (0.0, off.length())
        };
        let nearest = along.clamp(0.0, length);
        let part = if length > 0.0 { nearest / length } else { 0.0 };
        let height_m = self.from.z + (self.to.z - self.from.z) * part;
        let beyond_m = (along - nearest).abs();
        if (along < 0.0 && !self.starts) || (along > length && !self.ends) {
            return LegOffset { aside_m: DVec2::new(aside_m, beyond_m).length(), beyond_m: 0.0, height_m };
        }
        LegOffset { aside_m, beyond_m, height_m }
    }

    fn bounds(&self) -> Rect {
        Rect::around([self.from.truncate(), self.to.truncate()])
    }
}

impl LegOffset {
    fn distance(&self) -> f64 {
        DVec2::new(self.aside_m, self.beyond_m).length()
    }
}

/// Lowers the posts within `reach_m` of a line, each by `sink` of its position relative to the nearest leg.
fn sink_along(
    lattice: &mut Lattice,
    line: &[DVec2],
    reach_m: f64,
    sink: impl Fn(LegOffset) -> f64,
) -> BrushChanges {
    let line: Vec<DVec3> = line.iter().map(|at| at.extend(0.0)).collect();
    paint_along(lattice, &line, reach_m, |legs, at, height| {
        let offsets = legs.iter().map(|leg| leg.offset(at));
        let nearest = offsets.min_by(|a, b| a.distance().total_cmp(&b.distance()));
        nearest.map_or(height, |near| height - sink(near))
    })
}

/// Gives the posts within `reach_m` of a line new heights, from the line's legs near each tile.
fn paint_along(
    lattice: &mut Lattice,
    line: &[DVec3],
    reach_m: f64,
    height: impl Fn(&[StrokeLeg], DVec2, f64) -> f64,
) -> BrushChanges {
    let last = line.len().saturating_sub(2);
    let leg = |(index, ends): (usize, &[DVec3])| StrokeLeg {
        from: ends[0],
        to: ends[1],
        starts: index == 0,
        ends: index == last,
    };
    let legs: Vec<StrokeLeg> = line.windows(2).enumerate().map(leg).collect();
    let bounds = Rect::around(line.iter().map(|at| at.truncate())).grown(reach_m);
    let near = |tile: &Rect| {
        let near = legs.iter().filter(|leg| leg.bounds().grown(reach_m).meets(tile)).copied();
        Some(near.collect::<Vec<StrokeLeg>>()).filter(|near| !near.is_empty())
    };
    paint(lattice, bounds, near, |legs, at, before| height(legs, at, before))
}

/// Gives the posts within `bounds` new heights, tile by tile: `near` prepares a tile, `None` for one without effect.
fn paint<Near>(
    lattice: &mut Lattice,
    bounds: Rect,
    near: impl Fn(&Rect) -> Option<Near>,
    height: impl Fn(&Near, DVec2, f64) -> f64,
) -> BrushChanges {
    let mut changes = BrushChanges::default();
    let (first, cell) = (lattice.first().grid(), lattice.cell());
    let world = |post: Post| (first + post.grid()) * cell;
    for tile in PostRect::within(lattice, &bounds).into_iter().flat_map(tiles) {
        if let Some(near) = near(&Rect { min: world(tile.first), max: world(tile.last) }) {
            let new = |post: Post, before: f32| height(&near, world(post), f64::from(before)) as f32;
            changes.write(lattice, tile, new);
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SIDE: u32 = 161;
    const CELL_M: f64 = 0.5;

    fn level() -> Lattice {
        let heights = vec![100.0; (SIDE * SIDE) as usize];
        Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), SIDE, heights).expect("sound")
    }

    fn middle() -> DVec2 {
        DVec2::splat(f64::from(SIDE / 2) * CELL_M)
    }

    fn near(found: f64, expected: f64, part: f64) {
        assert!((found / expected - 1.0).abs() < part, "{found} against {expected}");
    }

    #[test]
    fn a_crater_moves_the_earth_of_its_formula_and_is_symmetric() {
        let (mut lattice, crater) =
            (level(), Crater { center: middle(), radius_m: 12.0, depth_m: 4.0, rim_m: 1.0 });
        let changes = crater.apply(&mut lattice);
        near(changes.volumes.cut_m3, PI * 144.0 * 16.0 / (2.0 * 5.0), 2e-3);
        let net = PI * 144.0 * (1.0 - 4.0) / 2.0 + 5.0 / 6.0 * PI * 144.0;
        near(changes.volumes.fill_m3 - changes.volumes.cut_m3, net, 2e-2);
        let at = |column: u32, row: u32| lattice.height(Post { column, row });
        for (column, row) in (0..SIDE).flat_map(|column| (0..SIDE).map(move |row| (column, row))) {
            let turned = [(row, column), (SIDE - 1 - column, row), (column, SIDE - 1 - row)];
            assert!(turned.iter().all(|&(x, y)| at(x, y) == at(column, row)), "{column}, {row}");
        }
        assert_eq!((at(80, 80), at(104, 80), at(130, 80)), (96.0, 101.0, 100.0));
    }

    #[test]
    fn profiles_have_no_jumps() {
        let crater = Crater { center: middle(), radius_m: 12.0, depth_m: 4.0, rim_m: 1.5 };
        let rises = (0..3000).map(|step| crater.rise_m(f64::from(step) * 0.01)).collect::<Vec<f64>>();
        assert!(rises.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 0.02));
        let bent = vec![DVec2::new(20.0, 20.0), DVec2::new(55.0, 30.0), DVec2::new(40.0, 62.0)];
        let (mut trench, mut track, mut bank) = (level(), level(), level());
        Trench { line: bent.clone(), bottom_m: 4.0, top_m: 12.0, depth_m: 2.0 }.apply(&mut trench);
        TireTrack { line: bent.clone(), gauge_m: 14.0, rut_m: 8.0, depth_m: 2.0 }.apply(&mut track);
        let line = bent.iter().map(|at| at.extend(103.0)).collect();
        Embankment { line, crown_m: 6.0, run: 2.0, reach_m: 12.0 }.apply(&mut bank);
        for (lattice, steepest) in [(trench, 0.5), (track, 1.0), (bank, 0.5)] {
            for post in lattice.posts().filter(|post| post.column + 1 < SIDE && post.row + 1 < SIDE) {
                let [here, east, north, _] = lattice.corner_heights(post);
                let step = (here - east).abs().max((here - north).abs());
                assert!(f64::from(step) <= steepest * CELL_M + 1e-3, "a step of {step} m at {post:?}");
            }
        }
    }

    #[test]
    fn strokes_move_the_earth_of_their_profiles() {
        let line = vec![DVec2::new(20.0, 40.0), DVec2::new(35.0, 40.0), DVec2::new(60.0, 40.0)];
        let mut lattice = level();
        let trench = Trench { line: line.clone(), bottom_m: 2.0, top_m: 6.0, depth_m: 3.0 };
        let moved = trench.apply(&mut lattice).volumes;
        let cone = PI * 3.0 / 3.0 * (9.0 + 3.0 + 1.0);
        assert_eq!(moved.fill_m3, 0.0);
        near(moved.cut_m3, 40.0 * 3.0 * 4.0 + cone, 2e-2);

        let mut lattice = level();
        let track = TireTrack { line: line.clone(), gauge_m: 12.0, rut_m: 5.0, depth_m: 0.6 };
        let moved = track.apply(&mut lattice).volumes;
        near(moved.cut_m3, 2.0 * (2.0 / 3.0 * 5.0 * 0.6) * (40.0 + 2.5), 2e-2);
        assert_eq!(moved.fill_m3, 0.0);

        let mut lattice = level();
        let line = line.iter().map(|at| at.extend(102.0)).collect();
        let moved = Embankment { line, crown_m: 4.0, run: 1.5, reach_m: 6.0 }.apply(&mut lattice).volumes;
        let cone = PI * 2.0 / 3.0 * (25.0 + 10.0 + 4.0);
        near(moved.fill_m3, 40.0 * (4.0 + 3.0) * 2.0 + cone, 2e-2);
        assert_eq!(moved.cut_m3, 0.0);
    }

    #[test]
    fn holes_stay_holes_and_the_pieces_hold_the_former_heights() {
        let heights =
            (0..SIDE * SIDE).map(|index| if index % 7 == 0 { f32::NAN } else { index as f32 }).collect();
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::splat(CELL_M), SIDE, heights).expect("sound");
        let before = lattice.clone();
        let line = vec![DVec2::new(-20.0, -3.0), DVec2::new(95.0, 90.0)];
        let changes = Trench { line, bottom_m: 2.0, top_m: 5.0, depth_m: 9.0 }.apply(&mut lattice);
        assert!(changes.pieces.len() > 2, "a long stroke comes in pieces");
        let mut reported = vec![false; before.heights().len()];
        for piece in &changes.pieces {
            for (post, height) in piece.posts.posts().zip(&piece.before) {
                assert_eq!(before.height(post).to_bits(), height.to_bits());
            }
            piece.changed(&lattice).for_each(|(post, _)| reported[lattice.index(post)] = true);
        }
        for (post, reported) in lattice.posts().zip(reported) {
            let (old, new) = (before.height(post), lattice.height(post));
            assert_eq!(old.is_nan(), new.is_nan());
            assert_eq!(reported, !old.is_nan() && old != new, "{post:?}");
        }
    }

    #[test]
    fn a_rectangle_of_heights_is_set_where_it_lies_on_the_lattice() {
        let mut lattice = level();
        let posts = PostRect { first: Post { column: 159, row: 160 }, last: Post { column: 162, row: 162 } };
        let changes = set_heights(&mut lattice, posts, &[1.0, f32::NAN, 3.0]);
        assert_eq!(lattice.height(Post { column: 159, row: 160 }), 1.0);
        assert_eq!(lattice.height(Post { column: 160, row: 160 }), 100.0);
        assert_eq!(changes.pieces.len(), 1);
        assert_eq!(changes.volumes, Volumes { cut_m3: 99.0 * CELL_M * CELL_M, fill_m3: 0.0 });
    }
}
