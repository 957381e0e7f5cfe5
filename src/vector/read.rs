//! A vector file by its content: what is read, and what is named with the command that converts it.
//!
//! | format | layers | coordinate system |
//! |---|---|---|
//! | GeoJSON, also one feature to a line or as a text sequence | one | its `crs` member, else EPSG:4326 |
//! | ESRI shapefile, also zipped | one; of an archive the names of its `.shp` files | its `.prj` |
//! | GeoPackage | its tables and views of features | as it says |
//! | FlatGeobuf | one | as it says |
//! | GPX | waypoints, routes, tracks; route_points, track_points | EPSG:4326 |
//! | KML, KMZ | the names of its folders; all where none is asked for | EPSG:4326 |
//! | OpenStreetMap XML and PBF | points, lines, multipolygons; roads, railways, waterways, water, buildings | EPSG:4326 |
//!
//! Any of them may be packed by gzip.

use std::borrow::Cow;

use crate::geom::crs::Crs;
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::packed::{self, Zip};
use crate::vector::{flatgeobuf, geojson, geopackage, gpx, kml, osm, shapefile};

/// What the caller knows of a vector file beyond its bytes.
pub struct VectorHints<'a> {
    /// The coordinate system, in place of what the file says or where it says nothing.
    pub crs: Option<&'a Crs>,
    /// Which layer of a file that may hold several; without it the file must hold one.
    pub layer: Option<&'a str>,
    /// The bytes of a file that lies beside this one, by its name: the name given to [`read`] with another extension.
    /// `None` where there is none.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for VectorHints<'_> {
    fn default() -> Self {
        Self { crs: None, layer: None, companions: &|_| None }
    }
}

/// All features of a vector file, or of one of its layers.
///
/// The content decides what format it is; `name` only where the content does not tell, for the names of companions,
/// and for messages.
///
/// # Errors
/// [`VectorError`], for a format that is not read with the command that converts it.
pub fn read(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    if packed::is_gzip(bytes) {
        let stem = name.strip_suffix(".gz").unwrap_or(name);
        return plain(stem, &packed::gunzip(bytes)?, hints);
    }
    if packed::is_zip(bytes) { archive(name, bytes, hints) } else { plain(name, bytes, hints) }
}

/// A file that is not packed.
fn plain(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let (stated, layer) = (hints.crs, hints.layer);
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match format(name, bytes, text) {
        VectorFormat::GeoJson => one(name, layer, geojson::read_as(bytes, stated)),
        VectorFormat::GeoJsonSequence => one(name, layer, geojson::sequence::read(bytes, stated)),
        VectorFormat::Shapefile => {
            let beside = |extension: &str| beside(name, extension, hints);
            let files = shapefile::Files {
                shapes: bytes,
                index: beside("shx"),
                table: beside("dbf"),
                system: beside("prj"),
                encoding: beside("cpg"),
            };
            one(name, layer, shapefile::read(&files, stated))
        }
        VectorFormat::GeoPackage => geopackage::read(bytes, stated, layer),
        VectorFormat::FlatGeobuf => one(name, layer, flatgeobuf::read(bytes, stated)),
        VectorFormat::Gpx => gpx::read(bytes, stated, layer),
        VectorFormat::Kml => kml::read(bytes, stated, layer),
        VectorFormat::OsmXml => osm::read_xml(bytes, stated, layer),
        VectorFormat::OsmPbf => osm::read_pbf(bytes, stated, layer),
        VectorFormat::Other(format) => Err(VectorError::OtherFormat { format, command: conversion(name) }),
        VectorFormat::Unknown => Err(VectorError::UnknownFormat),
    }
}

/// A layer of a format that has one to a file, which may be asked for by the file's own name.
fn one(
    name: &str,
    wanted: Option<&str>,
    layer: Result<VectorLayer, VectorError>,
) -> Result<VectorLayer, VectorError> {
    let own = stem(name);
    match wanted {
        Some(wanted) if wanted != own => Err(VectorError::no_such_layer(wanted, &[own])),
        _ => layer,
    }
}

/// The file's name without folders and extension.
fn stem(name: &str) -> &str {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file.split_once('.').map_or(file, |(stem, _)| stem)
}

