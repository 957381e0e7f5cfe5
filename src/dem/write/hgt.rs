//! SRTM tile: big-endian whole meters of a one-degree square, nodes on its borders; the name is its place.

use glam::DVec2;

use crate::dem::formats::hgt::{SIZES, VOID};
use crate::dem::raster::Raster;
use crate::dem::write::{WriteError, WrittenDem, check_place};

const FORMAT: &str = "SRTM tile";

/// How far, in samples, nodes may lie from those of the degree.
const OFF_SAMPLES: f64 = 1e-3;

/// Writes a raster in meters that fills a degree; `stem` is the name that the file will have, without its extension.
///
/// # Errors
/// It is no degree on WGS 84 in one of the sizes that tiles have, heights are out of range, or the name is that of
/// another tile.
pub(crate) fn write(raster: &Raster, stem: &str) -> Result<WrittenDem, WriteError> {
    check_place(raster, FORMAT)?;
    let size = (raster.width, raster.height);
    let is_wgs84 = raster.crs.as_ref().is_none_or(|crs| crs.epsg() == Some(4326));
    let half = raster.spacing() * 0.5;
    let (min, max) = (raster.extent().min + half, raster.extent().max - half);
    let (corner, off) = (min.round(), raster.spacing() * OFF_SAMPLES);
    let is_degree =
        (min - corner).abs().cmple(off).all() && (max - corner - DVec2::ONE).abs().cmple(off).all();
    if !is_wgs84 || !is_degree || !SIZES.contains(&size) {
        return Err(WriteError::Shape {
            reason: format!(
                "an {FORMAT} is one degree of EPSG:4326 with nodes on whole degrees and 1201 x 1201, 3601 x 3601, 1801 x 3601 or 7201 x 7201 samples, not {} x {} from ({}, {}) to ({}, {})",
                size.0, size.1, min.x, min.y, max.x, max.y
            ),
        });
    }
    let wanted = name(corner);
    if !stem.to_ascii_uppercase().starts_with(&wanted) {
        return Err(WriteError::Name { wanted });
    }
    let mut bytes = Vec::with_capacity(raster.samples.len() * 2);
    let mut rounded: f64 = 0.0;
    for value in raster.samples.iter() {
        let meters = value.round();
        rounded = rounded.max((value - meters).abs());
        let (least, most) = (-32767.0, 32767.0);
        if meters < least || meters > most {
            return Err(WriteError::OutOfRange { format: FORMAT, least, most, found: value });
        }
        bytes.extend(if value.is_nan() { VOID } else { meters as i16 }.to_be_bytes());
    }
    let notes = if rounded > 0.0 { vec!["heights are rounded to whole meters".to_owned()] } else { vec![] };
    Ok(WrittenDem { bytes, companions: Vec::new(), stored: "int16".into(), notes })
}

/// The name of the tile whose south-west corner this is.
fn name(corner: DVec2) -> String {
    let letter = |value: f64, plus: char, minus: char| if value < 0.0 { minus } else { plus };
    let (north, east) = (letter(corner.y, 'N', 'S'), letter(corner.x, 'E', 'W'));
    format!("{north}{:02}{east}{:03}", corner.y.abs(), corner.x.abs())
}
