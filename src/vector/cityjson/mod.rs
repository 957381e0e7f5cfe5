//! CityJSON 1.0, 1.1 and 2.0, and CityJSON text sequences: a `CityJSON` object on the first line, a `CityJSONFeature` on
//! each other.
//!
//! Each city object with a geometry is a feature: its footprint in the highest level of detail, or its lines or points,
//! with its attributes and those of its parents, and `id`, `type`, `parent` and `lod`. A [`CityModel`] holds the surfaces,
//! in all levels of detail.
//!
//! Written by hand, over `serde_json`: a limit holds for what templates multiply, and an object that cannot be read is left
//! out and reported.
//!
//! Heights are those of the file, meters above the zero of its vertical system. Of the system only the horizontal part is
//! read. Inner shells of solids, extensions' own geometry and transparency are not read.

pub mod body;
mod boundary;
mod footprint;
mod text;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use serde_json::Value;

use crate::builder::{FeatureParts, LayerBuilder};
use crate::cityjson::body::{CityBody, CityShapes, Referred, ShapeTally, Templates};
use crate::cityjson::text::{CityAppearance, CityText, GeometryText, ObjectText, VertexTransform};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::tally::RecordTally;
use sandtable_base::limits::{DESIGN_VERTICES, GEOJSON_BYTES};
use sandtable_geom::crs::{Crs, CrsError};

pub(crate) use crate::cityjson::text::is_cityjson;

const FORMAT: &str = "CityJSON file";

/// As many generations of parents as are followed.
const MOST_GENERATIONS: usize = 8;

/// The surfaces of a CityJSON file's objects.
#[derive(Clone, Debug)]
pub struct CityModel {
    /// The objects with surfaces, by their id, which is the property `id` of their features.
    pub objects: BTreeMap<String, CityObject>,
    /// The files of the textures' images, as the file names them.
    pub images: Vec<String>,
}

/// An object of a city.
#[derive(Clone, Debug)]
pub struct CityObject {
    /// Its type, such as `BuildingPart`.
    pub kind: String,
    /// The id of its farthest ancestor, of an object without parents its own: what is one building.
    pub root: String,
    /// Its surfaces, by ascending level of detail; at least one.
    pub bodies: Vec<CityBody>,
}

impl CityObject {
    /// Its surfaces in the level of detail `wanted`, else in the highest below it, else in the lowest; without a wish in
    /// the highest.
    pub fn body(&self, wanted: Option<&str>) -> Option<&CityBody> {
        let Some(wanted) = wanted else { return self.bodies.last() };
        let limit = lod_number(wanted);
        let exact = self.bodies.iter().find(|body| body.lod == wanted);
        exact
            .or_else(|| self.bodies.iter().rev().find(|body| lod_number(&body.lod) <= limit))
            .or_else(|| self.bodies.first())
    }
}

/// Reads the objects as features in the system that the file states, and their surfaces.
///
/// # Errors
/// [`VectorError`], also where no object is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<(VectorLayer, CityModel), VectorError> {
    if bytes.len() > GEOJSON_BYTES.count() {
        return Err(VectorError::TooLarge { bytes: bytes.len() });
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut lines = Texts { rest: bytes, line: 1 };
    let Some((place, first)) = lines.next() else {
        return Err(VectorError::broken(FORMAT, "line 1", "the file is empty"));
    };
    let head = parse(first, place)?;
    if head.kind == "CityJSONFeature" {
        return Err(VectorError::Unsupported {
            format: FORMAT,
            content: "a feature without the object before it that states how its vertices are scaled".into(),
            remedy: "put the first line of its sequence before it",
        });
    }
    let mut reader = ModelReader::new(&head, hints)?;
    reader.add(&head, &head, place);
    for (line, text) in lines {
        match parse(text, line) {
            Ok(feature) => reader.add(&feature, &head, line),
            Err(error) => reader.layer.add_broken(format!("line {line}"), error),
        }
    }
    reader.finish()
}

