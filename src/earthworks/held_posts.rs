//! Posts that earthworks leave as they are: those under water, which stays level.

use sandtable_terrain::lattice::{Lattice, Post};

/// Posts of a lattice, kept as runs along its rows, so that a few lakes in a large model take little memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HeldPosts {
    /// Sorted by row, then by column.
    runs: Vec<PostRun>,
    /// How often the spacing of the lattice's posts was halved when the runs were taken.
    doublings: u32,
}

/// Posts of one row from the first to the last column, ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct PostRun {
    row: u32,
    first: u32,
    last: u32,
}

impl HeldPosts {
    /// The posts that are pinned now.
    pub fn pinned(lattice: &Lattice) -> Self {
        let mut runs: Vec<PostRun> = Vec::new();
        if !lattice.has_pins() {
            return Self { runs, doublings: lattice.doublings() };
        }
        for (row, pinned) in (0..).zip(lattice.pinned().chunks_exact(lattice.columns() as usize)) {
            let mut from = 0;
            while let Some(start) = pinned[from..].iter().position(|&pin| pin).map(|at| from + at) {
                let end = pinned[start..].iter().position(|&pin| !pin).map_or(pinned.len(), |at| start + at);
                runs.push(PostRun { row, first: start as u32, last: end as u32 - 1 });
                from = end;
            }
        }
        Self { runs, doublings: lattice.doublings() }
    }

    /// Whether none is held.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Whether a post of the lattice is held. Where posts were put in between those of the runs
    /// ([`sandtable_terrain::densify`]), those between held ones are held. `lattice` may be a part of the one of the runs.
    pub fn holds(&self, lattice: &Lattice, post: Post) -> bool {
        if self.is_empty() {
            return false;
        }
        let times = lattice.doublings().saturating_sub(self.doublings);
        let between = |at: u32| {
            let low = at >> times;
            let high = if low << times == at { low } else { low + 1 };
            low..=high
        };
        let post = post.offset(lattice.first().column, lattice.first().row);
        between(post.row).all(|row| between(post.column).all(|column| self.has(Post { column, row })))
    }

    fn has(&self, post: Post) -> bool {
        let after = self.runs.partition_point(|run| (run.row, run.first) <= (post.row, post.column));
        let run = after.checked_sub(1).map(|index| self.runs[index]);
        run.is_some_and(|run| run.row == post.row && post.column <= run.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_terrain::densify::densify;

    fn lattice(pins: &[(u32, u32)]) -> Lattice {
        let mut lattice = Lattice::new(DVec2::ZERO, DVec2::ONE, 7, vec![5.0; 42]).expect("sound");
        pins.iter().for_each(|&(column, row)| lattice.pin(Post { column, row }, 4.0));
        lattice
    }

    #[test]
    fn the_pinned_posts_are_held_and_no_others() {
        let lattice = lattice(&[(0, 0), (1, 0), (3, 0), (6, 0), (0, 1), (6, 4), (2, 5), (3, 5), (6, 5)]);
        let held = HeldPosts::pinned(&lattice);
        for post in lattice.posts() {
            assert_eq!(held.holds(&lattice, post), lattice.is_pinned(post), "{post:?}");
        }
        assert!(
            HeldPosts::default().is_empty()
                && !HeldPosts::default().holds(&lattice, Post { column: 0, row: 0 })
        );
    }

    #[test]
    fn posts_put_in_between_held_ones_are_held() {
        let coarse = lattice(&[(2, 2), (3, 2), (2, 3), (3, 3), (5, 5)]);
        let held = HeldPosts::pinned(&coarse);
        let dense = densify(&coarse, 2).expect("sound");
        let count = dense.posts().filter(|&post| held.holds(&dense, post)).count();
        assert_eq!(count, 5 * 5 + 1);
        for post in dense.posts() {
            assert_eq!(held.holds(&dense, post), dense.is_pinned(post), "{post:?}");
        }
    }
}
