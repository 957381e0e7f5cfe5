//! PNG as a height map: gray of 8 or 16 bits by a stated scale and offset, or colors by a stated encoding.
//!
//! The picture's own transparency (a gray value or an alpha channel) is no data. The meaning of colors differs from
//! maker to maker: without a stated [`HeightEncoding`] they are refused.
//!
//! Gray of 16 bits is written, with a world file beside it. Gray value 0 is no data, and stated as transparent; heights
//! take 1 to 65535. Whole meters that fit are kept; others are spread over all values and rounded to half a step.

use std::io::Cursor;

use png::{BitDepth, ColorType, Transformations};

use crate::companion::{projection_file_of, world_file_of};
use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition, any_size};
use crate::formats::height_encoding::HeightEncoding;
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::file_bands::FileBands;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, Samples};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "PNG",
    extensions: &[],
    shared_extensions: &["png"],
    recognition: Recognition::Content {
        matches: |bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n"),
        start: "the signature of a PNG file",
    },
    reader: read,
    windows: None,
    most_bytes: any_size,
    writer: Some(FormatWriter { extensions: &["png"], write }),
    windows_writer: None,
};

/// Deflate turns one byte into at most 1032; filters add one byte a row.
const EXPANSION: u64 = 1032;

/// Steps from the lowest to the highest height written: 65,534 gray values, less one for an offset on a whole step.
const STEPS: f64 = 65533.0;

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let mut decoder = png::Decoder::new(Cursor::new(file.bytes));
    let header = decoder.read_header_info().map_err(|error| FORMAT.undecodable(error))?;
    let (color, depth) = (header.color_type, header.bit_depth);
    check_pixels(color, depth)?;
    let claim = SizeClaim {
        expansion: EXPANSION,
        ..SizeClaim::new(header.width.into(), header.height.into(), (depth as u64 / 8).max(1))
    };
    let size = claim.check(file.bytes.len())?;
    let heights = PngHeights::new(file, color)?;
    // Four samples a pixel with alpha, and as much again for rows and the inflater.
    decoder.set_limits(png::Limits { bytes: size.x as usize * size.y as usize * 8 + (1 << 20) });
    decoder.set_transformations(Transformations::EXPAND);
    let pixels = PngPixels::read(decoder).map_err(|error| FORMAT.undecodable(error))?;
    let samples = match heights {
        PngHeights::Gray { scale, offset } => Samples::F32(pixels.gray()).scaled(scale, offset),
        PngHeights::Colors(encoding) => Samples::F64(pixels.heights(encoding)),
    };
    let raster = file.placed(Raster::new(size.x, samples), None, &["pgw", "pngw", "wld"])?;
    let bands = match color {
        ColorType::GrayscaleAlpha => FileBands { count: 2, mask: Some(2) },
        _ => FileBands::default(),
    };
    let raster = raster.with_bands(bands);
    Ok(Raster {
        driver: "PNG",
        data_type: if depth == BitDepth::Sixteen { "UInt16" } else { "Byte" },
        crs: file.crs()?,
        nodata: pixels.transparent_gray,
        ..raster
    })
}

enum PngHeights {
    /// Gray values: meters per value, and the height of value 0.
    Gray {
        scale: f64,
        offset: f64,
    },
    Colors(HeightEncoding),
}

impl PngHeights {
    fn new(file: &DemFile, color: ColorType) -> Result<Self, DemErrorKind> {
        let is_gray = matches!(color, ColorType::Grayscale | ColorType::GrayscaleAlpha);
        match (is_gray, file.hints.options.height_encoding) {
            (false, Some(encoding)) => Ok(Self::Colors(encoding)),
            (false, None) => Err(DemErrorKind::NoHeightEncoding),
            (true, Some(encoding)) => {
                let what = format!("gray values, where {encoding} is stated");
                Err(FORMAT.unsupported(what, "state height_scale (--height-scale) instead of the encoding"))
            }
            (true, None) => {
                let scale = file.height_scale()?.ok_or(DemErrorKind::NoHeightScale)?;
                Ok(Self::Gray { scale, offset: file.height_offset()? })
            }
        }
    }
}

