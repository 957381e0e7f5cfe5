//! Ground whose heights are in memory part by part, for a mesh of all of it.
//!
//! The state of a mesh is a bit a vertex and stays in memory; heights are read for some patches at a time:
//!
//! ```text
//! ┌───────┬───────┬───┐   a part is one patch of the largest size, or a run of smaller ones in a row of patches;
//! │   3   │   4   │ 5 │   parts follow each other as their patches do, so that a mesh has its vertices and triangles
//! ├───────┼───────┼───┤   in the same order whatever the parts
//! │   0   │   1   │ 2 │
//! └───────┴───────┴───┘   neighbors share the posts of the border between them
//! ```
//!
//! What is known of posts on borders is carried from part to part by [`BorderCarry`].

use std::convert::Infallible;
use std::sync::Arc;

use crate::graph::Vertex;
use crate::layout::PatchLayout;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// Ground that is read part by part.
pub trait PartedGround {
    /// Why a part cannot be read.
    type Error;

    /// How it is divided.
    fn plan(&self) -> PartPlan;

    /// The ground with at least the posts of a part in memory.
    ///
    /// # Errors
    /// They cannot be read.
    fn part(&mut self, part: usize) -> Result<Arc<Lattice>, Self::Error>;
}

/// The division of the patches of a layout into parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartPlan {
    layout: PatchLayout,
    /// Patches eastward and northward in a part; fewer in the last ones.
    patches: (usize, usize),
}

impl PartPlan {
    /// All patches in one part.
    pub fn whole(layout: PatchLayout) -> Self {
        Self { layout, patches: layout.patch_grid() }
    }

    /// Parts of at most `most` vertices, but at least one patch.
    pub fn of_vertices(layout: PatchLayout, most: usize) -> Self {
        let side = layout.patch() as usize;
        let at_once = (most / (side + 1)).saturating_sub(1) / side;
        Self { layout, patches: (at_once.clamp(1, layout.patch_grid().0), 1) }
    }

    /// The patches that are divided.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// The number of parts.
    pub fn count(&self) -> usize {
        self.parts_east() * self.layout.patch_grid().1.div_ceil(self.patches.1)
    }

    /// The part of the patch at a place in [`PatchLayout::patches`].
    pub fn part_of(&self, patch: usize) -> usize {
        let east = self.layout.patch_grid().0;
        patch / east / self.patches.1 * self.parts_east() + patch % east / self.patches.0
    }

    /// The south-west corners of a part's patches, in the order of [`PatchLayout::patches`].
    pub fn patches(&self, part: usize) -> impl Iterator<Item = Vertex> + use<> {
        let (first, last) = self.ends(part);
        self.layout.patches_within(first, last)
    }

    /// The posts of a part, those on its borders included.
    pub fn posts(&self, part: usize) -> PostRect {
        let ((west, south), (east, north)) = self.ends(part);
        let side = self.layout.patch();
        let post = |x: i32, y: i32| self.layout.post(Vertex::new(x * side, y * side));
        PostRect { first: post(west, south), last: post(east + 1, north + 1) }
    }

    /// The most posts of a part.
    pub fn most_posts(&self) -> usize {
        let first = self.posts(0);
        first.width() * first.height()
    }

    fn parts_east(&self) -> usize {
        self.layout.patch_grid().0.div_ceil(self.patches.0)
    }

    /// The south-westernmost and the north-easternmost patch of a part, counted in patches east and north.
    fn ends(&self, part: usize) -> ((i32, i32), (i32, i32)) {
        let (east, north) = self.layout.patch_grid();
        let west = part % self.parts_east() * self.patches.0;
        let south = part / self.parts_east() * self.patches.1;
        let last = ((west + self.patches.0).min(east) - 1, (south + self.patches.1).min(north) - 1);
        ((west as i32, south as i32), (last.0 as i32, last.1 as i32))
    }
}

/// Ground in memory, in one part.
#[derive(Clone, Debug)]
pub struct HeldGround {
    lattice: Arc<Lattice>,
    plan: PartPlan,
}

impl HeldGround {
    /// A lattice that holds all of its posts, and the patches over it.
    pub fn new(lattice: &Arc<Lattice>, layout: PatchLayout) -> Self {
        Self { lattice: Arc::clone(lattice), plan: PartPlan::whole(layout) }
    }

    /// The ground.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }
}

impl PartedGround for HeldGround {
    type Error = Infallible;

    fn plan(&self) -> PartPlan {
        self.plan
    }

    fn part(&mut self, _part: usize) -> Result<Arc<Lattice>, Infallible> {
        Ok(Arc::clone(&self.lattice))
    }
}

/// The values of border posts that one part of the ground leaves for later parts, one per post.
#[derive(Clone, Debug)]
pub struct BorderCarry<T> {
    /// By column, those of the northernmost row of the parts before.
    north: Vec<T>,
    /// By row, those of the easternmost column of the part before.
    east: Vec<T>,
    unknown: T,
}

