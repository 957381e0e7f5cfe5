//! Which patches can be seen.
//!
//! Patches are asked about in squares of 2ᵏ × 2ᵏ, the coarsest first: a square out of view is left at once, and
//! one inside a plane is not asked about that plane again, so that the cost follows what can be seen and not how
//! much terrain there is. The height ranges of the squares are kept level by level:
//!
//! ```text
//! level 0: one patch      level 1: 2 × 2      level 2: 4 × 4, cut off at the border
//! ```

use glam::Vec3;

use crate::roam::graph::Vertex;
use crate::roam::patched_ground::PatchedGround;
use crate::view::camera::Camera;
use crate::view::frustum::Frustum;
use crate::view::wedge::GroundWedge;

/// What patches are culled against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Culling {
    /// Nothing: every patch with data is listed.
    Nothing,
    /// The ground-plane wedge of 000: left, right and far, blind to heights.
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

    /// The planes of `among` that the box crosses, `None` where it is out of view.
    fn crossed(&self, min: Vec3, max: Vec3, among: u8) -> Option<u8> {
        match self {
            Self::Nothing => Some(0),
            Self::Wedge(wedge) => wedge.crossed_lines(min.truncate(), max.truncate(), among),
            Self::Frustum(frustum) => frustum.crossed_planes(min, max, among),
        }
    }
}

/// The lowest and highest drawn Z of each patch and of squares of them.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchHeights {
    levels: Vec<RangeLevel>,
}

/// The ranges of all squares of one size, row by row from the south-west.
#[derive(Clone, Debug, PartialEq)]
struct RangeLevel {
    columns: usize,
    ranges: Vec<(f32, f32)>,
}

/// The range of no post.
pub(in crate::roam) const NO_DATA: (f32, f32) = (f32::INFINITY, f32::NEG_INFINITY);

impl PatchHeights {
    /// The ranges of the drawn ground; patches without data get an empty range.
    pub fn new(ground: PatchedGround<'_>) -> Self {
        let (columns, _) = ground.layout.patch_grid();
        let ranges = ground.layout.patches().map(|corner| range(ground, corner)).collect();
        let mut levels = vec![RangeLevel { columns, ranges }];
        while let Some(coarser) = levels.last().and_then(RangeLevel::halved) {
            levels.push(coarser);
        }
        Self { levels }
    }

    /// Measures the patch with south-west corner `corner` again, after an edit.
    pub fn renew(&mut self, ground: PatchedGround<'_>, corner: Vertex) {
        let patch = ground.layout.patch();
        self.put((corner.x / patch) as usize, (corner.y / patch) as usize, range(ground, corner));
    }

    /// Sets the range of the patch in column `x` and row `y`, and those of the squares that hold it.
    fn put(&mut self, mut x: usize, mut y: usize, mut renewed: (f32, f32)) {
        for place in 0..self.levels.len() {
            let level = &mut self.levels[place];
            let index = y * level.columns + x;
            level.ranges[index] = renewed;
            (x, y) = (x / 2, y / 2);
            renewed = level.square(x, y);
        }
    }

    /// Takes in heights of the patch `index` that are new, drawn Z from `low` to `high`, where none of the range's own
    /// ends went away.
    pub(in crate::roam) fn widen(&mut self, index: usize, (low, high): (f32, f32)) {
        let range = self.levels[0].ranges[index];
        let columns = self.levels[0].columns;
        self.put(index % columns, index / columns, (range.0.min(low), range.1.max(high)));
    }

    /// The lowest and highest drawn Z of the patch `index`, in the layout's patch order; low above high where it
    /// has no data.
    pub fn range(&self, index: usize) -> (f32, f32) {
        self.levels[0].ranges[index]
    }

    /// The box of the patch with south-west corner `corner`, in world space; `None` without data.
    pub fn bounds(&self, ground: PatchedGround<'_>, corner: Vertex) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.range(ground.layout.patch_index(corner));
        let far = corner.moved(ground.layout.patch(), ground.layout.patch());
        (low <= high).then(|| (ground.plan(corner).extend(low), ground.plan(far).extend(high)))
    }

    /// The box of the two triangles that `vertex` splits, as high and as low as the patches they lie in; `None`
    /// without data.
    pub fn diamond(&self, ground: PatchedGround<'_>, vertex: Vertex) -> Option<(Vec3, Vec3)> {
        let (min, max) = ground.diamond(vertex);
        let patch = ground.layout.patch();
        let before = |at: i32| (at - 1).max(0) / patch;
        let (low, high) = ground
            .layout
            .patches_within((before(vertex.x), before(vertex.y)), (vertex.x / patch, vertex.y / patch))
            .map(|corner| self.range(ground.layout.patch_index(corner)))
            .reduce(joined)?;
        (low <= high).then(|| (min.extend(low), max.extend(high)))
    }
}

