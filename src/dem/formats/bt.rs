//! Binary Terrain of the Virtual Terrain Project (`.bt`, versions 1.0 to 1.3).
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
//! Where the values stand follows VTP's own reader: **the extents are the coordinates of the outermost grid
//! nodes**, so that neighbors are (right − left) / (columns − 1) apart. GDAL takes the same numbers as outer
//! edges of cells and divides by the number of columns; the two differ by up to half a cell. −32768 stands for
//! no data in all three kinds of value.

use glam::DVec2;

use crate::dem::error::{DemErrorKind, bytes_at, check_size};
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::read::DemFile;
use crate::geom::crs::Crs;

const FORMAT: &str = "BT terrain";

/// Values start here in every version.
const HEADER: usize = 256;

const NODATA: f64 = -32768.0;

/// Whether the content starts as all versions do.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    bytes.starts_with(b"binterr")
}

/// Reads a terrain; its coordinate system comes from a `.prj` companion where the header says so.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let header = BtHeader::read(source.bytes)?;
    let data = &source.bytes[HEADER..];
    let size = (u64::from(header.columns), u64::from(header.rows));
    check_size(size, header.value.bytes() as u64, (data.len(), 1))?;
    let nodes = DVec2::new(f64::from(header.columns - 1), f64::from(header.rows - 1));
    let (crs, meters_per_unit) = system(source, &header)?;
    let (min, max) = (header.min * meters_per_unit, header.max * meters_per_unit);
    let cell = (max - min) / nodes;
    if !(cell.is_finite() && cell.min_element() > 0.0) {
        return Err(DemErrorKind::Georeference {
            reason: format!("its extents are {} to {}", header.min, header.max),
            remedy: "write it again with extents that grow to the north-east",
        });
    }
    Ok(Raster {
        driver: "BT",
        data_type: header.value.name(),
        width: header.columns,
        height: header.rows,
        samples: header.samples(data),
        meters_per_z: header.meters_per_z,
        map_from_grid: north_up(DVec2::new(min.x - cell.x * 0.5, max.y + cell.y * 0.5), cell),
        georeferenced: true,
        crs,
        nodata: Some(NODATA),
        vertical_datum: None,
    })
}

/// The kinds of value.
#[derive(Clone, Copy)]
enum BtKind {
    I16,
    I32,
    F32,
}

impl BtKind {
    fn name(self) -> &'static str {
        match self {
            Self::I16 => "Int16",
            Self::I32 => "Int32",
            Self::F32 => "Float32",
        }
    }

    fn bytes(self) -> usize {
        if matches!(self, Self::I16) { 2 } else { 4 }
    }
}

struct BtHeader {
    columns: u32,
    rows: u32,
    value: BtKind,
    unit: i16,
    zone: i16,
    datum: i16,
    external: bool,
    min: DVec2,
    max: DVec2,
    meters_per_z: f64,
}

impl BtHeader {
    fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        if bytes.len() < HEADER {
            return Err(DemErrorKind::broken(
                FORMAT,
                format!("{} bytes are less than its header", bytes.len()),
            ));
        }
        let version = match &bytes[7..10] {
            [b'1', b'.', digit @ b'0'..=b'3'] => digit - b'0',
            other => {
                return Err(DemErrorKind::Unsupported {
                    format: FORMAT,
                    what: format!("version '{}'", String::from_utf8_lossy(other)),
                    remedy: "save it as version 1.3",
                });
            }
        };
        let fields = Fields(bytes);
        let nodes = |at: usize, what: &str| match fields.long(at) {
            count if count >= 2 => Ok(count as u32),
            count => {
                Err(DemErrorKind::broken(FORMAT, format!("it has {count} {what}; at least 2 make a terrain")))
            }
        };
        let mut header = if version == 0 { Self::oldest(&fields)? } else { Self::later(&fields, version)? };
        header.columns = nodes(10, "columns")?;
        header.rows = nodes(14, "rows")?;
        Ok(header)
    }

    fn oldest(fields: &Fields) -> Result<Self, DemErrorKind> {
        let edge = |at: usize| f64::from(fields.float(at));
        let is_utm = fields.short(22) == 1;
        Ok(Self {
            columns: 0,
            rows: 0,
            value: kind(fields.long(18), fields.long(42) != 0)?,
            unit: i16::from(is_utm),
            zone: if is_utm { fields.short(24) } else { 0 },
            datum: 6326,
            external: false,
            min: DVec2::new(edge(26), edge(34)),
            max: DVec2::new(edge(30), edge(38)),
            meters_per_z: 1.0,
        })
    }

    fn later(fields: &Fields, version: u8) -> Result<Self, DemErrorKind> {
        let scale = if version >= 3 { f64::from(fields.float(62)) } else { 1.0 };
        Ok(Self {
            columns: 0,
            rows: 0,
            value: kind(i32::from(fields.short(18)), fields.short(20) != 0)?,
            unit: fields.short(22),
            zone: fields.short(24),
            datum: fields.short(26),
            external: version >= 2 && fields.short(60) != 0,
            min: DVec2::new(fields.double(28), fields.double(44)),
            max: DVec2::new(fields.double(36), fields.double(52)),
            meters_per_z: vertical_unit(scale)?,
        })
    }

    fn samples(&self, data: &[u8]) -> Samples {
        match self.value {
            BtKind::I16 => {
                Samples::F32(self.turned(data, |b: [u8; 2]| f32::from(i16::from_le_bytes(b)), f32::NAN))
            }
            BtKind::F32 => Samples::F32(self.turned(data, f32::from_le_bytes, f32::NAN)),
            BtKind::I32 => Samples::F64(self.turned(data, |b| f64::from(i32::from_le_bytes(b)), f64::NAN)),
        }
    }

    /// Columns from the south-west, turned into rows from the north-west.
    fn turned<const N: usize, T>(&self, data: &[u8], value: impl Fn([u8; N]) -> T, hole: T) -> Vec<T>
    where
        T: Copy + Into<f64>,
    {
        let (columns, rows) = (self.columns as usize, self.rows as usize);
        let mut turned = Vec::with_capacity(columns * rows);
        for row in (0..rows).rev() {
            for column in 0..columns {
                let at = (column * rows + row) * N;
                let found = bytes_at(data, at).map_or(hole, &value);
                let elevation: f64 = found.into();
                turned.push(if elevation == NODATA || !elevation.is_finite() { hole } else { found });
            }
        }
        turned
    }
}

