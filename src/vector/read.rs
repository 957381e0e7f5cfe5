//! Reads vector files; the format follows from the content.
//!
//! | format | layers | coordinate system |
//! |---|---|---|
//! | GeoJSON, also one feature to a line or as a text sequence | one | its `crs` member, else EPSG:4326 |
//! | CityJSON, also one feature to a line | one: footprints | its reference system |
//! | ESRI shapefile, also zipped | one; of an archive the names of its `.shp` files | its `.prj` |
//! | DXF | its layers; all that are shown where none is requested | none: `crs` |
//! | GeoPackage (feature `vector-db`) | its tables and views of features | its own |
//! | FlatGeobuf | one | its own |
//! | GPX | waypoints, routes, tracks; route_points, track_points | EPSG:4326 |
//! | KML, KMZ | the names of its folders; all where none is requested | EPSG:4326 |
//! | Cursor-on-Target events, also of a data package | one | EPSG:4326 |
//! | MilX, MSDL, NVG | the names of its layers or groups, of MSDL units, equipment, installations, graphics; all where none is requested | EPSG:4326 |
//! | scenarios of ORBAT Mapper | units, and the names of its layers; all where none is requested | EPSG:4326 |
//! | CSV, TSV | one | that of its column names or grid references, else the `crs` key |
//! | spreadsheets: xlsx, xlsm, ods, xls | its sheets | as of CSV |
//! | LandXML | alignments; stations, points, plan_features | its EPSG code |
//! | OpenStreetMap XML and PBF | points, lines, multipolygons; roads, railways, waterways, water, buildings | EPSG:4326 |
//!
//! Any of them may be packed by gzip.

use std::borrow::Cow;

use crate::cityjson::CityModel;
use crate::error::VectorError;
use crate::feature::VectorLayer;
#[cfg(feature = "vector-db")]
use crate::geopackage;
use crate::hints::VectorHints;
use crate::osm::OsmExtract;
use crate::{
    cityjson, cot, dxf, flatgeobuf, geojson, gpx, kml, landxml, milx, msdl, nvg, orbat, osm, shapefile, table,
};
use sandtable_base::archive::{self, ArchiveError, ZipReader};
use sandtable_base::limits::UNPACKED_VECTOR_BYTES;

/// Bytes at the start of a document in which its outermost element is searched.
const XML_HEAD_BYTES: usize = 4096;

/// How many times as long as a packed file its content is. Coordinates and tags in XML deflate to a tenth or a twentieth.
const MOST_EXPANSION: u64 = 64;

/// The bytes that a packed file of any size unpacks to.
const SMALL_BYTES: u64 = 16 << 20;

/// Reads all features of a vector file, or of one of its layers.
///
/// The content decides the format; `name` is used where it does not, for the names of companions and in
/// messages.
///
/// # Errors
/// [`VectorError`]; for a format that cannot be read with the command that converts it.
pub fn read(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    read_file(name, bytes, hints).map(|file| file.layer)
}

/// A vector file as read.
pub struct VectorFile {
    /// Its features.
    pub layer: VectorLayer,
    /// The surfaces of its objects, of CityJSON.
    pub model: Option<CityModel>,
}

