//! NATO Vector Graphics 1.4, 1.5 and 2.0 (NVG data format, NATO ACT): points, lines, areas and their parts, on WGS 84.
//!
//! Elements are read by their local names, so the namespaces of the versions do not matter. Circles, ellipses, arcs, bands,
//! rectangles, corridors and arrows are computed on the ground in meters; corridors and arrows with a symbol stay lines, since
//! the symbol's draw rule makes the shape. Groups (`g`) hand on symbol, modifiers and style; their labels are the layers. The
//! symbol of a composite is that of its first part, so that it is drawn once. A style may be the attribute `style`, or one
//! attribute for each of its parts, as version 1.4 has it. Speeds are in knots.

mod shape;

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::builder::LayerBuilder;
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    ALTITUDE, BEGIN, DESCRIPTION, DIRECTION, END, FILL, FILL_OPACITY, ID, LABEL, LAYER, NAME, SPEED, STROKE,
    STROKE_DASHES, STROKE_OPACITY, STROKE_WIDTH, WIDTH, bare_code, set, set_code, set_field, set_number,
    shared_name,
};
use crate::svg_style::add_style;
use crate::tally::RecordTally;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_base::limits::OVERLAY_VERTICES;
use sandtable_geom::crs::Crs;

const FORMAT: &str = "NVG file";

/// The longest text that a group hands on; a longer one would be read once for each element in it.
const MOST_INHERITED: usize = 4000;

/// Elements that say something of the element around them.
const SAID: [&str; 8] =
    ["textinfo", "extendeddata", "metadata", "timespan", "timestamp", "exclude", "icon", "schema"];

/// Reads all elements, or those in the groups with the label that is asked for.
///
/// # Errors
/// [`VectorError`], also where no element is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let mut reader = NvgReader {
        xml: XmlReader::new(&text, FORMAT),
        wanted: hints.layer,
        groups: Vec::new(),
        known: BTreeSet::new(),
        builder: LayerBuilder::new(Crs::wgs84()),
        unread: RecordTally::new(),
        codeless: RecordTally::new(),
        shape_vertices: 0,
    };
    if hints.crs.is_some_and(|crs| *crs != Crs::wgs84()) {
        reader.builder.note("its places are on WGS 84: `crs` has no effect on them");
    }
    reader.xml.root()?;
    reader.read_group(&Inherited::default())?;
    reader.xml.finish()?;
    let names: Vec<&str> = reader.groups.iter().map(String::as_str).collect();
    if let Some(wanted) = hints.layer.filter(|wanted| !names.contains(wanted)) {
        return Err(VectorError::no_such_layer(wanted, &names));
    }
    let codeless = reader.codeless.text(
        "element has a symbol that is no code of MIL-STD-2525 or APP-6",
        "elements have symbols that are no codes of MIL-STD-2525 or APP-6",
    );
    codeless.into_iter().for_each(|fault| reader.builder.fault(fault));
    reader.builder.note_omitted(&reader.unread, "element of an unknown kind", "elements of unknown kinds");
    fault.into_iter().for_each(|fault| reader.builder.fault(fault));
    reader.builder.finish()
}

/// What groups hand on to the elements in them.
#[derive(Clone, Default)]
struct Inherited {
    group: String,
    symbol: Option<String>,
    style: String,
    modifiers: String,
    label: Option<String>,
}

impl Inherited {
    /// What an element hands on; its own attributes count before those from above.
    fn within(&self, element: &XmlElement<'_>) -> Self {
        let own = |name: &str| {
            let text = element.attribute(name).filter(|text| !text.trim().is_empty());
            text.filter(|text| text.len() <= MOST_INHERITED).map(Cow::into_owned)
        };
        let joined = |above: &str, own: Option<String>| match own {
            Some(own) if above.is_empty() => own,
            Some(own) => format!("{above};{own}"),
            None => above.to_owned(),
        };
        Self {
            group: self.group.clone(),
            symbol: own("symbol").or_else(|| self.symbol.clone()),
            style: joined(&joined(&self.style, attribute_style(element)), own("style")),
            modifiers: joined(&self.modifiers, own("modifiers")),
            label: own("label").or_else(|| self.label.clone()),
        }
    }
}

/// The style that attributes of an element state one by one.
fn attribute_style(element: &XmlElement<'_>) -> Option<String> {
    let names = [STROKE, STROKE_WIDTH, STROKE_OPACITY, STROKE_DASHES, "stroke-dash", FILL, FILL_OPACITY];
    let parts = names.iter().filter_map(|name| Some(format!("{name}:{}", element.attribute(name)?)));
    let parts: Vec<String> = parts.filter(|part| part.len() <= 100 && !part.contains(';')).collect();
    (!parts.is_empty()).then(|| parts.join(";"))
}

struct NvgReader<'a> {
    xml: XmlReader<'a>,
    wanted: Option<&'a str>,
    /// The labels of the groups, in order and by name.
    groups: Vec<String>,
    known: BTreeSet<String>,
    builder: LayerBuilder,
    unread: RecordTally,
    /// Elements whose symbol is no code.
    codeless: RecordTally,
    /// Vertices so far of shapes that few letters state.
    shape_vertices: usize,
}

