//! NATO Vector Graphics 1.4, 1.5 and 2.0 (NVG data format, NATO ACT): points, lines, areas and their parts, on WGS 84.
//!
//! Elements are read by their local names, so the namespaces of the versions do not matter. Circles, ellipses, arcs, bands,
//! rectangles, corridors and arrows are computed on the ground in meters; corridors and arrows with a symbol stay lines, since
//! the symbol's draw rule makes the shape. Groups (`g`) hand on symbol, style and label; their labels are the layers.

mod shape;

use std::borrow::Cow;

use crate::builder::LayerBuilder;
use crate::error::VectorError;
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::moment::Moment;
use crate::overlay_schema::{
    BEGIN, DESCRIPTION, DIRECTION, END, ID, LABEL, LAYER, NAME, SIDC, SPEED, bare_code, field_property, set,
};
use crate::svg_style::add_style;
use crate::tally::RecordTally;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "NVG file";

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
        builder: LayerBuilder::new(hints.crs.cloned().unwrap_or_else(Crs::wgs84)),
        unread: RecordTally::new(),
    };
    reader.xml.root()?;
    reader.read_group(&Inherited::default())?;
    reader.xml.finish()?;
    let names: Vec<&str> = reader.groups.iter().map(String::as_str).collect();
    if let Some(wanted) = hints.layer.filter(|wanted| !names.contains(wanted)) {
        return Err(VectorError::no_such_layer(wanted, &names));
    }
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
        let own =
            |name: &str| element.attribute(name).filter(|text| !text.trim().is_empty()).map(Cow::into_owned);
        let joined = |above: &str, own: Option<String>| match own {
            Some(own) if above.is_empty() => own,
            Some(own) => format!("{above};{own}"),
            None => above.to_owned(),
        };
        Self {
            group: self.group.clone(),
            symbol: own("symbol").or_else(|| self.symbol.clone()),
            style: joined(&self.style, own("style")),
            modifiers: joined(&self.modifiers, own("modifiers")),
            label: own("label").or_else(|| self.label.clone()),
        }
    }
}

struct NvgReader<'a> {
    xml: XmlReader<'a>,
    wanted: Option<&'a str>,
    /// The labels of the groups.
    groups: Vec<String>,
    builder: LayerBuilder,
    unread: RecordTally,
}

impl NvgReader<'_> {
    fn read_group(&mut self, inherited: &Inherited) -> Result<(), VectorError> {
        while let Some(child) = self.xml.next_child()? {
            let kind = child.name().to_ascii_lowercase();
            match kind.as_str() {
                "g" | "group" | "a" => {
                    let mut within = inherited.within(&child);
                    if let Some(label) = child.attribute("label").filter(|label| !label.trim().is_empty()) {
                        within.group = label.into_owned();
                        if !self.groups.contains(&within.group) {
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
                        self.add(&element, inherited);
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds an element, or each part of a composite.
    fn add(&mut self, element: &XmlElement<'_>, inherited: &Inherited) {
        let own = inherited.within(element);
        let kind = element.name().to_ascii_lowercase();
        if kind == "composite" {
            for part in element.children().filter(|part| !SAID.contains(&&*part.name().to_ascii_lowercase()))
            {
                self.add(part, &own);
            }
            return;
        }
        let symbol = own.symbol.as_deref().and_then(bare_code);
        let xml = &self.xml;
        let place = || xml.line_of(element);
        match shape::parts(&kind, element, symbol.is_some()) {
            None => self.unread.add(place),
            Some(Err(reason)) => {
                let line = place();
                self.builder.add_broken(&line, VectorError::broken(FORMAT, &line, reason));
            }
            Some(Ok(parts)) => {
                let properties = properties(element, &kind, &own, symbol);
                self.builder.add_at(parts, properties, place);
            }
        }
    }
}

fn properties(element: &XmlElement<'_>, kind: &str, own: &Inherited, symbol: Option<String>) -> Properties {
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
        set(&mut properties, NAME, label.as_str());
    }
    let attributes =
        [(ID, "uri"), (DIRECTION, "course"), (SPEED, "speed"), (BEGIN, "timestamp"), ("href", "href")];
    for (property, name) in attributes {
        let value = element.attribute(name).map(Cow::into_owned);
        let value = value.and_then(|value| match property {
            BEGIN => Moment::parse(&value).map(|moment| moment.to_string()),
            _ => Some(value),
        });
        value.into_iter().for_each(|value| set(&mut properties, property, value));
    }
    if kind == "text" {
        let content = element.attribute("content").map(Cow::into_owned).unwrap_or_else(|| element.text());
        set(&mut properties, LABEL, content);
    }
    add_style(&own.style, &mut properties);
    // `T:1-77;M:3 BDE` and, in version 2, `t="1-77"`.
    for modifier in own.modifiers.split(';') {
        if let Some((letters, text)) = modifier.split_once([':', '='])
            && let Some(property) = field_property(letters.trim())
        {
            set(&mut properties, property, text.trim().trim_matches('"'));
        }
    }
    symbol.into_iter().for_each(|code| set(&mut properties, SIDC, code));
    shape::width_m(element).into_iter().for_each(|width_m| {
        crate::svg_style::set_number(&mut properties, crate::overlay_schema::WIDTH, Some(width_m));
    });
    properties
}

/// The data of an element by its keys.
fn add_extended(data: &XmlElement<'_>, properties: &mut Properties) {
    for item in data.children() {
        match item.attribute("key") {
            Some(key) => set(properties, &key, item.text()),
            None => add_extended(item, properties),
        }
    }
}

#[cfg(test)]
mod tests;
