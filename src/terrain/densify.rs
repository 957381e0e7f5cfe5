//! Inserts posts between the measured ones, for features narrower than a cell.
//!
//! Between posts the ground is the plane of the finest triangles. Posts inserted on those planes change nothing: the
//! halves of a cell have their diagonals where the cell had its own, because column and row of a cell's lower half are
//! both even in the doubled lattice:
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
//! So every height stays as it was, up to the rounding of the new posts to f32. Spacing is only ever halved: halves of a
//! cell are exact in binary, and origin, extent and the old posts keep their positions to the last bit. A smooth surface
//! through the posts would look rounder, but would move ground that no feature touches.

use glam::DVec2;
use rayon::prelude::*;

use crate::cell_triangle::Diagonal;
use crate::lattice::{Lattice, LatticeError, Post};
use crate::query::Interpolation;
use crate::query::cell::interpolate;
use crate::returned_memory::returned_zeros;
use sandtable_base::limits::GROUND_POSTS;
use sandtable_base::limits::GROUND_ROW_POSTS;

/// The most halvings: a thirty-second of the measured spacing says nothing new about the ground.
const MOST_DOUBLINGS: u32 = 5;

/// Puts in posts until they are at most `spacing_m` apart, as far as a lattice may have posts. Returns how often they
/// were doubled; the ground stays as it was.
pub fn bring_to(lattice: &mut Lattice, spacing_m: f64) -> u32 {
    let times = affordable_doublings(lattice, doublings_for(lattice, spacing_m));
    if times > 0
        && let Ok(dense) = densify(lattice, times)
    {
        *lattice = dense;
        return times;
    }
    0
}

/// The number of doublings of the lattice after which its posts are at most `spacing_m` apart; no more than
/// `MOST_DOUBLINGS` of the measured posts.
pub fn doublings_for(lattice: &Lattice, spacing_m: f64) -> u32 {
    let spacing = |times: u32| lattice.cell().max_element() / f64::from(1u32 << times);
    let most = MOST_DOUBLINGS.saturating_sub(lattice.doublings());
    (0..most).find(|&times| spacing(times) <= spacing_m).unwrap_or(most)
}

/// The largest number of doublings, up to `wanted`, that leaves the lattice within `GROUND_POSTS`.
pub fn affordable_doublings(lattice: &Lattice, wanted: u32) -> u32 {
    let side = |posts: u32, times: u32| ((u64::from(posts) - 1) << times) + 1;
    let is_affordable = |&times: &u32| {
        let (columns, rows) = (side(lattice.columns(), times), side(lattice.rows(), times));
        columns.max(rows) <= GROUND_ROW_POSTS.get() && columns * rows <= GROUND_POSTS.get()
    };
    (1..=wanted).rev().find(is_affordable).unwrap_or(0)
}

/// The same ground with its posts doubled `times` times; a post between pinned ones is pinned. Spread over all threads; the
/// same for any number of them.
///
/// # Errors
/// Those of [`Lattice::new`], of which a lattice that was made by it has none, and a lack of memory.
pub fn densify(lattice: &Lattice, times: u32) -> Result<Lattice, LatticeError> {
    let side = |posts: u32| ((posts - 1) << times) + 1;
    let (columns, rows) = (side(lattice.columns()), side(lattice.rows()));
    Lattice::check_memory(columns, rows)?;
    let mut heights = returned_zeros(columns as usize * rows as usize);
    heights.par_chunks_exact_mut(columns as usize).zip(0..rows).for_each(|(heights, row)| {
        for (height_m, column) in heights.iter_mut().zip(0..columns) {
            *height_m = height(lattice, Post { column, row }, times);
        }
    });
    let cell = lattice.cell() / f64::from(1u32 << times);
    let mut dense = Lattice::new(lattice.origin(), cell, columns, heights)?;
    dense.set_doublings(lattice.doublings() + times);
    if lattice.has_pins() {
        let posts = (0..rows).flat_map(|row| (0..columns).map(move |column| Post { column, row }));
        for post in posts.filter(|&post| is_pinned(lattice, post, times)) {
            dense.pin(post, dense.height(post));
        }
    }
    Ok(dense)
}

/// The cell of `lattice` that holds a post of the denser one, and the post's position in it.
fn place(lattice: &Lattice, post: Post, times: u32) -> (Post, DVec2) {
    let cell = Post {
        column: (post.column >> times).min(lattice.columns() - 2),
        row: (post.row >> times).min(lattice.rows() - 2),
    };
    let corner = Post { column: cell.column << times, row: cell.row << times };
    (cell, (post.grid() - corner.grid()) / f64::from(1u32 << times))
}

fn height(lattice: &Lattice, post: Post, times: u32) -> f32 {
    let (cell, part) = place(lattice, post, times);
    let corners = lattice.corner_heights(cell).map(f64::from);
    let answer = interpolate(Interpolation::Planar, corners, part, Diagonal::of_cell(cell), lattice.cell());
    answer.height_m().map_or(f32::NAN, |height| height as f32)
}

/// Whether all corners that the post lies between are pinned.
fn is_pinned(lattice: &Lattice, post: Post, times: u32) -> bool {
    let (cell, part) = place(lattice, post, times);
    [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().all(|(east, north)| {
        let counts = |step: u32, part: f64| if step == 0 { part < 1.0 } else { part > 0.0 };
        !(counts(east, part.x) && counts(north, part.y)) || lattice.is_pinned(cell.offset(east, north))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::ground_height;
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
            let dense = densify(&coarse, times).expect("sound");
            let at = coarse.origin() + DVec2::new(x, y) * coarse.extent().max;
            let heights = [&coarse, &dense].map(|of| ground_height(of, Interpolation::Planar, at).height_m());
            let [before, after] = heights.map(|height| height.expect("inside"));
            prop_assert!((before - after).abs() < 1e-4, "{before} became {after}");
        }
    }

    #[test]
    fn any_number_of_threads_puts_in_the_same_posts() {
        let mut coarse = hills(61, 47);
        coarse.pin(Post { column: 8, row: 9 }, f32::NAN);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let dense = pool.install(|| densify(&coarse, 2)).expect("sound");
            dense.heights().iter().map(|height| height.to_bits()).collect::<Vec<_>>()
        };
        let one = with(1);
        assert_eq!(one.len(), 241 * 185);
        assert!([2, 3, 16].iter().all(|&threads| with(threads) == one));
    }

    #[test]
    fn origin_extent_and_old_posts_keep_their_positions_to_the_last_bit() {
        let coarse = hills(9, 6);
        let dense = densify(&coarse, 3).expect("sound");
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
        let dense = densify(&coarse, 1).expect("sound");
        assert_eq!(dense.pinned().iter().filter(|pinned| **pinned).count(), 9 + 1);
        assert!(
            dense.height(Post { column: 7, row: 7 }).is_nan()
                && !dense.height(Post { column: 6, row: 7 }).is_nan()
        );
    }

    #[test]
    fn posts_are_doubled_until_they_are_close_enough_or_too_many() {
        let lattice = hills(1001, 801);
        assert_eq!(doublings_for(&lattice, 40.0), 0);
        assert_eq!(doublings_for(&lattice, 4.0), 3);
        assert_eq!(affordable_doublings(&lattice, 3), 2);
        assert_eq!(affordable_doublings(&hills(300, 300), 3), 3);
    }
}
