//! Georeferences of rasters: world files, stated cells, projection files.

use glam::{DAffine2, DMat2, DVec2};

use crate::error::DemErrorKind;
use crate::raster::{Raster, north_up};
use crate::read::DemFile;
use crate::write::Companion;
use sandtable_geom::crs::Crs;
use sandtable_geom::wkt_writer;

/// `raster` at the place that its file states; else at that of a world file with one of `extensions` beside it, or with
/// the hinted cell and its south-west sample at (0, 0), or else with samples 1 apart and without a georeference.
pub(crate) fn placed(
    file: &DemFile,
    raster: Raster,
    stated: Option<DAffine2>,
    extensions: &[&str],
) -> Result<Raster, DemErrorKind> {
    if let Some(map_from_grid) = stated {
        return Ok(raster.placed(checked(map_from_grid)?));
    }
    if let Some(text) = extensions.iter().find_map(|extension| file.companion(extension)) {
        return Ok(raster.placed(world_file(&String::from_utf8_lossy(&text))?));
    }
    let cell = file.cell()?;
    let size = DVec2::splat(cell.unwrap_or(1.0));
    let corner = DVec2::new(-0.5, f64::from(raster.height) - 0.5) * size;
    Ok(Raster { georeferenced: cell.is_some(), ..raster.placed(north_up(corner, size)) })
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

/// The raster's system, where that has a place on Earth.
pub(crate) fn crs_on_earth(raster: &Raster) -> Option<&Crs> {
    raster.crs.as_ref().filter(|crs| !crs.proj_text().is_empty())
}

/// GDAL's six numbers as a transform.
pub fn affine([x, x_column, x_row, y, y_column, y_row]: [f64; 6]) -> DAffine2 {
    let axes = DMat2::from_cols(DVec2::new(x_column, y_column), DVec2::new(x_row, y_row));
    DAffine2 { matrix2: axes, translation: DVec2::new(x, y) }
}

/// The transform, if it is finite and can be inverted.
pub fn checked(map_from_grid: DAffine2) -> Result<DAffine2, DemErrorKind> {
    let determinant = map_from_grid.matrix2.determinant();
    if map_from_grid.is_finite() && determinant.is_normal() && map_from_grid.matrix2.inverse().is_finite() {
        return Ok(map_from_grid);
    }
    Err(DemErrorKind::Georeference {
        reason: "its cells have no area or its corner is not finite".into(),
        remedy: "write the georeference again, for example with: gdal_edit.py -a_ullr",
    })
}

/// EPSG's code of a UTM zone, negative in the south, on a geographic system; `None` where there is none.
pub(crate) fn utm_code(geographic: u32, zone: i64) -> Option<u32> {
    let (north, south) =
        UTM_BASES.iter().find(|(known, ..)| *known == geographic).map(|(_, n, s)| (*n, *s))?;
    let base = if zone > 0 { Some(north) } else { south }?;
    (1..=60).contains(&zone.abs()).then_some(base + zone.unsigned_abs() as u32)
}

/// Geographic systems with the EPSG codes before their first UTM zones north and south.
const UTM_BASES: [(u32, u32, Option<u32>); 5] = [
    (4326, 32600, Some(32700)),
    (4322, 32200, Some(32300)),
    (4269, 26900, None),
    (4267, 26700, None),
    (4258, 25800, None),
];

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
