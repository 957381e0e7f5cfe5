//! A smaller raster of one that is read in windows: means over squares of samples, for an overview of ground that is larger
//! than the memory.

use std::ops::Range;

use glam::{DAffine2, DMat2, DVec2};

use crate::dem::error::DemErrorKind;
use crate::dem::raster::{Raster, Samples};
use crate::dem::windows::{RasterWindow, Windows};

/// The raster of every `step`-th sample of `windows`, counted from its south-west one, a power of two: each the mean of the
/// `step` × `step` samples around it that hold data, in meters; NaN where none does. The south-west sample lies where it did.
/// Memory: `step` rows, and the result.
///
/// # Errors
/// The samples cannot be read.
///
/// # Panics
/// Where `step` is no power of two.
pub fn reduced(windows: &mut impl Windows, step: u32) -> Result<Raster, DemErrorKind> {
    let (width, height) = reduced_size(windows.size(), step);
    let from_south = reduced_part(windows, step, 0..width, 0..height)?;
    let samples = from_south.chunks_exact(width as usize).rev().flatten().copied().collect();
    let rows = windows.size().1;
    let whole = windows.metadata();
    let matrix2 = DMat2::from_cols(whole.map_from_grid.matrix2.x_axis, whole.map_from_grid.matrix2.y_axis)
        * f64::from(step);
    let south_west = whole.map_from_grid.transform_point2(DVec2::new(0.5, f64::from(rows) - 0.5));
    let translation = south_west - matrix2 * DVec2::new(0.5, f64::from(height) - 0.5);
    Ok(Raster {
        data_type: "Float32",
        width,
        height,
        samples: Samples::F32(samples),
        meters_per_z: 1.0,
        map_from_grid: DAffine2 { matrix2, translation },
        nodata: None,
        ..whole.without_samples()
    })
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
    let size = windows.size();
    let around = |at: u32, count: u32| at.saturating_sub(step / 2)..(at + step.div_ceil(2)).min(count);
    let (west, east) =
        (around(columns.start * step, size.0).start, around((columns.end - 1) * step, size.0).end);
    let (mut samples, mut buffer) = (Vec::with_capacity(columns.len() * rows.len()), Vec::new());
    for row in rows {
        // Rasters are counted from the north.
        let own = around(size.1 - 1 - row * step, size.1);
        let window =
            RasterWindow { column: west, row: own.start, width: east - west, height: own.end - own.start };
        windows.read(window, &mut buffer)?;
        samples.extend(columns.clone().map(|column| {
            let span = around(column * step, size.0);
            let (from, to) = ((span.start - west) as usize, (span.end - west) as usize);
            mean(buffer.chunks_exact((east - west) as usize).flat_map(|line| &line[from..to]))
        }));
    }
    Ok(samples)
}

/// The mean of the values that are not NaN; NaN without any.
fn mean<'a>(values: impl Iterator<Item = &'a f32>) -> f32 {
    let valid = values.filter(|value| !value.is_nan());
    let (sum, count) = valid.fold((0.0, 0u32), |(sum, count), &value| (sum + f64::from(value), count + 1));
    (sum / f64::from(count)) as f32
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
        assert!(mean([f32::NAN].iter()).is_nan());
        let part = reduced_part(&mut raster, 4, 1..4, 1..3).expect("in memory");
        let wanted = [(1, 2), (2, 2), (3, 2), (1, 1), (2, 1), (3, 1)]
            .map(|(column, row)| small.at(column, row) as f32);
        assert_eq!(part, wanted);
        let same = reduced(&mut raster, 1).expect("in memory");
        assert_eq!((same.width, same.height, same.at(3, 4)), (21, 13, raster.at(3, 4)));
    }
}
