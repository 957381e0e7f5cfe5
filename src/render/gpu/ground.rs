//! The ground map as textures: the map itself and the smaller levels that far ground is read from.
//!
//! They are no mip levels to the device, which would halve rounding down: `n` posts become `n / 2 + 1`. The
//! smaller ones lie side by side in a texture of their own:
//!
//! ```text
//!   posts          coarse
//! ┌───────────┐  ┌──────┬───┬─┐
//! │  level 0  │  │  1   │ 2 │…│
//! │           │  │      ├───┴─┘
//! └───────────┘  └──────┘
//! ```
//!
//! Texels are integers holding the bits of floats: every adapter can read them and none may filter them, so
//! that what the shader interpolates by hand is the same everywhere.

use std::iter::successors;

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::draw::ground::{GroundMap, GroundPost};
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::ground_levels::{PostCount, smaller_levels};

/// More levels than the largest texture has; the shader's array is as long.
pub(in crate::render::gpu) const MOST_LEVELS: usize = 24;

/// Posts are sent in portions of about this many bytes, so that a large map is never held three times over.
const PORTION_BYTES: usize = 16 << 20;

/// A level and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render::gpu) struct PlacedLevel {
    /// How many posts.
    pub size: PostCount,
    /// Its first column in the texture that holds it.
    pub first: u32,
}

/// The textures of a ground map.
#[derive(Debug)]
pub(in crate::render::gpu) struct GroundTextures {
    /// Level 0.
    pub posts: wgpu::Texture,
    /// All further levels.
    pub coarse: wgpu::Texture,
}

/// The levels of a map of `size`, down to two posts a side.
pub(in crate::render::gpu) fn levels(size: PostCount) -> Vec<PlacedLevel> {
    let next = |last: &PlacedLevel| {
        let first = if last.size == size { 0 } else { last.first + last.size.columns };
        last.size.halved().map(|size| PlacedLevel { size, first })
    };
    successors(Some(PlacedLevel { size, first: 0 }), next).take(MOST_LEVELS).collect()
}

impl GroundTextures {
    /// Sends a map, which has passed its check, to the device; without a map, one texel that nothing reads.
    ///
    /// # Errors
    /// [`GpuError::GroundSize`].
    pub fn upload(gpu: &Gpu, map: Option<&GroundMap>) -> Result<Self, GpuError> {
        let levels = map.map_or_else(Vec::new, |map| levels(PostCount::from_map(map)));
        let one = PostCount { columns: 1, rows: 1 };
        let posts_size = levels.first().map_or(one, |level| level.size);
        let coarse_size = match (levels.get(1), levels.last()) {
            (Some(largest), Some(last)) => {
                PostCount { columns: last.first + last.size.columns, ..largest.size }
            }
            _ => one,
        };
        let limit = gpu.limits.max_texture_dimension_2d;
        let PostCount { columns, rows } = posts_size;
        if columns.max(rows).max(coarse_size.columns) > limit {
            return Err(GpuError::GroundSize { columns, rows, limit, adapter: gpu.name().into() });
        }
        let textures = Self { posts: texture(gpu, posts_size), coarse: texture(gpu, coarse_size) };
        if let Some(map) = map {
            textures.fill(gpu, map, &levels);
        }
        Ok(textures)
    }

    fn fill(&self, gpu: &Gpu, map: &GroundMap, levels: &[PlacedLevel]) {
        write(gpu, &self.posts, &levels[0], &map.posts);
        for (place, level) in levels[1..].iter().zip(smaller_levels(map)) {
            write(gpu, &self.coarse, place, &level.posts);
        }
    }
}

fn texture(gpu: &Gpu, PostCount { columns: width, rows: height }: PostCount) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("ground"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Uint,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, place: &PlacedLevel, posts: &[GroundPost]) {
    let stride = place.size.columns as usize;
    let row_bytes = stride * size_of::<[u32; 4]>();
    let portion = (PORTION_BYTES / row_bytes).max(1);
    let mut to = texture.as_image_copy();
    to.origin.x = place.first;
    for posts in posts.chunks(portion * stride) {
        let texels: Vec<[u32; 4]> = posts.par_iter().with_min_len(1024).map(packed).collect();
        let height = (posts.len() / stride) as u32;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes as u32),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width: place.size.columns, height, depth_or_array_layers: 1 };
        gpu.queue.write_texture(to, cast_slice(&texels), layout, size);
        to.origin.y += height;
    }
}

/// Height and slopes as bits, both visibilities as 16 bits each.
fn packed(post: &GroundPost) -> [u32; 4] {
    let sixteen = |share: f32| (share.clamp(0.0, 1.0) * 65535.0 + 0.5) as u32;
    [
        post.height_m.to_bits(),
        post.slope_east.to_bits(),
        post.slope_north.to_bits(),
        sixteen(post.sun_visibility) | sixteen(post.sky_visibility) << 16,
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
    fn packing_keeps_the_bits_of_heights_and_the_visibilities_to_16_bits() {
        let post = GroundPost {
            height_m: -1234.567,
            slope_east: 0.1,
            slope_north: -3.5,
            sun_visibility: 1.0,
            sky_visibility: 0.25,
        };
        let [height, east, north, visibilities] = packed(&post);
        assert_eq!([height, east, north].map(f32::from_bits), [-1234.567, 0.1, -3.5]);
        assert_eq!(visibilities & 0xffff, 65535);
        assert!((f64::from(visibilities >> 16) / 65535.0 - 0.25).abs() < 1e-5);
    }
}
