//! DXF drawings, as text and binary, of all releases: entities with their layers, colors and texts; blocks where they are
//! inserted.
//!
//! | entity | shape |
//! |---|---|
//! | LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE, SPLINE, LEADER | lines; arcs as chords of one degree |
//! | 3DFACE, SOLID, TRACE, meshes of POLYLINE, HATCH | polygons; those of meshes and faces with their elevations |
//! | POINT, TEXT, MTEXT, ATTRIB | points |
//! | INSERT, DIMENSION | what the block draws there; of INSERT a point as well |
//!
//! Properties are `Layer` (as GDAL names it, since `layer` is OpenStreetMap's for what passes over what), `type`, `handle`, `stroke` (its color as drawn), `linetype`, `text`, `text_height`, `rotation`;
//! of an inserted block also `block` and its attributes by their tags. Layers are those of the drawing; all where none is
//! requested, but for those that are off or frozen. What lies on paper and what is invisible is left out, and so are solids
//! of ACIS, regions, images and rays, with their counts.
//!
//! A drawing names no coordinate system: the key `crs` does. Its unit is told where it is another than the system's.
//!
//! Written by hand. `dxf` 0.6 panics on a drawing whose time of change is out of bounds, refuses all of it for one odd value,
//! and builds a decoder of pictures and a clock; blocks, planes and colors are left to its caller.

mod colors;
mod curves;
mod entity;
mod groups;
mod hatch;
mod text;

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};
use serde_json::Number;

use crate::builder::{FeatureParts, LayerBuilder};
use crate::dxf::colors::DxfColor;
use crate::dxf::entity::{BlockInsert, DxfEntity, DxfRecord, DxfShape};
use crate::dxf::groups::GroupReader;
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::rings::{HoleRule, RingSorter};
use sandtable_base::limits::DESIGN_VERTICES;
use sandtable_geom::length_unit::US_SURVEY_FOOT_M;

const FORMAT: &str = "DXF file";

/// As many blocks in blocks as are drawn.
const MOST_NESTED: usize = 16;

/// The most groups of one entity: a line of a million vertices.
const MOST_GROUPS: usize = 1 << 22;

/// As many vertices as an entity of a block weighs at least.
const FEATURE_WEIGHT: usize = 8;

/// Units by the numbers of `$INSUNITS`, and meters in each.
const UNITS: [(i64, &str, f64); 12] = [
    (1, "inches", 0.0254),
    (2, "feet", 0.3048),
    (3, "miles", 1609.344),
    (4, "millimeters", 0.001),
    (5, "centimeters", 0.01),
    (6, "meters", 1.0),
    (7, "kilometers", 1000.0),
    (10, "yards", 0.9144),
    (14, "decimeters", 0.1),
    (15, "decameters", 10.0),
    (16, "hectometers", 100.0),
    (21, "US survey feet", US_SURVEY_FOOT_M),
];

/// Whether bytes are those of a drawing.
pub(super) fn is_dxf(bytes: &[u8]) -> bool {
    groups::is_binary(bytes) || groups::is_text(bytes)
}

/// Reads the entities of the requested layer, or of all that are shown.
///
/// # Errors
/// [`VectorError`], also where no entity is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    VectorError::check_design_size(FORMAT, bytes)?;
    let reason = "names no coordinate system, as all of its kind";
    let crs = hints.crs.cloned().ok_or(VectorError::NoCrs { format: FORMAT, reason })?;
    let drawing = if groups::is_binary(bytes) {
        DxfDrawing::read(GroupReader::of_binary(bytes))
    } else {
        DxfDrawing::read(GroupReader::of_text(&groups::decode(bytes)))
    };
    let drawing = drawing?;
    let names: Vec<&str> = drawing.layer_names();
    if let Some(wanted) = hints.layer.filter(|wanted| !names.contains(wanted)) {
        return Err(VectorError::no_such_layer(wanted, &names));
    }
    let mut layer = LayerBuilder::new(crs);
    drawing.note_unit(&mut layer);
    if let Some(cut) = &drawing.cut_short {
        layer.fault(cut.clone());
    }
    let mut drawn = DxfFeatures {
        drawing: &drawing,
        wanted: hints.layer,
        vertices_left: DESIGN_VERTICES.get(),
        features: Vec::new(),
        missing_blocks: BTreeSet::new(),
        hidden: 0,
        on_paper: 0,
        nested: 0,
        is_too_large: false,
    };
    for entity in &drawing.entities {
        drawn.add(entity, &BlockReference::none(), 0);
    }
    drawn.finish(layer)
}

