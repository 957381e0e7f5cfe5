//! The ground map as textures: the map itself and the smaller levels that far ground is read from.
//!
//! A far pixel spans many posts, and one reading would make hillshade sparkle; so there are levels of every
//! second post, each smoothed from the one before (Williams, "Pyramidal Parametrics", 1983), by the same
//! rule as the CPU renderer's. They are no mip levels to the device: `n` posts become `n / 2 + 1`, so that
//! posts stay where they are, while mip levels would halve rounding down. The smaller ones lie side by side
//! in a texture of their own:
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

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::draw::ground::{GroundMap, GroundPost};
use crate::render::gpu::adapter::Gpu;
use crate::render::gpu::error::GpuError;

/// More levels than the largest texture has; the shader's array is as long.
pub(in crate::render::gpu) const MOST_LEVELS: usize = 24;

/// Posts are sent in portions of about this many bytes, so that a large map is never held three times over.
const PORTION_BYTES: usize = 16 << 20;

/// Every second post counts half, its neighbours a quarter each.
const KERNEL: [(usize, f32); 3] = [(0, 0.25), (1, 0.5), (2, 0.25)];

/// One level of the pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::render::gpu) struct Level {
    /// Posts per row.
    pub columns: u32,
    /// Rows of posts.
    pub rows: u32,
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

/// The levels of a map of `columns` × `rows` posts, down to two posts a side.
pub(in crate::render::gpu) fn levels(columns: u32, rows: u32) -> Vec<Level> {
    let mut levels = vec![Level { columns, rows, first: 0 }];
    while let Some(&last) = levels.last()
        && (last.columns > 2 || last.rows > 2)
        && levels.len() < MOST_LEVELS
    {
        let first = if levels.len() == 1 { 0 } else { last.first + last.columns };
        levels.push(Level { columns: last.columns / 2 + 1, rows: last.rows / 2 + 1, first });
    }
    levels
}

/// What is wrong with a ground map, in words; `None` where it can be read.
pub(in crate::render::gpu) fn fault(map: &GroundMap) -> Option<String> {
    let posts = u64::from(map.columns) * u64::from(map.rows);
    if posts == 0 || posts != map.posts.len() as u64 {
        let (columns, rows, held) = (map.columns, map.rows, map.posts.len());
        return Some(format!("the ground map of {columns}×{rows} posts holds {held}"));
    }
    let sound = map.cell.min_element() > 0.0 && map.cell.is_finite() && map.origin.is_finite();
    (!sound).then(|| format!("the ground map has cells of {} m from {}", map.cell, map.origin))
}

impl GroundTextures {
    /// Sends a map without [`fault`] to the device; without a map, one texel that nothing reads.
    ///
    /// # Errors
    /// [`GpuError::GroundSize`].
    pub fn upload(gpu: &Gpu, map: Option<&GroundMap>) -> Result<Self, GpuError> {
        let levels = map.map_or_else(Vec::new, |map| levels(map.columns, map.rows));
        let size = |level: Option<&Level>, columns: u32| level.map_or((1, 1), |level| (columns, level.rows));
        let posts_size = size(levels.first(), levels.first().map_or(1, |level| level.columns));
        let coarse_size = size(levels.get(1), levels.last().map_or(1, |last| last.first + last.columns));
        let limit = gpu.limits.max_texture_dimension_2d;
        let (columns, rows) = posts_size;
        if columns.max(rows).max(coarse_size.0) > limit {
            return Err(GpuError::GroundSize { columns, rows, limit, adapter: gpu.name().into() });
        }
        let textures = Self { posts: texture(gpu, posts_size), coarse: texture(gpu, coarse_size) };
        if let Some(map) = map {
            textures.fill(gpu, map, &levels);
        }
        Ok(textures)
    }

