//! More posts on the same ground, for what is narrower than a cell.
//!
//! Between posts the ground is the plane of the finest triangles. Posts added on those planes change nothing: halved
//! cells have their diagonals where the whole cell had its own, because column and row of a cell's lower half are both
//! even in the doubled lattice:
//!
//! ```text
//!   o───────────o         o─────o─────o
//!   │         ╱ │         │ ╲   │   ╱ │
//!   │       ╱   │         │   ╲ │ ╱   │      the rising diagonal of a cell is that of the two
//!   │     ╱     │   ──►   o─────o─────o      halves along it; the two beside it lie in planes
//!   │   ╱       │         │   ╱ │ ╲   │
//!   │ ╱         │         │ ╱   │   ╲ │
//!   o───────────o         o─────o─────o
//! ```
//!
//! So every height answered stays as it was, up to the rounding of the added posts to f32. Posts are doubled, never
//! trebled: halves of a cell are exact in binary, and origin, extent and the old posts keep their places to the last bit.
//! A smooth surface through the posts would look rounder, but would move ground that nobody asked to move.

use glam::DVec2;

use crate::terrain::lattice::{Lattice, LatticeError, Post};
use crate::terrain::query::cell::interpolate;
use crate::terrain::query::{Diagonal, Interpolation};

/// No lattice is made denser than to this many posts: some 17 million take about 800 MB with the errors, the light and
/// the map that are kept for each. More would show more of a narrow road, and cost memory in proportion.
pub const MOST_POSTS: u64 = 4097 * 4097;

/// Nor to more posts in a row or column than this, the largest texture of most graphics cards.
const MOST_IN_A_ROW: u64 = 8192;

/// Nor are cells halved more often than this: a thirty-second of what was measured says nothing new about the ground.
const MOST_DOUBLINGS: u32 = 5;

/// How often the lattice must be doubled for its posts to stand no further apart than `spacing_m` either way.
pub fn doublings_for(lattice: &Lattice, spacing_m: f64) -> u32 {
    let needed = (0..=MOST_DOUBLINGS).find(|&times| spaced(lattice, times) <= spacing_m);
    needed.unwrap_or(MOST_DOUBLINGS)
}

/// The largest number of doublings, up to `wanted`, that leaves the lattice within [`MOST_POSTS`].
pub fn affordable(lattice: &Lattice, wanted: u32) -> u32 {
    (0..=wanted).rev().find(|&times| is_affordable(lattice, times)).unwrap_or(0)
}

/// The wider of the two distances between posts after so many doublings.
fn spaced(lattice: &Lattice, times: u32) -> f64 {
    lattice.cell().max_element() / f64::from(1u32 << times)
}

fn is_affordable(lattice: &Lattice, times: u32) -> bool {
    let side = |posts: u32| ((u64::from(posts) - 1) << times) + 1;
    let (columns, rows) = (side(lattice.columns()), side(lattice.rows()));
    times == 0 || (columns.max(rows) <= MOST_IN_A_ROW && columns * rows <= MOST_POSTS)
}

/// The same ground with its posts doubled so many times; a post added between pinned ones is pinned.
///
/// # Errors
/// As [`Lattice::new`]; none for a whole lattice, which has been through it.
pub fn densified(lattice: &Lattice, times: u32) -> Result<Lattice, LatticeError> {
    let side = |posts: u32| ((posts - 1) << times) + 1;
    let (columns, rows) = (side(lattice.columns()), side(lattice.rows()));
    let posts = || (0..rows).flat_map(move |row| (0..columns).map(move |column| Post { column, row }));
    let heights = posts().map(|post| height(lattice, post, times)).collect();
    let cell = lattice.cell() / f64::from(1u32 << times);
    let mut dense = Lattice::new(lattice.origin(), cell, columns, heights)?;
    dense.resampled(lattice.doublings() + times);
    if lattice.pinned().contains(&true) {
        for post in posts().filter(|&post| is_pinned(lattice, post, times)) {
            dense.pin(post, dense.height(post));
        }
    }
    Ok(dense)
}

