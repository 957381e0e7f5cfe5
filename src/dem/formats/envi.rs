//! ENVI rasters: a file of plain samples (`.img`, `.dat`, any name) with a text header `.hdr` beside it.
//!
//! Specification: Harris, *ENVI Header Files*. `key = value` lines, lists in braces over any number of lines; the
//! place is `map info = {projection, column, row, x, y, dx, dy, …}`, where pixel (1, 1) is the outer corner of the
//! first sample.

use glam::DVec2;

use crate::dem::error::DemErrorKind;
use crate::dem::formats::plain::{ByteOrder, Number, SampleLayout};
use crate::dem::georef::{self, RasterPlace};
use crate::dem::raster::{Raster, north_up};
use crate::dem::read::DemFile;
use crate::geom::crs::Crs;

const FORMAT: &str = "ENVI raster";

/// Whether `header` is the text of such a header.
pub(crate) fn is_header(header: &[u8]) -> bool {
    header.starts_with(b"ENVI")
}

/// Reads the first band as `header`, the file beside it, says.
pub(crate) fn read(source: &DemFile, header: &[u8]) -> Result<Raster, DemErrorKind> {
    let header = EnviHeader::new(&String::from_utf8_lossy(header));
    let number = header.number_kind()?;
    let nodata = header.float("data ignore value")?;
    let (width, height, samples) = header.layout(number)?.read(FORMAT, source.bytes, nodata)?;
    let gain = header.first_of("data gain values")?.unwrap_or(1.0);
    let offset = header.first_of("data offset values")?.unwrap_or(0.0);
    let map = header.list("map info");
    let place = match map.is_empty() {
        false => place(&map)?,
        true => georef::beside(source, height, &["wld"])?,
    };
    let crs = match (&source.hints.crs, header.get("coordinate system string")) {
        (Some(crs), _) => Some(crs.clone()),
        (None, Some(text)) => Some(Crs::parse(text).map_err(DemErrorKind::Crs)?),
        (None, None) => system(&map)?.map_or_else(|| source.crs_beside(), |crs| Ok(Some(crs)))?,
    };
    Ok(Raster {
        driver: "ENVI",
        data_type: number.gdal_name(),
        width,
        height,
        samples: samples.scaled(gain, offset),
        meters_per_z: 1.0,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs,
        nodata,
        vertical_datum: None,
    })
}

/// The pairs of the header, keys in lower case, values without their braces.
struct EnviHeader(Vec<(String, String)>);

impl EnviHeader {
    fn new(text: &str) -> Self {
        let mut pairs: Vec<(String, String)> = Vec::new();
        let mut open = false;
        for line in text.lines().skip(1) {
            if let (true, Some((_, value))) = (open, pairs.last_mut()) {
                value.push(' ');
                value.push_str(line.trim());
            } else if let Some((key, value)) = line.split_once('=') {
                pairs.push((key.trim().to_ascii_lowercase(), value.trim().to_owned()));
            } else {
                continue;
            }
            open = pairs.last().is_some_and(|(_, value)| value.starts_with('{') && !value.ends_with('}'));
        }
        for (_, value) in &mut pairs {
            let inner = value.strip_prefix('{').map(|rest| rest.strip_suffix('}').unwrap_or(rest).trim());
            if let Some(inner) = inner.map(str::to_owned) {
                *value = inner;
            }
        }
        Self(pairs)
    }

