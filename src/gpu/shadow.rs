//! The shadow maps as textures: the tables of both with their pages' numbers, and the texels of all pages. The processor's
//! are uploaded; others are drawn to (`shadow_maps`).

use bytemuck::{Pod, Zeroable, cast_slice};

use crate::error::GpuError;
use crate::memory::{Loader, texture};
use sandtable_render::shadow::plan::ShadowPlan;
use sandtable_render::shadow::{MOST_LEVELS, PAGE, ShadowMap, ShadowTexel, Shadows};

/// Table entries in a row of their texture; the shader's constant of the same name.
const TABLE_COLUMNS: u32 = 1024;

/// Pages in a row of theirs; the shader's constant of the same name.
pub const PAGE_COLUMNS: u32 = 64;

/// The formats of both textures.
pub const TABLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
pub const TEXEL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;

/// The constants of a map: `ShadowView` in the shader; zero where there is none.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct ShadowView {
    eye: [f32; 4],
    forward: [f32; 4],
    across: [[f32; 4]; 2],
    toward: [f32; 4],
    levels: [[f32; 4]; MOST_LEVELS],
    tables: [[u32; 4]; MOST_LEVELS],
}

#[derive(Debug)]
pub struct ShadowTextures {
    pub pages: wgpu::Texture,
    pub texels: wgpu::Texture,
}

impl ShadowView {
    /// The constants of the sun's map and of the sky's, whose entries lie after the sun's.
    pub fn both([sun, sky]: [Option<&ShadowMap>; 2]) -> [Self; 2] {
        let after = sun.map_or(0, |map| map.pages.len());
        let view = |map: Option<&ShadowMap>, first: usize| {
            map.map_or_else(Self::zeroed, |map| Self::new(map, first as u32))
        };
        [view(sun, 0), view(sky, after)]
    }

    fn new(map: &ShadowMap, first: u32) -> Self {
        let [right, ahead] = map.axes.across;
        let mut view = Self {
            eye: map.eye.extend(0.0).to_array(),
            forward: map.forward.extend(0.0).to_array(),
            across: [
                right.extend(map.scale.texel_per_depth).to_array(),
                ahead.extend(map.scale.least as f32).to_array(),
            ],
            toward: map.axes.toward.extend(map.levels.len() as f32).to_array(),
            ..Self::zeroed()
        };
        for (index, level) in map.levels.iter().enumerate() {
            view.levels[index] = [level.origin[0], level.origin[1], level.texel_m, 0.0];
            view.tables[index] = [level.columns, level.rows, level.first + first, 0];
        }
        view
    }
}

impl ShadowTextures {
    /// Sends the maps to the device; without any, one texel each that nothing reads.
    pub fn upload(loader: &Loader<'_>, shadows: &Shadows) -> Result<Self, GpuError> {
        let maps = || shadows.maps().into_iter().flatten();
        let mut table: Vec<[u32; 4]> = Vec::new();
        let mut before = 0;
        for map in maps() {
            table.extend(map.pages.iter().map(|page| {
                let number = if page.number > 0 { page.number + before } else { 0 };
                [number, page.highest.solid.to_bits(), page.highest.ground.to_bits(), 0]
            }));
            before += map.texels.len() as u32 / (PAGE * PAGE);
        }
        let texels: Vec<&[ShadowTexel]> = maps().map(|map| map.texels.as_slice()).collect();
        Ok(Self { pages: page_table(loader, table)?, texels: page_texels(loader, &texels.concat())? })
    }

    /// Textures that the device is to draw the maps to.
    pub fn to_draw(loader: &Loader<'_>, plan: &ShadowPlan) -> Result<Self, GpuError> {
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let maps = || plan.maps().into_iter().flatten();
        let entries = maps().map(|map| map.map.pages.len()).sum();
        let stored = maps().map(|map| map.stored).sum();
        let pages = table_texture(loader, entries, usage)?;
        Ok(Self { pages, texels: texel_texture(loader, stored, usage)? })
    }
}

fn page_table(loader: &Loader<'_>, mut table: Vec<[u32; 4]>) -> Result<wgpu::Texture, GpuError> {
    let texture = table_texture(loader, table.len(), wgpu::TextureUsages::empty())?;
    let (width, height) = (texture.width(), texture.height());
    table.resize((width * height) as usize, [0; 4]);
    loader.gpu.write(texture.as_image_copy(), width, height, cast_slice(&table));
    Ok(texture)
}

/// A texture for the table of so many pages.
fn table_texture(
    loader: &Loader<'_>,
    pages: usize,
    usage: wgpu::TextureUsages,
) -> Result<wgpu::Texture, GpuError> {
    let rows = pages.div_ceil(TABLE_COLUMNS as usize).max(1);
    let mut descriptor = texture("table of shadow pages", TABLE_COLUMNS, rows as u32, TABLE_FORMAT);
    descriptor.usage |= usage;
    loader.texture(|| format!("the table of {pages} shadow pages"), &descriptor)
}

/// A texture for so many stored pages.
fn texel_texture(
    loader: &Loader<'_>,
    pages: u32,
    usage: wgpu::TextureUsages,
) -> Result<wgpu::Texture, GpuError> {
    let size = [PAGE_COLUMNS * PAGE, pages.div_ceil(PAGE_COLUMNS).max(1) * PAGE];
    let mut descriptor = texture("shadow pages", size[0], size[1], TEXEL_FORMAT);
    descriptor.usage |= usage;
    loader.texture(|| format!("{pages} shadow pages"), &descriptor)
}

/// The pages beside each other, [`PAGE_COLUMNS`] in a row.
fn page_texels(loader: &Loader<'_>, texels: &[ShadowTexel]) -> Result<wgpu::Texture, GpuError> {
    let pages = texels.len() as u32 / (PAGE * PAGE);
    let texture = texel_texture(loader, pages, wgpu::TextureUsages::empty())?;
    let size = [texture.width(), texture.height()];
    let row_of_pages = (PAGE_COLUMNS * PAGE * PAGE) as usize;
    for (row, texels) in texels.chunks(row_of_pages).enumerate() {
        let mut lines = vec![ShadowTexel::EMPTY; row_of_pages];
        for (index, &texel) in texels.iter().enumerate() {
            let [page, y, x] =
                [index as u32 / (PAGE * PAGE), index as u32 / PAGE % PAGE, index as u32 % PAGE];
            lines[(y * size[0] + page * PAGE + x) as usize] = texel;
        }
        let mut to = texture.as_image_copy();
        to.origin.y = row as u32 * PAGE;
        loader.gpu.write(to, size[0], PAGE, cast_slice(&lines));
    }
    Ok(texture)
}
