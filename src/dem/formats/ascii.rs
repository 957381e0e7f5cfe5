//! ESRI ASCII grid (`.asc`): lines of `key value`, then the samples as text, north row first.
//!
//! Read liberally: keys in any order and case, tabs and CRLF, `xllcenter` for `xllcorner`, `dx`/`dy` for `cellsize`,
//! line breaks anywhere, a decimal comma, a no-data value that is a word, as 12d writes `null`, and such words in place of
//! values. The number of samples must be right: a wrong `ncols` would shear the terrain
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
use crate::formats::text::{TextWords, is_missing, number, quote};
use crate::written::{WriteError, WrittenDem};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::limits::SizeClaim;
use sandtable_raster::nodata_span::NoDataSpan;
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

/// The key of the value for no data.
const NODATA_KEY: &str = "nodata_value";

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
    let stated = StatedMissing::new(header.get(NODATA_KEY));
    let values = values(&mut words, size.x as usize * size.y as usize, &stated)?;
    let nodata = stated.value.or(values.have_nodata.then_some(DEFAULT_NODATA));
    let north_west = DVec2::new(corner.x, corner.y + height as f64 * cell.y);
    Ok(Raster {
        driver: "AAIGrid",
        data_type: if values.have_fractions { "Float32" } else { "Int32" },
        crs: file.crs()?,
        nodata,
        notes: values.note(&stated).into_iter().collect(),
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
        if key != NODATA_KEY {
            header.parse(&key, &value)?;
        }
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

/// What the header states of missing data.
struct StatedMissing<'a> {
    /// The value; `None` where none is stated, or a word.
    value: Option<f64>,
    /// The word that stands for missing data.
    word: Option<&'a str>,
    /// What means no data among the samples.
    span: NoDataSpan,
}

impl<'a> StatedMissing<'a> {
    fn new(stated: Option<&'a str>) -> Self {
        let value = stated.and_then(|text| number(text.as_bytes()));
        let word = stated.filter(|_| value.is_none());
        Self { value, word, span: NoDataSpan::around(value.unwrap_or(DEFAULT_NODATA)) }
    }

    fn is_word(&self, word: &[u8]) -> bool {
        self.word.is_some_and(|stated| stated.as_bytes().eq_ignore_ascii_case(word))
    }
}

#[derive(Default)]
struct AsciiValues {
    values: Vec<f32>,
    /// Whether any of them is no data.
    have_nodata: bool,
    /// Whether one is written as a fraction or not as a number.
    have_fractions: bool,
    /// How many are written as a word that the header does not state, and the first such word.
    unstated_words: u64,
    first_word: String,
    /// How many have the default value for no data where the header states a word.
    defaults: u64,
}

impl AsciiValues {
    /// What was guessed, for the user.
    fn note(&self, stated: &StatedMissing) -> Option<String> {
        let Self { unstated_words, first_word, defaults, .. } = self;
        let of_words = (*unstated_words > 0).then(|| {
            let are = if *unstated_words == 1 { "value is" } else { "values are" };
            format!("{unstated_words} {are} no number ('{first_word}'), and taken for no data")
        });
        let of_defaults = stated.word.filter(|_| *defaults > 0).map(|word| {
            let word = quote(word.as_bytes());
            format!("its no-data value is '{word}', and {defaults} values of {DEFAULT_NODATA} are taken for no data")
        });
        let parts: Vec<String> = of_words.into_iter().chain(of_defaults).collect();
        (!parts.is_empty()).then(|| parts.join("; "))
    }
}

fn values(words: &mut TextWords, count: usize, stated: &StatedMissing) -> Result<AsciiValues, DemErrorKind> {
    let mut read = AsciiValues { values: Vec::with_capacity(count), ..AsciiValues::default() };
    for word in words {
        let index = read.values.len();
        if index == count {
            return Err(FORMAT.broken(format!("more than the {count} values that ncols and nrows promise")));
        }
        let Some(value) = number(word) else {
            if !stated.is_word(word) {
                if !is_missing(word) {
                    let (at, found) = (index + 1, quote(word));
                    return Err(FORMAT.broken(format!("value {at} of {count} is '{found}', not a number")));
                }
                if read.unstated_words == 0 {
                    read.first_word = quote(word);
                }
                read.unstated_words += 1;
            }
            read.have_nodata = true;
            read.values.push(f32::NAN);
            continue;
        };
        // The value for no data may have other digits than the samples, which are 32 bits wide.
        let narrow = value as f32;
        let is_stated = stated.span.contains(value) || stated.span.contains(narrow.into());
        let is_nodata = is_stated || !narrow.is_finite();
        read.defaults += u64::from(is_stated && stated.word.is_some());
        read.have_nodata |= is_nodata;
        read.have_fractions |= !word.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'-' | b'+'));
        read.values.push(if is_nodata { f32::NAN } else { narrow });
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
    let is_free = |nodata: &f64| {
        let span = NoDataSpan::around(*nodata);
        !raster.samples.iter().any(|value| span.contains(value))
    };
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
    fn no_data_may_be_written_with_other_digits_than_the_samples() {
        let head = "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value";
        for (stated, samples) in [
            ("-3.40282e+38", ["-3.4028234663852886e+38", "-3.402823e+38"]),
            ("-3.4028234663852886e+38", ["-3.40282e+38", "-340282346638528859811704183484516925440"]),
            ("-9999.9", ["-9999.900391", "-9999.9000"]),
            ("-9999.900391", ["-9999.9", "-9999.900390625"]),
            ("-1.79769e+308", ["-1.7976931348623157e308", "-1.79769e+308"]),
            ("1.70141e+038", ["1.7014100091878281e+38", "1.70141e38"]),
        ] {
            let raster = grid(&format!("{head} {stated}\n{} {} 7", samples[0], samples[1])).expect(stated);
            assert!(
                raster.at(0, 0).is_nan() && raster.at(1, 0).is_nan() && raster.at(2, 0) == 7.0,
                "{stated}: {:?}",
                raster.samples
            );
        }
        let near = grid(&format!("{head} -9999\n-9999.4 -9998 -9999")).expect("fine");
        assert!(
            near.at(0, 0) == f64::from(-9999.4_f32) && near.at(1, 0) == -9998.0 && near.at(2, 0).is_nan()
        );
    }

    #[test]
    fn a_word_may_stand_for_no_data_in_the_header_and_among_the_values() {
        let head = "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
        let missing = |values: &str| {
            let raster = grid(&format!("{head}{values}")).expect(values);
            let valid: Vec<f64> = raster.samples.valid().collect();
            (valid, raster.notes, raster.data_type)
        };
        let plain = || (vec![7.0, 8.0], Vec::<String>::new(), "Int32");
        assert_eq!(missing("NODATA_value null\n7 NULL 8"), plain());
        assert_eq!(missing("NODATA_value void\n7 void 8"), plain());
        assert_eq!(missing("NODATA_value nan\n7 -nan(ind) 8").0, [7.0, 8.0]);
        let (valid, notes, _) = missing("NODATA_value -9999\n7 null -9999");
        assert_eq!((valid, notes.len()), (vec![7.0], 1));
        assert!(notes[0].starts_with("1 value is no number ('null')"), "{notes:?}");
        let (valid, notes, _) = missing("NODATA_value null\n7 -9999 n/a");
        assert_eq!(valid, [7.0]);
        assert!(notes[0].contains("('n/a')") && notes[0].contains("1 values of -9999"), "{notes:?}");
        let refused = grid(&format!("{head}NODATA_value null\n7 x 8")).expect_err("a word");
        assert!(refused.contains("value 2 of 3 is 'x'"), "{refused}");
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
