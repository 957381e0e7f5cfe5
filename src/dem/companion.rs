//! Files beside an elevation file, of the same name with another extension: world files and projection files.

use glam::{DAffine2, DVec2};

use sandtable_geom::wkt_writer;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::georef::{affine, checked, crs_on_earth};
use sandtable_raster::raster::Raster;

/// A file beside another, of the same name with another extension.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Companion {
    /// The extension without its dot.
    pub extension: &'static str,
    /// The content.
    pub bytes: Vec<u8>,
}

/// Reads a world file: x and y per column, x and y per row, and the center of the first sample.
pub(crate) fn world_file(text: &str) -> Result<DAffine2, DemErrorKind> {
    let numbers: Vec<f64> =
        text.split_ascii_whitespace().map_while(|word| word.replace(',', ".").parse().ok()).collect();
    let [a, d, b, e, c, f] = numbers[..] else {
        return Err(DemErrorKind::Georeference {
            reason: format!("the world file beside it holds {} numbers, not six", numbers.len()),
            remedy: "write it again, or remove it",
        });
    };
    checked(affine([c, a, b, f, d, e]) * DAffine2::from_translation(DVec2::splat(-0.5)))
}

/// The world file of a raster; `None` where it has no georeference.
pub(crate) fn world_file_of(raster: &Raster, extension: &'static str) -> Option<Companion> {
    let axes = raster.map_from_grid.matrix2;
    let first = raster.map_from_grid.transform_point2(DVec2::splat(0.5));
    let numbers = [axes.x_axis.x, axes.x_axis.y, axes.y_axis.x, axes.y_axis.y, first.x, first.y];
    let text: String = numbers.iter().map(|number| format!("{number}\n")).collect();
    raster.georeferenced.then(|| Companion { extension, bytes: text.into_bytes() })
}

/// The `.prj` of a raster: WKT, or the proj string where its projection has no WKT; `None` without a system.
pub(crate) fn projection_file_of(raster: &Raster) -> Option<Companion> {
    let crs = crs_on_earth(raster)?;
    let text = wkt_writer::write(crs).unwrap_or_else(|| crs.name().to_owned());
    Some(Companion { extension: "prj", bytes: format!("{text}\n").into_bytes() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_file_states_the_center_of_the_first_sample() {
        let place = world_file("2,0\n0\n0\n-2\n101\n199\n").expect("six numbers");
        assert_eq!(place.transform_point2(DVec2::ZERO), DVec2::new(100.0, 200.0));
        assert!(world_file("1 2 3").is_err());
        assert!(world_file("0 0 0 0 0 0").is_err());
    }
}
