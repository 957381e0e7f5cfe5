//! The deterministic renderer: needs nothing but the processor, and gives the same bytes on every platform
//! and for every number of threads.
//!
//! # How
//! ```text
//! DrawList ──geometry──▶ faces, pieces ──band──▶ tiles of 64×64 ──visibility──▶ which face each sample sees
//!            plane, clip, raster::snapped              raster, pattern, occlusion     │
//!                                                                 blend ◀─────────────┤
//!                        Picture ◀──band── pixels ◀──tile::resolve── shade ◀──────────┘
//!                                                  cutout, alpha     hit, ground_shade, texture
//! ```
//! Coverage is integer arithmetic on snapped corners; depth and attributes come from the exact planes of the
//! unsnapped triangles in f64, so that a road cut from the ground's triangles has the ground's very depth.
//! Shading runs once per pixel and face (as multisampling does), at the middle of the samples the face
//! holds. Tiles are drawn in parallel on the current `rayon` pool; none depends on another. Within a
//! tile ground and drapes keep the list's order; solids are drawn from the nearest on, which the picture does
//! not show, and what is hidden as a whole is passed over.
//!
//! # Surfaces
//! Ground and solids hide what is behind them; draped faces follow [`crate::draw::list::DepthLayer`], with the
//! tolerance widened where f32 corners far from the origin round by more than it (see
//! `geometry::drape_tolerance`). Masked surfaces are tested at each sample that
//! nothing nearer covers, by one reading of their alpha as a rule. Blended surfaces are sorted per pixel, up to
//! 32 deep, and laid over each sample in linear light; from alpha ½ on they are what depth and
//! feature buffers hold, below it what lies behind them.
//!
//! # Cost
//! Time is a sum of pixels × the surfaces seen in each (shading, two thirds of it and more), triangles
//! (three corners projected and three planes each), and covered samples (one depth test each). Against one
//! sample a pixel, four take about a quarter more time and eight a third. A landscape of 180,000 triangles,
//! 1920×1080, eight samples, takes about half a second of processor time, shared evenly by the threads.
//! A forest of 100,000 trees, most of them pictures on masked quads, takes about three.
//!
//! Memory: 12 bytes a pixel for the picture; 150 bytes a visible triangle; for each band of 64 rows at work
//! 12 bytes a pixel and 48 a triangle in it; for each thread 0.3 MiB, and up to 2 MiB more under
//! transparent surfaces; a third of each texture and of the ground map for their smaller levels, and as
//! much again of a texture with holes for its alpha by itself.

mod alpha;
mod band;
mod blend;
mod clip;
mod cutout;
mod geometry;
mod ground_shade;
mod hit;
mod occlusion;
mod pattern;
mod plane;
mod raster;
mod screen;
mod shade;
mod texture;
mod tile;
mod visibility;

use rayon::prelude::*;

use crate::draw::color::Srgba;
use crate::draw::list::{DrawList, FeatureId};
use crate::draw::material::{Albedo, NormalSource};
use crate::draw::pixels::Pixels;
use crate::render::cpu::band::{BandRows, draw_band};
use crate::render::cpu::geometry::ScreenGeometry;
use crate::render::cpu::pattern::{EIGHT, FOUR, ONE, SamplePattern};
use crate::render::cpu::screen::Screen;
use crate::render::cpu::shade::Shader;
use crate::render::cpu::tile::TileContext;
use crate::render::cpu::visibility::TILE;
use crate::render::picture::Picture;
use crate::view::camera::Camera;

/// How carefully to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderQuality {
    /// Samples a pixel. Default: eight.
    pub samples: SampleCount,
    /// The most readings of a texture or of the ground map along a pixel seen at a grazing angle, 1..=16.
    /// Default: 8.
    pub anisotropy: u32,
}

/// In how many places each pixel is tested for what it sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleCount {
    /// Once, at the center: jagged, for drafts.
    One,
    /// Four times.
    Four,
    /// Eight times.
    Eight,
}

/// Why a draw list cannot be rendered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// [`DrawList::check`] found something out of place.
    #[error("the draw list is not sound: {0}; its maker must be mended")]
    List(String),
    /// A material takes color or normals from a ground map that is not there.
    #[error(
        "item {item} takes its color or normals from the ground map, but the draw list has none; add one"
    )]
    NoGroundMap {
        /// The item's index in the list.
        item: usize,
    },
    /// There are too many triangles.
    #[error("the draw list draws {0} triangles, the most is 4294965000; draw fewer or coarser meshes")]
    TooManyTriangles(usize),
}

impl Default for RenderQuality {
    fn default() -> Self {
        Self { samples: SampleCount::Eight, anisotropy: 8 }
    }
}

/// The picture that `camera` takes of `list`, drawn on the current `rayon` pool.
///
/// Triangles with corners that are not finite are left out.
///
/// # Errors
/// See [`RenderError`].
pub fn render(list: &DrawList, camera: &Camera, options: &RenderQuality) -> Result<Picture, RenderError> {
    check(list)?;
    let screen = Screen::of(camera);
    let geometry = ScreenGeometry::of(list, &screen)
        .ok_or_else(|| RenderError::TooManyTriangles(list.triangle_count()))?;
    let shader = Shader::new(list, &screen, options.anisotropy.clamp(1, 16));
    let frame =
        TileContext { screen: &screen, geometry: &geometry, shader: &shader, lighting: &list.lighting };
    Ok(match options.samples {
        SampleCount::One => draw(&frame, &ONE),
        SampleCount::Four => draw(&frame, &FOUR),
        SampleCount::Eight => draw(&frame, &EIGHT),
    })
}

fn check(list: &DrawList) -> Result<(), RenderError> {
    list.check().map_err(RenderError::List)?;
    let needs_ground = list.items.iter().position(|item| {
        let material = &list.materials[item.material.0 as usize];
        material.albedo == Albedo::GroundMap || material.normals == NormalSource::Ground
    });
    match needs_ground {
        Some(item) if list.ground.is_none() => Err(RenderError::NoGroundMap { item }),
        _ => Ok(()),
    }
}

/// All bands of the picture.
fn draw<const N: usize>(frame: &TileContext, pattern: &SamplePattern<N>) -> Picture {
    let [width, height] = frame.screen.size;
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
            draw_band(frame, pattern, number as u32, BandRows { colors, depths_m, features });
        });
    Picture { pixels, depth_m, features }
}
