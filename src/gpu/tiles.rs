//! A large picture in tiles: each as large as a texture may be, and not so large that a device's memory ends.
//!
//! ```text
//!   ┌───────┬───────┐      all tiles have one size, so that all are drawn to the same textures;
//!   │       │       │      the last of a row or a column reach beyond the picture
//!   ├───────┼───────┤┐
//!   └───────┴───────┴┘
//! ```
//!
//! A tile is drawn as its part of the whole picture: corners are moved after they are projected, so that a pixel has the ray
//! that it has in a picture drawn at once.

/// The most pixels of a tile: its targets take 48 bytes a pixel, 0.8 gibibytes in all.
const MOST_PIXELS: u64 = 1 << 24;

/// How a picture is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureTiles {
    picture: (u32, u32),
    tile: (u32, u32),
}

/// A part of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureTile {
    /// The column of its first pixel in the picture, and the row.
    pub first: [u32; 2],
    /// Its size in pixels, some of which may lie beyond the picture.
    pub size: (u32, u32),
}

/// The projection of a tile: the whole picture, scaled and moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileProjection {
    /// Factors of the picture's clip coordinates, and what is added to them for each unit of depth.
    pub scale_and_offset: [f32; 4],
    /// Its first pixel.
    pub first: [f32; 2],
}

impl PictureTiles {
    /// As few tiles as do for a picture on an adapter whose textures have at most so many pixels a side.
    pub fn new(picture: (u32, u32), longest: u32) -> Self {
        let divided = |side: u32, parts: u32| side.div_ceil(parts);
        let (width, height) = picture;
        let mut parts = [width, height].map(|side| side.div_ceil(longest.max(1)).max(1));
        loop {
            let tile = (divided(width, parts[0]), divided(height, parts[1]));
            if u64::from(tile.0) * u64::from(tile.1) <= MOST_PIXELS {
                return Self { picture, tile };
            }
            parts[usize::from(tile.1 > tile.0)] += 1;
        }
    }

    /// The size of every tile in pixels.
    pub fn tile_size(&self) -> (u32, u32) {
        self.tile
    }

    /// The tiles, row by row from the upper left.
    pub fn tiles(self) -> impl Iterator<Item = PictureTile> {
        let (size, (width, height)) = (self.tile, self.picture);
        let starts = |side: u32, step: u32| (0..side).step_by(step.max(1) as usize);
        starts(height, size.1)
            .flat_map(move |y| starts(width, size.0).map(move |x| PictureTile { first: [x, y], size }))
    }
}

impl PictureTile {
    /// Its projection in a picture of a size.
    pub fn projection(&self, (width, height): (u32, u32)) -> TileProjection {
        let axis = |picture: u32, tile: u32, first: u32| {
            let (picture, tile) = (f64::from(picture), f64::from(tile));
            let scale = picture / tile;
            (scale as f32, (scale - 2.0 * f64::from(first) / tile - 1.0) as f32)
        };
        let [x, y] = self.first;
        let (scale_x, offset_x) = axis(width, self.size.0, x);
        let (scale_y, offset_y) = axis(height, self.size.1, y);
        TileProjection {
            // Clip coordinates rise upward, rows downward.
            scale_and_offset: [scale_x, scale_y, offset_x, -offset_y],
            first: [x as f32, y as f32],
        }
    }
}

impl TileProjection {
    /// That of a whole picture.
    pub const WHOLE: Self = Self { scale_and_offset: [1.0, 1.0, 0.0, 0.0], first: [0.0; 2] };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_that_fits_is_one_tile_and_is_not_moved() {
        let tiles = PictureTiles::new((3840, 2160), 16_384);
        let all: Vec<PictureTile> = tiles.tiles().collect();
        assert_eq!(all, [PictureTile { first: [0, 0], size: (3840, 2160) }]);
        assert_eq!(all[0].projection((3840, 2160)), TileProjection::WHOLE);
    }

    #[test]
    fn tiles_cover_a_picture_within_the_sides_and_the_memory_of_an_adapter() {
        for (picture, longest) in
            [((7680, 4320), 16_384), ((1000, 30), 64), ((16_384, 16_384), 8192), ((5, 7), 1)]
        {
            let tiles = PictureTiles::new(picture, longest);
            let (width, height) = tiles.tile_size();
            assert!(width.max(height) <= longest && u64::from(width) * u64::from(height) <= MOST_PIXELS);
            let covered: u64 = tiles
                .tiles()
                .map(|PictureTile { first: [x, y], size }| {
                    let part = |side: u32, first: u32, size: u32| u64::from(size.min(side - first));
                    part(picture.0, x, size.0) * part(picture.1, y, size.1)
                })
                .sum();
            assert_eq!(covered, u64::from(picture.0) * u64::from(picture.1), "{picture:?}");
        }
        assert_eq!(PictureTiles::new((7680, 4320), 16_384).tiles().count(), 2);
    }

    #[test]
    fn a_pixel_of_a_tile_is_that_of_the_picture() {
        let picture = (1000, 700);
        for tile in PictureTiles::new(picture, 300).tiles() {
            let TileProjection { scale_and_offset: [scale_x, scale_y, offset_x, offset_y], .. } =
                tile.projection(picture);
            // The pixel in the picture, from clip coordinates that are those of the tile's corners.
            let pixel = |clip: f32, scale: f32, offset: f32, side: u32| {
                ((clip - offset) / scale + 1.0) / 2.0 * side as f32
            };
            let left = pixel(-1.0, scale_x, offset_x, picture.0);
            let upper = picture.1 as f32 - pixel(1.0, scale_y, offset_y, picture.1);
            assert!((left - tile.first[0] as f32).abs() < 1e-3, "{left} {tile:?}");
            assert!((upper - tile.first[1] as f32).abs() < 1e-3, "{upper} {tile:?}");
        }
    }
}
