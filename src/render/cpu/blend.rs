//! Transparent surfaces: sorted per pixel and blended over the opaque picture, sample by sample.
//!
//! Fragments are collected after all opaque surfaces of a tile, so that hidden ones are not kept. They are inserted in
//! order from the nearest to the farthest, drapes by the rule of layers. Colors are blended exactly, without dithering
//! and with no limit on overlap but [`MOST_LAYERS`].

use glam::Vec3;

use crate::cpu::geometry::{FaceId, FacePiece, ScreenFace};
use crate::cpu::pattern::SampleMask;
use crate::cpu::raster::{PixelWindow, cover};
use crate::cpu::shade::{FaceAt, Shaded};
use crate::cpu::tile::TileContext;
use crate::cpu::visibility::{SampleDepths, TILE, Visibility};
use crate::picture::LEAST_VISIBLE_ALPHA;
use sandtable_draw::list::DepthLayer;

/// Transparent fragments that a pixel keeps; of more, the farthest is dropped. Bounds memory to 2 MiB per tile.
const MOST_LAYERS: usize = 32;

#[derive(Clone, Copy, Debug)]
struct Fragment {
    face: FaceId,
    nearness: f32,
    mask: SampleMask,
}

/// The transparent fragments of one tile, the nearest of each pixel first.
#[derive(Debug)]
pub struct Blend {
    window: PixelWindow,
    pixels: Vec<Vec<Fragment>>,
}

impl Blend {
    pub fn new() -> Self {
        Self { window: PixelWindow::EMPTY, pixels: vec![Vec::new(); (TILE * TILE) as usize] }
    }

    /// Removes all fragments and moves the tile to `window`.
    pub fn clear(&mut self, window: PixelWindow) {
        self.window = window;
        self.pixels.iter_mut().for_each(Vec::clear);
    }

    fn index(&self, x: u32, y: u32) -> usize {
        ((y - self.window.from[1]) * TILE + x - self.window.from[0]) as usize
    }

    /// Adds the part of a transparent piece that lies before the opaque surfaces.
    pub fn draw<const N: usize>(
        &mut self,
        frame: &TileContext<N>,
        piece: &FacePiece,
        visibility: &Visibility<N>,
    ) {
        let face = frame.geometry.face(piece.face);
        let offsets = SampleDepths::new(face, frame.pattern);
        cover(&piece.corners, frame.pattern, piece.window.intersection(self.window), |x, y, mask| {
            let depths = offsets.at(face, x, y);
            let (opaque, opaque_depths) = (visibility.faces(x, y), visibility.depths(x, y));
            let mut seen = 0;
            for sample in (0..N).filter(|sample| mask & (1 << sample) != 0) {
                let is_before = match opaque[sample] {
                    FaceId::NONE => depths[sample] > opaque_depths[sample],
                    id => {
                        let opaque = frame.geometry.face(id);
                        is_before(frame, face, depths[sample], opaque, opaque_depths[sample])
                    }
                };
                seen |= SampleMask::from(is_before) << sample;
            }
            if seen != 0 {
                let nearness = face.nearness(frame.pattern.centroid_in(x, y, seen));
                let index = self.index(x, y);
                let fragment = Fragment { face: piece.face, nearness, mask: seen };
                let is_in_front = |other: &Fragment| is_in_front(frame, other, &fragment);
                insert(&mut self.pixels[index], &fragment, is_in_front);
            }
        });
    }

    /// What a pixel shows of transparent faces, the farthest first.
    pub fn points<'a, const N: usize>(
        &self,
        frame: &'a TileContext<N>,
        (x, y): (u32, u32),
    ) -> impl Iterator<Item = FaceAt<'a>> {
        self.pixels[self.index(x, y)].iter().rev().map(move |fragment| FaceAt {
            face: frame.geometry.face(fragment.face),
            at: frame.pattern.centroid_in(x, y, fragment.mask),
        })
    }

    /// Blends a pixel's fragments over the `colors` of its samples; `shaded` gives the color of each of its
    /// [points](Self::points). Returns the transparent face that the depth and feature buffers show, if any.
    pub fn composite<const N: usize>(
        &self,
        (x, y): (u32, u32),
        shaded: impl Iterator<Item = Shaded>,
        colors: &mut [Vec3; N],
    ) -> Option<FaceId> {
        let mut seen = None;
        for (fragment, shaded) in self.pixels[self.index(x, y)].iter().rev().zip(shaded) {
            for (sample, color) in colors.iter_mut().enumerate() {
                if fragment.mask & (1 << sample) != 0 {
                    *color = color.lerp(shaded.color, shaded.alpha);
                }
            }
            if fragment.mask & 1 != 0 && shaded.alpha >= LEAST_VISIBLE_ALPHA {
                seen = Some(fragment.face);
            }
        }
        seen
    }
}

/// Inserts a fragment before the first of a pixel's fragments that does not lie in front of it.
fn insert(pixel: &mut Vec<Fragment>, fragment: &Fragment, is_in_front: impl Fn(&Fragment) -> bool) {
    let place = pixel.iter().position(|other| !is_in_front(other)).unwrap_or(pixel.len());
    if place < MOST_LAYERS {
        pixel.insert(place, *fragment);
        pixel.truncate(MOST_LAYERS);
    }
}

/// Whether a fragment lies in front of another. Drapes that show at a pixel lie on the same ground, since ground is opaque: the
/// later in the list is in front, whatever rounding did to the depth of a sliver.
fn is_in_front<const N: usize>(frame: &TileContext<N>, other: &Fragment, fragment: &Fragment) -> bool {
    let [beside, face] = [other.face, fragment.face].map(|id| frame.geometry.face(id));
    match (frame.shader.item(beside).layer, frame.shader.item(face).layer) {
        (DepthLayer::Draped(_), DepthLayer::Draped(_)) if beside.item != face.item => beside.item > face.item,
        _ => other.nearness > fragment.nearness * face.reach,
    }
}

/// Whether a transparent face at nearness `depth` shows before an opaque face. In the same plane a drape shows
/// over the ground and over drapes that come before it in the list; drapes that come after it cover it.
fn is_before<const N: usize>(
    frame: &TileContext<N>,
    face: &ScreenFace,
    depth: f32,
    opaque: &ScreenFace,
    opaque_depth: f32,
) -> bool {
    match (frame.shader.item(face).layer, frame.shader.item(opaque).layer) {
        (DepthLayer::Draped(_), DepthLayer::Draped(_)) if opaque.item > face.item => {
            depth > opaque_depth * face.reach
        }
        (DepthLayer::Draped(_), DepthLayer::Ground | DepthLayer::Draped(_)) => {
            depth * face.reach >= opaque_depth
        }
        _ => depth > opaque_depth,
    }
}
