//! ESRI ASCII grid: a header of keys, then the heights as text, north row first; the system in a `.prj` beside it.
//!
//! A height is written with as many digits as tell it from its neighbors in its own precision, so that it comes back
//! to the last bit. Cells that are not square get `dx` and `dy` in place of `cellsize`, as GDAL reads and writes them.

use std::fmt::Write;

use crate::dem::raster::{Raster, Samples};
use crate::dem::write::{WriteError, WrittenDem, check_place, projection_file};

const FORMAT: &str = "ESRI ASCII grid";

/// What stands for no data, in the order of preference; the raster's own comes before.
const HOLES: [f64; 3] = [-9999.0, -32768.0, -99999.0];

/// Writes a raster in meters.
///
/// # Errors
/// It has no place, or rows that do not run east and south.
pub(crate) fn write(raster: &Raster) -> Result<WrittenDem, WriteError> {
    check_place(raster, FORMAT)?;
    let hole = hole(raster)?;
    let (cell, south_west) = (raster.spacing(), raster.extent().min);
    let mut text = format!("ncols {}\nnrows {}\n", raster.width, raster.height);
    put(&mut text, format_args!("xllcorner {}\nyllcorner {}\n", south_west.x, south_west.y));
    if cell.x == cell.y {
        put(&mut text, format_args!("cellsize {}\n", cell.x));
    } else {
        put(&mut text, format_args!("dx {}\ndy {}\n", cell.x, cell.y));
    }
    put(&mut text, format_args!("NODATA_value {hole}\n"));
    let width = raster.width as usize;
    match &raster.samples {
        Samples::F32(values) => rows(&mut text, values, width, |value| value.is_nan(), hole),
        Samples::F64(values) => rows(&mut text, values, width, |value| value.is_nan(), hole),
    }
    Ok(WrittenDem {
        bytes: text.into_bytes(),
        companions: projection_file(raster.crs.as_ref()).into_iter().collect(),
        stored: "text".into(),
        notes: Vec::new(),
    })
}

fn rows<T: Copy + std::fmt::Display>(
    text: &mut String,
    values: &[T],
    width: usize,
    is_hole: impl Fn(T) -> bool,
    hole: f64,
) {
    for row in values.chunks_exact(width) {
        for (at, &value) in row.iter().enumerate() {
            text.push_str(if at == 0 { "" } else { " " });
            if is_hole(value) {
                put(text, format_args!("{hole}"));
            } else {
                put(text, format_args!("{value}"));
            }
        }
        text.push('\n');
    }
}

fn put(text: &mut String, what: std::fmt::Arguments) {
    text.write_fmt(what).expect("a string takes what is written");
}

/// A value that is no height; always written, since readers take −9999 for one where none is stated.
fn hole(raster: &Raster) -> Result<f64, WriteError> {
    let own = raster.nodata.filter(|value| value.is_finite());
    let is_free = |hole: &f64| raster.samples.iter().all(|value| value != *hole);
    let taken = WriteError::HoleTaken { format: FORMAT, value: HOLES[0] };
    own.into_iter().chain(HOLES).find(is_free).ok_or(taken)
}
