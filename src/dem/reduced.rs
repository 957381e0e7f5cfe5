//! A smaller raster of one that is read in windows: means over squares of samples, for an overview of ground that is larger
//! than the memory, and for pictures that show no more.

use std::ops::Range;

use glam::{DAffine2, DMat2, DVec2};
use rayon::prelude::*;

use crate::dem::error::DemErrorKind;
use crate::dem::raster::{Raster, Samples};
use crate::dem::read_ahead::read_ahead;
use crate::dem::windows::{RasterWindow, Windows};

/// Samples that are read at a time: rows of tiles of a file.
const BAND_SAMPLES: u32 = 1 << 22;

/// The raster of every `step`-th sample of `windows`, counted from its south-west one, a power of two: each the mean of the
/// `step` × `step` samples around it that hold data, in meters; NaN where none does. The south-west sample lies where it did.
/// The same bits for every number of threads. Memory: some rows, at least `step` of them twice, and the result.
///
/// # Errors
/// The samples cannot be read.
///
/// # Panics
/// Where `step` is no power of two.
pub fn reduced(windows: &mut (impl Windows + Send), step: u32) -> Result<Raster, DemErrorKind> {
    assert!(step.is_power_of_two(), "{step} is a power of two");
    let (columns, rows) = windows.size();
    let (width, height) = reduced_size((columns, rows), step);
    let spans: Vec<Range<usize>> = (0..width).map(|column| around(column * step, step, columns)).collect();
    // The last row holds the southernmost sample.
    let rows_of = |row: u32| around(rows - 1 - (height - 1 - row) * step, step, rows);
    let per_band = (BAND_SAMPLES / columns / step).max(1);
    let bands = (0..height).step_by(per_band as usize).map(|first| {
        let end = rows_of((first + per_band).min(height) - 1).end as u32;
        let row = rows_of(first).start as u32;
        RasterWindow { column: 0, row, width: columns, height: end - row }
    });
    let mut means = vec![0f32; width as usize * height as usize];
    let mut of_bands =
        means.chunks_mut(width as usize * per_band as usize).zip((0..).step_by(per_band as usize));
    let read = |source: &mut _, window| {
        let mut heights = Vec::new();
        Windows::read(source, window, &mut heights).map(|()| heights)
    };
    read_ahead(windows, bands, read, |window, heights: Vec<f32>| {
        let Some((means, first)) = of_bands.next() else { return };
        means.par_chunks_mut(width as usize).enumerate().for_each(|(at, means)| {
            let own = rows_of(first + at as u32);
            let [from, to] = [own.start, own.end].map(|row| (row - window.row as usize) * columns as usize);
            fill_means(&heights[from..to], columns as usize, &spans, means);
        });
    })?;
    Ok(Raster { samples: Samples::F32(means), ..reduced_header(windows.metadata(), step) })
}

/// What [`reduced`] makes of a raster, without its samples.
pub fn reduced_header(whole: &Raster, step: u32) -> Raster {
    let (width, height) = reduced_size((whole.width, whole.height), step);
    let matrix2 = DMat2::from_cols(whole.map_from_grid.matrix2.x_axis, whole.map_from_grid.matrix2.y_axis)
        * f64::from(step);
    let south_west = whole.map_from_grid.transform_point2(DVec2::new(0.5, f64::from(whole.height) - 0.5));
    let translation = south_west - matrix2 * DVec2::new(0.5, f64::from(height) - 0.5);
    Raster {
        data_type: "Float32",
        width,
        height,
        samples: Samples::F32(Vec::new()),
        meters_per_z: 1.0,
        map_from_grid: DAffine2 { matrix2, translation },
        nodata: None,
        ..whole.without_samples()
    }
}

/// Samples per row, and rows, of every `step`-th sample of a raster of `size`.
pub fn reduced_size((columns, rows): (u32, u32), step: u32) -> (u32, u32) {
    ((columns - 1) / step + 1, (rows - 1) / step + 1)
}

/// The samples of [`reduced`] in a rectangle of it, row by row from the south-west; rows are counted from the south.
///
/// # Errors
/// The samples cannot be read.
///
/// # Panics
/// Where `step` is no power of two, or the rectangle is empty or reaches beyond the reduced raster.
pub fn reduced_part(
    windows: &mut impl Windows,
    step: u32,
    columns: Range<u32>,
    rows: Range<u32>,
) -> Result<Vec<f32>, DemErrorKind> {
    assert!(step.is_power_of_two(), "{step} is a power of two");
    let (size, width) = (windows.size(), columns.len());
    let spans: Vec<Range<usize>> = columns.map(|column| around(column * step, step, size.0)).collect();
    let (west, east) = (spans[0].start, spans[width - 1].end);
    let spans: Vec<Range<usize>> = spans.iter().map(|span| span.start - west..span.end - west).collect();
    let (mut means, mut lines) = (vec![0f32; width * rows.len()], Vec::new());
    // Rasters are counted from the north.
    let lines_of = |row: u32| around(size.1 - 1 - row * step, step, size.1);
    let across = east - west;
    let per_band = (BAND_SAMPLES as usize / across / step as usize).max(1);
    for (first, means) in rows.step_by(per_band).zip(means.chunks_mut(width * per_band)) {
        let last = first + (means.len() / width) as u32 - 1;
        let (top, end) = (lines_of(last).start, lines_of(first).end);
        let (column, row) = (west as u32, top as u32);
        windows.read(
            RasterWindow { column, row, width: across as u32, height: (end - top) as u32 },
            &mut lines,
        )?;
        means.par_chunks_mut(width).enumerate().for_each(|(at, means)| {
            let own = lines_of(first + at as u32);
            fill_means(&lines[(own.start - top) * across..(own.end - top) * across], across, &spans, means);
        });
    }
    Ok(means)
}