impl RangeLevel {
    fn rows(&self) -> usize {
        self.ranges.len() / self.columns
    }

    /// The level of squares twice as large; `None` above a single square.
    fn halved(&self) -> Option<Self> {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows().div_ceil(2));
        let squares = || (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let coarser = || Self { columns, ranges: squares().map(|(x, y)| self.square(x, y)).collect() };
        (self.ranges.len() > 1).then(coarser)
    }

    /// The range of the four squares under the square (`x`, `y`) of the next level.
    fn square(&self, x: usize, y: usize) -> (f32, f32) {
        let (x, y) = (2 * x, 2 * y);
        let rows = y..(y + 2).min(self.rows());
        rows.flat_map(|y| &self.ranges[y * self.columns + x..y * self.columns + (x + 2).min(self.columns)])
            .fold(NO_DATA, |joint, &range| joined(joint, range))
    }
}

/// The range of both.
pub(in crate::roam) fn joined(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0.min(b.0), a.1.max(b.1))
}

fn range(ground: PatchedGround<'_>, corner: Vertex) -> (f32, f32) {
    let (lattice, layout) = (ground.lattice, ground.layout);
    let (first, last) = (layout.post(corner), layout.post(corner.moved(layout.patch(), layout.patch())));
    (first.row..=last.row)
        .map(|row| {
            let start = row as usize * lattice.columns() as usize;
            let posts = &lattice.heights()[start + first.column as usize..=start + last.column as usize];
            drawn_range(posts)
        })
        .fold(NO_DATA, joined)
}

/// The lowest and highest drawn Z of some posts, those without data left out. Several at a time: the smaller of two
/// numbers must be known before that of three.
pub(in crate::roam) fn drawn_range(heights: &[f32]) -> (f32, f32) {
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
    let mut found = Vec::new();
    cull(ground, heights, &Culling::Frustum(*frustum), &mut found);
    found
}

/// Fills `found` with the south-west corners of the patches that hold data and are not culled, row by row.
pub fn cull(ground: PatchedGround<'_>, heights: &PatchHeights, culling: &Culling, found: &mut Vec<Vertex>) {
    gather(ground, heights, culling, found);
    found.sort_unstable_by_key(|corner| (corner.y, corner.x));
}

/// As [`cull`], in the order in which the squares are visited: row by row within every square.
fn gather(ground: PatchedGround<'_>, heights: &PatchHeights, culling: &Culling, found: &mut Vec<Vertex>) {
    found.clear();
    let top = heights.levels.len() - 1;
    visit(ground, heights, culling, PatchSquare { level: top, x: 0, y: 0 }, culling.all(), found);
}

/// The patches in view, culled again only when the view is another.
#[derive(Clone, Debug, Default)]
pub struct InView {
    culling: Option<Culling>,
    patches: Vec<Vertex>,
}

impl InView {
    /// The south-west corners of the patches that hold data and are not culled, by squares: neighbors in the list
    /// are neighbors on the ground.
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

/// A square of 2^level patches a side.
#[derive(Clone, Copy)]
struct PatchSquare {
    level: usize,
    x: usize,
    y: usize,
}

fn visit(
    ground: PatchedGround<'_>,
    heights: &PatchHeights,
    culling: &Culling,
    square: PatchSquare,
    among: u8,
    found: &mut Vec<Vertex>,
) {
    let Some(level) = heights.levels.get(square.level).filter(|level| square.x < level.columns) else {
        return;
    };
    let Some(&(low, high)) =
        level.ranges.get(square.y * level.columns + square.x).filter(|range| range.0 <= range.1)
    else {
        return;
    };
    let side = ground.layout.patch() << square.level;
    let corner = Vertex::new(square.x as i32 * side, square.y as i32 * side);
    // Squares at the border reach past the last patch; their far posts are those on the border all the same.
    let (min, max) = (ground.plan(corner).extend(low), ground.plan(corner.moved(side, side)).extend(high));
    let Some(among) = culling.crossed(min, max, among) else {
        return;
    };
    if square.level == 0 {
        found.push(corner);
        return;
    }
    for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let quarter = PatchSquare { level: square.level - 1, x: 2 * square.x + x, y: 2 * square.y + y };
        visit(ground, heights, culling, quarter, among, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roam::layout::PatchLayout;
    use crate::terrain::lattice::{Lattice, Post};
    use glam::{DVec2, Vec2};
    use proptest::prelude::*;

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