/// The file beside `name` with another extension, in small letters or in capitals.
fn beside(name: &str, extension: &str, hints: &VectorHints) -> Option<Vec<u8>> {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let spelled = [extension.to_owned(), extension.to_ascii_uppercase()];
    spelled.iter().find_map(|extension| (hints.companions)(&format!("{stem}.{extension}")))
}

/// An archive: a KMZ, a zipped shapefile, or one file of another format.
fn archive(name: &str, bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    const READ: [&str; 6] = [".geojson", ".json", ".gpkg", ".fgb", ".gpx", ".osm"];
    let zip = Zip::open(bytes)?;
    let ending = |extension: &str| {
        let ends = |member: &&str| member.to_ascii_lowercase().ends_with(extension);
        zip.names().filter(ends).collect::<Vec<_>>()
    };
    let content = |member: &str| {
        zip.member(member)?.ok_or_else(|| VectorError::broken("zip archive", member, "it is not there"))
    };
    // A KMZ's document is the first .kml in it (OGC 07-147r2, section 8.1).
    if let Some(document) = ending(".kml").first() {
        return plain(document, &content(document)?, hints);
    }
    let shapes = ending(".shp");
    if let Some(member) = chosen(&shapes, hints.layer)? {
        let companions = |name: &str| zip.member(name).ok().flatten();
        let hints = VectorHints { crs: hints.crs, layer: None, companions: &companions };
        return plain(member, &content(member)?, &hints);
    }
    let others: Vec<&str> = READ.iter().flat_map(|extension| ending(extension)).collect();
    match others[..] {
        [only] => plain(only, &content(only)?, hints),
        _ => Err(VectorError::OtherFormat {
            format: "a zip archive without a .kml, a .shp or one other vector file",
            command: format!("unzip \"{name}\""),
        }),
    }
}

/// The shapefile of an archive that was asked for, or its only one; `None` where it has none.
fn chosen<'n>(members: &[&'n str], wanted: Option<&str>) -> Result<Option<&'n str>, VectorError> {
    let names: Vec<&str> = members.iter().map(|member| stem(member)).collect();
    match (members, wanted) {
        ([], _) => Ok(None),
        (&[only], None) => Ok(Some(only)),
        (_, None) => Err(VectorError::which_layer(&names)),
        (_, Some(wanted)) => {
            let at = names.iter().position(|&name| name == wanted);
            at.map(|at| Some(members[at])).ok_or_else(|| VectorError::no_such_layer(wanted, &names))
        }
    }
}

/// What a file is.
#[derive(Debug, PartialEq, Eq)]
enum VectorFormat {
    GeoJson,
    GeoJsonSequence,
    Shapefile,
    GeoPackage,
    FlatGeobuf,
    Gpx,
    Kml,
    OsmXml,
    OsmPbf,
    /// Known, but not read.
    Other(&'static str),
    Unknown,
}

/// What the content tells, and where it does not, the name. `text` is `bytes` without what may precede text.
fn format(name: &str, bytes: &[u8], text: &[u8]) -> VectorFormat {
    match () {
        () if shapefile::is_shapefile(bytes) => by_extension_of_shapefile(name),
        () if geopackage::is_sqlite(bytes) => VectorFormat::GeoPackage,
        () if flatgeobuf::is_flatgeobuf(bytes) => VectorFormat::FlatGeobuf,
        () if osm::is_pbf(bytes) => VectorFormat::OsmPbf,
        () if bytes.starts_with(b"PAR1") => VectorFormat::Other("GeoParquet"),
        () => xml(bytes).or_else(|| other_by_name(name)).unwrap_or_else(|| match text.first() {
            Some(&geojson::sequence::RECORD_SEPARATOR) => VectorFormat::GeoJsonSequence,
            Some(b'{') if geojson::sequence::is_lines(text) => VectorFormat::GeoJsonSequence,
            Some(b'{') => VectorFormat::GeoJson,
            _ => VectorFormat::Unknown,
        }),
    }
}

/// A `.shx` file starts as a `.shp` file does.
fn by_extension_of_shapefile(name: &str) -> VectorFormat {
    let is_index = name.len() >= 4 && name.is_char_boundary(name.len() - 4);
    match is_index && name[name.len() - 4..].eq_ignore_ascii_case(".shx") {
        true => VectorFormat::Other("the index of an ESRI shapefile; give the .shp file"),
        false => VectorFormat::Shapefile,
    }
}

/// The format whose outermost element XML shows in its first kilobytes.
fn xml(bytes: &[u8]) -> Option<VectorFormat> {
    const LOOKED_AT: usize = 4096;
    let head = &bytes[..bytes.len().min(LOOKED_AT)];
    // Every second byte of UTF-16 is text enough to know the element by.
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
        () if holds(b"<osm") => VectorFormat::OsmXml,
        () if holds(b"gml") => VectorFormat::Other("GML"),
        () => VectorFormat::Other("XML of no kind that is read"),
    })
}

