//! ESRI ASCII grid (`.asc`): a few `key value` lines, then the samples as text, north row first.
//!
//! Read as liberally as it is written: keys in any order and case, tabs and CRLF, `xllcenter` for
//! `xllcorner`, `dx`/`dy` for `cellsize`, line breaks anywhere, a decimal comma. The number of samples must
//! be right: a wrong `ncols` would shear the terrain without a word.

use glam::DVec2;

use crate::dem::error::{DemErrorKind, check_size};
use crate::dem::raster::{Raster, Samples, north_up};
use crate::dem::read::DemFile;

const FORMAT: &str = "ESRI ASCII grid";

/// What stands for no data where the header does not say, by Esri's definition of the format.
const DEFAULT_NODATA: f64 = -9999.0;

const KEYS: [&str; 10] = [
    "ncols",
    "nrows",
    "xllcorner",
    "yllcorner",
    "xllcenter",
    "yllcenter",
    "cellsize",
    "dx",
    "dy",
    "nodata_value",
];

/// Whether the content starts with a key of the header.
pub(crate) fn recognizes(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(64)];
    let text =
        String::from_utf8_lossy(start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start)).to_ascii_lowercase();
    text.split_ascii_whitespace().next().is_some_and(|word| KEYS.contains(&word))
}

/// Reads a grid; its coordinate system comes from a `.prj` companion.
pub(crate) fn read(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = source.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(source.bytes);
    let mut words = TextWords::new(bytes);
    let header = AsciiHeader::read(&mut words)?;
    let (width, height) = (header.size("ncols")?, header.size("nrows")?);
    // Every sample needs a digit, and all but the last a blank.
    let room = words.rest().len();
    let count = check_size((width, height), 2, (room + 1, 1))?;
    let cell = header.cell()?;
    let corner = header.south_west(cell)?;
    let nodata = header.get("nodata_value");
    let AsciiSamples { values, replaced, whole } =
        samples(&mut words, count, nodata.unwrap_or(DEFAULT_NODATA))?;
    Ok(Raster {
        driver: "AAIGrid",
        data_type: if whole { "Int32" } else { "Float32" },
        width: width as u32,
        height: height as u32,
        samples: Samples::F32(values),
        meters_per_z: 1.0,
        map_from_grid: north_up(DVec2::new(corner.x, corner.y + height as f64 * cell.y), cell),
        georeferenced: true,
        crs: source.crs_beside()?,
        nodata: nodata.or(replaced.then_some(DEFAULT_NODATA)),
        vertical_datum: None,
    })
}

/// The samples as the text holds them.
struct AsciiSamples {
    values: Vec<f32>,
    /// Whether any of them was no data.
    replaced: bool,
    /// Whether all are written as whole numbers.
    whole: bool,
}

fn samples(words: &mut TextWords, count: usize, nodata: f64) -> Result<AsciiSamples, DemErrorKind> {
    let mut values = Vec::with_capacity(count);
    let (mut replaced, mut whole) = (false, true);
    for word in words {
        if values.len() == count {
            return Err(DemErrorKind::broken(
                FORMAT,
                format!("more than the {count} values that ncols and nrows promise"),
            ));
        }
        let value = number(word).ok_or_else(|| {
            let word = String::from_utf8_lossy(&word[..word.len().min(20)]).into_owned();
            DemErrorKind::broken(
                FORMAT,
                format!("value {} of {count} is '{word}', not a number", values.len() + 1),
            )
        })?;
        let hole = value == nodata || !value.is_finite();
        replaced |= hole;
        whole = whole && word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+'));
        values.push(if hole { f32::NAN } else { value as f32 });
    }
    if values.len() < count {
        return Err(DemErrorKind::broken(
            FORMAT,
            format!("it ends after {} of {count} values", values.len()),
        ));
    }
    Ok(AsciiSamples { values, replaced, whole })
}