/// JSON texts one after the other, each with the line on which it begins.
struct Texts<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Iterator for Texts<'a> {
    type Item = (usize, &'a [u8]);

    /// The next text: a line that is a JSON text or, of the first, all of the file where its first line is none.
    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if self.rest.trim_ascii().is_empty() {
                return None;
            }
            let end = self.rest.iter().position(|&byte| byte == b'\n').map_or(self.rest.len(), |end| end + 1);
            let (mut text, mut rest) = self.rest.split_at(end);
            let trimmed = text.trim_ascii();
            let is_whole = trimmed.starts_with(b"{") && trimmed.ends_with(b"}");
            let (line, is_first) = (self.line, self.line == 1);
            if is_first && !is_whole {
                (text, rest) = (self.rest, &[]);
            }
            self.rest = rest;
            self.line += 1;
            if !text.trim_ascii().is_empty() {
                return Some((line, text));
            }
        }
    }
}

fn parse(text: &[u8], line: usize) -> Result<CityText<'_>, VectorError> {
    serde_json::from_slice(text.trim_ascii_end()).map_err(|error| {
        let place = format!("line {}, column {}", line + error.line().max(1) - 1, error.column().max(1));
        VectorError::broken(FORMAT, place, json_reason(&error))
    })
}

/// What is wrong with a text, without the place that the message has already.
fn json_reason(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let end = text.rfind(" at line ").unwrap_or(text.len());
    text[..end].chars().take(200).collect()
}

struct ModelReader {
    layer: LayerBuilder,
    objects: BTreeMap<String, CityObject>,
    images: Vec<String>,
    templates: Templates,
    tally: ShapeTally,
    without_geometry: RecordTally,
}

/// One text's objects, and what they refer to.
struct TextObjects<'a> {
    objects: BTreeMap<&'a str, ObjectText<'a>>,
    /// The ids that objects name as their parents.
    parents: BTreeSet<String>,
}

impl ModelReader {
    fn new(head: &CityText<'_>, hints: &VectorHints) -> Result<Self, VectorError> {
        let named = head.metadata.as_ref().and_then(|metadata| metadata.reference_system.as_deref());
        let crs = system(named, hints)?;
        let mut templates = Templates::default();
        let mut layer = LayerBuilder::new(crs);
        if let Some(stated) = &head.templates {
            templates.vertices = stated.vertices.iter().map(|&at| DVec3::from_array(at)).collect();
            for (number, text) in stated.templates.iter().enumerate() {
                let template: GeometryText = serde_json::from_str(text.get()).map_err(|error| {
                    VectorError::broken(FORMAT, format!("template {number}"), json_reason(&error))
                })?;
                templates.geometries.push(template);
            }
        }
        let version = head.version.as_ref().and_then(Value::as_str).unwrap_or_default();
        if !["1.", "2."].iter().any(|known| version.starts_with(known)) {
            layer.note(format!("the version is '{}'; it is read as CityJSON 2.0", shorten(version)));
        }
        Ok(Self {
            layer,
            objects: BTreeMap::new(),
            images: Vec::new(),
            templates,
            tally: ShapeTally { vertices_left: DESIGN_VERTICES.get(), lost_textures: 0 },
            without_geometry: RecordTally::new(),
        })
    }

