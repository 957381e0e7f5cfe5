//! The pixels of a tile: their centers, their heights, and the colors of those.

use glam::DVec2;

use crate::tiles::colors::pyramid::PIXELS;
use crate::tiles::tiling::{TileAddress, TileScheme};
use sandtable_dem::formats::height_encoding::HeightEncoding;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_files::png::encode_png;

/// Pixels of a tile.
pub const TILE_PIXELS: usize = (PIXELS * PIXELS) as usize;

/// The heights of the pixels of a tile that has elevation, row by row from the north-west, meters; NaN without.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelHeights(Vec<f32>);

impl PixelHeights {
    /// The tile whose pixels have these heights; `None` where none has elevation.
    ///
    /// # Panics
    /// Where there are not as many as pixels.
    pub fn new(heights: Vec<f32>) -> Option<Self> {
        assert_eq!(heights.len(), TILE_PIXELS, "heights of a tile");
        heights.iter().any(|height| !height.is_nan()).then_some(Self(heights))
    }

    /// The height of a pixel.
    pub fn at(&self, column: usize, row: usize) -> f32 {
        self.0[row * PIXELS as usize + column]
    }

    /// The tile as a PNG file of 8-bit colors. Pixels without elevation have height 0, opaque: viewers read no transparency,
    /// but take a transparent pixel for the lowest height.
    pub fn png(&self, encoding: HeightEncoding) -> Vec<u8> {
        let color = |column: u32, row: u32| {
            let height = self.at(column as usize, row as usize);
            let [red, green, blue] = encoding.color(if height.is_nan() { 0.0 } else { f64::from(height) });
            Srgba::opaque(red, green, blue)
        };
        encode_png(&Pixels::from_fn(PIXELS, PIXELS, color))
    }
}

/// The bytes of heights as a result of a shard: 32-bit floats, little-endian; none without elevation.
pub fn heights_to_bytes(heights: Option<&PixelHeights>) -> Vec<u8> {
    heights.iter().flat_map(|PixelHeights(heights)| heights).flat_map(|height| height.to_le_bytes()).collect()
}

/// The numbers of [`heights_to_bytes`], NaN without elevation; `None` where there are not as many as pixels.
pub fn heights_from_bytes(bytes: &[u8]) -> Option<Vec<f32>> {
    if bytes.is_empty() {
        return Some(vec![f32::NAN; TILE_PIXELS]);
    }
    let (numbers, rest) = bytes.as_chunks::<4>();
    let is_tile = numbers.len() == TILE_PIXELS && rest.is_empty();
    is_tile.then(|| numbers.iter().map(|&number| f32::from_le_bytes(number)).collect())
}

/// The longitudes and latitudes of the centers of a tile's pixels, row by row from the north-west.
pub fn pixel_centers(tile: TileAddress) -> Vec<DVec2> {
    let center =
        |pixel: u32| TileScheme::WebMercator.place(tile, PIXELS, DVec2::splat(f64::from(pixel) + 0.5));
    // A column has one longitude, and a row one latitude.
    let diagonal: Vec<DVec2> = (0..PIXELS).map(center).collect();
    let row = |of_row: &DVec2| {
        let latitude = of_row.y;
        diagonal.iter().map(move |of_column| DVec2::new(of_column.x, latitude))
    };
    diagonal.iter().flat_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centers_are_half_a_pixel_from_the_corner_of_a_tile() {
        let tile = TileAddress { level: 3, x: 2, y: 3 };
        let centers = pixel_centers(tile);
        let extent = TileScheme::WebMercator.extent(tile);
        let pixel = extent.size().x / 256.0;
        assert!((centers[0].x - extent.min.x - pixel / 2.0).abs() < 1e-12);
        assert!((extent.max.x - centers[TILE_PIXELS - 1].x - pixel / 2.0).abs() < 1e-12);
        // Rows go south, and each is as high as it is wide: a cosine of the latitude less in degrees.
        let rows = centers[0].y - centers[256].y;
        assert!((rows / pixel / extent.max.y.to_radians().cos() - 1.0).abs() < 0.01, "{rows} {pixel}");
    }

    #[test]
    fn heights_are_kept_as_bytes_and_encoded_as_colors() {
        let height =
            |pixel: usize| if pixel.is_multiple_of(7) { f32::NAN } else { pixel as f32 * 0.1 - 300.0 };
        let heights = PixelHeights::new((0..TILE_PIXELS).map(height).collect()).expect("elevation");
        let bytes = heights_to_bytes(Some(&heights));
        let back = heights_from_bytes(&bytes).and_then(PixelHeights::new).expect("elevation");
        assert_eq!(heights_to_bytes(Some(&back)), bytes);
        let empty = heights_from_bytes(&heights_to_bytes(None)).expect("as many");
        assert_eq!(PixelHeights::new(empty), None);
        assert_eq!(heights_from_bytes(&bytes[4..]), None);
        for encoding in [HeightEncoding::TerrainRgb, HeightEncoding::Terrarium] {
            let png = heights.png(encoding);
            let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().expect("a sound head");
            let mut colors = vec![0; 3 * TILE_PIXELS];
            reader.next_frame(&mut colors).expect("sound pixels");
            for (pixel, color) in colors.as_chunks::<3>().0.iter().enumerate() {
                let wanted = if pixel.is_multiple_of(7) { 0.0 } else { f64::from(height(pixel)) };
                assert!((encoding.meters(*color) - wanted).abs() <= 0.05 + 1e-9, "{encoding} {pixel}");
            }
        }
    }
}
