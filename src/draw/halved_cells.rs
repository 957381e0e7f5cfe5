//! A ground map with posts between those of its model, for pictures whose pixels are narrower than its cells.
//!
//! Between posts, slopes that run straight from one to the next blur all crests and valleys over two cells. Along the sides of a
//! cell, the slopes here are those of the cubics that have the heights and the slopes of the posts at their ends (Hermite's; with
//! slopes by central differences those of Catmull and Rom 1974), and straight between opposite sides. All other values, heights
//! too, are what they were at each place: contours and tints stay those of the model.

use glam::Vec2;
use rayon::prelude::*;

use crate::ground::{GroundMap, GroundPost};
use crate::lanes::mix;

impl GroundMap {
    /// The map with cells halved `times` times; slopes between its posts are straight where [`Self::is_curved`] is false.
    pub fn with_halved_cells(mut self, times: u32) -> Self {
        let count = |posts: u32| ((posts - 1) << times) + 1;
        let (columns, rows) = (count(self.columns), count(self.rows));
        let scale = (1u32 << times) as f32;
        let mut posts: Vec<GroundPost> = bytemuck::zeroed_vec(columns as usize * rows as usize);
        posts.par_chunks_exact_mut(columns as usize).enumerate().for_each(|(row, posts)| {
            for (column, post) in posts.iter_mut().enumerate() {
                let grid = Vec2::new(column as f32, row as f32) / scale;
                *post = self.post_at(grid);
                if self.is_curved {
                    [post.slope_east, post.slope_north] = self.curved_slopes(grid).to_array();
                }
            }
        });
        self.posts = posts;
        (self.columns, self.rows) = (columns, rows);
        self.cell /= scale;
        self.form_level += times;
        self.halvings += times;
        self
    }

    /// The slopes eastward and northward of the curved ground at a place on the map in columns and rows.
    fn curved_slopes(&self, grid: Vec2) -> Vec2 {
        let ([sw, se, nw, ne], part) = self.around(grid);
        let rise_per_m = self.z_per_m / self.cell;
        let rise = |from: &GroundPost, to: &GroundPost| to.height_m - from.height_m;
        let east = |from: &GroundPost, to: &GroundPost| {
            slope_of_cubic([from.slope_east, to.slope_east], rise(from, to) * rise_per_m.x, part.x)
        };
        let north = |from: &GroundPost, to: &GroundPost| {
            slope_of_cubic([from.slope_north, to.slope_north], rise(from, to) * rise_per_m.y, part.y)
        };
        Vec2::new(mix(east(sw, se), east(nw, ne), part.y), mix(north(sw, nw), north(se, ne), part.x))
    }
}

/// The slope at `along`, 0..=1, of the cubic with these slopes at its ends, which rises by `mean` per unit of length.
fn slope_of_cubic([from, to]: [f32; 2], mean: f32, along: f32) -> f32 {
    let rest = 1.0 - along;
    from * rest * (1.0 - 3.0 * along) + to * along * (3.0 * along - 2.0) + 6.0 * along * rest * mean
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: u32 = 9;

    /// A map of `height_m` by place in cells, whose slopes are `slopes` there.
    fn map(height_m: impl Fn(Vec2) -> f32, slopes: impl Fn(Vec2) -> Vec2) -> GroundMap {
        let post = |index: u32| {
            let at = Vec2::new((index % SIDE) as f32, (index / SIDE) as f32);
            GroundPost {
                height_m: height_m(at),
                slope_east: slopes(at).x,
                slope_north: slopes(at).y,
                water: 0.1 * at.x,
                ..GroundPost::default()
            }
        };
        let posts = (0..SIDE * SIDE).map(post).collect();
        GroundMap {
            columns: SIDE,
            rows: SIDE,
            posts,
            cell: Vec2::new(2.0, 4.0),
            z_per_m: 3.0,
            form_level: 2,
            is_curved: true,
            ..GroundMap::level()
        }
    }

    #[test]
    fn places_keep_what_they_had_and_posts_keep_their_slopes() {
        let wave = |at: Vec2| libm::sinf(at.x * 1.3) * libm::cosf(at.y * 0.7);
        let coarse = map(wave, |at| Vec2::new(wave(at), -0.5 * wave(at)));
        for (times, is_curved) in [(1, true), (2, true), (3, false)] {
            let fine = GroundMap { is_curved, ..coarse.clone() }.with_halved_cells(times);
            fine.check().expect("sound");
            assert_eq!((fine.halvings, fine.form_level), (times, 2 + times));
            assert_eq!(fine.model_cell_m(), coarse.model_cell_m());
            for row in 0..fine.rows {
                for column in 0..fine.columns {
                    let post = &fine.posts[(row * fine.columns + column) as usize];
                    let at = fine.origin + fine.cell * Vec2::new(column as f32, row as f32);
                    let own = coarse.sample(at);
                    assert!(
                        (post.height_m - own.height_m).abs() < 1e-5 && (post.water - own.water).abs() < 1e-5
                    );
                    let is_post = column % (1 << times) == 0 && row % (1 << times) == 0;
                    if is_post || !is_curved {
                        assert!((post.slope_east - own.slope_east).abs() < 1e-5, "{times} {column} {row}");
                        assert!((post.slope_north - own.slope_north).abs() < 1e-5, "{times} {column} {row}");
                    }
                }
            }
        }
    }

    #[test]
    fn slopes_of_a_cubic_are_exact_between_posts() {
        // Heights per cell, drawn three times as high; cells are 2 m and 4 m wide.
        let height_m = |at: Vec2| 0.05 * at.x * at.x * at.x - 0.4 * at.x * at.x + 0.3 * at.y * at.y;
        let slopes =
            |at: Vec2| Vec2::new(3.0 * (0.15 * at.x * at.x - 0.8 * at.x) / 2.0, 3.0 * 0.6 * at.y / 4.0);
        let fine = map(height_m, slopes).with_halved_cells(2);
        for (index, post) in (0..).zip(&fine.posts) {
            let at = Vec2::new((index % fine.columns) as f32, (index / fine.columns) as f32) / 4.0;
            let found = Vec2::new(post.slope_east, post.slope_north);
            assert!((found - slopes(at)).length() < 1e-4, "{at}: {found} {}", slopes(at));
        }
    }

    #[test]
    fn maps_of_one_post_or_row_stay_sound() {
        for (columns, rows) in [(1, 1), (3, 1), (1, 3), (2, 2)] {
            let posts = vec![GroundPost::default(); (columns * rows) as usize];
            let fine = GroundMap { columns, rows, posts, ..GroundMap::level() }.with_halved_cells(2);
            fine.check().expect("sound");
        }
    }
}
