//! Bytes to a raster: the format is told by content, then by extension.

use crate::archive::{self, MAX_RASTER_BYTES, ZipReader};
use crate::dem::error::{DemError, DemErrorKind};
use crate::dem::formats::raw;
use crate::dem::formats::raw::RawLayout;
use crate::dem::formats::rgb_png::HeightEncoding;
use crate::dem::formats::{ascii, bt, dted, ehdr, envi, hgt, png, surfer, terragen, usgs, xyz};
use crate::dem::raster::Raster;
use crate::dem::tiff::geotiff;
use crate::geom::crs::Crs;

/// What the caller knows of a file beyond its bytes.
#[derive(Clone)]
pub struct DemHints<'a> {
    /// Meters per gray value of a PNG, which is refused without it, or per value of a RAW file. Default 1 there; other
    /// formats do not look at it.
    pub png_height_scale: Option<f64>,
    /// Elevation in meters of value 0. Default 0.
    pub png_height_offset: Option<f64>,
    /// What the colors of a PNG mean; a color PNG is refused without it.
    pub height_encoding: Option<HeightEncoding>,
    /// That the file is RAW, and how it is laid out.
    pub raw: Option<RawLayout>,
    /// What heights are counted from, in place of what the file says.
    pub vertical_datum: Option<String>,
    /// Distance in meters between samples of a file without georeference; its south-west sample then stands
    /// at (0, 0). Files with a georeference keep theirs.
    pub cell: Option<f64>,
    /// The coordinate system, in place of what the file says or where it says nothing.
    pub crs: Option<Crs>,
    /// The bytes of a file that lies beside this one, by its name: the name given to [`read`] with another
    /// extension. Asked for `.prj` and world files; `None` where there is none.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for DemHints<'_> {
    fn default() -> Self {
        Self {
            png_height_scale: None,
            png_height_offset: None,
            height_encoding: None,
            raw: None,
            vertical_datum: None,
            cell: None,
            crs: None,
            companions: &|_| None,
        }
    }
}

/// The ends of names of files that are taken for elevation in a folder of tiles or an archive. Names that pictures and
/// tables go by as well are not among them.
const TILE_NAMES: [&str; 18] = [
    ".tif", ".tiff", ".asc", ".hgt", ".hgt.zip", ".hgt.gz", ".bt", ".bt.gz", ".btz", ".dem", ".dt0", ".dt1",
    ".dt2", ".flt", ".bil", ".ter", ".grd", ".xyz",
];

/// Whether a file of this name in a folder of tiles or an archive is one of them, as far as its name tells.
pub fn is_tile_name(name: &str) -> bool {
    let lower = name.rsplit(['/', '\\']).next().unwrap_or(name).to_ascii_lowercase();
    !lower.starts_with('.') && TILE_NAMES.iter().any(|end| lower.ends_with(end))
}

/// A file while it is read: its name, bytes and hints.
pub(crate) struct DemFile<'a> {
    /// The name as given, for the extension and the companions.
    pub name: &'a str,
    /// The content.
    pub bytes: &'a [u8],
    /// What the caller knows.
    pub hints: &'a DemHints<'a>,
}

impl DemFile<'_> {
    /// The extension in lower case, without the dot; empty where there is none.
    pub fn extension(&self) -> String {
        split_extension(self.name).1.to_ascii_lowercase()
    }

    /// The file name without folders and extension.
    pub fn stem(&self) -> &str {
        let file = self.name.rsplit(['/', '\\']).next().unwrap_or(self.name);
        split_extension(file).0
    }

    /// The bytes of the companion with another extension, asked for in lower and in upper case.
    pub fn companion(&self, extension: &str) -> Option<Vec<u8>> {
        let base = split_extension(self.name).0;
        let ask = |extension: &str| (self.hints.companions)(&format!("{base}.{extension}"));
        ask(extension).or_else(|| ask(&extension.to_ascii_uppercase()))
    }

    /// The coordinate system of the hints, or of a `.prj` companion; `None` where there is neither.
    pub fn crs_beside(&self) -> Result<Option<Crs>, DemErrorKind> {
        if let Some(crs) = &self.hints.crs {
            return Ok(Some(crs.clone()));
        }
        let Some(bytes) = self.companion("prj") else { return Ok(None) };
        Crs::parse(&String::from_utf8_lossy(&bytes)).map(Some).map_err(DemErrorKind::Crs)
    }

    /// The content of the `.hdr` beside the file: `a.hdr` for `a.bil`, or `a.img.hdr` for `a.img`.
    pub fn header(&self) -> Option<Vec<u8>> {
        self.companion("hdr").or_else(|| (self.hints.companions)(&format!("{}.hdr", self.name)))
    }

    /// The hinted meters per value, checked.
    pub fn height_scale(&self) -> Result<Option<f64>, DemErrorKind> {
        match self.hints.png_height_scale {
            Some(scale) if !(scale.is_finite() && scale != 0.0) => Err(DemErrorKind::Hint {
                what: "height_scale",
                value: scale,
                wanted: "a finite number other than 0",
            }),
            scale => Ok(scale),
        }
    }

    /// The hinted height of value 0, checked; 0 where there is none.
    pub fn height_offset(&self) -> Result<f64, DemErrorKind> {
        match self.hints.png_height_offset.unwrap_or(0.0) {
            offset if offset.is_finite() => Ok(offset),
            offset => {
                Err(DemErrorKind::Hint { what: "height_offset", value: offset, wanted: "a finite number" })
            }
        }
    }

    /// The hinted distance between samples, checked.
    pub fn cell(&self) -> Result<Option<f64>, DemErrorKind> {
        match self.hints.cell {
            Some(cell) if !(cell.is_finite() && cell > 0.0) => {
                Err(DemErrorKind::Hint { what: "cell", value: cell, wanted: "a positive number of meters" })
            }
            cell => Ok(cell),
        }
    }
}

