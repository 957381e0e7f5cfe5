//! Writing GeoTIFF (TIFF 6.0; OGC 19-008r4): one band in deflated tiles, with its georeference.
//!
//! ```text
//! header │ directory │ long values of tags │ tile 0 │ tile 1 │ …
//! ```
//!
//! The directory comes first, so that the first bytes hold all that a reader needs. Tiles are packed in
//! parallel and written in their order: the same bytes for every number of threads. Floats go through the floating-point
//! predictor, integers through differences: both pack terrain a third smaller than plain. (The `tiff` crate's encoder
//! writes no tiles and no floating-point predictor.)

use std::borrow::Cow;
use std::io::Write;
use std::sync::LazyLock;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use crate::tiff::gdal_metadata::GDAL_METADATA;
use crate::tiff::write_computed::write_computed;
use crate::tiff::write_geokeys::GeoKeyTags;
use crate::written::{WriteError, WriteWindowsError, WrittenDem, WrittenWindows};
use sandtable_geom::length_unit::name_of_length;
use sandtable_raster::content::WrittenContent;
use sandtable_raster::raster::{Raster, SampleFloat, Samples};
use sandtable_raster::read_ahead::read_ahead;
use sandtable_raster::sample_type::{NumberKind, SampleType};
use sandtable_raster::stored::{SampleSurvey, StoredSamples};
use sandtable_raster::unstated_unit::foot_of_coordinates;
use sandtable_raster::windows::{ByteRows, RasterWindow, Windows};

/// Samples along a side of a tile, as GDAL writes them.
const TILE: u32 = 256;

/// Writes a raster; every raster can be.
pub(crate) fn write(raster: &Raster, _name: &str) -> Result<WrittenDem, WriteError> {
    Ok(write_described(raster, ""))
}

/// [`write`] with a description of what it shows, as `gdalinfo` prints it; empty for none.
pub fn write_described(raster: &Raster, description: &str) -> WrittenDem {
    let is_named = name_of_length(raster.meters_per_z).is_some();
    let raster = if is_named { Cow::Borrowed(raster) } else { raster.in_meters() };
    let stored = StoredSamples::new(&raster);
    let across = raster.width.div_ceil(TILE);
    let tiles: Vec<Vec<u8>> = (0..across * raster.height.div_ceil(TILE))
        .into_par_iter()
        .map(|index| tile(&raster, stored, (index % across) * TILE, (index / across) * TILE))
        .collect();
    let lengths: Vec<u32> = tiles.iter().map(|tile| tile.len() as u32).collect();
    let mut tags = tags(&raster, stored);
    if !description.is_empty() {
        tags.push((270, TiffField::text(description)));
    }
    let mut bytes = head(tags, &lengths);
    tiles.iter().for_each(|tile| bytes.extend(tile));
    WrittenDem { notes: notes(is_named), ..WrittenDem::new(bytes, stored.sample.gdal_name()) }
}

/// Samples that are looked at together before the first is written: 16 or 32 MiB.
const SURVEYED_SAMPLES: u32 = 1 << 22;

/// Writes a raster that is read in windows, twice, and holds a row of tiles of it: the bytes of [`write`].
pub(crate) fn write_windows(
    source: &mut (dyn Windows + Send),
    out: &mut dyn WrittenContent,
) -> Result<WrittenWindows, WriteWindowsError> {
    let own = source.metadata().without_samples();
    if let Some(rows) = source.computed_rows() {
        return write_computed(source, rows, out);
    }
    if let Some(bytes) = source.bytes() {
        return write_bytes(&own, bytes, out);
    }
    let is_named = name_of_length(own.meters_per_z).is_some();
    let written = |raster: Raster| if is_named { raster } else { raster.into_meters() };
    let part = |samples: Samples, height: u32| written(Raster { samples, height, ..own.without_samples() });
    let header = written(own.without_samples());
    let all = RasterWindow::all(source.size());
    let mut survey = SampleSurvey::new(&header);
    read_ahead(source, all.bands(SURVEYED_SAMPLES), Windows::samples, |window, samples| {
        survey.add(&part(samples, window.height).samples);
    })?;
    let stored = survey.stored();
    let across = header.width.div_ceil(TILE);
    // The lengths of the tiles are not known yet, but how many there are: the head is as long.
    let mut lengths = vec![0; (across * header.height.div_ceil(TILE)) as usize];
    out.write_all(&head(tags(&header, stored), &lengths))?;
    let (mut unwritten, mut outcome, mut valid) = (lengths.iter_mut(), Ok(()), 0);
    read_ahead(source, all.bands(TILE * header.width), Windows::samples, |window, samples| {
        let rows = part(samples, window.height);
        valid += valid_samples(&rows.samples);
        let tiles: Vec<Vec<u8>> =
            (0..across).into_par_iter().map(|index| tile(&rows, stored, index * TILE, 0)).collect();
        for (tile, length) in tiles.iter().zip(unwritten.by_ref()) {
            *length = tile.len() as u32;
            if outcome.is_ok() {
                outcome = out.write_all(tile);
            }
        }
    })?;
    outcome?;
    out.rewind()?;
    out.write_all(&head(tags(&header, stored), &lengths))?;
    Ok(WrittenWindows {
        stored: stored.sample.gdal_name().to_ascii_lowercase(),
        valid,
        notes: notes(is_named),
    })
}

