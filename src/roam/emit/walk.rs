//! The leaves of one patch's bintree, on linear indices.
//!
//! A vertex is two numbers, both linear in its coordinates and packed into one word: its index in the layout, which
//! addresses its bit, and a tag of the caller's choice. The middle of a hypotenuse is one addition and one shift for both,
//! exact because the middle is a grid vertex.
//!
//! The leaves come in the order of Sierpiński's curve: a triangle is entered at one end of its hypotenuse and left at the
//! other, by way of its apex, so the halves follow each other and each leaf shares an edge with the leaf before it. Seen
//! from above the halves have the opposite orientation:
//!
//! ```text
//!         apex                    exit of the first, entry of the second
//!         ╱ ╲                        ╱│╲
//!       ╱     ╲                    ╱  │  ╲
//!     ╱         ╲                ╱    │    ╲
//! entry ─────── exit         entry ─ apex ─ exit
//! ```

use crate::active::ActiveSet;

/// Twice the levels of the largest patch, 4096 cells a side, and the other root.
const DEEPEST: usize = 26;

/// A vertex: its index in the layout and a tag below 2³¹ that is linear in its coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WalkKey(u64);

impl WalkKey {
    /// The key of the vertex with an index in the layout.
    #[inline]
    pub const fn new(index: u32, tag: u32) -> Self {
        Self((tag as u64) << 32 | index as u64)
    }

    /// The index in the layout.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as u32 as usize
    }

    /// The tag.
    #[inline]
    pub const fn tag(self) -> u32 {
        (self.0 >> 32) as u32
    }

    /// The key halfway to `other`, for the ends of a hypotenuse.
    #[inline]
    pub const fn middle(self, other: Self) -> Self {
        Self((self.0 + other.0) >> 1)
    }

    /// The key moved by the difference of two others, `to` less `from`.
    #[inline]
    pub const fn moved(self, from: Self, to: Self) -> Self {
        Self(self.0.wrapping_add(to.0).wrapping_sub(from.0))
    }
}

/// A triangle with the ends of its hypotenuse in the order of the walk.
#[derive(Clone, Copy, Default)]
struct WalkTriangle {
    entry: WalkKey,
    apex: WalkKey,
    exit: WalkKey,
    depth: u32,
}

impl WalkTriangle {
    #[inline]
    fn halves(&self, middle: WalkKey) -> [Self; 2] {
        let depth = self.depth + 1;
        [
            Self { entry: self.entry, apex: middle, exit: self.apex, depth },
            Self { entry: self.apex, apex: middle, exit: self.exit, depth },
        ]
    }

    /// Its corners, counter-clockwise from the apex.
    #[inline]
    fn corners(&self) -> [WalkKey; 3] {
        if self.depth.is_multiple_of(2) {
            [self.apex, self.entry, self.exit]
        } else {
            [self.apex, self.exit, self.entry]
        }
    }
}

/// Calls `emit` with every leaf below `roots`, corners counter-clockwise from the apex.
///
/// `roots` are the two triangles of a patch, each apex first and counter-clockwise, the second's hypotenuse the reverse of
/// the first's. A triangle for which `enter` returns false is left out with all below it.
pub fn leaves(
    active: &ActiveSet,
    roots: [[WalkKey; 3]; 2],
    mut enter: impl FnMut([WalkKey; 3]) -> bool,
    mut emit: impl FnMut([WalkKey; 3]),
) {
    let finest = 2 * active.layout().patch().trailing_zeros();
    let [first, second] = roots.map(|[apex, entry, exit]| WalkTriangle { entry, apex, exit, depth: 0 });
    let mut waiting = [WalkTriangle::default(); DEEPEST];
    waiting[0] = second;
    let mut count = 1;
    let mut here = first;
    loop {
        let middle = here.entry.middle(here.exit);
        if enter(here.corners()) {
            if here.depth < finest && active.bit(middle.index()) {
                let [next, later] = here.halves(middle);
                waiting[count] = later;
                count += 1;
                here = next;
                continue;
            }
            emit(here.corners());
        }
        if count == 0 {
            return;
        }
        count -= 1;
        here = waiting[count];
    }
}
