//! Tiles whose cells do not nest, joined in cells of a stated size.

use crate::mosaic::{Mosaic, MosaicError, Tiles};
use crate::warp::error::WarpError;
use crate::warp::reproject::{Resampling, to_cells};
use sandtable_geom::crs::Crs;

/// A larger cell, in degrees, is taken for one in meters.
const LARGEST_CELL_DEG: f64 = 1.0;

impl Tiles {
    /// Joins the tiles. Where their cells neither are alike nor nest, or their samples lie off each other's, all are resampled
    /// to square cells of `cell`, on multiples of it, if it is stated: to the mean of samples from twice their cells on, else
    /// bilinearly. A tile without data is left out then.
    ///
    /// # Errors
    /// [`MosaicError`].
    pub fn join_in_cells(self, cell: Option<f64>) -> Result<Mosaic, MosaicError> {
        let Some(misfit) = self.misfit() else { return self.join() };
        let is_in_degrees = self.first().and_then(|tile| tile.crs.as_ref()).is_some_and(Crs::is_geographic);
        let Some(cell) = cell.filter(|&cell| !is_in_degrees || cell <= LARGEST_CELL_DEG) else {
            return Err(misfit);
        };
        let (mut resampled, tiles, mut means) = (Self::default(), self.into_named(), 0);
        let count = tiles.len();
        for (name, tile) in tiles {
            let failed =
                |source| MosaicError::Resample { name: name.clone(), cell, source: Box::new(source) };
            let warped = match to_cells(&tile, cell) {
                Err(WarpError::Empty) => continue,
                warped => warped.map_err(failed)?,
            };
            means += usize::from(warped.method == Resampling::Average);
            resampled.push(name, warped.raster.into_owned())?;
        }
        let mut mosaic = resampled.join()?;
        mosaic.of_other_cells = mosaic.tiles;
        mosaic.raster.notes.push(format!(
            "{count} tiles whose cells do not nest were resampled to cells of {cell}: {means} to means of their samples, {} \
             bilinearly",
            mosaic.tiles - means
        ));
        Ok(mosaic)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;
    use crate::raster::{Raster, Samples};
    use glam::DVec2;

    #[test]
    fn other_cells_are_resampled_to_a_stated_one() {
        let plane = |raster: &Raster, column: u32, row: u32| {
            let center = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let at = raster.map_from_grid.transform_point2(center);
            0.5 * at.x - 0.25 * at.y
        };
        let painted = |mut raster: Raster| {
            let (width, height) = (raster.width, raster.height);
            let values = (0..width * height).map(|at| plane(&raster, at % width, at / width) as f32);
            raster.samples = Samples::F32(values.collect());
            raster
        };
        let tile = |column: f64, side: u32| {
            let mut tile = small(side, side, vec![0.0; (side * side) as usize]);
            tile.map_from_grid.translation = DVec2::new(1000.0 + 10.0 * column, 2020.0);
            tile
        };
        let mut odd = tile(12.0, 8);
        odd.map_from_grid.matrix2 *= 1.5;
        let tiles = || {
            let mut tiles = Tiles::default();
            tiles.push("a", painted(tile(0.0, 12))).expect("few");
            tiles.push("b", painted(odd.clone())).expect("few");
            tiles
        };
        assert!(matches!(tiles().join_in_cells(None), Err(MosaicError::Cells { .. })));
        for (cell, means) in [(5.0, 0), (12.0, 0), (20.0, 1), (30.0, 2)] {
            let joined = tiles().join_in_cells(Some(cell)).expect("resampled");
            let raster = &joined.raster;
            assert_eq!(raster.spacing(), DVec2::splat(cell));
            let corner = raster.map_from_grid.translation / cell;
            assert!((corner - corner.round()).abs().max_element() < 1e-9, "{corner}");
            assert!(raster.notes[0].contains(&format!("{means} to means")), "{:?}", raster.notes);
            // Away from the border, where bilinear heights hold the outermost samples', the plane comes back.
            let inner = |column: u32, row: u32| {
                let center = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
                let at = raster.map_from_grid.transform_point2(center);
                let within = |low: DVec2, high: DVec2| at.cmpgt(low).all() && at.cmplt(high).all();
                within(DVec2::new(1015.0, 1915.0), DVec2::new(1105.0, 2005.0))
                    || within(DVec2::new(1140.0, 1925.0), DVec2::new(1220.0, 2000.0))
            };
            let mut compared = 0;
            for (column, row) in (0..raster.width).flat_map(|x| (0..raster.height).map(move |y| (x, y))) {
                if inner(column, row) {
                    let off = raster.at(column, row) - plane(raster, column, row);
                    let most = if means > 0 { 0.75 * cell } else { 1e-3 };
                    assert!(off.abs() <= most, "{cell}: {column}, {row}: {off}");
                    compared += 1;
                }
            }
            assert!(compared > 4, "{cell}: {compared}");
        }
    }
}
