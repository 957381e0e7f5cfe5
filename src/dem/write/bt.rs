//! Binary Terrain of the Virtual Terrain Project, version 1.3; [`crate::dem::formats::bt`] draws its layout.
//!
//! The extents are the coordinates of the outermost nodes, as VTP has them and our reader takes them. The system stands
//! in the header where that can name it (UTM and degrees on a few datums), and always in a `.prj` beside it too.

use crate::dem::raster::Raster;
use crate::dem::write::values::{ValueType, stored};
use crate::dem::write::{WriteError, WrittenDem, check_place, projection_file};
use crate::geom::crs::Crs;

const FORMAT: &str = "BT terrain";

const HEADER: usize = 256;

/// What stands for no data in all three kinds of value.
const HOLE: f64 = -32768.0;

/// Writes a raster.
///
/// # Errors
/// It has no place, rows that do not run east and south, less than two rows or columns, or a height that stands for
/// no data here.
pub(crate) fn write(raster: &Raster) -> Result<WrittenDem, WriteError> {
    check_place(raster, FORMAT)?;
    if raster.width.min(raster.height) < 2 {
        let reason =
            format!("a {FORMAT} has at least 2 x 2 samples, not {} x {}", raster.width, raster.height);
        return Err(WriteError::Shape { reason });
    }
    if raster.samples.iter().any(|value| value == HOLE) {
        return Err(WriteError::HoleTaken { format: FORMAT, value: HOLE });
    }
    let (value_type, mut notes) = match stored(raster).value_type {
        kept @ (ValueType::I16 | ValueType::I32 | ValueType::F32) => (kept, vec![]),
        ValueType::U16 => (ValueType::F32, vec![]),
        ValueType::U32 | ValueType::F64 => {
            (ValueType::F32, vec!["heights are rounded to float32".to_owned()])
        }
    };
    // f32 holds the unit: feet are told from it, all others are kept to seven digits.
    let unit = raster.meters_per_z as f32;
    if f64::from(unit) != raster.meters_per_z && ![0.3048, 1200.0 / 3937.0].contains(&raster.meters_per_z) {
        notes.push(format!("the unit of heights, {} m, is rounded", raster.meters_per_z));
    }
    let mut bytes = header(raster, value_type, unit);
    bytes.extend(values(raster, value_type));
    let stored = value_type.name().to_owned();
    Ok(WrittenDem {
        bytes,
        companions: projection_file(raster.crs.as_ref()).into_iter().collect(),
        stored,
        notes,
    })
}

fn header(raster: &Raster, value_type: ValueType, meters_per_z: f32) -> Vec<u8> {
    let half = raster.spacing() * 0.5;
    let (min, max) = (raster.extent().min + half, raster.extent().max - half);
    let system = BtCrs::of(raster.crs.as_ref());
    let mut bytes = b"binterr1.3".to_vec();
    bytes.extend((raster.width as i32).to_le_bytes());
    bytes.extend((raster.height as i32).to_le_bytes());
    for short in
        [value_type.bytes() as i16, i16::from(value_type.is_float()), system.unit, system.zone, system.datum]
    {
        bytes.extend(short.to_le_bytes());
    }
    for edge in [min.x, max.x, min.y, max.y] {
        bytes.extend(edge.to_le_bytes());
    }
    bytes.extend(i16::from(raster.crs.as_ref().is_some_and(|crs| !crs.proj_text().is_empty())).to_le_bytes());
    bytes.extend(meters_per_z.to_le_bytes());
    bytes.resize(HEADER, 0);
    bytes
}

/// Columns from the south-west, each northward.
fn values(raster: &Raster, value_type: ValueType) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(raster.samples.len() * value_type.bytes());
    for column in 0..raster.width {
        for row in (0..raster.height).rev() {
            let value = raster.at(column, row);
            let value = if value.is_nan() { HOLE } else { value };
            match value_type {
                ValueType::I16 => bytes.extend((value as i16).to_le_bytes()),
                ValueType::I32 => bytes.extend((value as i32).to_le_bytes()),
                _ => bytes.extend((value as f32).to_le_bytes()),
            }
        }
    }
    bytes
}

/// What the header says of the system.
struct BtCrs {
    /// 0 degrees, 1 meters, 2 feet, 3 US survey feet.
    unit: i16,
    /// UTM zone, negative in the south; 0 for none.
    zone: i16,
    /// EPSG's number of the datum.
    datum: i16,
}

impl BtCrs {
    fn of(crs: Option<&Crs>) -> Self {
        const WGS84: i16 = 6326;
        let Some(crs) = crs else { return Self { unit: 1, zone: 0, datum: WGS84 } };
        let zone = |base: u32, code: u32| (code - base) as i16;
        let (zone, datum) = match crs.epsg() {
            Some(code @ 32601..=32660) => (zone(32600, code), WGS84),
            Some(code @ 32701..=32760) => (-zone(32700, code), WGS84),
            Some(code @ 26901..=26923) => (zone(26900, code), 6269),
            Some(code @ 26701..=26722) => (zone(26700, code), 6267),
            Some(code @ 25828..=25838) => (zone(25800, code), 6258),
            Some(4269) => (0, 6269),
            Some(4267) => (0, 6267),
            Some(4258) => (0, 6258),
            _ => (0, WGS84),
        };
        let unit = match crs.meters_per_unit() {
            _ if crs.is_geographic() => 0,
            0.3048 => 2,
            feet if (feet - 1200.0 / 3937.0).abs() < 1e-9 => 3,
            _ => 1,
        };
        Self { unit, zone, datum }
    }
}
