//! One tile from its pieces to finished pixels.

use glam::Vec3;

use crate::draw::color::Srgba;
use crate::draw::lighting::Lighting;
use crate::draw::list::FeatureId;
use crate::render::cpu::blend::Blend;
use crate::render::cpu::geometry::{FaceId, Geometry, Pass, Piece};
use crate::render::cpu::pattern::Pattern;
use crate::render::cpu::raster::Window;
use crate::render::cpu::screen::Screen;
use crate::render::cpu::shade::Shader;
use crate::render::cpu::visibility::{Visibility, samples_of};

/// Everything the tiles of a frame share.
#[derive(Debug)]
pub struct Frame<'a> {
    /// Where things are on the picture.
    pub screen: &'a Screen,
    /// What may be seen.
    pub geometry: &'a Geometry,
    /// How it looks.
    pub shader: &'a Shader<'a>,
    /// The sky.
    pub lighting: &'a Lighting,
}

/// One pixel of the picture.
#[derive(Clone, Copy, Debug)]
pub struct PixelOut {
    /// Its colour.
    pub color: Srgba,
    /// Metres along the viewing direction.
    pub depth_m: f32,
    /// The feature at its centre.
    pub feature: FeatureId,
}

/// Memory that one tile after another uses.
#[derive(Debug)]
pub struct Scratch<const N: usize> {
    visibility: Visibility<N>,
    blend: Blend,
}

impl<const N: usize> Scratch<N> {
    /// Room for one tile.
    pub fn new() -> Self {
        Self { visibility: Visibility::new(), blend: Blend::new() }
    }
}

/// The pixels of `window`, row by row, from all `pieces` of its band in the list's order.
pub fn draw_tile<const N: usize>(
    frame: &Frame,
    pattern: &Pattern<N>,
    pieces: &[Piece],
    window: Window,
    scratch: &mut Scratch<N>,
) -> Vec<PixelOut> {
    let Scratch { visibility, blend } = scratch;
    visibility.clear(window, frame.screen.far);
    blend.clear(window);
    let here = || pieces.iter().filter(|piece| !piece.window.and(window).is_empty());
    for piece in here() {
        draw_piece(frame, pattern, piece, visibility);
    }
    for piece in here().filter(|piece| piece.pass == Pass::Blend) {
        blend.draw(piece, (frame.geometry, frame.shader), visibility, pattern);
    }
    let rows = window.from[1]..window.to[1];
    rows.flat_map(|y| (window.from[0]..window.to[0]).map(move |x| (x, y)))
        .map(|at| resolve(frame, pattern, visibility, blend, at))
        .collect()
}

fn draw_piece<const N: usize>(
    frame: &Frame,
    pattern: &Pattern<N>,
    piece: &Piece,
    visibility: &mut Visibility<N>,
) {
    let face = frame.geometry.face(piece.face);
    match piece.pass {
        Pass::Opaque if frame.shader.is_draped(face) => visibility.draw_draped(piece, face, pattern),
        Pass::Opaque => visibility.draw_nearer(piece, face, pattern),
        Pass::Mask => {
            visibility.draw_masked(piece, face, pattern, |at| frame.shader.is_hole(face, at));
        }
        Pass::Blend => {}
    }
}

/// One pixel: each face it sees shaded once, averaged over the samples.
fn resolve<const N: usize>(
    frame: &Frame,
    pattern: &Pattern<N>,
    visibility: &Visibility<N>,
    blend: &Blend,
    (x, y): (u32, u32),
) -> PixelOut {
    let faces = visibility.faces(x, y);
    let center = [x as f32 + 0.5, y as f32 + 0.5];
    let mut colors = [Vec3::ZERO; N];
    let mut left = Pattern::<N>::FULL;
    while left != 0 {
        let id = faces[left.trailing_zeros() as usize];
        let mask = samples_of(faces, id);
        let [right, down] = pattern.centroid(mask);
        let color = match id {
            FaceId::NONE => frame.lighting.sky_at(frame.screen.ray_at(center)),
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
    PixelOut { color: Srgba::from_linear(mean), depth_m, feature }
}

/// The depth and feature of a face at a pixel's centre.
fn seen_at(frame: &Frame, id: FaceId, center: [f32; 2]) -> (f32, FeatureId) {
    if id == FaceId::NONE {
        return (f32::INFINITY, FeatureId::NONE);
    }
    let face = frame.geometry.face(id);
    (1.0 / face.inverse_depth(center), frame.shader.item(face).feature)
}
