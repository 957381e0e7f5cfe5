//! Triangles of a draw list to faces and pieces: what may be seen, ready to be rasterized.
//!
//! A [`ScreenFace`] is one triangle with all that shading needs; a [`FacePiece`] is a part of its outline on the
//! picture, most often the only one. Triangles are taken in chunks of [`CHUNK`], in parallel, each from its
//! three vertices on: projecting a vertex anew for each of its triangles costs less than storing it. Chunks
//! keep the list's order, which is what makes the picture independent of threads.

use glam::DVec3;
use rayon::prelude::*;

use crate::draw::list::{DepthLayer, DrawItem, DrawList};
use crate::draw::material::AlphaMode;
use crate::render::cpu::clip::{Outline, clipped};
use crate::render::cpu::plane::TrianglePlanes;
use crate::render::cpu::raster::{PixelWindow, SubpixelPoint, doubled_area, snapped};
use crate::render::cpu::screen::{Projection, Screen};

/// Triangles a chunk; a power of two, so that a face's id splits into chunk and place.
const CHUNK: u64 = 2048;

/// The depth by which a draped surface may lie behind what it is draped on, as a part of that depth.
const DRAPE_TOLERANCE: f64 = 1.0 / 50_000.0;

/// The most that [`drape_tolerance`] grows to where the eye is almost in the drape's plane.
const MOST_DRAPE_TOLERANCE: f64 = 1e-3;

/// Which face: the chunk's number × [`CHUNK`] + the place in the chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceId(pub u32);

impl FaceId {
    /// No face: the sky.
    pub const NONE: Self = Self(u32::MAX);
}

/// One triangle of the list that may be seen.
#[derive(Clone, Copy, Debug)]
pub struct ScreenFace {
    /// The item's index in the list.
    pub item: u32,
    /// The triangle's index in its mesh.
    pub triangle: u32,
    /// Depth and corner shares over the picture.
    pub planes: TrianglePlanes,
    /// The least and greatest inverse depth of the part before the near plane.
    pub range: [f32; 2],
    /// For draped items, 1 + the part of a depth by which it may lie behind; 1 for all else.
    pub reach: f32,
}

impl ScreenFace {
    /// Whether it lies in the ground's plane, and not before it by a shape of its own.
    pub fn is_draped(&self) -> bool {
        self.reach > 1.0
    }

    /// The inverse depth at a pixel position, kept to what the face's corners span.
    pub fn inverse_depth(&self, at: [f32; 2]) -> f32 {
        (self.planes.inverse_depth.at(at) as f32).max(self.range[0]).min(self.range[1])
    }
}

/// How a piece enters the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RasterPass {
    /// Hides what is behind it.
    Opaque,
    /// Hides what is behind it where its alpha reaches the cut-off.
    Mask,
    /// Lets through a part of what is behind it.
    Blend,
}

/// A triangular part of a face's outline.
#[derive(Clone, Copy, Debug)]
pub struct FacePiece {
    /// Sub-pixel corners with a positive area.
    pub corners: [SubpixelPoint; 3],
    /// The pixels it may touch; never empty.
    pub window: PixelWindow,
    /// Its face.
    pub face: FaceId,
    /// How it is drawn.
    pub pass: RasterPass,
}

/// The faces of up to [`CHUNK`] triangles that follow each other in the list.
#[derive(Debug, Default)]
struct FaceChunk {
    faces: Vec<ScreenFace>,
    pieces: Vec<FacePiece>,
}

/// All faces and pieces of a list as one camera sees them.
#[derive(Debug)]
pub struct ScreenGeometry {
    chunks: Vec<FaceChunk>,
}

/// What the triangles of one item have in common.
struct ItemSetup<'a> {
    item: &'a DrawItem,
    index: u32,
    projection: Projection,
    pass: RasterPass,
    two_sided: bool,
    is_draped: bool,
}

impl ScreenGeometry {
    /// The faces of a checked `list` that `screen` may see, in the list's order.
    ///
    /// `None` where the list draws more triangles than ids can number (2^32).
    pub fn of(list: &DrawList, screen: &Screen) -> Option<Self> {
        let mut ends = Vec::with_capacity(list.items.len());
        let mut total = 0u64;
        for item in &list.items {
            total += item.triangles.len() as u64;
            ends.push(total);
        }
        if total >= u64::from(u32::MAX) - CHUNK {
            return None;
        }
        let chunk = |number: u64| {
            let triangles = number * CHUNK..((number + 1) * CHUNK).min(total);
            build_chunk(list, screen, &ends, triangles, (number * CHUNK) as u32)
        };
        Some(Self { chunks: (0..total.div_ceil(CHUNK)).into_par_iter().map(chunk).collect() })
    }

    /// The face with this id, which must be one of this geometry's.
    pub fn face(&self, id: FaceId) -> &ScreenFace {
        let id = u64::from(id.0);
        &self.chunks[(id / CHUNK) as usize].faces[(id % CHUNK) as usize]
    }

    /// All pieces in the list's order.
    pub fn pieces(&self) -> impl Iterator<Item = &FacePiece> {
        self.chunks.iter().flat_map(|chunk| &chunk.pieces)
    }
}