/// Reads an elevation file.
///
/// `name` serves the extension, the companions' names and messages; nothing is opened.
///
/// # Errors
/// [`DemError`] with the name and what was wrong; an unknown format lists what can be read.
pub fn read(name: &str, bytes: &[u8], hints: &DemHints) -> Result<Raster, DemError> {
    let mut raster = read_source(&DemFile { name, bytes, hints })
        .map_err(|fault| DemError { name: name.into(), fault })?;
    if hints.vertical_datum.is_some() {
        raster.vertical_datum.clone_from(&hints.vertical_datum);
    }
    Ok(raster)
}

fn read_source(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let bytes = source.bytes;
    if archive::is_gzip(bytes) {
        return read_gzip(source);
    }
    if archive::is_zip(bytes) {
        return read_zip(source);
    }
    if source.extension() == "hdr" {
        return Err(DemErrorKind::UnknownFormat {
            found: "it is the header of a file beside it: name that one".into(),
        });
    }
    if let Some(layout) = &source.hints.raw {
        return raw::read(source, layout);
    }
    match FORMATS.iter().find(|(recognizes, _)| recognizes(bytes)) {
        Some((_, read)) => read(source),
        None => read_by_name(source),
    }
}

/// Whether content is that of a format.
type Recognizes = fn(&[u8]) -> bool;

/// Reads content of a format.
type Reads = fn(&DemFile) -> Result<Raster, DemErrorKind>;

/// The formats whose content says what they are.
const FORMATS: [(Recognizes, Reads); 8] = [
    (geotiff::recognizes, geotiff::read),
    (png::recognizes, png::read),
    (bt::recognizes, bt::read),
    (ascii::recognizes, ascii::read),
    (dted::recognizes, dted::read),
    (terragen::recognizes, terragen::read),
    (surfer::recognizes, surfer::read),
    (usgs::recognizes, usgs::read),
];

/// Reads content that does not say what it is: by the header beside it, or else by its extension.
fn read_by_name(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let extension = source.extension();
    // Not for files that have a meaning without one: an .hgt beside a stray .hdr is still a tile.
    let header = if extension == "hgt" { None } else { source.header() };
    match &header {
        Some(header) if envi::is_header(header) => return envi::read(source, header),
        Some(header) if ehdr::is_header(header) => return ehdr::read(source, header),
        _ => {}
    }
    match extension.as_str() {
        "hgt" => hgt::read(source),
        "tif" | "tiff" => Err(DemErrorKind::broken("GeoTIFF", "it does not start as a TIFF file does")),
        "asc" => Err(DemErrorKind::broken("ESRI ASCII grid", "it does not start with ncols")),
        "bt" => Err(DemErrorKind::broken("BT terrain", "it does not start with 'binterr1.' and a digit")),
        "png" => Err(DemErrorKind::broken("PNG", "it does not start as a PNG file does")),
        "ter" => Err(DemErrorKind::broken("Terragen terrain", "it does not start with TERRAGENTERRAIN")),
        "dt0" | "dt1" | "dt2" => Err(DemErrorKind::broken("DTED", "it does not start with UHL1")),
        "raw" | "r16" if header.is_none() => Err(DemErrorKind::NoRawLayout),
        text if xyz::EXTENSIONS.contains(&text) => xyz::read(source),
        grid if ehdr::EXTENSIONS.contains(&grid) => {
            Err(DemErrorKind::NoHeader { format: "ESRI binary grid" })
        }
        extension => Err(DemErrorKind::UnknownFormat { found: describe(source.bytes, extension) }),
    }
}

