//! From the roots down: a mesh for one camera, built anew.
//!
//! Cost: one visit per triangle of the resulting tree, whatever the size of the terrain.

use glam::Vec3;

use crate::roam::active::ActiveSet;
use crate::roam::bintree::Triangle;
use crate::roam::criterion::ScreenError;
use crate::roam::error::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::layout::Layout;
use crate::terrain::lattice::Lattice;
use crate::view::frustum::Frustum;

/// The lowest and highest drawn Z of each patch, in the layout's patch order.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchHeights {
    ranges: Vec<(f32, f32)>,
}

impl PatchHeights {
    /// The ranges of `lattice` with heights times `exaggeration`; patches without data get an empty range.
    pub fn new(lattice: &Lattice, layout: &Layout, exaggeration: f32) -> Self {
        let range = |corner: Vertex| {
            let (first, last) =
                (layout.post(corner), layout.post(corner.moved(layout.patch(), layout.patch())));
            (first.row..=last.row)
                .flat_map(|row| {
                    let start = row as usize * lattice.columns() as usize;
                    &lattice.heights()[start + first.column as usize..=start + last.column as usize]
                })
                .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &height| {
                    (low.min(height * exaggeration), high.max(height * exaggeration))
                })
        };
        Self { ranges: layout.patches().map(range).collect() }
    }

    /// The box of the patch `index` with south-west corner `corner`, in world space; `None` without data.
    pub fn bounds(
        &self,
        lattice: &Lattice,
        layout: &Layout,
        index: usize,
        corner: Vertex,
    ) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.ranges[index];
        let plan = |vertex: Vertex| lattice.position(layout.post(vertex));
        let far = corner.moved(layout.patch(), layout.patch());
        (low <= high).then(|| (plan(corner).extend(low), plan(far).extend(high)))
    }
}

/// What refinement reads.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The heights.
    pub lattice: &'a Lattice,
    /// The patches over them.
    pub layout: &'a Layout,
    /// The errors of their vertices.
    pub errors: &'a ErrorMap,
    /// The heights' range per patch.
    pub heights: &'a PatchHeights,
}

/// The south-west corners of the patches that hold data and may be seen.
pub fn patches_in_view(ground: Ground<'_>, frustum: &Frustum) -> Vec<Vertex> {
    let in_view = |&(index, corner): &(usize, Vertex)| {
        let bounds = ground.heights.bounds(ground.lattice, ground.layout, index, corner);
        bounds.is_some_and(|(min, max)| frustum.may_see(min, max))
    };
    ground.layout.patches().enumerate().filter(in_view).map(|(_, corner)| corner).collect()
}

/// Sets the bits for one camera, from the roots: splits every triangle in view that `criterion` finds too coarse,
/// and whatever that forces.
///
/// Triangles outside `frustum` are left as coarse as their neighbours allow.
pub fn rebuild(ground: Ground<'_>, criterion: &ScreenError, frustum: &Frustum) -> ActiveSet {
    let mut active = ActiveSet::new(*ground.layout);
    let mut stack = Vec::new();
    for (index, corner) in ground.layout.patches().enumerate() {
        let Some((min, max)) = ground.heights.bounds(ground.lattice, ground.layout, index, corner) else {
            continue;
        };
        stack.extend(Triangle::roots(corner, ground.layout.patch()));
        while let Some(triangle) = stack.pop() {
            if triangle.is_finest() {
                continue;
            }
            let vertex = triangle.split_vertex();
            let (min, max) = triangle_box(ground, &triangle, (min.z, max.z));
            let error = ground.errors.at(ground.layout, vertex);
            if frustum.may_see(min, max) && criterion.must_split(error, min, max) {
                active.activate(vertex);
                stack.extend(triangle.split());
            }
        }
    }
    active
}

/// Sets the bits regardless of any camera: every triangle whose error exceeds `tolerance_m` is split.
pub fn rebuild_everywhere(ground: Ground<'_>, tolerance_m: f32) -> ActiveSet {
    let mut active = ActiveSet::new(*ground.layout);
    let mut stack = Vec::new();
    for corner in ground.layout.patches() {
        stack.extend(Triangle::roots(corner, ground.layout.patch()));
        while let Some(triangle) = stack.pop() {
            let vertex = triangle.split_vertex();
            if !triangle.is_finest() && ground.errors.at(ground.layout, vertex) > tolerance_m {
                active.activate(vertex);
                stack.extend(triangle.split());
            }
        }
    }
    active
}

fn triangle_box(ground: Ground<'_>, triangle: &Triangle, (low, high): (f32, f32)) -> (Vec3, Vec3) {
    let [a, b, c] = triangle.corners().map(|vertex| ground.lattice.position(ground.layout.post(vertex)));
    (a.min(b).min(c).extend(low), a.max(b).max(c).extend(high))
}