/// Whether pixels of a kind are read; encoders may pack a tile of few heights into a palette.
fn check_pixels(color: ColorType, depth: BitDepth) -> Result<(), DemErrorKind> {
    let what = match (color, depth) {
        (ColorType::Indexed, _) | (_, BitDepth::Eight) => return Ok(()),
        (ColorType::Grayscale | ColorType::GrayscaleAlpha, BitDepth::Sixteen) => return Ok(()),
        (ColorType::Rgb | ColorType::Rgba, _) => "colors of 16 bits".into(),
        _ => format!("{} bits per gray value", depth as u8),
    };
    Err(FORMAT.unsupported(what, "give the elevation as 16-bit gray, or as a GeoTIFF"))
}

/// Decoded pixels: palettes as colors, transparency as alpha, two bytes a sample with the most significant first.
struct PngPixels {
    bytes: Vec<u8>,
    /// Bytes of a sample.
    sample: usize,
    /// Samples of a pixel.
    channels: usize,
    transparent_gray: Option<f64>,
}

impl PngPixels {
    fn read(decoder: png::Decoder<Cursor<&[u8]>>) -> Result<Self, png::DecodingError> {
        let mut reader = decoder.read_info()?;
        let is_gray = reader.info().color_type == ColorType::Grayscale;
        let transparent = reader.info().trns.as_deref().filter(|_| is_gray).map(number);
        let (color, depth) = reader.output_color_type();
        let mut bytes = vec![0; reader.output_buffer_size().ok_or(png::DecodingError::LimitsExceeded)?];
        reader.next_frame(&mut bytes)?;
        let sample = depth as usize / 8;
        Ok(Self { bytes, sample, channels: color.samples(), transparent_gray: transparent.map(f64::from) })
    }

    fn gray(&self) -> Vec<f32> {
        let pixels = self.bytes.chunks_exact(self.sample * self.channels);
        pixels
            .map(|pixel| {
                let (gray, alpha) = pixel.split_at(self.sample);
                let is_clear = self.channels == 2 && alpha.iter().all(|byte| *byte == 0);
                if is_clear { f32::NAN } else { number(gray) }
            })
            .collect()
    }

    fn heights(&self, encoding: HeightEncoding) -> Vec<f64> {
        let pixels = self.bytes.chunks_exact(self.channels);
        let height = |pixel: &[u8]| match *pixel {
            [_, _, _, 0] => f64::NAN,
            [red, green, blue, ..] => encoding.meters([red, green, blue]),
            _ => f64::NAN,
        };
        pixels.map(height).collect()
    }
}

/// A big-endian number of one or two bytes.
fn number(bytes: &[u8]) -> f32 {
    bytes.iter().fold(0.0, |number, byte| number * 256.0 + f32::from(*byte))
}

fn write(raster: &Raster, _name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let least = raster.samples.valid().fold(f64::INFINITY, f64::min);
    let greatest = raster.samples.valid().fold(f64::NEG_INFINITY, f64::max);
    if least > greatest {
        return Err(WriteError::Empty);
    }
    let are_whole = raster.samples.valid().all(|value| value.fract() == 0.0) && greatest - least <= STEPS;
    let scale = if are_whole { 1.0 } else { readable(((greatest - least) / STEPS).max(f64::MIN_POSITIVE)) };
    let offset = (least / scale).floor() * scale - scale;
    let gray = |value: f64| if value.is_nan() { 0 } else { ((value - offset) / scale).round() as u16 };
    let mut notes = vec![format!("read it with --height-scale {scale} --height-offset {offset}")];
    if !are_whole {
        notes.push(format!("heights are rounded to multiples of {scale} m"));
    }
    let pixels: Vec<u8> = raster.samples.iter().flat_map(|value| gray(value).to_be_bytes()).collect();
    let bytes =
        encode(raster.width, raster.height, &pixels).expect("memory takes a picture that is not empty");
    let companions = world_file_of(raster, "pgw").into_iter().chain(projection_file_of(raster)).collect();
    Ok(WrittenDem { companions, notes, ..WrittenDem::new(bytes, "uint16") })
}