    /// Adds the objects of a text that begins on a line.
    fn add(&mut self, text: &CityText<'_>, head: &CityText<'_>, line: usize) {
        let scaled = scaled(&text.vertices, text.transform.or(head.transform));
        let own = !text.appearance.textures.is_empty() || !text.appearance.materials.is_empty();
        let appearance: &CityAppearance = if own { &text.appearance } else { &head.appearance };
        let first_image = self.images.len();
        self.images.extend(appearance.textures.iter().map(|texture| texture.image.clone()));
        let mut objects = TextObjects { objects: BTreeMap::new(), parents: BTreeSet::new() };
        for (id, object) in &text.objects.0 {
            match serde_json::from_str::<ObjectText<'_>>(object.get()) {
                Ok(object) => {
                    objects.parents.extend(object.parents.iter().flatten().cloned());
                    objects.objects.insert(id, object);
                }
                Err(error) => {
                    let error = VectorError::broken(FORMAT, place(id, line), json_reason(&error));
                    self.layer.add_broken(place(id, line), error);
                }
            }
        }
        for (id, _) in &text.objects.0 {
            let Some(object) = objects.objects.get(id.as_str()) else { continue };
            let templates = std::mem::take(&mut self.templates);
            let referred = Referred { vertices: &scaled, appearance, first_image, templates: &templates };
            let added = self.add_object(id, object, &objects, &referred);
            self.templates = templates;
            if let Err(reason) = added {
                let error = VectorError::broken(FORMAT, place(id, line), reason);
                self.layer.add_broken(place(id, line), error);
            }
        }
    }

    fn add_object(
        &mut self,
        id: &str,
        object: &ObjectText<'_>,
        all: &TextObjects<'_>,
        referred: &Referred<'_>,
    ) -> Result<(), String> {
        let texts = object.geometry.as_deref().unwrap_or_default();
        if texts.is_empty() {
            if !all.parents.contains(id) {
                self.without_geometry.add(|| format!("city object '{}'", shorten(id)));
            }
            return Ok(());
        }
        let mut by_lod: Vec<(String, CityShapes)> = Vec::new();
        for text in texts {
            let geometry: GeometryText =
                serde_json::from_str(text.get()).map_err(|error| json_reason(&error))?;
            let shapes = body::shapes(&geometry, referred, &mut self.tally)?;
            let lod = match geometry.template {
                Some(number) => referred.templates.geometries.get(number).map(lod_text),
                None => Some(lod_text(&geometry)),
            };
            let lod = lod.unwrap_or_default();
            // Several geometries of one level are one body.
            match by_lod.iter_mut().find(|(known, _)| *known == lod) {
                Some((_, known)) => {
                    known.surfaces.extend(shapes.surfaces);
                    known.lines.extend(shapes.lines);
                    known.points.extend(shapes.points);
                }
                None => by_lod.push((lod, shapes)),
            }
        }
        by_lod.sort_by(|(a, _), (b, _)| lod_number(a).total_cmp(&lod_number(b)));
        let mut parts = FeatureParts::default();
        let with_surfaces = by_lod.iter().rev().find(|(_, shapes)| !shapes.surfaces.is_empty());
        let drawn = with_surfaces.or(by_lod.last());
        if let Some((_, shapes)) = drawn {
            let polygons = footprint::footprint(&shapes.surfaces)?;
            if polygons.is_empty() {
                shapes.lines.iter().for_each(|line| parts.add_line(line.clone()));
                if shapes.lines.is_empty() {
                    parts.add_points(shapes.points.clone());
                }
            }
            polygons.into_iter().for_each(|rings| parts.add_polygon(rings));
        }
        let lod = drawn.map(|(lod, _)| lod.clone()).unwrap_or_default();
        let ancestors = all.ancestors(id);
        let properties = properties(id, object, &ancestors, &lod);
        let root = ancestors.last().map_or(id, |(root, _)| root).to_owned();
        let bodies: Vec<CityBody> = by_lod
            .into_iter()
            .filter(|(_, shapes)| !shapes.surfaces.is_empty())
            .map(|(lod, shapes)| CityBody { lod, surfaces: shapes.surfaces })
            .collect();
        self.layer.add_at(parts, properties, || format!("city object '{}'", shorten(id)));
        if !bodies.is_empty() {
            let object = CityObject { kind: object.kind.clone(), root, bodies };
            self.objects.insert(id.to_owned(), object);
        }
        Ok(())
    }

    fn finish(self) -> Result<(VectorLayer, CityModel), VectorError> {
        let Self { mut layer, objects, images, without_geometry, tally, .. } = self;
        let [one, many] = ["city object without a geometry", "city objects without a geometry"];
        layer.note_omitted(&without_geometry, one, many);
        match tally.lost_textures {
            0 => {}
            1 => layer.note("1 ring without the texture that it names, which is not there"),
            count => {
                layer.note(format!("{count} rings without the textures that they name, which are not there"))
            }
        }
        Ok((layer.finish()?, CityModel { objects, images }))
    }
}

