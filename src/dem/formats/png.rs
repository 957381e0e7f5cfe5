//! Gray PNG as a height map: 8 or 16 bits per value, meters by a stated scale and offset.
//!
//! The picture's own transparency (a gray value that stands for "nothing", or an alpha channel) is no data.
//! What colors mean differs from maker to maker: they are heights by a stated [`HeightEncoding`], or else refused.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, Limits};

use crate::dem::error::{DemErrorKind, bytes_at, check_size};
use crate::dem::formats::rgb_png::HeightEncoding;
use crate::dem::georef;
use crate::dem::raster::{Raster, Samples};
use crate::dem::read::DemFile;

const FORMAT: &str = "PNG";

/// Deflate turns one byte into at most 1032; filters add one byte a row.
const EXPANSION: u64 = 1032;

/// Whether the content starts as PNG does.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

/// Reads a picture, its place from a world file or the hinted cell.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let header = PngHeader::read(source.bytes)?;
    let count = check_size(
        (u64::from(header.width), u64::from(header.height)),
        u64::from(header.bits / 8).max(1),
        (source.bytes.len(), EXPANSION),
    )?;
    let samples = match (header.is_colored, source.hints.height_encoding) {
        (true, Some(encoding)) => Samples::F64(decode_colors(source.bytes, count, encoding)?),
        (true, None) => return Err(DemErrorKind::NoHeightEncoding),
        (false, Some(encoding)) => {
            return Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what: format!("gray values, where {encoding} is stated"),
                remedy: "state height_scale (--height-scale) instead of the encoding",
            });
        }
        (false, None) => {
            let (scale, offset) = heights(source)?;
            Samples::F32(decode(source.bytes, count)?).scaled(scale, offset)
        }
    };
    let place = georef::beside(source, header.height, &["pgw", "pngw", "wld"])?;
    Ok(Raster {
        driver: "PNG",
        data_type: if header.bits == 8 { "Byte" } else { "UInt16" },
        width: header.width,
        height: header.height,
        samples,
        meters_per_z: 1.0,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs: source.crs_beside()?,
        nodata: header.transparent,
        vertical_datum: None,
    })
}

/// Meters per gray value, and the height of value 0.
fn heights(source: &DemFile) -> Result<(f64, f64), DemErrorKind> {
    Ok((source.height_scale()?.ok_or(DemErrorKind::NoHeightScale)?, source.height_offset()?))
}

struct PngHeader {
    width: u32,
    height: u32,
    bits: u8,
    is_colored: bool,
    transparent: Option<f64>,
}

impl PngHeader {
    fn read(bytes: &[u8]) -> Result<Self, DemErrorKind> {
        let cut = || DemErrorKind::broken(FORMAT, "it ends inside its header");
        let long = |at: usize| bytes_at(bytes, at).map(u32::from_be_bytes).ok_or_else(cut);
        let [bits, color] = bytes_at(bytes, 24).ok_or_else(cut)?;
        if bytes.get(12..16) != Some(b"IHDR") {
            return Err(DemErrorKind::broken(FORMAT, "its first chunk is not IHDR"));
        }
        let what = match (color, bits) {
            (0 | 4, 8 | 16) | (2 | 6, 8) => None,
            // Encoders may pack a tile of few heights.
            (3, 1 | 2 | 4 | 8) => None,
            (0, 1 | 2 | 4) => Some(format!("{bits} bits per gray value")),
            (2 | 6, 16) => Some("colors of 16 bits".into()),
            _ => {
                return Err(DemErrorKind::broken(
                    FORMAT,
                    format!("color type {color} with {bits} bits does not exist"),
                ));
            }
        };
        if let Some(what) = what {
            return Err(DemErrorKind::Unsupported {
                format: FORMAT,
                what,
                remedy: "give the elevation as 16-bit gray, or as a GeoTIFF",
            });
        }
        let is_colored = matches!(color, 2 | 3 | 6);
        Ok(Self { width: long(16)?, height: long(20)?, bits, is_colored, transparent: transparent(bytes) })
    }
}