/// A drawing as read.
#[derive(Default)]
struct DxfDrawing {
    unit: Option<i64>,
    layers: BTreeMap<String, DrawingLayer>,
    blocks: BTreeMap<String, DxfBlock>,
    entities: Vec<DxfEntity>,
    /// How many entities of each kind are not read.
    unread: BTreeMap<String, usize>,
    /// A sentence where the file ends too early or is broken behind some entities.
    cut_short: Option<String>,
}

struct DrawingLayer {
    color: DxfColor,
    is_shown: bool,
}

#[derive(Default)]
struct DxfBlock {
    base: DVec3,
    entities: Vec<DxfEntity>,
}

/// Reads records: a group of code 0 and those up to the next.
struct RecordReader<'a> {
    groups: GroupReader<'a>,
    /// The kind of the next record.
    next: Option<String>,
    fault: Option<String>,
}

impl<'a> RecordReader<'a> {
    fn new(mut groups: GroupReader<'a>) -> Result<Self, String> {
        let mut next = None;
        while next.is_none() {
            match groups.next()? {
                Some(group) if group.code == 0 => next = Some(group.text().to_owned()),
                Some(_) => {}
                None => break,
            }
        }
        Ok(Self { groups, next, fault: None })
    }

    /// The next record; what is broken ends the file.
    fn record(&mut self) -> Option<DxfRecord<'a>> {
        let mut record =
            DxfRecord { kind: self.next.take()?, groups: Vec::new(), place: self.groups.place() };
        loop {
            match self.groups.next() {
                Ok(Some(group)) if group.code == 0 => {
                    self.next = Some(group.text().to_owned());
                    return Some(record);
                }
                // Extended data belongs to other programs; hatches repeat its codes nowhere.
                Ok(Some(group)) if group.code >= 1000 || group.code == 999 => {}
                Ok(Some(_)) if record.groups.len() == MOST_GROUPS => {
                    self.fault = Some(format!(
                        "{}: one entity has more than {MOST_GROUPS} groups",
                        self.groups.place()
                    ));
                    return Some(record);
                }
                Ok(Some(group)) => record.groups.push(group),
                Ok(None) => return Some(record),
                Err(reason) => {
                    self.fault = Some(format!("{}: {reason}", self.groups.place()));
                    return Some(record);
                }
            }
        }
    }
}

impl DxfDrawing {
    fn read(groups: GroupReader<'_>) -> Result<Self, VectorError> {
        let mut reader =
            RecordReader::new(groups).map_err(|reason| VectorError::broken(FORMAT, "its start", reason))?;
        let mut drawing = Self::default();
        let mut section = String::new();
        let mut block: Option<(String, DxfBlock)> = None;
        let mut is_ended = false;
        while let Some(record) = reader.record() {
            match (record.kind.as_str(), section.as_str()) {
                ("SECTION", _) => {
                    section = record.text(2).unwrap_or_default().to_owned();
                    drawing.read_header(&record);
                }
                ("ENDSEC", _) => section.clear(),
                ("EOF", _) => is_ended = true,
                ("LAYER", "TABLES") => drawing.add_layer(&record),
                ("BLOCK", "BLOCKS") => {
                    let base = record.point(10).unwrap_or_default();
                    block = Some((
                        record.text(2).unwrap_or_default().to_owned(),
                        DxfBlock { base, entities: Vec::new() },
                    ));
                }
                ("ENDBLK", "BLOCKS") => drawing.blocks.extend(block.take()),
                (_, "BLOCKS" | "ENTITIES") => {
                    let parts = Self::parts(&record, &mut reader);
                    let entity = record.entity(&parts);
                    if entity.is_none() && section == "ENTITIES" {
                        *drawing.unread.entry(record.kind.chars().take(30).collect()).or_default() += 1;
                    }
                    match &mut block {
                        Some((_, block)) if section == "BLOCKS" => block.entities.extend(entity),
                        _ if section == "ENTITIES" => drawing.entities.extend(entity),
                        _ => {}
                    }
                }
                _ => {}
            }
            if is_ended {
                break;
            }
        }
        let fault = reader.fault.or_else(|| (!is_ended).then(|| "it ends without its end mark".to_owned()));
        match fault {
            Some(fault) if drawing.entities.is_empty() => {
                Err(VectorError::broken(FORMAT, "its entities", fault))
            }
            fault => {
                drawing.cut_short = fault.map(|fault| format!("the file is not read to its end: {fault}"));
                Ok(drawing)
            }
        }
    }

