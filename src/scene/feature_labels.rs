//! Labels of the features of a vector file.
//!
//! Features are taken in the order of their rank, and no more is done for a feature than its rank and its size until
//! it is its turn, so that of a large file the few that count are placed and written.

use std::collections::BTreeMap;

use glam::{DVec2, Vec3};
use rayon::prelude::*;

use crate::attributes::{Attributes, PROMINENCE, written};
use crate::exact_ground::ExactGround;
use crate::label_course::{LabelCourse, across, along};
use crate::named_summits::NamedSummits;
use crate::scene_findings::SceneFindings;
use crate::scene_label::{SceneLabel, whole_meters};
use crate::shape_place::{place, world_points};
use crate::sources::Sources;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, LabelTable};
use sandtable_description::expression::Expression;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::LabelKind;
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon::doubled_area;
use sandtable_terrain::lattice::Lattice;
use sandtable_vector::feature::{Geometry, Polygon};

/// The labels of the features that `table` names, in the order of their rank. `findings` gets a sentence on features
/// without one.
///
/// # Errors
/// The file cannot be read or holds no feature that matches.
pub(super) fn labels(
    table: &LabelTable,
    sources: &Sources<'_>,
    exact: &ExactGround<'_>,
    findings: &mut SceneFindings,
) -> Result<Vec<SceneLabel>, Diagnostic> {
    let (frame, lattice) = (sources.frame, exact.lattice);
    let Some(source) = table.source() else { return Ok(Vec::new()) };
    let text = Expression::parse(&table.text).map_err(|error| frame.document.error(&table.text, error))?;
    let (crs, features) = sources.features(&source)?;
    let summits = reads_prominence(table, &text).then(|| NamedSummits::new(lattice, exact.summits()));
    let known = |attributes: Attributes| {
        let prominence_m = summits.as_ref().and_then(|summits| {
            let at = place(attributes.geometry()?, &crs, frame, lattice)?;
            Some(summits.prominence_m(at.truncate().as_vec2()))
        });
        attributes.with_prominence(prominence_m)
    };
    let ranked = |attributes: Attributes| RankedFeature::new(table, known(attributes));
    let mut features: Vec<RankedFeature> = features.into_par_iter().map(ranked).collect();
    // Stable: the file's order decides in the end.
    features.sort_by(|a, b| a.rank.total_cmp(&b.rank).then(b.size.total_cmp(&a.size)));
    let most = table.most as usize;
    let (mut named, mut left_out, mut lines) = (Vec::new(), LeftOut::default(), BTreeMap::new());
    for RankedFeature { attributes, rank, .. } in features {
        let is_line = matches!(attributes.geometry(), Some(Geometry::Lines(_)));
        if named.len() == most && (!is_line || lines.is_empty()) {
            left_out.beyond += 1;
            continue;
        }
        let Some(text) = attributes.evaluated(&text).and_then(|text| written(&text)) else {
            left_out.nameless += 1;
            continue;
        };
        let text = if table.shield.is_some() { first_number(&text) } else { text };
        let Some(shape) = attributes.geometry() else {
            left_out.off += 1;
            continue;
        };
        // The pieces that a river or a road consists of in a file carry its name together.
        if let Some(&label) = lines.get(&text).filter(|_| is_line) {
            if follows(table) {
                let NamedFeature { lines, .. }: &mut NamedFeature = &mut named[label];
                lines.extend(world_lines(shape, &crs, frame));
            }
            continue;
        }
        if named.len() == most {
            left_out.beyond += 1;
            continue;
        }
        let Some(ground) = place(shape, &crs, frame, lattice) else {
            left_out.off += 1;
            continue;
        };
        let elevation = match text.contains("{height}") {
            true => whole_meters(exact.elevation_m(ground.truncate(), ground.z as f32)?),
            false => String::new(),
        };
        let Some(filled) = filled(&text, &elevation, &attributes) else {
            left_out.nameless += 1;
            continue;
        };
        let course = match shape {
            Geometry::Polygons(polygons) if follows(table) => {
                across(&world_polygons(polygons, &crs, frame), frame, lattice)
            }
            _ => LabelCourse::Place,
        };
        let pieces = if is_line && follows(table) { world_lines(shape, &crs, frame) } else { Vec::new() };
        if is_line {
            lines.insert(text, named.len());
        }
        let size = type_size(table, &attributes);
        let shield = attributes.value(table.shield.as_ref());
        let ground = ground.as_vec3();
        let anchor = ground + Vec3::Z * table.height as f32;
        let stated = table.text.span().unwrap_or_default();
        let label =
            SceneLabel { text: filled, stated, ground, anchor, course, kind: table.kind, rank, size, shield };
        named.push(NamedFeature { label, lines: pieces });
    }
    if named.is_empty() && left_out.off > 0 {
        sources.measure(&source)?;
    }
    let labels = named.into_iter().map(|named| named.with_course(frame, lattice)).collect();
    if let Some(sentence) = left_out.note(source.file.as_ref().map_or("", |file| file.as_str()), most) {
        findings.add(FindingCode::LeftOut, source.span(), sentence);
    }
    Ok(labels)
}

/// Whether labels of a document need the summits of the ground.
pub(super) fn need_summits(document: &Document) -> bool {
    document.style.spot_heights > 0
        || document.labels.iter().any(|table| {
            Expression::parse(&table.text)
                .is_ok_and(|text| table.at.is_none() && reads_prominence(table, &text))
        })
}

