//! Makes triangles for an eye, patch by patch, without a mesh kept between frames.
//!
//! A vertex is active exactly while the eye is inside its sphere. Spheres are nested, so the active vertices of a patch are
//! closed under parents; and a vertex on a border has the same sphere in both patches, so each patch is a function of the
//! eye alone and still fits its neighbors.

use glam::{Vec2, Vec3};

use crate::bintree::Triangle;
use crate::block::{BlockError, BlockSource, PatchBlock};
use crate::criterion::spheres::distance;
use crate::graph::Vertex;
use crate::paging::ground::PagedGround;
use crate::patched_ground::PatchedGround;
use crate::spheres::SphereMap;
use sandtable_raster::windows::Windows;

/// Calls `visit` with the triangles of a patch for an eye in world space. `corner` is the patch's south-west corner, `side`
/// the cells along its side.
pub fn leaves(
    block: &PatchBlock,
    (corner, side): (Vertex, i32),
    eye: Vec3,
    visit: &mut impl FnMut(Triangle),
) {
    let is_active = |vertex: Vertex| {
        let (x, y) = ((vertex.x - corner.x) as usize, (vertex.y - corner.y) as usize);
        let at = y * (side as usize + 1) + x;
        let z = if block.z[at].is_nan() { 0.0 } else { block.z[at] };
        let position = Vec2::new(block.plan[0][x], block.plan[1][y]).extend(z);
        block.radii[at] > 0.0 && distance(eye, position) < f64::from(block.radii[at])
    };
    let mut stack = Triangle::roots(corner, side).to_vec();
    while let Some(triangle) = stack.pop() {
        if triangle.is_finest() || !is_active(triangle.split_vertex()) {
            visit(triangle);
        } else {
            stack.extend(triangle.split());
        }
    }
}

/// Calls `visit` with the triangles of `patches`, each by its south-west corner, for an eye in world space. Patches whose
/// spheres are all out of reach are not read.
///
/// # Errors
/// A patch cannot be read; those before it were visited.
pub fn walk<W: Windows, S: Fn(PatchedGround<'_>) -> SphereMap>(
    ground: &mut PagedGround<W, S>,
    eye: Vec3,
    patches: impl IntoIterator<Item = Vertex>,
    visit: &mut impl FnMut(Triangle),
) -> Result<(), BlockError> {
    let side = ground.layout().patch();
    for corner in patches {
        if ground.is_far(corner, eye) {
            Triangle::roots(corner, side).into_iter().for_each(&mut *visit);
        } else {
            let block = ground.block(corner)?;
            leaves(&block, (corner, side), eye, visit);
        }
    }
    Ok(())
}