    /// The vertices of a polyline and the attributes of a block's reference, which follow it.
    fn parts<'a>(record: &DxfRecord<'a>, reader: &mut RecordReader<'a>) -> Vec<DxfRecord<'a>> {
        let mut parts = Vec::new();
        let has_parts =
            record.kind == "POLYLINE" || (record.kind == "INSERT" && record.integer(66) == Some(1));
        while has_parts
            && reader.next.as_deref().is_some_and(|next| matches!(next, "VERTEX" | "ATTRIB" | "SEQEND"))
        {
            let Some(part) = reader.record() else { break };
            if part.kind == "SEQEND" {
                break;
            }
            parts.push(part);
        }
        parts
    }

    /// The header is one record: names with values behind them.
    fn read_header(&mut self, record: &DxfRecord<'_>) {
        let mut groups = record.groups.iter();
        if groups.by_ref().any(|group| group.code == 9 && group.text() == "$INSUNITS") {
            self.unit = groups.next().and_then(groups::DxfGroup::integer);
        }
    }

    fn add_layer(&mut self, record: &DxfRecord<'_>) {
        let Some(name) = record.text(2) else { return };
        let index = record.integer(62).unwrap_or(7);
        let color = match record.integer(420) {
            Some(color) => DxfColor::of_true_color(color),
            None => DxfColor::of_index(index),
        };
        let is_shown = index >= 0 && record.integer(70).unwrap_or(0) & 1 == 0;
        self.layers.insert(text::plain(name), DrawingLayer { color, is_shown });
    }

    /// The layers that hold entities, in the drawing or in blocks, in order.
    fn layer_names(&self) -> Vec<&str> {
        let inner = self.blocks.values().flat_map(|block| &block.entities);
        let names: BTreeSet<&str> =
            self.entities.iter().chain(inner).map(|entity| entity.layer.as_str()).collect();
        names.into_iter().collect()
    }

    fn note_unit(&self, layer: &mut LayerBuilder) {
        let Some(number) = self.unit.filter(|unit| *unit != 0) else {
            return layer
                .note("the drawing states no unit: its coordinates are taken in that of the stated system");
        };
        let Some((_, name, meters)) = UNITS.iter().find(|(known, ..)| *known == number) else {
            return layer
                .note(format!("the drawing states the unit {number}, which is no length on the ground"));
        };
        let crs = layer.crs();
        if crs.is_geographic() || (crs.meters_per_unit() - meters).abs() > 1e-6 * meters {
            layer.note(format!(
                "the drawing states {name}; its coordinates are taken in the unit of the stated system all the same: state a proj string with +to_meter={meters} as `crs` where they are {name}"
            ));
        }
    }
}

/// Where a block is drawn, and what its entities take from the reference.
struct BlockReference<'a> {
    placed: DAffine3,
    /// The layer and the color of the reference; `None` of the drawing itself.
    by: Option<(&'a str, DxfColor)>,
    block: Option<&'a str>,
}

impl BlockReference<'_> {
    fn none() -> Self {
        Self { placed: DAffine3::IDENTITY, by: None, block: None }
    }
}

/// The features of a drawing while they are collected.
struct DxfFeatures<'a> {
    drawing: &'a DxfDrawing,
    wanted: Option<&'a str>,
    /// How many more vertices and references there may be: blocks multiply them.
    vertices_left: u64,
    features: Vec<DrawnFeature<'a>>,
    missing_blocks: BTreeSet<&'a str>,
    hidden: usize,
    on_paper: usize,
    nested: usize,
    is_too_large: bool,
}

struct DrawnFeature<'a> {
    lines: Vec<Vec<DVec3>>,
    points: Vec<DVec3>,
    polygons: Vec<Vec<Vec<DVec3>>>,
    properties: Properties,
    entity: &'a DxfEntity,
}

impl<'a> DxfFeatures<'a> {
    fn take(&mut self, count: usize) -> bool {
        match self.vertices_left.checked_sub(count as u64) {
            Some(left) => self.vertices_left = left,
            None => self.is_too_large = true,
        }
        !self.is_too_large
    }

