//! Reads rasters from bytes. The format follows from the content, else from the extension.

use std::cell::OnceCell;

use crate::error::{DemError, DemErrorKind};
use crate::formats::height_encoding::HeightEncoding;
use crate::formats::raw::RawLayout;
use crate::formats::{DemFormat, FORMATS, FileContent, Recognition, raw};
use crate::raster::{Raster, Samples};
use crate::windows::{RasterWindow, Windows};
use sandtable_base::archive::{self, ArchiveError, ZipReader};
use sandtable_base::limits::COMPANION_BYTES;
use sandtable_base::limits::UNPACKED_RASTER_BYTES;
use sandtable_geom::crs::Crs;

/// The bytes of a packed file that are unpacked before it is known what it is.
pub const HEAD_BYTES: u64 = 64 << 10;

/// What a caller states of elevation, in place of what the file does or besides it.
#[derive(Clone, Debug, Default)]
pub struct DemOptions {
    /// Meters per gray value of a PNG, which is refused without it, or per value of a RAW file (default 1).
    pub height_scale: Option<f64>,
    /// Elevation in meters of value 0. Default 0.
    pub height_offset: Option<f64>,
    /// A value that means no data, besides the one that the file declares, in the file's vertical unit.
    pub nodata: Option<f64>,
    /// The encoding of heights in the colors of a PNG; a color PNG is refused without it.
    pub height_encoding: Option<HeightEncoding>,
    /// The layout of the file, which is RAW.
    pub raw: Option<RawLayout>,
    /// The vertical datum, in place of the file's.
    pub vertical_datum: Option<String>,
    /// Meters between samples of a file without georeference, whose south-west sample is then at (0, 0).
    pub cell: Option<f64>,
    /// The coordinate system, in place of the file's.
    pub crs: Option<Crs>,
}

/// How one elevation file is read.
#[derive(Clone)]
pub struct DemHints<'a> {
    /// What is stated of it.
    pub options: DemOptions,
    /// Called with the system that the file states where the stated one takes its place.
    pub overridden: &'a dyn Fn(&Crs),
    /// The bytes of a companion by its name: the name given to [`read`] with another extension, such as `.prj`; `None`
    /// where there is none.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for DemHints<'_> {
    fn default() -> Self {
        DemOptions::default().into()
    }
}

impl From<DemOptions> for DemHints<'_> {
    /// The hints for a file without companions.
    fn from(options: DemOptions) -> Self {
        Self { options, overridden: &|_| (), companions: &|_| None }
    }
}

/// Whether the name of a file in a folder or an archive is that of a tile of elevation. Extensions that pictures and
/// tables have as well do not count.
pub fn is_tile_name(name: &str) -> bool {
    let file = file_name(name).to_ascii_lowercase();
    let unpacked = unpacked_name(&file);
    let extension = split_extension(&unpacked).1;
    !file.starts_with('.') && FORMATS.iter().any(|format| format.extensions.contains(&extension))
}

/// An elevation file while it is read: its name, bytes and hints.
pub(crate) struct DemFile<'a> {
    /// The name as given, for the extension and the companions.
    pub name: &'a str,
    /// The content.
    pub bytes: &'a [u8],
    pub hints: &'a DemHints<'a>,
}

