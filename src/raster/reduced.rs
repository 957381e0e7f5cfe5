//! A smaller raster of one that is read in windows: means over squares of samples, for an overview of ground that is larger
//! than the memory, and for pictures that show no more.

use std::ops::Range;

use glam::{DAffine2, DMat2, DVec2};
use rayon::prelude::*;

use crate::error::DemErrorKind;
use crate::raster::{Raster, Samples};
use crate::read_ahead::read_ahead;
use crate::windows::{RasterWindow, Windows};

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
    let whole = windows.metadata().without_samples();
    means_of(&whole, windows, step)
}

/// [`reduced`], computed from the coarsest overview of the file that has at least two samples along the side of a square, if
/// there is one: then no more than some samples of the overview are read for each mean, and it lies where that of all samples
/// would.
///
/// # Errors
/// The samples cannot be read.
///
/// # Panics
/// Where `step` is no power of two.
pub fn reduced_by_overview(windows: &mut (impl Windows + Send), step: u32) -> Result<Raster, DemErrorKind> {
    let whole = windows.metadata().without_samples();
    let of_overview =
        windows.overview(step / 2).map(|(_, mut overview)| means_of(&whole, &mut overview, step));
    of_overview.unwrap_or_else(|| means_of(&whole, windows, step))
}

/// [`reduced`] of `whole`, of which `windows` are the samples or an overview.
fn means_of(whole: &Raster, windows: &mut (impl Windows + Send), step: u32) -> Result<Raster, DemErrorKind> {
    let squares = SampleSquares::new(whole.size(), windows, step);
    let columns = squares.held.0 as usize;
    let (width, height) = reduced_size(squares.whole, step);
    let spans: Vec<Range<usize>> = (0..width).map(|column| squares.columns(column)).collect();
    // The last row holds the southernmost sample.
    let rows_of = |row: u32| squares.rows(height - 1 - row);
    let per_band = (BAND_SAMPLES / squares.held.0 / rows_of(height / 2).len() as u32).max(1);
    let bands = (0..height).step_by(per_band as usize).map(|first| {
        let end = rows_of((first + per_band).min(height) - 1).end as u32;
        let row = rows_of(first).start as u32;
        RasterWindow { column: 0, row, width: squares.held.0, height: end - row }
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
            let [from, to] = [own.start, own.end].map(|row| (row - window.row as usize) * columns);
            fill_means(&heights[from..to], columns, &spans, means);
        });
    })?;
    Ok(Raster { samples: Samples::F32(means), ..reduced_header(whole, step) })
}

/// The raster that [`reduced`] returns, without its samples.
pub fn reduced_header(whole: &Raster, step: u32) -> Raster {
    let (width, height) = reduced_size(whole.size(), step);
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

/// The samples of [`reduced_by_overview`] in a rectangle of it, row by row from the south-west; rows are counted from the
/// south.
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
    let (whole, part) = (windows.size(), (columns, rows));
    let of_overview = windows
        .overview(step / 2)
        .map(|(_, mut overview)| part_means(whole, &mut overview, step, part.clone()));
    of_overview.unwrap_or_else(|| part_means(whole, windows, step, part))
}

fn part_means(
    whole: (u32, u32),
    windows: &mut impl Windows,
    step: u32,
    (columns, rows): (Range<u32>, Range<u32>),
) -> Result<Vec<f32>, DemErrorKind> {
    let (squares, width) = (SampleSquares::new(whole, windows, step), columns.len());
    let spans: Vec<Range<usize>> = columns.map(|column| squares.columns(column)).collect();
    let (west, east) = (spans[0].start, spans[width - 1].end);
    let spans: Vec<Range<usize>> = spans.iter().map(|span| span.start - west..span.end - west).collect();
    let (mut means, mut lines) = (vec![0f32; width * rows.len()], Vec::new());
    let across = east - west;
    let per_band = (BAND_SAMPLES as usize / across / step as usize).max(1);
    for (first, means) in rows.step_by(per_band).zip(means.chunks_mut(width * per_band)) {
        // Rasters are counted from the north.
        let last = first + (means.len() / width) as u32 - 1;
        let (top, end) = (squares.rows(last).start, squares.rows(first).end);
        let (column, row) = (west as u32, top as u32);
        windows.read(
            RasterWindow { column, row, width: across as u32, height: (end - top) as u32 },
            &mut lines,
        )?;
        means.par_chunks_mut(width).enumerate().for_each(|(at, means)| {
            let own = squares.rows(first + at as u32);
            fill_means(&lines[(own.start - top) * across..(own.end - top) * across], across, &spans, means);
        });
    }
    Ok(means)
}

/// The squares of `step` × `step` samples around every `step`-th sample of a raster, as columns and rows of the raster itself
/// or of an overview of it.
struct SampleSquares {
    /// Samples per row, and rows, of the raster.
    whole: (u32, u32),
    /// Those of what is read.
    held: (u32, u32),
    step: u32,
}

