//! The patches that can be in view.
//!
//! Squares of 2ᵏ × 2ᵏ patches are tested, the coarsest first: a square out of view is discarded at once, and one inside a
//! plane is not tested against that plane again, so the cost follows what is in view and not the size of the terrain. The
//! height ranges of the squares are kept level by level:
//!
//! ```text
//! level 0: one patch      level 1: 2 × 2      level 2: 4 × 4, cut off at the border
//! ```

use glam::Vec3;

use crate::graph::Vertex;
use crate::patched_ground::PatchedGround;
use sandtable_terrain::lattice::Post;
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::pyramid::Pyramid;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;
use sandtable_view::wedge::GroundWedge;

/// The shape against which patches are culled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Culling {
    /// Nothing: every patch with data is listed.
    Nothing,
    /// The left, right and far plane on the ground plane, without heights (Lin et al.).
    Wedge(GroundWedge),
    /// All five planes, against boxes with height.
    Frustum(Frustum),
}

impl Culling {
    /// The wedge of a camera.
    pub fn wedge(camera: &Camera) -> Self {
        Self::Wedge(GroundWedge::new(camera))
    }

    /// The frustum of a camera.
    pub fn frustum(camera: &Camera) -> Self {
        Self::Frustum(Frustum::new(camera))
    }

    fn all(&self) -> u8 {
        match self {
            Self::Nothing => 0,
            Self::Wedge(_) => GroundWedge::ALL,
            Self::Frustum(_) => Frustum::ALL,
        }
    }

    /// The planes of `among` that the box crosses; `None` where it is out of view.
    fn crossed(&self, min: Vec3, max: Vec3, among: u8) -> Option<u8> {
        match self {
            Self::Nothing => Some(0),
            Self::Wedge(wedge) => wedge.crossed_lines(min.truncate(), max.truncate(), among),
            Self::Frustum(frustum) => frustum.crossed_planes(min, max, among),
        }
    }
}

/// The lowest and highest displayed Z of each patch and of squares of them.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchHeights {
    /// Its smallest blocks are the patches.
    pyramid: Pyramid,
    /// The side of a patch, as a power of two.
    bits: u32,
}

/// The range without posts.
pub(crate) const NO_DATA: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

impl PatchHeights {
    /// The ranges of a ground; patches without data have an empty range.
    pub fn new(ground: PatchedGround<'_>) -> Self {
        let bits = ground.layout.patch().trailing_zeros();
        Self { pyramid: Pyramid::with_blocks(ground.lattice, bits), bits }
    }

    /// Measures the patch with south-west corner `corner` again, after an edit.
    pub fn renew(&mut self, ground: PatchedGround<'_>, corner: Vertex) {
        // The posts on its border belong to other patches too.
        let inner = [1, ground.layout.patch() - 1].map(|at| ground.layout.post(corner.moved(at, at)));
        self.pyramid.update(ground.lattice, PostRect { first: inner[0], last: inner[1] });
    }

    /// Widens the range of a patch by new heights, where none of the range's ends was removed.
    pub(crate) fn widen(&mut self, corner: Vertex, heights: (f32, f32)) {
        self.pyramid.widen(self.block(corner), heights);
    }

    fn block(&self, corner: Vertex) -> Post {
        Post { column: corner.x as u32 >> self.bits, row: corner.y as u32 >> self.bits }
    }

    /// The lowest and highest displayed Z of the patch with south-west corner `corner`; low above high where it has no
    /// data.
    pub fn range(&self, corner: Vertex) -> (f32, f32) {
        self.pyramid.range(self.bits, self.block(corner)).unwrap_or(NO_DATA)
    }

    /// The box of the patch with south-west corner `corner`, in world space; `None` without data.
    pub fn bounds(&self, ground: PatchedGround<'_>, corner: Vertex) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.range(corner);
        let far = corner.moved(ground.layout.patch(), ground.layout.patch());
        (low <= high).then(|| (ground.plan(corner).extend(low), ground.plan(far).extend(high)))
    }