/// The cell of `lattice` that holds a post of the denser one, and the post's place in it.
fn place(lattice: &Lattice, post: Post, times: u32) -> (Post, DVec2) {
    let cell = Post {
        column: (post.column >> times).min(lattice.columns() - 2),
        row: (post.row >> times).min(lattice.rows() - 2),
    };
    let within = DVec2::new(
        f64::from(post.column - (cell.column << times)),
        f64::from(post.row - (cell.row << times)),
    );
    (cell, within / f64::from(1u32 << times))
}

fn height(lattice: &Lattice, post: Post, times: u32) -> f32 {
    let (cell, part) = place(lattice, post, times);
    let corners = lattice.corner_heights(cell).map(f64::from);
    let diagonal = Diagonal::of_cell(u64::from(cell.column), u64::from(cell.row));
    let answer = interpolate(Interpolation::Planar, corners, part, diagonal, lattice.cell());
    answer.height_m().map_or(f32::NAN, |height| height as f32)
}

/// Whether all corners that the post lies between are pinned.
fn is_pinned(lattice: &Lattice, post: Post, times: u32) -> bool {
    let (cell, part) = place(lattice, post, times);
    [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().all(|(east, north)| {
        let counts = |step: u32, part: f64| if step == 0 { part < 1.0 } else { part > 0.0 };
        let corner = Post { column: cell.column + east, row: cell.row + north };
        !(counts(east, part.x) && counts(north, part.y)) || lattice.is_pinned(corner)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::query::ground_height;
    use proptest::prelude::*;

    fn hills(columns: u32, rows: u32) -> Lattice {
        let random = |index: u32| index.wrapping_mul(2_654_435_761).rotate_left(13) % 1000;
        let heights = (0..columns * rows).map(|index| random(index) as f32 / 10.0).collect();
        Lattice::new(DVec2::new(5e5, 4e6), DVec2::new(30.0, 25.0), columns, heights).expect("sound")
    }

    proptest! {
        #[test]
        fn every_height_stays_as_it_was(x in 0.0..1.0f64, y in 0.0..1.0f64, times in 1u32..5) {
            let coarse = hills(8, 7);
            let dense = densified(&coarse, times).expect("sound");
            let at = coarse.origin() + DVec2::new(x, y) * coarse.extent().max;
            let heights = [&coarse, &dense].map(|of| ground_height(of, Interpolation::Planar, at).height_m());
            let [before, after] = heights.map(|height| height.expect("inside"));
            prop_assert!((before - after).abs() < 1e-4, "{before} became {after}");
        }
    }

    #[test]
    fn origin_extent_and_old_posts_keep_their_places_to_the_last_bit() {
        let coarse = hills(9, 6);
        let dense = densified(&coarse, 3).expect("sound");
        assert_eq!((dense.origin(), dense.extent()), (coarse.origin(), coarse.extent()));
        for post in coarse.posts() {
            let same = Post { column: post.column * 8, row: post.row * 8 };
            assert_eq!(dense.position(same), coarse.position(post));
            assert_eq!(dense.height(same).to_bits(), coarse.height(post).to_bits());
        }
    }

    #[test]
    fn a_hole_stays_a_hole_and_a_level_pinned_cell_stays_pinned() {
        let mut coarse = hills(5, 5);
        for (column, row) in [(1, 1), (2, 1), (1, 2), (2, 2)] {
            coarse.pin(Post { column, row }, 7.0);
        }
        coarse.pin(Post { column: 4, row: 4 }, f32::NAN);
        let dense = densified(&coarse, 1).expect("sound");
        assert_eq!(dense.pinned().iter().filter(|pinned| **pinned).count(), 9 + 1);
        assert!(
            dense.height(Post { column: 7, row: 7 }).is_nan()
                && !dense.height(Post { column: 6, row: 7 }).is_nan()
        );
    }

    #[test]
    fn posts_are_doubled_until_they_stand_close_enough_or_would_be_too_many() {
        let lattice = hills(1001, 801);
        assert_eq!(doublings_for(&lattice, 40.0), 0);
        assert_eq!(doublings_for(&lattice, 4.0), 3);
        assert_eq!(affordable(&lattice, 3), 2);
        assert_eq!(affordable(&hills(300, 300), 3), 3);
    }
}
