//! The deterministic renderer: needs nothing but the processor, and gives the same bytes on every platform and for
//! every number of threads.
//!
//! # How
//! ```text
//! DrawList ──geometry──▶ faces, pieces ──band──▶ tiles of 64×64 ──visibility──▶ the face each sample sees
//!            plane, clip, raster::snapped              raster, pattern, occlusion     │
//!                                                                 blend ◀─────────────┤
//!                        Picture ◀──band── pixels ◀──tile::resolve── shade ◀──────────┘
//!                                                  cutout, alpha     hit, ground_shade, texture
//!                                                                         ▲
//! DrawList ──────── shadow maps of the sun and of the sky (../shadow) ────┘
//! ```
//! Coverage is integer arithmetic on snapped corners. Depth and attributes come from the exact planes of the unsnapped
//! triangles in f64, so that a road cut from the ground's triangles has exactly the ground's depth. Shading runs once
//! per pixel and face, as in multisampling, at the mean of the samples that the face covers. Tiles are independent and
//! are drawn in parallel on the current `rayon` pool. Within a tile ground and drapes keep the list's order. Solids
//! are drawn from the nearest on, and hidden ones are skipped; the picture does not depend on their order.
//!
//! Draped faces follow [`sandtable_draw::list::DepthLayer`], with a tolerance widened where f32 corners far from the
//! origin round by more than it. Masked surfaces are tested at each sample that nothing nearer covers. Transparent
//! surfaces are sorted per pixel, up to 32 deep, and blended over each sample in linear light.
//!
//! # Cost
//! Shading takes two thirds of the time and more, shadows where solids are a tenth of that; the rest is triangles (three
//! corners projected, three planes) and one depth test per covered sample. Eight samples per pixel take a third more time
//! than one. Memory: 12 bytes per pixel for the picture; 150 bytes per visible triangle; for each band of 64 rows in work
//! 12 bytes per pixel and 52 per triangle in it; for each thread 0.3 MiB, and up to 2 MiB more under transparent
//! surfaces; a third of each texture and of the ground map for their coarser levels, and as much again of a texture with
//! holes for its alpha; the shadow maps.

pub(crate) mod alpha;
mod band;
mod blend;
mod clip;
pub mod contour_cover;
mod cutout;
mod geometry;
mod ground_shade;
mod hit;
mod occlusion;
pub(crate) mod pattern;
mod plane;
pub(crate) mod raster;
mod screen;
mod shade;
mod texture;
mod tile;
mod visibility;

use rayon::prelude::*;

use crate::cpu::band::{BandRows, draw_band};
use crate::cpu::geometry::ScreenGeometry;
use crate::cpu::pattern::{EIGHT, FOUR, ONE, SamplePattern};
use crate::cpu::screen::Screen;
use crate::cpu::shade::Shader;
use crate::cpu::tile::TileContext;
use crate::cpu::visibility::TILE;
use crate::picture::Rendering;
use crate::shadow::Shadows;
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawList, DrawListError, FeatureId};
use sandtable_draw::pixels::Pixels;
use sandtable_view::camera::Camera;

/// Samples and filter of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderQuality {
    /// Samples per pixel. Default: eight.
    pub samples: SampleCount,
    /// The most readings of a texture or of the ground map along a pixel seen at a grazing angle, 1..=16; values
    /// outside are clamped. Default: 8.
    pub anisotropy: u32,
}

/// The number of samples per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleCount {
    /// Once, at the center: jagged, for drafts.
    One,
    /// Four times.
    Four,
    /// Eight times.
    Eight,
}

/// Why the CPU renderer gives no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CpuRenderError {
    /// [`DrawList::check`] failed.
    #[error("the draw list is unsound: {0}")]
    List(#[from] DrawListError),
    /// There is not enough memory for the picture.
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
    /// There are too many triangles.
    #[error("the draw list draws {0} triangles, the most is 4294965000; draw fewer or coarser meshes")]
    TooManyTriangles(usize),
}

impl Default for RenderQuality {
    fn default() -> Self {
        Self { samples: SampleCount::Eight, anisotropy: 8 }
    }
}

/// The picture of `list` as `camera` sees it, drawn on the current `rayon` pool.
///
/// Triangles with corners that are not finite are left out.
///
/// # Errors
/// See [`CpuRenderError`].
pub fn render(
    list: &DrawList,
    camera: &Camera,
    quality: &RenderQuality,
) -> Result<Rendering, CpuRenderError> {
    list.check()?;
    check_memory(bytes_of(list, camera), "the picture", "draw a smaller one")?;
    let screen = Screen::new(camera);
    let geometry = geometry(list, &screen)?;
    let shadows = Shadows::new(list, camera)?;
    let shader = Shader::new(list, &screen, &shadows, quality.anisotropy.clamp(1, 16));
    Ok(match quality.samples {
        SampleCount::One => draw(&screen, &geometry, &shader, &ONE, true),
        SampleCount::Four => draw(&screen, &geometry, &shader, &FOUR, true),
        SampleCount::Eight => draw(&screen, &geometry, &shader, &EIGHT, true),
    })
}

/// About how much memory the picture of a list takes but for its shadow maps, which ask for their own: see the module.
fn bytes_of(list: &DrawList, camera: &Camera) -> u64 {
    const PER_PIXEL: u64 = 12;
    const PER_TRIANGLE: u64 = 150;
    let (width, height) = camera.size();
    // Coarser levels of a texture are a third of its four bytes a pixel.
    let texels: usize = list.textures.iter().map(|texture| texture.data().len()).sum();
    u64::from(width) * u64::from(height) * PER_PIXEL
        + list.triangle_count() as u64 * PER_TRIANGLE
        + texels as u64 * 4 / 3
}

/// The depths and features of [`render`], to the bit, without light, shadows and colors: the pixels are white.
///
/// # Errors
/// See [`CpuRenderError`].
pub fn render_buffers(list: &DrawList, camera: &Camera) -> Result<Rendering, CpuRenderError> {
    list.check()?;
    let screen = Screen::new(camera);
    let geometry = geometry(list, &screen)?;
    let shadows = Shadows::default();
    let shader = Shader::new(list, &screen, &shadows, RenderQuality::default().anisotropy);
    Ok(draw(&screen, &geometry, &shader, &EIGHT, false))
}

fn geometry(list: &DrawList, screen: &Screen) -> Result<ScreenGeometry, CpuRenderError> {
    ScreenGeometry::new(list, screen).ok_or_else(|| CpuRenderError::TooManyTriangles(list.triangle_count()))
}

fn draw<const N: usize>(
    screen: &Screen,
    geometry: &ScreenGeometry,
    shader: &Shader,
    pattern: &SamplePattern<N>,
    is_colored: bool,
) -> Rendering {
    let frame = TileContext { screen, geometry, shader, pattern, is_colored };
    let [width, height] = screen.size;
    let (count, band) = (width as usize * height as usize, (width * TILE) as usize);
    let mut pixels = Pixels::filled(width, height, Srgba::WHITE);
    let mut depth_m = vec![f32::INFINITY; count];
    let mut features = vec![FeatureId::NONE; count];
    pixels
        .data_mut()
        .par_chunks_mut(band)
        .zip(depth_m.par_chunks_mut(band))
        .zip(features.par_chunks_mut(band))
        .enumerate()
        .for_each(|(number, ((colors, depths_m), features))| {
            draw_band(&frame, number as u32, BandRows { colors, depths_m, features });
        });
    Rendering { pixels, depth_m, features }
}
