//! Pictures as PNG files, with notes on their print.

use rayon::prelude::*;

use crate::png_strips::{PngChannels, packed_pixels};
use sandtable_draw::pixels::Pixels;

/// What every file begins with.
const SIGNATURE: &[u8; 8] = b"\x89PNG\r\n\x1a\n";

/// The most bytes of a chunk.
const MOST_CHUNK: usize = (u32::MAX >> 1) as usize;

/// The metadata of a PNG file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PngNotes {
    /// Pixels per inch of its print, for programs that print it at its size.
    pub dpi: Option<f64>,
    /// Keywords, of 1 to 79 Latin letters, with their texts.
    pub texts: Vec<(&'static str, String)>,
}

/// The bytes of a PNG file without notes; see [`encode_png_with`].
pub fn encode_png(pixels: &Pixels) -> Vec<u8> {
    encode_png_with(pixels, &PngNotes::default())
}

/// The bytes of a PNG file, without alpha where all pixels are opaque, with notes in chunks `pHYs` and `iTXt` (PNG 3rd edition,
/// sections 11.3.3 and 11.3.4). `pixels` must not be empty. Spread over all threads; the same for any number of them.
pub fn encode_png_with(pixels: &Pixels, notes: &PngNotes) -> Vec<u8> {
    /// Eight bits a channel; the one packing, filtering and order of rows there is but for interlaced ones.
    const DEPTH: u8 = 8;
    let channels = PngChannels::of(pixels);
    let color_type = match channels {
        PngChannels::Opaque => 2,
        PngChannels::WithAlpha => 6,
    };
    let packed = packed_pixels(pixels, channels);
    let mut png = Vec::with_capacity(packed.len() + packed.len() / 8);
    png.extend(SIGNATURE);
    let size = [pixels.width().to_be_bytes(), pixels.height().to_be_bytes()].concat();
    add_chunk(&mut png, b"IHDR", &[&size[..], &[DEPTH, color_type, 0, 0, 0]].concat());
    if let Some(dpi) = notes.dpi {
        let per_meter = (libm::round(dpi / 0.0254).clamp(1.0, 2e9) as u32).to_be_bytes();
        add_chunk(&mut png, b"pHYs", &[&per_meter[..], &per_meter, &[1]].concat());
    }
    for (key, text) in &notes.texts {
        // Neither packed, nor in a language, nor with a keyword in one.
        let text = text.replace('\0', " ");
        add_chunk(&mut png, b"iTXt", &[key.as_bytes(), &[0; 5], text.as_bytes()].concat());
    }
    packed.chunks(MOST_CHUNK).for_each(|data| add_chunk(&mut png, b"IDAT", data));
    add_chunk(&mut png, b"IEND", &[]);
    png
}

fn add_chunk(png: &mut Vec<u8>, name: &[u8; 4], data: &[u8]) {
    png.extend((data.len() as u32).to_be_bytes());
    png.extend(name);
    png.extend(data);
    png.extend(check(name, data).to_be_bytes());
}

/// The CRC of a chunk, its parts looked at on all threads.
fn check(name: &[u8; 4], data: &[u8]) -> u32 {
    /// Bytes of a part.
    const PART: usize = 1 << 20;
    let of = |bytes: &[u8]| {
        let mut check = flate2::Crc::new();
        check.update(bytes);
        check
    };
    let mut check = of(name);
    let parts: Vec<flate2::Crc> = data.par_chunks(PART).map(of).collect();
    parts.iter().for_each(|part| check.combine(part));
    check.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;

    #[test]
    fn a_picture_is_read_back_with_its_resolution_and_its_texts() {
        let pixels = Pixels::filled(5, 3, Srgba::opaque(1, 2, 3));
        let texts = vec![("Title", "Höhe\0 1".to_owned())];
        let bytes = encode_png_with(&pixels, &PngNotes { dpi: Some(300.0), texts });
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().expect("a sound head");
        let print = reader.info().pixel_dims.expect("a resolution");
        assert_eq!((print.xppu, print.yppu, print.unit), (11_811, 11_811, png::Unit::Meter));
        let text = &reader.info().utf8_text[0];
        assert_eq!((text.keyword.as_str(), text.get_text().expect("plain").as_str()), ("Title", "Höhe  1"));
        let mut data = vec![0; 5 * 3 * 3];
        reader.next_frame(&mut data).expect("sound");
        assert_eq!(data[..3], [1, 2, 3]);
    }
    /// Pixels of a picture as it is drawn: plain parts, slopes and grain.
    fn drawn(width: u32, height: u32, alpha: u8) -> Pixels {
        Pixels::from_fn(width, height, |x, y| {
            let grain = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)).count_ones();
            let slope = (x / 3 + y / 2) as u8;
            match (x / 40 + y / 30) % 3 {
                0 => Srgba([247, 247, 244, 255]),
                1 => Srgba([slope, slope.wrapping_add(20), grain as u8, 255]),
                _ => Srgba([slope.wrapping_add(grain as u8), 90, 40, alpha]),
            }
        })
    }

    fn noise(width: u32, height: u32) -> Pixels {
        Pixels::from_fn(width, height, |x, y| {
            let mixed = (u64::from(x) << 32 | u64::from(y)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            Srgba(
                (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9).to_be_bytes()[..4]
                    .try_into()
                    .expect("4"),
            )
        })
    }

    #[test]
    fn strips_on_any_number_of_threads_have_the_bytes_of_one_stream() {
        let pictures = [
            drawn(1, 1, 255),
            drawn(1, 700, 7),
            drawn(640, 480, 255),
            drawn(641, 479, 128),
            drawn(200_000, 3, 255),
            Pixels::filled(900, 600, Srgba::WHITE),
            noise(500, 300),
        ];
        for pixels in pictures {
            let expected = of_image(&pixels);
            for threads in [1, 2, 3, 16] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                let own = pool.install(|| encode_png(&pixels));
                assert!(own == expected, "{}×{} on {threads}", pixels.width(), pixels.height());
            }
        }
    }

    /// The file that the crate `image` writes.
    fn of_image(pixels: &Pixels) -> Vec<u8> {
        let mut png = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        let is_opaque = pixels.data().iter().all(|color| color.0[3] == 255);
        let opaque = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]);
        let (bytes, color) = match is_opaque {
            true => (opaque.collect(), image::ExtendedColorType::Rgb8),
            false => (pixels.bytes().to_vec(), image::ExtendedColorType::Rgba8),
        };
        image::ImageEncoder::write_image(encoder, &bytes, pixels.width(), pixels.height(), color)
            .expect("memory");
        png
    }
}