/// The least number of two significant digits that is not below the value: a scale that can be typed.
fn readable(scale: f64) -> f64 {
    let power = scale.log10().floor() as i32 - 1;
    let digits = (scale / 10f64.powi(power)).ceil();
    // Parsed, so that the scale in the note is the scale in use.
    format!("{digits}e{power}").parse().unwrap_or(scale)
}

fn encode(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_filter(png::Filter::Up);
    encoder.set_trns(vec![0, 0]);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use crate::formats::height_encoding::HeightEncoding;
    use crate::hints::{DemHints, DemOptions};
    use crate::read::read;
    use image::ImageEncoder;

    fn picture(values: &[u16]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let raw: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
        image::codecs::png::PngEncoder::new(&mut bytes)
            .write_image(&raw, values.len() as u32, 1, image::ExtendedColorType::L16)
            .expect("memory");
        bytes
    }

    #[test]
    fn gray_becomes_meters_by_the_stated_scale() {
        let hints = DemHints::from(DemOptions {
            height_scale: Some(0.5),
            height_offset: Some(-100.0),
            cell: Some(30.0),
            ..DemOptions::default()
        });
        let raster = read("a.png", &picture(&[0, 65535]), &hints).expect("a picture");
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [-100.0, 32667.5]);
        // The south-west sample stands at the origin.
        assert_eq!(raster.map_from_grid.transform_point2(glam::DVec2::new(0.5, 0.5)), glam::DVec2::ZERO);
        assert!(raster.georeferenced);
    }

    #[test]
    fn a_picture_without_a_scale_is_refused_with_the_keys_that_give_it() {
        let error = read("a.png", &picture(&[1, 2]), &DemHints::default()).expect_err("refused").to_string();
        assert!(error.contains("height_scale") && error.contains("--height-scale"), "{error}");
    }

    #[test]
    fn colors_are_heights_by_the_stated_encoding_and_a_clear_pixel_none() {
        let mut bytes = Vec::new();
        image::codecs::png::PngEncoder::new(&mut bytes)
            .write_image(&[1, 134, 170, 255, 1, 134, 170, 0], 2, 1, image::ExtendedColorType::Rgba8)
            .expect("memory");
        let hints = |height_encoding| {
            DemHints::from(DemOptions { height_encoding, cell: Some(1.0), ..DemOptions::default() })
        };
        let tile = read("a.png", &bytes, &hints(Some(HeightEncoding::TerrainRgb))).expect("a tile");
        assert_eq!((tile.at(0, 0), tile.data_type), (1.0, "Byte"));
        assert!(tile.at(1, 0).is_nan());
        let refused = read("a.png", &bytes, &hints(None)).expect_err("refused").to_string();
        assert!(refused.contains("terrain-rgb") && refused.contains("terrarium"), "{refused}");
        let gray = read("a.png", &picture(&[1, 2]), &hints(Some(HeightEncoding::Terrarium)));
        assert!(gray.expect_err("gray").to_string().contains("gray values, where terrarium"));
    }

    #[test]
    fn a_picture_cut_anywhere_is_an_error() {
        let whole = picture(&[1, 2, 3, 4]);
        let hints = DemHints::from(DemOptions { height_scale: Some(1.0), ..DemOptions::default() });
        for end in 0..whole.len() - 12 {
            assert!(read("a.png", &whole[..end], &hints).is_err(), "{end}");
        }
    }
}
