//! Tiles of a GeoPackage's coverage: their values, decoded by the readers of PNG and GeoTIFF, become heights of a raster.

use rusqlite::Connection;
use rusqlite::types::ValueRef;

use crate::dem_file::DemFile;
use crate::formats::gpkg::{FORMAT, GpkgCoverage, GpkgMatrix, GpkgWindow, WHOLE, refused};
use crate::formats::png;
use crate::hints::{DemHints, DemOptions};
use crate::tiff::geotiff;
use sandtable_database::quoted;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples, scaled};

/// The size and the meaning of the values of one tile.
struct GpkgTile {
    column: u64,
    row: u64,
    scale: f64,
    offset: f64,
}

/// Fills `samples` from all tiles of a level.
pub(super) fn read_tiles(
    database: &Connection,
    coverage: &GpkgCoverage,
    matrix: &GpkgMatrix,
    window: &GpkgWindow,
    samples: &mut Samples,
) -> Result<(), DemErrorKind> {
    let refused = |error| refused("its tiles")(error);
    let query = format!(
        "SELECT t.tile_column, t.tile_row, a.scale, a.offset, t.tile_data FROM {} t \
         LEFT JOIN gpkg_2d_gridded_tile_ancillary a ON a.tpudt_name = ?1 AND a.tpudt_id = t.id \
         WHERE t.zoom_level = ?2 ORDER BY t.id",
        quoted(&coverage.name)
    );
    let mut statement = database.prepare(&query).map_err(refused)?;
    let mut rows = statement.query((&coverage.name, matrix.zoom)).map_err(refused)?;
    while let Some(row) = rows.next().map_err(refused)? {
        let index = |at: usize| row.get::<_, i64>(at).map(|index| u64::try_from(index).unwrap_or(u64::MAX));
        let number =
            |at: usize, default: f64| row.get::<_, Option<f64>>(at).map(|found| found.unwrap_or(default));
        let tile = GpkgTile {
            column: index(0).map_err(refused)?,
            row: index(1).map_err(refused)?,
            scale: number(2, 1.0).map_err(refused)?,
            offset: number(3, 0.0).map_err(refused)?,
        };
        let name = format!("tile {}, {} of level {}", tile.column, tile.row, matrix.zoom);
        let ValueRef::Blob(bytes) = row.get_ref(4).map_err(refused)? else {
            return Err(FORMAT.broken(format!("{name} holds no bytes")));
        };
        if !(tile.scale.is_finite() && tile.offset.is_finite()) {
            return Err(
                FORMAT.broken(format!("{name} has the scale {} and the offset {}", tile.scale, tile.offset))
            );
        }
        let values = tile_values(bytes, coverage.is_float)
            .map_err(|source| DemErrorKind::Tile { name: name.clone(), source: Box::new(source) })?;
        if (u64::from(values.width), u64::from(values.height)) != (matrix.tile.x, matrix.tile.y) {
            let (found, wanted) = ((values.width, values.height), matrix.tile);
            return Err(FORMAT.broken(format!(
                "{name} has {} x {} pixels, not {} x {}",
                found.0, found.1, wanted.x, wanted.y
            )));
        }
        if tile.column < matrix.tiles.x && tile.row < matrix.tiles.y {
            tile.copy(&values, coverage, window, samples);
        }
    }
    Ok(())
}

/// The values of a tile as they are stored.
fn tile_values(bytes: &[u8], is_float: bool) -> Result<Raster, DemErrorKind> {
    let hints = DemHints::from(DemOptions { height_scale: Some(1.0), ..DemOptions::default() });
    let format = if is_float { &geotiff::FORMAT } else { &png::FORMAT };
    (format.reader)(&DemFile { name: "tile", bytes, hints: &hints })
}

impl GpkgTile {
    /// Copies the part within the window.
    fn copy(&self, values: &Raster, coverage: &GpkgCoverage, window: &GpkgWindow, samples: &mut Samples) {
        let (width, height) = (u64::from(values.width), u64::from(values.height));
        let (left, top) = (self.column * width, self.row * height);
        let stride = window.columns.end - window.columns.start;
        let rows = top.max(window.rows.start)..(top + height).min(window.rows.end);
        let columns = left.max(window.columns.start)..(left + width).min(window.columns.end);
        for row in rows {
            for column in columns.clone() {
                let value = values.at((column - left) as u32, (row - top) as u32);
                let at = (row - window.rows.start) * stride + column - window.columns.start;
                samples.set(at as usize, self.height(value, coverage));
            }
        }
    }

    fn height(&self, value: f64, coverage: &GpkgCoverage) -> f64 {
        let nodata =
            coverage.nodata.map(|nodata| if coverage.is_float { f64::from(nodata as f32) } else { nodata });
        if value.is_nan() || nodata == Some(value) {
            return f64::NAN;
        }
        if coverage.is_float {
            return value;
        }
        let height = scaled(scaled(value, self.scale, self.offset), coverage.scale, coverage.offset);
        if coverage.precision == WHOLE { height.round() } else { height }
    }
}
