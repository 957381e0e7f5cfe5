//! The ground under trees: the share of it around each post that lies under crowns.
//!
//! A crown is spread over the posts around it by a cone, at least as wide as the posts lie apart, so that a wood of any
//! density covers as much of the ground as its crowns do, and a lone tree darkens the ground about its foot.

use glam::Vec2;

use crate::scene_model::SceneModel;
use sandtable_model::Model;

/// The radius of a cone in radii of its crown: litter lies beyond the boughs.
const REACH: f32 = 1.4;

/// What crowns leave open is raised to this power: a wood whose crowns cover half of the ground has little open ground.
const BETWEEN: i32 = 3;

/// A crown's radius in parts of how far its model reaches from its foot at the most.
const CROWN_PART: f32 = 0.85;

/// The most posts along the side of the square around one crown: a crown of kilometers is a mistake, and costs no more
/// than a second's thousandth.
const MOST_POSTS: f32 = 64.0;

/// The share of the ground that crowns cover by post, row by row from the south-west, 0..=1; empty where nothing grows.
pub fn undergrowth(scene: &SceneModel) -> Vec<f32> {
    let grows = |model: usize| !scene.models[model].tints.is_empty();
    if !scene.placements.iter().any(|placement| grows(placement.model)) {
        return Vec::new();
    }
    let reaches: Vec<f32> = scene.models.iter().map(crown_reach).collect();
    let size = [scene.lattice.columns(), scene.lattice.rows()];
    let mut ground = CrownGround::new(scene.lattice.cell().as_vec2(), size);
    for placement in scene.placements.iter().filter(|placement| grows(placement.model)) {
        ground.add(placement.at, reaches[placement.model] * placement.scale);
    }
    // Litter and scrub reach from crown to crown.
    ground.shares.iter_mut().for_each(|share| *share = 1.0 - (1.0 - *share).powi(BETWEEN));
    ground.shares
}

/// The radius of a model's crown, in its own units.
pub fn crown_reach(model: &Model) -> f32 {
    let bounds = model.bounds().unwrap_or_default();
    bounds.min.abs().max(bounds.max.abs()).truncate().max_element() * CROWN_PART
}

/// The share of the ground that crowns cover at the posts of a grid.
pub struct CrownGround {
    cell: Vec2,
    /// Posts per row.
    pub columns: u32,
    /// Rows of posts.
    pub rows: u32,
    /// The shares, row by row from the south-west, 0..=1.
    pub shares: Vec<f32>,
}

impl CrownGround {
    /// Open ground, of posts in columns and rows `cell` meters apart.
    pub fn new(cell: Vec2, [columns, rows]: [u32; 2]) -> Self {
        Self { cell, columns, rows, shares: vec![0.0; columns as usize * rows as usize] }
    }

    /// Adds a crown around a place, in meters from the south-west post.
    pub fn add(&mut self, at: Vec2, radius_m: f32) {
        let reach_m = self.reach_m(radius_m);
        // The cone's volume is the crown's area.
        let height = 3.0 * (radius_m / reach_m) * (radius_m / reach_m);
        let mut shares = std::mem::take(&mut self.shares);
        self.visit(at, radius_m, |index, near| shares[index] = (shares[index] + height * near).min(1.0));
        self.shares = shares;
    }

    /// Calls `visit` with the number of each post around a crown and how near it lies: 1 at the crown's center, 0 where
    /// its cone ends.
    pub fn visit(&self, at: Vec2, radius_m: f32, mut visit: impl FnMut(usize, f32)) {
        let reach_m = self.reach_m(radius_m);
        let (at, reach) = (at / self.cell, Vec2::splat(reach_m) / self.cell);
        if !(at.is_finite() && radius_m > 0.0 && reach.max_element() * 2.0 < MOST_POSTS) {
            return;
        }
        let within = |low: f32, high: f32, count: u32| {
            let first = low.ceil().clamp(0.0, count as f32) as u32;
            first..(high.floor() + 1.0).clamp(0.0, count as f32) as u32
        };
        for row in within(at.y - reach.y, at.y + reach.y, self.rows) {
            for column in within(at.x - reach.x, at.x + reach.x, self.columns) {
                let away_m = ((Vec2::new(column as f32, row as f32) - at) * self.cell).length();
                visit((row * self.columns + column) as usize, (1.0 - away_m / reach_m).max(0.0));
            }
        }
    }

    fn reach_m(&self, radius_m: f32) -> f32 {
        (radius_m * REACH).max(self.cell.max_element())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground(cell: f32) -> CrownGround {
        CrownGround::new(Vec2::splat(cell), [41, 31])
    }

    #[test]
    fn crowns_cover_as_much_ground_as_they_are_large_however_far_posts_lie_apart() {
        for (cell, radius_m) in [(30.0, 4.0), (30.0, 12.0), (2.0, 6.0), (90.0, 40.0)] {
            let mut ground = ground(cell);
            ground.add(Vec2::new(20.3, 15.6) * cell, radius_m);
            let covered: f32 = ground.shares.iter().sum::<f32>() * cell * cell;
            let area = std::f32::consts::PI * radius_m * radius_m;
            // A wide cone is clamped where it is higher than 1.
            assert!((0.5..1.4).contains(&(covered / area)), "{covered} m² of {area} in cells of {cell} m");
        }
    }

    #[test]
    fn crowns_beside_the_ground_and_hostile_ones_do_nothing_or_little() {
        for (at, radius_m) in
            [(-900.0, 5.0), (1e30, 5.0), (f32::NAN, 5.0), (20.0, 1e30), (20.0, f32::NAN), (20.0, -4.0)]
        {
            let mut ground = ground(2.0);
            ground.add(Vec2::splat(at), radius_m);
            assert!(ground.shares.iter().all(|&share| share == 0.0), "{at} {radius_m}");
        }
    }
}
