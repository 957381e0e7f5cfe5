//! Which patches can be seen.

use glam::Vec3;

use crate::roam::graph::Vertex;
use crate::roam::ground::Ground;
use crate::view::frustum::Frustum;

/// The lowest and highest drawn Z of each patch, in the layout's patch order.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchHeights {
    ranges: Vec<(f32, f32)>,
}

impl PatchHeights {
    /// The ranges of the drawn ground; patches without data get an empty range.
    pub fn new(ground: Ground<'_>) -> Self {
        Self { ranges: ground.layout.patches().map(|corner| range(ground, corner)).collect() }
    }

    /// Measures the patch with south-west corner `corner` again, after an edit.
    pub fn renew(&mut self, ground: Ground<'_>, corner: Vertex) {
        self.ranges[ground.layout.patch_index(corner)] = range(ground, corner);
    }

    /// Takes in heights of the patch `index` that are new, drawn Z from `low` to `high`, where none of the range's own
    /// ends went away.
    pub(in crate::roam) fn widen(&mut self, index: usize, (low, high): (f32, f32)) {
        let range = &mut self.ranges[index];
        *range = (range.0.min(low), range.1.max(high));
    }

    /// The lowest and highest drawn Z of the patch `index`; low above high where it has no data.
    pub fn range(&self, index: usize) -> (f32, f32) {
        self.ranges[index]
    }

    /// The box of the patch with south-west corner `corner`, in world space; `None` without data.
    pub fn bounds(&self, ground: Ground<'_>, corner: Vertex) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.ranges[ground.layout.patch_index(corner)];
        let far = corner.moved(ground.layout.patch(), ground.layout.patch());
        (low <= high).then(|| (ground.plan(corner).extend(low), ground.plan(far).extend(high)))
    }

    /// The box of the two triangles that `vertex` splits, as high and as low as the patches they lie in; `None`
    /// without data.
    pub fn diamond(&self, ground: Ground<'_>, vertex: Vertex) -> Option<(Vec3, Vec3)> {
        let (min, max) = ground.diamond(vertex);
        let patch = ground.layout.patch();
        let before = |at: i32| (at - 1).max(0) / patch;
        let (low, high) = ground
            .layout
            .patches_within((before(vertex.x), before(vertex.y)), (vertex.x / patch, vertex.y / patch))
            .map(|corner| self.ranges[ground.layout.patch_index(corner)])
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        (low <= high).then(|| (min.extend(low), max.extend(high)))
    }
}

fn range(ground: Ground<'_>, corner: Vertex) -> (f32, f32) {
    let (lattice, layout) = (ground.lattice, ground.layout);
    let (first, last) = (layout.post(corner), layout.post(corner.moved(layout.patch(), layout.patch())));
    (first.row..=last.row)
        .flat_map(|row| {
            let start = row as usize * lattice.columns() as usize;
            &lattice.heights()[start + first.column as usize..=start + last.column as usize]
        })
        .map(|height| height * ground.exaggeration)
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)))
}

/// The south-west corners of the patches that hold data and may be seen.
pub fn patches_in_view(ground: Ground<'_>, heights: &PatchHeights, frustum: &Frustum) -> Vec<Vertex> {
    let in_view =
        |&corner: &Vertex| heights.bounds(ground, corner).is_some_and(|(min, max)| frustum.may_see(min, max));
    ground.layout.patches().filter(in_view).collect()
}
