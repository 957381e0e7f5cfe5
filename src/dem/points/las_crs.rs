//! The coordinate system of a LAS file: GeoTIFF keys (before 1.4, and formats 0 to 5) or WKT, in its records.
//!
//! Heights are in the vertical unit that is stated, else in the unit of x and y, as ASPRS LAS 1.4 R15 has it of a
//! system that states one unit only; that heights were taken for feet is told, because so much hangs on it.

use crate::dem::points::PointsError;
use crate::dem::points::las_header::{LasHeader, Record};
use crate::dem::tiff::geokeys::GeoKeys;
use crate::geom::crs::Crs;

/// Who defined the records of coordinate systems.
const OWNER: &[u8] = b"LASF_Projection";
const KEYS: u16 = 34735;
const DOUBLES: u16 = 34736;
/// Records with text that keys point into.
const TEXTS: u16 = 34737;
const WKT: u16 = 2112;

/// What a file says of its coordinates.
pub(super) struct LasCrs {
    /// Of x and y.
    pub crs: Option<Crs>,
    /// Of z.
    pub meters_per_z: f64,
    /// What heights are counted from.
    pub vertical_datum: Option<String>,
    /// What was taken for granted.
    pub notes: Vec<String>,
}

/// The system that the records state; for x and y `stated` instead, where the caller knows better.
pub(super) fn read(
    records: &[Record],
    header: &LasHeader,
    stated: Option<&Crs>,
) -> Result<LasCrs, PointsError> {
    let content = |id: u16| {
        let found = records.iter().find(|record| record.owner == OWNER && record.id == id);
        found.map(|record| record.content).filter(|content| !content.is_empty())
    };
    let wkt = content(WKT).map(text).filter(|text| !text.is_empty());
    let keys = content(KEYS).map(|directory| {
        keys(directory, content(DOUBLES).unwrap_or_default(), content(TEXTS).unwrap_or_default())
    });
    let by_wkt = wkt.as_deref().filter(|_| header.says_wkt || keys.is_none());
    let (crs, unit) = match (by_wkt, &keys, stated) {
        (Some(text), _, None) => (Some(crs_of(text)?), vertical_unit(text)),
        (Some(text), _, Some(crs)) => (Some(crs.clone()), vertical_unit(text)),
        (None, Some(keys), None) => (keys.crs()?, keys.meters_per_z()?),
        (None, Some(keys), Some(crs)) => (Some(crs.clone()), keys.meters_per_z().ok().flatten()),
        (None, None, stated) => (stated.cloned(), None),
    };
    let mut notes = Vec::new();
    let of_plane = crs.as_ref().filter(|crs| !crs.is_geographic()).map_or(1.0, Crs::meters_per_unit);
    if unit.is_none() && of_plane != 1.0 {
        notes.push(format!("heights were taken to be in the unit of x and y, {of_plane} m"));
    }
    let vertical_datum = by_wkt.and_then(|text| quoted(vertical(text)?));
    Ok(LasCrs { crs, meters_per_z: unit.unwrap_or(of_plane), vertical_datum, notes })
}

/// A text up to its first zero.
fn text(content: &[u8]) -> String {
    let end = content.iter().position(|&byte| byte == 0).unwrap_or(content.len());
    String::from_utf8_lossy(&content[..end]).trim().to_owned()
}

fn crs_of(wkt: &str) -> Result<Crs, PointsError> {
    Crs::parse(wkt).map_err(|error| PointsError::Crs { reason: error.to_string() })
}

fn keys(directory: &[u8], doubles: &[u8], text: &[u8]) -> GeoKeys {
    let directory: Vec<u16> =
        directory.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
    let double = |eight: &[u8]| eight.try_into().map(f64::from_le_bytes).unwrap_or(f64::NAN);
    let doubles: Vec<f64> = doubles.chunks_exact(8).map(double).collect();
    GeoKeys::new(&directory, &doubles, &String::from_utf8_lossy(text))
}

/// The vertical part of a compound system, from its keyword on.
fn vertical(wkt: &str) -> Option<&str> {
    let at = ["VERT_CS[", "VERTCS[", "VERTCRS["].iter().filter_map(|keyword| wkt.find(keyword)).min()?;
    wkt.get(at..)
}

/// Meters in the unit of the vertical part.
fn vertical_unit(wkt: &str) -> Option<f64> {
    let part = vertical(wkt)?;
    let unit = &part[part.find("UNIT[")?..];
    let factor = unit.split(',').nth(1)?.trim_end_matches([']', ' ']).trim();
    let factor: f64 = factor.split(']').next()?.trim().parse().ok()?;
    (factor.is_finite() && factor > 0.0).then_some(factor)
}

fn quoted(part: &str) -> Option<String> {
    part.split('"').nth(1).map(str::to_owned).filter(|name| !name.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertical_part_gives_its_unit_and_name() {
        let wkt = "COMPD_CS[\"x\",PROJCS[\"y\",UNIT[\"metre\",1]],VERT_CS[\"NAVD88 height (ftUS)\",VERT_DATUM[\"n\",2005],UNIT[\"US survey foot\",0.304800609601219,AUTHORITY[\"EPSG\",\"9003\"]],AXIS[\"Up\",UP]]]";
        assert_eq!(vertical_unit(wkt), Some(0.304_800_609_601_219));
        assert_eq!(vertical(wkt).and_then(quoted).as_deref(), Some("NAVD88 height (ftUS)"));
        assert_eq!(vertical_unit("PROJCS[\"y\",UNIT[\"metre\",1]]"), None);
    }
}
