//! Well-known text, the shapes of a column (OGC 06-103r4, with `SRID=` of EWKT): points, lines, polygons, several of one kind and
//! collections, with and without Z and M.

use crate::builder::{FeatureParts, Vertices, position};
use sandtable_base::limits::GEOMETRY_DEPTH;

/// The words that a shape begins with.
const KINDS: [&str; 10] = [
    "POINT",
    "LINESTRING",
    "LINEARRING",
    "POLYGON",
    "TRIANGLE",
    "MULTIPOINT",
    "MULTILINESTRING",
    "MULTIPOLYGON",
    "GEOMETRYCOLLECTION",
    "POLYHEDRALSURFACE",
];

/// The shape of a text, and the code of its system where the text has one.
///
/// # Errors
/// A sentence on what is wrong.
pub(super) fn read(text: &str) -> Result<(FeatureParts, Option<u32>), String> {
    let text = text.trim();
    let (code, shape) = match text.get(..5).filter(|start| start.eq_ignore_ascii_case("SRID=")) {
        Some(_) => {
            let (code, shape) = text[5..].split_once(';').ok_or("'SRID=' without a ';' behind its code")?;
            let code = code.trim().parse().map_err(|_| format!("'SRID={code}' is no code"))?;
            (Some(code), shape)
        }
        None => (None, text),
    };
    let mut reader = WktReader { rest: shape };
    let mut parts = FeatureParts::default();
    reader.shape(&mut parts, 0)?;
    match reader.rest.trim_start() {
        "" => Ok((parts, code)),
        rest => Err(format!("'{}' follows the shape", head(rest))),
    }
}

fn head(text: &str) -> String {
    text.chars().take(20).collect()
}

struct WktReader<'a> {
    rest: &'a str,
}

impl<'a> WktReader<'a> {
    fn word(&mut self) -> &'a str {
        let rest = self.rest.trim_start();
        let end = rest.find(|letter: char| !letter.is_ascii_alphabetic()).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        self.rest = after;
        word
    }

    fn takes(&mut self, sign: char) -> bool {
        let rest = self.rest.trim_start().strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn need(&mut self, sign: char) -> Result<(), String> {
        match self.takes(sign) {
            true => Ok(()),
            false => Err(format!("'{sign}' is missing before '{}'", head(self.rest.trim_start()))),
        }
    }

    fn shape(&mut self, parts: &mut FeatureParts, depth: usize) -> Result<(), String> {
        if depth > GEOMETRY_DEPTH.count() {
            return Err(format!("collections are more than {GEOMETRY_DEPTH} deep"));
        }
        let word = self.word().to_ascii_uppercase();
        let attached = KINDS
            .iter()
            .find(|kind| word.strip_prefix(**kind).is_some_and(|rest| matches!(rest, "" | "Z" | "M" | "ZM")));
        let kind = attached
            .ok_or_else(|| format!("'{}' is no shape of well-known text that is read", head(&word)))?;
        let mut dimensions = word[kind.len()..].to_owned();
        let before = self.rest;
        match self.word().to_ascii_uppercase().as_str() {
            "" => {}
            "EMPTY" => return Ok(()),
            stated @ ("Z" | "M" | "ZM") => {
                dimensions = stated.to_owned();
                let before = self.rest;
                if self.word().eq_ignore_ascii_case("EMPTY") {
                    return Ok(());
                }
                self.rest = before;
            }
            _ => self.rest = before,
        }
        let has_z = dimensions != "M";
        match *kind {
            "POINT" => {
                let points = self.vertices(has_z)?;
                parts.add_points(points);
            }
            "LINESTRING" | "LINEARRING" => {
                let line = self.vertices(has_z)?;
                parts.add_line(line);
            }
            "POLYGON" | "TRIANGLE" => self.polygon(parts, has_z)?,
            "MULTIPOINT" => self.each(|reader| {
                let point = if reader.rest.trim_start().starts_with('(') {
                    reader.vertices(has_z)?
                } else if reader.is_empty_shape() {
                    Vertices::new()
                } else {
                    vec![reader.vertex(has_z)?]
                };
                parts.add_points(point);
                Ok(())
            })?,
            "MULTILINESTRING" => self.each(|reader| {
                if !reader.is_empty_shape() {
                    let line = reader.vertices(has_z)?;
                    parts.add_line(line);
                }
                Ok(())
            })?,
            "MULTIPOLYGON" | "POLYHEDRALSURFACE" => self
                .each(|reader| if reader.is_empty_shape() { Ok(()) } else { reader.polygon(parts, has_z) })?,
            _ => self.each(|reader| reader.shape(parts, depth + 1))?,
        }
        Ok(())
    }

    /// Takes the word of a shape without content.
    fn is_empty_shape(&mut self) -> bool {
        let before = self.rest;
        let is_empty = self.word().eq_ignore_ascii_case("EMPTY");
        if !is_empty {
            self.rest = before;
        }
        is_empty
    }

    /// A list in parentheses.
    fn each(&mut self, mut one: impl FnMut(&mut Self) -> Result<(), String>) -> Result<(), String> {
        self.need('(')?;
        loop {
            one(self)?;
            if !self.takes(',') {
                return self.need(')');
            }
        }
    }

    fn polygon(&mut self, parts: &mut FeatureParts, has_z: bool) -> Result<(), String> {
        let mut rings = Vec::new();
        self.each(|reader| {
            rings.push(reader.vertices(has_z)?);
            Ok(())
        })?;
        parts.add_polygon(rings);
        Ok(())
    }

    fn vertices(&mut self, has_z: bool) -> Result<Vertices, String> {
        let mut vertices = Vertices::new();
        self.each(|reader| {
            vertices.push(reader.vertex(has_z)?);
            Ok(())
        })?;
        Ok(vertices)
    }

    fn vertex(&mut self, has_z: bool) -> Result<glam::DVec3, String> {
        let (x, y) = (self.number()?, self.number()?);
        let mut third = None;
        for index in 0..2 {
            if self.rest.trim_start().starts_with([',', ')']) {
                break;
            }
            let number = self.number()?;
            third = if index == 0 { Some(number) } else { third };
        }
        Ok(position(x, y, third.filter(|_| has_z)))
    }

    fn number(&mut self) -> Result<f64, String> {
        let rest = self.rest.trim_start();
        let end = rest.find(|letter: char| letter.is_whitespace() || matches!(letter, ',' | '(' | ')'));
        let (text, after) = rest.split_at(end.unwrap_or(rest.len()));
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        self.rest = after;
        number.ok_or_else(|| format!("'{}' is no number", head(text)))
    }
}
