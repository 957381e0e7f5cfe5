//! The far ground of a walk over terrain on disk: patches of two triangles each, many at a time, and a backdrop under all.
//!
//! ```text
//!  ┌──┬──┬──┬──┐   a block: one vertex a corner of its patches, two triangles a patch,
//!  │╱ │ ╲│╱ │ ╲│   none where a patch is near (N): that is handed over as itself
//!  ├──┼──┼──┼──┤
//!  │ ╲│N │N │╱ │   A block has as many vertices as any patch.
//!  └──┴──┴──┴──┘
//! ```
//!
//! Where a patch is near but not read yet, its two triangles do not fit the vertices of its refined neighbors. The backdrop
//! lies below all ground and shows through such gaps, so that no sky does.

use glam::Vec3;

use sandtable_raster::windows::Windows;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::BlockSource;
use sandtable_roam::graph::Vertex;
use sandtable_roam::paging::ground::PagedGround;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::shown::LocalTriangle;
use sandtable_roam::spheres::SphereMap;

/// Patches that are two triangles each.
#[derive(Clone, Debug)]
pub(super) struct FarBlock {
    /// The south-west corners of its patches, row by row.
    pub patches: Vec<Vertex>,
    /// The box of its ground; `None` without data.
    pub bounds: Option<(Vec3, Vec3)>,
    /// Those that were near when it was handed over last; `None` while it is not shown.
    pub near: Option<Vec<Vertex>>,
    /// Whether its vertices were handed over.
    pub is_held: bool,
}

/// The blocks of all patches, row by row.
pub(super) fn far_blocks<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &PagedGround<W, S>,
) -> Vec<FarBlock> {
    let layout = ground.layout();
    let (side, (east, north)) = (layout.patch() as usize, layout.patch_grid());
    let firsts = (0..north).step_by(side).flat_map(|y| (0..east).step_by(side).map(move |x| (x, y)));
    let block = |(x, y): (usize, usize)| {
        let last = ((x + side - 1) as i32, (y + side - 1) as i32);
        let patches: Vec<Vertex> = layout.patches_within((x as i32, y as i32), last).collect();
        let boxes = patches.iter().filter_map(|&corner| ground.bounds(corner));
        let bounds = boxes.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)));
        FarBlock { patches, bounds, near: None, is_held: false }
    };
    firsts.map(block).collect()
}

impl FarBlock {
    /// The patches that are refined for an eye.
    pub fn near<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
        &self,
        ground: &PagedGround<W, S>,
        eye: Vec3,
    ) -> Vec<Vertex> {
        let has_data = |corner: &Vertex| ground.summary(*corner).low <= ground.summary(*corner).high;
        let near = self.patches.iter().copied().filter(|&corner| !ground.is_far(corner, eye));
        near.filter(has_data).collect()
    }

    /// The vertices, as many as a patch has; those past the last patch are where its corners are.
    pub fn positions<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
        &self,
        ground: &PagedGround<W, S>,
    ) -> Vec<[f32; 3]> {
        let (layout, Vertex { x, y }) = (ground.layout(), self.patches[0]);
        let side = layout.patch();
        let mut positions = vec![[0.0; 3]; ((side + 1) * (side + 1)) as usize];
        for &corner in &self.patches {
            let [column, row] = [(corner.x - x) / side, (corner.y - y) / side];
            let corners = ground.corners(corner);
            for (at, [east, north]) in corners.into_iter().zip([[0, 0], [1, 0], [0, 1], [1, 1]]) {
                let z = if at.z.is_nan() { 0.0 } else { at.z };
                positions[((row + north) * (side + 1) + column + east) as usize] = [at.x, at.y, z];
            }
        }
        positions
    }

    /// Two triangles a patch that is not near, but for those without data at a corner.
    pub fn triangles<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
        &self,
        ground: &PagedGround<W, S>,
        near: &[Vertex],
    ) -> Vec<LocalTriangle> {
        let (side, origin, mut near) = (ground.layout().patch(), self.patches[0], near.iter().peekable());
        let mut triangles = Vec::with_capacity(2 * self.patches.len());
        for &corner in &self.patches {
            if near.next_if(|&&near| near == corner).is_some() {
                continue;
            }
            let z = ground.summary(corner).corners;
            let has_data =
                |at: &Vertex| !z[usize::from(at.x > corner.x) + 2 * usize::from(at.y > corner.y)].is_nan();
            let local =
                |at: Vertex| ((at.y - origin.y) / side * (side + 1) + (at.x - origin.x) / side) as u16;
            let roots = Triangle::roots(corner, side).map(|root| root.corners());
            triangles.extend(
                roots
                    .into_iter()
                    .filter(|corners| corners.iter().all(has_data))
                    .map(|corners| corners.map(local)),
            );
        }
        triangles
    }
}

/// A coarse surface below all ground, as one patch: where heights differ, and on a level lake by a cell, it is never seen but
/// through gaps. Where a patch lacks data at a corner there is none.
pub(super) fn backdrop<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &PagedGround<W, S>,
) -> (Vec<[f32; 3]>, Vec<LocalTriangle>) {
    let layout = ground.layout();
    let (side, (east, north)) = (layout.patch(), layout.patch_grid());
    let step = (east.max(north) as i32 + side - 1) / side;
    let low = |x: i32, y: i32| -> Option<f32> {
        let inside = x >= 0 && y >= 0;
        let patches = layout.patches_within((x * step, y * step), ((x + 1) * step - 1, (y + 1) * step - 1));
        let lows = patches.filter(|_| inside).map(|corner| {
            let summary = ground.summary(corner);
            let is_whole = summary.corners.iter().all(|z| !z.is_nan());
            if is_whole { summary.low } else { f32::NAN }
        });
        lows.reduce(|a, b| if a.is_nan() || b.is_nan() { f32::NAN } else { a.min(b) })
            .filter(|low| !low.is_nan())
    };
    let lows: Vec<Option<f32>> =
        (-1..=side).flat_map(|y| (-1..=side).map(move |x| (x, y))).map(|(x, y)| low(x, y)).collect();
    let at = |x: i32, y: i32| lows[((y + 1) * (side + 2) + x + 1) as usize];
    let beneath = ground.plan(Vertex::new(1, 1)).max_element();
    let mut positions = Vec::with_capacity(((side + 1) * (side + 1)) as usize);
    let mut triangles = Vec::new();
    for y in 0..=side {
        for x in 0..=side {
            let plan = ground.plan(Vertex::new(x * step * side, y * step * side));
            let around = [at(x - 1, y - 1), at(x, y - 1), at(x - 1, y), at(x, y)];
            let z = around.into_iter().flatten().reduce(f32::min).map_or(0.0, |z| z - beneath);
            positions.push([plan.x, plan.y, z]);
            if x < side && y < side && at(x, y).is_some() {
                let corner = |x: i32, y: i32| (y * (side + 1) + x) as u16;
                let [sw, se, nw, ne] =
                    [corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1)];
                triangles.extend([[sw, se, ne], [sw, ne, nw]]);
            }
        }
    }
    (positions, triangles)
}
