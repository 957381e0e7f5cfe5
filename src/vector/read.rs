//! A vector file by its content: GeoJSON is read, other formats are named with the command that converts
//! them.

use crate::geom::crs::Crs;
use crate::vector::error::VectorError;
use crate::vector::feature::Layer;
use crate::vector::geojson;

/// What the caller knows of a vector file beyond its bytes.
pub struct Hints<'a> {
    /// The coordinate system, in place of what the file says or where it says nothing.
    pub crs: Option<&'a Crs>,
    /// Which layer of a file that may hold several; without it the file must hold one.
    pub layer: Option<&'a str>,
    /// The bytes of a file that lies beside this one, by its name: the name given to [`read`] with another extension.
    /// `None` where there is none.
    pub companions: &'a dyn Fn(&str) -> Option<Vec<u8>>,
}

impl Default for Hints<'_> {
    fn default() -> Self {
        Self { crs: None, layer: None, companions: &|_| None }
    }
}

/// All features of a vector file, or of one of its layers.
///
/// The content decides what format it is; `name` only where the content does not tell, and for messages.
///
/// # Errors
/// [`VectorError`], for a format that is not read with the command that converts it.
pub fn read(name: &str, bytes: &[u8], hints: &Hints) -> Result<Layer, VectorError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    match other_by_content(bytes, text).or_else(|| other_by_name(name, text)) {
        Some(format) => Err(VectorError::OtherFormat { format, command: conversion(name) }),
        None if text.first() == Some(&b'{') => geojson::read_as(bytes, hints.crs),
        None => Err(VectorError::UnknownFormat),
    }
}

/// The format that the first bytes tell, if it is not JSON. `text` is `bytes` without what may precede text.
fn other_by_content(bytes: &[u8], text: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 6] = [
        (b"\x00\x00\x27\x0a", "an ESRI shapefile"),
        (b"SQLite format 3\0", "a GeoPackage or another SQLite database"),
        (b"fgb", "FlatGeobuf"),
        (b"PAR1", "GeoParquet"),
        (b"PK\x03\x04", "a ZIP archive (KMZ, or a zipped shapefile)"),
        (b"\x1f\x8b", "a gzip archive"),
    ];
    let magic = MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, format)| *format);
    magic.or_else(|| xml(text)).or_else(|| osm_pbf(bytes))
}

fn xml(text: &[u8]) -> Option<&'static str> {
    const LOOKED_AT: usize = 1024;
    if text.first() != Some(&b'<') {
        return None;
    }
    let head = &text[..text.len().min(LOOKED_AT)];
    let holds = |tag: &[u8]| head.windows(tag.len()).any(|window| window.eq_ignore_ascii_case(tag));
    Some(match () {
        () if holds(b"<kml") => "KML",
        () if holds(b"<gpx") => "GPX",
        () if holds(b"<osm") => "OpenStreetMap XML",
        () if holds(b"gml") => "GML",
        () => "XML",
    })
}

fn osm_pbf(bytes: &[u8]) -> Option<&'static str> {
    bytes.get(4..).filter(|rest| rest.starts_with(b"\x0a\x09OSMHeader")).map(|_| "OpenStreetMap PBF")
}

/// The format that the name's extension tells, for content without a signature of its own.
fn other_by_name(name: &str, text: &[u8]) -> Option<&'static str> {
    let extension = name.rsplit_once('.')?.1.to_ascii_lowercase();
    match extension.as_str() {
        "csv" | "tsv" | "txt" | "xyz" => Some("a table of text"),
        "dbf" | "shx" | "prj" | "cpg" => Some("a part of an ESRI shapefile"),
        "tab" | "mif" | "mid" => Some("MapInfo"),
        "dxf" | "dwg" => Some("a CAD drawing"),
        "geojsonl" | "geojsons" | "ndjson" | "jsonl" => Some("a sequence of GeoJSON texts, one to a line"),
        _ if text.first() == Some(&0x1e) => Some("a GeoJSON text sequence (RFC 8142)"),
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

    fn refusal(name: &str, bytes: &[u8]) -> String {
        read(name, bytes, &Hints::default()).expect_err(name).to_string()
    }

    #[test]
    fn content_decides_before_the_name() {
        let text = b"\xef\xbb\xbf \n{\"type\":\"Point\",\"coordinates\":[1,2]}";
        for name in ["a.geojson", "a.json", "a.xyzzy", "a"] {
            assert_eq!(read(name, text, &Hints::default()).expect(name).features.len(), 1);
        }
        assert!(refusal("a.geojson", b"SQLite format 3\0...").contains("GeoPackage"));
    }

    #[test]
    fn other_formats_are_named_with_the_way_out() {
        let error = refusal("roads/main.shp", b"\x00\x00\x27\x0a\x00");
        assert!(error.contains("an ESRI shapefile"), "{error}");
        assert!(error.contains("ogr2ogr -f GeoJSON \"roads/main.geojson\" \"roads/main.shp\""), "{error}");
        assert!(refusal("a.kml", b"<?xml version=\"1.0\"?>\n<kml xmlns=\"x\">").contains("this is KML"));
        assert!(refusal("a.gpx", b"<?xml?><gpx>").contains("this is GPX"));
        assert!(refusal("a.osm.pbf", b"\0\0\0\x0d\x0a\x09OSMHeader\x18").contains("OpenStreetMap PBF"));
        assert!(refusal("a.csv", b"x,y\n1,2\n").contains("a table of text"));
        assert!(refusal("a.geojsonl", b"{}\n{}\n").contains("one to a line"));
    }

    #[test]
    fn nothing_known_is_told_so() {
        for bytes in [&b""[..], b"hello", b"\xff\xfe{", b"[1]"] {
            assert!(refusal("a", bytes).contains("GeoJSON is read"));
        }
    }
}