    /// The box of the two triangles that `vertex` splits, as high and as low as the patches they lie in; `None` without
    /// data.
    pub fn diamond(&self, ground: PatchedGround<'_>, vertex: Vertex) -> Option<(Vec3, Vec3)> {
        let (min, max) = ground.diamond(vertex);
        let patches = ground.layout.patches_meeting(vertex, vertex);
        let (low, high) = patches.map(|corner| self.range(corner)).reduce(joined)?;
        (low <= high).then(|| (min.extend(low), max.extend(high)))
    }
}

/// The smallest range around both.
pub(crate) fn joined(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The lowest and highest of some heights, those without data left out. In lanes, which do not wait for each other.
pub(crate) fn drawn_range(heights: &[f32]) -> (f32, f32) {
    const LANES: usize = 8;
    let (mut low, mut high) = ([NO_DATA.0; LANES], [NO_DATA.1; LANES]);
    let (groups, rest) = heights.as_chunks::<LANES>();
    let mut add = |lane: usize, z: f32| {
        // Written so that NaN is never taken, and each is one instruction.
        low[lane] = if z < low[lane] { z } else { low[lane] };
        high[lane] = if z > high[lane] { z } else { high[lane] };
    };
    for group in groups {
        group.iter().enumerate().for_each(|(lane, &height)| add(lane, height));
    }
    rest.iter().enumerate().for_each(|(lane, &height)| add(lane, height));
    low.into_iter().zip(high).fold(NO_DATA, joined)
}

/// The south-west corners of the patches that hold data and may be seen, row by row.
pub fn patches_in_view(ground: PatchedGround<'_>, heights: &PatchHeights, frustum: &Frustum) -> Vec<Vertex> {
    let mut patches = Vec::new();
    cull(ground, heights, &Culling::Frustum(*frustum), &mut patches);
    patches
}

/// Fills `patches` with the south-west corners of the patches that hold data and are not culled, row by row.
pub fn cull(ground: PatchedGround<'_>, heights: &PatchHeights, culling: &Culling, patches: &mut Vec<Vertex>) {
    gather(ground, heights, culling, patches);
    patches.sort_unstable_by_key(|corner| (corner.y, corner.x));
}

/// [`cull`] in the order in which the squares are visited: row by row within every square.
fn gather(ground: PatchedGround<'_>, heights: &PatchHeights, culling: &Culling, patches: &mut Vec<Vertex>) {
    patches.clear();
    let all = Post { column: 0, row: 0 };
    PatchCull { ground, heights, culling, patches }.visit(heights.pyramid.top_bits(), all, culling.all());
}

/// The patches in view, culled again only when the view changes.
#[derive(Clone, Debug, Default)]
pub struct InView {
    culling: Option<Culling>,
    patches: Vec<Vertex>,
}

impl InView {
    /// The south-west corners of the patches that hold data and are not culled, by squares: neighbors in the list are
    /// neighbors on the ground.
    pub fn update(
        &mut self,
        ground: PatchedGround<'_>,
        heights: &PatchHeights,
        culling: Culling,
    ) -> &[Vertex] {
        if self.culling != Some(culling) {
            gather(ground, heights, &culling, &mut self.patches);
            self.culling = Some(culling);
        }
        &self.patches
    }

    /// Makes the next update cull, after heights have changed.
    pub fn forget(&mut self) {
        self.culling = None;
    }
}

struct PatchCull<'a> {
    ground: PatchedGround<'a>,
    heights: &'a PatchHeights,
    culling: &'a Culling,
    patches: &'a mut Vec<Vertex>,
}