impl NvgReader<'_> {
    fn read_group(&mut self, inherited: &Inherited) -> Result<(), VectorError> {
        while let Some(child) = self.xml.next_child()? {
            let kind = child.name().to_ascii_lowercase();
            match kind.as_str() {
                "g" | "group" | "a" => {
                    let mut within = inherited.within(&child);
                    if let Some(label) = child.attribute("label").filter(|label| !label.trim().is_empty()) {
                        within.group = shared_name(&label);
                        if self.known.insert(within.group.clone()) {
                            self.groups.push(within.group.clone());
                        }
                        // The label of a group is not that of what it holds.
                        within.label = None;
                    }
                    self.read_group(&within)?;
                }
                kind if SAID.contains(&kind) => self.xml.skip()?,
                _ => {
                    let element = self.xml.read(child)?;
                    if self.wanted.is_none_or(|wanted| wanted == inherited.group) {
                        self.add(&element, inherited)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds an element, or each part of a composite.
    fn add(&mut self, element: &XmlElement<'_>, inherited: &Inherited) -> Result<(), VectorError> {
        let mut own = inherited.within(element);
        let kind = element.name().to_ascii_lowercase();
        if kind == "composite" {
            for part in element.children().filter(|part| !SAID.contains(&&*part.name().to_ascii_lowercase()))
            {
                self.add(part, &own)?;
                own.symbol = None;
            }
            return Ok(());
        }
        let symbol = own.symbol.as_deref().filter(|symbol| bare_code(symbol).is_some());
        let xml = &self.xml;
        let place = || xml.line_of(element);
        if own.symbol.is_some() && symbol.is_none() {
            self.codeless.add(place);
        }
        match shape::parts(&kind, element, symbol.is_some()) {
            None => self.unread.add(place),
            Some(Err(reason)) => {
                let line = place();
                self.builder.add_broken(&line, VectorError::broken(FORMAT, &line, reason));
            }
            Some(Ok(parts)) => {
                if matches!(kind.as_str(), "circle" | "ellipse" | "arc" | "arcband" | "arc-band" | "orbit") {
                    self.shape_vertices += parts.vertex_count();
                }
                if self.shape_vertices > OVERLAY_VERTICES.count() {
                    return Err(xml.broken_at(element, format!(
                        "its circles and arcs up to here have more than {OVERLAY_VERTICES} vertices; {OVERLAY_VERTICES:#}"
                    )));
                }
                let properties = properties(element, &kind, &own, symbol);
                self.builder.add_at(parts, properties, place);
            }
        }
        Ok(())
    }
}

fn properties(element: &XmlElement<'_>, kind: &str, own: &Inherited, symbol: Option<&str>) -> Properties {
    let mut properties = Properties::new();
    for child in element.children() {
        match child.name().to_ascii_lowercase().as_str() {
            "textinfo" => set(&mut properties, DESCRIPTION, child.text()),
            "extendeddata" | "metadata" => add_extended(child, &mut properties),
            "timespan" => {
                for (property, name) in [(BEGIN, "begin"), (END, "end")] {
                    let times = child.children().filter(|time| time.name().eq_ignore_ascii_case(name));
                    times.filter_map(|time| Moment::parse(&time.text())).for_each(|time| {
                        set(&mut properties, property, time.to_string());
                    });
                }
            }
            "timestamp" => {
                let moment = Moment::parse(&child.text());
                moment.into_iter().for_each(|moment| set(&mut properties, BEGIN, moment.to_string()));
            }
            _ => {}
        }
    }
    set(&mut properties, LAYER, own.group.as_str());
    if let Some(label) = &own.label {
        set(&mut properties, NAME, shared_name(label));
    }
    let attributes = [(ID, "uri"), (DIRECTION, "course"), (BEGIN, "timestamp"), ("href", "href")];
    for (property, name) in attributes {
        let value = element.attribute(name).map(Cow::into_owned);
        let value = value.and_then(|value| match property {
            BEGIN => Moment::parse(&value).map(|moment| moment.to_string()),
            _ => Some(value),
        });
        value.into_iter().for_each(|value| set(&mut properties, property, value));
    }
    let speed = element.number::<f64>("speed").filter(|knots| *knots > 0.0 && knots.is_finite());
    speed.into_iter().for_each(|knots| set(&mut properties, SPEED, format!("{knots} kt")));
    let altitudes = ["minaltitude", "maxaltitude"].map(|name| element.number::<f64>(name));
    let altitudes: Vec<String> = altitudes
        .into_iter()
        .flatten()
        .filter(|meters| meters.is_finite())
        .map(|meters| format!("{meters} m"))
        .collect();
    set(&mut properties, ALTITUDE, altitudes.join(" - "));
    if kind == "text" {
        let content = element.attribute("content").map(Cow::into_owned).unwrap_or_else(|| element.text());
        set(&mut properties, LABEL, content);
    }
    add_style(&own.style, &mut properties);
    // `T:1-77;M:3 BDE` and, in version 2, `t="1-77"`.
    for modifier in own.modifiers.split(';') {
        if let Some((letters, text)) = modifier.split_once([':', '=']) {
            set_field(&mut properties, letters, text.trim().trim_matches('"'));
        }
    }
    if let Some(code) = symbol {
        set_code(&mut properties, code);
    }
    set_number(&mut properties, WIDTH, shape::width_m(element));
    properties
}

/// The data of an element by its keys.
fn add_extended(data: &XmlElement<'_>, properties: &mut Properties) {
    for item in data.children() {
        match item.attribute("key") {
            // What the schema of overlays names comes from the element itself.
            Some(key) if !properties.contains_key(&*key) => set(properties, &key, item.text()),
            Some(_) => {}
            None => add_extended(item, properties),
        }
    }
}

#[cfg(test)]
mod tests;