/// [`write_windows`] of bytes, which takes them as they are. Memory: some packed tiles.
fn write_bytes(
    header: &Raster,
    bytes: &dyn ByteRows,
    out: &mut dyn WrittenContent,
) -> Result<WrittenWindows, WriteWindowsError> {
    /// Tiles that threads pack before they are written.
    const TOGETHER: usize = 128;
    let stored = StoredSamples { sample: SampleType::U8, nodata: header.nodata };
    let across = header.width.div_ceil(TILE);
    let mut lengths = vec![0; (across * header.height.div_ceil(TILE)) as usize];
    out.write_all(&head(tags(header, stored), &lengths))?;
    let mut valid = 0;
    let tile = |index: usize| {
        let [column, row] = [index as u32 % across * TILE, index as u32 / across * TILE];
        let tile = ByteTile::new((header.width, header.height), (column, row), |row, out| {
            bytes.fill(column, row, out);
        });
        (tile.valid(stored.nodata), tile.packed())
    };
    for (first, lengths) in (0..).step_by(TOGETHER).zip(lengths.chunks_mut(TOGETHER)) {
        let tiles: Vec<(u64, Vec<u8>)> = (first..first + lengths.len()).into_par_iter().map(tile).collect();
        for (length, (count, packed)) in lengths.iter_mut().zip(tiles) {
            *length = packed.len() as u32;
            valid += count;
            out.write_all(&packed)?;
        }
    }
    out.rewind()?;
    out.write_all(&head(tags(header, stored), &lengths))?;
    Ok(WrittenWindows { stored: stored.sample.gdal_name().to_ascii_lowercase(), valid, notes: Vec::new() })
}

/// How many samples have data.
fn valid_samples(samples: &Samples) -> u64 {
    /// Samples that a thread counts together.
    const COUNTED_TOGETHER: usize = 1 << 16;
    fn count<T: SampleFloat>(values: &[T]) -> u64 {
        let valid = |few: &[T]| few.iter().filter(|&&value| !value.into().is_nan()).count() as u64;
        values.par_chunks(COUNTED_TOGETHER).map(valid).sum()
    }
    match samples {
        Samples::F32(values) => count(values),
        Samples::F64(values) => count(values),
    }
}

fn notes(is_named: bool) -> Vec<String> {
    if is_named { vec![] } else { vec!["heights are converted to meters".to_owned()] }
}

/// How hard bytes are packed: grays and classes, of which a longer search finds a tenth more for twice the time.
pub(super) const BYTES_LEVEL: Compression = Compression::new(4);

/// One packed tile; beyond the raster its last samples are repeated, which packs to almost nothing.
fn tile(raster: &Raster, stored: StoredSamples, column: u32, row: u32) -> Vec<u8> {
    if stored.sample == SampleType::U8 {
        let nodata = stored.nodata.unwrap_or(0.0) as u8;
        let fill = |row: u32, out: &mut [u8]| byte_row(raster, nodata, (column, row), out);
        return ByteTile::new((raster.width, raster.height), (column, row), fill).packed();
    }
    let StoredSamples { sample, nodata } = stored;
    let nodata = nodata.unwrap_or(f64::NAN);
    let size = sample.bytes();
    let mut predicted = Vec::with_capacity((TILE * TILE) as usize * size);
    let mut line = Vec::with_capacity(TILE as usize * size);
    let mut values = [0.0; TILE as usize];
    for y in row..row + TILE {
        tile_row(raster, column, y.min(raster.height - 1), &mut values);
        values.iter_mut().for_each(|value| *value = if value.is_nan() { nodata } else { *value });
        line.clear();
        sample.write(&values, &mut line);
        predicted.extend(if sample.is_float() { float_bytes(&line, size) } else { differences(&line, size) });
    }
    packed(&predicted, Compression::default())
}

