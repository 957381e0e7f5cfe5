//! ENVI rasters: a file of plain samples (`.img`, `.dat`, any name) with a text header `.hdr` beside it.
//!
//! Specification: Harris, *ENVI Header Files*. `key = value` lines, lists in braces over any number of lines; the
//! place is `map info = {projection, column, row, x, y, dx, dy, …}`, where pixel (1, 1) is the outer corner of the
//! first sample.

use glam::{DAffine2, DVec2};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::header::{HeaderFields, StatedNoData};
use crate::formats::plain_raster::{self, PlainRaster};
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use sandtable_base::bytes::ByteOrder;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::file_bands::FileBands;
use sandtable_raster::raster::{Raster, north_up};
use sandtable_raster::sample_type::SampleType;

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "ENVI raster",
    extensions: &[],
    shared_extensions: &[],
    recognition: Recognition::HeaderFile { matches: |header| header.starts_with(b"ENVI") },
    reader: |file| plain_raster::read(file, plain),
    windows: Some(|file, content, _| plain_raster::windows(file, content, plain)),
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

/// The first band.
fn plain(file: &DemFile, size: FileSize) -> Result<PlainRaster, DemErrorKind> {
    let text = file.header().ok_or(DemErrorKind::NoHeader(FORMAT.name))?;
    let header = header(&String::from_utf8_lossy(&text));
    let StatedNoData { value: nodata, note } = header.nodata(&["data ignore value"]);
    let layout = layout(&header)?;
    let raster = layout.header(FORMAT.name, size)?;
    let first_number = |key: &str| list(&header, key).first().map(|text| header.parse(key, text)).transpose();
    let gain = first_number("data gain values")?.unwrap_or(1.0);
    let offset = first_number("data offset values")?.unwrap_or(0.0);
    let map = list(&header, "map info");
    let raster = file.placed(raster, place(&map)?, &["wld"])?;
    let crs = file.crs_or(|| match header.get("coordinate system string") {
        Some(text) => Ok(Some(Crs::parse(text)?)),
        None => system(&map),
    })?;
    let bands = FileBands { count: header.whole("bands")?.unwrap_or(1), mask: None };
    let mut raster = Raster { driver: "ENVI", crs, nodata, ..raster }.with_bands(bands);
    raster.notes.extend(note);
    Ok(PlainRaster::new(raster, layout, NoData::Value(nodata)).scaled(gain, offset))
}

/// The fields, values without their braces.
fn header(text: &str) -> HeaderFields {
    let mut header = HeaderFields::new(FORMAT.name);
    let mut lines = text.lines().skip(1);
    while let Some(line) = lines.next() {
        let Some((key, value)) = line.split_once('=') else { continue };
        let mut value = value.trim().to_owned();
        while value.starts_with('{') && !value.ends_with('}') {
            let Some(line) = lines.next() else { break };
            value.push(' ');
            value.push_str(line.trim());
        }
        let list = value.strip_prefix('{').map(|rest| rest.strip_suffix('}').unwrap_or(rest));
        header.push(key, list.unwrap_or(&value));
    }
    header
}

/// The parts of a list; none where it is not stated.
fn list<'a>(header: &'a HeaderFields, key: &str) -> Vec<&'a str> {
    header.get(key).map(|text| text.split(',').map(str::trim).collect()).unwrap_or_default()
}

fn layout(header: &HeaderFields) -> Result<SampleLayout, DemErrorKind> {
    let sample = match header.required("data type")? {
        1 => SampleType::U8,
        2 => SampleType::I16,
        3 => SampleType::I32,
        4 => SampleType::F32,
        5 => SampleType::F64,
        12 => SampleType::U16,
        13 => SampleType::U32,
        14 => SampleType::I64,
        15 => SampleType::U64,
        other => {
            let remedy = "convert it, for example with: gdal_translate -ot Float64 FILE out.tif";
            return Err(FORMAT.unsupported(format!("data type {other} (complex numbers)"), remedy));
        }
    };
    let size = (header.required("samples")?, header.required("lines")?);
    let bands = header.whole("bands")?.unwrap_or(1);
    let order = match header.whole("byte order")?.unwrap_or(0) {
        0 => ByteOrder::Little,
        1 => ByteOrder::Big,
        other => return Err(header.broken(format!("byte order is {other}; 0 and 1 exist"))),
    };
    let dense = SampleLayout::dense(size, sample, order, header.whole("header offset")?.unwrap_or(0));
    match header.get("interleave").unwrap_or("bsq").to_ascii_lowercase().as_str() {
        "bsq" => Ok(dense),
        "bil" => Ok(SampleLayout { row_step: dense.row_step.saturating_mul(bands), ..dense }),
        "bip" => Ok(dense.by_pixel(bands)),
        other => Err(header.broken(format!("interleave is '{other}'; bsq, bil and bip exist"))),
    }
}

