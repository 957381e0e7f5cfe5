//! Binary Terrain of the Virtual Terrain Project (`.bt`): versions 1.0 to 1.3 are read, 1.3 is written.
//!
//! ```text
//! offset   1.1 – 1.3                     1.0
//!   0      "binterr1.x"
//!  10      columns i32, rows i32
//!  18      bytes per value i16, float? i16   bytes per value i32
//!  22      horizontal unit i16               UTM? i16
//!  24      UTM zone i16 (south negative)
//!  26      datum i16                         left right bottom top f32
//!  28      left right bottom top f64         (float? i32 at 42)
//!  60      projection in a .prj? i16         (1.2 on)
//!  62      meters per vertical unit f32      (1.3)
//! 256      values, little-endian, by columns from the south-west, each column northward
//! ```
//!
//! As in VTP's own reader **the extents are the coordinates of the outermost grid nodes**: neighbors are (right −
//! left) / (columns − 1) apart. GDAL takes the same numbers for outer edges of cells and divides by the number of
//! columns; the two differ by up to half a cell. −32768 is no data in all three types of value.
//!
//! The coordinate system is written to the header where that can name it (UTM and degrees on a few datums), and always
//! to a `.prj` beside the file.

use glam::DVec2;

use crate::companion::projection_file_of;
use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition};
use crate::formats::plain_raster::{self, PlainRaster};
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use crate::written::{WriteError, WrittenDem};
use sandtable_base::bytes::{ByteFields, ByteOrder};
use sandtable_geom::crs::Crs;
use sandtable_geom::length_unit::{FOOT_M, US_SURVEY_FOOT_M};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef::crs_on_earth;
use sandtable_raster::raster::{Raster, north_up_nodes};
use sandtable_raster::sample_type::SampleType;
use sandtable_raster::stored::StoredSamples;

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "BT terrain",
    extensions: &["bt"],
    shared_extensions: &[],
    recognition: Recognition::Content {
        matches: |bytes| bytes.starts_with(b"binterr"),
        start: "'binterr1.' and a digit",
    },
    reader: |file| plain_raster::read(file, plain),
    windows: Some(|file, content, _| plain_raster::windows(file, content, plain)),
    most_bytes,
    writer: Some(FormatWriter { extensions: &["bt"], write }),
    windows_writer: None,
};

/// The first byte of the values, in every version.
const HEADER: usize = 256;

const NODATA: f64 = -32768.0;

/// EPSG's number of the datum WGS 84.
const WGS84_DATUM: i16 = 6326;

/// The header and the samples; some writers add a trailer.
fn most_bytes(head: &[u8]) -> u64 {
    const TRAILER: u64 = 64 << 10;
    let samples = |header: BtHeader| u64::from(header.columns) * u64::from(header.rows);
    let bytes = BtHeader::read(head).map_or(0, |header| 4 * samples(header));
    HEADER as u64 + bytes + TRAILER
}

fn plain(file: &DemFile, size: FileSize) -> Result<PlainRaster, DemErrorKind> {
    let header = BtHeader::read(file.bytes)?;
    let sides = (u64::from(header.columns), u64::from(header.rows));
    let layout = SampleLayout::dense(sides, header.sample, ByteOrder::Little, 0).by_columns();
    let raster = layout.header(FORMAT.name, size.after(HEADER))?;
    let BtSystem { crs, meters_per_unit } = system(file, &header)?;
    let (min, max) = (header.min * meters_per_unit, header.max * meters_per_unit);
    let cell = (max - min) / (raster.grid_size() - 1.0);
    if !(cell.is_finite() && cell.min_element() > 0.0) {
        return Err(DemErrorKind::Georeference {
            reason: format!("its extents are {} to {}", header.min, header.max),
            remedy: "write it again with extents that grow to the north-east",
        });
    }
    let raster = Raster {
        driver: "BT",
        meters_per_z: header.meters_per_z,
        states_z_unit: header.states_z_unit,
        crs,
        nodata: Some(NODATA),
        ..raster.placed(north_up_nodes(DVec2::new(min.x, max.y), cell))
    };
    let layout = SampleLayout { start: HEADER as u64, ..layout };
    Ok(PlainRaster::new(raster, layout, NoData::Value(Some(NODATA))))
}

