//! Lattices cut out of larger ones: posts are counted anew, and keep their positions to the last bit.

use crate::lattice::{Lattice, LatticeError};
use crate::post_rect::PostRect;

impl Lattice {
    /// The held posts as a lattice of their own, a [part](Lattice::part) of this one. All heights are held then; diagonals
    /// may differ.
    ///
    /// # Errors
    /// [`LatticeError::TooSmall`] where fewer than two columns or rows are held.
    pub fn cut_to_held(&self) -> Result<Self, LatticeError> {
        self.cut_to(self.held())
    }

    /// These posts as a lattice of their own, a [part](Lattice::part) of this one, of which those are held that are held here.
    /// Diagonals may differ.
    ///
    /// # Errors
    /// [`LatticeError::TooSmall`] for fewer than two columns or rows.
    ///
    /// # Panics
    /// Where posts are held here that do not belong to it.
    pub fn cut_to(&self, posts: PostRect) -> Result<Self, LatticeError> {
        let (columns, rows) = (posts.width() as u32, posts.height() as u32);
        if columns < 2 || rows < 2 {
            return Err(LatticeError::TooSmall(columns, rows));
        }
        let held = self.held();
        assert!(posts.contains(held.first) && posts.contains(held.last), "{held:?} are not all of {posts:?}");
        let first = posts.first.offset(self.first().column, self.first().row);
        let heights = self.held_heights().to_vec();
        Self::holding((self.origin(), self.cell()), first, (columns, rows), held.counted_in(posts), heights)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::lattice::Post;

    fn rect(first: (u32, u32), last: (u32, u32)) -> PostRect {
        let post = |(column, row)| Post { column, row };
        PostRect { first: post(first), last: post(last) }
    }

    #[test]
    fn what_is_cut_keeps_its_heights_and_positions() {
        let heights = (0..30u8).map(f32::from).collect();
        let whole = Lattice::new(DVec2::new(0.3, 0.7), DVec2::new(0.1, 0.3), 6, heights).expect("sound");
        let (held, around) = (rect((1, 2), (4, 4)), rect((1, 1), (5, 4)));
        let part = whole.holding_only(held);
        let (cut, wider) =
            (part.cut_to_held().expect("four by three"), part.cut_to(around).expect("five by four"));
        assert_eq!(cut.heights(), part.held_heights());
        assert_eq!((wider.columns(), wider.rows(), wider.held()), (5, 4, held.counted_in(around)));
        for post in held.posts() {
            for (lattice, counted_in) in [(&cut, held), (&wider, around)] {
                let own = PostRect { first: post, last: post }.counted_in(counted_in).first;
                assert_eq!(lattice.height(own), whole.height(post));
                assert_eq!(lattice.map_position(own), whole.map_position(post));
            }
        }
        assert_eq!(part.cut_to(rect((1, 2), (4, 2))).err(), Some(LatticeError::TooSmall(4, 1)));
    }
}