fn read_gzip(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let (base, extension) = split_extension(source.name);
    let inner = if extension.eq_ignore_ascii_case("btz") { format!("{base}.bt") } else { base.to_owned() };
    let content = archive::gunzip(source.bytes, MAX_RASTER_BYTES)?;
    if archive::is_gzip(&content) || archive::is_zip(&content) {
        return Err(DemErrorKind::UnknownFormat { found: "it is packed twice".into() });
    }
    read_source(&DemFile { name: &inner, bytes: &content, hints: source.hints })
}

/// Reads the first elevation file in an archive, with its companions there.
fn read_zip(source: &DemFile) -> Result<Raster, DemErrorKind> {
    let zip = ZipReader::open(source.bytes, MAX_RASTER_BYTES)?;
    let Some(name) = zip.names().find(|name| is_tile_name(name)) else {
        return Err(DemErrorKind::UnknownFormat {
            found: "it is a zip archive without an .hgt tile or another elevation file in it".into(),
        });
    };
    let content = zip.read(name)?;
    if archive::is_gzip(&content) || archive::is_zip(&content) {
        return Err(DemErrorKind::UnknownFormat { found: "it is packed twice".into() });
    }
    let beside = |wanted: &str| zip.read(wanted).ok();
    let hints = DemHints { companions: &beside, ..source.hints.clone() };
    read_source(&DemFile { name, bytes: &content, hints: &hints })
}

/// What an unknown file seems to be.
fn describe(bytes: &[u8], extension: &str) -> String {
    const KNOWN: [(&[u8], &str); 6] = [
        (b"SQLite format 3", "it is an SQLite database, perhaps a GeoPackage"),
        (b"EHFA_HEADER_TAG", "it is an Erdas Imagine file"),
        (b"\xff\xd8\xff", "it is a JPEG picture"),
        (b"\x89HDF", "it is an HDF 5 or NetCDF file"),
        (b"CDF", "it is a NetCDF file"),
        (b"LASF", "it is a point cloud, of which `sandtable dem grid` makes a grid"),
    ];
    let found = KNOWN.iter().find(|(start, _)| bytes.starts_with(start));
    match (found, bytes.is_empty(), extension) {
        (Some((_, what)), ..) => (*what).into(),
        (_, true, _) => "the file is empty".into(),
        (.., "") => "neither its content nor its name says what it is".into(),
        (.., extension) => format!("its content is not known, and .{extension} is not read"),
    }
}

/// A name without its extension, and the extension.
fn split_extension(name: &str) -> (&str, &str) {
    match name.rsplit_once('.') {
        Some((base, extension)) if !extension.contains(['/', '\\']) => (base, extension),
        _ => (name, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_file_is_refused_with_what_it_is_and_what_is_read() {
        let said = |name: &str, bytes: &[u8]| {
            read(name, bytes, &DemHints::default()).expect_err("refused").to_string()
        };
        assert!(said("a/b.las", b"LASF").contains("dem grid"));
        for wanted in ["x.adf", ".adf is not read", "GeoTIFF", ".asc", ".png", ".bt", ".hgt", ".dem", ".bil"]
        {
            assert!(said("x.adf", b"1 2 3").contains(wanted), "{wanted}");
        }
        assert!(said("x.hdr", b"NROWS 3\n").contains("name that one"));
        assert!(said("x.raw", b"123").contains("--raw"));
        assert!(said("x", b"").contains("empty"));
    }

    /// An archive of stored members.
    fn zip(members: &[(&str, &[u8])]) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for (name, content) in members {
            let (at, size) = ((bytes.len() as u32).to_le_bytes(), (content.len() as u32).to_le_bytes());
            let length = (name.len() as u16).to_le_bytes();
            bytes.extend([&b"PK\x03\x04"[..], &[0; 22], &length, &[0; 2], name.as_bytes(), content].concat());
            directory.extend([&b"PK\x01\x02"[..], &[0; 16], &size, &size, &length, &[0; 12], &at].concat());
            directory.extend(name.as_bytes());
        }
        let (start, count) = ((bytes.len() as u32).to_le_bytes(), (members.len() as u16).to_le_bytes());
        let end = [&b"PK\x05\x06\0\0\0\0"[..], &count, &count, &[0; 4], &start, &[0; 2]].concat();
        [bytes, directory, end].concat()
    }

    #[test]
    fn the_elevation_file_in_an_archive_is_read_with_its_companions() {
        let grid = b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n";
        let archive = zip(&[("readme.txt", b"1 2 3"), ("d/a.asc", grid), ("d/a.prj", b"EPSG:32612")]);
        let raster = read("a.zip", &archive, &DemHints::default()).expect("a grid in it");
        assert_eq!(raster.crs.and_then(|crs| crs.epsg()), Some(32612));
        let nested = zip(&[("a.hgt.zip", &archive)]);
        assert!(
            read("b.zip", &nested, &DemHints::default()).expect_err("nested").to_string().contains("twice")
        );
        let without = zip(&[("readme.txt", b"1 2 3")]);
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