impl DemFile<'_> {
    /// The extension in lower case, without the dot; empty where there is none.
    pub fn extension(&self) -> String {
        split_extension(self.name).1.to_ascii_lowercase()
    }

    pub fn stem(&self) -> &str {
        split_extension(file_name(self.name)).0
    }

    /// The bytes of the companion with another extension, in lower or in upper case.
    pub fn companion(&self, extension: &str) -> Option<Vec<u8>> {
        let base = split_extension(self.name).0;
        let read = |extension: &str| (self.hints.companions)(&format!("{base}.{extension}"));
        read(extension).or_else(|| read(&extension.to_ascii_uppercase()))
    }

    /// The content of the `.hdr` beside the file: `a.hdr` for `a.bil`, or `a.img.hdr` for `a.img`.
    pub fn header(&self) -> Option<Vec<u8>> {
        self.companion("hdr").or_else(|| (self.hints.companions)(&format!("{}.hdr", self.name)))
    }

    /// The coordinate system of the hints, else of a `.prj` companion; `None` where there is neither.
    pub fn crs(&self) -> Result<Option<Crs>, DemErrorKind> {
        self.crs_or(|| Ok(None))
    }

    /// The coordinate system of the hints, else the one that the file states, else that of a `.prj` companion.
    pub fn crs_or(
        &self,
        stated: impl FnOnce() -> Result<Option<Crs>, DemErrorKind>,
    ) -> Result<Option<Crs>, DemErrorKind> {
        let Some(crs) = &self.hints.options.crs else { return self.own_crs(stated) };
        // What the file states may be unreadable: another is stated for that.
        if let Ok(Some(own)) = self.own_crs(stated) {
            (self.hints.overridden)(&own);
        }
        Ok(Some(crs.clone()))
    }

    fn own_crs(
        &self,
        stated: impl FnOnce() -> Result<Option<Crs>, DemErrorKind>,
    ) -> Result<Option<Crs>, DemErrorKind> {
        if let Some(crs) = stated()? {
            return Ok(Some(crs));
        }
        let Some(bytes) = self.companion("prj") else { return Ok(None) };
        Ok(Some(Crs::parse(&String::from_utf8_lossy(&bytes))?))
    }

    /// The hinted meters per value, checked.
    pub fn height_scale(&self) -> Result<Option<f64>, DemErrorKind> {
        let is_sound = |scale: f64| scale.is_finite() && scale != 0.0;
        checked("height_scale", self.hints.options.height_scale, is_sound, "a finite number other than 0")
    }

    /// The hinted height of value 0, checked; 0 where there is none.
    pub fn height_offset(&self) -> Result<f64, DemErrorKind> {
        let offset =
            checked("height_offset", self.hints.options.height_offset, f64::is_finite, "a finite number");
        Ok(offset?.unwrap_or(0.0))
    }

    /// The hinted distance between samples, checked.
    pub fn cell(&self) -> Result<Option<f64>, DemErrorKind> {
        let is_sound = |cell: f64| cell.is_finite() && cell > 0.0;
        checked("cell", self.hints.options.cell, is_sound, "a positive number of meters")
    }
}

fn checked(
    what: &'static str,
    hint: Option<f64>,
    is_sound: impl Fn(f64) -> bool,
    wanted: &'static str,
) -> Result<Option<f64>, DemErrorKind> {
    match hint.filter(|&value| !is_sound(value)) {
        Some(value) => Err(DemErrorKind::Hint { what, value, wanted }),
        None => Ok(hint),
    }
}

/// Reads an elevation file.
///
/// `name` gives the extension, the companions' names and the name in messages; nothing is opened.
///
/// # Errors
/// [`DemError`] with the name and what was wrong; for an unknown format it lists the known ones.
pub fn read(name: &str, bytes: &[u8], hints: &DemHints) -> Result<Raster, DemError> {
    let raster = read_packed(&DemFile { name, bytes, hints })
        .map_err(|kind| DemError { name: name.to_owned(), kind })?;
    let mut raster = with_stated_datum(raster, hints);
    if let Some(nodata) = hints.options.nodata {
        raster.samples.clear(nodata);
    }
    Ok(raster)
}

