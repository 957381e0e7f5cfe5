//! The coordinate system of a LAS file: GeoTIFF keys (before 1.4, and formats 0 to 5) or WKT, in its records.
//!
//! Heights are in the vertical unit that is stated, else in the unit of x and y, as ASPRS LAS 1.4 R15 has it of a
//! system that states one unit only. That heights were taken for feet is noted: so much depends on it.

use crate::points::error::PointsError;
use crate::points::las_header::{LasHeader, Record};
use crate::tiff::geokeys::GeoKeys;
use sandtable_geom::crs::Crs;
use sandtable_raster::vertical;

/// The owner of the records of coordinate systems, and their numbers.
const OWNER: &[u8] = b"LASF_Projection";
const KEYS: u16 = 34735;
const DOUBLES: u16 = 34736;
const TEXTS: u16 = 34737;
const WKT: u16 = 2112;

pub(super) struct LasCrs {
    /// The system of x and y.
    pub crs: Option<Crs>,
    /// Meters in one unit of z.
    pub meters_per_z: f64,
    /// The vertical datum.
    pub vertical_datum: Option<String>,
    /// Notes on assumptions.
    pub notes: Vec<String>,
}

impl LasCrs {
    /// The system that the records state; for x and y `stated` instead, where the caller states one.
    pub fn new(records: &[Record], header: &LasHeader, stated: Option<&Crs>) -> Result<Self, PointsError> {
        let content = |id: u16| {
            let record = records.iter().find(|record| record.owner == OWNER && record.id == id);
            record.map(|record| record.content).filter(|content| !content.is_empty())
        };
        let keys = content(KEYS).map(|directory| {
            keys(directory, content(DOUBLES).unwrap_or_default(), content(TEXTS).unwrap_or_default())
        });
        let wkt = content(WKT).map(text).filter(|text| !text.is_empty());
        let wkt = wkt.filter(|_| header.says_wkt || keys.is_none());
        let (own, unit) = match (&wkt, &keys, stated) {
            (Some(wkt), ..) => (None, vertical::unit_of_wkt(wkt)),
            (None, Some(keys), None) => {
                (keys.crs().map_err(PointsError::Crs)?, keys.meters_per_z().map_err(PointsError::Crs)?)
            }
            (None, Some(keys), Some(_)) => (None, keys.meters_per_z().ok().flatten()),
            (None, None, _) => (None, None),
        };
        let crs = match (stated, &wkt) {
            (Some(stated), _) => Some(stated.clone()),
            (None, Some(wkt)) => Some(Crs::parse(wkt).map_err(|error| PointsError::Crs(error.into()))?),
            (None, None) => own,
        };
        let mut notes = Vec::new();
        let of_plane = crs.as_ref().filter(|crs| !crs.is_geographic()).map_or(1.0, Crs::meters_per_unit);
        if unit.is_none() && of_plane != 1.0 {
            notes.push(format!("heights were taken to be in the unit of x and y, {of_plane} m"));
        }
        let vertical_datum = wkt.as_deref().and_then(vertical::name_of_wkt);
        Ok(Self { crs, meters_per_z: unit.unwrap_or(of_plane), vertical_datum, notes })
    }
}

/// A text up to its first zero.
fn text(content: &[u8]) -> String {
    let end = content.iter().position(|&byte| byte == 0).unwrap_or(content.len());
    String::from_utf8_lossy(&content[..end]).trim().to_owned()
}

fn keys(directory: &[u8], doubles: &[u8], text: &[u8]) -> GeoKeys {
    let directory: Vec<u16> = directory.as_chunks().0.iter().map(|raw| u16::from_le_bytes(*raw)).collect();
    let doubles: Vec<f64> = doubles.as_chunks().0.iter().map(|raw| f64::from_le_bytes(*raw)).collect();
    GeoKeys::new(&directory, &doubles, &String::from_utf8_lossy(text))
}
