//! The summary of every patch, however large the terrain.
//!
//! Gathered in one pass over squares of patches, each with its surroundings: memory does not grow with the terrain, and only
//! the borders of the squares are read and measured twice.

use glam::{Vec2, Vec3};

use crate::block::BlockError;
use crate::culling::PatchHeights;
use crate::graph::Vertex;
use crate::paging::region::{PagedFrame, PagedRegion, Patches};
use crate::patched_ground::PatchedGround;
use crate::spheres::SphereMap;
use sandtable_raster::windows::Windows;

/// Patches along a square of the pass. With the surroundings 10 or 11 are measured for 8, 1.6 times the least work, and
/// 450,000 vertices of patches of 64 are in memory; 16 would save a fifth of the work for 3.3 times the memory.
const SQUARE: i32 = 8;

/// One patch as seen from afar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchSummary {
    /// Displayed Z of the corners, meters: south-west, south-east, north-west, north-east; NaN without data.
    pub corners: [f32; 4],
    /// Displayed Z of the middle, meters; 0 without data.
    pub middle: f32,
    /// Radius of the middle's nested sphere, meters. It holds the spheres of all vertices of the patch, including those on
    /// its border, which all descend from the middle.
    pub radius: f32,
    /// Lowest displayed Z, meters; above `high` where the patch holds no data.
    pub low: f32,
    /// Highest displayed Z, meters.
    pub high: f32,
}

impl PatchSummary {
    /// The patch with south-west corner `corner` of a ground in memory with its surroundings.
    pub fn new(
        ground: PatchedGround<'_>,
        spheres: &SphereMap,
        heights: &PatchHeights,
        corner: Vertex,
    ) -> Self {
        let side = ground.layout.patch();
        let z = |x, y| ground.lattice.height(ground.layout.post(corner.moved(x, y)));
        let middle = corner.moved(side / 2, side / 2);
        let (low, high) = heights.range(corner);
        Self {
            corners: [z(0, 0), z(side, 0), z(0, side), z(side, side)],
            middle: ground.position(middle).z,
            radius: spheres.at(ground.layout, middle),
            low,
            high,
        }
    }

    /// Whether the eye is outside all spheres of the patch, whose middle is at `middle` in plan, so that it is drawn as its
    /// two root triangles.
    pub fn is_far(&self, middle: Vec2, eye: Vec3) -> bool {
        let distance = crate::criterion::spheres::distance(eye, middle.extend(self.middle));
        self.radius == 0.0 || distance >= f64::from(self.radius)
    }
}

/// The summaries of all patches, in the layout's patch order; `spheres` measures a ground.
///
/// # Errors
/// The first piece that cannot be read, by its south-west patch.
pub fn summaries(
    windows: &mut impl Windows,
    frame: &PagedFrame,
    spheres: &impl Fn(PatchedGround<'_>) -> SphereMap,
) -> Result<Vec<PatchSummary>, BlockError> {
    let layout = &frame.layout;
    let nothing = PatchSummary { corners: [f32::NAN; 4], middle: 0.0, radius: 0.0, low: 0.0, high: 0.0 };
    let mut summaries = vec![nothing; layout.patch_count()];
    for square in squares(layout.patch_grid()) {
        let region = PagedRegion::read(windows, frame, square).map_err(|source| {
            let side = layout.patch() as u32;
            let (column, row) = (square.first.0 as u32 * side, square.first.1 as u32 * side);
            BlockError { column, row, source }
        })?;
        let ground = region.ground();
        let (map, heights) = (spheres(ground), PatchHeights::new(ground));
        for corner in layout.patches_within(square.first, square.last) {
            summaries[layout.patch_index(corner)] =
                PatchSummary::new(ground, &map, &heights, region.own(corner));
        }
    }
    Ok(summaries)
}

/// The terrain's patches in squares, row by row.
fn squares((east, north): (usize, usize)) -> impl Iterator<Item = Patches> {
    let (east, north) = (east as i32, north as i32);
    (0..north).step_by(SQUARE as usize).flat_map(move |y| {
        (0..east).step_by(SQUARE as usize).map(move |x| {
            let last = ((x + SQUARE).min(east) - 1, (y + SQUARE).min(north) - 1);
            Patches { first: (x, y), last }
        })
    })
}
