//! Strips of rows that are drawn one after the other, so that the faces of a long list do not lie in memory all at once: those
//! of the strip that is drawn, and of the next.
//!
//! ```text
//!   pieces by band of 64 rows:   begins  120  80  900  40      a strip of bands a..b shows what begins before b
//!                                 ends     0  70  130 940      less what ends before a
//! ```
//!
//! Faces that lie in two strips are made twice, to the same bits; the picture does not depend on the strips.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::cpu::geometry::GeometrySource;
use crate::cpu::visibility::TILE;

/// The most pieces of a picture in one strip: 40 MB of faces and pieces.
const MOST_PIECES: u64 = 1 << 18;

/// The most pieces of one of several strips, two of which are in memory. Fewer would have triangles projected more often.
const STRIP_PIECES: u64 = MOST_PIECES / 2;

/// The strips of a picture.
pub struct RowStrips {
    /// The rows of each, from the top; all but the last end at a band's end.
    pub rows: Vec<Range<u32>>,
    /// The rows that each block of triangles may touch; empty for a picture in one strip.
    pub block_rows: Vec<Range<u32>>,
}

impl RowStrips {
    /// The strips that a source needs.
    pub fn new(source: &GeometrySource) -> Self {
        let is_one = source.triangle_count() <= MOST_PIECES;
        Self::of(source, if is_one { MOST_PIECES } else { STRIP_PIECES })
    }

    /// Strips of up to `most` pieces, or of one band.
    pub fn of(source: &GeometrySource, most: u64) -> Self {
        let rows = source.rows();
        if source.triangle_count() <= most {
            return Self { rows: vec![rows], block_rows: Vec::new() };
        }
        let bands = rows.end.div_ceil(TILE) as usize;
        let [begins, ends] = [(); 2].map(|()| (0..bands).map(|_| AtomicU64::new(0)).collect::<Vec<_>>());
        let block_rows = source.survey(|rows| {
            begins[(rows.start / TILE) as usize].fetch_add(1, Ordering::Relaxed);
            ends[((rows.end - 1) / TILE) as usize].fetch_add(1, Ordering::Relaxed);
        });
        let [begins, ends] =
            [begins, ends].map(|counts| counts.into_iter().map(AtomicU64::into_inner).collect());
        let strips = BandCounts { begins, ends }.cut(most);
        let rows = strips.into_iter().map(|bands| bands.start * TILE..(bands.end * TILE).min(rows.end));
        Self { rows: rows.collect(), block_rows }
    }
}

/// How many pieces begin and end in each band.
struct BandCounts {
    begins: Vec<u64>,
    ends: Vec<u64>,
}

impl BandCounts {
    /// The bands in strips of up to `most` pieces, or of one band.
    fn cut(&self, most: u64) -> Vec<Range<u32>> {
        let mut strips = Vec::new();
        let (mut first, mut begun, mut ended) = (0, 0u64, 0u64);
        for (band, &begins) in (0..).zip(&self.begins) {
            if band > first && begun + begins - ended > most {
                strips.push(first..band);
                let before = &self.ends[first as usize..band as usize];
                ended += before.iter().sum::<u64>();
                first = band;
            }
            begun += begins;
        }
        strips.push(first..self.begins.len() as u32);
        strips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_hold_all_bands_and_no_more_pieces_than_they_may() {
        let counts = BandCounts { begins: vec![5, 3, 9, 30, 0, 1], ends: vec![0, 8, 4, 5, 30, 1] };
        assert_eq!(counts.cut(100), vec![0u32..6; 1]);
        assert_eq!(counts.cut(17), [0..3, 3..4, 4..5, 5..6], "a band may hold more");
        assert_eq!(counts.cut(8), [0..2, 2..3, 3..4, 4..5, 5..6]);
        let shown = |bands: &Range<u32>| -> u64 {
            let begun: u64 = counts.begins[..bands.end as usize].iter().sum();
            begun - counts.ends[..bands.start as usize].iter().sum::<u64>()
        };
        for most in 1..60 {
            let strips = counts.cut(most);
            assert!(strips.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(strips.iter().all(|strip| shown(strip) <= most || strip.len() == 1));
        }
    }
}