struct BtHeader {
    columns: u32,
    rows: u32,
    sample: SampleType,
    /// 0 degrees, 1 meters, 2 feet, 3 US survey feet.
    unit: i16,
    /// The UTM zone, negative in the south; 0 for none.
    zone: i16,
    /// EPSG's number of the datum.
    datum: i16,
    /// Whether the system is stated in a `.prj` beside the file.
    has_projection_file: bool,
    min: DVec2,
    max: DVec2,
    meters_per_z: f64,
    states_z_unit: bool,
}

impl BtHeader {
    fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        if bytes.len() < HEADER {
            return Err(FORMAT.broken(format!("{} bytes are less than its header", bytes.len())));
        }
        let version = match &bytes[7..10] {
            [b'1', b'.', digit @ b'0'..=b'3'] => digit - b'0',
            other => {
                let what = format!("version '{}'", String::from_utf8_lossy(other));
                return Err(FORMAT.unsupported(what, "save it as version 1.3"));
            }
        };
        let fields = ByteFields::little_endian(bytes);
        let long = |at: usize| fields.i32(at).unwrap_or_default();
        let nodes = |at: usize, what: &str| match long(at) {
            count @ 2.. => Ok(count as u32),
            count => Err(FORMAT.broken(format!("it has {count} {what}; at least 2 make a terrain"))),
        };
        let (columns, rows) = (nodes(10, "columns")?, nodes(14, "rows")?);
        let short = |at: usize| fields.i16(at).unwrap_or_default();
        let narrow = |at: usize| fields.f32(at).map_or(f64::NAN, f64::from);
        let (bytes, is_float) =
            if version == 0 { (long(18), long(42)) } else { (short(18).into(), short(20).into()) };
        let [unit, zone, datum] = match (version, short(22)) {
            (0, 1) => [1, short(24), WGS84_DATUM],
            (0, _) => [0, 0, WGS84_DATUM],
            _ => [22, 24, 26].map(short),
        };
        let [left, right, bottom, top] = match version {
            0 => [26, 30, 34, 38].map(narrow),
            _ => [28, 36, 44, 52].map(|at| fields.f64(at).unwrap_or(f64::NAN)),
        };
        Ok(Self {
            columns,
            rows,
            sample: sample_type(bytes, is_float != 0)?,
            unit,
            zone,
            datum,
            has_projection_file: version >= 2 && short(60) != 0,
            min: DVec2::new(left, bottom),
            max: DVec2::new(right, top),
            states_z_unit: version >= 3 && narrow(62) != 0.0,
            meters_per_z: vertical_unit(if version >= 3 { narrow(62) } else { 1.0 })?,
        })
    }
}

fn sample_type(bytes: i32, is_float: bool) -> Result<SampleType, DemErrorKind> {
    match (bytes, is_float) {
        (2, false) => Ok(SampleType::I16),
        (4, false) => Ok(SampleType::I32),
        (4, true) => Ok(SampleType::F32),
        (_, true) => Err(FORMAT.broken(format!("floating-point values of {bytes} bytes do not exist"))),
        (_, false) => Err(FORMAT.broken(format!("integer values of {bytes} bytes do not exist"))),
    }
}

/// 0 means meters, as files before 1.3 left it. Feet are stored in 32 bits and restored to 64.
fn vertical_unit(scale: f64) -> Result<f64, DemErrorKind> {
    if scale == 0.0 || scale == 1.0 {
        return Ok(1.0);
    }
    if !(scale.is_finite() && scale > 0.0) {
        return Err(FORMAT.broken(format!("its vertical unit is {scale} m")));
    }
    let feet = [US_SURVEY_FOOT_M, FOOT_M].into_iter().find(|foot| f64::from(*foot as f32) == scale);
    Ok(feet.unwrap_or(scale))
}

struct BtSystem {
    crs: Option<Crs>,
    /// The factor of extents: 1, or the length of a foot for a local grid in feet.
    meters_per_unit: f64,
}

