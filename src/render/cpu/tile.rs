//! Draws the pieces of one tile to finished pixels.

use std::ops::Range;

use glam::Vec3;

use crate::cpu::blend::Blend;
use crate::cpu::geometry::{FaceId, FacePiece, ScreenFace, ScreenGeometry};
use crate::cpu::pattern::{SampleMask, SamplePattern};
use crate::cpu::raster::PixelWindow;
use crate::cpu::screen::Screen;
use crate::cpu::shade::{MappedPixel, Shader};
use crate::cpu::visibility::{Visibility, samples_of};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, FeatureId};
use sandtable_draw::material::AlphaMode;

#[derive(Debug)]
pub struct TileContext<'a, const N: usize> {
    pub screen: &'a Screen,
    pub geometry: &'a ScreenGeometry,
    pub shader: &'a Shader<'a>,
    pub pattern: &'a SamplePattern<N>,
    /// Whether opaque surfaces are shaded; where not, only depths and features count.
    pub is_colored: bool,
}

#[derive(Clone, Copy, Debug)]
pub struct ResolvedPixel {
    pub color: Srgba,
    /// Meters along the viewing direction.
    pub depth_m: f32,
    pub feature: FeatureId,
}

#[derive(Debug)]
pub struct TileScratch<const N: usize> {
    visibility: Visibility<N>,
    blend: Blend,
}

impl<const N: usize> TileScratch<N> {
    pub fn new() -> Self {
        Self { visibility: Visibility::new(), blend: Blend::new() }
    }
}

/// The pixels of `window`, row by row, from all `pieces` of its band in the list's order.
pub fn draw_tile<const N: usize>(
    frame: &TileContext<N>,
    pieces: &[FacePiece],
    window: PixelWindow,
    scratch: &mut TileScratch<N>,
) -> Vec<ResolvedPixel> {
    scratch.visibility.clear(window, frame.screen.nearness(frame.screen.far) as f32);
    scratch.blend.clear(window);
    let touches_tile = |piece: &&FacePiece| !piece.window.intersection(window).is_empty();
    let (transparent, others): (Vec<&FacePiece>, Vec<&FacePiece>) =
        pieces.iter().filter(touches_tile).partition(|piece| piece.alpha == AlphaMode::Blend);
    let mut solids = Vec::new();
    for piece in others {
        let face = frame.geometry.face(piece.face);
        if frame.shader.item(face).layer == DepthLayer::Solid {
            solids.push((piece, face));
        } else {
            draw_piece(frame, piece, face, &mut scratch.visibility);
        }
    }
    draw_solids(frame, solids, &mut scratch.visibility);
    for piece in transparent {
        scratch.blend.draw(frame, piece, &scratch.visibility);
    }
    let columns = window.from[0]..window.to[0];
    let mut pixels = Vec::with_capacity(columns.len() * (window.to[1] - window.from[1]) as usize);
    for y in window.from[1]..window.to[1] {
        let mapped = mapped_pixels(frame, &scratch.visibility, columns.clone(), y);
        let mut mapped = mapped.iter().peekable();
        pixels.extend(columns.clone().map(|x| {
            let mapped = mapped.next_if(|pixel| pixel.column == x);
            resolve(frame, scratch, (x, y), mapped)
        }));
    }
    pixels
}

/// The pixels of a row that show nothing but ground colored and lit by the map, on one slope: most of a picture's. What covers it
/// is computed for all of them together.
fn mapped_pixels<'a, const N: usize>(
    frame: &'a TileContext<N>,
    visibility: &Visibility<N>,
    columns: Range<u32>,
    y: u32,
) -> Vec<MappedPixel<'a>> {
    let mapped = |x: u32| {
        let face = match visibility.faces(x, y)[0] {
            FaceId::NONE => return None,
            id => frame.geometry.face(id),
        };
        let is_whole = || samples_alike(frame, visibility, (x, y), 0) == SamplePattern::<N>::FULL;
        let at = || frame.pattern.centroid_in(x, y, SamplePattern::<N>::FULL);
        if frame.shader.is_mapped(face) && is_whole() { frame.shader.mapped(face, at(), x) } else { None }
    };
    let is_covered = frame.is_colored && frame.shader.has_cover();
    let mut pixels: Vec<_> = if is_covered { columns.filter_map(mapped).collect() } else { Vec::new() };
    Shader::cover_mapped(&mut pixels);
    pixels
}

