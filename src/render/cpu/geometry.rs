//! Converts the triangles of a draw list to faces and pieces for the rasterizer.
//!
//! A [`ScreenFace`] is a triangle with all that shading needs; a [`FacePiece`] is a part of its outline on the picture,
//! usually the only one. Triangles are processed in parallel in chunks of [`CHUNK`], each from its three vertices:
//! projecting a vertex again for each of its triangles costs less than storing it. Chunks keep the list's order, so that
//! the picture does not depend on threads.
//!
//! A picture of many triangles is drawn in [`strips`](crate::cpu::strips) of rows, one after the other, each from the faces
//! that it may show, so that memory does not grow with the list.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::cpu::clip::{Outline, SeenPart, clipped};
use crate::cpu::pattern::SamplePattern;
use crate::cpu::plane::TrianglePlanes;
use crate::cpu::raster::{PixelWindow, SubpixelBox, SubpixelPoint, doubled_area, sample_places, snapped};
use crate::cpu::screen::{Projection, Screen};
use sandtable_draw::list::{DRAPE_TOLERANCE, DepthLayer, DrawItem, DrawList, DrawMesh};
use sandtable_draw::material::AlphaMode;

/// Triangles per chunk; a power of two, so that a face's id splits into chunk and index.
const CHUNK: u64 = 2048;

/// Triangles of which is known together which rows they may touch: few, since those that follow each other in a list lie near
/// each other for a while, a chunk of roads all over the picture.
const BLOCK: u64 = 32;

/// The least [`drape_tolerance`] with parallel rays: eight times the rounding of a nearness to f32, 10 cm over 100 km.
const PARALLEL_DRAPE_TOLERANCE: f64 = 1e-6;

/// The most that [`drape_tolerance`] grows to where the eye is almost in the drape's plane.
const MOST_DRAPE_TOLERANCE: f64 = 1e-3;

/// A face: the number of its chunk × [`CHUNK`] + its index in the chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceId(pub u32);

impl FaceId {
    /// No face: the sky.
    pub const NONE: Self = Self(u32::MAX);
}

#[derive(Clone, Copy, Debug)]
pub struct ScreenFace {
    pub item: u32,
    pub triangle: u32,
    /// Depth and corner weights over the picture.
    pub planes: TrianglePlanes,
    /// The least and greatest nearness of the part before the near plane.
    pub range: [f32; 2],
    /// For draped items, 1 + the part of a depth by which it may lie behind; 1 for all others.
    pub reach: f32,
}

impl ScreenFace {
    /// The nearness at a pixel position, clamped to the range of the face's corners.
    pub fn nearness(&self, at: [f32; 2]) -> f32 {
        (self.planes.nearness.at(at) as f32).max(self.range[0]).min(self.range[1])
    }
}

#[derive(Clone, Copy, Debug)]
pub struct FacePiece {
    /// Sub-pixel corners with a positive area.
    pub corners: [SubpixelPoint; 3],
    /// The pixels it may touch; never empty.
    pub window: PixelWindow,
    pub face: FaceId,
    pub alpha: AlphaMode,
}

/// The faces of up to [`CHUNK`] consecutive triangles of the list.
#[derive(Debug)]
struct FaceChunk {
    faces: Vec<ScreenFace>,
    pieces: Vec<FacePiece>,
    /// The rows of pixels that its pieces may touch.
    rows: Range<u32>,
}

/// The faces of a strip of rows.
#[derive(Debug)]
pub struct ScreenGeometry {
    chunks: Vec<FaceChunk>,
}

/// A list as a screen sees it, before its triangles are faces.
#[derive(Debug)]
pub struct GeometrySource<'a> {
    list: &'a DrawList,
    screen: &'a Screen,
    /// The triangles up to the end of each item.
    ends: Vec<u64>,
    total: u64,
    /// Where samples lie in a pixel.
    samples: Vec<SubpixelPoint>,
}

/// A triangle on the picture that may show.
struct SeenTriangle {
    /// Its corners, from the eye in meters along the world's axes.
    offsets: [DVec3; 3],
    /// The same in homogeneous pixels.
    points: [DVec3; 3],
    outline: SeenOutline,
    /// The pixels that it may touch.
    window: PixelWindow,
}

/// The outline of what is seen of a triangle.
enum SeenOutline {
    /// All of it: its corners in sub-pixels.
    Whole([SubpixelPoint; 3]),
    /// What is left of it, and the same in sub-pixels.
    Cut(Box<Outline>, Vec<SubpixelPoint>),
}