/// Opens an elevation file to be read in windows, which hold what [`read`] returns. `head` are the first bytes of `content`, of
/// which [`HEAD_BYTES`] are enough; up to `cache_bytes` of decoded samples are kept. `None` where such a file is read whole:
/// a format without windows, an archive, or none of elevation.
///
/// # Errors
/// [`DemError`]. A file that has no windows may still be read whole.
pub fn open_windows(
    name: &str,
    head: &[u8],
    content: Box<dyn FileContent>,
    hints: &DemHints,
    cache_bytes: usize,
) -> Result<Option<Box<dyn Windows + Send>>, DemError> {
    let file = DemFile { name, bytes: head, hints };
    let Some(open) = format_of(&file).ok().and_then(|format| format.windows) else { return Ok(None) };
    let windows =
        open(&file, content, cache_bytes).map_err(|kind| DemError { name: name.to_owned(), kind })?;
    if hints.options.vertical_datum.is_none() && hints.options.nodata.is_none() {
        return Ok(Some(windows));
    }
    let header = with_stated_datum(windows.metadata().without_samples(), hints);
    Ok(Some(Box::new(StatedWindows { windows, header, nodata: hints.options.nodata })))
}

/// A raster with the vertical datum that the caller states, if any, in place of the file's.
fn with_stated_datum(raster: Raster, hints: &DemHints) -> Raster {
    let vertical_datum = hints.options.vertical_datum.clone().or(raster.vertical_datum);
    Raster { vertical_datum, ..raster }
}

/// Windows of a file of which the caller states more than the file does.
struct StatedWindows<W> {
    windows: W,
    header: Raster,
    /// A value for no data, besides the file's.
    nodata: Option<f64>,
}

impl<W: Windows + Send> Windows for StatedWindows<W> {
    fn metadata(&self) -> &Raster {
        &self.header
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        let mut samples = self.windows.samples(window)?;
        if let Some(nodata) = self.nodata {
            samples.clear(nodata);
        }
        Ok(samples)
    }

    fn overview(&self, step: u32) -> Option<(u32, Box<dyn Windows + Send + '_>)> {
        let (held, windows) = self.windows.overview(step)?;
        let vertical_datum = self.header.vertical_datum.clone();
        let header = Raster { vertical_datum, ..windows.metadata().without_samples() };
        Some((held, Box::new(StatedWindows { windows, header, nodata: self.nodata })))
    }

    fn announce(&mut self, windows: &[RasterWindow]) {
        self.windows.announce(windows);
    }
}

/// The name of the format that a file seems to have by its name and its first bytes, of which [`HEAD_BYTES`] are enough;
/// `None` where it is none of elevation. A PNG is elevation where the hints say what its colors mean; an archive may be.
pub fn format_by_head(name: &str, head: &[u8], hints: &DemHints) -> Option<&'static str> {
    if archive::is_gzip(head) || archive::is_zip(head) {
        return Some("packed");
    }
    let format = format_of(&DemFile { name, bytes: head, hints }).ok()?;
    let is_picture = hints.options.height_scale.is_none()
        && hints.options.height_encoding.is_none()
        && format.name == "PNG";
    (!is_picture).then_some(format.name)
}

fn read_packed(file: &DemFile) -> Result<Raster, DemErrorKind> {
    if archive::is_gzip(file.bytes) {
        let name = unpacked_name(file.name);
        let head = archive::gunzip_head(file.bytes, HEAD_BYTES)?;
        let limit = most_bytes(&DemFile { name: &name, bytes: &head, hints: file.hints })?;
        let content = archive::gunzip(file.bytes, limit).map_err(of_unpacking)?;
        return read_unpacked(&DemFile { name: &name, bytes: &content, hints: file.hints });
    }
    if archive::is_zip(file.bytes) {
        return read_zip(file);
    }
    read_unpacked(file)
}

