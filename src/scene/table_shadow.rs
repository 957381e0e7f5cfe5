//! The shadow of the block on its table.
//!
//! The block is read as a coarse height field over the table. From a place of the table one looks toward the sun: of the
//! samples on the way, the one that stands highest over the ray decides how much of the sun is hidden. The sun's edge is
//! taken far wider than it is, as if by a large lamp, so that the shadow is sharp at the block's foot and softens away from
//! it. Where block and table meet, a narrow darker rim shows that the block rests on it.

use glam::{DVec2, UVec2, Vec2, Vec3};
use rayon::prelude::*;

use sandtable_draw::box_blur::box_blurred;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};

/// The shadow of the block on its table.
#[derive(Clone, Copy, Debug)]
pub struct TableShadow<'a> {
    /// The drawn ground.
    pub ground: &'a Lattice,
    /// World Z of the table.
    pub table_z: f32,
    /// Unit vector toward the sun.
    pub to_sun: Vec3,
}

/// Meters by which the half-shadow widens per meter from what throws it: a large lamp, not the sun (0.009).
const SOFTNESS: f32 = 0.3;

/// The shade where the sun is hidden, and where the block meets the table.
const CAST: f32 = 0.42;
const CONTACT: f32 = 0.5;

/// The reach of the contact shade, as a share of the map's side.
const CONTACT_REACH: f32 = 0.012;

/// The most samples on the way to the sun: beyond them a low sun's shadow ends.
const MOST_STEPS: u32 = 512;

/// Samples of the block's height, row by row from the south; NaN where there is no ground.
struct BlockHeights {
    size: UVec2,
    cell: Vec2,
    heights: Vec<f32>,
    highest: f32,
}

impl TableShadow<'_> {
    /// The shade, 0 for full light, on `side` × `side` places over the rectangle `table` of world X and Y, in rows from
    /// its north-west corner. `side` is at least 2.
    pub fn map(&self, table: &Rect, side: u32) -> Vec<f32> {
        let step = table.size().as_vec2() / (side - 1) as f32;
        let corner = Vec2::new(table.min.x as f32, table.max.y as f32);
        let place = |index: usize| {
            let (x, y) = (index as u32 % side, index as u32 / side);
            corner + Vec2::new(x as f32, -(y as f32)) * step
        };
        let block = BlockHeights::new(self.ground, step.min_element());
        let count = (side * side) as usize;
        let cast: Vec<f32> = (0..count)
            .into_par_iter()
            .map(|index| self.hidden_share(&block, place(index), step.min_element()))
            .collect();
        // The block's samples are coarse: their steps would show in the shadow's edge.
        let cast = box_blurred(&cast, side as usize, 1);
        let is_covered = |index| f32::from(block.at(place(index)).is_finite());
        let covered: Vec<f32> = (0..count).into_par_iter().map(is_covered).collect();
        let reach = ((side as f32 * CONTACT_REACH) as usize).max(1);
        let contact = box_blurred(&box_blurred(&covered, side as usize, reach), side as usize, reach);
        cast.par_iter()
            .zip(contact)
            .map(|(cast, near)| 1.0 - (1.0 - cast * CAST) * (1.0 - near * CONTACT))
            .collect()
    }

    /// The share of the sun that is hidden from a place on the table.
    fn hidden_share(&self, block: &BlockHeights, place: Vec2, step_m: f32) -> f32 {
        let level = self.to_sun.truncate();
        let Some(toward) = level.try_normalize() else { return 0.0 };
        let rise = self.to_sun.z / level.length();
        // Past this way nothing of the block reaches up to the half-shadow's edge.
        let closing = (rise - SOFTNESS).max(1e-3);
        let last_m = (block.highest - self.table_z + step_m).max(0.0) / closing;
        let steps = ((last_m / step_m).ceil() as u32).min(MOST_STEPS);
        let Some((first_m, last_m)) = block.way_over(place, toward) else { return 0.0 };
        let step = |way_m: f64| way_m / f64::from(step_m);
        let (first, last) = (step(first_m).floor() as u32, step(last_m).ceil() as u32);
        let mut most = 0.0_f32;
        for step in first.max(1)..=last.min(steps) {
            let way_m = step as f32 * step_m;
            let over = block.at(place + toward * way_m) - self.table_z - way_m * rise;
            // Where there is no ground the height is NaN, which `max` passes over.
            most = most.max((over / (way_m * SOFTNESS + step_m) * 0.5 + 0.5).clamp(0.0, 1.0));
            if most >= 1.0 {
                break;
            }
        }
        most
    }
}

