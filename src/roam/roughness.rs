//! Local roughness: how far the posts around a post differ from it in height.
//!
//! `f = (1/n) Σ (z − z_i)²` over the n posts with data in a window around the post, itself included (constrained nested
//! error criterion; 3 × 3 in the paper's tests). The factor `k = 1 − 1/(f + 1 + ξ)`, `0 < k < 1`, is near 1 on rough ground
//! and near 0 on flat ground. It has no unit: a slope counts as roughness, and f is measured in meters.

use rayon::prelude::*;

use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// The paper's ξ: keeps k above 0 on level ground, so that an infinite error stays infinite.
const XI: f64 = 1e-6;

/// The local roughness of every post, square meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Roughness {
    columns: usize,
    half_window: (u32, u32),
    values: Vec<f32>,
}

impl Roughness {
    /// The roughness over windows that reach `half_window` posts east and north of each post, (1, 1) for the paper's
    /// 3 × 3. In parallel; the same for any number of threads.
    pub fn new(lattice: &Lattice, half_window: (u32, u32)) -> Self {
        let columns = lattice.columns() as usize;
        let mut values = vec![0.0; lattice.heights().len()];
        values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
            for (column, value) in values.iter_mut().enumerate() {
                *value = local(lattice, Post { column: column as u32, row: row as u32 }, half_window);
            }
        });
        Self { columns, half_window, values }
    }

    /// The number of posts that a window reaches east and north.
    pub fn half_window(&self) -> (u32, u32) {
        self.half_window
    }

    /// The roughness of a post of the lattice; 0 without data.
    pub fn at(&self, post: Post) -> f32 {
        self.values[post.row as usize * self.columns + post.column as usize]
    }

    /// The constraint factor of a post, above 0 and at most 1.
    pub fn factor(&self, post: Post) -> f64 {
        1.0 - 1.0 / (f64::from(self.at(post)) + 1.0 + XI)
    }

    /// Measures the windows of the posts of `posts`, which have new heights, again.
    pub fn renew(&mut self, lattice: &Lattice, posts: &PostRect) {
        for post in posts.grown(self.half_window, lattice).posts() {
            self.values[lattice.index(post)] = local(lattice, post, self.half_window);
        }
    }
}

fn local(lattice: &Lattice, post: Post, half_window: (u32, u32)) -> f32 {
    let own = f64::from(lattice.height(post));
    let window = PostRect { first: post, last: post }.grown(half_window, lattice);
    let (mut sum, mut count) = (0.0, 0u32);
    for row in window.first.row..=window.last.row {
        let start = lattice.index(Post { column: window.first.column, row });
        for &height in &lattice.heights()[start..start + window.width()] {
            let rise = own - f64::from(height);
            if !rise.is_nan() {
                sum += rise * rise;
                count += 1;
            }
        }
    }
    if count > 0 { (sum / f64::from(count)) as f32 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    fn lattice(heights: Vec<f32>) -> Lattice {
        Lattice::new(DVec2::ZERO, DVec2::ONE, 5, heights).expect("sound")
    }

    #[test]
    fn a_spike_is_eight_times_as_rough_as_each_of_its_neighbors() {
        let mut heights = vec![10.0; 25];
        heights[12] = 14.0;
        let roughness = Roughness::new(&lattice(heights), (1, 1));
        let at = |column, row| roughness.at(Post { column, row });
        assert_eq!((at(2, 2), at(1, 2), at(0, 0)), (8.0 * 16.0 / 9.0, 16.0 / 9.0, 0.0));
        let factor = |column, row| roughness.factor(Post { column, row });
        assert!((factor(2, 2) - 128.0 / 137.0).abs() < 1e-6);
        assert!(factor(0, 0) > 0.0 && factor(0, 0) < 1e-5);
    }

    #[test]
    fn neighbors_without_data_or_beyond_the_border_are_left_out() {
        let mut heights = vec![10.0; 25];
        (heights[0], heights[5], heights[1]) = (12.0, f32::NAN, 13.0);
        let roughness = Roughness::new(&lattice(heights), (1, 1));
        assert_eq!(roughness.at(Post { column: 0, row: 0 }), (0.0 + 1.0 + 4.0) / 3.0);
        assert_eq!(roughness.at(Post { column: 0, row: 1 }), 0.0);
    }
}
