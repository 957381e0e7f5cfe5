//! Coarse levels: each pixel the mean of the four below it that have elevation.

use rayon::prelude::*;

use crate::tiles::colors::pixels::{PixelHeights, TILE_PIXELS};
use crate::tiles::colors::pyramid::{ColorPyramid, PIXELS};
use crate::tiles::tiling::TileAddress;

/// A tile and the results for it and for those below it, from the coarsest.
pub struct TileMeans<T> {
    /// The tile's heights; `None` without elevation.
    pub heights: Option<PixelHeights>,
    /// The results.
    pub made: Vec<T>,
}

/// Computes the heights of `tile` from those of the level `leaves`, which is not coarser and which `leaf` returns, and calls
/// `make` for each tile on the way that has elevation, the leaves and the tile itself with them. The same on every number of
/// threads. Memory: four tiles for each level and thread.
///
/// # Errors
/// Those of `leaf` and `make`.
pub fn tile_means<T: Send, E: Send>(
    pyramid: &ColorPyramid,
    tile: TileAddress,
    leaves: u32,
    leaf: &(impl Fn(TileAddress) -> Result<Option<PixelHeights>, E> + Sync),
    make: &(impl Fn(TileAddress, &PixelHeights) -> Result<Option<T>, E> + Sync),
) -> Result<TileMeans<T>, E> {
    let (heights, below) = if tile.level == leaves {
        (leaf(tile)?, Vec::new())
    } else {
        let range = pyramid.meeting(tile.level + 1);
        let child = |&child: &TileAddress| match range.contains(child) {
            true => tile_means(pyramid, child, leaves, leaf, make),
            false => Ok(TileMeans { heights: None, made: Vec::new() }),
        };
        let children: Vec<Result<_, E>> = tile.children().par_iter().map(child).collect();
        let children = children.into_iter().collect::<Result<Vec<_>, E>>()?;
        let (heights, made): (Vec<_>, Vec<_>) =
            children.into_iter().map(|child| (child.heights, child.made)).unzip();
        (mean(&heights), made)
    };
    let own = heights.as_ref().map(|heights| make(tile, heights)).transpose()?.flatten();
    let made = own.into_iter().chain(below.into_iter().flatten()).collect();
    Ok(TileMeans { heights, made })
}

/// The heights of a tile from those of its children, row by row.
fn mean(children: &[Option<PixelHeights>]) -> Option<PixelHeights> {
    let side = PIXELS as usize;
    let pixel = |at: usize| {
        let (column, row) = (at % side * 2, at / side * 2);
        let Some(child) = &children[row / side * 2 + column / side] else { return f32::NAN };
        let (column, row) = (column % side, row % side);
        let four = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let heights = four.map(|(across, down)| child.at(column + across, row + down));
        let valid = heights.iter().filter(|height| !height.is_nan());
        let (sum, count) = valid.fold((0.0, 0), |(sum, count), &height| (sum + f64::from(height), count + 1));
        // Not a quotient, whose NaN differs from machine to machine.
        if count == 0 { f32::NAN } else { (sum / f64::from(count)) as f32 }
    };
    PixelHeights::new((0..TILE_PIXELS).map(pixel).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_dem::formats::height_encoding::HeightEncoding;

    #[test]
    fn a_pixel_is_the_mean_of_those_below_it_that_have_elevation() {
        let tile = TileAddress { level: 1, x: 1, y: 0 };
        let bounds = [0.0, 0.0, 180.0, 85.0];
        let pyramid =
            ColorPyramid { encoding: HeightEncoding::TerrainRgb, max_zoom: 3, sampled_zoom: 3, bounds };
        // A plane over all of level 3, with a hole at the corner and a tile that is missing.
        let leaf = |tile: TileAddress| -> Result<Option<PixelHeights>, String> {
            let height = |at: usize| {
                let (column, row) = (tile.x as usize * 256 + at % 256, tile.y as usize * 256 + at / 256);
                let is_hole = column < 1026 && row == 0;
                if is_hole { f32::NAN } else { column as f32 + 3.0 * row as f32 }
            };
            let is_there = (tile.x, tile.y) != (7, 3);
            Ok(PixelHeights::new((0..TILE_PIXELS).map(height).collect()).filter(|_| is_there))
        };
        let make = |tile: TileAddress, _: &PixelHeights| Ok((tile.level < 3).then_some(tile));
        let TileMeans { heights, made } = tile_means(&pyramid, tile, 3, &leaf, &make).expect("no fault");
        let heights = heights.expect("elevation");
        assert_eq!(made, [vec![tile], tile.children().to_vec()].concat());
        // Pixel 10, 20 covers columns 1024 + 40 to + 43 and rows 80 to 83.
        assert_eq!(heights.at(10, 20), 1024.0 + 41.5 + 3.0 * 81.5);
        assert!(heights.at(255, 255).is_nan() && heights.at(191, 191).is_finite());
        // Of level 2, the first pixel has two of four, and the next all four.
        let first = (1024.0 + 1025.0 + 6.0) / 2.0;
        let pixels = [first, 1026.5 + 1.5, 1024.5 + 7.5, 1026.5 + 7.5];
        assert_eq!(heights.at(0, 0), pixels.iter().sum::<f32>() / 4.0);
        let failed = tile_means::<(), String>(&pyramid, tile, 3, &|_| Err("torn".into()), &|_, _| Ok(None));
        assert!(failed.is_err_and(|error| error == "torn"));
    }
}
