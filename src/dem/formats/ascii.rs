//! ESRI ASCII grid (`.asc`): lines of `key value`, then the samples as text, north row first.
//!
//! Read liberally: keys in any order and case, tabs and CRLF, `xllcenter` for `xllcorner`, `dx`/`dy` for `cellsize`,
//! line breaks anywhere, a decimal comma. The number of samples must be right: a wrong `ncols` would shear the terrain
//! silently.
//!
//! Written with as many digits as a value needs to come back to the last bit, its coordinate system in a `.prj` beside
//! it. Cells that are not square get `dx` and `dy` in place of `cellsize`, as GDAL reads and writes them.

use std::fmt::Write;

use glam::DVec2;

use crate::companion::projection_file_of;
use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, FormatWriter, Recognition};
use crate::formats::header::HeaderFields;
use crate::formats::text::{TextWords, number, quote};
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::raster::{Raster, SampleFloat, Samples, north_up};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: "ESRI ASCII grid",
    extensions: &["asc"],
    shared_extensions: &[],
    recognition: Recognition::Content { matches: recognizes, start: "ncols" },
    reader: read,
    windows: None,
    most_bytes,
    writer: Some(FormatWriter { extensions: &["asc"], write }),
    windows_writer: None,
};

/// The no-data value where the header states none, by Esri's definition of the format.
const DEFAULT_NODATA: f64 = -9999.0;

/// Written for no data, in the order of preference; the raster's own value comes first.
const NODATA_VALUES: [f64; 3] = [DEFAULT_NODATA, -32768.0, -99999.0];

fn is_key(word: &[u8]) -> bool {
    const KEYS: &str = "ncols nrows xllcorner yllcorner xllcenter yllcenter cellsize dx dy nodata_value";
    KEYS.split(' ').any(|key| key.as_bytes().eq_ignore_ascii_case(word))
}

fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn recognizes(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(64)];
    TextWords::new(without_byte_order_mark(start)).next().is_some_and(is_key)
}

/// The keys, and for each sample all the digits that a writer gives it, padded to a column.
fn most_bytes(head: &[u8]) -> u64 {
    const KEYS: u64 = 64 << 10;
    const SAMPLE: u64 = 64;
    let mut words = TextWords::new(without_byte_order_mark(head));
    let size =
        header(&mut words).and_then(|header| Ok((header.required("ncols")?, header.required("nrows")?)));
    // What is wrong with the keys is said when they are read.
    size.map_or(KEYS, |(width, height)| {
        width.saturating_mul(height).saturating_mul(SAMPLE).saturating_add(KEYS)
    })
}

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let mut words = TextWords::new(without_byte_order_mark(file.bytes));
    let header = header(&mut words)?;
    let (width, height) = (header.required("ncols")?, header.required("nrows")?);
    // Every sample takes a digit, and all but the last a blank.
    let size = SizeClaim::new(width, height, 2).check(words.rest().len() + 1)?;
    let cell = cell(&header)?;
    let corner = header.south_west(cell)?;
    let corner = corner.ok_or_else(|| header.broken("its header states no xllcorner and yllcorner"))?;
    if !corner.is_finite() {
        return Err(header.broken("its corner is not finite"));
    }
    let nodata = header.number("nodata_value")?;
    let values = values(&mut words, size.x as usize * size.y as usize, nodata.unwrap_or(DEFAULT_NODATA))?;
    let north_west = DVec2::new(corner.x, corner.y + height as f64 * cell.y);
    Ok(Raster {
        driver: "AAIGrid",
        data_type: if values.are_whole { "Int32" } else { "Float32" },
        crs: file.crs()?,
        nodata: nodata.or(values.have_nodata.then_some(DEFAULT_NODATA)),
        ..Raster::new(size.x, Samples::F32(values.values)).placed(north_up(north_west, cell))
    })
}

