//! Rasters whose rows or columns run the other way, turned as maps are printed.

use std::borrow::Cow;

use glam::DVec2;

use crate::raster::{Raster, Samples, north_up};
use sandtable_geom::rect::Rect;

impl Raster {
    /// An axis-aligned raster with columns and rows in the order that puts north up.
    pub fn turned_north_up(&self) -> Cow<'_, Self> {
        if self.is_north_up() {
            return Cow::Borrowed(self);
        }
        let Rect { min, max } = self.extent();
        let samples = match &self.samples {
            Samples::F32(values) => Samples::F32(mirrored(values, self)),
            Samples::F64(values) => Samples::F64(mirrored(values, self)),
        };
        let map_from_grid = north_up(DVec2::new(min.x, max.y), self.spacing());
        Cow::Owned(Self { samples, map_from_grid, ..self.without_samples() })
    }
}

fn mirrored<T: Copy>(values: &[T], raster: &Raster) -> Vec<T> {
    let axes = raster.map_from_grid.matrix2;
    let (mirrors_x, mirrors_y) = (axes.x_axis.x < 0.0, axes.y_axis.y > 0.0);
    let (width, height) = (raster.width as usize, raster.height as usize);
    let at = |index: usize| {
        let (row, column) = (index / width, index % width);
        let row = if mirrors_y { height - 1 - row } else { row };
        let column = if mirrors_x { width - 1 - column } else { column };
        values[row * width + column]
    };
    (0..values.len()).map(at).collect()
}
