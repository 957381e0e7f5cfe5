//! Windows of finer posts of the ground as one texture, one under the other.

use std::sync::Arc;

use bytemuck::cast_slice;
use rayon::prelude::*;

use crate::error::GpuError;
use crate::ground::packed;
use crate::memory::{Loader, texture};
use sandtable_draw::ground::GroundMapError;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_draw::list::DrawListError;

/// The length of the shader's array.
pub const MOST_WINDOWS: usize = 8;

/// Posts are sent in portions of about this many bytes: while one is copied, no frame can be sent.
const WINDOW_PORTION_BYTES: u32 = 1 << 20;

/// The place of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowPlace {
    /// The column and the row of its first post, counted in its own posts.
    pub first: [u32; 2],
    /// Posts per row, and rows.
    pub size: [u32; 2],
    /// Rows of the texture from one window to the next.
    pub rows_apart: u32,
}

/// The windows on the device.
#[derive(Clone, Debug)]
pub struct WindowTexture {
    posts: wgpu::Texture,
    places: Vec<WindowPlace>,
}

impl WindowTexture {
    /// Sends windows, each with half the distance between the posts of the one before, as many as a texture holds; without
    /// any, a texel that nothing reads.
    pub fn upload(loader: &Loader<'_>, windows: &[Arc<GroundWindow>]) -> Result<Self, GpuError> {
        let size = |window: &Arc<GroundWindow>| {
            window.size().ok_or_else(|| {
                let error = GroundMapError::PostCount(window.columns, 0, window.posts.len());
                GpuError::List(DrawListError::GroundMap(error))
            })
        };
        let sizes = windows.iter().map(size).collect::<Result<Vec<_>, _>>()?;
        let most = |axis: usize| sizes.iter().map(|size| size[axis]).max().unwrap_or(1);
        let (width, rows_apart) = (most(0), most(1));
        let fitting = (loader.gpu.limits.max_texture_dimension_2d / rows_apart) as usize;
        let windows = &windows[..windows.len().min(fitting).min(MOST_WINDOWS)];
        let height = rows_apart * windows.len().max(1) as u32;
        let what = || format!("{} windows of finer ground", windows.len());
        let descriptor = texture("windows of finer ground", width, height, wgpu::TextureFormat::Rgba32Uint);
        let posts = loader.texture(what, &descriptor)?;
        let mut places = Vec::new();
        for (window, size) in windows.iter().zip(sizes) {
            let row = places.len() as u32 * rows_apart;
            send(loader, &posts, row, window)?;
            places.push(WindowPlace { first: window.first, size, rows_apart });
        }
        Ok(Self { posts, places })
    }

    /// Their posts.
    pub fn posts(&self) -> &wgpu::Texture {
        &self.posts
    }

    /// The places of the windows, the coarsest first.
    pub fn places(&self) -> &[WindowPlace] {
        &self.places
    }
}

/// Fills the texture from `row` on with the posts of a window.
fn send(
    loader: &Loader<'_>,
    posts: &wgpu::Texture,
    mut row: u32,
    window: &GroundWindow,
) -> Result<(), GpuError> {
    let row_bytes = window.columns * size_of::<[u32; 4]>() as u32;
    let rows = (WINDOW_PORTION_BYTES / row_bytes).max(1);
    for portion in window.posts.chunks((rows * window.columns) as usize) {
        let texels: Vec<[u32; 4]> = portion.par_iter().with_min_len(1024).map(packed).collect();
        let sent = portion.len() as u32 / window.columns;
        let mut to = posts.as_image_copy();
        to.origin.y = row;
        loader.gpu.write(to, window.columns, sent, cast_slice(&texels));
        loader.count_sent(u64::from(sent * row_bytes))?;
        row += sent;
    }
    Ok(())
}
