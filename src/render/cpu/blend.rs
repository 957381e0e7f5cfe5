//! Transparent surfaces: sorted per pixel and blended over the opaque picture, sample by sample.
//!
//! Fragments are collected after all opaque surfaces of a tile, so that hidden ones are not kept. They are inserted in
//! order from the nearest to the farthest, drapes by the rule of layers. Colors are blended exactly, without dithering
//! and with no limit on overlap but [`MOST_LAYERS`].

use glam::Vec3;

use crate::draw::list::DepthLayer;
use crate::render::cpu::geometry::{FaceId, FacePiece, ScreenFace};
use crate::render::cpu::pattern::SampleMask;
use crate::render::cpu::raster::{PixelWindow, cover};
use crate::render::cpu::tile::TileContext;
use crate::render::cpu::visibility::{SampleDepths, TILE, Visibility};
use crate::render::picture::LEAST_VISIBLE_ALPHA;

/// Transparent fragments that a pixel keeps; of more, the farthest is dropped. Bounds memory to 2 MiB per tile.
const MOST_LAYERS: usize = 32;

/// No fragment.
const END: u32 = u32::MAX;

/// A transparent face in one pixel.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    face: FaceId,
    next: u32,
    inverse_depth: f32,
    mask: SampleMask,
}

/// The transparent fragments of one tile: a linked list per pixel.
#[derive(Debug)]
pub struct Blend {
    window: PixelWindow,
    heads: Vec<u32>,
    fragments: Vec<Fragment>,
}

impl Blend {
    /// Without fragments.
    pub fn new() -> Self {
        let heads = vec![END; (TILE * TILE) as usize];
        Self { window: PixelWindow::EMPTY, heads, fragments: Vec::new() }
    }

    /// Removes all fragments and moves the tile to `window`.
    pub fn clear(&mut self, window: PixelWindow) {
        self.window = window;
        self.fragments.clear();
        self.heads.fill(END);
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
                let inverse_depth = face.inverse_depth(frame.pattern.centroid_in(x, y, seen));
                let fragment = Fragment { face: piece.face, next: END, inverse_depth, mask: seen };
                self.insert(self.index(x, y), fragment, face);
            }
        });
    }

    /// Inserts a fragment before the first of its pixel that does not lie in front of it.
    fn insert(&mut self, pixel: usize, mut fragment: Fragment, face: &ScreenFace) {
        let (mut before, mut here, mut count) = (END, self.heads[pixel], 0);
        while here != END && self.fragments[here as usize].inverse_depth > fragment.inverse_depth * face.reach
        {
            (before, here, count) = (here, self.fragments[here as usize].next, count + 1);
        }
        if count == MOST_LAYERS {
            return;
        }
        fragment.next = here;
        let new = self.fragments.len() as u32;
        self.fragments.push(fragment);
        match before {
            END => self.heads[pixel] = new,
            before => self.fragments[before as usize].next = new,
        }
        self.drop_farthest(new, count);
    }

    /// Ends a pixel's list after [`MOST_LAYERS`] fragments; `count` fragments precede `at`.
    fn drop_farthest(&mut self, mut at: u32, mut count: usize) {
        while at != END {
            count += 1;
            if count == MOST_LAYERS {
                self.fragments[at as usize].next = END;
            }
            at = self.fragments[at as usize].next;
        }
    }

    /// Blends a pixel's fragments over the `colors` of its samples. Returns the transparent face that the depth and
    /// feature buffers show, if any.
    pub fn composite<const N: usize>(
        &self,
        frame: &TileContext<N>,
        (x, y): (u32, u32),
        colors: &mut [Vec3; N],
    ) -> Option<FaceId> {
        if self.fragments.is_empty() {
            return None;
        }
        let mut nearest_first = [END; MOST_LAYERS];
        let (mut count, mut at) = (0, self.heads[self.index(x, y)]);
        while at != END {
            nearest_first[count] = at;
            (count, at) = (count + 1, self.fragments[at as usize].next);
        }
        let mut seen = None;
        for &index in nearest_first[..count].iter().rev() {
            let fragment = &self.fragments[index as usize];
            let at = frame.pattern.centroid_in(x, y, fragment.mask);
            let shaded = frame.shader.shade(frame.geometry.face(fragment.face), at);
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

/// Whether a transparent face at inverse depth `depth` shows before an opaque face.
///
/// In the same plane a drape shows over the ground and over drapes that come before it in the list; drapes that come
/// after it cover it.
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
