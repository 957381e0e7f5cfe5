//! The ground map as textures: the map itself and the coarser levels from which far ground is read.
//!
//! They are not mip levels of the device, which would halve rounding down: `n` posts become `n / 2 + 1`. The coarser
//! levels lie side by side in a texture of their own:
//!
//! ```text
//!   posts          coarse
//! ┌───────────┐  ┌──────┬───┬─┐
//! │  level 0  │  │  1   │ 2 │…│
//! │           │  │      ├───┴─┘
//! └───────────┘  └──────┘
//! ```
//!
//! Texels are integers that hold the bits of floats. Every adapter can read them and none may filter them, so that the
//! interpolation in the shader is the same everywhere.

use std::iter::successors;

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::draw::ground::{GroundMap, GroundPost};
use crate::draw::ground_levels::{PostCount, coarser_levels};
use crate::render::gpu::error::GpuError;
use crate::render::gpu::memory::{Loader, texture};

/// More levels than the largest texture has; the length of the shader's array.
pub const MOST_LEVELS: usize = 24;

/// Posts are sent in portions of about this many bytes, so that a large map is never held three times.
const PORTION_BYTES: usize = 16 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedLevel {
    pub size: PostCount,
    /// Its first column in the texture that holds it.
    pub first: u32,
}

#[derive(Debug)]
pub struct GroundTextures {
    /// Level 0.
    pub posts: wgpu::Texture,
    pub coarse: wgpu::Texture,
}

/// The levels of a map of `size`, down to two posts a side.
pub fn levels(size: PostCount) -> Vec<PlacedLevel> {
    let next = |last: &PlacedLevel| {
        let first = if last.size == size { 0 } else { last.first + last.size.columns };
        last.size.halved().map(|size| PlacedLevel { size, first })
    };
    successors(Some(PlacedLevel { size, first: 0 }), next).take(MOST_LEVELS).collect()
}

impl GroundTextures {
    /// Sends a checked map to the device; without a map, one texel that nothing reads.
    pub fn upload(loader: &Loader<'_>, map: Option<&GroundMap>) -> Result<Self, GpuError> {
        let levels = map.map_or_else(Vec::new, |map| levels(PostCount::from_map(map)));
        let one = PostCount { columns: 1, rows: 1 };
        let posts = levels.first().map_or(one, |level| level.size);
        let coarse = match (levels.get(1), levels.last()) {
            (Some(finest), Some(last)) => {
                PostCount { columns: last.first + last.size.columns, ..finest.size }
            }
            _ => one,
        };
        let what = || format!("the {}×{} posts of the ground map", posts.columns, posts.rows);
        let create = |PostCount { columns, rows }| {
            let format = wgpu::TextureFormat::Rgba32Uint;
            loader.texture(what, &texture("ground posts", columns, rows, format))
        };
        let textures = Self { posts: create(posts)?, coarse: create(coarse)? };
        if let Some(map) = map {
            write(loader, &textures.posts, &levels[0], &map.posts)?;
            for (place, level) in levels[1..].iter().zip(coarser_levels(map)) {
                write(loader, &textures.coarse, place, &level.posts)?;
            }
        }
        Ok(textures)
    }
}

fn write(
    loader: &Loader<'_>,
    texture: &wgpu::Texture,
    place: &PlacedLevel,
    posts: &[GroundPost],
) -> Result<(), GpuError> {
    let stride = place.size.columns as usize;
    let portion = (PORTION_BYTES / (stride * size_of::<[u32; 4]>())).max(1);
    let mut to = texture.as_image_copy();
    to.origin.x = place.first;
    for posts in posts.chunks(portion * stride) {
        let texels: Vec<[u32; 4]> = posts.par_iter().with_min_len(1024).map(packed).collect();
        let rows = (posts.len() / stride) as u32;
        loader.gpu.write(to, place.size.columns, rows, cast_slice(&texels));
        loader.count_sent((texels.len() * size_of::<[u32; 4]>()) as u64)?;
        to.origin.y += rows;
    }
    Ok(())
}

/// Height and slopes as bits, then the visibility of the sun in 12 bits, that of the sky in 10, and water in 10, from −1 (woods) to 1.
fn packed(post: &GroundPost) -> [u32; 4] {
    let share = |share: f32, most: f32| (share.clamp(0.0, 1.0) * most + 0.5) as u32;
    [
        post.height_m.to_bits(),
        post.slope_east.to_bits(),
        post.slope_north.to_bits(),
        share(post.sun_visibility, 4095.0)
            | share(post.sky_visibility, 1023.0) << 12
            | share(post.water * 0.5 + 0.5, 1022.0) << 22,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_shrink_to_two_posts_a_side_and_lie_side_by_side() {
        let levels = |columns, rows| levels(PostCount { columns, rows });
        let placed = levels(9, 4);
        let sizes: Vec<_> =
            placed.iter().map(|level| (level.size.columns, level.size.rows, level.first)).collect();
        assert_eq!(sizes, [(9, 4, 0), (5, 3, 0), (3, 2, 5), (2, 2, 8)]);
        assert_eq!(levels(1, 1).len(), 1);
        assert!(levels(u32::MAX, 2).len() <= MOST_LEVELS);
    }

    #[test]
    fn packing_keeps_the_bits_of_heights_and_the_shares_to_a_thousandth() {
        let post = GroundPost {
            height_m: -1234.567,
            slope_east: 0.1,
            slope_north: -3.5,
            sun_visibility: 1.0,
            sky_visibility: 0.25,
            water: 0.75,
        };
        let [height, east, north, shares] = packed(&post);
        assert_eq!([height, east, north].map(f32::from_bits), [-1234.567, 0.1, -3.5]);
        let shares = [(shares & 4095, 4095.0), (shares >> 12 & 1023, 1023.0), (shares >> 22, 1022.0)];
        for ((share, most), wanted) in shares.into_iter().zip([1.0, 0.25, 0.875]) {
            assert!((f64::from(share) / most - wanted).abs() < 1e-3, "{share} of {most}");
        }
    }
}
