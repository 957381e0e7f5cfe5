//! Relief in water: where a ray that level water mirrors meets the ground of a map.
//!
//! The ray rises, so it passes over every block of the map whose highest land lies below it where it enters
//! ([`GroundTops`]), by blocks that grow as long as nothing is in its way. In the blocks that are left it is compared with
//! the ground every half cell, bilinear between posts, and where it first lies below, the place is found by bisection.
//! Ground under water does not count, so the banks of a lake are mirrored from their shore on.
//!
//! The surface that mirrors lies at the height of the map, and over beds below 0 at that of the sea.

use glam::{Vec2, Vec3};

use crate::ground::GroundMap;
use crate::ground_tops::{BLOCK, GroundTops, is_land};

/// The shares of light that water mirrors from which it begins to show relief, and from which it does so in full: a ray that
/// falls by 25° and by 17°. From above the mirror shows next to nothing, and costs nothing.
pub const SHOWN: [f32; 2] = [0.05, 0.10];

/// What a ray to water falls per meter of its length from which on it shows no relief, however ripples tilt the mirror.
pub const STEEP: f32 = 0.52;

/// The least that a mirrored ray rises, per meter: ripples tilt some into the water.
pub const LEAST_RISE: f32 = 1e-3;

/// The most blocks and places that a ray is compared with: some ten are common, a ray close over rough land takes more and
/// shows the sky where this is spent.
pub const MOST_STEPS: u32 = 256;

/// The level of blocks that a ray begins with: it begins on water, mostly far from all land.
pub const FIRST_LEVEL: usize = 3;

/// How often the last half cell of a ray is halved: to a part in a hundred of a cell.
pub const BISECTIONS: u32 = 6;

/// The share of the relief that water shows which mirrors `share` of the light.
pub fn relief_shown(share: f32) -> f32 {
    let [none, all] = SHOWN;
    ((share - none) / (all - none)).clamp(0.0, 1.0)
}

/// A ray that water mirrors, in the world space of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirroredRay {
    /// World X and Y where it begins.
    pub from: Vec2,
    /// World Z there.
    pub z: f32,
    /// Its direction in plan, of unit length.
    pub toward: Vec2,
    /// What it rises per meter in plan, above 0.
    pub rise: f32,
}

/// How far from its beginning a ray meets something, in meters in plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RayEnd {
    /// It meets the ground.
    Ground(f32),
    /// It leaves the map.
    Beyond(f32),
}

impl MirroredRay {
    /// The ray `direction`, of unit length, from water at a place of the map; `None` where it is upright.
    pub fn new(map: &GroundMap, from: Vec2, direction: Vec3) -> Option<Self> {
        let level = direction.truncate().length();
        (level > 1e-3).then(|| Self {
            from,
            z: (map.value_at(map.grid_at(from), |post| post.height_m) * map.z_per_m).max(0.0),
            toward: direction.truncate() / level,
            rise: (direction.z / level).max(LEAST_RISE),
        })
    }

    /// The same ray in a world space whose origin lies at `origin` in this one.
    pub fn within(self, origin: Vec2) -> Self {
        Self { from: self.from - origin, ..self }
    }

    /// World X and Y that far along it.
    pub fn at(&self, along_m: f32) -> Vec2 {
        self.from + self.toward * along_m
    }

    /// Its length to there, in meters.
    pub fn length_m(&self, along_m: f32) -> f32 {
        along_m * (1.0 + self.rise * self.rise).sqrt()
    }

    /// Where it first meets a checked map, of which `tops` are, from `start_m` on.
    pub fn meets(&self, map: &GroundMap, tops: &GroundTops, start_m: f32) -> RayEnd {
        let start = (self.from - map.origin) / map.cell;
        // What runs along the posts crosses no line beside it on the map.
        let per_m = self.toward / map.cell;
        let per_m = Vec2::select(per_m.cmpeq(Vec2::ZERO), Vec2::splat(1e-20), per_m);
        let (meters, ahead) = (per_m.recip(), Vec2::select(per_m.cmplt(Vec2::ZERO), Vec2::ZERO, Vec2::ONE));
        let last = Vec2::new((map.columns - 1) as f32, (map.rows - 1) as f32);
        let beyond = ((ahead * last - start) * meters).min_element();
        let clear = (tops.highest_m() * map.z_per_m - self.z) / self.rise;
        let end = beyond.min(clear);
        // Half a cell, and what carries a ray over the border of a block.
        let (step, past) = (0.5 / per_m.abs().max_element(), 1e-3 / per_m.abs().max_element());
        let is_below = |along: f32| {
            let grid = (start + per_m * along).clamp(Vec2::ZERO, last);
            map.value_at(grid, |post| post.height_m) * map.z_per_m > self.z + self.rise * along
                && is_land(map.value_at(grid, |post| post.water))
        };
        let (mut along, mut level, mut left) = (start_m, FIRST_LEVEL.min(tops.levels.len() - 1), MOST_STEPS);
        while along < end && left > 0 {
            left -= 1;
            let cells = (BLOCK << level) as f32;
            let block = ((start + per_m * along).clamp(Vec2::ZERO, last) * cells.recip()).as_uvec2();
            let leaves = (((block.as_vec2() + ahead) * cells - start) * meters).min_element().max(along);
            let top = tops.levels[level].top_m(block);
            if self.z + self.rise * along >= top * map.z_per_m {
                along = leaves + past;
                level = (level + 1).min(tops.levels.len() - 1);
            } else if level > 0 {
                level -= 1;
            } else {
                let stop = leaves.min(end);
                let mut clear = along;
                loop {
                    if is_below(along) {
                        return RayEnd::Ground(bisected([clear, along], is_below));
                    }
                    if along >= stop || left == 0 {
                        break;
                    }
                    left -= 1;
                    clear = along;
                    along = (along + step).min(stop);
                }
                along = leaves + past;
            }
        }
        RayEnd::Beyond(beyond)
    }
}

