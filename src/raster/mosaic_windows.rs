//! The tiles of one raster that stay on disk: opened by their headers, and read where a window meets them.
//!
//! A window is filled from the tiles that it meets, in their order: as in a [mosaic](crate::mosaic) in memory, the first
//! tile with a value wins. Some tiles stay open, the others are opened again when they are met.

use crate::cache::LruCache;
use crate::error::DemErrorKind;
use crate::mosaic::{MosaicError, PlacedHeader, Tiles};
use crate::nested_tile::{FinerWindows, Refinement};
use crate::raster::{Raster, Samples};
use crate::windows::{RasterWindow, Windows};
use sandtable_base::limits::WINDOWED_SAMPLES;

/// Tiles that stay open: few enough for any system's limit on open files.
const OPEN_TILES: usize = 32;

/// Opens the tile of an index.
type TileOpener = Box<dyn FnMut(usize) -> Result<Box<dyn Windows + Send>, DemErrorKind> + Send>;

/// A mosaic of tiles on disk.
pub struct MosaicWindows {
    header: Raster,
    /// In the order in which they win.
    tiles: Vec<PlacedHeader>,
    opener: TileOpener,
    open: LruCache<usize, Box<dyn Windows + Send>>,
}

impl MosaicWindows {
    /// Joins tiles of which the names and the headers are known; `opener` opens one of them by its number.
    ///
    /// # Errors
    /// [`MosaicError`].
    pub fn new(headers: Vec<(String, Raster)>, opener: TileOpener) -> Result<Self, MosaicError> {
        let (header, tiles) = Tiles::of_headers(headers).placed(WINDOWED_SAMPLES.get())?;
        Ok(Self { header, tiles, opener, open: LruCache::new(OPEN_TILES) })
    }

    /// The samples of a tile in a window of its own, in the mosaic's grid.
    fn tile_samples(&mut self, tile: usize, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        let PlacedHeader { index, size, refinement, .. } = self.tiles[tile];
        let mut opened = match self.open.take(tile) {
            Some(opened) => opened,
            None => {
                let opened = (self.opener)(index)?;
                if opened.size() != size {
                    return Err(DemErrorKind::Changed);
                }
                in_finer_grid(opened, refinement)
            }
        };
        let samples = opened.samples(window);
        self.open.put(tile, opened, 1);
        samples
    }
}

/// A tile in the grid of the finest one.
fn in_finer_grid(tile: Box<dyn Windows + Send>, refinement: Option<Refinement>) -> Box<dyn Windows + Send> {
    match refinement {
        Some(refinement) => Box::new(FinerWindows::new(tile, refinement)),
        None => tile,
    }
}

impl Windows for MosaicWindows {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let mut all = Samples::absent(window.samples(), self.header.samples.is_wide());
        for index in 0..self.tiles.len() {
            let Some(shared) = self.tiles[index].window.intersection(window) else { continue };
            let tile = self.tiles[index].window;
            let own =
                RasterWindow { column: shared.column - tile.column, row: shared.row - tile.row, ..shared };
            let found = self.tile_samples(index, own).map_err(|source| DemErrorKind::Tile {
                name: self.tiles[index].name.clone(),
                source: Box::new(source),
            })?;
            for (from, to) in shared.shared_rows(window) {
                for (from, to) in from.zip(to) {
                    let value = found.get(from);
                    if !value.is_nan() && all.get(to).is_nan() {
                        all.set(to, value);
                    }
                }
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::tests::small;
    use glam::DVec2;

    /// Three overlapping tiles of one grid, with holes.
    fn tiles() -> Vec<Raster> {
        [(0.0, 0.0, 7, 5), (5.0, 2.0, 6, 6), (-2.0, 4.0, 9, 3)]
            .into_iter()
            .map(|(column, row, width, height)| {
                let value = |at: u32| if at % 5 == 2 { f32::NAN } else { at as f32 + 100.0 * column as f32 };
                let mut tile = small(width, height, (0..width * height).map(value).collect());
                tile.map_from_grid.translation = DVec2::new(1000.0 + 10.0 * column, 2000.0 - 10.0 * row);
                tile
            })
            .collect()
    }

    #[test]
    fn windows_of_a_mosaic_are_those_of_the_joined_raster() {
        let mut joined = Tiles::default();
        let mut headers = Vec::new();
        for (index, tile) in tiles().into_iter().enumerate() {
            headers.push((format!("tile {index}"), tile.without_samples()));
            joined.push(format!("tile {index}"), tile).expect("few samples");
        }
        let mut whole = joined.join().expect("of one raster").raster;
        let opener: TileOpener = Box::new(|index| Ok(Box::new(tiles().swap_remove(index))));
        let mut windows = MosaicWindows::new(headers, opener).expect("of one raster");
        assert_eq!(windows.metadata().geotransform(), whole.geotransform());
        let (width, height) = whole.size();
        assert_eq!(windows.size(), (width, height));
        let bits = |samples: Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
        for (column, row) in (0..width).flat_map(|column| (0..height).map(move |row| (column, row))) {
            let window =
                RasterWindow { column, row, width: (width - column).min(4), height: (height - row).min(3) };
            let found = windows.samples(window).expect("in memory");
            assert_eq!(bits(found), bits(whole.samples(window).expect("in memory")), "{window:?}");
        }
    }

    #[test]
    fn windows_of_tiles_of_several_cells_are_those_of_the_joined_raster() {
        let several = || {
            let mut all = tiles();
            for (times, column, row) in [(2.0, -4.0, -2.0), (3.0, 6.0, 1.0), (2.0, 0.5, 0.5)] {
                let mut tile = all[0].clone();
                tile.map_from_grid.matrix2 *= times;
                tile.map_from_grid.translation = DVec2::new(1000.0 + 10.0 * column, 2000.0 - 10.0 * row);
                all.insert(0, tile);
            }
            all
        };
        let mut joined = Tiles::default();
        let mut headers = Vec::new();
        for (index, tile) in several().into_iter().enumerate() {
            headers.push((format!("tile {index}"), tile.without_samples()));
            joined.push(format!("tile {index}"), tile).expect("few samples");
        }
        let mut whole = joined.join().expect("they nest").raster;
        let opener: TileOpener = Box::new(move |index| Ok(Box::new(several().swap_remove(index))));
        let mut windows = MosaicWindows::new(headers, opener).expect("they nest");
        assert_eq!(windows.metadata().geotransform(), whole.geotransform());
        assert_eq!(windows.metadata().notes, whole.notes);
        let (width, height) = whole.size();
        let bits = |samples: Samples| samples.iter().map(f64::to_bits).collect::<Vec<_>>();
        for (column, row) in (0..width).flat_map(|column| (0..height).map(move |row| (column, row))) {
            let window =
                RasterWindow { column, row, width: (width - column).min(4), height: (height - row).min(3) };
            let found = windows.samples(window).expect("in memory");
            assert_eq!(bits(found), bits(whole.samples(window).expect("in memory")), "{window:?}");
        }
    }

    #[test]
    fn a_tile_that_changed_is_named() {
        let headers = tiles().into_iter().map(|tile| ("a.tif".to_owned(), tile.without_samples())).collect();
        let opener: TileOpener = Box::new(|_| Ok(Box::new(small(2, 2, vec![0.0; 4]))));
        let mut windows = MosaicWindows::new(headers, opener).expect("of one raster");
        let fault =
            windows.samples(RasterWindow { column: 2, row: 0, width: 1, height: 1 }).expect_err("changed");
        assert!(fault.to_string().starts_with("a.tif: ") && fault.to_string().contains("changed"), "{fault}");
    }
}
