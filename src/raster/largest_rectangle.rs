//! The largest axis-parallel rectangle of a raster's samples that holds no sample from outside the data.
//!
//! Samples without data that are connected to the raster's border along rows and columns lie outside the data: the empty
//! wedges of a warped raster, for one. Voids, which other samples enclose, do not count.
//!
//! Every row is the base of a histogram: the height of a column is the number of samples inside the data from that row
//! upward. The largest rectangle under a histogram comes from one pass with a stack of rising columns, so that all takes
//! time in proportion to the samples (Vandevoorde 1998, "The maximal rectangle problem").

use crate::raster::Raster;

/// A rectangle of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleRect {
    /// The westernmost column.
    pub left: u32,
    /// The northernmost row.
    pub top: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl SampleRect {
    /// The number of samples in it.
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Whether each sample of `raster` has no data and is connected to the border by such samples.
pub fn outside(raster: &Raster) -> Vec<bool> {
    let mut outside = vec![false; raster.samples.len()];
    let mut open: Vec<usize> = Vec::new();
    let visit = |at: usize, open: &mut Vec<usize>, outside: &mut Vec<bool>| {
        if !outside[at] && raster.samples.get(at).is_nan() {
            outside[at] = true;
            open.push(at);
        }
    };
    for start in raster.border() {
        visit(start, &mut open, &mut outside);
        while let Some(at) = open.pop() {
            raster.beside(at).into_iter().flatten().for_each(|next| visit(next, &mut open, &mut outside));
        }
    }
    outside
}

/// The largest rectangle of samples that are not `outside`, of rows of `width` samples; of several the one that ends first
/// in the order of the samples. Empty where all are outside.
pub fn largest_rectangle(outside: &[bool], width: u32) -> SampleRect {
    let mut best = SampleRect::default();
    let mut heights = vec![0u32; width as usize];
    let mut rising = Vec::new();
    for (row, samples) in (0u32..).zip(outside.chunks_exact(width as usize)) {
        for (height, &is_outside) in heights.iter_mut().zip(samples) {
            *height = if is_outside { 0 } else { *height + 1 };
        }
        let under = largest_under(&heights, &mut rising);
        if under.area() > best.area() {
            best = SampleRect { top: row + 1 - under.height, ..under };
        }
    }
    best
}

/// The largest rectangle under a histogram, on its base; `rising` is scratch: the starts of columns with their heights.
fn largest_under(heights: &[u32], rising: &mut Vec<(u32, u32)>) -> SampleRect {
    let mut best = SampleRect::default();
    rising.clear();
    // A column of height 0 after the last closes all rectangles.
    for (column, height) in (0u32..).zip(heights.iter().copied().chain([0])) {
        let mut start = column;
        while let Some(&(left, open)) = rising.last().filter(|(_, open)| *open >= height) {
            let closed = SampleRect { left, top: 0, width: column - left, height: open };
            if closed.area() > best.area() {
                best = closed;
            }
            start = left;
            rising.pop();
        }
        if height > 0 {
            rising.push((start, height));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;

    fn raster(rows: &[&str]) -> Raster {
        let values = rows.concat().chars().map(|mark| if mark == '#' { 1.0 } else { f32::NAN }).collect();
        small(rows[0].len() as u32, rows.len() as u32, values)
    }

    fn largest(rows: &[&str]) -> SampleRect {
        largest_rectangle(&outside(&raster(rows)), rows[0].len() as u32)
    }

    #[test]
    fn wedges_are_cut_and_enclosed_voids_are_not() {
        let rows = ["..####", "..####", ".##.##", ".#####", "#####.", "#####."];
        assert_eq!(largest(&rows), SampleRect { left: 2, top: 0, width: 3, height: 6 });
        assert_eq!(largest(&["###", "#.#", "###"]), SampleRect { left: 0, top: 0, width: 3, height: 3 });
        // Open to the border, the void counts.
        assert_eq!(largest(&["#.#", "#.#", "###"]), SampleRect { left: 0, top: 0, width: 1, height: 3 });
        assert_eq!(largest(&["..", ".."]), SampleRect::default());
    }

    #[test]
    fn no_rectangle_is_larger_whatever_the_samples() {
        for seed in 0..60u32 {
            let (width, height) = (3 + seed % 6, 2 + seed / 9);
            let blocked = |at: u32| (at.wrapping_mul(2_654_435_761u32.wrapping_add(seed * 97)) >> 16) & 7 < 2;
            let outside: Vec<bool> = (0..width * height).map(|at| blocked(at + seed * 131)).collect();
            let is_free = |rect: SampleRect| {
                let rows = rect.top..rect.top + rect.height;
                let mut columns =
                    rows.flat_map(|row| (rect.left..rect.left + rect.width).map(move |at| (row, at)));
                columns.all(|(row, column)| !outside[(row * width + column) as usize])
            };
            let all = (0..width).flat_map(|left| (0..height).map(move |top| (left, top))).flat_map(
                |(left, top)| {
                    let sizes = (1..=width - left).flat_map(move |w| (1..=height - top).map(move |h| (w, h)));
                    sizes.map(move |(width, height)| SampleRect { left, top, width, height })
                },
            );
            let most = all.filter(|rect| is_free(*rect)).map(|rect| rect.area()).max().unwrap_or(0);
            let found = largest_rectangle(&outside, width);
            assert!(found.area() == most && is_free(found), "seed {seed}: {found:?} for {most}");
        }
    }
}