/// The fields up to the first word that is not a key.
fn header(words: &mut TextWords) -> Result<HeaderFields, DemErrorKind> {
    let mut header = HeaderFields::new(FORMAT.name);
    while let Some(key) = words.next_if(is_key) {
        let key = String::from_utf8_lossy(key).to_ascii_lowercase();
        let value = String::from_utf8_lossy(words.next().unwrap_or_default());
        if header.get(&key).is_some() {
            return Err(FORMAT.broken(format!("{key} is stated twice")));
        }
        header.parse(&key, &value)?;
        header.push(&key, &value);
    }
    Ok(header)
}

fn cell(header: &HeaderFields) -> Result<DVec2, DemErrorKind> {
    let sides = header.first_number(["dx", "cellsize"])?.zip(header.first_number(["dy", "cellsize"])?);
    let cell = DVec2::from(sides.ok_or_else(|| header.broken("neither cellsize nor dx and dy are stated"))?);
    if cell.is_finite() && cell.min_element() > 0.0 {
        return Ok(cell);
    }
    Err(header.broken(format!("the cells are {} by {}, not of a positive size", cell.x, cell.y)))
}

struct AsciiValues {
    values: Vec<f32>,
    /// Whether any of them is no data.
    have_nodata: bool,
    /// Whether all are written as whole numbers.
    are_whole: bool,
}

fn values(words: &mut TextWords, count: usize, nodata: f64) -> Result<AsciiValues, DemErrorKind> {
    let mut read = AsciiValues { values: Vec::with_capacity(count), have_nodata: false, are_whole: true };
    for word in words {
        let index = read.values.len();
        if index == count {
            return Err(FORMAT.broken(format!("more than the {count} values that ncols and nrows promise")));
        }
        let value = number(word).ok_or_else(|| {
            FORMAT.broken(format!("value {} of {count} is '{}', not a number", index + 1, quote(word)))
        })?;
        let is_nodata = value == nodata || !value.is_finite();
        read.have_nodata |= is_nodata;
        read.are_whole &= word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+'));
        read.values.push(if is_nodata { f32::NAN } else { value as f32 });
    }
    if read.values.len() < count {
        return Err(FORMAT.broken(format!("it ends after {} of {count} values", read.values.len())));
    }
    Ok(read)
}

fn write(raster: &Raster, _name: &str) -> Result<WrittenDem, WriteError> {
    let raster = &raster.in_meters();
    let raster = &FORMAT.north_up(raster)?;
    let nodata = nodata_to_write(raster)?;
    let (cell, south_west) = (raster.spacing(), raster.extent().min);
    let sides = if cell.x == cell.y {
        format!("cellsize {}", cell.x)
    } else {
        format!("dx {}\ndy {}", cell.x, cell.y)
    };
    let mut text = format!(
        "ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\n{sides}\nNODATA_value {nodata}\n",
        raster.width, raster.height, south_west.x, south_west.y
    );
    match &raster.samples {
        Samples::F32(values) => write_rows(&mut text, values, raster.width, nodata),
        Samples::F64(values) => write_rows(&mut text, values, raster.width, nodata),
    }
    Ok(WrittenDem {
        companions: projection_file_of(raster).into_iter().collect(),
        ..WrittenDem::new(text.into_bytes(), "text")
    })
}

fn write_rows<T: SampleFloat>(text: &mut String, values: &[T], width: u32, nodata: f64) {
    for (index, &value) in values.iter().enumerate() {
        let end = if (index + 1).is_multiple_of(width as usize) { '\n' } else { ' ' };
        let wide: f64 = value.into();
        let written =
            if wide.is_nan() { write!(text, "{nodata}{end}") } else { write!(text, "{value}{end}") };
        written.expect("a string takes what is written");
    }
}

/// A value that no sample has. It is always stated: readers assume −9999 where none is.
fn nodata_to_write(raster: &Raster) -> Result<f64, WriteError> {
    let own = raster.nodata.filter(|value| value.is_finite());
    let is_free = |nodata: &f64| raster.samples.iter().all(|value| value != *nodata);
    let taken = WriteError::NoDataTaken { format: FORMAT.name, value: DEFAULT_NODATA };
    own.into_iter().chain(NODATA_VALUES).find(is_free).ok_or(taken)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::read::read;

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