impl<T: Copy> BorderCarry<T> {
    /// For a layout of which nothing is known yet.
    pub fn new(layout: &PatchLayout, unknown: T) -> Self {
        Self { north: vec![unknown; layout.columns()], east: vec![unknown; layout.rows()], unknown }
    }

    /// Sets the values of some rows of a part, row by row from the south-west: those that earlier parts left on its
    /// borders, and the unknown value elsewhere.
    pub fn enter(&self, part: PostRect, rows: (u32, u32), values: &mut Vec<T>) {
        let (width, west) = (part.width(), part.first.column as usize);
        values.clear();
        values.resize((rows.1 - rows.0 + 1) as usize * width, self.unknown);
        if rows.0 == part.first.row && rows.0 > 0 {
            values[..width].copy_from_slice(&self.north[west..west + width]);
        }
        if west > 0 {
            let east = &self.east[rows.0 as usize..=rows.1 as usize];
            values.iter_mut().step_by(width).zip(east).for_each(|(value, east)| *value = *east);
        }
    }

    /// Stores the border values of some rows of a part, once they are done.
    pub fn leave(&mut self, part: PostRect, rows: (u32, u32), values: &[T]) {
        let (width, west) = (part.width(), part.first.column as usize);
        let east = &mut self.east[rows.0 as usize..=rows.1 as usize];
        values.chunks_exact(width).zip(east).for_each(|(row, east)| *east = row[width - 1]);
        if rows.1 == part.last.row {
            self.north[west..west + width].copy_from_slice(&values[values.len() - width..]);
        }
    }
}

/// Whether a part counts a post among its own: of those on borders the last part that has them does.
pub fn is_own(layout: &PatchLayout, part: PostRect, post: Post) -> bool {
    let end = layout.post(Vertex::new(layout.columns() as i32, layout.rows() as i32));
    (post.column < part.last.column || post.column == end.column)
        && (post.row < part.last.row || post.row == end.row)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Ground in memory in parts of at most so many vertices, each holding its own posts alone.
    pub struct CutGround {
        pub lattice: Lattice,
        pub plan: PartPlan,
    }

    impl PartedGround for CutGround {
        type Error = Infallible;

        fn plan(&self) -> PartPlan {
            self.plan
        }

        fn part(&mut self, part: usize) -> Result<Arc<Lattice>, Infallible> {
            Ok(Arc::new(self.lattice.holding_only(self.plan.posts(part))))
        }
    }

    proptest! {
        #[test]
        fn parts_have_all_patches_in_their_order_and_each_post_is_one_parts_own(
            columns in 2u32..100, rows in 2u32..100, power in 1u32..6, most in 1usize..5000,
        ) {
            let layout = PatchLayout::new(columns, rows, 1 << power).expect("sound");
            for plan in [PartPlan::whole(layout), PartPlan::of_vertices(layout, most)] {
                let parts = 0..plan.count();
                let patches: Vec<Vertex> = parts.clone().flat_map(|part| plan.patches(part)).collect();
                prop_assert_eq!(&patches, &layout.patches().collect::<Vec<_>>());
                let mut owners = vec![0; (columns * rows) as usize];
                for part in parts {
                    prop_assert!(plan.patches(part).all(|at| plan.part_of(layout.patch_index(at)) == part));
                    let rect = plan.posts(part);
                    let held = rect.width() * rect.height();
                    let one = (layout.patch() as usize + 1).pow(2);
                    prop_assert!(plan.count() == 1 || held <= most.max(one) && held <= plan.most_posts());
                    for post in rect.posts().filter(|&post| is_own(&layout, rect, post)) {
                        owners[(post.row * columns + post.column) as usize] += 1;
                    }
                }
                prop_assert!(owners.iter().all(|&owners| owners == 1));
            }
        }

        #[test]
        fn what_is_known_of_a_post_reaches_every_later_part_that_has_it(
            columns in 2u32..60, rows in 2u32..60, power in 1u32..5, most in 1usize..400, at_once in 1u32..9,
        ) {
            let layout = PatchLayout::new(columns, rows, 1 << power).expect("sound");
            let plan = PartPlan::of_vertices(layout, most);
            let (mut carry, mut values) = (BorderCarry::new(&layout, 0), Vec::new());
            let mut visits = vec![0; (columns * rows) as usize];
            for part in 0..plan.count() {
                let rect = plan.posts(part);
                for first in (rect.first.row..=rect.last.row).step_by(at_once as usize) {
                    let band = (first, (first + at_once - 1).min(rect.last.row));
                    carry.enter(rect, band, &mut values);
                    let posts = rect.posts().filter(|post| (band.0..=band.1).contains(&post.row));
                    for (value, post) in values.iter_mut().zip(posts) {
                        let visits = &mut visits[(post.row * columns + post.column) as usize];
                        prop_assert_eq!(*value, *visits, "{:?}", post);
                        (*value, *visits) = (*value + 1, *visits + 1);
                    }
                    carry.leave(rect, band, &values);
                }
            }
        }
    }
}
