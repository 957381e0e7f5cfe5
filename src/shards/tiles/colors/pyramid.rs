//! The tiles of a pyramid of pictures.

use crate::tiles::tiling::{TileAddress, TileRange, TileScheme};
use sandtable_dem::formats::height_encoding::HeightEncoding;

/// Pixels along a side of a tile.
pub const PIXELS: u32 = 256;
/// Levels of a shard: at most 64 tiles whose 4.2 million pixels are queried, some seconds' work, and 21 above them.
const SHARD_LEVELS: u32 = 4;
/// Degrees to which Web Mercator reaches north and south: where the map is a square.
const MOST_LATITUDE: f64 = 85.051_128_779_806_59;

/// A pyramid of pictures.
#[derive(Clone, Copy, Debug)]
pub struct ColorPyramid {
    /// Which colors heights have.
    pub encoding: HeightEncoding,
    /// The finest level that is written.
    pub max_zoom: u32,
    /// The level at whose pixels the elevation is queried, `max_zoom` or finer.
    pub sampled_zoom: u32,
    /// West, south, east and north of the elevation in degrees, as the plan states them.
    pub bounds: [f64; 4],
}

impl ColorPyramid {
    /// The roots of the shards, in their order.
    pub fn roots(&self) -> TileRange {
        self.meeting(self.sampled_zoom.saturating_sub(SHARD_LEVELS - 1))
    }

    /// The tiles of a level that meet the elevation.
    pub fn meeting(&self, level: u32) -> TileRange {
        TileScheme::WebMercator.tiles_meeting(level, self.bounds)
    }

    /// The tiles of a shard whose pixels are queried.
    pub fn sampled_below(&self, root: TileAddress) -> TileRange {
        self.meeting(self.sampled_zoom).intersection(&root.below(self.sampled_zoom))
    }

    /// The path of a tile in the folder of the plan.
    pub fn path(&self, tile: TileAddress) -> String {
        format!("tiles/{}", tile.path("png"))
    }
}

/// The level whose pixels are no farther apart than `cell_deg` degrees of longitude.
pub fn natural_zoom(cell_deg: f64) -> u32 {
    TileScheme::WebMercator.level_of(PIXELS, cell_deg)
}

/// The part of bounds in degrees that Web Mercator has; `None` where it has none.
pub fn within_mercator([west, south, east, north]: [f64; 4]) -> Option<[f64; 4]> {
    let (south, north) = (south.max(-MOST_LATITUDE), north.min(MOST_LATITUDE));
    (south < north).then_some([west, south, east, north])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sampled_tile_is_in_one_shard() {
        let bounds = [7.1, 46.2, 7.9, 46.7];
        let pyramid =
            ColorPyramid { encoding: HeightEncoding::TerrainRgb, max_zoom: 13, sampled_zoom: 13, bounds };
        assert_eq!(pyramid.roots().level, 10);
        let mut tiles: Vec<TileAddress> =
            pyramid.roots().tiles().flat_map(|root| pyramid.sampled_below(root).tiles()).collect();
        tiles.sort();
        let mut all: Vec<TileAddress> = pyramid.meeting(13).tiles().collect();
        all.sort();
        assert_eq!(tiles, all);
        let coarse = ColorPyramid { sampled_zoom: 2, max_zoom: 2, ..pyramid };
        assert_eq!((coarse.roots().level, coarse.roots().count()), (0, 1));
    }

    #[test]
    fn the_poles_are_cut_off() {
        let cut = within_mercator([0.0, 80.0, 9.0, 90.0]).expect("a part");
        assert!(cut[3] < 85.06 && cut[1] == 80.0, "{cut:?}");
        assert_eq!(within_mercator([0.0, 86.0, 9.0, 90.0]), None);
    }
}