fn kind(bytes: i32, float: bool) -> Result<BtKind, DemErrorKind> {
    match (bytes, float) {
        (2, false) => Ok(BtKind::I16),
        (4, false) => Ok(BtKind::I32),
        (4, true) => Ok(BtKind::F32),
        _ => {
            let sort = if float { "floating-point" } else { "integer" };
            Err(DemErrorKind::broken(FORMAT, format!("{sort} values of {bytes} bytes do not exist")))
        }
    }
}

/// 0 means meters, as files before 1.3 left it. The two feet are kept in f32 and named again in full.
fn vertical_unit(scale: f64) -> Result<f64, DemErrorKind> {
    const US_FOOT: f64 = 1200.0 / 3937.0;
    if scale == 0.0 || scale == 1.0 {
        return Ok(1.0);
    }
    if !(scale.is_finite() && scale > 0.0) {
        return Err(DemErrorKind::broken(FORMAT, format!("its vertical unit is {scale} m")));
    }
    let named = [US_FOOT, 0.3048].into_iter().find(|foot| f64::from(*foot as f32) == scale);
    Ok(named.unwrap_or(scale))
}

/// The coordinate system, and the factor that its extents still need: 1, or the length of a foot where a
/// local grid in feet is brought to meters.
fn system(source: &DemFile, header: &BtHeader) -> Result<(Option<Crs>, f64), DemErrorKind> {
    if let Some(crs) = source.hints.crs.clone() {
        return Ok((Some(crs), 1.0));
    }
    if header.external
        && let Some(crs) = source.crs_beside()?
    {
        return Ok((Some(crs), 1.0));
    }
    let unit = match header.unit {
        0 | 1 => 1.0,
        2 => 0.3048,
        3 => 1200.0 / 3937.0,
        other => {
            return Err(DemErrorKind::broken(
                FORMAT,
                format!("its horizontal unit is {other}; 0 to 3 exist"),
            ));
        }
    };
    let code = match (header.zone, header.unit) {
        (0, 0) => geographic_code(header.datum)?,
        (0, _) => return Ok((None, unit)),
        (zone, _) => utm_code(zone, geographic_code(header.datum)?)?,
    };
    Ok((Some(Crs::from_epsg_in(code, unit).map_err(DemErrorKind::Crs)?), 1.0))
}

/// The geographic system of a datum: EPSG's number less 2000, one of the old USGS numbers, or WGS 84 where it
/// is unknown (negative), as GDAL takes it.
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

fn utm_code(zone: i16, base: u32) -> Result<u32, DemErrorKind> {
    let number = u32::from(zone.unsigned_abs());
    let code = match (base, zone > 0) {
        (4326, true) => 32600 + number,
        (4326, false) => 32700 + number,
        (4269, true) => 26900 + number,
        (4267, true) => 26700 + number,
        (4258, true) => 25800 + number,
        _ => 0,
    };
    if (1..=60).contains(&number) && code > 0 {
        return Ok(code);
    }
    Err(DemErrorKind::Georeference {
        reason: format!("UTM zone {zone} on datum EPSG:{base} is not known"),
        remedy: "state crs under [terrain]",
    })
}

/// Little-endian fields of a header whose length was checked.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&self, at: usize) -> [u8; N] {
        bytes_at(self.0, at).unwrap_or([0; N])
    }

    fn short(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.take(at))
    }

    fn long(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.take(at))
    }

    fn float(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.take(at))
    }

    fn double(&self, at: usize) -> f64 {
        f64::from_le_bytes(self.take(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

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
