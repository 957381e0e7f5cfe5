//! Writing ESRI binary grids: `.flt` of 32-bit floats, and `.bil` of the integers or floats that keep the heights. Both have
//! the least significant byte first, an `.hdr` and a `.prj` beside them.
//!
//! The header of a `.flt` is that of Esri's *Float to Raster*, as of an ASCII grid; cells that are not square get `xdim`
//! and `ydim`, which GDAL reads. A `.bil` has no 64-bit numbers: its floats are rounded to 32 bits.

use std::fmt::Write;

use crate::companion::{Companion, projection_file_of};
use crate::file_name::split_extension;
use crate::formats::ehdr::FORMAT;
use crate::written::{WriteError, WrittenDem};
use glam::DVec2;
use sandtable_raster::raster::Raster;
use sandtable_raster::sample_type::{NumberKind, SampleType};
use sandtable_raster::stored::StoredSamples;

/// Written for no data among floats, in the order of preference; the raster's own value comes first.
const NODATA_VALUES: [f64; 4] = [-9999.0, -32768.0, -99999.0, f32::MIN as f64];

pub(super) fn write(raster: &Raster, name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let raster = &FORMAT.north_up(raster)?;
    let is_flt = split_extension(name).1.eq_ignore_ascii_case("flt");
    let (sample, nodata) = stored(raster, is_flt)?;
    let hole = nodata.unwrap_or_default();
    let values: Vec<f64> =
        raster.samples.iter().map(|value| if value.is_nan() { hole } else { value }).collect();
    let mut bytes = Vec::with_capacity(values.len() * sample.bytes());
    sample.write(&values, &mut bytes);
    let header = if is_flt { flt_header(raster, hole) } else { bil_header(raster, sample, nodata) };
    let header = Companion { extension: "hdr", bytes: header.into_bytes() };
    let is_rounded = sample == SampleType::F32 && raster.samples.valid().any(|value| !sample.keeps(value));
    let notes = is_rounded.then(|| "heights are rounded to 32-bit floats".to_owned());
    Ok(WrittenDem {
        companions: [header].into_iter().chain(projection_file_of(raster)).collect(),
        notes: notes.into_iter().collect(),
        ..WrittenDem::new(bytes, sample.gdal_name())
    })
}

/// The type of the samples, and the value for no data.
fn stored(raster: &Raster, is_flt: bool) -> Result<(SampleType, Option<f64>), WriteError> {
    let kept = StoredSamples::new(raster);
    if !is_flt && !kept.sample.is_float() {
        return Ok((kept.sample, kept.nodata));
    }
    let (least, greatest) = SampleType::F32.range();
    let too_large = raster.samples.valid().find(|value| !(*value as f32).is_finite());
    if let Some(found) = too_large {
        return Err(WriteError::OutOfRange { format: FORMAT.name, least, greatest, found });
    }
    let own = raster.nodata.filter(|value| (*value as f32).is_finite()).map(|value| f64::from(value as f32));
    let is_free = |nodata: &f64| raster.samples.iter().all(|value| f64::from(value as f32) != *nodata);
    let taken = WriteError::NoDataTaken { format: FORMAT.name, value: NODATA_VALUES[0] };
    let nodata = own.into_iter().chain(NODATA_VALUES).find(is_free).ok_or(taken)?;
    Ok((SampleType::F32, Some(nodata)))
}

fn flt_header(raster: &Raster, nodata: f64) -> String {
    let (cell, south_west) = (raster.spacing(), raster.extent().min);
    let sides = if cell.x == cell.y {
        format!("cellsize {}", cell.x)
    } else {
        format!("xdim {}\nydim {}", cell.x, cell.y)
    };
    format!(
        "ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\n{sides}\nNODATA_value {nodata}\nbyteorder LSBFIRST\n",
        raster.width, raster.height, south_west.x, south_west.y
    )
}

fn bil_header(raster: &Raster, sample: SampleType, nodata: Option<f64>) -> String {
    let first = raster.map_from_grid.transform_point2(DVec2::splat(0.5));
    let (cell, row_bytes) = (raster.spacing(), raster.width as usize * sample.bytes());
    let kind = match sample.kind() {
        NumberKind::Unsigned => "UNSIGNEDINT",
        NumberKind::Signed => "SIGNEDINT",
        NumberKind::Float => "FLOAT",
    };
    let mut header = format!(
        "BYTEORDER I\nLAYOUT BIL\nNROWS {}\nNCOLS {}\nNBANDS 1\nNBITS {}\nPIXELTYPE {kind}\nBANDROWBYTES {row_bytes}\n\
         TOTALROWBYTES {row_bytes}\nULXMAP {}\nULYMAP {}\nXDIM {}\nYDIM {}\n",
        raster.height,
        raster.width,
        8 * sample.bytes(),
        first.x,
        first.y,
        cell.x,
        cell.y
    );
    if let Some(nodata) = nodata {
        writeln!(header, "NODATA {nodata}").expect("a string takes what is written");
    }
    header
}