/// The `key value` pairs.
struct AsciiHeader(Vec<(&'static str, f64)>);

impl AsciiHeader {
    fn read(words: &mut TextWords) -> Result<Self, DemErrorKind> {
        let mut pairs: Vec<(&'static str, f64)> = Vec::new();
        loop {
            let before = words.at;
            let Some(word) = words.next() else { break };
            let lower = String::from_utf8_lossy(word).to_ascii_lowercase();
            let Some(key) = KEYS.into_iter().find(|key| *key == lower) else {
                words.at = before;
                break;
            };
            let value = words
                .next()
                .and_then(number)
                .ok_or_else(|| DemErrorKind::broken(FORMAT, format!("{key} is not followed by a number")))?;
            if pairs.iter().any(|(known, _)| *known == key) {
                return Err(DemErrorKind::broken(FORMAT, format!("{key} is stated twice")));
            }
            pairs.push((key, value));
        }
        Ok(Self(pairs))
    }

    fn get(&self, key: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| *known == key).map(|(_, value)| *value)
    }

    fn size(&self, key: &str) -> Result<u64, DemErrorKind> {
        match self.get(key) {
            Some(value) if value >= 1.0 && value.fract() == 0.0 && value <= u64::MAX as f64 => {
                Ok(value as u64)
            }
            Some(value) => {
                Err(DemErrorKind::broken(FORMAT, format!("{key} is {value}, not a whole number above 0")))
            }
            None => Err(DemErrorKind::broken(FORMAT, format!("{key} is missing"))),
        }
    }

    fn cell(&self) -> Result<DVec2, DemErrorKind> {
        let square = self.get("cellsize");
        let cell = match (self.get("dx").or(square), self.get("dy").or(square)) {
            (Some(x), Some(y)) => DVec2::new(x, y),
            _ => return Err(DemErrorKind::broken(FORMAT, "neither cellsize nor dx and dy are stated")),
        };
        if cell.is_finite() && cell.min_element() > 0.0 {
            return Ok(cell);
        }
        Err(DemErrorKind::broken(
            FORMAT,
            format!("the cells are {} by {}, not of a positive size", cell.x, cell.y),
        ))
    }

    /// The outer south-west corner.
    fn south_west(&self, cell: DVec2) -> Result<DVec2, DemErrorKind> {
        let edge = |corner: &str, center: &str, cell: f64| match (self.get(corner), self.get(center)) {
            (Some(at), _) => Ok(at),
            (None, Some(at)) => Ok(at - cell * 0.5),
            (None, None) => {
                Err(DemErrorKind::broken(FORMAT, format!("neither {corner} nor {center} is stated")))
            }
        };
        let at = DVec2::new(edge("xllcorner", "xllcenter", cell.x)?, edge("yllcorner", "yllcenter", cell.y)?);
        if at.is_finite() { Ok(at) } else { Err(DemErrorKind::broken(FORMAT, "its corner is not finite")) }
    }
}

/// The words of a text, as bytes.
pub(crate) struct TextWords<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> TextWords<'a> {
    /// The words of `bytes`, which blanks, line ends and NULs stand between.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// What has not been read yet.
    pub fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }
}

impl<'a> Iterator for TextWords<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
        let rest = &self.bytes[self.at..];
        let start = self.at + rest.iter().position(|byte| !is_blank(byte))?;
        let length = self.bytes[start..].iter().position(is_blank).unwrap_or(self.bytes.len() - start);
        self.at = start + length;
        Some(&self.bytes[start..self.at])
    }
}

/// A number, with a decimal point or a single decimal comma; `nan` in any case and GDAL's `-1.#IND` are NaN.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    if text.contains('#') {
        return Some(f64::NAN);
    }
    if text.matches(',').count() == 1 && !text.contains('.') {
        return text.replace(',', ".").parse().ok();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::read::{DemHints, read};

    fn grid(text: &str) -> Result<Raster, String> {
        read("a.asc", text.as_bytes(), &DemHints::default()).map_err(|error| error.to_string())
    }

    #[test]
    fn keys_come_in_any_order_and_case_and_values_on_any_line() {
        let raster =
            grid("NROWS 2\r\nnCols\t2\r\nYLLCENTER 5\r\nxllcorner 1\r\nDX 2\r\ndy 10\r\n1\r\n2 3\r\n\r\n4")
                .expect("a liberal grid");
        assert_eq!(raster.samples, Samples::F32(vec![1.0, 2.0, 3.0, 4.0]));
        assert_eq!(raster.geotransform(), [1.0, 2.0, 0.0, 20.0, 0.0, -10.0]);
    }

    #[test]
    fn no_data_is_what_the_header_says_or_else_what_esri_says() {
        let head = "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
        let stated = grid(&format!("{head}NODATA_value 7\n7 -9999 nan")).expect("fine");
        assert!(stated.at(0, 0).is_nan() && stated.at(1, 0) == -9999.0 && stated.at(2, 0).is_nan());
        let unstated = grid(&format!("{head}7 -9999 1,5")).expect("fine");
        assert!(unstated.at(1, 0).is_nan() && unstated.at(2, 0) == 1.5);
        assert_eq!(unstated.nodata, Some(-9999.0));
    }

    #[test]
    fn a_header_that_promises_too_much_is_refused_before_allocation() {
        let refused = grid("ncols 2000000000\nnrows 2000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1");
        assert!(refused.expect_err("too large").contains("2000000000 x 2000000000"));
        let refused = grid("ncols 1000\nnrows 1000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3");
        assert!(refused.expect_err("too short").contains("1000 x 1000"));
    }

    #[test]
    fn wrong_counts_and_words_are_refused_with_their_place() {
        let head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
        assert!(grid(&format!("{head}1 2 3.5")).expect_err("short").contains("3 of 4"));
        assert!(grid(&format!("{head}1 2 3 4 5")).expect_err("long").contains("more than the 4"));
        assert!(grid(&format!("{head}1 2 x 4")).expect_err("a word").contains("value 3 of 4 is 'x'"));
        assert!(grid("ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 0\n1").is_err());
    }
}
