//! The pictures of a page: textures of models and ribbons, and what is draped over the ground.

use image::ExtendedColorType;
use image::ImageEncoder;
use image::codecs::jpeg::JpegEncoder;
use serde_json::{Value, json};

use crate::page::container::PageSections;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_files::png::encode_png;

/// The side from which an opaque picture is stored as JPEG: below it PNG is as small, and exact.
const JPEG_FROM_PX: u32 = 512;

/// The quality of those, of 100: higher doubles the size for what nobody sees.
const JPEG_QUALITY: u8 = 88;

/// The longest side of a picture in a page; larger ones are reduced.
const LONGEST_PX: u32 = 4096;

/// Adds a picture; `null` for an empty one.
pub fn picture(sections: &mut PageSections, pixels: &Pixels) -> Value {
    if pixels.data().is_empty() {
        return Value::Null;
    }
    let pixels = reduced(pixels);
    let (width, height) = (pixels.width(), pixels.height());
    let is_opaque = pixels.data().iter().all(|color| color.0[3] == 255);
    let (kind, bytes) = if is_opaque && width.min(height) >= JPEG_FROM_PX {
        ("image/jpeg", jpeg(&pixels))
    } else {
        ("image/png", encode_png(&with_seen_colors(pixels)))
    };
    let section = sections.add_packed(&bytes);
    json!({"section": section, "type": kind, "width": width, "height": height, "opaque": is_opaque})
}

fn jpeg(pixels: &Pixels) -> Vec<u8> {
    let rgb: Vec<u8> = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY);
    encoder
        .write_image(&rgb, pixels.width(), pixels.height(), ExtendedColorType::Rgb8)
        .expect("memory takes all bytes, and there are as many as the size says");
    bytes
}

/// Half the size as often as needed, by the mean of four pixels in linear light weighted by alpha.
fn reduced(pixels: &Pixels) -> Pixels {
    let mut pixels = pixels.clone();
    while pixels.width().max(pixels.height()) > LONGEST_PX {
        let [width, height] = [pixels.width(), pixels.height()].map(|side| side.div_ceil(2));
        let last = [pixels.width() - 1, pixels.height() - 1];
        pixels = Pixels::from_fn(width, height, |x, y| {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(east, south)| pixels.at((2 * x + east).min(last[0]), (2 * y + south).min(last[1])));
            let alpha: f32 = four.iter().map(|color| color.alpha()).sum();
            let light: glam::Vec3 = four.iter().map(|color| color.linear() * color.alpha()).sum();
            let Srgba([red, green, blue, _]) = Srgba::from_linear(light / alpha.max(1e-6));
            Srgba([red, green, blue, (alpha * 255.0 / 4.0).round() as u8])
        });
    }
    pixels
}

/// Pixels that are not seen take the mean color of those that are: a filter mixes them in at the borders.
fn with_seen_colors(mut pixels: Pixels) -> Pixels {
    let seen = pixels.data().iter().filter(|color| color.0[3] > 0);
    let (sum, count) =
        seen.fold((glam::Vec3::ZERO, 0), |(sum, count), color| (sum + color.linear(), count + 1));
    let Srgba([red, green, blue, _]) = Srgba::from_linear(sum / (count.max(1) as f32));
    for color in pixels.data_mut().iter_mut().filter(|color| color.0[3] == 0) {
        *color = Srgba([red, green, blue, 0]);
    }
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unseen_pixels_take_the_color_of_those_that_are_seen() {
        let [leaf, hole] = [Srgba([20, 120, 40, 255]), Srgba([255, 0, 255, 0])];
        let pixels = Pixels::from_fn(4, 4, |x, _| if x < 2 { leaf } else { hole });
        let filled = with_seen_colors(pixels);
        assert_eq!((filled.at(0, 0), filled.at(3, 3)), (leaf, Srgba([20, 120, 40, 0])));
    }

    #[test]
    fn a_picture_too_large_for_a_texture_is_halved_until_it_fits() {
        let reduced = reduced(&Pixels::filled(9001, 3, Srgba::opaque(9, 99, 199)));
        assert_eq!(
            (reduced.width(), reduced.height(), reduced.at(2250, 0)),
            (2251, 1, Srgba::opaque(9, 99, 199))
        );
    }
}