/// The `step` columns, or rows, around one of `count`.
fn around(at: u32, step: u32, count: u32) -> Range<usize> {
    at.saturating_sub(step / 2) as usize..(at + step.div_ceil(2)).min(count) as usize
}

/// Fills a row of means over the columns `spans` of `lines`, which are as long as `columns`; NaN where all values are.
fn fill_means(lines: &[f32], columns: usize, spans: &[Range<usize>], means: &mut [f32]) {
    let mut sums = vec![(0.0, 0u32); spans.len()];
    for line in lines.chunks_exact(columns) {
        for ((sum, count), span) in sums.iter_mut().zip(spans) {
            for value in line[span.clone()].iter().filter(|value| !value.is_nan()) {
                *sum += f64::from(*value);
                *count += 1;
            }
        }
    }
    for (mean, (sum, count)) in means.iter_mut().zip(sums) {
        *mean = (sum / f64::from(count)) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::raster::north_up_nodes;

    #[test]
    fn means_lie_where_their_samples_do_and_holes_count_for_nothing() {
        // Height rises by 2 m a column and by 5 m a row northward: means of squares lie half a sample to the north-west.
        let height = |at: u32| (at % 21) as f32 * 2.0 + (12 - at / 21) as f32 * 5.0;
        let heights = (0..21 * 13).map(|at| if at == 12 * 21 { f32::NAN } else { height(at) }).collect();
        let mut raster = Raster::new(21, Samples::F32(heights))
            .placed(north_up_nodes(DVec2::new(500.0, 900.0), DVec2::splat(10.0)));
        let small = reduced(&mut raster, 4).expect("in memory");
        assert_eq!((small.width, small.height, small.spacing()), (6, 4, DVec2::splat(40.0)));
        let south_west = |raster: &Raster| {
            raster.map_from_grid.transform_point2(DVec2::new(0.5, f64::from(raster.height) - 0.5))
        };
        assert_eq!(south_west(&small), south_west(&raster));
        assert_eq!(small.at(2, 1), 2.0 * 7.5 + 5.0 * 8.5);
        // The corner is the mean of five of the six samples there.
        assert_eq!(small.at(0, 3), f64::from((2.0f32 + 5.0 + 7.0 + 10.0 + 12.0) / 5.0));
        let part = reduced_part(&mut raster, 4, 1..4, 1..3).expect("in memory");
        let wanted = [(1, 2), (2, 2), (3, 2), (1, 1), (2, 1), (3, 1)]
            .map(|(column, row)| small.at(column, row) as f32);
        assert_eq!(part, wanted);
        let same = reduced(&mut raster, 1).expect("in memory");
        assert_eq!((same.width, same.height, same.at(3, 4)), (21, 13, raster.at(3, 4)));
    }

    #[test]
    fn bands_of_rows_give_the_means_of_squares_and_nan_without_data() {
        // Rows so long that a band holds few of them, and a hole as wide as several squares.
        let (columns, rows) = (1 << 16, 70);
        let is_hole = |at: u32| (1000..1100).contains(&(at % columns)) && (20..50).contains(&(at / columns));
        let height = |at: u32| if is_hole(at) { f32::NAN } else { (at.wrapping_mul(7919) % 1013) as f32 };
        let mut raster = Raster::new(columns, Samples::F32((0..columns * rows).map(height).collect()));
        let small = reduced(&mut raster, 16).expect("in memory");
        assert_eq!((small.width, small.height), (4096, 5));
        for (column, row) in [(0, 0), (17, 1), (66, 2), (66, 1), (4095, 4), (2048, 3)] {
            let own = around(rows - 1 - (4 - row) * 16, 16, rows);
            let values =
                own.flat_map(|row| around(column * 16, 16, columns).map(move |column| (column, row)));
            let valid = values
                .map(|(column, row)| raster.at(column as u32, row as u32))
                .filter(|value| !value.is_nan());
            let (sum, count) = valid.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
            let mean = f64::from((sum / f64::from(count)) as f32);
            assert_eq!(small.at(column, row).to_bits(), mean.to_bits(), "{column} {row}");
        }
        assert!(small.at(66, 2).is_nan(), "all of its samples are in the hole");
    }
}