/// Reads the first elevation file in an archive, with its companions there.
fn read_zip(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let zip = ZipReader::open(file.bytes)?;
    let name = zip
        .names()
        .find(|name| is_tile_name(name))
        .ok_or_else(|| unknown("it is a zip archive without an .hgt tile or another elevation file in it"))?;
    let too_large: OnceCell<DemErrorKind> = OnceCell::new();
    let companions = |wanted: &str| match zip.read(wanted, COMPANION_BYTES.get()) {
        Err(source @ ArchiveError::TooLarge { .. }) => {
            // The reader takes it for absent; the first of these is what it lacks.
            let _ = too_large.set(DemErrorKind::Companion { name: wanted.to_owned(), source });
            None
        }
        companion => companion.ok(),
    };
    let hints = DemHints { companions: &companions, ..file.hints.clone() };
    let read = || {
        let head = zip.read_head(name, HEAD_BYTES)?;
        let limit = most_bytes(&DemFile { name, bytes: &head, hints: &hints })?;
        let content = zip.read(name, limit).map_err(of_unpacking)?;
        read_unpacked(&DemFile { name, bytes: &content, hints: &hints })
    };
    let raster = read();
    too_large.into_inner().map_or(raster, Err)
}

/// The error of unpacking a file, with what raises the limit where that is the one for all files.
fn of_unpacking(error: ArchiveError) -> DemErrorKind {
    match error {
        ArchiveError::TooLarge { limit, .. } if limit == UNPACKED_RASTER_BYTES.get() => {
            DemErrorKind::Unpacked(error)
        }
        _ => DemErrorKind::Archive(error),
    }
}

fn read_unpacked(file: &DemFile) -> Result<Raster, DemErrorKind> {
    (format_of(file)?.reader)(file)
}

/// The most bytes that a packed file unpacks to; the bytes of `head` are its first.
fn most_bytes(head: &DemFile) -> Result<u64, DemErrorKind> {
    Ok((format_of(head)?.most_bytes)(head.bytes).min(UNPACKED_RASTER_BYTES.get()))
}

/// The format of an unpacked file, of whose content the first bytes are enough.
fn format_of(file: &DemFile) -> Result<&'static DemFormat, DemErrorKind> {
    if archive::is_gzip(file.bytes) || archive::is_zip(file.bytes) {
        return Err(unknown("it is packed twice"));
    }
    let extension = file.extension();
    if extension == "hdr" {
        return Err(unknown("it is the header of a file beside it: name that one"));
    }
    if file.hints.options.raw.is_some() {
        return Ok(&raw::FORMAT);
    }
    let by_content = |format: &DemFormat| matches!(format.recognition, Recognition::Content { matches, .. } if matches(file.bytes));
    let by_name =
        || by_extension(&extension).filter(|format| matches!(format.recognition, Recognition::Extension));
    let by_header = || {
        let header = file.header()?;
        find(|format| matches!(format.recognition, Recognition::HeaderFile { matches } if matches(&header)))
    };
    let recognized = find(by_content).or_else(by_name).or_else(by_header);
    recognized.ok_or_else(|| not_recognized(file.bytes, &extension))
}

fn find(is_wanted: impl Fn(&DemFormat) -> bool) -> Option<&'static DemFormat> {
    FORMATS.into_iter().find(|format| is_wanted(format))
}

fn by_extension(extension: &str) -> Option<&'static DemFormat> {
    find(|format| format.has_extension(extension))
}

fn not_recognized(bytes: &[u8], extension: &str) -> DemErrorKind {
    let Some(format) = by_extension(extension) else { return unknown(describe(bytes, extension)) };
    match format.recognition {
        Recognition::Content { start, .. } => format.broken(format!("it does not start with {start}")),
        Recognition::HeaderFile { .. } => DemErrorKind::NoHeader(format.name),
        Recognition::Statement | Recognition::Extension => DemErrorKind::NoRawLayout,
    }
}

fn unknown(found: impl Into<String>) -> DemErrorKind {
    DemErrorKind::UnknownFormat(found.into())
}