/// The first place below the ground between one above it and one below.
fn bisected([mut above, mut below]: [f32; 2], is_below: impl Fn(f32) -> bool) -> f32 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (above + below);
        if is_below(middle) {
            below = middle;
        } else {
            above = middle;
        }
    }
    below
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::GroundPost;

    /// Water west of column 40, then dry ground at `land` of a place in cells.
    fn shore(columns: u32, rows: u32, land: impl Fn(u32, u32) -> f32) -> GroundMap {
        let post = |index: u32| {
            let (x, y) = (index % columns, index / columns);
            let (height_m, water) = if x < 40 { (100.0, 1.0) } else { (land(x, y), 0.0) };
            GroundPost { height_m, water, ..GroundPost::default() }
        };
        let posts = (0..columns * rows).map(post).collect();
        GroundMap { cell: Vec2::new(10.0, 5.0), columns, rows, posts, z_per_m: 2.0, ..GroundMap::level() }
    }

    fn ray(map: &GroundMap, from: Vec2, toward: Vec2, rise: f32) -> MirroredRay {
        MirroredRay::new(map, from, toward.extend(rise).normalize()).expect("not upright")
    }

    #[test]
    fn a_wall_is_met_up_to_its_top_and_the_sky_above_it() {
        let map = shore(90, 80, |x, _| if x < 50 { 101.0 } else { 160.0 });
        let tops = GroundTops::new(&map);
        let from = Vec2::new(105.0, 200.0);
        // The wall rises from 385 m on along the ray to 395 m, and is 120 m high as drawn.
        for rise in [0.05, 0.1, 0.2, 0.29] {
            let end = ray(&map, from, Vec2::X, rise).meets(&map, &tops, 0.0);
            assert!(matches!(end, RayEnd::Ground(at) if (380.0..=395.5).contains(&at)), "{rise}: {end:?}");
        }
        for rise in [0.31, 0.5, 3.0] {
            let end = ray(&map, from, Vec2::X, rise).meets(&map, &tops, 0.0);
            assert!(matches!(end, RayEnd::Beyond(at) if (at - 785.0).abs() < 0.1), "{rise}: {end:?}");
        }
        assert!(matches!(ray(&map, from, -Vec2::X, 0.05).meets(&map, &tops, 0.0), RayEnd::Beyond(_)));
    }

    #[test]
    fn what_a_ray_meets_is_what_small_steps_find() {
        let rough = |x: u32, y: u32| 100.0 + (x - 40) as f32 * 1.5 + ((x * 7 + y * 13) % 11) as f32 * 3.0;
        let map = shore(97, 61, rough);
        let tops = GroundTops::new(&map);
        for turn in 0..60 {
            let toward = Vec2::from_angle(turn as f32 * 0.1 - 3.0);
            for rise in [0.02, 0.11, 0.3, 0.6] {
                let ray = ray(&map, Vec2::new(200.0, 150.0 + turn as f32), toward, rise);
                let is_below = |along: f32| {
                    let post = map.sample(ray.at(along));
                    post.height_m * 2.0 > ray.z + rise * along && is_land(post.water)
                };
                let end = ray.meets(&map, &tops, 0.0);
                let is_within = |at: f32| {
                    let grid = ray.at(at) / map.cell;
                    grid.cmpge(Vec2::ZERO).all() && grid.cmple(Vec2::new(96.0, 60.0)).all()
                };
                let found = (0..10_000)
                    .map(|step| step as f32 * 0.1)
                    .take_while(|at| is_within(*at))
                    .find(|at| is_below(*at));
                match (end, found) {
                    (RayEnd::Ground(at), Some(wanted)) => assert!((at - wanted).abs() < 2.6, "{at} {wanted}"),
                    (RayEnd::Beyond(_), None) => {}
                    other => panic!("{toward} {rise}: {other:?}"),
                }
            }
        }
    }

    #[test]
    fn the_sea_mirrors_from_its_level_and_not_from_its_bed() {
        let map = shore(60, 20, |_, _| 5.0);
        let bed = GroundMap {
            posts: map
                .posts
                .iter()
                .map(|post| GroundPost { height_m: post.height_m - 300.0, ..*post })
                .collect(),
            ..map.clone()
        };
        assert_eq!(ray(&map, Vec2::splat(50.0), Vec2::X, 0.1).z, 200.0);
        assert_eq!(ray(&bed, Vec2::splat(50.0), Vec2::X, 0.1).z, 0.0);
    }

    #[test]
    fn only_low_views_show_relief() {
        assert_eq!(
            [0.02, 0.05, 0.075, 0.1, 0.5].map(|share| (relief_shown(share) * 100.0).round()),
            [0.0, 0.0, 50.0, 100.0, 100.0]
        );
    }
}