/// Draws solids, the nearest first: hidden ones are skipped, and masks are read only where nothing is in front. The
/// picture does not depend on their order.
fn draw_solids<const N: usize>(
    frame: &TileContext<N>,
    mut solids: Vec<(&FacePiece, &ScreenFace)>,
    visibility: &mut Visibility<N>,
) {
    solids.sort_by(|(_, a), (_, b)| b.range[1].total_cmp(&a.range[1]));
    for (piece, face) in solids {
        if visibility.may_show(piece, face) {
            draw_piece(frame, piece, face, visibility);
        }
    }
}

fn draw_piece<const N: usize>(
    frame: &TileContext<N>,
    piece: &FacePiece,
    face: &ScreenFace,
    visibility: &mut Visibility<N>,
) {
    if matches!(piece.alpha, AlphaMode::Mask(_)) {
        let cutout = frame.shader.cutout(face);
        visibility.draw(piece, face, frame.pattern, |at, samples| cutout.solid(at, samples, frame.pattern));
    } else {
        visibility.draw(piece, face, frame.pattern, |_, samples| samples);
    }
}

/// One pixel: each face it shows is shaded once and averaged over the samples; `mapped` is what is known of it.
fn resolve<const N: usize>(
    frame: &TileContext<N>,
    scratch: &TileScratch<N>,
    (x, y): (u32, u32),
    mapped: Option<&MappedPixel<'_>>,
) -> ResolvedPixel {
    let faces = scratch.visibility.faces(x, y);
    let center = [x as f32 + 0.5, y as f32 + 0.5];
    let color_of = |sample: usize, mask: SampleMask| match faces[sample] {
        FaceId::NONE => frame.shader.backdrop(center),
        id => frame.shader.shade(frame.geometry.face(id), frame.pattern.centroid_in(x, y, mask)).color,
    };
    let mut colors = mapped.map_or([Vec3::ZERO; N], |pixel| [frame.shader.shade_mapped(pixel); N]);
    let mut left = if frame.is_colored && mapped.is_none() { SamplePattern::<N>::FULL } else { 0 };
    while left != 0 {
        let first = left.trailing_zeros() as usize;
        let mask = left & samples_alike(frame, &scratch.visibility, (x, y), first);
        let color = color_of(first, mask);
        if mask == SamplePattern::<N>::FULL {
            // Most pixels: one face, or one slope of ground.
            colors = [color; N];
            break;
        }
        for (sample, slot) in colors.iter_mut().enumerate() {
            *slot = if mask & (1 << sample) != 0 { color } else { *slot };
        }
        left &= !mask;
    }
    let transparent = scratch.blend.composite(frame, (x, y), &mut colors);
    let (depth_m, feature) = depth_and_feature(frame, transparent.unwrap_or(faces[0]), center);
    let mean = colors.iter().sum::<Vec3>() / N as f32;
    ResolvedPixel { color: Srgba::from_linear(mean), depth_m, feature }
}

/// The samples of a pixel that are shaded with sample `first`: those of its face and, on ground colored and lit by the
/// map, those of neighbors on the same slope. Ground triangles are often no larger than a few pixels: this saves about
/// a sixth of a frame's time.
fn samples_alike<const N: usize>(
    frame: &TileContext<N>,
    visibility: &Visibility<N>,
    (x, y): (u32, u32),
    first: usize,
) -> SampleMask {
    let (faces, depths) = (visibility.faces(x, y), visibility.depths(x, y));
    let mut mask = samples_of(faces, faces[first]);
    if mask == SamplePattern::<N>::FULL || faces[first] == FaceId::NONE {
        return mask;
    }
    let face = frame.geometry.face(faces[first]);
    if !frame.shader.is_mapped(face) {
        return mask;
    }
    for (sample, &id) in faces.iter().enumerate() {
        let is_near = (depths[sample] - depths[first]).abs() < frame.screen.same_slope(depths[first]);
        let is_alike = is_near && id != FaceId::NONE && frame.geometry.face(id).item == face.item;
        mask |= SampleMask::from(is_alike) << sample;
    }
    mask
}

fn depth_and_feature<const N: usize>(
    frame: &TileContext<N>,
    id: FaceId,
    center: [f32; 2],
) -> (f32, FeatureId) {
    if id == FaceId::NONE {
        return (f32::INFINITY, FeatureId::NONE);
    }
    let face = frame.geometry.face(id);
    (frame.screen.depth_m(face.nearness(center)), frame.shader.item(face).feature)
}
