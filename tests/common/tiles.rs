//! A tiled GeoTIFF of 32-bit floats with overviews, written byte by byte.

use std::io::Write;

/// How tiles are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Packing {
    /// As they are.
    Plain,
    /// Deflated.
    Deflate,
}

/// Samples of one image, row by row from the north.
pub struct Image {
    pub width: u32,
    pub height: u32,
    pub samples: Vec<f32>,
}

impl Image {
    /// The image whose sample at (column, row) is `of` them.
    pub fn of(width: u32, height: u32, of: impl Fn(u32, u32) -> f32) -> Self {
        let samples = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        Self { width, height, samples: samples.map(|(column, row)| of(column, row)).collect() }
    }

    /// Every second sample of every second row, rounded up: an overview by the nearest sample.
    pub fn halved(&self) -> Self {
        let at = |column: u32, row: u32| self.samples[(row * 2 * self.width + column * 2) as usize];
        Self::of(self.width.div_ceil(2), self.height.div_ceil(2), at)
    }
}

/// The file of `images`, the first in full and the others its overviews, in tiles of `tile` samples a side; meters
/// in UTM zone 12, cells of 10 m, no-data value −9999.
pub fn file(images: &[Image], tile: u32, packing: Packing) -> Vec<u8> {
    let mut out = b"II*\0\0\0\0\0".to_vec();
    let mut link = 4;
    for (index, image) in images.iter().enumerate() {
        let tiles = tiles(&mut out, image, tile, packing);
        let directory = directory(&mut out, image, tile, packing, &tiles, index > 0);
        let at = u32::try_from(out.len()).expect("small");
        out[link..link + 4].copy_from_slice(&at.to_le_bytes());
        out.extend(directory);
        link = out.len() - 4;
    }
    out
}

/// Writes the tiles and returns their offsets and lengths.
fn tiles(out: &mut Vec<u8>, image: &Image, tile: u32, packing: Packing) -> Vec<(u32, u32)> {
    let mut places = Vec::new();
    for top in (0..image.height).step_by(tile as usize) {
        for left in (0..image.width).step_by(tile as usize) {
            let posts =
                (top..top + tile).flat_map(|row| (left..left + tile).map(move |column| (column, row)));
            let plain: Vec<u8> = posts
                .flat_map(|(column, row)| {
                    let inside = column < image.width && row < image.height;
                    let at = (row * image.width + column) as usize;
                    if inside { image.samples[at] } else { 0.0 }.to_le_bytes()
                })
                .collect();
            let stored = match packing {
                Packing::Plain => plain,
                Packing::Deflate => {
                    let mut packer = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
                    packer.write_all(&plain).expect("memory");
                    packer.finish().expect("memory")
                }
            };
            places.push((out.len() as u32, stored.len() as u32));
            out.extend(stored);
        }
    }
    places
}

/// The bytes of a directory whose long values are written before it.
fn directory(
    out: &mut Vec<u8>,
    image: &Image,
    tile: u32,
    packing: Packing,
    tiles: &[(u32, u32)],
    reduced: bool,
) -> Vec<u8> {
    let words = |values: &[u32]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let shorts = |values: &[u16]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let doubles = |values: &[f64]| values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>();
    let compression = if packing == Packing::Plain { 1 } else { 8 };
    let offsets: Vec<u32> = tiles.iter().map(|place| place.0).collect();
    let lengths: Vec<u32> = tiles.iter().map(|place| place.1).collect();
    let mut tags: Vec<(u16, u16, u32, Vec<u8>)> = vec![
        (254, 4, 1, words(&[u32::from(reduced)])),
        (256, 4, 1, words(&[image.width])),
        (257, 4, 1, words(&[image.height])),
        (258, 3, 1, shorts(&[32])),
        (259, 3, 1, shorts(&[compression])),
        (262, 3, 1, shorts(&[1])),
        (277, 3, 1, shorts(&[1])),
        (322, 4, 1, words(&[tile])),
        (323, 4, 1, words(&[tile])),
        (324, 4, tiles.len() as u32, words(&offsets)),
        (325, 4, tiles.len() as u32, words(&lengths)),
        (339, 3, 1, shorts(&[3])),
    ];
    if !reduced {
        tags.push((33550, 12, 3, doubles(&[10.0, 10.0, 0.0])));
        tags.push((33922, 12, 6, doubles(&[0.0, 0.0, 0.0, 5e5, 4e6, 0.0])));
        tags.push((34735, 3, 12, shorts(&[1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32612])));
        tags.push((42113, 2, 6, b"-9999\0".to_vec()));
    }
    let mut directory = (tags.len() as u16).to_le_bytes().to_vec();
    for (tag, kind, count, mut value) in tags {
        if value.len() > 4 {
            let at = out.len() as u32;
            out.extend(&value);
            value = at.to_le_bytes().to_vec();
        }
        value.resize(4, 0);
        directory.extend(tag.to_le_bytes());
        directory.extend(kind.to_le_bytes());
        directory.extend(count.to_le_bytes());
        directory.extend(value);
    }
    directory.extend([0; 4]);
    directory
}
