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
        let samples = self.samples.clone().mirrored(self.width as usize, self.mirrors());
        Cow::Owned(Self { samples, ..self.placed_north_up() })
    }

    /// An axis-aligned raster without samples as [`Self::turned_north_up`] places it.
    pub(crate) fn placed_north_up(&self) -> Self {
        if self.is_north_up() {
            return self.without_samples();
        }
        let Rect { min, max } = self.extent();
        let map_from_grid = north_up(DVec2::new(min.x, max.y), self.spacing());
        Self { map_from_grid, ..self.without_samples() }
    }

    /// Whether the columns, and whether the rows, of an axis-aligned raster run the other way.
    pub(crate) fn mirrors(&self) -> (bool, bool) {
        let axes = self.map_from_grid.matrix2;
        (axes.x_axis.x < 0.0, axes.y_axis.y > 0.0)
    }
}

impl Samples {
    /// Rows of `width` samples with their columns, and rows, in the other order.
    pub(crate) fn mirrored(self, width: usize, mirrors: (bool, bool)) -> Self {
        match self {
            Self::F32(values) => Self::F32(mirrored(values, width, mirrors)),
            Self::F64(values) => Self::F64(mirrored(values, width, mirrors)),
        }
    }
}

fn mirrored<T: Copy>(mut values: Vec<T>, width: usize, (mirrors_x, mirrors_y): (bool, bool)) -> Vec<T> {
    if mirrors_x && mirrors_y {
        values.reverse();
    } else if mirrors_x {
        values.chunks_mut(width).for_each(<[T]>::reverse);
    } else if mirrors_y {
        let rows = values.len() / width;
        for row in 0..rows / 2 {
            let (upper, lower) = values.split_at_mut((rows - 1 - row) * width);
            upper[row * width..][..width].swap_with_slice(&mut lower[..width]);
        }
    }
    values
}
