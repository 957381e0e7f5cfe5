//! The samples of tiles set into their mosaic, the first tile's where several have a value, and how much they differ.

use std::borrow::Cow;

use glam::I64Vec2;

use crate::mosaic::{Mosaic, MosaicError};
use crate::nested_tile::Refinement;
use crate::raster::{Raster, SampleFloat, Samples};
use crate::windows::RasterWindow;
use sandtable_geom::length_unit::FOOT_M;

/// The rectangle around all tiles, in the first tile's grid.
#[derive(Clone, Copy)]
pub(crate) struct MosaicFrame {
    pub min: I64Vec2,
    pub width: usize,
    pub height: usize,
}

impl MosaicFrame {
    /// Of at most `most` samples.
    pub fn around(tiles: &[Raster], corners: &[I64Vec2], most: u64) -> Result<Self, MosaicError> {
        let size = |tile: &Raster| I64Vec2::new(tile.width.into(), tile.height.into());
        let ends = tiles.iter().zip(corners).map(|(tile, corner)| *corner + size(tile));
        let min = corners.iter().copied().fold(I64Vec2::MAX, I64Vec2::min);
        let max = ends.fold(I64Vec2::MIN, I64Vec2::max);
        let size = (max - min).as_u64vec2();
        match size.x.checked_mul(size.y) {
            Some(samples) if samples <= most && size.max_element() <= u32::MAX.into() => {
                Ok(Self { min, width: size.x as usize, height: size.y as usize })
            }
            _ => Err(MosaicError::TooLarge(size)),
        }
    }
}

/// A tile in memory, in a mosaic.
pub(crate) struct PlacedTile<'a> {
    pub raster: &'a Raster,
    pub refinement: Option<Refinement>,
    /// Columns and rows in the mosaic's grid.
    pub size: (u32, u32),
    /// Its first sample in the mosaic.
    pub at: I64Vec2,
}

impl PlacedTile<'_> {
    /// Its samples in the mosaic's grid.
    fn samples(&self) -> Cow<'_, Samples> {
        let samples = &self.raster.samples;
        let Some(finer) = self.refinement else { return Cow::Borrowed(samples) };
        Cow::Owned(finer.samples(self.raster, RasterWindow::all(self.size), samples.is_wide()))
    }
}

/// The mosaic of tiles in the order in which they win; `header` is the mosaic without its samples.
pub(crate) fn join<T: SampleFloat>(tiles: &[PlacedTile<'_>], frame: MosaicFrame, header: Raster) -> Mosaic {
    let mut values = vec![T::NODATA; frame.width * frame.height];
    let mut covered = vec![0u64; values.len().div_ceil(64)];
    let (mut overlaps, mut differing, mut greatest_difference, mut in_feet) = (0, 0, 0.0f64, 0);
    for tile in tiles {
        let (at, width) = (tile.at, tile.size.0 as usize);
        for (index, value) in tile.samples().iter().enumerate() {
            let place = (at.y as usize + index / width) * frame.width + at.x as usize + index % width;
            covered[place / 64] |= 1 << (place % 64);
            let earlier: f64 = values[place].into();
            if value.is_nan() {
                continue;
            }
            if earlier.is_nan() {
                values[place] = T::from_f64(value);
                continue;
            }
            // What is interpolated is no sample that two tiles share.
            if tile.refinement.is_some() {
                continue;
            }
            overlaps += 1;
            if earlier != value {
                differing += 1;
                greatest_difference = greatest_difference.max((earlier - value).abs());
                in_feet += u64::from(is_foot_to_meter(earlier, value));
            }
        }
    }
    let kept: u64 = covered.iter().map(|word| u64::from(word.count_ones())).sum();
    let gaps = values.len() as u64 - kept;
    let raster = Raster { samples: T::into_samples(values), ..header };
    let without_datum = match raster.vertical_datum {
        Some(_) => tiles.iter().filter(|tile| tile.raster.vertical_datum.is_none()).count(),
        None => 0,
    };
    let of_other_cells = tiles.iter().filter(|tile| tile.refinement.is_some()).count();
    let tiles = tiles.len();
    Mosaic {
        raster,
        tiles,
        overlaps,
        differing,
        greatest_difference,
        in_feet,
        gaps,
        without_datum,
        of_other_cells,
    }
}

/// Whether one of two heights is the other in feet, within 1 %.
fn is_foot_to_meter(one: f64, other: f64) -> bool {
    let is_near = |ratio: f64| (ratio - FOOT_M).abs() < 0.01 * FOOT_M;
    is_near(one / other) || is_near(other / one)
}
