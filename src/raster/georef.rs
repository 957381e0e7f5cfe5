//! Georeferences of rasters: transforms of grid positions to map coordinates, and their systems.

use glam::{DAffine2, DMat2, DVec2};

use crate::error::DemErrorKind;
use crate::raster::Raster;
use sandtable_geom::crs::Crs;

/// The raster's system, where that has a place on Earth.
pub fn crs_on_earth(raster: &Raster) -> Option<&Crs> {
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