    fn fill(&self, gpu: &Gpu, map: &GroundMap, levels: &[Level]) {
        write(gpu, &self.posts, &levels[0], &map.posts);
        let mut finer: Option<Vec<GroundPost>> = None;
        for pair in levels.windows(2) {
            let coarser = halved(&pair[0], finer.as_deref().unwrap_or(&map.posts), &pair[1]);
            write(gpu, &self.coarse, &pair[1], &coarser);
            finer = Some(coarser);
        }
    }
}

fn texture(gpu: &Gpu, (width, height): (u32, u32)) -> wgpu::Texture {
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

fn write(gpu: &Gpu, texture: &wgpu::Texture, level: &Level, posts: &[GroundPost]) {
    let stride = level.columns as usize;
    let row_bytes = stride * size_of::<[u32; 4]>();
    let portion = (PORTION_BYTES / row_bytes).max(1);
    let mut to = texture.as_image_copy();
    to.origin.x = level.first;
    for posts in posts.chunks(portion * stride) {
        let texels: Vec<[u32; 4]> = posts.par_iter().with_min_len(1024).map(packed).collect();
        let height = (posts.len() / stride) as u32;
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row_bytes as u32),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d { width: level.columns, height, depth_or_array_layers: 1 };
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

/// The posts of `to`, the level after `from`.
fn halved(from: &Level, posts: &[GroundPost], to: &Level) -> Vec<GroundPost> {
    let (columns, rows, stride) = (from.columns as usize, from.rows as usize, to.columns as usize);
    // Past the border, the border's posts stand in.
    let neighbour =
        |index: usize, step: usize, count: usize| (2 * index + step).saturating_sub(1).min(count - 1);
    let post = |index: usize| {
        let mut sum = GroundPost::default();
        for (down, height) in KERNEL {
            let line = neighbour(index / stride, down, rows) * columns;
            for (across, width) in KERNEL {
                add(&mut sum, &posts[line + neighbour(index % stride, across, columns)], height * width);
            }
        }
        sum
    };
    (0..stride * to.rows as usize).into_par_iter().with_min_len(1024).map(post).collect()
}

fn add(sum: &mut GroundPost, post: &GroundPost, weight: f32) {
    sum.height_m += post.height_m * weight;
    sum.slope_east += post.slope_east * weight;
    sum.slope_north += post.slope_north * weight;
    sum.sun_visibility += post.sun_visibility * weight;
    sum.sky_visibility += post.sky_visibility * weight;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_shrink_to_two_posts_a_side_and_lie_side_by_side() {
        let of_nine = levels(9, 4);
        let sizes: Vec<_> = of_nine.iter().map(|level| (level.columns, level.rows, level.first)).collect();
        assert_eq!(sizes, [(9, 4, 0), (5, 3, 0), (3, 2, 5), (2, 2, 8)]);
        assert_eq!(levels(1, 1).len(), 1);
        assert!(levels(u32::MAX, 2).len() <= MOST_LEVELS);
    }

    #[test]
    fn a_plane_stays_a_plane_on_every_level_away_from_the_border() {
        let of_map = levels(33, 17);
        let height = |column: u32, row: u32| column as f32 * 3.0 - row as f32;
        let plane = |level: &Level, step: u32| -> Vec<GroundPost> {
            (0..level.columns * level.rows)
                .map(|index| GroundPost {
                    height_m: height(index % level.columns * step, index / level.columns * step),
                    ..Default::default()
                })
                .collect()
        };
        let (posts, expected) = (plane(&of_map[0], 1), plane(&of_map[1], 2));
        let coarser = halved(&of_map[0], &posts, &of_map[1]);
        let columns = of_map[1].columns as usize;
        for (index, (post, plane)) in coarser.iter().zip(&expected).enumerate() {
            let (column, row) = (index % columns, index / columns);
            if (1..columns - 1).contains(&column) && (1..7).contains(&row) {
                assert_eq!(post.height_m, plane.height_m, "{column}, {row}");
            }
        }
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