/// The place that the parts of `map info` state; `None` where there are none.
fn place(map: &[&str]) -> Result<Option<DAffine2>, DemErrorKind> {
    let wrong =
        |reason: String| DemErrorKind::Georeference { reason, remedy: "correct map info in its .hdr" };
    let part = |index: usize| {
        let text = map.get(index).copied().unwrap_or_default();
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| wrong(format!("part {} of map info is '{text}', not a number", index + 1)))
    };
    if map.is_empty() {
        return Ok(None);
    }
    let rotation = map.iter().find_map(|part| part.strip_prefix("rotation="));
    if let Some(angle) = rotation.filter(|angle| angle.trim().parse::<f64>().ok() != Some(0.0)) {
        return Err(DemErrorKind::Georeference {
            reason: format!("it is turned by {angle} degrees"),
            remedy: "straighten it first, for example with: gdalwarp FILE out.tif",
        });
    }
    let first = DVec2::new(part(1)? - 1.0, part(2)? - 1.0);
    let (at, cell) = (DVec2::new(part(3)?, part(4)?), DVec2::new(part(5)?, part(6)?));
    if cell.min_element() <= 0.0 {
        return Err(wrong(format!("its cells are {} by {}", cell.x, cell.y)));
    }
    Ok(Some(north_up(at + DVec2::new(-first.x, first.y) * cell, cell)))
}

/// The system that `map info` names: UTM or geographic on WGS 84, the most common ones.
fn system(map: &[&str]) -> Result<Option<Crs>, DemErrorKind> {
    let is = |index: usize, name: &str| map.get(index).is_some_and(|part| part.eq_ignore_ascii_case(name));
    if is(0, "Geographic Lat/Lon") && is(7, "WGS-84") {
        return Ok(Some(Crs::wgs84()));
    }
    if !(is(0, "UTM") && is(9, "WGS-84")) {
        return Ok(None);
    }
    let zone = map.get(7).and_then(|zone| zone.parse::<u8>().ok()).map(i64::from);
    let zone = zone.filter(|zone| (1..=60).contains(zone));
    let system = zone.map(|zone| Crs::utm_on(4326, if is(8, "South") { -zone } else { zone }, 1.0));
    Ok(system.transpose()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

    fn raster(header: &str, bytes: &[u8]) -> Result<Raster, String> {
        let header = format!("ENVI\n{header}");
        let beside = move |name: &str| (name == "a.hdr").then(|| header.clone().into_bytes());
        let hints = DemHints { companions: &beside, ..DemHints::default() };
        read("a.img", bytes, &hints).map_err(|error| error.to_string())
    }

    #[test]
    fn lists_may_run_over_lines_and_the_first_sample_need_not_be_the_tied_one() {
        let header = "samples = 2\nlines = 1\ndata type = 2\nbyte order = 1\ndescription = {\n samples = 9}\n\
                      map info = {UTM, 2, 1, 500010,\n 4000000, 10, 10, 33, South, WGS-84}\n";
        let raster = raster(header, &[0, 7, 0xff, 0xff]).expect("a raster");
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [7.0, -1.0]);
        assert_eq!(raster.geotransform(), [500_000.0, 10.0, 0.0, 4e6, 0.0, -10.0]);
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32733));
    }

    #[test]
    fn gain_and_offset_of_the_first_band_are_applied() {
        let header = "samples = 1\nlines = 1\nbands = 2\ninterleave = bip\ndata type = 1\ndata ignore value = 255\n\
                      data gain values = {0.5, 9}\ndata offset values = {-3, 9}\n";
        assert_eq!(raster(header, &[8, 1]).expect("a raster").at(0, 0), 1.0);
        assert!(raster(header, &[255, 1]).expect("a raster").at(0, 0).is_nan());
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_key() {
        let refused = |header: &str| raster(header, &[0; 8]).expect_err("refused");
        assert!(refused("samples = 2\nlines = 2\n").contains("data type"));
        assert!(refused("samples = 2\nlines = 2\ndata type = 6\n").contains("data type 6"));
        assert!(
            refused("samples = -2\nlines = 2\ndata type = 1\n").contains("samples in its header is '-2'")
        );
        assert!(refused("samples = 9\nlines = 9\ndata type = 1\n").contains("cannot be held"));
        let turned = "samples = 1\nlines = 1\ndata type = 1\nmap info = {UTM,1,1,0,0,1,1,33,North,WGS-84,rotation=9}\n";
        assert!(refused(turned).contains("turned"));
    }
}
