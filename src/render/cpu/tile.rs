//! Draws the pieces of one tile to finished pixels.

use glam::Vec3;

use crate::cpu::blend::Blend;
use crate::cpu::geometry::{FaceId, FacePiece, ScreenFace, ScreenGeometry};
use crate::cpu::pattern::{SampleMask, SamplePattern};
use crate::cpu::raster::PixelWindow;
use crate::cpu::screen::Screen;
use crate::cpu::shade::{FaceAt, Shader};
use crate::cpu::visibility::{TILE, Visibility, samples_of};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, FeatureId};
use sandtable_draw::material::AlphaMode;

/// Rows of a tile whose pixels are shaded together: what is known of their points stays in the second level cache.
const ROWS_TOGETHER: usize = 4;

/// About the most points that pixels of these rows show, where few of them show two.
const MOST_TOGETHER: usize = 5 * TILE as usize;

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

/// The pixels of `window`, row by row, from all pieces that may touch it, and perhaps others, in the list's order.
pub fn draw_tile<'a, const N: usize>(
    frame: &TileContext<'a, N>,
    pieces: impl Iterator<Item = &'a FacePiece>,
    window: PixelWindow,
    scratch: &mut TileScratch<N>,
) -> Vec<ResolvedPixel> {
    scratch.visibility.clear(window, frame.screen.nearness(frame.screen.far) as f32);
    scratch.blend.clear(window);
    let touches_tile = |piece: &&FacePiece| !piece.window.intersection(window).is_empty();
    let (transparent, others): (Vec<&FacePiece>, Vec<&FacePiece>) =
        pieces.filter(touches_tile).partition(|piece| piece.alpha == AlphaMode::Blend);
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
    for top in (window.from[1]..window.to[1]).step_by(ROWS_TOGETHER) {
        let rows = top..window.to[1].min(top + ROWS_TOGETHER as u32);
        let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
        draw_pixels(frame, scratch, places, &mut pixels);
    }
    pixels
}

/// Adds the pixels at some places: each face that one of them shows is shaded once and averaged over its samples. What is shaded
/// of all of them is shaded together.
fn draw_pixels<const N: usize>(
    frame: &TileContext<N>,
    scratch: &TileScratch<N>,
    places: impl Iterator<Item = (u32, u32)> + Clone,
    pixels: &mut Vec<ResolvedPixel>,
) {
    let TileScratch { visibility, blend } = scratch;
    let mut parts = Vec::with_capacity(MOST_TOGETHER);
    if frame.is_colored {
        places.clone().for_each(|place| add_parts(frame, visibility, place, &mut parts));
    }
    let mut points = Vec::with_capacity(MOST_TOGETHER);
    for &PixelPart { place: (x, y), face, mask } in parts.iter().filter(|part| part.face != FaceId::NONE) {
        points.push(FaceAt { face: frame.geometry.face(face), at: frame.pattern.centroid_in(x, y, mask) });
    }
    let opaque = points.len();
    places.clone().for_each(|place| points.extend(blend.points(frame, place)));
    let shaded = frame.shader.shade_each(&points);
    let (opaque, transparent) = shaded.split_at(opaque);
    let (mut opaque, mut transparent) = (opaque.iter(), transparent.iter().copied());
    let mut parts = parts.iter().peekable();
    pixels.extend(places.map(|(x, y)| {
        let center = [x as f32 + 0.5, y as f32 + 0.5];
        let mut colors = [Vec3::ZERO; N];
        while let Some(part) = parts.next_if(|part| part.place == (x, y)) {
            let color = match part.face {
                FaceId::NONE => frame.shader.backdrop(center),
                _ => opaque.next().map_or(Vec3::ZERO, |shaded| shaded.color),
            };
            for (sample, slot) in colors.iter_mut().enumerate() {
                *slot = if part.mask & (1 << sample) != 0 { color } else { *slot };
            }
        }
        let seen = blend.composite((x, y), &mut transparent, &mut colors);
        let face = seen.unwrap_or(visibility.faces(x, y)[0]);
        let (depth_m, feature) = depth_and_feature(frame, face, center);
        let mean = colors.iter().sum::<Vec3>() / N as f32;
        ResolvedPixel { color: Srgba::from_linear(mean), depth_m, feature }
    }));
}

/// Samples of a pixel that are shaded together.
struct PixelPart {
    /// The column and the row of the pixel.
    place: (u32, u32),
    /// The face of the first of them.
    face: FaceId,
    mask: SampleMask,
}

/// Adds the parts of a pixel, which are all of its samples.
fn add_parts<const N: usize>(
    frame: &TileContext<N>,
    visibility: &Visibility<N>,
    place: (u32, u32),
    parts: &mut Vec<PixelPart>,
) {
    let faces = visibility.faces(place.0, place.1);
    let mut left = SamplePattern::<N>::FULL;
    while left != 0 {
        let first = left.trailing_zeros() as usize;
        let mask = left & samples_alike(frame, visibility, place, first);
        parts.push(PixelPart { place, face: faces[first], mask });
        left &= !mask;
    }
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