/// Whether an expression of a table of summits, of which `text` is one, reads their prominence.
fn reads_prominence(table: &LabelTable, text: &Expression) -> bool {
    table.kind == LabelKind::Summit
        && (text.properties().contains(&PROMINENCE)
            || table.rank.stated().is_some_and(|rank| rank.reads(PROMINENCE))
            || table.size.stated().is_some_and(|size| size.reads(PROMINENCE))
            || table.shield.as_ref().is_some_and(|shield| shield.reads(PROMINENCE)))
}

/// The first of several road numbers.
fn first_number(text: &str) -> String {
    text.split(';').map(str::trim).find(|number| !number.is_empty()).unwrap_or(text).to_owned()
}

/// Whether names follow their features; those wished above them on a leader line do not.
fn follows(table: &LabelTable) -> bool {
    table.height == 0.0
}

/// A label with the lines along which it may stand.
struct NamedFeature {
    label: SceneLabel,
    /// In world coordinates.
    lines: Vec<Vec<DVec2>>,
}

impl NamedFeature {
    fn with_course(self, frame: &WorldFrame<'_>, lattice: &Lattice) -> SceneLabel {
        let course =
            if self.lines.is_empty() { self.label.course } else { along(self.lines, frame, lattice) };
        SceneLabel { course, ..self.label }
    }
}

/// The rank of a feature in `table`; infinite where an expression gives none.
pub fn rank(table: &LabelTable, attributes: &Attributes) -> f64 {
    match table.rank.stated() {
        Some(rank) => attributes.value(Some(rank)).unwrap_or(f64::INFINITY),
        None => *table.rank.default(),
    }
}

/// The size of the letters of a feature in `table`; the usual one where an expression gives none.
pub fn type_size(table: &LabelTable, attributes: &Attributes) -> f32 {
    let stated = table.size.stated().and_then(|size| attributes.value(Some(size)));
    stated.unwrap_or(*table.size.default()) as f32
}

/// A feature with what decides its turn.
struct RankedFeature {
    attributes: Attributes,
    rank: f64,
    /// The length of lines and the area of polygons in the file's own unit; 0 for points.
    size: f64,
}

impl RankedFeature {
    fn new(table: &LabelTable, attributes: Attributes) -> Self {
        let rank = rank(table, &attributes);
        let size = attributes.geometry().map_or(0.0, size);
        // NaN would come before all others.
        Self { attributes, rank, size: if size.is_finite() { size } else { 0.0 } }
    }
}

fn size(shape: &Geometry) -> f64 {
    let length = |line: &Vec<DVec2>| line.windows(2).map(|leg| leg[0].distance(leg[1])).sum::<f64>();
    match shape {
        Geometry::Points(_) => 0.0,
        Geometry::Lines(lines) => lines.iter().map(length).sum(),
        Geometry::Polygons(polygons) => {
            polygons.iter().map(|polygon| doubled_area(&polygon.exterior).abs()).sum()
        }
    }
}

/// The number of features without a label, by reason.
#[derive(Default)]
struct LeftOut {
    nameless: usize,
    off: usize,
    beyond: usize,
}

impl LeftOut {
    fn note(&self, file: &str, most: usize) -> Option<String> {
        let reasons = [
            (self.nameless, "give no text".to_owned()),
            (self.off, "lie off the elevation model".to_owned()),
            (self.beyond, format!("come after the {most} that `most` allows")),
        ];
        let told = reasons.iter().filter(|(count, _)| *count > 0);
        let told: Vec<String> = told.map(|(count, why)| format!("{count} {why}")).collect();
        (!told.is_empty()).then(|| format!("features of '{file}' without a label: {}", told.join(", ")))
    }
}

/// `text` with `{height}` and every `{property}` replaced; `None` where the feature does not have that property. A brace
/// that is not closed stays.
fn filled(text: &str, elevation: &str, attributes: &Attributes) -> Option<String> {
    let (mut out, mut rest) = (String::new(), text);
    while let Some((before, name, after)) = next_brace(rest) {
        out.push_str(before);
        match name {
            "height" => out.push_str(elevation),
            _ => out.push_str(&attributes.get(name).and_then(|value| written(&value))?),
        }
        rest = after;
    }
    out.push_str(rest);
    Some(out)
}

/// What is before, in, and after the first pair of braces.
fn next_brace(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('{')?;
    let (name, after) = rest.split_once('}')?;
    Some((before, name, after))
}

fn world_lines(shape: &Geometry, crs: &Crs, frame: &WorldFrame<'_>) -> Vec<Vec<DVec2>> {
    match shape {
        Geometry::Lines(lines) => lines.iter().filter_map(|line| world_points(line, crs, frame)).collect(),
        Geometry::Points(_) | Geometry::Polygons(_) => Vec::new(),
    }
}

/// The outer rings; holes do not matter to a name.
fn world_polygons(polygons: &[Polygon], crs: &Crs, frame: &WorldFrame<'_>) -> Vec<Polygon> {
    let outer = |polygon: &Polygon| world_points(&polygon.exterior, crs, frame);
    polygons.iter().filter_map(outer).map(|exterior| Polygon { exterior, holes: Vec::new() }).collect()
}
