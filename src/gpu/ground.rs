//! The ground map as textures: the map itself and the coarser levels from which far ground is read.
//!
//! They are not mip levels of the device, which would halve rounding down: `n` posts become `n / 2 + 1`. All posts lie one
//! after the other, row by row and level by level, in a texture whose rows have nothing to do with theirs:
//!
//! ```text
//! ┌─────────────────┐
//! │0000000000000000 │  level 0 …
//! │0000000011111122 │  … then 1, 2, …, then the tops of blocks
//! └─────────────────┘
//! ```
//!
//! So a map may have more columns than a texture, and one reading serves all levels. The tops of blocks, over which the rays
//! pass that water mirrors ([`GroundTops`]), follow in the same way: a twelfth as many.
//!
//! Texels are integers that hold the bits of floats. Every adapter can read them and none may filter them, so that the
//! interpolation in the shader is the same everywhere.

use std::iter::successors;

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::memory::{Loader, texture};
use sandtable_draw::ground::{GroundMap, GroundPost};
use sandtable_draw::ground_levels::{PostCount, coarser_levels};
use sandtable_draw::ground_tops::GroundTops;

/// More levels than the largest texture has; the length of the shader's array.
pub const MOST_LEVELS: usize = 24;

/// Posts are sent in portions of about this many bytes, so that a large map is never held three times.
const PORTION_BYTES: usize = 16 << 20;

/// The binary logarithm of the most texels in a row.
const MOST_ROW_BITS: u32 = 13;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedLevel {
    pub size: PostCount,
    /// Its first post among those of all levels; less than 2^32 wherever a texture holds them.
    pub first: u32,
}

#[derive(Debug)]
pub struct GroundTextures {
    pub posts: wgpu::Texture,
}

/// Fills a texture texel by texel.
struct TexelWriter<'a> {
    loader: &'a Loader<'a>,
    texture: &'a wgpu::Texture,
    row: u32,
    /// What does not fill a row yet.
    pending: Vec<[u32; 4]>,
}

/// The binary logarithm of the texels in a row of the texture, on an adapter with textures of at most `largest` a side.
pub fn row_bits(largest: u32) -> u32 {
    largest.max(1).ilog2().min(MOST_ROW_BITS)
}

/// The levels of a map of `size`, down to two posts a side.
pub fn levels(size: PostCount) -> Vec<PlacedLevel> {
    let next = |last: &PlacedLevel| last.size.halved().map(|size| PlacedLevel { size, first: last.end() });
    successors(Some(PlacedLevel { size, first: 0 }), next).take(MOST_LEVELS).collect()
}

/// The levels of the tops of a map of `size`, which lie behind its posts.
pub fn top_levels(size: PostCount) -> Vec<PlacedLevel> {
    let mut first = levels(size).last().map_or(0, PlacedLevel::end);
    let placed = GroundTops::sizes(size).map(|blocks| {
        let level = PlacedLevel { size: PostCount { columns: blocks.x, rows: blocks.y }, first };
        first = level.end();
        level
    });
    placed.take(MOST_LEVELS).collect()
}

impl PlacedLevel {
    /// The number after that of its last texel.
    fn end(&self) -> u32 {
        self.first.saturating_add(self.size.columns.saturating_mul(self.size.rows))
    }
}

impl GroundTextures {
    /// Sends a checked map to the device; without a map, texels that nothing reads.
    pub fn upload(loader: &Loader<'_>, map: Option<&GroundMap>) -> Result<Self, GpuError> {
        let levels = map.map_or_else(Vec::new, |map| levels(PostCount::from_map(map)));
        let tops = map.map_or_else(Vec::new, |map| top_levels(PostCount::from_map(map)));
        let posts_of = |level: &PlacedLevel| u64::from(level.size.columns) * u64::from(level.size.rows);
        let count = levels.iter().chain(&tops).map(posts_of).sum::<u64>().max(1);
        let width = 1 << row_bits(loader.gpu.limits.max_texture_dimension_2d);
        let rows = u32::try_from(count.div_ceil(u64::from(width))).unwrap_or(u32::MAX);
        let what = || format!("the {count} posts of the ground map and its coarser levels");
        let format = wgpu::TextureFormat::Rgba32Uint;
        let posts = loader.texture(what, &texture("ground posts", width, rows, format))?;
        if let Some(map) = map {
            let mut writer = TexelWriter { loader, texture: &posts, row: 0, pending: Vec::new() };
            writer.write(&map.posts)?;
            for (_, level) in levels[1..].iter().zip(coarser_levels(map)) {
                writer.write(&level.posts)?;
            }
            for level in &GroundTops::new(map).levels {
                writer.write_tops(&level.heights_m)?;
            }
            writer.finish()?;
        }
        Ok(Self { posts })
    }
}

