//! Reads rasters from bytes. The format follows from the content, else from the extension.

use std::cell::OnceCell;

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition};
use crate::file_name::{file_name, split_extension, unpacked_name};
use crate::formats::{self, FORMATS, raw};
use crate::hints::DemHints;
use sandtable_base::archive::{self, ArchiveError, ZipReader};
use sandtable_base::limits::COMPANION_BYTES;
use sandtable_base::limits::UNPACKED_RASTER_BYTES;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::{DemError, DemErrorKind};
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};

/// The start of a database, which may be a GeoPackage of anything.
const SQLITE: &[u8] = b"SQLite format 3";

/// The bytes of a packed file that are unpacked before it is known what it is.
pub const HEAD_BYTES: u64 = 64 << 10;

/// Whether the name of a file in a folder or an archive is that of a tile of elevation. Extensions that pictures and
/// tables have as well do not count.
pub fn is_tile_name(name: &str) -> bool {
    let file = file_name(name).to_ascii_lowercase();
    let unpacked = unpacked_name(&file);
    let extension = split_extension(&unpacked).1;
    !file.starts_with('.') && FORMATS.iter().any(|format| format.extensions.contains(&extension))
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
    let own = windows.metadata();
    let with_unit =
        file.with_unit(own.without_samples()).map_err(|kind| DemError { name: name.to_owned(), kind })?;
    let is_own = (with_unit.meters_per_z, with_unit.states_z_unit) == (own.meters_per_z, own.states_z_unit);
    if is_own && hints.options.vertical_datum.is_none() && hints.options.nodata.is_none() {
        return Ok(Some(windows));
    }
    let header = with_stated_datum(with_unit, hints);
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
        let Raster { meters_per_z, states_z_unit, .. } = self.header;
        let own = windows.metadata().without_samples();
        let header = Raster { vertical_datum, meters_per_z, states_z_unit, ..own };
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
    file.with_unit((format_of(file)?.reader)(file)?)
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
    FORMATS.iter().copied().find(|format| is_wanted(format))
}

fn by_extension(extension: &str) -> Option<&'static DemFormat> {
    find(|format| format.has_extension(extension))
}

fn not_recognized(bytes: &[u8], extension: &str) -> DemErrorKind {
    let is_database = bytes.starts_with(SQLITE);
    let Some(format) = by_extension(extension).filter(|_| !is_database) else {
        return unknown(describe(bytes, extension));
    };
    match format.recognition {
        Recognition::Content { start, .. } => format.broken(format!("it does not start with {start}")),
        Recognition::HeaderFile { .. } => DemErrorKind::NoHeader(format.name),
        Recognition::Statement | Recognition::Extension => DemErrorKind::NoRawLayout,
    }
}

fn unknown(found: impl Into<String>) -> DemErrorKind {
    DemErrorKind::UnknownFormat { found: found.into(), known: formats::list() }
}

fn describe(bytes: &[u8], extension: &str) -> String {
    const KNOWN: [(&[u8], &str); 5] = [
        (SQLITE, "it is an SQLite database, but no GeoPackage of elevation"),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemOptions;
    use sandtable_base::archive::zip;

    #[test]
    fn tiles_are_named_by_extensions_that_nothing_else_has() {
        for name in ["a.tif", "d/B.TIFF", "n1.hgt.zip", "a.bt.gz", "a.btz", "a.dt0", "a.xyz", "a.img"] {
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

    /// A vertical part of a system in US survey feet.
    const IN_FEET: &[u8] =
        b"COMPD_CS[\"x\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
        PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],VERT_CS[\"NAVD88 height (ftUS)\",\
        VERT_DATUM[\"North American Vertical Datum 1988\",2005],UNIT[\"US survey foot\",0.304800609601219]]]";

    #[test]
    fn the_unit_of_elevations_is_the_callers_else_the_files_else_that_of_the_projection_beside_it() {
        let grid = b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n";
        let beside = |name: &str| (name == "a.prj").then(|| IN_FEET.to_vec());
        let unit = |name: &str, stated: Option<f64>| {
            let options = DemOptions { vertical_unit: stated, ..DemOptions::default() };
            let hints = DemHints { companions: &beside, ..DemHints::from(options) };
            let raster = read(name, grid, &hints).expect("a small grid");
            (raster.meters_per_z, raster.states_z_unit, raster.notes.len())
        };
        assert_eq!(unit("a.asc", None), (0.304_800_609_601_219, true, 0));
        assert_eq!(unit("b.asc", None), (1.0, false, 0));
        assert_eq!(unit("b.asc", Some(0.3048)), (0.3048, true, 0));
        assert_eq!(unit("a.asc", Some(1.0)), (1.0, true, 1), "another unit than the file's is told");
        let bad = DemOptions { vertical_unit: Some(0.0), ..DemOptions::default() };
        let refused = read("b.asc", grid, &bad.into()).expect_err("no unit").to_string();
        assert!(refused.contains("vertical_unit"), "{refused}");
    }

    #[test]
    fn windows_have_the_unit_that_the_whole_file_has() {
        let raster = Raster { georeferenced: true, ..Raster::new(2, Samples::F32(vec![1.0, 2.0, 3.0, 4.0])) };
        let format = DemFormat::to_write("tif").expect("a GeoTIFF");
        let bytes = crate::write::write(&raster, format, "a.tif").expect("written").bytes;
        let beside = |name: &str| (name == "a.prj").then(|| IN_FEET.to_vec());
        for stated in [None, Some(0.3048)] {
            let options = DemOptions { vertical_unit: stated, ..DemOptions::default() };
            let hints = DemHints { companions: &beside, ..DemHints::from(options) };
            let content = Box::new(std::io::Cursor::new(bytes.clone()));
            let windows = open_windows("a.tif", &bytes, content, &hints, 1 << 16).expect("opened");
            let windows = windows.expect("a format with windows");
            let whole = read("a.tif", &bytes, &hints).expect("read");
            assert_eq!(windows.metadata().meters_per_z, whole.meters_per_z);
            assert_eq!(whole.meters_per_z, stated.unwrap_or(0.304_800_609_601_219));
        }
    }
}
