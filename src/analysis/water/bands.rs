//! Land larger than the memory, cut into bands of whole rows, and what is kept of it elsewhere.
//!
//! ```text
//!            ┌──────────────┐ ─┐
//!  band 2    │              │  │ band_rows
//!            ├──────────────┤ ─┘  edge 3: the southern row of band 2
//!            ├──────────────┤     edge 2: the northern row of band 1
//!  band 1    │              │
//!            ├──────────────┤     edge 1: the southern row of band 1
//!            ├──────────────┤     edge 0: the northern row of band 0
//!  band 0    │              │  band_rows to twice as many, so that the others end where bands from the north do
//!            └──────────────┘
//! ```
//!
//! What happens within a band has an effect on others through the posts of its edges alone. So each band is looked at alone, what
//! edges know of each other is solved in memory, and each band is completed with it: the way in which Barnes fills tiles (2016) and
//! accumulates flow over them (2017). Between the looks, the values of posts are kept in a [`BandStore`].

use std::ops::Range;

use crate::error::AnalysisError;

/// The posts of a band, about: a band is at work in some 40 bytes a post.
const BAND_POSTS: usize = 1 << 22;

/// Which values of posts a [`BandStore`] keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BandArray {
    /// Heights, 4 bytes each: at first as a band alone is filled, then filled.
    Heights,
    /// Ways out of the band, 4 bytes each, and later the distances to higher ground.
    Ways,
    /// The distances to lower ground, 4 bytes each.
    Toward,
    /// Directions, a byte each.
    Codes,
}

impl BandArray {
    /// The bytes of a value.
    pub fn bytes(self) -> u64 {
        if self == Self::Codes { 1 } else { 4 }
    }

    /// The bytes a post of all arrays before this one.
    pub fn before(self) -> u64 {
        self as u64 * 4
    }
}

/// Where the heights of land larger than the memory come from, and where values of its posts are kept meanwhile. Posts are counted
/// row by row from the south-west.
pub trait BandStore {
    /// What may happen.
    type Error: From<AnalysisError>;

    /// The heights of rows, two or more, in meters; NaN without data.
    ///
    /// # Errors
    /// They cannot be read.
    fn heights(&mut self, rows: Range<usize>) -> Result<Vec<f32>, Self::Error>;

    /// Fills `out` with what was written of an array, from byte `at` of it on.
    ///
    /// # Errors
    /// It cannot be read.
    fn read(&mut self, array: BandArray, at: u64, out: &mut [u8]) -> Result<(), Self::Error>;

    /// Keeps bytes of an array, from byte `at` of it on.
    ///
    /// # Errors
    /// There is no place for them.
    fn write(&mut self, array: BandArray, at: u64, bytes: &[u8]) -> Result<(), Self::Error>;
}

/// Land cut into bands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LandBands {
    /// Posts of a row, 2 or more.
    pub columns: usize,
    /// All rows, 2 or more.
    pub rows: usize,
    /// The rows of a band, 2 or more.
    band_rows: usize,
}

impl LandBands {
    /// Bands of some million posts.
    pub fn new(columns: usize, rows: usize) -> Self {
        Self::of_rows(columns, rows, BAND_POSTS / columns)
    }

    /// Bands of so many rows.
    pub fn of_rows(columns: usize, rows: usize, band_rows: usize) -> Self {
        Self { columns, rows, band_rows: band_rows.clamp(2, rows.max(2)) }
    }

    /// The number of bands.
    pub fn count(&self) -> usize {
        (self.rows / self.band_rows).max(1)
    }

    /// The number of edges, and of posts on them.
    pub fn edge_posts(&self) -> usize {
        2 * (self.count() - 1) * self.columns
    }

    /// The rows of a band but the southernmost.
    pub fn band_rows(&self) -> usize {
        self.band_rows
    }

    /// The rows of a band.
    pub fn rows_of(&self, band: usize) -> Range<usize> {
        let end = self.rows - (self.count() - 1 - band) * self.band_rows;
        if band == 0 { 0..end } else { end - self.band_rows..end }
    }

    /// The band of a row.
    pub fn band_of(&self, row: usize) -> usize {
        self.count() - 1 - ((self.rows - 1 - row) / self.band_rows).min(self.count() - 1)
    }

    /// The rows of a band and so many more to the south and the north, as far as there are any.
    pub fn rows_around(&self, band: usize, more: usize) -> Range<usize> {
        let Range { start, end } = self.rows_of(band);
        start.saturating_sub(more)..(end + more).min(self.rows)
    }

    /// Whether there is land south and north of a band.
    pub fn is_open(&self, band: usize) -> [bool; 2] {
        [band > 0, band + 1 < self.count()]
    }

    /// The edges of a band in the south and the north that it has, each with its row in the band.
    pub fn edges_of(&self, band: usize) -> impl Iterator<Item = (usize, usize)> {
        let last = self.rows_of(band).len() - 1;
        let south = (band > 0).then(|| (2 * band - 1, 0));
        let north = (band + 1 < self.count()).then_some((2 * band, last));
        south.into_iter().chain(north)
    }

    /// The posts of an edge among those of all edges.
    pub fn edge(&self, edge: usize) -> Range<usize> {
        edge * self.columns..(edge + 1) * self.columns
    }

    /// Reads rows of an array.
    ///
    /// # Errors
    /// As [`BandStore::read`].
    pub fn read<S: BandStore, T: bytemuck::Pod>(
        &self,
        store: &mut S,
        array: BandArray,
        rows: Range<usize>,
    ) -> Result<Vec<T>, S::Error> {
        let mut values = vec![T::zeroed(); rows.len() * self.columns];
        let at = (rows.start * self.columns) as u64 * array.bytes();
        store.read(array, at, bytemuck::cast_slice_mut(&mut values))?;
        Ok(values)
    }

    /// Keeps values of an array from a row on.
    ///
    /// # Errors
    /// As [`BandStore::write`].
    pub fn write<S: BandStore, T: bytemuck::Pod>(
        &self,
        store: &mut S,
        array: BandArray,
        row: usize,
        values: &[T],
    ) -> Result<(), S::Error> {
        store.write(array, (row * self.columns) as u64 * array.bytes(), bytemuck::cast_slice(values))
    }
}

/// The edge on the other side of the border that an edge lies at.
pub(crate) fn opposite(edge: usize) -> usize {
    edge ^ 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_every_row_once_and_end_as_bands_from_the_north() {
        for (rows, band_rows) in [(2, 2), (3, 2), (9, 2), (10, 4), (11, 4), (12, 4), (7, 100)] {
            let bands = LandBands::of_rows(5, rows, band_rows);
            let held: Vec<usize> = (0..bands.count()).flat_map(|band| bands.rows_of(band)).collect();
            assert_eq!(held, (0..rows).collect::<Vec<_>>(), "{rows} by {band_rows}");
            for band in 0..bands.count() {
                assert!(bands.rows_of(band).len() >= 2);
                assert!(bands.rows_of(band).all(|row| bands.band_of(row) == band));
                assert!(band == 0 || bands.rows_of(band).len() == band_rows.min(rows));
            }
            assert_eq!(bands.edges_of(0).count(), usize::from(bands.count() > 1));
        }
        assert_eq!([opposite(0), opposite(1), opposite(6)], [1, 0, 7]);
    }
}