impl GroundTextures {
    /// Replaces the posts from number `first` on; returns the bytes sent.
    pub fn write(&self, gpu: &Gpu, first: u32, posts: &[GroundPost]) -> u64 {
        let width = self.posts.width();
        let texels: Vec<[u32; 4]> = posts.iter().map(packed).collect();
        let (mut left, mut next) = (texels.as_slice(), first);
        while !left.is_empty() {
            let in_row = ((width - next % width) as usize).min(left.len());
            let mut to = self.posts.as_image_copy();
            (to.origin.x, to.origin.y) = (next % width, next / width);
            gpu.write(to, in_row as u32, 1, cast_slice(&left[..in_row]));
            left = &left[in_row..];
            next += in_row as u32;
        }
        (texels.len() * size_of::<[u32; 4]>()) as u64
    }
}

impl TexelWriter<'_> {
    fn write(&mut self, posts: &[GroundPost]) -> Result<(), GpuError> {
        for posts in posts.chunks(PORTION_BYTES / size_of::<[u32; 4]>()) {
            self.pending.par_extend(posts.par_iter().with_min_len(1024).map(packed));
            self.send()?;
        }
        Ok(())
    }

    fn write_tops(&mut self, heights_m: &[f32]) -> Result<(), GpuError> {
        // Shaders need not know infinities.
        self.pending.extend(heights_m.iter().map(|height_m| [height_m.max(-1e30).to_bits(), 0, 0, 0]));
        self.send()
    }

    /// Sends the rows that are full.
    fn send(&mut self) -> Result<(), GpuError> {
        let width = self.texture.width();
        let rows = self.pending.len() as u32 / width;
        if rows == 0 {
            return Ok(());
        }
        let texels = (rows * width) as usize;
        let mut to = self.texture.as_image_copy();
        to.origin.y = self.row;
        self.loader.gpu.write(to, width, rows, cast_slice(&self.pending[..texels]));
        self.loader.count_sent((texels * size_of::<[u32; 4]>()) as u64)?;
        self.pending.drain(..texels);
        self.row += rows;
        Ok(())
    }

    fn finish(&mut self) -> Result<(), GpuError> {
        let width = self.texture.width() as usize;
        self.pending.resize(self.pending.len().next_multiple_of(width), [0; 4]);
        self.send()
    }
}

/// Height and slopes as bits, then the visibility of the sun in 11 bits, that of the sky in 11, from 0 to 2, and water in 10, from
/// −1 (woods) to 1.
pub fn packed(post: &GroundPost) -> [u32; 4] {
    let share = |share: f32, most: f32| (share.clamp(0.0, 1.0) * most + 0.5) as u32;
    [
        post.height_m.to_bits(),
        post.slope_east.to_bits(),
        post.slope_north.to_bits(),
        share(post.sun_visibility, 2047.0)
            | share(post.sky_visibility / GroundPost::MOST_SKY, 2046.0) << 11
            | share(post.water * 0.5 + 0.5, 1022.0) << 22,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_shrink_to_two_posts_a_side_and_lie_one_after_the_other() {
        let levels = |columns, rows| levels(PostCount { columns, rows });
        let placed = levels(9, 4);
        let sizes: Vec<_> =
            placed.iter().map(|level| (level.size.columns, level.size.rows, level.first)).collect();
        assert_eq!(sizes, [(9, 4, 0), (5, 3, 36), (3, 2, 51), (2, 2, 57)]);
        let tops = top_levels(PostCount { columns: 9, rows: 4 });
        let placed: Vec<_> =
            tops.iter().map(|level| (level.size.columns, level.size.rows, level.first)).collect();
        assert_eq!(placed, [(2, 1, 61), (1, 1, 63)]);
        assert_eq!(levels(1, 1).len(), 1);
        assert!(levels(u32::MAX, 2).len() <= MOST_LEVELS);
        assert_eq!([1, 2048, 16_384, 40_000].map(row_bits), [0, 11, 13, 13]);
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
        let shares = [(shares & 2047, 2047.0), (shares >> 11 & 2047, 1023.0), (shares >> 22, 1022.0)];
        for ((share, most), wanted) in shares.into_iter().zip([1.0, 0.25, 0.875]) {
            assert!((f64::from(share) / most - wanted).abs() < 1e-3, "{share} of {most}");
        }
    }
}