fn system(file: &DemFile, header: &BtHeader) -> Result<BtSystem, DemErrorKind> {
    let known = if header.has_projection_file { file.crs()? } else { file.hints.options.crs.clone() };
    if known.is_some() {
        return Ok(BtSystem { crs: known, meters_per_unit: 1.0 });
    }
    let unit = match header.unit {
        0 | 1 => 1.0,
        2 => FOOT_M,
        3 => US_SURVEY_FOOT_M,
        other => return Err(FORMAT.broken(format!("its horizontal unit is {other}; 0 to 3 exist"))),
    };
    let crs = match (header.zone, header.unit) {
        (0, 0) => Crs::from_epsg(geographic_code(header.datum)?)?,
        (0, _) => return Ok(BtSystem { crs: None, meters_per_unit: unit }),
        (zone, _) => Crs::utm_on(geographic_code(header.datum)?, zone.into(), unit)?,
    };
    Ok(BtSystem { crs: Some(crs), meters_per_unit: 1.0 })
}

/// The geographic system of a datum by EPSG's number less 2000 or an old USGS number; WGS 84, as in GDAL, if negative.
fn geographic_code(datum: i16) -> Result<u32, DemErrorKind> {
    match datum {
        ..=-1 | 23 => Ok(4326),
        7 => Ok(4267),
        8 => Ok(4269),
        6001..=6999 => Ok(datum as u32 - 2000),
        _ => Err(DemErrorKind::Georeference {
            reason: format!("datum number {datum} is not known"),
            remedy: "put a .prj file beside it and save it as version 1.3, or state crs under [terrain]",
        }),
    }
}

fn write(raster: &Raster, _name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &FORMAT.north_up(raster)?;
    if raster.width.min(raster.height) < 2 {
        let found = format!("{} x {}", raster.width, raster.height);
        return Err(WriteError::Shape { format: FORMAT.name, wanted: "at least 2 x 2 samples", found });
    }
    if raster.samples.iter().any(|value| value == NODATA) {
        return Err(WriteError::NoDataTaken { format: FORMAT.name, value: NODATA });
    }
    let mut notes = Vec::new();
    let sample = match StoredSamples::new(raster).sample {
        kept @ (SampleType::I16 | SampleType::I32) => kept,
        SampleType::U8 => SampleType::I16,
        other => {
            if other.is_wide() {
                notes.push("heights are rounded to float32".to_owned());
            }
            SampleType::F32
        }
    };
    // 32 bits hold the unit: feet are restored by the reader, all others keep seven digits.
    let unit = raster.meters_per_z as f32;
    if f64::from(unit) != raster.meters_per_z && ![FOOT_M, US_SURVEY_FOOT_M].contains(&raster.meters_per_z) {
        notes.push(format!("the unit of heights, {} m, is rounded", raster.meters_per_z));
    }
    let mut bytes = header_bytes(raster, sample);
    for column in 0..raster.width {
        for row in (0..raster.height).rev() {
            let value = raster.at(column, row);
            sample.write(&[if value.is_nan() { NODATA } else { value }], &mut bytes);
        }
    }
    let companions = projection_file_of(raster).into_iter().collect();
    Ok(WrittenDem { companions, notes, ..WrittenDem::new(bytes, &sample.gdal_name().to_ascii_lowercase()) })
}

fn header_bytes(raster: &Raster, sample: SampleType) -> Vec<u8> {
    let nodes = raster.node_extent();
    let (unit, zone, datum) = system_fields(raster.crs.as_ref());
    let values = raster.samples.len() * sample.bytes();
    let mut bytes = Vec::with_capacity(HEADER + values);
    bytes.extend(b"binterr1.3");
    bytes.extend((raster.width as i32).to_le_bytes());
    bytes.extend((raster.height as i32).to_le_bytes());
    for short in [sample.bytes() as i16, i16::from(sample.is_float()), unit, zone, datum] {
        bytes.extend(short.to_le_bytes());
    }
    for edge in [nodes.min.x, nodes.max.x, nodes.min.y, nodes.max.y] {
        bytes.extend(edge.to_le_bytes());
    }
    bytes.extend(i16::from(crs_on_earth(raster).is_some()).to_le_bytes());
    bytes.extend((raster.meters_per_z as f32).to_le_bytes());
    bytes.resize(HEADER, 0);
    bytes
}

