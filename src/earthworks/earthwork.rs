//! An earthwork: one of the brushes, or ground that is leveled or raised, applied to all posts but those under water.
//!
//! A scene's earthworks and those that a user makes while the scene is shown are applied by the same function, so that
//! both leave the same heights.

use glam::DVec2;

use crate::brush::{BrushChanges, Crater, Embankment, TireTrack, Trench};
use crate::held_posts::HeldPosts;
use crate::level_ground::LevelGround;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::volumes::Volumes;

/// How far the batter of raised ground reaches, as a multiple of its reach on level ground: down a slope half as steep as
/// the batter it reaches twice as far. Steeper slopes end it in a step.
const DOWNHILL: f64 = 3.0;

/// The least width of an earthwork in cells: a narrower one falls between the posts, or is a row of pits.
const LEAST_CELLS: f64 = 2.0;

/// Posts along the side of a tile; what a leg of a line costs at least.
const TILE: f64 = 64.0;

/// Ground dug, leveled or filled. Positions are world X and Y in meters, heights elevations in meters.
#[derive(Clone, Debug, PartialEq)]
pub enum Earthwork {
    /// A bowl with a raised rim.
    Crater(Crater),
    /// A ditch along a line.
    Trench(Trench),
    /// Two ruts along a line.
    Track(TireTrack),
    /// Level ground within an outline.
    Level(LevelGround),
    /// A bank along a line, or a mound at a point.
    Raise(RaisedGround),
}

/// A bank along a line with side slopes down to the ground; a mound where the line is a single point. It only fills.
#[derive(Clone, Debug, PartialEq)]
pub struct RaisedGround {
    /// The centerline, one or more points.
    pub line: Vec<DVec2>,
    /// How high its crown lies.
    pub crown: CrownHeight,
    /// Width of the crown, meters.
    pub width_m: f64,
    /// Meters outward for each meter down, above 0.
    pub run: f64,
}

/// The height of the crown of raised ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CrownHeight {
    /// So many meters above the ground under each point of the line, straight in between.
    AboveGround(f64),
    /// At this elevation.
    Elevation(f64),
}

impl Earthwork {
    /// Changes the lattice except for the posts in `held`; pins no post.
    pub fn apply(&self, lattice: &mut Lattice, held: &HeldPosts) -> BrushChanges {
        let changes = match self {
            Self::Crater(crater) => crater.apply(lattice),
            Self::Trench(trench) => trench.apply(lattice),
            Self::Track(track) => track.apply(lattice),
            Self::Level(ground) => ground.apply(lattice),
            Self::Raise(ground) => {
                ground.embankment(lattice).map_or_else(BrushChanges::default, |bank| bank.apply(lattice))
            }
        };
        if held.is_empty() { changes } else { changes.without_held(lattice, held) }
    }

    /// Whether posts `cell_m` apart show its shape.
    pub fn is_resolved(&self, cell_m: f64) -> bool {
        let narrowest_m = match self {
            Self::Crater(crater) => 2.0 * crater.radius_m,
            Self::Trench(trench) => trench.top_m,
            Self::Track(track) => track.rut_m,
            Self::Level(_) | Self::Raise(_) => return true,
        };
        narrowest_m >= LEAST_CELLS * cell_m
    }

    /// The rectangle within which heights may change; `None` off the lattice or where there is no data.
    pub fn bounds(&self, lattice: &Lattice) -> Option<Rect> {
        let bounds = match self {
            Self::Crater(crater) => Rect::around([crater.center]).grown(2.0 * crater.radius_m),
            Self::Trench(trench) => Rect::around(trench.line.iter().copied()).grown(trench.top_m / 2.0),
            Self::Track(track) => {
                Rect::around(track.line.iter().copied()).grown((track.gauge_m + track.rut_m) / 2.0)
            }
            Self::Level(ground) => {
                let PostRect { first, last } = ground.window(lattice)?;
                let world = |post: Post| (lattice.first().grid() + post.grid()) * lattice.cell();
                Rect { min: world(first), max: world(last) }
            }
            Self::Raise(ground) => {
                let bank = ground.embankment(lattice)?;
                Rect::around(ground.line.iter().copied()).grown(bank.reach_m)
            }
        };
        bounds.meets(&lattice.extent()).then_some(bounds)
    }

