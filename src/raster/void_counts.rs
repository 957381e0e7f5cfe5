//! Counts of voids, row by row: what a raster on disk needs, of which never all is in memory.
//!
//! A void is a set of samples without data that are neighbors along rows and columns, none of them on the raster's border.
//! A row's stretches without data join the voids of the row before that they touch:
//!
//! ```text
//! row before   ──AAAA────BB───CCC──    A and B become one; C is not continued, and so is whole: it is counted
//! row          ────aaaaaaaa────────
//! ```

use crate::raster::{Raster, Samples};
use sandtable_base::disjoint_sets::root;

/// The number of voids, and of the samples in all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VoidCounts {
    /// Voids.
    pub voids: u64,
    /// Their samples.
    pub samples: u64,
}

impl VoidCounts {
    /// The counts of a raster in memory.
    pub fn of(raster: &Raster) -> Self {
        let mut search = VoidSearch::new((raster.width, raster.height));
        search.add_rows(&raster.samples);
        search.finish()
    }
}

/// A count of the voids of a raster whose rows are added in order.
pub(crate) struct VoidSearch {
    width: usize,
    rows: u32,
    /// Rows added.
    row: u32,
    /// The stretches of the last row without data.
    stretches: Vec<VoidStretch>,
    /// The parts of voids that these belong to.
    parts: Vec<VoidPart>,
    counts: VoidCounts,
}

/// Samples of a row without data: from the first to before the end.
#[derive(Clone, Copy)]
struct VoidStretch {
    first: usize,
    end: usize,
    /// Its part, by index.
    part: usize,
}

/// The part of a void in the rows so far.
#[derive(Clone, Copy)]
struct VoidPart {
    samples: u64,
    on_border: bool,
}

impl VoidSearch {
    pub fn new((width, rows): (u32, u32)) -> Self {
        let (stretches, parts, counts) = (Vec::new(), Vec::new(), VoidCounts::default());
        Self { width: width as usize, rows, row: 0, stretches, parts, counts }
    }

    /// Adds the next rows.
    pub fn add_rows(&mut self, samples: &Samples) {
        match samples {
            Samples::F32(values) => self.add_rows_of(values, f32::is_nan),
            Samples::F64(values) => self.add_rows_of(values, f64::is_nan),
        }
    }

    fn add_rows_of<T: Copy>(&mut self, values: &[T], is_missing: impl Fn(T) -> bool) {
        for row in values.chunks_exact(self.width) {
            // Most rows hold data all through: that is seen without a branch a sample.
            if row.iter().fold(false, |found, &value| found | is_missing(value)) || !self.stretches.is_empty()
            {
                self.add_row(|column| is_missing(row[column]));
            } else {
                self.row += 1;
            }
        }
    }

    fn add_row(&mut self, is_missing: impl Fn(usize) -> bool) {
        let on_border = self.row == 0 || self.row + 1 == self.rows;
        self.row += 1;
        let mut found: Vec<VoidStretch> = Vec::new();
        // The parts of the row before, and one for each stretch of this row; links lead to the part that one has joined.
        let mut parts = std::mem::take(&mut self.parts);
        let before = parts.len();
        let mut links: Vec<usize> = (0..before).collect();
        let (mut column, mut touched) = (0, 0);
        while column < self.width {
            if !is_missing(column) {
                column += 1;
                continue;
            }
            let first = column;
            while column < self.width && is_missing(column) {
                column += 1;
            }
            let own = parts.len();
            let reaches_side = first == 0 || column == self.width;
            parts.push(VoidPart { samples: (column - first) as u64, on_border: on_border || reaches_side });
            links.push(own);
            while self.stretches.get(touched).is_some_and(|above| above.end <= first) {
                touched += 1;
            }
            let above = self.stretches[touched..].iter().take_while(|above| above.first < column);
            for above in above {
                join(&mut parts, &mut links, above.part, own);
            }
            found.push(VoidStretch { first, end: column, part: own });
        }
        // Parts that this row continues are numbered anew; the others are whole voids.
        let mut numbers: Vec<Option<usize>> = vec![None; parts.len()];
        for stretch in &mut found {
            let root = root(&mut links, stretch.part);
            stretch.part = *numbers[root].get_or_insert_with(|| {
                self.parts.push(parts[root]);
                self.parts.len() - 1
            });
        }
        for part in (0..before).filter(|&part| links[part] == part && numbers[part].is_none()) {
            self.counts.add(parts[part]);
        }
        self.stretches = found;
    }

    /// The counts after the last row.
    pub fn finish(mut self) -> VoidCounts {
        self.parts.iter().for_each(|&part| self.counts.add(part));
        self.counts
    }
}

impl VoidCounts {
    fn add(&mut self, part: VoidPart) {
        if !part.on_border {
            self.voids += 1;
            self.samples += part.samples;
        }
    }
}

/// Joins two parts: the lower number stays.
fn join(parts: &mut [VoidPart], links: &mut [usize], one: usize, other: usize) {
    let (one, other) = (root(links, one), root(links, other));
    if one == other {
        return;
    }
    let (kept, joined) = (one.min(other), one.max(other));
    let VoidPart { samples, on_border } = parts[joined];
    parts[kept].samples += samples;
    parts[kept].on_border |= on_border;
    links[joined] = kept;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;
    use crate::voids;
    use proptest::prelude::*;

    fn counts(width: u32, rows: &[&str]) -> VoidCounts {
        let value = |at: u8| if at == b'.' { f32::NAN } else { 1.0 };
        VoidCounts::of(&small(width, rows.len() as u32, rows.concat().bytes().map(value).collect()))
    }

    #[test]
    fn arms_that_meet_below_are_one_void_and_the_border_encloses_none() {
        let found = counts(7, &["#######", "#.#.#.#", "#...#.#", "#######", "##.####", "#######", "......#"]);
        assert_eq!(found, VoidCounts { voids: 3, samples: 5 + 2 + 1 });
        assert_eq!(counts(3, &["###", "#.#", "#.#"]), VoidCounts::default());
    }

    proptest! {
        #[test]
        fn counts_by_rows_are_those_of_a_flood(
            width in 1u32..13, holes in proptest::collection::vec(any::<bool>(), 1..160),
        ) {
            let rows = (holes.len() as u32).div_ceil(width);
            let missing = |at: u32| holes.get(at as usize).copied().unwrap_or(false);
            let values = (0..width * rows).map(|at| if missing(at) { f32::NAN } else { 1.0 }).collect();
            let mut raster = small(width, rows, values);
            let found = VoidCounts::of(&raster);
            let flooded = voids::fill(&mut raster);
            prop_assert_eq!((found.voids, found.samples), (flooded.voids, flooded.cells));
        }
    }
}