/// A tile of bytes.
struct ByteTile {
    /// [`TILE`] rows of as many; beyond the raster its last samples are repeated.
    bytes: Vec<u8>,
    /// Columns and rows within the raster.
    within: (usize, usize),
}

impl ByteTile {
    /// The tile of a raster of a size from `column` and `row` on; `fill` returns the rest of a row of the raster, as far as
    /// the tile reaches.
    fn new((width, height): (u32, u32), (column, row): (u32, u32), fill: impl Fn(u32, &mut [u8])) -> Self {
        let within = (TILE.min(width - column) as usize, TILE.min(height - row) as usize);
        let mut bytes = vec![0; (TILE * TILE) as usize];
        for (y, line) in (row..).zip(bytes.chunks_exact_mut(TILE as usize)) {
            let (held, beyond) = line.split_at_mut(within.0);
            fill(y.min(height - 1), held);
            beyond.fill(held[within.0 - 1]);
        }
        Self { bytes, within }
    }

    /// How many samples within the raster are not `nodata`.
    fn valid(&self, nodata: Option<f64>) -> u64 {
        let lines = self.bytes.chunks_exact(TILE as usize).take(self.within.1);
        let valid = |line: &[u8]| line.iter().filter(|&&byte| Some(f64::from(byte)) != nodata).count();
        lines.map(|line| valid(&line[..self.within.0]) as u64).sum()
    }

    /// The differences of its rows, packed. Many tiles are all zeros: nothing is in sight behind a ridge.
    fn packed(&self) -> Vec<u8> {
        /// A tile of zeros, packed.
        static ZEROS: LazyLock<Vec<u8>> = LazyLock::new(|| packed(&[0; (TILE * TILE) as usize], BYTES_LEVEL));
        if self.bytes.iter().fold(0, |bits, byte| bits | byte) == 0 {
            return ZEROS.clone();
        }
        let mut predicted = self.bytes.clone();
        let lines = self.bytes.chunks_exact(TILE as usize);
        for (out, line) in predicted.chunks_exact_mut(TILE as usize).zip(lines) {
            let pairs = line[1..].iter().zip(line);
            out[1..]
                .iter_mut()
                .zip(pairs)
                .for_each(|(out, (byte, before))| *out = byte.wrapping_sub(*before));
        }
        packed(&predicted, BYTES_LEVEL)
    }
}

/// A row of bytes from a column on, `nodata` for NaN.
fn byte_row(raster: &Raster, nodata: u8, (column, row): (u32, u32), bytes: &mut [u8]) {
    fn store<T: SampleFloat>(samples: &[T], nodata: u8, bytes: &mut [u8]) {
        for (byte, &value) in bytes.iter_mut().zip(samples) {
            let value = value.into();
            *byte = if value.is_nan() { nodata } else { value as u8 };
        }
    }
    let start = row as usize * raster.width as usize + column as usize;
    match &raster.samples {
        Samples::F32(samples) => store(&samples[start..], nodata, bytes),
        Samples::F64(samples) => store(&samples[start..], nodata, bytes),
    }
}

pub(super) fn packed(bytes: &[u8], level: Compression) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), level);
    packer.write_all(bytes).expect("memory takes what is written");
    packer.finish().expect("memory takes what is written")
}

/// The samples of a row from a column on, the last of them repeated.
fn tile_row(raster: &Raster, column: u32, row: u32, values: &mut [f64; TILE as usize]) {
    let count = TILE.min(raster.width - column) as usize;
    let start = row as usize * raster.width as usize + column as usize;
    let (held, beyond) = values.split_at_mut(count);
    match &raster.samples {
        Samples::F32(samples) => {
            let samples = &samples[start..start + count];
            held.iter_mut().zip(samples).for_each(|(value, &sample)| *value = f64::from(sample));
        }
        Samples::F64(samples) => held.copy_from_slice(&samples[start..start + count]),
    }
    beyond.fill(held[count - 1]);
}

/// Predictor 2: each value less the one before, in the type's own arithmetic.
fn differences(line: &[u8], size: usize) -> Vec<u8> {
    match size {
        1 => subtracted(line, |a, b| u8::from_le_bytes(a).wrapping_sub(u8::from_le_bytes(b)).to_le_bytes()),
        2 => subtracted(line, |a, b| u16::from_le_bytes(a).wrapping_sub(u16::from_le_bytes(b)).to_le_bytes()),
        4 => subtracted(line, |a, b| u32::from_le_bytes(a).wrapping_sub(u32::from_le_bytes(b)).to_le_bytes()),
        _ => subtracted(line, |a, b| u64::from_le_bytes(a).wrapping_sub(u64::from_le_bytes(b)).to_le_bytes()),
    }
}

