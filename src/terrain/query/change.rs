//! What was cut and filled between two epochs of the same ground, exact.
//!
//! Both epochs have the same posts and so the same finest triangles; over each the difference is one plane, whose parts
//! above and below zero are counted apart. A post that rose beside one that sank therefore counts for both.

use crate::terrain::lattice::Lattice;
use crate::terrain::query::pieces::{GridRegion, TrianglePiece};
use crate::terrain::query::zone::{Known, add_rises, in_cubic_meters};
use crate::terrain::volumes::Volumes;

/// The difference between two epochs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// The earth moved.
    pub volumes: Volumes,
    /// Square meters of plan that could not be compared, because one of the epochs has no data there.
    pub no_data_m2: f64,
}

/// Why two lattices cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the two grounds do not have the same posts; resample one onto the other first")]
pub struct OtherPosts;

/// What was moved within `region` from `before` to `after`.
///
/// # Errors
/// [`OtherPosts`], where origin, cell or size differ.
///
/// # Panics
/// Where the region is one of a larger lattice.
pub fn moved(before: &Lattice, after: &Lattice, region: &GridRegion) -> Result<Moved, OtherPosts> {
    let frame = |lattice: &Lattice| {
        (lattice.origin(), lattice.cell(), lattice.first(), lattice.columns(), lattice.rows())
    };
    if frame(before) != frame(after) {
        return Err(OtherPosts);
    }
    let bands = region.fold(|sums: &mut (Volumes, f64), piece| {
        let (old, new) = (before.corner_heights(piece.cell), after.corner_heights(piece.cell));
        // Most of the ground stays as it is.
        if old == new {
            return;
        }
        let rises = std::array::from_fn(|corner| f64::from(new[corner]) - f64::from(old[corner]));
        add(sums, piece, rises);
    });
    let cell = before.cell();
    let no_data_cells: f64 = bands.iter().map(|band| band.1).sum();
    let volumes = in_cubic_meters(before, bands.into_iter().map(|band| band.0).collect());
    Ok(Moved { volumes, no_data_m2: no_data_cells.max(0.0) * cell.x * cell.y })
}

fn add((volumes, no_data_cells): &mut (Volumes, f64), piece: TrianglePiece<'_>, rises: [f64; 4]) {
    if add_rises(volumes, piece, rises) == Known::No {
        *no_data_cells += piece.fan().map(|(_, area)| area).sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::earthworks::brush::set_heights;
    use crate::terrain::lattice::Post;
    use crate::terrain::post_rect::PostRect;
    use glam::DVec2;

    fn ground() -> Lattice {
        let heights = (0..33 * 33).map(|index| (index % 33) as f32 * 0.5).collect();
        Lattice::new(DVec2::ZERO, DVec2::new(4.0, 2.0), 33, heights).expect("sound")
    }

    fn raised(lattice: &Lattice, post: Post, by_m: f32) -> Lattice {
        let mut after = lattice.clone();
        let height = after.height(post) + by_m;
        set_heights(&mut after, PostRect { first: post, last: post }, &[height]);
        after
    }

    #[test]
    fn a_raised_post_is_a_pyramid_over_the_triangles_round_it() {
        let before = ground();
        let whole = GridRegion::whole(&before);
        // Eight triangles, or four, of half a cell, a third of the rise high on average.
        for (post, triangles) in [(Post { column: 7, row: 9 }, 8.0), (Post { column: 7, row: 8 }, 4.0)] {
            let after = raised(&before, post, 6.0);
            let exact = triangles * 4.0 * 6.0 / 3.0;
            let found = moved(&before, &after, &whole).expect("the same posts");
            assert!((found.volumes.fill_m3 - exact).abs() < 1e-9, "{found:?}");
            assert_eq!((found.volumes.cut_m3, found.no_data_m2), (0.0, 0.0));
            let back = moved(&after, &before, &whole).expect("the same posts");
            assert!((back.volumes.cut_m3 - exact).abs() < 1e-9 && back.volumes.fill_m3 == 0.0);
        }
    }

    #[test]
    fn cut_and_fill_side_by_side_are_both_counted() {
        let before = ground();
        let (low, high) = (Post { column: 7, row: 9 }, Post { column: 8, row: 9 });
        let after = raised(&raised(&before, low, -2.0), high, 2.0);
        let found = moved(&before, &after, &GridRegion::whole(&before)).expect("the same posts");
        let net = found.volumes.fill_m3 - found.volumes.cut_m3;
        // Eight triangles sink at the one, four rise at the other.
        assert!((net - (4.0 - 8.0) * 4.0 * 2.0 / 3.0).abs() < 1e-9, "{found:?}");
        assert!(found.volumes.fill_m3 > 4.0 && found.volumes.cut_m3 > 4.0, "{found:?}");
    }

    #[test]
    fn only_what_lies_within_the_polygon_counts() {
        let before = ground();
        let after =
            raised(&raised(&before, Post { column: 5, row: 5 }, 3.0), Post { column: 25, row: 25 }, 3.0);
        let near = [(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)].map(DVec2::from).to_vec();
        let region = GridRegion::new(&before, &[near]).expect("sound");
        let found = moved(&before, &after, &region).expect("the same posts");
        assert!((found.volumes.fill_m3 - 8.0 * 4.0 * 3.0 / 3.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn ground_that_one_of_them_lacks_is_told() {
        let before = ground();
        let mut heights = before.heights().to_vec();
        heights[before.index(Post { column: 5, row: 5 })] = f32::NAN;
        let after = Lattice::new(before.origin(), before.cell(), 33, heights).expect("sound");
        let found = moved(&before, &after, &GridRegion::whole(&before)).expect("the same posts");
        assert_eq!(found, Moved { volumes: Volumes::default(), no_data_m2: 8.0 * 4.0 });
        let other = Lattice::new(DVec2::ONE, DVec2::new(4.0, 2.0), 33, before.heights().to_vec());
        let compared = moved(&before, &other.expect("sound"), &GridRegion::whole(&before));
        assert_eq!(compared, Err(OtherPosts));
    }
}
