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
//! are drawn in parallel on the current `rayon` pool, the last in quarters. Within a tile ground and drapes keep the list's order. Solids
//! are drawn from the nearest on, and hidden ones are skipped; the picture does not depend on their order.
//!
//! Draped faces follow [`sandtable_draw::list::DepthLayer`], with a tolerance widened where f32 corners far from the
//! origin round by more than it. Masked surfaces are tested at each sample that nothing nearer covers. Transparent
//! surfaces are sorted per pixel, up to 32 deep, and blended over each sample in linear light.
//!
//! # Cost
//! Shading takes two thirds of the time and more, shadows where solids are a tenth of that; the rest is triangles (three
//! corners projected, three planes) and one depth test per covered sample. Eight samples per pixel take a third more time
//! than one. Memory: 12 bytes per pixel for the picture; 150 bytes per visible triangle of two strips; for each band of 64 rows in work
//! 12 bytes per pixel and 8 to 16 per triangle in it; for each thread 0.3 MiB, and up to 2 MiB more under transparent
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
mod strips;
mod texture;
mod tile;
mod visibility;

use rayon::iter::repeat_n;
use rayon::prelude::*;

use crate::cpu::band::{BandRows, TilesLeft, draw_band};
use crate::cpu::geometry::GeometrySource;
use crate::cpu::pattern::{EIGHT, FOUR, ONE, SamplePattern};
use crate::cpu::screen::Screen;
use crate::cpu::shade::Shader;
use crate::cpu::strips::RowStrips;
use crate::cpu::tile::TileContext;
use crate::cpu::visibility::TILE;
use crate::drawn_rows::DrawnRows;
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
    render_counted(list, camera, quality, &DrawnRows::default())
}

/// [`render`], which says how many rows it has drawn.
///
/// # Errors
/// See [`CpuRenderError`].
pub fn render_counted(
    list: &DrawList,
    camera: &Camera,
    quality: &RenderQuality,
    drawn: &DrawnRows,
) -> Result<Rendering, CpuRenderError> {
    list.check()?;
    check_memory(bytes_of(list, camera), "the picture", "draw a smaller one")?;
    let most_taps = quality.anisotropy.clamp(1, 16);
    match quality.samples {
        SampleCount::One => render_samples(list, camera, (&ONE, most_taps), drawn),
        SampleCount::Four => render_samples(list, camera, (&FOUR, most_taps), drawn),
        SampleCount::Eight => render_samples(list, camera, (&EIGHT, most_taps), drawn),
    }
}

/// The picture of a checked list with these samples and so many readings of a texture at the most.
fn render_samples<const N: usize>(
    list: &DrawList,
    camera: &Camera,
    (pattern, most_taps): (&SamplePattern<N>, u32),
    drawn: &DrawnRows,
) -> Result<Rendering, CpuRenderError> {
    let screen = Screen::new(camera);
    let source = source(list, &screen, pattern)?;
    // Before there are faces: what a map is made of takes as much memory as they do.
    let shadows = Shadows::new(list, camera)?;
    let shader = Shader::new(list, &screen, &shadows, most_taps);
    Ok(draw(&source, &RowStrips::new(&source), &shader, pattern, DrawnAs::Colors(drawn)))
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
    let source = source(list, &screen, &EIGHT)?;
    let shadows = Shadows::default();
    let shader = Shader::new(list, &screen, &shadows, RenderQuality::default().anisotropy);
    Ok(draw(&source, &RowStrips::new(&source), &shader, &EIGHT, DrawnAs::Shapes))
}

fn source<'a, const N: usize>(
    list: &'a DrawList,
    screen: &'a Screen,
    pattern: &SamplePattern<N>,
) -> Result<GeometrySource<'a>, CpuRenderError> {
    let source = GeometrySource::new(list, screen, pattern);
    source.ok_or_else(|| CpuRenderError::TooManyTriangles(list.triangle_count()))
}

/// What is drawn.
#[derive(Clone, Copy)]
enum DrawnAs<'a> {
    /// Colors, depths and features; their rows are counted.
    Colors(&'a DrawnRows),
    /// Depths and features.
    Shapes,
}