/// The gray value of a tRNS chunk, which stands before the picture data.
fn transparent(bytes: &[u8]) -> Option<f64> {
    let mut at = 8usize;
    loop {
        let length = u32::from_be_bytes(bytes_at(bytes, at)?) as usize;
        match bytes.get(at + 4..at + 8)? {
            b"tRNS" if length == 2 => {
                return bytes_at(bytes, at + 8).map(|gray| f64::from(u16::from_be_bytes(gray)));
            }
            b"IDAT" | b"tRNS" => return None,
            _ => at = at.checked_add(length)?.checked_add(12)?,
        }
    }
}

/// The pixels, with no more memory than so many need.
fn pixels(bytes: &[u8], count: usize) -> Result<DynamicImage, DemErrorKind> {
    let broken = |error: image::ImageError| DemErrorKind::broken(FORMAT, error.to_string());
    let mut decoder = image::codecs::png::PngDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let mut limits = Limits::default();
    // Four bytes a sample with alpha, and as much again for rows and the inflater.
    limits.max_alloc = Some(count as u64 * 8 + (1 << 20));
    decoder.set_limits(limits).map_err(broken)?;
    DynamicImage::from_decoder(decoder).map_err(broken)
}

fn decode_colors(bytes: &[u8], count: usize, encoding: HeightEncoding) -> Result<Vec<f64>, DemErrorKind> {
    let values: Vec<f64> = match pixels(bytes, count)? {
        DynamicImage::ImageRgb8(picture) => picture.pixels().map(|pixel| encoding.meters(pixel.0)).collect(),
        DynamicImage::ImageRgba8(picture) => {
            let meters = |[red, green, blue, alpha]: [u8; 4]| match alpha {
                0 => f64::NAN,
                _ => encoding.meters([red, green, blue]),
            };
            picture.pixels().map(|pixel| meters(pixel.0)).collect()
        }
        other => {
            return Err(DemErrorKind::broken(
                FORMAT,
                format!("it decodes to {:?}, not to colors", other.color()),
            ));
        }
    };
    if values.len() != count {
        return Err(DemErrorKind::broken(
            FORMAT,
            format!("it decodes to {} of {count} values", values.len()),
        ));
    }
    Ok(values)
}

fn decode(bytes: &[u8], count: usize) -> Result<Vec<f32>, DemErrorKind> {
    let values: Vec<f32> = match pixels(bytes, count)? {
        DynamicImage::ImageLuma8(gray) => gray.as_raw().iter().map(|&v| f32::from(v)).collect(),
        DynamicImage::ImageLuma16(gray) => gray.as_raw().iter().map(|&v| f32::from(v)).collect(),
        DynamicImage::ImageLumaA8(both) => {
            both.pixels().map(|p| if p[1] == 0 { f32::NAN } else { f32::from(p[0]) }).collect()
        }
        DynamicImage::ImageLumaA16(both) => {
            both.pixels().map(|p| if p[1] == 0 { f32::NAN } else { f32::from(p[0]) }).collect()
        }
        other => {
            return Err(DemErrorKind::broken(
                FORMAT,
                format!("it decodes to {:?}, not to gray", other.color()),
            ));
        }
    };
    if values.len() != count {
        return Err(DemErrorKind::broken(
            FORMAT,
            format!("it decodes to {} of {count} values", values.len()),
        ));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use crate::dem::formats::rgb_png::HeightEncoding;
    use crate::dem::read::{DemHints, read};
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
        let hints = DemHints {
            png_height_scale: Some(0.5),
            png_height_offset: Some(-100.0),
            cell: Some(30.0),
            ..DemHints::default()
        };
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
        let hints = |height_encoding| DemHints { height_encoding, cell: Some(1.0), ..DemHints::default() };
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
        let hints = DemHints { png_height_scale: Some(1.0), ..DemHints::default() };
        for end in 0..whole.len() - 12 {
            assert!(read("a.png", &whole[..end], &hints).is_err(), "{end}");
        }
    }
}