fn describe(bytes: &[u8], extension: &str) -> String {
    const KNOWN: [(&[u8], &str); 6] = [
        (b"SQLite format 3", "it is an SQLite database, perhaps a GeoPackage"),
        (b"EHFA_HEADER_TAG", "it is an Erdas Imagine file"),
        (b"\xff\xd8\xff", "it is a JPEG picture"),
        (b"\x89HDF", "it is an HDF 5 or NetCDF file"),
        (b"CDF", "it is a NetCDF file"),
        (b"LASF", "it is a point cloud, of which `sandtable dem grid` makes a grid"),
    ];
    let known = KNOWN.iter().find(|(start, _)| bytes.starts_with(start));
    match (known, bytes.is_empty(), extension) {
        (Some((_, what)), ..) => (*what).into(),
        (_, true, _) => "the file is empty".into(),
        (.., "") => "neither its content nor its name is known".into(),
        (.., extension) => format!("its content is not known, and .{extension} is not read"),
    }
}

fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The name of the file in a packed file of this name.
fn unpacked_name(name: &str) -> String {
    let (base, extension) = split_extension(name);
    match extension.to_ascii_lowercase().as_str() {
        "gz" | "zip" => base.to_owned(),
        "btz" => format!("{base}.bt"),
        _ => name.to_owned(),
    }
}

fn split_extension(name: &str) -> (&str, &str) {
    match name.rsplit_once('.') {
        Some((base, extension)) if !extension.contains(['/', '\\']) => (base, extension),
        _ => (name, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_base::archive::zip;

    #[test]
    fn tiles_are_named_by_extensions_that_nothing_else_has() {
        for name in ["a.tif", "d/B.TIFF", "n1.hgt.zip", "a.bt.gz", "a.btz", "a.dt0", "a.xyz"] {
            assert!(is_tile_name(name), "{name}");
        }
        for name in ["a.png", "a.csv", "a.zip", "a.gz", ".a.tif", "a.tif.aux.xml", "a.hdr", "tif"] {
            assert!(!is_tile_name(name), "{name}");
        }
    }

    #[test]
    fn an_unknown_file_is_refused_with_what_it_is_and_what_is_read() {
        let message = |name: &str, bytes: &[u8]| {
            read(name, bytes, &DemHints::default()).expect_err("refused").to_string()
        };
        assert!(message("a/b.las", b"LASF").contains("dem grid"));
        for wanted in ["x.adf", ".adf is not read", "GeoTIFF", ".asc", ".png", ".bt", ".hgt", ".dem", ".bil"]
        {
            assert!(message("x.adf", b"1 2 3").contains(wanted), "{wanted}");
        }
        assert!(message("x.hdr", b"NROWS 3\n").contains("name that one"));
        assert!(message("x.raw", b"123").contains("--raw"));
        assert!(message("x", b"").contains("empty"));
    }

    #[test]
    fn the_elevation_file_in_an_archive_is_read_with_its_companions() {
        let grid = b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n";
        let archive = zip(&[("readme.txt", b"1 2 3"), ("d/a.asc", &grid[..]), ("d/a.prj", b"EPSG:32612")])
            .expect("memory");
        let raster = read("a.zip", &archive, &DemHints::default()).expect("a grid in it");
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32612));
        let nested = zip(&[("a.hgt.zip", &archive[..])]).expect("memory");
        assert!(
            read("b.zip", &nested, &DemHints::default()).expect_err("nested").to_string().contains("twice")
        );
        let without = zip(&[("readme.txt", &b"1 2 3"[..])]).expect("memory");
        assert!(
            read("c.zip", &without, &DemHints::default()).expect_err("none").to_string().contains(".hgt")
        );
    }

    #[test]
    fn companions_are_asked_for_by_the_name_with_another_extension() {
        let grid = b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n";
        let beside = |name: &str| (name == "dir.d/a.prj").then(|| b"EPSG:32612".to_vec());
        let hints = DemHints { companions: &beside, ..DemHints::default() };
        let raster = read("dir.d/a.asc", grid, &hints).expect("a small grid");
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32612));
        assert!(read("b.asc", grid, &hints).expect("a small grid").crs.is_none());
    }
}
