//! The volumes cut and filled between two snapshots of the same ground, exact.
//!
//! Both have the same posts and so the same finest triangles; over each the difference is one plane, whose parts above and
//! below zero are counted apart. A post that rose beside one that sank therefore counts for both.

use crate::lattice::Lattice;
use crate::query::pieces::GridRegion;
use crate::query::zone::add_rises;
use crate::volumes::Volumes;

/// The difference between two snapshots.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundChange {
    /// The earth moved.
    pub volumes: Volumes,
    /// Square meters of plan that cannot be compared, because one of the snapshots has no data there.
    pub no_data_m2: f64,
}

/// Why two lattices cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the two grounds do not have the same posts; resample one onto the other first")]
pub struct PostsDiffer;

/// The change within `region` from `before` to `after`.
///
/// # Errors
/// [`PostsDiffer`], where origin, cell or size differ.
///
/// # Panics
/// Where the region is one of a larger lattice.
pub fn ground_change(
    before: &Lattice,
    after: &Lattice,
    region: &GridRegion,
) -> Result<GroundChange, PostsDiffer> {
    let frame = |lattice: &Lattice| {
        (lattice.origin(), lattice.cell(), lattice.first(), lattice.columns(), lattice.rows())
    };
    if frame(before) != frame(after) {
        return Err(PostsDiffer);
    }
    // In cells instead of square meters.
    let bands = region.fold(|sums: &mut GroundChange, piece| {
        let (old, new) = (before.corner_heights(piece.cell), after.corner_heights(piece.cell));
        // Most of the ground stays as it is.
        if old == new {
            return;
        }
        let rises = std::array::from_fn(|corner| f64::from(new[corner]) - f64::from(old[corner]));
        if piece.has_data(rises) {
            add_rises(&mut sums.volumes, piece, rises);
        } else {
            sums.no_data_m2 += piece.area_cells();
        }
    });
    let no_data_cells: f64 = bands.iter().map(|band| band.no_data_m2).sum();
    let volumes = bands.into_iter().map(|band| band.volumes * before.cell_m2()).sum();
    Ok(GroundChange { volumes, no_data_m2: no_data_cells.max(0.0) * before.cell_m2() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Post;
    use glam::DVec2;

    fn ground() -> Lattice {
        let heights = (0..33 * 33).map(|index| (index % 33) as f32 * 0.5).collect();
        Lattice::new(DVec2::ZERO, DVec2::new(4.0, 2.0), 33, heights).expect("sound")
    }

    fn raised(lattice: &Lattice, post: Post, by_m: f32) -> Lattice {
        let mut heights = lattice.heights().to_vec();
        heights[lattice.index(post)] += by_m;
        Lattice::new(lattice.origin(), lattice.cell(), lattice.columns(), heights).expect("sound")
    }

    #[test]
    fn a_raised_post_is_a_pyramid_over_the_triangles_around_it() {
        let before = ground();
        let whole = GridRegion::whole(&before);
        // Eight triangles, or four, of half a cell, a third of the rise high on average.
        for (post, triangles) in [(Post { column: 7, row: 9 }, 8.0), (Post { column: 7, row: 8 }, 4.0)] {
            let after = raised(&before, post, 6.0);
            let exact = triangles * 4.0 * 6.0 / 3.0;
            let found = ground_change(&before, &after, &whole).expect("the same posts");
            assert!((found.volumes.fill_m3 - exact).abs() < 1e-9, "{found:?}");
            assert_eq!((found.volumes.cut_m3, found.no_data_m2), (0.0, 0.0));
            let back = ground_change(&after, &before, &whole).expect("the same posts");
            assert!((back.volumes.cut_m3 - exact).abs() < 1e-9 && back.volumes.fill_m3 == 0.0);
        }
    }

    #[test]
    fn cut_and_fill_side_by_side_are_both_counted() {
        let before = ground();
        let (low, high) = (Post { column: 7, row: 9 }, Post { column: 8, row: 9 });
        let after = raised(&raised(&before, low, -2.0), high, 2.0);
        let found = ground_change(&before, &after, &GridRegion::whole(&before)).expect("the same posts");
        let net = found.volumes.fill_m3 - found.volumes.cut_m3;
        // Eight triangles sink at the one, four rise at the other.
        assert!((net - (4.0 - 8.0) * 4.0 * 2.0 / 3.0).abs() < 1e-9, "{found:?}");
        assert!(found.volumes.fill_m3 > 4.0 && found.volumes.cut_m3 > 4.0, "{found:?}");
    }

    #[test]
    fn only_changes_within_the_polygon_count() {
        let before = ground();
        let after =
            raised(&raised(&before, Post { column: 5, row: 5 }, 3.0), Post { column: 25, row: 25 }, 3.0);
        let near = [(0.0, 0.0), (40.0, 0.0), (40.0, 20.0), (0.0, 20.0)].map(DVec2::from).to_vec();
        let region = GridRegion::new(&before, &[near]).expect("sound");
        let found = ground_change(&before, &after, &region).expect("the same posts");
        assert!((found.volumes.fill_m3 - 8.0 * 4.0 * 3.0 / 3.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn areas_without_data_in_one_snapshot_are_counted() {
        let before = ground();
        let mut heights = before.heights().to_vec();
        heights[before.index(Post { column: 5, row: 5 })] = f32::NAN;
        let after = Lattice::new(before.origin(), before.cell(), 33, heights).expect("sound");
        let found = ground_change(&before, &after, &GridRegion::whole(&before)).expect("the same posts");
        assert_eq!(found, GroundChange { volumes: Volumes::default(), no_data_m2: 8.0 * 4.0 });
        let other = Lattice::new(DVec2::ONE, DVec2::new(4.0, 2.0), 33, before.heights().to_vec());
        let compared = ground_change(&before, &other.expect("sound"), &GridRegion::whole(&before));
        assert_eq!(compared, Err(PostsDiffer));
    }
}
