//! RAW: samples without a header, whose size and type the caller states.
//!
//! The statement is one text, the same on the command line and in a scene: `1201x1201:i16be`, where needed followed
//! by `:skip=512` (bytes before the first sample) and `:nodata=-9999`.

use std::str::FromStr;

use crate::dem::error::DemErrorKind;
use crate::dem::formats::plain::{ByteOrder, Number, SampleLayout};
use crate::dem::georef;
use crate::dem::raster::Raster;
use crate::dem::read::DemFile;

const FORMAT: &str = "RAW file";

/// What a RAW file holds: north row first, from the west.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawLayout {
    width: u32,
    height: u32,
    number: Number,
    order: ByteOrder,
    skip: u64,
    nodata: Option<f64>,
}

impl FromStr for RawLayout {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const FORM: &str = "write it as 1201x1201:i16be, where needed with :skip=BYTES and :nodata=VALUE; types are \
                            u8, i8, u16, i16, u32, i32, f32 and f64, followed by le or be";
        let mut parts = text.split(':');
        let size = parts.next().and_then(|size| size.split_once(['x', 'X', '×']));
        let size = size.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        let (Some((width @ 1.., height @ 1..)), Some(kind)) = (size, parts.next()) else {
            return Err(FORM.into());
        };
        let (number, order) = kind_of(kind).ok_or(FORM)?;
        let mut layout = Self { width, height, number, order, skip: 0, nodata: None };
        for part in parts {
            match part.split_once('=') {
                Some(("skip", bytes)) => layout.skip = bytes.parse().map_err(|_| FORM)?,
                Some(("nodata", value)) => layout.nodata = Some(value.parse().map_err(|_| FORM)?),
                _ => return Err(FORM.into()),
            }
        }
        Ok(layout)
    }
}

/// `i16be` as a number and its byte order; single bytes need no order.
fn kind_of(text: &str) -> Option<(Number, ByteOrder)> {
    let lower = text.to_ascii_lowercase();
    let (name, order) = match (lower.strip_suffix("le"), lower.strip_suffix("be")) {
        (Some(name), _) => (name, Some(ByteOrder::Little)),
        (_, Some(name)) => (name, Some(ByteOrder::Big)),
        _ => (lower.as_str(), None),
    };
    let number = match name {
        "u8" => Number::U8,
        "i8" => Number::I8,
        "u16" => Number::U16,
        "i16" => Number::I16,
        "u32" => Number::U32,
        "i32" => Number::I32,
        "f32" => Number::F32,
        "f64" => Number::F64,
        _ => return None,
    };
    if number.bytes() == 1 { Some((number, ByteOrder::Little)) } else { Some((number, order?)) }
}

/// Reads the file as the caller says it is laid out. Heights are the samples, or what a stated scale and offset make
/// of them.
pub(crate) fn read(source: &DemFile, raw: &RawLayout) -> Result<Raster, DemErrorKind> {
    let scale = source.height_scale()?.unwrap_or(1.0);
    let offset = source.height_offset()?;
    let size = (u64::from(raw.width), u64::from(raw.height));
    let layout = SampleLayout::dense(size, raw.number, raw.order, raw.skip);
    let (width, height, samples) = layout.read(FORMAT, source.bytes, raw.nodata)?;
    let place = georef::beside(source, height, &["rww", "wld"])?;
    Ok(Raster {
        driver: "RAW",
        data_type: raw.number.gdal_name(),
        width,
        height,
        samples: samples.scaled(scale, offset),
        meters_per_z: 1.0,
        map_from_grid: place.map_from_grid,
        georeferenced: place.stated,
        crs: source.crs_beside()?,
        nodata: raw.nodata,
        vertical_datum: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

    #[test]
    fn the_statement_is_a_size_a_type_and_what_is_needed_besides() {
        let stated: RawLayout = "3x2:i16be:skip=4:nodata=-1".parse().expect("sound");
        assert_eq!((stated.width, stated.height, stated.skip, stated.nodata), (3, 2, 4, Some(-1.0)));
        assert_eq!((stated.number, stated.order), (Number::I16, ByteOrder::Big));
        assert!("3x2:u8".parse::<RawLayout>().is_ok());
        for wrong in [
            "",
            "3x2",
            "3:u8",
            "0x2:u8",
            "3x2:i16",
            "3x2:i17le",
            "3x2:u8:skip",
            "3x2:u8:skip=-1",
            "3x2:u8:a=1",
        ] {
            let error = wrong.parse::<RawLayout>().expect_err(wrong);
            assert!(error.contains("1201x1201:i16be"), "{error}");
        }
    }

    #[test]
    fn samples_become_meters_by_a_stated_scale() {
        let hints = DemHints {
            raw: "2x1:u16le:skip=1".parse().ok(),
            png_height_scale: Some(0.5),
            png_height_offset: Some(-10.0),
            cell: Some(30.0),
            ..DemHints::default()
        };
        let raster = read("a.r16", &[9, 2, 0, 0, 1], &hints).expect("as stated");
        assert_eq!([raster.at(0, 0), raster.at(1, 0)], [-9.0, 118.0]);
        assert_eq!(raster.spacing().x, 30.0);
        let short = read("a.r16", &[9, 2, 0, 0], &hints).expect_err("too short").to_string();
        assert!(short.contains("2 x 1"), "{short}");
    }
}