    fn add(&mut self, entity: &'a DxfEntity, reference: &BlockReference<'a>, depth: usize) {
        if entity.is_on_paper || entity.is_hidden {
            self.on_paper += 1;
            return;
        }
        // In a block, layer 0 is that of the reference.
        let layer = match reference.by {
            Some((layer, _)) if entity.layer == "0" => layer,
            _ => entity.layer.as_str(),
        };
        let of_layer = || self.drawing.layers.get(layer).map_or(DxfColor::Rgb([0; 3]), |layer| layer.color);
        let color = match (entity.color, reference.by) {
            (DxfColor::ByLayer, _) => of_layer(),
            (DxfColor::ByBlock, Some((_, color))) => color,
            (DxfColor::ByBlock, None) => DxfColor::Rgb([0; 3]),
            (color, _) => color,
        };
        if let DxfShape::Insert(insert) = &entity.shape {
            self.insert(entity, insert, (layer, color), reference, depth);
            return;
        }
        if !self.is_wanted(layer) {
            return;
        }
        let place = |at: &DVec3| reference.placed.transform_point3(*at);
        let ring = |ring: &Vec<DVec3>| ring.iter().map(place).collect::<Vec<_>>();
        let mut properties = self.properties(entity, layer, color);
        if let Some(block) = reference.block {
            properties.insert("block".into(), block.into());
        }
        let (mut lines, mut points, mut polygons) = (Vec::new(), Vec::new(), Vec::new());
        match &entity.shape {
            DxfShape::Point(at) => points.push(place(at)),
            DxfShape::Line(line) => lines.push(ring(line)),
            DxfShape::Faces(faces) => {
                polygons.extend(faces.iter().map(|rings| rings.iter().map(ring).collect()))
            }
            DxfShape::Rings(rings) => {
                let sorted = RingSorter::new(HoleRule::Nesting).polygons(rings.iter().map(ring).collect());
                polygons.extend(sorted.map(|sorted| sorted.polygons).unwrap_or_default());
            }
            DxfShape::Text(text) => {
                points.push(place(&text.at));
                properties.insert("text".into(), text.text.clone().into());
                insert_number(&mut properties, "text_height", text.height);
                insert_number(&mut properties, "rotation", text.rotation_deg);
                properties.extend(text.tag.as_ref().map(|tag| ("tag".to_owned(), tag.clone().into())));
            }
            DxfShape::Insert(_) => {}
        }
        let count = points.len()
            + lines.iter().map(Vec::len).sum::<usize>()
            + polygons.iter().flatten().map(Vec::len).sum::<usize>();
        // Of a block's entities the properties weigh more than their vertices.
        let weight = if reference.block.is_some() { count.max(FEATURE_WEIGHT) } else { count };
        if self.take(weight) {
            self.features.push(DrawnFeature { lines, points, polygons, properties, entity });
        }
    }

    fn is_wanted(&mut self, layer: &str) -> bool {
        match self.wanted {
            Some(wanted) => wanted == layer,
            None => {
                let is_shown = self.drawing.layers.get(layer).is_none_or(|layer| layer.is_shown);
                self.hidden += usize::from(!is_shown);
                is_shown
            }
        }
    }

    fn properties(&self, entity: &DxfEntity, layer: &str, color: DxfColor) -> Properties {
        let mut properties = Properties::new();
        properties.insert("Layer".into(), layer.into());
        properties.insert("type".into(), entity.kind.clone().into());
        for (name, text) in [("handle", &entity.handle), ("linetype", &entity.line_type)] {
            if !text.is_empty() {
                properties.insert(name.into(), text.clone().into());
            }
        }
        if let DxfColor::Rgb([red, green, blue]) = color {
            properties.insert("stroke".into(), format!("#{red:02x}{green:02x}{blue:02x}").into());
        }
        properties
    }

