//! Writing a grid as text, a point a line, rows from the north: the places of nodes and their heights with as many digits
//! as they need to come back.
//!
//! A node without data has the height `nan`: left out, an empty border would make the grid smaller, and many would make it
//! scattered points. GDAL reads lines of equal length alone as a grid as well.

use std::fmt::Write;

use glam::DVec2;

use crate::companion::projection_file_of;
use crate::formats::xyz::FORMAT;
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::raster::{Raster, SampleFloat, Samples};

pub(super) fn write(raster: &Raster, _name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let raster = &FORMAT.north_up(raster)?;
    if raster.width.min(raster.height) < 2 {
        return Err(WriteError::Shape {
            format: FORMAT.name,
            wanted: "at least two columns and two rows, from which the cell follows",
            found: format!("{} x {} samples", raster.width, raster.height),
        });
    }
    let mut text = String::new();
    match &raster.samples {
        Samples::F32(values) => write_points(&mut text, raster, values),
        Samples::F64(values) => write_points(&mut text, raster, values),
    }
    let (all, valid) = (raster.samples.len(), raster.samples.valid().count());
    let notes =
        (valid < all).then(|| format!("{} of {all} points have no data, written as nan", all - valid));
    Ok(WrittenDem {
        companions: projection_file_of(raster).into_iter().collect(),
        notes: notes.into_iter().collect(),
        ..WrittenDem::new(text.into_bytes(), "text")
    })
}

fn write_points<T: SampleFloat>(text: &mut String, raster: &Raster, values: &[T]) {
    for (row, values) in values.chunks(raster.width as usize).enumerate() {
        for (column, &value) in values.iter().enumerate() {
            let at = DVec2::new(column as f64, row as f64) + 0.5;
            let at = raster.map_from_grid.transform_point2(at);
            let wide: f64 = value.into();
            let written = if wide.is_nan() {
                writeln!(text, "{} {} nan", at.x, at.y)
            } else {
                writeln!(text, "{} {} {value}", at.x, at.y)
            };
            written.expect("a string takes what is written");
        }
    }
}