    /// About how many steps of some nanoseconds it takes to apply; never less than the work, however hostile its sizes.
    pub fn cost(&self, lattice: &Lattice) -> f64 {
        let posts = |rect: Rect, beside: f64| {
            let on = rect.intersection(&lattice.extent());
            let cells = if on.is_empty() { DVec2::ZERO } else { on.size() / lattice.cell() };
            (cells.x + beside) * (cells.y + beside)
        };
        let Some(bounds) = self.bounds(lattice) else { return 1.0 };
        let along = |line: &[DVec2], reach_m: f64| {
            let legs = line.windows(2).map(|leg| Rect::around(leg.iter().copied()).grown(reach_m));
            let near = legs.filter(|leg| leg.meets(&lattice.extent()));
            let tiles = posts(bounds, TILE) / (TILE * TILE);
            near.map(|leg| posts(leg, 2.0 * TILE)).sum::<f64>() + tiles * line.len() as f64
        };
        match self {
            Self::Crater(_) => posts(bounds, 1.0),
            Self::Trench(trench) => along(&trench.line, trench.top_m / 2.0),
            Self::Track(track) => along(&track.line, (track.gauge_m + track.rut_m) / 2.0),
            Self::Level(ground) => {
                let edges: usize = ground.rings.iter().map(Vec::len).sum();
                posts(bounds, 1.0) * (4.0 + edges as f64) / 4.0
            }
            Self::Raise(ground) => {
                let reach_m = ground.embankment(lattice).map_or(0.0, |bank| bank.reach_m);
                along(&ground.line, reach_m).max(posts(bounds, 2.0 * TILE))
            }
        }
    }
}

/// The earth that works move, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovedEarth {
    /// Cut and filled by each work after the other.
    pub volumes: Volumes,
    /// Area of the posts that each work changes, square meters: a cell for each.
    pub area_m2: f64,
}

/// Applies earthworks one after the other, except for the posts in `held`; pins no post.
pub fn dig(works: &[Earthwork], lattice: &mut Lattice, held: &HeldPosts) -> BrushChanges {
    works.iter().fold(BrushChanges::default(), |changes, work| changes.and(work.apply(lattice, held)))
}

/// The earth that [`dig`] would move; changes nothing. Costs a copy of the ground around the works.
pub fn foreseen(works: &[Earthwork], lattice: &Lattice, held: &HeldPosts) -> MovedEarth {
    let mut moved = MovedEarth::default();
    let Some(mut part) = ground_around(works, lattice) else { return moved };
    for work in works {
        let changes = work.apply(&mut part, held);
        moved.area_m2 += changes.area_m2(&part);
        moved.volumes += changes.volumes;
    }
    moved
}

/// A copy of the ground around works, as a part of the lattice; `None` where none reaches it.
fn ground_around(works: &[Earthwork], lattice: &Lattice) -> Option<Lattice> {
    let around = works
        .iter()
        .filter_map(|work| work.bounds(lattice))
        .reduce(|a, b| Rect { min: a.min.min(b.min), max: a.max.max(b.max) })?;
    // A cell more on every side, whose corners interpolation between posts reads.
    let PostRect { first, last } =
        PostRect::within(lattice, &around.grown(lattice.cell().max_element()))?.grown((1, 1), lattice);
    // The diagonals of cells go by whether columns and rows are even.
    let first = Post { column: first.column & !1, row: first.row & !1 };
    let mut heights = Vec::new();
    for row in first.row..=last.row {
        let from = lattice.index(Post { column: first.column, row });
        heights.extend_from_slice(&lattice.heights()[from..=from + (last.column - first.column) as usize]);
    }
    let whole = first.offset(lattice.first().column, lattice.first().row);
    let frame = (lattice.origin(), lattice.cell());
    let part = Lattice::part(frame, whole, last.column - first.column + 1, heights).ok()?;
    Some(part.with_doublings_of(lattice))
}

