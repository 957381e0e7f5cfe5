//! Many GeoJSON texts in one file: a text sequence (RFC 8142), each after a record separator, or one to a line
//! (newline-delimited), as programs stream them.

use geojson::GeoJson;

use crate::geom::crs::Crs;
use crate::vector::collect::Collector;
use crate::vector::error::VectorError;
use crate::vector::feature::VectorLayer;
use crate::vector::geojson::{MAX_BYTES, add};

/// What each text of a sequence starts with (RFC 7464).
pub(in crate::vector) const RECORD_SEPARATOR: u8 = 0x1e;

/// Whether the first line is a whole JSON text and another follows it.
pub(in crate::vector) fn is_lines(text: &[u8]) -> bool {
    let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let is_object = |line: &[u8]| line.starts_with(b"{") && line.ends_with(b"}");
    lines.next().is_some_and(is_object) && lines.next().is_some_and(|line| line.starts_with(b"{"))
}

/// All features of all texts, in `stated` or else in longitude and latitude on WGS 84, which both standards fix.
///
/// # Errors
/// [`VectorError`] for the first text that is no GeoJSON; the last one too, though RFC 8142 would forgive it for being
/// cut short.
pub(in crate::vector) fn read(bytes: &[u8], stated: Option<&Crs>) -> Result<VectorLayer, VectorError> {
    if bytes.len() > MAX_BYTES {
        return Err(VectorError::TooLarge { bytes: bytes.len(), limit: MAX_BYTES });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let separated = bytes.trim_ascii_start().first() == Some(&RECORD_SEPARATOR);
    let separator = if separated { RECORD_SEPARATOR } else { b'\n' };
    let mut collector = Collector::new(stated.cloned().unwrap_or_else(Crs::wgs84));
    let mut line = 1;
    for text in bytes.split(|&byte| byte == separator) {
        if !text.trim_ascii().is_empty() {
            features(text, line, &mut collector)?;
        }
        line += text.iter().filter(|&&byte| byte == b'\n').count() + usize::from(!separated);
    }
    Ok(collector.finish())
}

/// The features of one text that starts on `line`.
fn features(text: &[u8], line: usize, collector: &mut Collector) -> Result<(), VectorError> {
    let parsed: GeoJson = serde_json::from_slice(text).map_err(|error| {
        let reason = error.to_string();
        let end = reason.rfind(" at line ").unwrap_or(reason.len());
        let reason = reason[..end].chars().take(200).collect();
        VectorError::Malformed { line: line + error.line().max(1) - 1, column: error.column().max(1), reason }
    })?;
    match parsed {
        GeoJson::FeatureCollection(all) => {
            all.features.into_iter().try_for_each(|feature| add(collector, feature))
        }
        GeoJson::Feature(one) => add(collector, one),
        GeoJson::Geometry(only) => add(collector, geojson::Feature::from(only)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn feature(x: u32) -> String {
        format!(
            r#"{{"type":"Feature","properties":{{"x":{x}}},"geometry":{{"type":"Point","coordinates":[{x},2]}}}}"#
        )
    }

    #[test]
    fn sequences_and_lines_are_read_alike() {
        let sequence = format!("\u{1e}{}\n\u{1e}{}\n", feature(1), feature(2).replace(',', ",\n"));
        let lines = format!("{}\r\n\n{}", feature(1), feature(2));
        for text in [sequence, lines] {
            let layer = read(text.as_bytes(), None).expect("sound");
            let values: Vec<_> = layer.features.iter().map(|feature| &feature.properties["x"]).collect();
            assert_eq!(values, [1, 2]);
        }
    }

    #[test]
    fn the_line_of_a_broken_text_is_told() {
        let text = format!("{}\n{}\n{{\"type\":\n", feature(1), feature(2));
        let error = read(text.as_bytes(), None).expect_err("cut short").to_string();
        assert!(error.starts_with("line 3, "), "{error}");
    }
}
