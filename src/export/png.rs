//! Pixels as PNG files.

use image::{ExtendedColorType, ImageEncoder};

use crate::draw::pixels::Pixels;

/// The bytes of a PNG file, without alpha where all pixels are opaque. `pixels` must not be empty.
pub fn encode(pixels: &Pixels) -> Vec<u8> {
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    let (width, height) = (pixels.width(), pixels.height());
    let written = if pixels.data().iter().all(|color| color.0[3] == 255) {
        let rgb: Vec<u8> =
            pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)
    } else {
        encoder.write_image(pixels.bytes(), width, height, ExtendedColorType::Rgba8)
    };
    written.expect("memory takes all bytes, and there are as many as the size says");
    png
}