fn draw<const N: usize>(
    source: &GeometrySource,
    strips: &RowStrips,
    shader: &Shader,
    pattern: &SamplePattern<N>,
    drawn_as: DrawnAs<'_>,
) -> Rendering {
    let screen = source.screen();
    let [width, height] = screen.size;
    let (is_colored, uncounted) = (matches!(drawn_as, DrawnAs::Colors(_)), DrawnRows::default());
    let drawn = if let DrawnAs::Colors(drawn) = drawn_as { drawn } else { &uncounted };
    drawn.begin(height);
    let (count, band) = (width as usize * height as usize, (width * TILE) as usize);
    // All threads fill them: new memory takes time when it is first written.
    let mut pixels = Pixels::par_from_fn(width, height, |_, _| Srgba::WHITE);
    let mut depth_m: Vec<f32> = repeat_n(f32::INFINITY, count).collect();
    let mut features: Vec<FeatureId> = repeat_n(FeatureId::NONE, count).collect();
    // While a strip is drawn, the faces of the next are made: threads that find no tile left in one go on with the other.
    let faces = |rows| source.geometry(rows, &strips.block_rows);
    let mut made = strips.rows.first().map(faces);
    for (number, rows) in strips.rows.iter().enumerate() {
        let Some(geometry) = made else { break };
        let frame = TileContext { screen, geometry: &geometry, shader, pattern, is_colored };
        let first = rows.start / TILE;
        let strip = (rows.start * width) as usize..(rows.end * width) as usize;
        let bands = pixels.data_mut()[strip.clone()]
            .par_chunks_mut(band)
            .zip(depth_m[strip.clone()].par_chunks_mut(band))
            .zip(features[strip].par_chunks_mut(band))
            .enumerate();
        let left = TilesLeft::new(width, rows.end - rows.start);
        let draw = || {
            bands.for_each(|(number, ((colors, depths_m), features))| {
                let rows = colors.len() as u32 / width;
                draw_band(&frame, first + number as u32, BandRows { colors, depths_m, features }, &left);
                drawn.add(rows);
            });
        };
        ((), made) = rayon::join(draw, || strips.rows.get(number + 1).map(faces));
    }
    drawn.end();
    Rendering { pixels, depth_m, features }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3};

    use super::*;
    use sandtable_draw::list::{DepthLayer, DrawItem, DrawMesh, DrawVertex};
    use sandtable_draw::material::{AlphaMode, Material};
    use sandtable_mesh::sink::MeshSink;

    /// Triangles of all sizes all over the picture, the later ones transparent.
    fn confetti() -> DrawList {
        let mut list = DrawList::default();
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for alpha in [AlphaMode::Opaque, AlphaMode::Blend] {
            let mut mesh = DrawMesh::default();
            for _ in 0..4000 {
                let at = Vec3::new(random() - 0.5, random() + 0.5, random() - 0.5) * 200.0;
                let size = 40.0 * random() * random();
                let color = Srgba([random(), random(), random(), random()].map(|part| (part * 255.0) as u8));
                let ids = [(); 3].map(|()| {
                    let position = (at + Vec3::new(random(), random(), random()) * size).to_array();
                    mesh.vertex(DrawVertex { position, normal: [0.0, 0.0, 1.0], uv: [0.0; 2], color })
                });
                mesh.triangle(ids);
            }
            let item = DrawItem {
                triangles: 0..4000,
                mesh: list.add_mesh(mesh),
                material: list.add_material(Material { alpha, two_sided: true, ..Material::default() }),
                world_from_mesh: Mat4::IDENTITY,
                layer: DepthLayer::Solid,
                feature: FeatureId(2 + u32::from(alpha == AlphaMode::Blend)),
            };
            list.items.push(item);
        }
        list
    }

    #[test]
    fn strips_draw_the_same_picture_as_one() {
        let list = confetti();
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.9, (150, 330), (0.5, 1000.0)).expect("sound");
        let (screen, shadows) = (Screen::new(&camera), Shadows::default());
        let source = GeometrySource::new(&list, &screen, &FOUR).expect("few triangles");
        let shader = Shader::new(&list, &screen, &shadows, 8);
        let drawn = |strips: &RowStrips| {
            draw(&source, strips, &shader, &FOUR, DrawnAs::Colors(&DrawnRows::default()))
        };
        let whole = drawn(&RowStrips::new(&source));
        for (most, count) in [(1, 6), (3000, 2)] {
            let strips = RowStrips::of(&source, most);
            assert!(strips.rows.len() >= count, "{:?}", strips.rows);
            let parts = drawn(&strips);
            assert!(whole.pixels == parts.pixels && whole.features == parts.features, "{most}");
            assert!(whole.depth_m == parts.depth_m, "{most}");
        }
    }
}
