//! SRTM tiles (`.hgt`): big-endian 16-bit meters of a one-degree square, north row first.
//!
//! The file holds samples only: its name is the south-west corner, and the spacing follows from its size. Values lie
//! on nodes that include both borders, so the raster reaches half a sample beyond the square.

use glam::DVec2;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition};
use crate::formats::degree_square::{degree_corner, nodes_in_words};
use crate::formats::plain_raster::{self, PlainRaster};
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use crate::written::{WriteError, WrittenDem};
use sandtable_base::bytes::ByteOrder;
use sandtable_geom::crs::Crs;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, north_up_nodes};
use sandtable_raster::sample_type::SampleType;

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "SRTM tile",
    extensions: &["hgt"],
    shared_extensions: &[],
    recognition: Recognition::Extension,
    reader: |file| plain_raster::read(file, plain),
    windows: Some(|file, content, _| plain_raster::windows(file, content, plain)),
    most_bytes,
    writer: Some(FormatWriter { extensions: &["hgt"], write }),
    windows_writer: None,
};

const VOID: i16 = -32768;

/// Columns and rows of tiles: 3″, 1″, 1″ north of 50° with every other column, and 0.5″.
const SIZES: [(u32, u32); 4] = [(1201, 1201), (3601, 3601), (1801, 3601), (7201, 7201)];

/// The largest tile.
fn most_bytes(_: &[u8]) -> u64 {
    let bytes = SIZES.map(|(width, height)| 2 * u64::from(width) * u64::from(height));
    bytes.into_iter().fold(0, u64::max)
}

fn plain(file: &DemFile, size: FileSize) -> Result<PlainRaster, DemErrorKind> {
    let corner = corner(file.stem()).ok_or_else(|| DemErrorKind::Georeference {
        reason: format!(
            "a tile's name states its corner, as N43E007.hgt does, and '{}' does not",
            file.stem()
        ),
        remedy: "give the file its name back",
    })?;
    let bytes = size.bytes as u64;
    let sides = SIZES.map(|(width, height)| (u64::from(width), u64::from(height)));
    let sides = sides.into_iter().find(|(width, height)| width * height * 2 == bytes).ok_or_else(|| {
        FORMAT.broken(format!("{bytes} bytes are not those of 1201 or 3601 samples squared"))
    })?;
    let layout = SampleLayout::dense(sides, SampleType::I16, ByteOrder::Big, 0);
    let raster = layout.header(FORMAT.name, size)?;
    let cell = (raster.grid_size() - 1.0).recip();
    let raster = Raster {
        driver: "SRTMHGT",
        states_z_unit: true,
        crs: Some(file.hints.options.crs.clone().unwrap_or_else(Crs::wgs84)),
        nodata: Some(VOID.into()),
        vertical_datum: Some("EGM96 geoid".into()),
        ..raster.placed(north_up_nodes(corner + DVec2::Y, cell))
    };
    Ok(PlainRaster::new(raster, layout, NoData::Value(Some(VOID.into()))))
}

/// The south-west corner in degrees that a name such as `N43E007` states.
fn corner(stem: &str) -> Option<DVec2> {
    let stem = stem.to_ascii_uppercase();
    let part = |from: usize, to: usize| -> Option<f64> {
        let digits = stem.get(from..to)?;
        digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())?
    };
    let sign = |at: usize, plus: u8, minus: u8| match stem.as_bytes().get(at)? {
        letter if *letter == plus => Some(1.0),
        letter if *letter == minus => Some(-1.0),
        _ => None,
    };
    let latitude = sign(0, b'N', b'S')? * part(1, 3)?;
    let longitude = sign(3, b'E', b'W')? * part(4, 7)?;
    ((-90.0..90.0).contains(&latitude) && (-180.0..180.0).contains(&longitude))
        .then_some(DVec2::new(longitude, latitude))
}

fn tile_name(corner: DVec2) -> String {
    let letter = |value: f64, plus: char, minus: char| if value < 0.0 { minus } else { plus };
    let (north, east) = (letter(corner.y, 'N', 'S'), letter(corner.x, 'E', 'W'));
    format!("{north}{:02}{east}{:03}", corner.y.abs(), corner.x.abs())
}

fn write(raster: &Raster, name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let raster = &FORMAT.north_up(raster)?;
    let size = (raster.width, raster.height);
    let is_wgs84 = raster.crs.as_ref().is_none_or(|crs| crs.epsg() == Some(4326));
    let corner = degree_corner(raster).filter(|_| is_wgs84 && SIZES.contains(&size));
    let Some(corner) = corner else {
        return Err(WriteError::Shape {
            format: FORMAT.name,
            wanted: "one degree of EPSG:4326 with nodes on whole degrees and 1201 x 1201, 3601 x 3601, 1801 x 3601 or 7201 x 7201 samples",
            found: nodes_in_words(raster),
        });
    };
    let wanted = tile_name(corner);
    if !name.to_ascii_uppercase().starts_with(&wanted) {
        return Err(WriteError::Name(wanted));
    }
    let (least, greatest) = (f64::from(VOID) + 1.0, f64::from(i16::MAX));
    if let Some(found) = raster.samples.valid().find(|value| !(least..=greatest).contains(&value.round())) {
        return Err(WriteError::OutOfRange { format: FORMAT.name, least, greatest, found });
    }
    let stored = raster.samples.iter().map(|value| if value.is_nan() { VOID } else { value.round() as i16 });
    let bytes = stored.flat_map(i16::to_be_bytes).collect();
    let is_rounded = raster.samples.valid().any(|value| value.fract() != 0.0);
    let notes = if is_rounded { vec!["heights are rounded to whole meters".to_owned()] } else { vec![] };
    Ok(WrittenDem { notes, ..WrittenDem::new(bytes, "int16") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

    #[test]
    fn the_name_is_the_corner() {
        assert_eq!(corner("N43E007"), Some(DVec2::new(7.0, 43.0)));
        assert_eq!(corner("s34w071.SRTMGL1"), Some(DVec2::new(-71.0, -34.0)));
        assert_eq!(corner("notacoord"), None);
        assert_eq!(corner("N99E007"), None);
        assert_eq!(corner("N4é"), None);
    }

    #[test]
    fn nodes_fall_on_the_borders_of_the_degree() {
        let mut bytes = vec![0u8; 1201 * 1201 * 2];
        bytes[..2].copy_from_slice(&[0x80, 0]);
        bytes[2..4].copy_from_slice(&[1, 2]);
        let raster = read("N43E007.hgt", &bytes, &DemHints::default()).expect("a tile");
        assert!(raster.at(0, 0).is_nan());
        assert_eq!(raster.at(1, 0), 258.0);
        let first = raster.map_from_grid.transform_point2(DVec2::splat(0.5));
        assert!(first.distance(DVec2::new(7.0, 44.0)) < 1e-12, "{first}");
        assert!(read("N43E007.hgt", &bytes[..9000], &DemHints::default()).is_err());
    }
}