/// The faces of the list's triangles number `triangles`, counted through all items.
fn build_chunk(
    list: &DrawList,
    screen: &Screen,
    ends: &[u64],
    triangles: std::ops::Range<u64>,
    first_id: u32,
) -> FaceChunk {
    let mut chunk = FaceChunk::default();
    let mut index = ends.partition_point(|&end| end <= triangles.start);
    let mut next = triangles.start;
    while next < triangles.end {
        let item = &list.items[index];
        let start = ends[index] - item.triangles.len() as u64;
        let end = ends[index].min(triangles.end);
        let setup = ItemSetup::new(list, screen, index);
        for number in next..end {
            let triangle = item.triangles.start + (number - start) as u32;
            let id = FaceId(first_id + chunk.faces.len() as u32);
            add_triangle(&mut chunk, list, screen, &setup, triangle, id);
        }
        (next, index) = (end, index + 1);
    }
    chunk
}

impl<'a> ItemSetup<'a> {
    fn new(list: &'a DrawList, screen: &Screen, index: usize) -> Self {
        let item = &list.items[index];
        let material = &list.materials[item.material.0 as usize];
        Self {
            item,
            index: index as u32,
            projection: screen.projection(&item.world_from_mesh),
            pass: match material.alpha {
                AlphaMode::Opaque => RasterPass::Opaque,
                AlphaMode::Mask(_) => RasterPass::Mask,
                AlphaMode::Blend => RasterPass::Blend,
            },
            two_sided: material.two_sided,
            is_draped: matches!(item.layer, DepthLayer::Draped(_)),
        }
    }
}

/// Adds the triangle's face and pieces, if it can be seen.
fn add_triangle(
    chunk: &mut FaceChunk,
    list: &DrawList,
    screen: &Screen,
    setup: &ItemSetup,
    triangle: u32,
    id: FaceId,
) {
    let mesh = &list.meshes[setup.item.mesh.0 as usize];
    let corners = mesh.triangles[triangle as usize].map(|id| mesh.vertices[id.index()].position);
    let offsets = corners.map(|position| setup.projection.eye_from_mesh(position));
    let points = offsets.map(|offset| setup.projection.pixels_from_eye(offset));
    if !points.iter().all(|point| point.is_finite()) {
        return;
    }
    let Some(outline) = clipped(points, screen) else { return };
    let Some(planes) = TrianglePlanes::of(points) else { return };
    if !(planes.faces_eye || setup.two_sided) {
        return;
    }
    let known = chunk.pieces.len();
    push_pieces(&mut chunk.pieces, &outline, &planes, screen, (id, setup.pass));
    if chunk.pieces.len() == known {
        return;
    }
    let reach = if setup.is_draped { 1.0 + drape_tolerance(&offsets, screen.eye()) } else { 1.0 };
    chunk.faces.push(ScreenFace {
        item: setup.index,
        triangle,
        planes,
        range: inverse_depth_range(&outline, screen.near),
        reach: reach as f32,
    });
}

/// The outline as a fan of snapped triangles that may touch a pixel.
fn push_pieces(
    pieces: &mut Vec<FacePiece>,
    outline: &Outline,
    planes: &TrianglePlanes,
    screen: &Screen,
    (face, pass): (FaceId, RasterPass),
) {
    let snap = |corner: &DVec3| [snapped(corner.x / corner.z), snapped(corner.y / corner.z)];
    let [first, rest @ ..] = outline.corners() else { return };
    for pair in rest.windows(2) {
        let [a, b, c] = [snap(first), snap(&pair[0]), snap(&pair[1])];
        // Counter-clockwise as seen is the negative sense on a picture whose rows run down.
        let corners = if planes.faces_eye { [a, c, b] } else { [a, b, c] };
        let window = PixelWindow::around(&corners, screen.size);
        if doubled_area(&corners) > 0 && !window.is_empty() {
            pieces.push(FacePiece { corners, window, face, pass });
        }
    }
}

/// The least and greatest `1 / w` among the corners.
///
/// Cutting a triangle of astronomic size can leave a corner a little before the near plane, or even behind
/// the eye, so both are kept to what a camera sees.
fn inverse_depth_range(outline: &Outline, near: f64) -> [f32; 2] {
    let inverses = outline.corners().iter().map(|corner| (1.0 / corner.z).clamp(0.0, 1.0 / near) as f32);
    inverses.fold([f32::MAX, 0.0], |[least, most], inverse| [least.min(inverse), most.max(inverse)])
}

/// The part of a depth by which a draped triangle may lie behind the ground it was cut from.
///
/// At least [`DRAPE_TOLERANCE`]. A corner rounded to f32 leaves the ground's plane by up to one step of
/// its largest coordinate; seen from an eye at distance `e` from that plane, this changes depths by that
/// step over `e`. Close above a road far from the origin this is the larger of the two.
fn drape_tolerance(offsets: &[DVec3; 3], eye: DVec3) -> f64 {
    let [a, b, c] = *offsets;
    let normal = (b - a).cross(c - a);
    let eye_height = (normal.dot(a) / normal.length()).abs();
    let largest = offsets.iter().map(|offset| (*offset + eye).abs().max_element()).fold(0.0, f64::max);
    let rounding = largest * f64::from(f32::EPSILON) / eye_height;
    // `max` first: it turns the NaN of a degenerate triangle into the least tolerance.
    DRAPE_TOLERANCE.max(rounding).min(MOST_DRAPE_TOLERANCE)
}
