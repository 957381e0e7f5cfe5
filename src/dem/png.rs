//! Grey PNG as a height map: 8 or 16 bits per value, metres by a stated scale and offset.
//!
//! The picture's own transparency (a grey value that stands for "nothing", or an alpha channel) is no data.
//! Colour pictures are refused: what their channels mean differs from maker to maker.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, Limits};

use crate::dem::fault::{Fault, bytes_at, check_size};
use crate::dem::georef;
use crate::dem::raster::{Raster, Samples};
use crate::dem::read::Source;

const FORMAT: &str = "PNG";

/// Deflate turns one byte into at most 1032; filters add one byte a row.
const EXPANSION: u64 = 1032;

/// Whether the content starts as PNG does.
pub(crate) fn recognises(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

/// Reads a picture, its place from a world file or the hinted cell.
pub(crate) fn read(source: &Source) -> Result<Raster, Fault> {
    let header = Header::read(source.bytes)?;
    let count = check_size(
        (u64::from(header.width), u64::from(header.height)),
        u64::from(header.bits / 8),
        (source.bytes.len(), EXPANSION),
    )?;
    let (scale, offset) = heights(source)?;
    let values = decode(source.bytes, count)?;
    let place = georef::beside(source, header.height, &["pgw", "pngw", "wld"])?;
    Ok(Raster {
        driver: "PNG",
        data_type: if header.bits == 8 { "Byte" } else { "UInt16" },
        width: header.width,
        height: header.height,
        samples: Samples::F32(values).scaled(scale, offset),
        metres_per_z: 1.0,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs: source.crs_beside()?,
        nodata: header.transparent,
        vertical_datum: None,
    })
}

fn heights(source: &Source) -> Result<(f64, f64), Fault> {
    let scale = source.hints.png_height_scale.ok_or(Fault::NoHeightScale)?;
    let offset = source.hints.png_height_offset.unwrap_or(0.0);
    if !(scale.is_finite() && scale != 0.0) {
        return Err(Fault::Hint {
            what: "height_scale",
            value: scale,
            wanted: "a finite number other than 0",
        });
    }
    if !offset.is_finite() {
        return Err(Fault::Hint { what: "height_offset", value: offset, wanted: "a finite number" });
    }
    Ok((scale, offset))
}

struct Header {
    width: u32,
    height: u32,
    bits: u8,
    transparent: Option<f64>,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let cut = || Fault::broken(FORMAT, "it ends inside its header");
        let long = |at: usize| bytes_at(bytes, at).map(u32::from_be_bytes).ok_or_else(cut);
        let [bits, colour] = bytes_at(bytes, 24).ok_or_else(cut)?;
        if bytes.get(12..16) != Some(b"IHDR") {
            return Err(Fault::broken(FORMAT, "its first chunk is not IHDR"));
        }
        let what = match (colour, bits) {
            (0 | 4, 8 | 16) => None,
            (0, 1 | 2 | 4) => Some(format!("{bits} bits per grey value")),
            (2 | 6, _) => Some("colours".into()),
            (3, _) => Some("a palette".into()),
            _ => {
                return Err(Fault::broken(
                    FORMAT,
                    format!("colour type {colour} with {bits} bits does not exist"),
                ));
            }
        };
        if let Some(what) = what {
            return Err(Fault::Unsupported {
                format: FORMAT,
                what,
                remedy: "give the elevation as 16-bit grey, or as a GeoTIFF",
            });
        }
        Ok(Self { width: long(16)?, height: long(20)?, bits, transparent: transparent(bytes) })
    }
}

/// The grey value of a tRNS chunk, which stands before the picture data.
fn transparent(bytes: &[u8]) -> Option<f64> {
    let mut at = 8usize;
    loop {
        let length = u32::from_be_bytes(bytes_at(bytes, at)?) as usize;
        match bytes.get(at + 4..at + 8)? {
            b"tRNS" if length == 2 => {
                return bytes_at(bytes, at + 8).map(|grey| f64::from(u16::from_be_bytes(grey)));
            }
            b"IDAT" | b"tRNS" => return None,
            _ => at = at.checked_add(length)?.checked_add(12)?,
        }
    }
}

fn decode(bytes: &[u8], count: usize) -> Result<Vec<f32>, Fault> {
    let broken = |error: image::ImageError| Fault::broken(FORMAT, error.to_string());
    let mut decoder = image::codecs::png::PngDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let mut limits = Limits::default();
    // Four bytes a sample with alpha, and as much again for rows and the inflater.
    limits.max_alloc = Some(count as u64 * 8 + (1 << 20));
    decoder.set_limits(limits).map_err(broken)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let values: Vec<f32> = match picture {
        DynamicImage::ImageLuma8(grey) => grey.as_raw().iter().map(|&v| f32::from(v)).collect(),
        DynamicImage::ImageLuma16(grey) => grey.as_raw().iter().map(|&v| f32::from(v)).collect(),
        DynamicImage::ImageLumaA8(both) => {
            both.pixels().map(|p| if p[1] == 0 { f32::NAN } else { f32::from(p[0]) }).collect()
        }
        DynamicImage::ImageLumaA16(both) => {
            both.pixels().map(|p| if p[1] == 0 { f32::NAN } else { f32::from(p[0]) }).collect()
        }
        other => {
            return Err(Fault::broken(FORMAT, format!("it decodes to {:?}, not to grey", other.color())));
        }
    };
    if values.len() != count {
        return Err(Fault::broken(FORMAT, format!("it decodes to {} of {count} values", values.len())));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use crate::dem::read::{Hints, read};
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
    fn grey_becomes_metres_by_the_stated_scale() {
        let hints = Hints {
            png_height_scale: Some(0.5),
            png_height_offset: Some(-100.0),
            cell: Some(30.0),
            ..Hints::default()
        };
        let raster = read("a.png", &picture(&[0, 65535]), &hints).expect("a picture");
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [-100.0, 32667.5]);
        // The south-west sample stands at the origin.
        assert_eq!(raster.map_from_grid.transform_point2(glam::DVec2::new(0.5, 0.5)), glam::DVec2::ZERO);
        assert!(raster.georeferenced);
    }

    #[test]
    fn a_picture_without_a_scale_is_refused_with_the_keys_that_give_it() {
        let error = read("a.png", &picture(&[1, 2]), &Hints::default()).expect_err("refused").to_string();
        assert!(error.contains("height_scale") && error.contains("--height-scale"), "{error}");
    }

    #[test]
    fn a_picture_cut_anywhere_is_an_error() {
        let whole = picture(&[1, 2, 3, 4]);
        let hints = Hints { png_height_scale: Some(1.0), ..Hints::default() };
        for end in 0..whole.len() - 12 {
            assert!(read("a.png", &whole[..end], &hints).is_err(), "{end}");
        }
    }
}