impl RaisedGround {
    /// The embankment on the ground as it is; `None` where a point of the line lies off it or where there is no data.
    fn embankment(&self, lattice: &Lattice) -> Option<Embankment> {
        let mut highest_m = 0.0f64;
        let crown = |&at: &DVec2| {
            let ground_m = ground_height(lattice, Interpolation::Planar, at + lattice.origin()).height_m()?;
            let crown_m = match self.crown {
                CrownHeight::AboveGround(height_m) => ground_m + height_m,
                CrownHeight::Elevation(crown_m) => crown_m,
            };
            highest_m = highest_m.max(crown_m - ground_m);
            Some(at.extend(crown_m))
        };
        let mut line = self.line.iter().map(crown).collect::<Option<Vec<_>>>()?;
        if let [only] = line[..] {
            line.push(only);
        }
        let reach_m = self.width_m / 2.0 + DOWNHILL * self.run * highest_m;
        Some(Embankment { line, crown_m: self.width_m, run: self.run, reach_m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::Batters;

    const SIDE: u32 = 121;

    /// Ground that rises 0.1 m a meter to the east, 1 m between posts.
    fn slope() -> Lattice {
        let heights = (0..SIDE * SIDE).map(|index| 100.0 + (index % SIDE) as f32 * 0.1).collect();
        Lattice::new(DVec2::new(5e5, 4e6), DVec2::ONE, SIDE, heights).expect("sound")
    }

    fn works() -> Vec<Earthwork> {
        let line = vec![DVec2::new(30.0, 40.0), DVec2::new(80.0, 60.0)];
        let ring = [(30.0, 40.0), (80.0, 45.0), (60.0, 80.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        let raised =
            |line: Vec<DVec2>, crown| Earthwork::Raise(RaisedGround { line, crown, width_m: 4.0, run: 1.5 });
        vec![
            Earthwork::Crater(Crater {
                center: DVec2::splat(60.0),
                radius_m: 12.0,
                depth_m: 4.0,
                rim_m: 1.0,
            }),
            Earthwork::Trench(Trench { line: line.clone(), bottom_m: 3.0, top_m: 6.0, depth_m: 2.0 }),
            Earthwork::Track(TireTrack { line: line.clone(), gauge_m: 6.0, rut_m: 3.0, depth_m: 0.5 }),
            Earthwork::Level(LevelGround { rings: vec![ring], level_m: None, batters: Batters::default() }),
            raised(line.clone(), CrownHeight::AboveGround(3.0)),
            raised(line, CrownHeight::Elevation(110.0)),
            raised(vec![DVec2::splat(60.0)], CrownHeight::AboveGround(5.0)),
        ]
    }

    #[test]
    fn held_posts_stay_and_volumes_are_those_of_the_posts_that_moved() {
        let mut held = slope();
        (0..SIDE).for_each(|row| {
            (55..60).for_each(|column| held.pin(Post { column, row }, held.height(Post { column, row })));
        });
        let held = HeldPosts::pinned(&held);
        for work in works() {
            let before = slope();
            let (mut free, mut kept) = (slope(), slope());
            work.apply(&mut free, &HeldPosts::default());
            let changes = work.apply(&mut kept, &held);
            let (mut cut_m3, mut fill_m3, mut moved) = (0.0, 0.0, 0);
            for post in before.posts() {
                let [was, is, would] = [&before, &kept, &free].map(|lattice| lattice.height(post));
                assert_eq!(
                    is,
                    if (55..60).contains(&post.column) { was } else { would },
                    "{work:?} {post:?}"
                );
                cut_m3 += f64::from(was - is).max(0.0);
                fill_m3 += f64::from(is - was).max(0.0);
                moved += usize::from(is != was);
            }
            assert!((changes.volumes.cut_m3 - cut_m3).abs() < 1e-6 * (1.0 + cut_m3), "{work:?}");
            assert!((changes.volumes.fill_m3 - fill_m3).abs() < 1e-6 * (1.0 + fill_m3), "{work:?}");
            let listed: usize = changes.pieces.iter().map(|piece| piece.changed(&kept).count()).sum();
            assert_eq!((listed, moved > 50), (moved, true), "{work:?}");
        }
    }

    #[test]
    fn heights_change_within_the_bounds_alone_and_at_the_stated_cost() {
        for work in works() {
            let before = slope();
            let mut lattice = slope();
            let (bounds, cost) = (work.bounds(&before).expect("on it"), work.cost(&before));
            work.apply(&mut lattice, &HeldPosts::default());
            let moved = |&post: &Post| lattice.height(post) != before.height(post);
            let changed: Vec<Post> = before.posts().filter(moved).collect();
            assert!(
                changed.iter().all(|&post| bounds.contains(before.position(post).as_dvec2())),
                "{work:?}"
            );
            assert!(cost >= changed.len() as f64 && cost < 1e6, "{cost} for {work:?}");
        }
    }

    #[test]
    fn what_is_foreseen_is_what_is_dug() {
        let mut wet = slope();
        (0..40).for_each(|row| wet.pin(Post { column: 58, row: row + 30 }, 100.0));
        let held = HeldPosts::pinned(&wet);
        let mut each: Vec<Vec<Earthwork>> = works().into_iter().map(|work| vec![work]).collect();
        each.push(works());
        for works in each {
            let mut lattice = slope();
            let foreseen = foreseen(&works, &lattice, &held);
            let changes = dig(&works, &mut lattice, &held);
            let difference = foreseen.volumes.cut_m3 - changes.volumes.cut_m3;
            assert!(difference.abs() < 1e-6 * (1.0 + changes.volumes.cut_m3), "{works:?}");
            let difference = foreseen.volumes.fill_m3 - changes.volumes.fill_m3;
            assert!(difference.abs() < 1e-6 * (1.0 + changes.volumes.fill_m3), "{works:?}");
            assert!(foreseen.area_m2 >= changes.pieces.len() as f64, "{works:?}");
        }
    }

    #[test]
    fn a_mound_is_as_high_as_stated_and_its_batters_reach_the_ground() {
        let mut lattice = slope();
        let crown = CrownHeight::AboveGround(5.0);
        let mound = RaisedGround { line: vec![DVec2::splat(60.0)], crown, width_m: 4.0, run: 1.5 };
        let changes = Earthwork::Raise(mound).apply(&mut lattice, &HeldPosts::default());
        assert_eq!(lattice.height(Post { column: 60, row: 60 }), 111.0);
        // No step where it ends: each post rises by less than the batter's fall over a diagonal.
        let before = slope();
        for change in &changes.pieces {
            for (post, was) in change.changed(&lattice) {
                let at_end = [(0, 1), (1, 0)].iter().any(|&(east, north)| {
                    let beside = post.offset(east, north);
                    lattice.height(beside) == before.height(beside)
                });
                assert!(!at_end || lattice.height(post) - was < 1.0, "{post:?}");
            }
        }
        assert_eq!(changes.volumes.cut_m3, 0.0);
    }

    #[test]
    fn what_lies_off_the_ground_changes_nothing_and_costs_nothing() {
        let far = DVec2::splat(1e9);
        let crown = CrownHeight::AboveGround(5.0);
        let line = vec![far, far + 10.0];
        for work in [
            Earthwork::Crater(Crater { center: far, radius_m: 12.0, depth_m: 4.0, rim_m: 1.0 }),
            Earthwork::Trench(Trench { line: line.clone(), bottom_m: 3.0, top_m: 6.0, depth_m: 2.0 }),
            Earthwork::Raise(RaisedGround { line, crown, width_m: 4.0, run: 1.5 }),
        ] {
            let mut lattice = slope();
            assert_eq!((work.bounds(&lattice), work.cost(&lattice)), (None, 1.0));
            assert!(work.apply(&mut lattice, &HeldPosts::default()).pieces.is_empty());
        }
    }
}
