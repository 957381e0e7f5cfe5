//! The posts of a tile: its vertices.

use glam::DVec2;

use crate::tiles::tiling::{TileAddress, TileScheme};

/// Posts along a side of a tile.
pub const POSTS: usize = CELLS as usize + 1;
/// Cells along a side of a tile.
pub const CELLS: u32 = 64;

/// The longitude and latitude of a post, degrees, by its column from the west and its row from the south; the same bits in
/// all tiles that it is a post of.
fn post(tile: TileAddress, column: usize, row: usize) -> DVec2 {
    TileScheme::Geographic.place(tile, CELLS, DVec2::new(column as f64, row as f64))
}

/// All posts of a tile, row by row from the south-west.
pub fn posts(tile: TileAddress) -> Vec<DVec2> {
    (0..POSTS).flat_map(|row| (0..POSTS).map(move |column| post(tile, column, row))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn posts_that_tiles_share_have_the_same_bits_on_every_level() {
        let tile = TileAddress { level: 11, x: 1073, y: 1437 };
        let (east, north) = (TileAddress { x: 1074, ..tile }, TileAddress { y: 1438, ..tile });
        for at in 0..POSTS {
            assert_eq!(post(tile, POSTS - 1, at), post(east, 0, at));
            assert_eq!(post(tile, at, POSTS - 1), post(north, at, 0));
        }
        let parent = TileAddress { level: 10, x: 536, y: 718 };
        assert_eq!(post(parent, 32 + 7, 32 + 9), post(tile, 14, 18));
        assert_eq!(post(TileAddress { level: 0, x: 1, y: 0 }, 64, 64), DVec2::new(180.0, 90.0));
    }
}