struct ItemSetup<'a> {
    screen: &'a Screen,
    mesh: &'a DrawMesh,
    item: &'a DrawItem,
    index: u32,
    projection: Projection<'a>,
    alpha: AlphaMode,
    two_sided: bool,
    samples: &'a [SubpixelPoint],
    /// The rows of pixels that are drawn.
    drawn: &'a Range<u32>,
}

impl<'a> GeometrySource<'a> {
    /// The source of a checked list whose pixels have the samples of `pattern`. `None` where the list draws more triangles than
    /// ids can number (2^32).
    pub fn new<const N: usize>(
        list: &'a DrawList,
        screen: &'a Screen,
        pattern: &SamplePattern<N>,
    ) -> Option<Self> {
        let mut total = 0;
        let ends = list.items.iter().map(|item| {
            total += item.triangles.len() as u64;
            total
        });
        let ends: Vec<u64> = ends.collect();
        (total < u64::from(u32::MAX) - CHUNK).then_some(Self {
            list,
            screen,
            ends,
            total,
            samples: sample_places(pattern),
        })
    }

    /// The screen.
    pub fn screen(&self) -> &'a Screen {
        self.screen
    }

    /// The number of triangles, seen or not.
    pub fn triangle_count(&self) -> u64 {
        self.total
    }

    /// The rows of all pixels.
    pub fn rows(&self) -> Range<u32> {
        0..self.screen.size[1]
    }

    /// The faces that may be seen in `rows`, in the list's order. `block_rows` are those that each block of triangles may touch,
    /// where that is known.
    pub fn geometry(&self, rows: &Range<u32>, block_rows: &[Range<u32>]) -> ScreenGeometry {
        let is_seen = |&block: &u64| {
            let own = block_rows.get(block as usize);
            own.is_none_or(|own| own.start < rows.end && rows.start < own.end)
        };
        let chunk = |number: u64| {
            let first = number * CHUNK;
            let blocks = first / BLOCK..(first + CHUNK).min(self.total).div_ceil(BLOCK);
            build_chunk(self, first, blocks.filter(is_seen).map(|block| self.block(block)), rows)
        };
        ScreenGeometry { chunks: (0..self.total.div_ceil(CHUNK)).into_par_iter().map(chunk).collect() }
    }

    /// The rows that each block of triangles may touch; calls `visit` with those of each triangle, in any order and on all
    /// threads.
    pub fn survey(&self, visit: impl Fn(Range<u32>) + Sync) -> Vec<Range<u32>> {
        let rows = self.rows();
        let surveyed = |block: u64| {
            let (mut top, mut bottom) = (u32::MAX, 0);
            each_triangle(self, self.block(block), &rows, |setup, triangle| {
                if let Some(SeenTriangle { window: PixelWindow { from, to }, .. }) = setup.seen(triangle) {
                    visit(from[1]..to[1]);
                    (top, bottom) = (top.min(from[1]), bottom.max(to[1]));
                }
            });
            top..bottom
        };
        (0..self.total.div_ceil(BLOCK)).into_par_iter().map(surveyed).collect()
    }

    /// The triangles of a block, counted through all items.
    fn block(&self, number: u64) -> Range<u64> {
        number * BLOCK..((number + 1) * BLOCK).min(self.total)
    }
}

impl ScreenGeometry {
    /// The face with this id, which must be one of this geometry's.
    pub fn face(&self, id: FaceId) -> &ScreenFace {
        let id = u64::from(id.0);
        &self.chunks[(id / CHUNK) as usize].faces[(id % CHUNK) as usize]
    }

    /// The pieces that may touch pixels of `window`.
    ///
    /// Triangles that follow each other in a list mostly lie near each other: most chunks are passed over as a whole.
    pub fn pieces_in(&self, window: PixelWindow) -> impl Iterator<Item = &FacePiece> {
        let [top, bottom] = [window.from[1], window.to[1]];
        let chunks =
            self.chunks.iter().filter(move |chunk| chunk.rows.start < bottom && top < chunk.rows.end);
        let pieces = chunks.flat_map(|chunk| &chunk.pieces);
        pieces.filter(move |piece| !piece.window.intersection(window).is_empty())
    }
}