impl PatchCull<'_> {
    /// Visits the square of patches that is a block with sides of 2^`bits` cells.
    fn visit(&mut self, bits: u32, block: Post, among: u8) {
        let range = self.heights.pyramid.range(bits, block);
        let Some((low, high)) = range.filter(|range| range.0 <= range.1) else { return };
        let side = 1 << bits;
        let corner = Vertex::new(block.column as i32 * side, block.row as i32 * side);
        // The far posts of a square that reaches past the last patch are those on the border.
        let (min, max) = (self.ground.plan(corner), self.ground.plan(corner.moved(side, side)));
        let Some(among) = self.culling.crossed(min.extend(low), max.extend(high), among) else { return };
        if bits == self.heights.bits {
            self.patches.push(corner);
            return;
        }
        let first = Post { column: 2 * block.column, row: 2 * block.row };
        for (east, north) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            self.visit(bits - 1, first.offset(east, north), among);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::PatchLayout;
    use glam::{DVec2, Vec2};
    use proptest::prelude::*;
    use sandtable_terrain::lattice::Lattice;

    fn plain(ground: PatchedGround<'_>, heights: &PatchHeights, frustum: &Frustum) -> Vec<Vertex> {
        let seen = |&corner: &Vertex| {
            heights.bounds(ground, corner).is_some_and(|(min, max)| frustum.may_see(min, max))
        };
        ground.layout.patches().filter(seen).collect()
    }

    fn hilly(columns: u32, rows: u32, hole: usize) -> Lattice {
        let height = |index: u32| libm::sinf(index as f32 * 0.11) * 20.0;
        let mut heights: Vec<f32> = (0..columns * rows).map(height).collect();
        let end = (hole + 90).min(heights.len() - 1);
        heights[hole.min(end)..end].fill(f32::NAN);
        Lattice::new(DVec2::ZERO, DVec2::new(3.0, 4.0), columns, heights).expect("sound")
    }

    proptest! {
        #[test]
        fn squares_of_patches_list_just_what_asking_every_patch_lists(
            columns in 2u32..90, rows in 2u32..90, hole in 0usize..2000,
            eye in (-50.0..350.0f32, -50.0..350.0f32, -30.0..90.0f32),
            target in (0.0..300.0f32, 0.0..300.0f32),
            far in 20.0..600.0f32,
        ) {
            let lattice = hilly(columns, rows, hole);
            let layout = PatchLayout::new(columns, rows, 4).expect("sound");
            let ground = PatchedGround { lattice: &lattice, layout: &layout };
            let heights = PatchHeights::new(ground);
            let (eye, target) = (Vec3::from(eye), Vec2::from(target).extend(0.0));
            prop_assume!(eye.distance(target) > 1.0);
            let camera = Camera::new(eye, target, 0.7, (640, 480), (1.0, far)).expect("sound");
            let by_frustum = patches_in_view(ground, &heights, &Frustum::new(&camera));
            prop_assert_eq!(&by_frustum, &plain(ground, &heights, &Frustum::new(&camera)));
            let (mut by_wedge, mut all) = (Vec::new(), Vec::new());
            cull(ground, &heights, &Culling::Nothing, &mut all);
            prop_assert_eq!(all.len(), layout.patches().filter(|&at| heights.bounds(ground, at).is_some()).count());
            cull(ground, &heights, &Culling::wedge(&camera), &mut by_wedge);
            let wedge = GroundWedge::new(&camera);
            let plain_wedge: Vec<Vertex> = all.into_iter().filter(|&corner| {
                let far = ground.plan(corner.moved(layout.patch(), layout.patch()));
                wedge.may_see(ground.plan(corner), far)
            }).collect();
            prop_assert_eq!(by_wedge, plain_wedge);
        }

        #[test]
        fn heights_measured_again_equal_those_measured_anew(column in 0u32..40, row in 0u32..50) {
            let mut lattice = hilly(40, 50, 7);
            let layout = PatchLayout::new(40, 50, 8).expect("sound");
            let before = PatchedGround { lattice: &lattice.clone(), layout: &layout };
            let mut heights = PatchHeights::new(before);
            lattice.pin(Post { column, row }, 500.0);
            let ground = PatchedGround { lattice: &lattice, layout: &layout };
            for corner in layout.patches() {
                heights.renew(ground, corner);
            }
            prop_assert_eq!(heights, PatchHeights::new(ground));
        }
    }
}