/// The format that the name's extension tells, for content without a signature of its own.
fn other_by_name(name: &str) -> Option<VectorFormat> {
    let extension = name.rsplit_once('.')?.1.to_ascii_lowercase();
    match extension.as_str() {
        "csv" | "tsv" | "txt" | "xyz" => Some(VectorFormat::Other("a table of text")),
        "dbf" | "shx" | "prj" | "cpg" => {
            Some(VectorFormat::Other("a part of an ESRI shapefile; give the .shp file"))
        }
        "tab" | "mif" | "mid" => Some(VectorFormat::Other("MapInfo")),
        "dxf" | "dwg" => Some(VectorFormat::Other("a CAD drawing")),
        "geojsonl" | "geojsons" | "geojsonseq" | "ndjson" | "jsonl" => Some(VectorFormat::GeoJsonSequence),
        _ => None,
    }
}

/// The command that makes GeoJSON of the file `name`.
fn conversion(name: &str) -> String {
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    format!("ogr2ogr -f GeoJSON \"{stem}.geojson\" \"{name}\"")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::packed::tests::stored;

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
        let of = |bytes: &[u8]| format("a", bytes, bytes.trim_ascii_start());
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
    fn other_formats_are_named_with_the_way_out() {
        let error = refusal("roads/main.gml", b"<gml:FeatureCollection>");
        assert!(error.contains("this is GML"), "{error}");
        assert!(error.contains("ogr2ogr -f GeoJSON \"roads/main.geojson\" \"roads/main.gml\""), "{error}");
        assert!(refusal("a.csv", b"x,y\n1,2\n").contains("a table of text"));
        assert!(refusal("a.shx", b"\x00\x00\x27\x0a").contains("give the .shp file"));
        assert!(refusal("a.parquet", b"PAR1").contains("GeoParquet"));
    }

    #[test]
    fn nothing_known_is_told_so() {
        for bytes in [&b""[..], b"hello", b"\xff\xfe{", b"[1]"] {
            assert!(refusal("a", bytes).contains("GeoJSON is read"));
        }
    }

    #[test]
    fn what_is_packed_is_unpacked() {
        let kmz = stored(&[("doc.kml", KML), ("files/a.png", b"")]);
        assert_eq!(read("a.kmz", &kmz, &VectorHints::default()).expect("a KMZ").features.len(), 1);
        let zipped = stored(&[("layers/a.geojson", POINT)]);
        assert_eq!(read("a.zip", &zipped, &VectorHints::default()).expect("zipped").features.len(), 1);
        assert!(refusal("a.zip", &stored(&[("readme.txt", b"")])).contains("without a .kml"));
        let mut shapes = 9994u32.to_be_bytes().to_vec();
        shapes.resize(100, 0);
        let zipped =
            stored(&[("x/roads.shp", &shapes), ("x/roads.prj", b"EPSG:32616"), ("x/rivers.shp", &shapes)]);
        assert!(refusal("a.zip", &zipped).contains("2 layers; say which with 'layer': roads, rivers"));
        let hints = VectorHints { layer: Some("roads"), ..VectorHints::default() };
        assert_eq!(read("a.zip", &zipped, &hints).expect("zipped").crs.epsg(), Some(32616));
    }

    #[test]
    fn a_single_layer_is_asked_for_by_the_files_name_or_not_at_all() {
        let of = |layer| read("in/hills.geojson", POINT, &VectorHints { layer, ..VectorHints::default() });
        assert!(of(Some("hills")).is_ok() && of(None).is_ok());
        let error = of(Some("hill")).expect_err("another").to_string();
        assert!(error.contains("did you mean 'hills'?"), "{error}");
    }
}