/// The values of `N` bytes of a line, each less the one before as `subtract` has it; the first as it is.
fn subtracted<const N: usize>(line: &[u8], subtract: impl Fn([u8; N], [u8; N]) -> [u8; N]) -> Vec<u8> {
    let mut out = line.to_vec();
    let values = line.as_chunks().0;
    for (out, pair) in out.as_chunks_mut().0.iter_mut().skip(1).zip(values.windows(2)) {
        *out = subtract(pair[1], pair[0]);
    }
    out
}

/// Predictor 3: bytes sorted by significance, highest first, each less the one before.
fn float_bytes(line: &[u8], size: usize) -> Vec<u8> {
    let count = line.len() / size;
    let sorted: Vec<u8> =
        (0..size).rev().flat_map(|byte| (0..count).map(move |at| line[at * size + byte])).collect();
    let before = std::iter::once(0).chain(sorted.iter().copied());
    sorted.iter().zip(before).map(|(byte, before)| byte.wrapping_sub(before)).collect()
}

/// The value of a tag.
pub(super) struct TiffField {
    /// TIFF's number of the type.
    kind: u16,
    /// The number of values.
    count: u32,
    bytes: Vec<u8>,
}

impl TiffField {
    fn new<T: Copy, const N: usize>(kind: u16, values: &[T], bytes: fn(T) -> [u8; N]) -> Self {
        let bytes = values.iter().flat_map(|value| bytes(*value)).collect();
        Self { kind, count: values.len() as u32, bytes }
    }

    fn text(text: &str) -> Self {
        Self::new(2, &[text.as_bytes(), &[0]].concat(), u8::to_le_bytes)
    }

    pub(super) fn shorts(values: &[u16]) -> Self {
        Self::new(3, values, u16::to_le_bytes)
    }

    pub(super) fn longs(values: &[u32]) -> Self {
        Self::new(4, values, u32::to_le_bytes)
    }

    fn doubles(values: &[f64]) -> Self {
        Self::new(12, values, f64::to_le_bytes)
    }
}

/// All tags but those that list the tiles.
fn tags(raster: &Raster, stored: StoredSamples) -> Vec<(u16, TiffField)> {
    let short = |value: u16| TiffField::shorts(&[value]);
    let mut tags = described(raster, stored);
    tags.extend([
        (259, short(8)),
        (317, short(if stored.sample.is_float() { 3 } else { 2 })),
        (322, short(TILE as u16)),
        (323, short(TILE as u16)),
    ]);
    tags
}

/// The tags of the size, the type, the place and the unit of samples, whatever blocks they are in.
pub(super) fn described(raster: &Raster, stored: StoredSamples) -> Vec<(u16, TiffField)> {
    let sample = stored.sample;
    let format = match sample.kind() {
        NumberKind::Unsigned => 1,
        NumberKind::Signed => 2,
        NumberKind::Float => 3,
    };
    let short = |value: u16| TiffField::shorts(&[value]);
    let mut tags = vec![
        (256, TiffField::longs(&[raster.width])),
        (257, TiffField::longs(&[raster.height])),
        (258, short(sample.bytes() as u16 * 8)),
        (262, short(1)),
        (277, short(1)),
        (284, short(1)),
        (339, short(format)),
    ];
    tags.extend(place(raster));
    let keys = GeoKeyTags::new(raster);
    tags.push((34735, TiffField::shorts(&keys.directory)));
    if !keys.doubles.is_empty() {
        tags.push((34736, TiffField::doubles(&keys.doubles)));
    }
    if !keys.text.is_empty() {
        tags.push((34737, TiffField::text(&keys.text)));
    }
    // Meters beside coordinates in feet would be doubted.
    let is_doubted = raster.states_z_unit && foot_of_coordinates(raster).is_some();
    if let Some(unit) = name_of_length(raster.meters_per_z).filter(|unit| *unit != "m" || is_doubted) {
        let xml = format!(
            "<GDALMetadata>\n  <Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{unit}</Item>\n</GDALMetadata>\n"
        );
        tags.push((GDAL_METADATA, TiffField::text(&xml)));
    }
    if let Some(nodata) = stored.nodata {
        let text = if nodata.is_nan() { "nan".into() } else { nodata.to_string() };
        tags.push((42113, TiffField::text(&text)));
    }
    tags
}