impl<'a> TextObjects<'a> {
    /// The parent of an object, its parent, and so on, of those that are there.
    fn ancestors(&self, id: &str) -> Vec<(&'a str, &ObjectText<'a>)> {
        let mut found: Vec<(&str, &ObjectText<'_>)> = Vec::new();
        let mut object = self.objects.get(id);
        while let Some(parent) = object.and_then(|object| object.parents.as_ref()?.first()) {
            let Some((&parent_id, parent)) = self.objects.get_key_value(parent.as_str()) else { break };
            if found.len() == MOST_GENERATIONS || parent_id == id {
                break;
            }
            found.push((parent_id, parent));
            object = Some(parent);
        }
        found
    }
}

/// The attributes of an object and, where it has none of that name, of its parents, then what it is.
fn properties(
    id: &str,
    object: &ObjectText<'_>,
    ancestors: &[(&str, &ObjectText<'_>)],
    lod: &str,
) -> Properties {
    let generations = std::iter::once(object).chain(ancestors.iter().map(|(_, ancestor)| *ancestor));
    let mut properties = Properties::new();
    for attributes in generations.filter_map(|object| object.attributes.as_ref()) {
        for (name, value) in attributes {
            properties.entry(name.clone()).or_insert_with(|| value.clone());
        }
    }
    properties.insert("id".into(), id.into());
    properties.insert("type".into(), object.kind.clone().into());
    if let Some((parent, _)) = ancestors.first() {
        properties.insert("parent".into(), (*parent).into());
    }
    if !lod.is_empty() {
        properties.insert("lod".into(), lod.into());
    }
    properties
}

fn place(id: &str, line: usize) -> String {
    match line {
        1 => format!("city object '{}'", shorten(id)),
        _ => format!("line {line}, city object '{}'", shorten(id)),
    }
}

fn scaled(vertices: &[[f64; 3]], transform: Option<VertexTransform>) -> Vec<DVec3> {
    let unit = VertexTransform { scale: [1.0; 3], translate: [0.0; 3] };
    let VertexTransform { scale, translate } = transform.unwrap_or(unit);
    let (scale, translate) = (DVec3::from_array(scale), DVec3::from_array(translate));
    vertices.iter().map(|&at| DVec3::from_array(at) * scale + translate).collect()
}

fn lod_text(geometry: &GeometryText) -> String {
    match &geometry.lod {
        Some(Value::String(text)) => text.trim().to_owned(),
        Some(Value::Number(number)) => number.to_string(),
        _ => String::new(),
    }
}

/// The order of levels of detail; what is no number is below all.
fn lod_number(lod: &str) -> f64 {
    lod.parse().ok().filter(|number: &f64| number.is_finite()).unwrap_or(f64::NEG_INFINITY)
}

/// The stated system, else the one that the file names: a URI or URN that ends in an EPSG code.
fn system(named: Option<&str>, hints: &VectorHints) -> Result<Crs, VectorError> {
    let code = named.and_then(|name| {
        let is_epsg = name.to_ascii_uppercase().contains("EPSG");
        let last = name.rsplit(['/', ':']).next()?;
        last.parse::<u32>().ok().filter(|_| is_epsg)
    });
    let crs: Result<Option<Crs>, CrsError> = hints.crs_or(code, named.filter(|_| code.is_none()));
    crs?.ok_or(VectorError::NoCrs { format: FORMAT, reason: "names no reference system" })
}

#[cfg(test)]
mod tests;