/// The horizontal unit, the UTM zone and the datum, as [`BtHeader`] has them.
fn system_fields(crs: Option<&Crs>) -> (i16, i16, i16) {
    let Some(crs) = crs else { return (1, 0, WGS84_DATUM) };
    let (zone, datum) = match crs.epsg().unwrap_or_default() {
        code @ 32601..=32660 => (code as i16 - 32600, WGS84_DATUM),
        code @ 32701..=32760 => (32700 - code as i16, WGS84_DATUM),
        code @ 26901..=26923 => (code as i16 - 26900, 6269),
        code @ 26701..=26722 => (code as i16 - 26700, 6267),
        code @ 25828..=25838 => (code as i16 - 25800, 6258),
        4269 => (0, 6269),
        4267 => (0, 6267),
        4258 => (0, 6258),
        _ => (0, WGS84_DATUM),
    };
    let unit = match crs.meters_per_unit() {
        _ if crs.is_geographic() => 0,
        FOOT_M => 2,
        feet if (feet - US_SURVEY_FOOT_M).abs() < 1e-9 => 3,
        _ => 1,
    };
    (unit, zone, datum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;
    use sandtable_raster::raster::Samples;

    fn terrain(version: &[u8; 10], values: &[i16]) -> Vec<u8> {
        let mut bytes = vec![0u8; HEADER];
        bytes[..10].copy_from_slice(version);
        bytes[10..14].copy_from_slice(&2i32.to_le_bytes());
        bytes[14..18].copy_from_slice(&3i32.to_le_bytes());
        bytes[18..20].copy_from_slice(&2i16.to_le_bytes());
        bytes[22..24].copy_from_slice(&1i16.to_le_bytes());
        bytes[24..26].copy_from_slice(&(-33i16).to_le_bytes());
        for (at, extent) in [(28, 100.0f64), (36, 110.0), (44, 200.0), (52, 220.0)] {
            bytes[at..at + 8].copy_from_slice(&extent.to_le_bytes());
        }
        bytes[26..28].copy_from_slice(&6326i16.to_le_bytes());
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        bytes
    }

    #[test]
    fn columns_from_the_south_west_become_rows_from_the_north_west() {
        let raster = read("a.bt", &terrain(b"binterr1.2", &[1, 2, 3, 4, -32768, 6]), &DemHints::default())
            .expect("fine");
        assert_eq!(
            [raster.at(0, 0), raster.at(1, 0), raster.at(0, 2), raster.at(1, 2)],
            [3.0, 6.0, 1.0, 4.0]
        );
        assert!(raster.at(1, 1).is_nan());
        assert_eq!(raster.geotransform(), [95.0, 10.0, 0.0, 225.0, 0.0, -10.0]);
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32733));
    }

    #[test]
    fn the_oldest_version_keeps_its_extents_in_32_bits() {
        let mut bytes = terrain(b"binterr1.0", &[1, 2, 3, 4, 5, 6]);
        bytes[18..22].copy_from_slice(&2i32.to_le_bytes());
        for (at, extent) in [(26, 100.0f32), (30, 110.0), (34, 200.0), (38, 220.0)] {
            bytes[at..at + 4].copy_from_slice(&extent.to_le_bytes());
        }
        bytes[42..46].copy_from_slice(&0i32.to_le_bytes());
        let raster = read("a.bt", &bytes, &DemHints::default()).expect("fine");
        assert_eq!(raster.geotransform(), [95.0, 10.0, 0.0, 225.0, 0.0, -10.0]);
        assert_eq!(raster.samples, Samples::F32(vec![3.0, 6.0, 2.0, 5.0, 1.0, 4.0]));
    }

    #[test]
    fn feet_stand_for_meters_where_the_header_says_so() {
        let mut bytes = terrain(b"binterr1.3", &[1, 2, 3, 4, 5, 6]);
        bytes[22..24].copy_from_slice(&2i16.to_le_bytes());
        bytes[24..26].copy_from_slice(&0i16.to_le_bytes());
        bytes[62..66].copy_from_slice(&0.3048f32.to_le_bytes());
        let raster = read("a.bt", &bytes, &DemHints::default()).expect("fine");
        assert_eq!(raster.meters_per_z, 0.3048);
        assert!((raster.spacing().x - 3.048).abs() < 1e-12);
        assert!(raster.crs.is_none());
    }

    #[test]
    fn a_terrain_cut_short_is_refused() {
        let whole = terrain(b"binterr1.3", &[1, 2, 3, 4, 5, 6]);
        for end in 0..whole.len() {
            assert!(read("a.bt", &whole[..end], &DemHints::default()).is_err(), "{end}");
        }
        assert!(read("a.bt", &terrain(b"binterr1.7", &[]), &DemHints::default()).is_err());
    }
}