/// [`read`] with what a file holds besides features.
///
/// # Errors
/// As [`read`].
pub fn read_file(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorFile, VectorError> {
    if archive::is_gzip(bytes) {
        let inner = name.strip_suffix(".gz").unwrap_or(name);
        return read_unpacked(
            inner,
            &archive::gunzip(bytes, most_unpacked(bytes)).map_err(of_unpacking)?,
            hints,
        );
    }
    if archive::is_zip(bytes) { read_zip(name, bytes, hints) } else { read_unpacked(name, bytes, hints) }
}

/// The most bytes that a packed file or one of its members unpacks to.
fn most_unpacked(packed: &[u8]) -> u64 {
    (SMALL_BYTES + MOST_EXPANSION * packed.len() as u64).min(UNPACKED_VECTOR_BYTES.get())
}

/// The error of unpacking a file, with what raises the limit where that is the one for all files.
fn of_unpacking(error: ArchiveError) -> VectorError {
    match error {
        ArchiveError::TooLarge { limit, .. } if limit == UNPACKED_VECTOR_BYTES.get() => {
            VectorError::Unpacked(error)
        }
        _ => VectorError::Archive(error),
    }
}

/// A file in memory of which any number of layers are made: an OpenStreetMap extract, which takes longer to read than a layer of it
/// to make.
pub struct LayeredFile(OsmExtract);

impl LayeredFile {
    /// Reads such a file; `None` for a file of another format, or packed, of which [`read_file`] makes one layer.
    ///
    /// # Errors
    /// As [`read`].
    pub fn read(name: &str, bytes: &[u8], hints: &VectorHints) -> Option<Result<Self, VectorError>> {
        if archive::is_gzip(bytes) || archive::is_zip(bytes) {
            return None;
        }
        let extract = match format_of(name, bytes) {
            VectorFormat::OsmXml => OsmExtract::of_xml(bytes, hints),
            VectorFormat::OsmPbf => OsmExtract::of_pbf(bytes, hints),
            _ => return None,
        };
        Some(extract.map(Self))
    }

    /// The layer that `hints` request, as [`read`] makes it.
    ///
    /// # Errors
    /// As [`read`].
    pub fn layer(&self, hints: &VectorHints) -> Result<VectorLayer, VectorError> {
        self.0.layer(hints)
    }
}

fn read_unpacked(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorFile, VectorError> {
    let layer = match format_of(name, bytes) {
        VectorFormat::GeoJson => single(name, hints, geojson::read(bytes, hints)),
        VectorFormat::Cot => single(name, hints, cot::read(bytes, hints)),
        VectorFormat::MilX => milx::read(bytes, hints),
        VectorFormat::Msdl => msdl::read(bytes, hints),
        VectorFormat::Nvg => nvg::read(bytes, hints),
        VectorFormat::Orbat => orbat::read(bytes, hints),
        VectorFormat::CityJson => {
            hints.choose_layer(&[stem(name)])?;
            let (layer, model) = cityjson::read(bytes, hints)?;
            return Ok(VectorFile { layer, model: Some(model) });
        }
        VectorFormat::GeoJsonSequence => single(name, hints, geojson::read_sequence(bytes, hints)),
        VectorFormat::Shapefile => {
            let companion = |extension: &str| companion(name, extension, hints);
            let files = shapefile::ShapefileParts {
                shapes: bytes,
                index: companion("shx"),
                table: companion("dbf"),
                crs: companion("prj"),
                encoding: companion("cpg"),
            };
            single(name, hints, shapefile::read(&files, hints))
        }
        #[cfg(feature = "vector-db")]
        VectorFormat::GeoPackage => geopackage::read(bytes, hints),
        #[cfg(not(feature = "vector-db"))]
        VectorFormat::GeoPackage => {
            let (format, feature) = ("GeoPackage", "vector-db");
            Err(VectorError::FeatureDisabled { format, feature, command: conversion(name) })
        }
        VectorFormat::Dxf => dxf::read(bytes, hints),
        VectorFormat::FlatGeobuf => single(name, hints, flatgeobuf::read(bytes, hints)),
        VectorFormat::Gpx => gpx::read(bytes, hints),
        VectorFormat::Kml => kml::read(bytes, hints),
        VectorFormat::LandXml => landxml::read(bytes, hints),
        VectorFormat::Table => single(name, hints, table::read_text(bytes, hints)),
        VectorFormat::OsmXml => OsmExtract::of_xml(bytes, hints)?.layer(hints),
        VectorFormat::OsmPbf => OsmExtract::of_pbf(bytes, hints)?.layer(hints),
        VectorFormat::Workbook97 => table::read_workbook_97(bytes, hints),
        VectorFormat::Other(format) => Err(VectorError::OtherFormat { format, command: conversion(name) }),
        VectorFormat::Unknown => Err(VectorError::UnknownFormat),
    };
    Ok(VectorFile { layer: layer?, model: None })
}

/// Returns the layer of a file that holds one, which may be requested by the file's name.
fn single(
    name: &str,
    hints: &VectorHints,
    layer: Result<VectorLayer, VectorError>,
) -> Result<VectorLayer, VectorError> {
    hints.choose_layer(&[stem(name)])?;
    layer
}

/// Returns the file's name without folders and extension.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.split_once('.').map_or(file, |(stem, _)| stem)
}

/// Returns the file beside `name` with another extension, in lower or upper case.
fn companion(name: &str, extension: &str, hints: &VectorHints) -> Option<Vec<u8>> {
    let base = name.rsplit_once('.').map_or(name, |(base, _)| base);
    let spellings = [extension.to_owned(), extension.to_ascii_uppercase()];
    spellings.iter().find_map(|extension| (hints.companions)(&format!("{base}.{extension}")))
}

/// Reads an archive: a KMZ, zipped shapefiles, or one file of another format.
fn read_zip(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorFile, VectorError> {
    const OTHERS: [&str; 10] =
        [".geojson", ".json", ".gpkg", ".fgb", ".gpx", ".osm", ".milxly", ".nvg", ".csv", ".tsv"];
    let zip = ZipReader::open(bytes)?;
    let limit = most_unpacked(bytes);
    if table::is_workbook(&zip) {
        return table::read_workbook(bytes, &zip, limit, hints)
            .map(|layer| VectorFile { layer, model: None });
    }
    let members = |extensions: &[&str]| {
        let is_wanted = |member: &&str| has_extension(member, extensions);
        zip.names().filter(is_wanted).collect::<Vec<_>>()
    };
    // A KMZ's document is the first .kml in it (OGC 07-147r2, section 8.1).
    if let Some(document) = members(&[".kml"]).first() {
        return read_unpacked(document, &zip.read(document, limit).map_err(of_unpacking)?, hints);
    }
    let shapefiles = members(&[".shp"]);
    if !shapefiles.is_empty() {
        let names: Vec<&str> = shapefiles.iter().map(|member| stem(member)).collect();
        let member = shapefiles[hints.choose_layer(&names)?];
        let companions = |name: &str| zip.read(name, limit).ok();
        let hints = VectorHints { layer: None, companions: &companions, ..*hints };
        return read_unpacked(member, &zip.read(member, limit).map_err(of_unpacking)?, &hints);
    }
    // A data package has a folder for each event.
    let events = members(&[".cot"]);
    if !events.is_empty() {
        let mut all = Vec::new();
        for member in events {
            all.extend(zip.read(member, limit.saturating_sub(all.len() as u64)).map_err(of_unpacking)?);
        }
        return read_unpacked(name, &all, hints);
    }
    match members(&OTHERS)[..] {
        [only] => read_unpacked(only, &zip.read(only, limit).map_err(of_unpacking)?, hints),
        _ => Err(VectorError::OtherFormat {
            format: "a zip archive without a .kml, a .shp or one other vector file",
            command: format!("unzip \"{name}\""),
        }),
    }
}

fn has_extension(name: &str, extensions: &[&str]) -> bool {
    let name = name.to_ascii_lowercase();
    extensions.iter().any(|extension| name.ends_with(extension))
}

/// The format of a file.
#[derive(Debug, PartialEq, Eq)]
enum VectorFormat {
    GeoJson,
    GeoJsonSequence,
    CityJson,
    Dxf,
    Shapefile,
    GeoPackage,
    FlatGeobuf,
    Gpx,
    Kml,
    Cot,
    MilX,
    Msdl,
    Nvg,
    Orbat,
    LandXml,
    Table,
    Workbook97,
    OsmXml,
    OsmPbf,
    /// Known, but not read.
    Other(&'static str),
    Unknown,
}

/// Returns the format by the content, else by the extension of the name.
fn format_of(name: &str, bytes: &[u8]) -> VectorFormat {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match () {
        // The index of a shapefile starts as its shapes do.
        () if shapefile::is_shapefile(bytes) && has_extension(name, &[".shx"]) => {
            VectorFormat::Other("the index of an ESRI shapefile; give the .shp file")
        }
        () if shapefile::is_shapefile(bytes) => VectorFormat::Shapefile,
        () if bytes.starts_with(b"SQLite format 3\0") => VectorFormat::GeoPackage,
        () if flatgeobuf::is_flatgeobuf(bytes) => VectorFormat::FlatGeobuf,
        () if dxf::is_dxf(bytes) => VectorFormat::Dxf,
        () if osm::is_pbf(bytes) => VectorFormat::OsmPbf,
        () if table::is_compound(bytes) => VectorFormat::Workbook97,
        () if bytes.starts_with(b"PAR1") => VectorFormat::Other("GeoParquet"),
        () => xml_format(bytes).or_else(|| format_by_name(name)).unwrap_or_else(|| match text.first() {
            Some(_) if orbat::is_orbat(text) => VectorFormat::Orbat,
            Some(b'{') if cityjson::is_cityjson(text) => VectorFormat::CityJson,
            Some(_) if geojson::is_sequence(text) => VectorFormat::GeoJsonSequence,
            Some(b'{') => VectorFormat::GeoJson,
            _ => VectorFormat::Unknown,
        }),
    }
}

/// Returns the format of XML, by its outermost element.
fn xml_format(bytes: &[u8]) -> Option<VectorFormat> {
    let head = &bytes[..bytes.len().min(XML_HEAD_BYTES)];
    // Of UTF-16, every second byte suffices to recognize the element.
    let text: Cow<'_, [u8]> = match head {
        [0xff, 0xfe, rest @ ..] | [0xfe, 0xff, rest @ ..] => {
            Cow::Owned(rest.iter().copied().filter(|&byte| byte != 0).collect())
        }
        _ => Cow::Borrowed(head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head)),
    };
    let text = text.trim_ascii_start();
    if text.first() != Some(&b'<') {
        return None;
    }
    let holds = |tag: &[u8]| text.windows(tag.len()).any(|window| window.eq_ignore_ascii_case(tag));
    Some(match () {
        () if holds(b"<kml") || holds(b":kml") || holds(b"<Placemark") => VectorFormat::Kml,
        () if holds(b"<gpx") => VectorFormat::Gpx,
        () if holds(b"<MilitaryScenario") || holds(b":MilitaryScenario") => VectorFormat::Msdl,
        () if holds(b"<MilXDocument") || holds(b"<MilXLayer") => VectorFormat::MilX,
        () if holds(b"<nvg") => VectorFormat::Nvg,
        () if holds(b"<event") && holds(b"uid=") => VectorFormat::Cot,
        () if holds(b"<LandXML") => VectorFormat::LandXml,
        () if holds(b"<osm") => VectorFormat::OsmXml,
        () if holds(b"gml") => VectorFormat::Other("GML"),
        () => VectorFormat::Other("XML of an unknown kind"),
    })
}

/// Returns the format that the name's extension means.
fn format_by_name(name: &str) -> Option<VectorFormat> {
    let extension = name.rsplit_once('.')?.1.to_ascii_lowercase();
    Some(match extension.as_str() {
        "csv" | "tsv" | "txt" | "xyz" => VectorFormat::Table,
        "dbf" | "shx" | "prj" | "cpg" => {
            VectorFormat::Other("a part of an ESRI shapefile; give the .shp file")
        }
        "tab" | "mif" | "mid" => VectorFormat::Other("MapInfo"),
        "dxf" => VectorFormat::Dxf,
        "dwg" => VectorFormat::Other("a CAD drawing; save it as DXF"),
        "geojsonl" | "geojsons" | "geojsonseq" | "ndjson" | "jsonl" => VectorFormat::GeoJsonSequence,
        _ => return None,
    })
}

/// Returns the command that converts the file `name` to GeoJSON.
fn conversion(name: &str) -> String {
    let base = name.rsplit_once('.').map_or(name, |(base, _)| base);
    format!("ogr2ogr -f GeoJSON \"{base}.geojson\" \"{name}\"")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_base::archive::zip;

    const POINT: &[u8] = b"{\"type\":\"Point\",\"coordinates\":[1,2]}";
    const KML: &[u8] = b"<kml><Placemark><Point><coordinates>1,2</coordinates></Point></Placemark></kml>";

    fn refusal(name: &str, bytes: &[u8]) -> String {
        read(name, bytes, &VectorHints::default()).expect_err(name).to_string()
    }

    #[test]
    fn content_decides_before_the_name() {
        let text = [b"\xef\xbb\xbf \n", POINT].concat();
        for name in ["a.geojson", "a.json", "a.xyzzy", "a", "a.shp"] {
            assert_eq!(read(name, &text, &VectorHints::default()).expect(name).features.len(), 1);
        }
        assert!(refusal("a.geojson", b"SQLite format 3\0...").contains("GeoPackage"));
        assert!(read("a.geojson", KML, &VectorHints::default()).is_ok());
    }

    #[test]
    fn every_format_is_known_by_its_first_bytes() {
        let of = |bytes: &[u8]| format_of("a", bytes);
        assert_eq!(of(b"\x00\x00\x27\x0a\x00"), VectorFormat::Shapefile);
        assert_eq!(of(b"SQLite format 3\0"), VectorFormat::GeoPackage);
        assert_eq!(of(b"fgb\x03fgb\x00"), VectorFormat::FlatGeobuf);
        assert_eq!(of(b"<?xml version=\"1.0\"?>\n<gpx>"), VectorFormat::Gpx);
        assert_eq!(of(b"<k:kml xmlns:k='x'>"), VectorFormat::Kml);
        assert_eq!(of(b"<?xml?>\n<!-- x --><osm version='0.6'>"), VectorFormat::OsmXml);
        assert_eq!(of(b"\0\0\0\x0d\x0a\x09OSMHeader\x18"), VectorFormat::OsmPbf);
        assert_eq!(of(b"\x1e{}\n"), VectorFormat::GeoJsonSequence);
        assert_eq!(of(b"{\"type\":\"Feature\"}\n{\"type\":\"Feature\"}"), VectorFormat::GeoJsonSequence);
        assert_eq!(of(b"{\"type\":\n\"Feature\"}\n"), VectorFormat::GeoJson);
    }

    #[test]
    fn other_formats_are_named_with_the_command_that_converts_them() {
        let error = refusal("roads/main.gml", b"<gml:FeatureCollection>");
        assert!(error.contains("this is GML"), "{error}");
        assert!(error.contains("ogr2ogr -f GeoJSON \"roads/main.geojson\" \"roads/main.gml\""), "{error}");
        assert!(
            refusal("a.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1").contains("no workbook that can be read")
        );
        assert!(refusal("a.shx", b"\x00\x00\x27\x0a").contains("give the .shp file"));
        assert!(refusal("a.parquet", b"PAR1").contains("GeoParquet"));
    }

    #[test]
    fn an_unknown_format_is_refused_with_those_that_are_read() {
        for bytes in [&b""[..], b"hello", b"\xff\xfe{", b"[1]"] {
            assert!(refusal("a", bytes).contains("GeoJSON is read"));
        }
    }

    #[test]
    fn packed_files_are_unpacked() {
        let kmz = zip(&[("doc.kml", KML), ("files/a.png", b"")]).expect("memory");
        assert_eq!(read("a.kmz", &kmz, &VectorHints::default()).expect("a KMZ").features.len(), 1);
        let single = zip(&[("layers/a.geojson", POINT)]).expect("memory");
        assert_eq!(read("a.zip", &single, &VectorHints::default()).expect("zipped").features.len(), 1);
        assert!(refusal("a.zip", &zip(&[("readme.txt", b"")]).expect("memory")).contains("without a .kml"));
        let mut shapes = 9994u32.to_be_bytes().to_vec();
        shapes.resize(100, 0);
        let zipped =
            zip(&[("x/roads.shp", &shapes), ("x/roads.prj", &b"EPSG:32616"[..]), ("x/rivers.shp", &shapes)])
                .expect("memory");
        assert!(refusal("a.zip", &zipped).contains("2 layers; choose one with 'layer': roads, rivers"));
        let hints = VectorHints { layer: Some("roads"), ..VectorHints::default() };
        assert_eq!(read("a.zip", &zipped, &hints).expect("zipped").crs.epsg(), Some(32616));
    }

    #[test]
    fn a_single_layer_has_the_name_of_the_file() {
        let of = |layer| read("in/hills.geojson", POINT, &VectorHints { layer, ..VectorHints::default() });
        assert!(of(Some("hills")).is_ok() && of(None).is_ok());
        let error = of(Some("hill")).expect_err("another").to_string();
        assert!(error.contains("did you mean 'hills'?"), "{error}");
    }
}