impl BlockHeights {
    /// Samples about `step_m` apart, at posts.
    fn new(ground: &Lattice, step_m: f32) -> Self {
        let last = UVec2::new(ground.columns() - 1, ground.rows() - 1);
        let extent = ground.extent().size();
        let size = (extent / f64::from(step_m)).ceil().as_uvec2().clamp(UVec2::splat(2), last + 1);
        let post = |index: u32| {
            let part = UVec2::new(index % size.x, index / size.x).as_dvec2() / (size - 1).as_dvec2();
            let at = (part * last.as_dvec2()).round().as_uvec2();
            ground.height(Post { column: at.x, row: at.y })
        };
        let cell = (extent / (size - 1).max(UVec2::ONE).as_dvec2()).as_vec2();
        let heights: Vec<f32> = (0..size.x * size.y).map(post).collect();
        let highest = heights.iter().copied().fold(f32::MIN, f32::max);
        Self { size, cell, heights, highest }
    }

    /// From how far and how far a ray from a place can be over the block, and a cell more on both sides, meters; `None` where
    /// it never is.
    fn way_over(&self, place: Vec2, toward: Vec2) -> Option<(f64, f64)> {
        let block =
            Rect { min: -self.cell.as_dvec2(), max: ((self.size + 1).as_vec2() * self.cell).as_dvec2() };
        block.clip_ray(place.as_dvec2(), toward.as_dvec2(), (0.0, f64::MAX))
    }

    /// The height of the nearest sample; NaN off the block.
    fn at(&self, place: Vec2) -> f32 {
        let index = (place / self.cell).round();
        let is_on = index.cmpge(Vec2::ZERO).all() && index.cmplt(self.size.as_vec2()).all();
        let index = index.as_uvec2();
        if is_on { self.heights[(index.y * self.size.x + index.x) as usize] } else { f32::NAN }
    }
}

/// The rectangle of world X and Y that a lattice covers, grown by `margin_m` on all sides.
pub fn table_rect(ground: &Lattice, margin_m: f64) -> Rect {
    Rect { min: DVec2::ZERO, max: ground.extent().size() }.grown(margin_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shadow_falls_away_from_the_sun_and_softens_with_distance() {
        // A block of 1 km, 100 m high, under a sun in the west, 45° high.
        let ground = Lattice::new(DVec2::ZERO, DVec2::splat(20.0), 51, vec![100.0; 51 * 51]).expect("sound");
        let to_sun = Vec3::new(-1.0, 0.0, 1.0).normalize();
        let side = 201;
        let shadow = TableShadow { ground: &ground, table_z: 0.0, to_sun };
        let map = shadow.map(&table_rect(&ground, 500.0), side);
        // One place each 10 m; the middle row, by its distance from the eastern and from the western wall.
        let row = &map[100 * side as usize..][..side as usize];
        let (east, west) = (|m: usize| row[150 + m / 10], |m: usize| row[50 - m / 10]);
        assert!(east(50) > 0.8 * CAST && west(50) < 0.05, "{} {}", east(50), west(50));
        assert!(east(250) < 0.02 && west(250) == 0.0);
        assert!(east(80) > east(100) && east(100) > east(120), "{row:?}");
        assert!(west(10) > west(30), "the foot is darker");
    }

    #[test]
    fn the_way_over_the_block_leaves_out_no_place_of_it() {
        let ground =
            Lattice::new(DVec2::ZERO, DVec2::new(20.0, 30.0), 21, vec![50.0; 21 * 31]).expect("sound");
        let block = BlockHeights::new(&ground, 25.0);
        for turn in 0..64 {
            let (sin, cos) = (turn as f32 * std::f32::consts::TAU / 64.0).sin_cos();
            let toward = Vec2::new(cos, sin);
            for from in 0..200 {
                let place = Vec2::new((from % 20) as f32 * 60.0 - 400.0, (from / 20) as f32 * 150.0 - 300.0);
                let way = block.way_over(place, toward);
                let is_over = |step: &u32| block.at(place + toward * *step as f32 * 7.0).is_finite();
                let mut met = (0..300).filter(is_over).map(|step| f64::from(step) * 7.0);
                let is_held = |at: f64| way.is_some_and(|(first, last)| first <= at && at <= last);
                assert!(met.all(is_held), "{place} {toward}");
            }
        }
        assert_eq!(block.way_over(Vec2::new(-100.0, 50.0), Vec2::NEG_X), None, "it leads away");
    }

    #[test]
    fn a_hole_in_the_ground_throws_no_shadow() {
        let mut heights = vec![100.0; 51 * 51];
        heights.iter_mut().enumerate().filter(|(index, _)| index % 51 > 20).for_each(|(_, z)| *z = f32::NAN);
        let ground = Lattice::new(DVec2::ZERO, DVec2::splat(20.0), 51, heights).expect("sound");
        let shadow = TableShadow { ground: &ground, table_z: 0.0, to_sun: Vec3::new(-0.6, 0.0, 0.8) };
        let map = shadow.map(&table_rect(&ground, 500.0), 201);
        assert_eq!(map[100 * 201 + 150 + 5], 0.0);
        assert!(map[100 * 201 + 50 + 45] > 0.8 * CAST);
    }
}
