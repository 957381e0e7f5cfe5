//! Pictures as PNG files, with notes on their print.

use image::{ExtendedColorType, ImageEncoder};

use sandtable_draw::pixels::Pixels;

/// The metadata of a PNG file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PngNotes {
    /// Pixels per inch of its print, for programs that print it at its size.
    pub dpi: Option<f64>,
    /// Keywords, of 1 to 79 Latin letters, with their texts.
    pub texts: Vec<(&'static str, String)>,
}

/// [`encode_png`] with notes in chunks `pHYs` and `iTXt` (PNG 3rd edition, sections 11.3.3 and 11.3.4).
pub fn encode_png_with(pixels: &Pixels, notes: &PngNotes) -> Vec<u8> {
    /// The signature, and the chunk IHDR with its length, name and check.
    const HEAD: usize = 8 + 25;
    let mut png = encode_png(pixels);
    let resolution = notes.dpi.map(|dpi| {
        let per_meter = (libm::round(dpi / 0.0254).clamp(1.0, 2e9) as u32).to_be_bytes();
        png_chunk(b"pHYs", &[&per_meter[..], &per_meter, &[1]].concat())
    });
    // Neither packed, nor in a language, nor with a keyword in one.
    let text = |(key, text): &(&str, String)| {
        png_chunk(b"iTXt", &[key.as_bytes(), &[0; 5], text.replace('\0', " ").as_bytes()].concat())
    };
    let chunks: Vec<u8> = resolution.into_iter().chain(notes.texts.iter().map(text)).flatten().collect();
    png.splice(HEAD..HEAD, chunks);
    png
}

fn png_chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut check = flate2::Crc::new();
    check.update(name);
    check.update(data);
    [&(data.len() as u32).to_be_bytes()[..], name, data, &check.sum().to_be_bytes()].concat()
}

/// The bytes of a PNG file, without alpha where all pixels are opaque. `pixels` must not be empty.
pub fn encode_png(pixels: &Pixels) -> Vec<u8> {
    let mut png = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    let (width, height) = (pixels.width(), pixels.height());
    let written = if pixels.data().iter().all(|color| color.0[3] == 255) {
        let mut rgb = vec![0; pixels.data().len() * 3];
        for (channels, color) in rgb.chunks_exact_mut(3).zip(pixels.data()) {
            channels.copy_from_slice(&color.0[..3]);
        }
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)
    } else {
        encoder.write_image(pixels.bytes(), width, height, ExtendedColorType::Rgba8)
    };
    written.expect("memory takes all bytes, and there are as many as the size says");
    png
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
}