    fn insert(
        &mut self,
        entity: &'a DxfEntity,
        insert: &'a BlockInsert,
        (layer, color): (&'a str, DxfColor),
        reference: &BlockReference<'a>,
        depth: usize,
    ) {
        if depth == MOST_NESTED {
            self.nested += 1;
            return;
        }
        let block = self.drawing.blocks.get(&insert.block);
        if block.is_none() {
            self.missing_blocks.insert(&insert.block);
        }
        let is_point = entity.kind == "INSERT" && self.is_wanted(layer);
        for row in 0..insert.rows {
            for column in 0..insert.columns {
                if !self.take(1) {
                    return;
                }
                // Rows and columns are as far apart as stated, whatever the scale, and turn with the block.
                let off =
                    DVec3::new(f64::from(column) * insert.spacing.x, f64::from(row) * insert.spacing.y, 0.0);
                let off = DAffine3::from_rotation_z(insert.rotation_deg.to_radians()).transform_vector3(off);
                let placed = reference.placed * DAffine3::from_translation(off) * insert.placed;
                if is_point && self.take(FEATURE_WEIGHT) {
                    self.add_place(entity, insert, (layer, color), placed);
                }
                let Some(block) = block else { continue };
                let placed = placed * DAffine3::from_translation(-block.base);
                let inner = BlockReference { placed, by: Some((layer, color)), block: Some(&insert.block) };
                for entity in &block.entities {
                    if self.is_too_large {
                        return;
                    }
                    self.add(entity, &inner, depth + 1);
                }
            }
        }
    }

    /// Adds the place of a block as a point.
    fn add_place(
        &mut self,
        entity: &'a DxfEntity,
        insert: &BlockInsert,
        (layer, color): (&str, DxfColor),
        placed: DAffine3,
    ) {
        let mut properties = self.properties(entity, layer, color);
        for (tag, value) in &insert.attributes {
            properties.entry(tag.clone()).or_insert_with(|| value.clone().into());
        }
        properties.insert("block".into(), insert.block.clone().into());
        insert_number(&mut properties, "rotation", insert.rotation_deg);
        insert_number(&mut properties, "scale", insert.scale.x);
        let points = vec![placed.transform_point3(DVec3::ZERO)];
        let (lines, polygons) = (Vec::new(), Vec::new());
        self.features.push(DrawnFeature { lines, points, polygons, properties, entity });
    }

    fn finish(self, mut layer: LayerBuilder) -> Result<VectorLayer, VectorError> {
        if self.is_too_large {
            return Err(VectorError::Unsupported {
                format: FORMAT,
                content: format!(
                    "more than {DESIGN_VERTICES} vertices with those of its blocks; {DESIGN_VERTICES:#}"
                )
                .into(),
                remedy: "part the drawing",
            });
        }
        // A drawing in the plane has no elevations, although each vertex has a z of 0.
        let flat = |feature: &DrawnFeature<'_>| {
            let mut all = feature.lines.iter().flatten().chain(&feature.points);
            all.all(|at| at.z == 0.0) && feature.polygons.iter().flatten().flatten().all(|at| at.z == 0.0)
        };
        let is_flat = self.features.iter().all(flat);
        let level = |vertices: Vec<DVec3>| -> Vec<DVec3> {
            if is_flat { vertices.into_iter().map(|at| at.with_z(f64::NAN)).collect() } else { vertices }
        };
        for DrawnFeature { lines, points, polygons, properties, entity } in self.features {
            let mut parts = FeatureParts::default();
            lines.into_iter().for_each(|line| parts.add_line(level(line)));
            if !points.is_empty() {
                parts.add_points(level(points));
            }
            polygons.into_iter().for_each(|rings| parts.add_polygon(rings.into_iter().map(level)));
            layer.add_at(parts, properties, || format!("{}, {}", entity.place, entity.kind));
        }
        let unread: Vec<String> =
            self.drawing.unread.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let counts = [
            (self.hidden, "on layers that are off or frozen; name one as `layer` to read it"),
            (self.on_paper, "on paper or invisible"),
            (self.nested, "that are blocks in blocks in blocks, more than 16 deep"),
        ];
        for (count, which) in counts.into_iter().filter(|(count, _)| *count > 0) {
            let noun = if count == 1 { "entity" } else { "entities" };
            layer.note(format!("left out: {count} {noun} {which}"));
        }
        if !unread.is_empty() {
            layer.note(format!(
                "left out, of kinds that are not read or without their points: {}",
                unread.join(", ")
            ));
        }
        if !self.missing_blocks.is_empty() {
            let names: Vec<String> =
                self.missing_blocks.iter().take(5).map(|name| format!("'{}'", shorten(name))).collect();
            layer.note(format!(
                "left out: {} blocks that the drawing does not hold: {}",
                self.missing_blocks.len(),
                names.join(", ")
            ));
        }
        layer.finish()
    }
}

fn insert_number(properties: &mut Properties, name: &str, number: f64) {
    if let Some(number) = Number::from_f64(number) {
        properties.insert(name.to_owned(), number.into());
    }
}

#[cfg(test)]
mod tests;