/// Calls `visit` with each of the triangles number `triangles`, counted through all items, and the setup of its item.
fn each_triangle(
    source: &GeometrySource,
    triangles: Range<u64>,
    drawn: &Range<u32>,
    mut visit: impl FnMut(&ItemSetup<'_>, u32),
) {
    let ends = &source.ends;
    let mut index = ends.partition_point(|&end| end <= triangles.start);
    let mut next = triangles.start;
    while next < triangles.end {
        let setup = ItemSetup::new(source, index, drawn);
        let range = &setup.item.triangles;
        let start = ends[index] - range.len() as u64;
        let end = ends[index].min(triangles.end);
        for number in next..end {
            visit(&setup, range.start + (number - start) as u32);
        }
        (next, index) = (end, index + 1);
    }
}

/// The faces of those triangles of the chunk that begins with number `first` that lie in `blocks` and may be seen in the rows
/// `drawn`; counted through all items.
fn build_chunk(
    source: &GeometrySource,
    first: u64,
    blocks: impl Iterator<Item = Range<u64>> + Clone,
    drawn: &Range<u32>,
) -> FaceChunk {
    let most = blocks.clone().map(|triangles| (triangles.end - triangles.start) as usize).sum();
    let (faces, pieces) = (Vec::with_capacity(most), Vec::with_capacity(most));
    let mut chunk = FaceChunk { faces, pieces, rows: 0..0 };
    for triangles in blocks {
        each_triangle(source, triangles, drawn, |setup, triangle| {
            let id = FaceId(first as u32 + chunk.faces.len() as u32);
            setup.add_triangle(&mut chunk, triangle, id);
        });
    }
    let (mut top, mut bottom) = (u32::MAX, 0);
    for PixelWindow { from, to } in chunk.pieces.iter().map(|piece| piece.window) {
        (top, bottom) = (top.min(from[1]), bottom.max(to[1]));
    }
    chunk.rows = top..bottom;
    // Of many triangles most are out of view.
    chunk.faces.shrink_to_fit();
    chunk.pieces.shrink_to_fit();
    chunk
}

impl<'a> ItemSetup<'a> {
    fn new(source: &'a GeometrySource, index: usize, drawn: &'a Range<u32>) -> Self {
        let GeometrySource { list, screen, samples, .. } = source;
        let item = &list.items[index];
        let material = &list.materials[item.material.0 as usize];
        Self {
            screen,
            mesh: &list.meshes[item.mesh.0 as usize],
            item,
            index: index as u32,
            projection: screen.projection(&item.world_from_mesh),
            alpha: material.alpha,
            two_sided: material.two_sided,
            samples,
            drawn,
        }
    }

    /// A triangle on the picture, unless it shows in no pixel that is drawn: most of many are out of view, turned away or
    /// between the samples.
    fn seen(&self, triangle: u32) -> Option<SeenTriangle> {
        let corners =
            self.mesh.triangles[triangle as usize].map(|id| self.mesh.vertices[id.index()].position);
        let offsets = corners.map(|position| self.projection.eye_from_mesh(position));
        let points = offsets.map(|offset| self.projection.pixels_from_eye(offset));
        if !points.iter().all(|point| point.is_finite()) {
            return None;
        }
        let outline = match clipped(&points, self.screen)? {
            SeenPart::Whole => SeenOutline::Whole(points.map(snapped_corner)),
            SeenPart::Cut(outline) => {
                let snapped = outline.corners().iter().copied().map(snapped_corner).collect();
                SeenOutline::Cut(outline, snapped)
            }
        };
        let snapped = outline.snapped();
        let bounds = SubpixelBox::around(snapped);
        let window = bounds.pixels(self.screen.size);
        let is_drawn = window.from[1] < self.drawn.end && self.drawn.start < window.to[1];
        if !is_drawn || window.is_empty() || bounds.is_between(self.samples) {
            return None;
        }
        if let [a, b, c] = *snapped {
            // Counter-clockwise as seen is the negative sense on a picture whose rows run down.
            let area = doubled_area(&[a, c, b]);
            if area == 0 || (area < 0 && !self.two_sided) {
                return None;
            }
        }
        Some(SeenTriangle { offsets, points, outline, window })
    }

    fn add_triangle(&self, chunk: &mut FaceChunk, triangle: u32, id: FaceId) {
        let Some(seen) = self.seen(triangle) else { return };
        let SeenTriangle { offsets, points, ref outline, .. } = seen;
        let nearness = || offsets.map(|offset| self.screen.nearness(self.screen.depth_from_eye(offset)));
        let planes = match self.screen.is_parallel {
            false => TrianglePlanes::from_corners(points),
            true => TrianglePlanes::from_parallel(points, nearness()),
        };
        let Some(planes) = planes else { return };
        if !(planes.faces_eye || self.two_sided) {
            return;
        }
        let known = chunk.pieces.len();
        self.push_pieces(&mut chunk.pieces, &seen, planes.faces_eye, id);
        if chunk.pieces.len() == known {
            return;
        }
        let tolerance = match self.item.layer {
            DepthLayer::Draped(_) => drape_tolerance(&offsets, self.screen),
            DepthLayer::Ground | DepthLayer::Solid => 0.0,
        };
        let range = match self.screen.is_parallel {
            false => nearness_range(outline.corners(&points), self.screen.near),
            true => nearness().map(|corner| corner as f32).into_iter().fold([f32::MAX, f32::MIN], extended),
        };
        let reach = (1.0 + tolerance) as f32;
        chunk.faces.push(ScreenFace { item: self.index, triangle, planes, range, reach });
    }

    /// The outline as a fan of triangles that may touch a pixel that is drawn.
    fn push_pieces(&self, pieces: &mut Vec<FacePiece>, seen: &SeenTriangle, faces_eye: bool, face: FaceId) {
        let [a, rest @ ..] = seen.outline.snapped() else { return };
        let is_whole = rest.len() == 2;
        for pair in rest.windows(2) {
            let (a, b, c) = (*a, pair[0], pair[1]);
            let corners = if faces_eye { [a, c, b] } else { [a, b, c] };
            let window = if is_whole { seen.window } else { PixelWindow::around(&corners, self.screen.size) };
            let is_drawn = window.from[1] < self.drawn.end && self.drawn.start < window.to[1];
            if is_drawn && doubled_area(&corners) > 0 && !window.is_empty() {
                pieces.push(FacePiece { corners, window, face, alpha: self.alpha });
            }
        }
    }
}

impl SeenOutline {
    fn snapped(&self) -> &[SubpixelPoint] {
        match self {
            Self::Whole(snapped) => snapped,
            Self::Cut(_, snapped) => snapped,
        }
    }

    /// In homogeneous pixels; `points` are the triangle's corners.
    fn corners<'a>(&'a self, points: &'a [DVec3; 3]) -> &'a [DVec3] {
        match self {
            Self::Whole(_) => points,
            Self::Cut(outline, _) => outline.corners(),
        }
    }
}

/// The sub-pixel position of a corner in homogeneous pixels.
fn snapped_corner(corner: DVec3) -> SubpixelPoint {
    [snapped(corner.x / corner.z), snapped(corner.y / corner.z)]
}

/// The least and greatest `1 / w` among the corners. Cutting a triangle of astronomic size can leave a corner slightly
/// before the near plane, or even behind the eye: both are clamped to what a camera sees.
fn nearness_range(corners: &[DVec3], near: f64) -> [f32; 2] {
    let inverses = corners.iter().map(|corner| (1.0 / corner.z).clamp(0.0, 1.0 / near) as f32);
    inverses.fold([f32::MAX, 0.0], extended)
}

fn extended([least, most]: [f32; 2], value: f32) -> [f32; 2] {
    [least.min(value), most.max(value)]
}

/// The part of a depth by which a draped triangle may lie behind the ground it was cut from. At least
/// [`DRAPE_TOLERANCE`]. A corner rounded to f32 leaves the ground's plane by up to one step of its largest coordinate.
/// Seen from an eye at distance `e` from that plane, this changes depths by that step over `e`: close above a road far
/// from the origin this is the larger of the two.
///
/// Parallel rays meet the plane everywhere at the same angle: the step over the cosine of that angle, as a part of the
/// least nearness, which is 1; at least [`PARALLEL_DRAPE_TOLERANCE`].
fn drape_tolerance(offsets: &[DVec3; 3], screen: &Screen) -> f64 {
    let [a, b, c] = *offsets;
    let eye = screen.eye;
    let normal = (b - a).cross(c - a);
    let eye_height = (normal.dot(a) / normal.length()).abs();
    let largest = offsets.iter().map(|offset| (*offset + eye).abs().max_element()).fold(0.0, f64::max);
    let rounding_m = largest * f64::from(f32::EPSILON);
    if screen.is_parallel {
        let cosine = (normal.dot(screen.forward) / normal.length()).abs();
        let share = rounding_m / (cosine * screen.far);
        return PARALLEL_DRAPE_TOLERANCE.max(share).min(MOST_DRAPE_TOLERANCE);
    }
    let rounding = rounding_m / eye_height;
    // `max` first: it turns the NaN of a degenerate triangle into the least tolerance.
    DRAPE_TOLERANCE.max(rounding).min(MOST_DRAPE_TOLERANCE)
}
