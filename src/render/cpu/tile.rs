//! One tile from its pieces to finished pixels.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::lighting::Lighting;
use crate::draw::list::{DepthLayer, FeatureId};
use crate::render::cpu::blend::Blend;
use crate::render::cpu::geometry::{FaceId, FacePiece, RasterPass, ScreenFace, ScreenGeometry};
use crate::render::cpu::pattern::{SampleMask, SamplePattern};
use crate::render::cpu::raster::PixelWindow;
use crate::render::cpu::screen::Screen;
use crate::render::cpu::shade::Shader;
use crate::render::cpu::visibility::{Visibility, samples_of};

/// Samples of ground whose depths differ by less than this part are taken to lie on one slope. Across
/// a silhouette depths differ by more; along a slope they differ by less, except close to the horizon.
const SAME_SLOPE: f32 = 0.01;

/// Everything the tiles of a frame share.
#[derive(Debug)]
pub struct TileContext<'a> {
    /// Where things are on the picture.
    pub screen: &'a Screen,
    /// What may be seen.
    pub geometry: &'a ScreenGeometry,
    /// How it looks.
    pub shader: &'a Shader<'a>,
    /// The sky.
    pub lighting: &'a Lighting,
}

/// One pixel of the picture.
#[derive(Clone, Copy, Debug)]
pub struct ResolvedPixel {
    /// Its color.
    pub color: Srgba,
    /// Meters along the viewing direction.
    pub depth_m: f32,
    /// The feature at its center.
    pub feature: FeatureId,
}

/// Memory that one tile after another uses.
#[derive(Debug)]
pub struct TileScratch<const N: usize> {
    visibility: Visibility<N>,
    blend: Blend,
}

impl<const N: usize> TileScratch<N> {
    /// Room for one tile.
    pub fn new() -> Self {
        Self { visibility: Visibility::new(), blend: Blend::new() }
    }
}

/// The pixels of `window`, row by row, from all `pieces` of its band in the list's order.
pub fn draw_tile<const N: usize>(
    frame: &TileContext,
    pattern: &SamplePattern<N>,
    pieces: &[FacePiece],
    window: PixelWindow,
    scratch: &mut TileScratch<N>,
) -> Vec<ResolvedPixel> {
    let TileScratch { visibility, blend } = scratch;
    visibility.clear(window, frame.screen.far);
    blend.clear(window);
    let here: Vec<&FacePiece> = pieces.iter().filter(|piece| !piece.window.and(window).is_empty()).collect();
    let mut solids = Vec::new();
    for &piece in here.iter().filter(|piece| piece.pass != RasterPass::Blend) {
        let face = frame.geometry.face(piece.face);
        if frame.shader.item(face).layer == DepthLayer::Solid {
            solids.push((piece, face));
        } else {
            draw_piece(frame, pattern, (piece, face), visibility);
        }
    }
    draw_solids(frame, pattern, solids, visibility);
    for piece in here.into_iter().filter(|piece| piece.pass == RasterPass::Blend) {
        blend.draw(piece, (frame.geometry, frame.shader), visibility, pattern);
    }
    let rows = window.from[1]..window.to[1];
    rows.flat_map(|y| (window.from[0]..window.to[0]).map(move |x| (x, y)))
        .map(|at| resolve(frame, pattern, visibility, blend, at))
        .collect()
}

/// Solids, the nearest first: of those behind, what is hidden as a whole is passed over, and of the rest masks need
/// be read only where nothing is in front. The picture does not depend on their order.
fn draw_solids<const N: usize>(
    frame: &TileContext,
    pattern: &SamplePattern<N>,
    mut solids: Vec<(&FacePiece, &ScreenFace)>,
    visibility: &mut Visibility<N>,
) {
    solids.sort_by(|(_, a), (_, b)| b.range[1].total_cmp(&a.range[1]));
    for (piece, face) in solids {
        if visibility.may_show(piece, face) {
            draw_piece(frame, pattern, (piece, face), visibility);
        }
    }
}

fn draw_piece<const N: usize>(
    frame: &TileContext,
    pattern: &SamplePattern<N>,
    (piece, face): (&FacePiece, &ScreenFace),
    visibility: &mut Visibility<N>,
) {
    match piece.pass {
        RasterPass::Opaque if face.is_draped() => visibility.draw_draped(piece, face, pattern),
        RasterPass::Opaque => visibility.draw_nearer(piece, face, pattern),
        RasterPass::Mask => {
            let cutout = frame.shader.cutout(face);
            visibility.draw_masked(piece, face, pattern, |at, samples| cutout.solid(at, samples, pattern));
        }
        RasterPass::Blend => {}
    }
}

/// One pixel: each face it sees shaded once, averaged over the samples.
fn resolve<const N: usize>(
    frame: &TileContext,
    pattern: &SamplePattern<N>,
    visibility: &Visibility<N>,
    blend: &Blend,
    (x, y): (u32, u32),
) -> ResolvedPixel {
    let faces = visibility.faces(x, y);
    let center = [x as f32 + 0.5, y as f32 + 0.5];
    let mut colors = [Vec3::ZERO; N];
    let mut left = SamplePattern::<N>::FULL;
    while left != 0 {
        let id = faces[left.trailing_zeros() as usize];
        let mask = left & alike(frame, visibility, (x, y), left.trailing_zeros() as usize);
        let [right, down] = pattern.centroid(mask);
        let color = match id {
            FaceId::NONE => frame.lighting.sky_color(frame.screen.ray_at(center)),
            id => frame.shader.shade(frame.geometry.face(id), [center[0] + right, center[1] + down]).color,
        };
        for (sample, place) in colors.iter_mut().enumerate() {
            *place = if mask & (1 << sample) != 0 { color } else { *place };
        }
        left &= !mask;
    }
    let transparent = if blend.is_empty() {
        None
    } else {
        blend.lay_over((x, y), &mut colors, (frame.geometry, frame.shader), pattern)
    };
    let (depth_m, feature) = seen_at(frame, transparent.unwrap_or(faces[0]), center);
    let mean = colors.iter().sum::<Vec3>() / N as f32;
    ResolvedPixel { color: Srgba::from_linear(mean), depth_m, feature }
}

/// The samples of a pixel that look like sample `first` and need no shading of their own: those of its face
/// and, on ground that takes its looks from the map, those of its neighbors on the same slope.
///
/// Ground triangles are often no larger than a few pixels; this spares about a sixth of a frame's time.
fn alike<const N: usize>(
    frame: &TileContext,
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
        let near = (depths[sample] - depths[first]).abs() < SAME_SLOPE * depths[first];
        let same = near && id != FaceId::NONE && frame.geometry.face(id).item == face.item;
        mask |= SampleMask::from(same) << sample;
    }
    mask
}

/// The depth and feature of a face at a pixel's center.
fn seen_at(frame: &TileContext, id: FaceId, center: [f32; 2]) -> (f32, FeatureId) {
    if id == FaceId::NONE {
        return (f32::INFINITY, FeatureId::NONE);
    }
    let face = frame.geometry.face(id);
    (1.0 / face.inverse_depth(center), frame.shader.item(face).feature)
}
