//! SRTM tiles (`.hgt`): big-endian 16-bit meters of a one-degree square, north row first.
//!
//! Nothing but the samples is in the file: the south-west corner is its name, the spacing follows from its
//! size. Values stand on nodes that include both borders, so the raster reaches half a sample beyond the
//! square.

use glam::DVec2;

use crate::dem::error::{DemErrorKind, MOST_SAMPLES};
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::read::DemFile;
use crate::geom::crs::Crs;

const FORMAT: &str = "SRTM tile";

/// What SRTM writes where the radar saw nothing.
pub(crate) const VOID: i16 = -32768;

/// The sizes tiles come in: 3″, 1″, 1″ north of 50° with every other column, and 0.5″.
pub(crate) const SIZES: [(u32, u32); 4] = [(1201, 1201), (3601, 3601), (1801, 3601), (7201, 7201)];

/// Reads a tile.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let corner = corner(source.stem()).ok_or_else(|| DemErrorKind::Georeference {
        reason: format!(
            "a tile's name states its corner, as N43E007.hgt does, and '{}' does not",
            source.stem()
        ),
        remedy: "give the file its name back",
    })?;
    let samples = (source.bytes.len() / 2) as u64;
    let size = SIZES.into_iter().find(|&(width, height)| {
        u64::from(width) * u64::from(height) == samples && source.bytes.len().is_multiple_of(2)
    });
    let (width, height) = size.filter(|_| samples <= MOST_SAMPLES).ok_or_else(|| {
        DemErrorKind::broken(
            FORMAT,
            format!("{} bytes are not those of 1201 or 3601 samples squared", source.bytes.len()),
        )
    })?;
    let cell = DVec2::new(1.0 / f64::from(width - 1), 1.0 / f64::from(height - 1));
    let north_west = DVec2::new(corner.x, corner.y + 1.0);
    Ok(Raster {
        driver: "SRTMHGT",
        data_type: "Int16",
        width,
        height,
        samples: Samples::F32(source.bytes.chunks_exact(2).map(|pair| value([pair[0], pair[1]])).collect()),
        meters_per_z: 1.0,
        map_from_grid: north_up(north_west + DVec2::new(-0.5, 0.5) * cell, cell),
        georeferenced: true,
        crs: Some(source.hints.crs.clone().unwrap_or_else(Crs::wgs84)),
        nodata: Some(f64::from(VOID)),
        vertical_datum: Some("EGM96 geoid".into()),
    })
}

fn value(bytes: [u8; 2]) -> f32 {
    match i16::from_be_bytes(bytes) {
        VOID => f32::NAN,
        meters => f32::from(meters),
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

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