/// The georeference: a tie point and a scale with north up, a matrix otherwise, nothing where there is none.
fn place(raster: &Raster) -> Vec<(u16, TiffField)> {
    let [x, x_per_column, x_per_row, y, y_per_column, y_per_row] = raster.geotransform();
    if !raster.georeferenced {
        Vec::new()
    } else if raster.is_north_up() {
        vec![
            (33550, TiffField::doubles(&[x_per_column, -y_per_row, 0.0])),
            (33922, TiffField::doubles(&[0.0, 0.0, 0.0, x, y, 0.0])),
        ]
    } else {
        let rows = [[x_per_column, x_per_row, 0.0, x], [y_per_column, y_per_row, 0.0, y]];
        let matrix = [rows[0], rows[1], [0.0; 4], [0.0, 0.0, 0.0, 1.0]].concat();
        vec![(34264, TiffField::doubles(&matrix))]
    }
}

/// The tags that list where tiles are and how long.
const TILES: (u16, u16) = (324, 325);

/// Header, directory and long values, before tiles of these lengths. At most 2²⁸ samples of eight bytes fit the 4 GiB of a
/// classic TIFF.
fn head(tags: Vec<(u16, TiffField)>, lengths: &[u32]) -> Vec<u8> {
    head_before(tags, TILES, lengths)
}

/// [`head`] before blocks that the tags `offsets` and `counts` list.
pub(super) fn head_before(
    mut tags: Vec<(u16, TiffField)>,
    (offsets, counts): (u16, u16),
    lengths: &[u32],
) -> Vec<u8> {
    tags.push((offsets, TiffField::longs(lengths)));
    tags.push((counts, TiffField::longs(lengths)));
    tags.sort_by_key(|(tag, _)| *tag);
    let first_tile = 8 + directory(&tags, 8).len() as u32;
    let next = |start: &mut u32, length: &u32| {
        *start += length;
        Some(*start - length)
    };
    let starts: Vec<u32> = lengths.iter().scan(first_tile, next).collect();
    tags.iter_mut()
        .filter(|(tag, _)| *tag == offsets)
        .for_each(|(_, field)| *field = TiffField::longs(&starts));
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    bytes.extend(directory(&tags, 8));
    bytes
}

/// A directory that starts at `start`, and after it the values that do not fit its entries.
fn directory(tags: &[(u16, TiffField)], start: usize) -> Vec<u8> {
    let mut entries = (tags.len() as u16).to_le_bytes().to_vec();
    let mut long = Vec::new();
    let long_start = start + 2 + tags.len() * 12 + 4;
    for (tag, field) in tags {
        let mut value = field.bytes.clone();
        if value.len() > 4 {
            let at = (long_start + long.len()) as u32;
            // Values start at even places.
            value.resize(value.len().next_multiple_of(2), 0);
            long.extend(value);
            value = at.to_le_bytes().to_vec();
        }
        value.resize(4, 0);
        entries.extend(tag.to_le_bytes());
        entries.extend(field.kind.to_le_bytes());
        entries.extend(field.count.to_le_bytes());
        entries.extend(value);
    }
    entries.extend([0; 4]);
    entries.extend(long);
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// A raster of more than two rows of tiles, with a height for each sample.
    fn raster(samples: Samples, meters_per_z: f64, nodata: Option<f64>) -> Raster {
        Raster { meters_per_z, nodata, ..Raster::new(530, samples) }
    }

    #[test]
    fn from_windows_a_file_has_the_bytes_that_it_has_from_memory() {
        let count = 530 * 600;
        let whole = |at: u32| (at % 9001) as f32 - 4500.0;
        let holed = |at: u32| if at % 977 == 5 { f32::NAN } else { (at % 9001) as f32 / 7.0 };
        // The only height that no 16 bits hold is the last.
        let late = |at: u32| if at + 1 == count { 0.5 } else { whole(at) };
        let rasters = [
            raster(Samples::F32((0..count).map(whole).collect()), 1.0, Some(-32768.0)),
            raster(Samples::F32((0..count).map(holed).collect()), 1.0, Some(holed(100).into())),
            raster(Samples::F32((0..count).map(late).collect()), 1.0, None),
            raster(Samples::F64((0..count).map(|at| f64::from(holed(at))).collect()), 0.3048, None),
            raster(Samples::F32((0..count).map(whole).collect()), 0.7, Some(-9999.0)),
            raster(Samples::F32(vec![f32::NAN; count as usize]), 1.0, Some(-9999.0)),
        ];
        for mut raster in rasters {
            let wanted = write(&raster, "").expect("any raster can be written");
            let mut out = Cursor::new(Vec::new());
            let written = write_windows(&mut raster, &mut out).expect("memory");
            assert!(out.into_inner() == wanted.bytes, "{}", wanted.stored);
            assert_eq!((written.stored, written.notes), (wanted.stored, wanted.notes));
            assert_eq!(written.valid, raster.samples.valid().count() as u64);
        }
    }
}
