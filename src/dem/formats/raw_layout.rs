//! The layout of a RAW file, as the caller states it.
//!
//! The statement is one text, the same on the command line and in a scene: `1201x1201:i16be`, where needed followed
//! by `:skip=512` (bytes before the first sample) and `:nodata=-9999`.

use std::fmt;
use std::str::FromStr;

use sandtable_base::bytes::ByteOrder;
use sandtable_raster::sample_type::{NumberKind, SampleType};

/// The layout of a RAW file: north row first, from the west.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawLayout {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) sample: SampleType,
    pub(super) order: ByteOrder,
    /// Bytes before the first sample.
    pub(super) skip: u64,
    pub(super) nodata: Option<f64>,
}

/// The text is not a layout of a RAW file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", Self::REMEDY)]
pub struct RawLayoutError;

impl RawLayoutError {
    /// How a layout is written.
    pub const REMEDY: &str = "write it as 1201x1201:i16be, where needed with :skip=BYTES and :nodata=VALUE; types are \
                              u8 to u64, i8 to i64, f16, f32 and f64, followed by le or be";
}

impl FromStr for RawLayout {
    type Err = RawLayoutError;

    fn from_str(text: &str) -> Result<Self, RawLayoutError> {
        let mut parts = text.split(':');
        let size = parts.next().and_then(|size| size.split_once(['x', 'X', '×']));
        let size = size.and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        let Some((width @ 1.., height @ 1..)) = size else { return Err(RawLayoutError) };
        let (sample, order) = parts.next().and_then(sample_and_order).ok_or(RawLayoutError)?;
        let mut layout = Self { width, height, sample, order, skip: 0, nodata: None };
        for part in parts {
            match part.split_once('=') {
                Some(("skip", bytes)) => layout.skip = bytes.parse().map_err(|_| RawLayoutError)?,
                Some(("nodata", value)) => layout.nodata = Some(value.parse().map_err(|_| RawLayoutError)?),
                _ => return Err(RawLayoutError),
            }
        }
        Ok(layout)
    }
}

impl fmt::Display for RawLayout {
    /// The text that [`FromStr`] reads.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.sample.kind() {
            NumberKind::Unsigned => 'u',
            NumberKind::Signed => 'i',
            NumberKind::Float => 'f',
        };
        let order = match self.order {
            ByteOrder::Little => "le",
            ByteOrder::Big => "be",
        };
        write!(out, "{}x{}:{kind}{}{order}", self.width, self.height, self.sample.bytes() * 8)?;
        if self.skip > 0 {
            write!(out, ":skip={}", self.skip)?;
        }
        self.nodata.map_or(Ok(()), |nodata| write!(out, ":nodata={nodata}"))
    }
}

/// `i16be` as a type and its byte order; single bytes need no order.
fn sample_and_order(text: &str) -> Option<(SampleType, ByteOrder)> {
    let lower = text.to_ascii_lowercase();
    let (name, order) = match (lower.strip_suffix("le"), lower.strip_suffix("be")) {
        (Some(name), _) => (name, Some(ByteOrder::Little)),
        (_, Some(name)) => (name, Some(ByteOrder::Big)),
        _ => (lower.as_str(), None),
    };
    let kind = match name.chars().next()? {
        'u' => NumberKind::Unsigned,
        'i' => NumberKind::Signed,
        'f' => NumberKind::Float,
        _ => return None,
    };
    let sample = SampleType::new(kind, name[1..].parse().ok()?)?;
    Some((sample, order.or((sample.bytes() == 1).then_some(ByteOrder::Little))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_statement_is_a_size_a_type_and_what_is_needed_besides() {
        let stated: RawLayout = "3x2:i16be:skip=4:nodata=-1".parse().expect("sound");
        assert_eq!((stated.width, stated.height, stated.skip, stated.nodata), (3, 2, 4, Some(-1.0)));
        assert_eq!((stated.sample, stated.order), (SampleType::I16, ByteOrder::Big));
        for text in ["3x2:i16be:skip=4:nodata=-1", "1x1:f64le", "70000x2:u8le:nodata=255"] {
            assert_eq!(text.parse::<RawLayout>().expect("sound").to_string(), text);
        }
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
            let error = wrong.parse::<RawLayout>().expect_err(wrong).to_string();
            assert!(error.contains("1201x1201:i16be"), "{error}");
        }
    }
}