impl SampleSquares {
    fn new(whole: (u32, u32), windows: &impl Windows, step: u32) -> Self {
        assert!(step.is_power_of_two(), "{step} is a power of two");
        Self { whole, held: windows.size(), step }
    }

    /// The columns of a square, counted from the west.
    fn columns(&self, square: u32) -> Range<usize> {
        held_around(square * self.step, self.step, (self.whole.0, self.held.0))
    }

    /// The rows of a square, counted from the south; rasters are counted from the north.
    fn rows(&self, square: u32) -> Range<usize> {
        held_around(self.whole.1 - 1 - square * self.step, self.step, (self.whole.1, self.held.1))
    }
}

/// Those of `held` columns, or rows, over `count` samples whose middles lie in the `step` samples around one; at least one.
fn held_around(at: u32, step: u32, (count, held): (u32, u32)) -> Range<usize> {
    let edge = |sample: u32| {
        ((u64::from(sample) * u64::from(held) + u64::from(count / 2)) / u64::from(count)) as usize
    };
    let first = edge(at.saturating_sub(step / 2)).min(held as usize - 1);
    first..edge((at + step.div_ceil(2)).min(count)).max(first + 1)
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
    use crate::raster::north_up_nodes;

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
            let own = held_around(rows - 1 - (4 - row) * 16, 16, (rows, rows));
            let values = own.flat_map(|row| {
                held_around(column * 16, 16, (columns, columns)).map(move |column| (column, row))
            });
            let valid = values
                .map(|(column, row)| raster.at(column as u32, row as u32))
                .filter(|value| !value.is_nan());
            let (sum, count) = valid.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
            let mean = f64::from((sum / f64::from(count)) as f32);
            assert_eq!(small.at(column, row).to_bits(), mean.to_bits(), "{column} {row}");
        }
        assert!(small.at(66, 2).is_nan(), "all of its samples are in the hole");
    }
    /// A raster with one overview of its own, the mean of `times` × `times` samples each.
    struct Overviewed {
        whole: Raster,
        overview: Raster,
        times: u32,
    }

    impl Windows for Overviewed {
        fn metadata(&self) -> &Raster {
            &self.whole
        }

        fn samples(&mut self, _: RasterWindow) -> Result<Samples, DemErrorKind> {
            panic!("the overview is fine enough")
        }

        fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
            (self.times <= step).then(|| (self.times, Box::new(self.overview.clone()) as _))
        }
    }

    #[test]
    fn means_of_an_overview_are_those_of_the_samples_under_it() {
        // Whole numbers, whose sums are exact in any order; a row further north is 16 m higher.
        let height = |column: u32, row: u32| (column * 7 % 64 * 16 + (32 - row) * 16) as f32;
        let over = |(columns, rows): (u32, u32), height: &dyn Fn(u32, u32) -> f32| {
            let heights = (0..columns * rows).map(|at| height(at % columns, at / columns)).collect();
            Raster::new(columns, Samples::F32(heights))
        };
        let whole = over((64, 32), &height).placed(north_up_nodes(DVec2::new(5.0, 9.0), DVec2::splat(10.0)));
        let mean = |column: u32, row: u32| {
            let squares = (0..16).map(|at| height(column * 4 + at % 4, row * 4 + at / 4));
            squares.sum::<f32>() / 16.0
        };
        let mut held = Overviewed { whole: whole.clone(), overview: over((16, 8), &mean), times: 4 };
        for step in [8, 16, 32] {
            let (own, wanted) = (
                reduced_by_overview(&mut held, step).expect("in memory"),
                reduced(&mut whole.clone(), step).expect("in memory"),
            );
            assert_eq!((own.size(), own.map_from_grid), (wanted.size(), wanted.map_from_grid));
            // Squares begin a row of samples further south than rows of the overview do, which count from the north.
            let off = own.samples.iter().zip(wanted.samples.iter()).map(|(own, wanted)| wanted - own);
            assert!(off.into_iter().all(|off| (0.0..=16.0).contains(&off)), "every {step}th");
            let part = reduced_part(&mut held, step, 1..2, 0..1).expect("in memory");
            assert_eq!(f64::from(part[0]), own.at(1, own.height - 1));
        }
    }

    #[test]
    fn squares_of_an_overview_of_odd_size_cover_it_once() {
        for (count, held) in [(65, 33), (1001, 501), (999, 125), (7, 4)] {
            let squares = (count - 1) / 16 + 1;
            let spans: Vec<Range<usize>> =
                (0..squares).map(|square| held_around(square * 16, 16, (count, held))).collect();
            assert_eq!((spans[0].start, spans.iter().all(|span| !span.is_empty())), (0, true));
            assert!(spans.windows(2).all(|two| two[0].end == two[1].start), "{count} {held} {spans:?}");
            assert!(spans[spans.len() - 1].end <= held as usize);
        }
    }
}