    fn get(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    /// The parts of a list; none where it is not stated.
    fn list(&self, key: &str) -> Vec<&str> {
        self.get(key).map(|text| text.split(',').map(str::trim).collect()).unwrap_or_default()
    }

    fn whole(&self, key: &str) -> Result<Option<u64>, DemErrorKind> {
        let Some(text) = self.get(key) else { return Ok(None) };
        text.parse().map(Some).map_err(|_| not_a_number(key, text))
    }

    fn float(&self, key: &str) -> Result<Option<f64>, DemErrorKind> {
        self.get(key).map(|text| number(key, text)).transpose()
    }

    fn first_of(&self, key: &str) -> Result<Option<f64>, DemErrorKind> {
        self.list(key).first().map(|text| number(key, text)).transpose()
    }

    fn number_kind(&self) -> Result<Number, DemErrorKind> {
        match self.whole("data type")? {
            Some(1) => Ok(Number::U8),
            Some(2) => Ok(Number::I16),
            Some(3) => Ok(Number::I32),
            Some(4) => Ok(Number::F32),
            Some(5) => Ok(Number::F64),
            Some(12) => Ok(Number::U16),
            Some(13) => Ok(Number::U32),
            Some(other) => Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what: format!("data type {other} (complex or 64-bit whole numbers)"),
                remedy: "convert it, for example with: gdal_translate -ot Float64 FILE out.tif",
            }),
            None => Err(DemErrorKind::broken(FORMAT, "its header does not state the data type")),
        }
    }

    fn layout(&self, number: Number) -> Result<SampleLayout, DemErrorKind> {
        let size = |key: &'static str| {
            let missing = || DemErrorKind::broken(FORMAT, format!("its header does not state {key}"));
            self.whole(key)?.ok_or_else(missing)
        };
        let (width, height) = (size("samples")?, size("lines")?);
        let bands = self.whole("bands")?.unwrap_or(1);
        let order = match self.whole("byte order")?.unwrap_or(0) {
            0 => ByteOrder::Little,
            1 => ByteOrder::Big,
            other => {
                return Err(DemErrorKind::broken(FORMAT, format!("byte order is {other}; 0 and 1 exist")));
            }
        };
        let start = self.whole("header offset")?.unwrap_or(0);
        let dense = SampleLayout::dense((width, height), number, order, start);
        match self.get("interleave").unwrap_or("bsq").to_ascii_lowercase().as_str() {
            "bsq" => Ok(dense),
            "bil" => Ok(SampleLayout { row_step: dense.row_step.saturating_mul(bands), ..dense }),
            "bip" => Ok(SampleLayout {
                sample_step: dense.sample_step.saturating_mul(bands),
                row_step: dense.row_step.saturating_mul(bands),
                ..dense
            }),
            other => {
                Err(DemErrorKind::broken(FORMAT, format!("interleave is '{other}'; bsq, bil and bip exist")))
            }
        }
    }
}

fn number(key: &str, text: &str) -> Result<f64, DemErrorKind> {
    match text.parse::<f64>() {
        Ok(value) => Ok(value),
        Err(_) => Err(not_a_number(key, text)),
    }
}

fn not_a_number(key: &str, text: &str) -> DemErrorKind {
    let shown: String = text.chars().take(20).collect();
    DemErrorKind::broken(FORMAT, format!("{key} in its header is '{shown}', not a number"))
}

/// The place that the parts of `map info` state.
fn place(map: &[&str]) -> Result<RasterPlace, DemErrorKind> {
    let wrong =
        |reason: String| DemErrorKind::Georeference { reason, remedy: "correct map info in its .hdr" };
    let part = |index: usize| {
        let text = map.get(index).copied().unwrap_or_default();
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| wrong(format!("part {} of map info is '{text}', not a number", index + 1)))
    };
    let turned = map.iter().find_map(|part| part.strip_prefix("rotation="));
    if let Some(angle) = turned.filter(|angle| angle.trim().parse::<f64>().ok() != Some(0.0)) {
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
    let corner = at + DVec2::new(-first.x, first.y) * cell;
    Ok(RasterPlace { map_from_grid: north_up(corner, cell), stated: true })
}

/// The system that `map info` names: UTM or geographic on WGS 84, what most are written in.
fn system(map: &[&str]) -> Result<Option<Crs>, DemErrorKind> {
    let is = |index: usize, name: &str| map.get(index).is_some_and(|part| part.eq_ignore_ascii_case(name));
    if is(0, "Geographic Lat/Lon") && is(7, "WGS-84") {
        return Ok(Some(Crs::wgs84()));
    }
    let zone = map.get(7).and_then(|zone| zone.parse::<u32>().ok()).filter(|zone| (1..=60).contains(zone));
    match zone {
        Some(zone) if is(0, "UTM") && is(9, "WGS-84") => {
            let base = if is(8, "South") { 32700 } else { 32600 };
            Crs::from_epsg(base + zone).map(Some).map_err(DemErrorKind::Crs)
        }
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

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
