//! Overlays: units, tactical graphics and drawings of a file, by the properties that its reader gives them
//! ([`sandtable_vector::overlay_schema`]).
//!
//! ```text
//! features of a file ─► those of the moment ─┬─ symbol code ──────────► symbol on the ground
//!                                            ├─ code or word of a control measure ─► tactical graphic
//!                                            └─ neither ──────────────► line, area or point in the file's style
//! ```
//!
//! A code or a graphic that cannot be drawn is told, and its shape is drawn plain.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::attributes::{Attributes, written};
use crate::builder::SceneBuilder;
use crate::feature::FeatureKind;
use crate::graphics::graphic;
use crate::military::{FoundSymbol, SceneSymbol, SymbolLook, SymbolSize, engaged, frameless, name};
use crate::scene_graphic::SceneGraphic;
use crate::shape_place::place;
use crate::sources::Sources;
use crate::told_tally::ToldTally;
use sandtable_base::limits::{SCENE_GRAPHICS, SCENE_SYMBOLS};
use sandtable_base::message::choice::Choice;
use sandtable_base::message::numbers::counted;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::graphics::GraphicTable;
use sandtable_description::overlays::OverlayTable;
use sandtable_description::stated::Stated;
use sandtable_description::words::{GraphicSide, GraphicStatus};
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::engagement::EngagementBar;
use sandtable_symbology::fields::SymbolSet;
use sandtable_symbology::graphic::kind::GraphicKind;
use sandtable_symbology::symbol::MilitarySymbol;
use sandtable_symbology::texts::{SymbolText, TEXT_FIELDS, placed_for};
use sandtable_terrain::lattice::Lattice;
use sandtable_vector::feature::{Geometry, Polygon};
use sandtable_vector::moment::Moment;
use sandtable_vector::overlay_schema as schema;

/// Lays the overlays of the document: adds their graphics to `collected`, which keeps errors, and returns their symbols.
pub fn lay(sources: &Sources<'_>, lattice: &Lattice, collected: &mut SceneBuilder) -> Vec<SceneSymbol> {
    let mut symbols = Vec::new();
    for table in &sources.frame.document.overlays {
        let laid =
            Overlay::new(table, sources, lattice).and_then(|overlay| overlay.lay(collected, &mut symbols));
        collected.errors.keep(laid);
    }
    symbols
}

/// One overlay as it is laid.
struct Overlay<'a> {
    table: &'a OverlayTable,
    source: FeatureSource,
    sources: &'a Sources<'a>,
    lattice: &'a Lattice,
    extent: Rect,
    /// Its name in the legend.
    name: String,
    /// What cannot be drawn as it is meant, by the reason.
    told: ToldTally,
    off: usize,
}

impl<'a> Overlay<'a> {
    fn new(
        table: &'a OverlayTable,
        sources: &'a Sources<'a>,
        lattice: &'a Lattice,
    ) -> Result<Self, Diagnostic> {
        let file = table.file.rsplit(['/', '\\']).next().unwrap_or(&table.file);
        let stem = file.split_once('.').map_or(file, |(stem, _)| stem);
        Ok(Self {
            table,
            source: table.source(),
            sources,
            lattice,
            extent: lattice.extent(),
            name: table.name.clone().unwrap_or_else(|| stem.to_owned()),
            told: ToldTally::default(),
            off: 0,
        })
    }

    fn lay(mut self, collected: &mut SceneBuilder, symbols: &mut Vec<SceneSymbol>) -> Result<(), Diagnostic> {
        let time = self.time()?;
        let (crs, features) = self.sources.features(&self.source)?;
        let all = features.len();
        let shown = at_time(features, time);
        if let (Some(time), true) = (time, shown.is_empty()) {
            let message = format!("nothing of '{}' is there at {time}", self.table.file.as_str());
            let span = self.table.time.as_ref().and_then(Stated::span).unwrap_or_default();
            collected.findings.add(FindingCode::LeftOut, span, message);
        }
        let before = (symbols.len(), collected.graphics.len());
        for attributes in &shown {
            self.lay_feature(attributes, &crs, collected, symbols)?;
        }
        let is_empty = before == (symbols.len(), collected.graphics.len());
        if is_empty && self.off > 0 && self.off == all {
            self.sources.measure(&self.source)?;
        }
        self.report(collected);
        Ok(())
    }

    /// The moment that is asked for.
    fn time(&self) -> Result<Option<Moment>, Diagnostic> {
        let Some(text) = &self.table.time else { return Ok(None) };
        Moment::parse(text).map(Some).ok_or_else(|| {
            let message = format!("'{}' is no moment", text.as_str());
            let help = "write the day and the time as 1982-05-21T12:00:00Z, or with a zone as 1982-05-21T08:00:00-04:00";
            self.sources.frame.document.error(text, message).with_help(help)
        })
    }

    fn lay_feature(
        &mut self,
        attributes: &Attributes,
        crs: &Crs,
        collected: &mut SceneBuilder,
        symbols: &mut Vec<SceneSymbol>,
    ) -> Result<(), Diagnostic> {
        let Some(geometry) = attributes.geometry() else { return Ok(()) };
        let code = schema::SIDC_SPELLINGS.iter().find_map(|key| text(attributes, key));
        let code = code.and_then(|stated| match schema::bare_code(&stated) {
            Some(code) => match SymbolCode::parse(&code) {
                Ok(parsed) => Some((code, parsed)),
                Err(error) => {
                    self.told.add(error.to_string());
                    None
                }
            },
            None => {
                self.told.add(format!("'{stated}' is no symbol code"));
                None
            }
        });
        let is_graphic = |code: &SymbolCode| {
            let of_lines = !matches!(geometry, Geometry::Points(_));
            let digits = format!("{:06}", code.entity);
            match code.set {
                SymbolSet::ControlMeasure => true,
                SymbolSet::Atmosphere | SymbolSet::Ocean => {
                    of_lines || GraphicKind::of_code(code.set.number(), &digits).is_some()
                }
                _ => false,
            }
        };
        match code {
            Some((stated, code)) if !is_graphic(&code) => {
                if self.lay_symbol(attributes, (&stated, code), crs, collected, symbols)? {
                    return Ok(());
                }
                self.lay_shapes(attributes, geometry, crs, None, collected)
            }
            Some((stated, _)) => {
                self.lay_shapes(attributes, geometry, crs, Some(Measure::Code(stated)), collected)
            }
            None => {
                let word = text(attributes, schema::KIND).map(Measure::Word);
                self.lay_shapes(attributes, geometry, crs, word, collected)
            }
        }
    }

    /// Adds a symbol; false where its set has none.
    fn lay_symbol(
        &mut self,
        attributes: &Attributes,
        (stated, code): (&str, SymbolCode),
        crs: &Crs,
        collected: &mut SceneBuilder,
        symbols: &mut Vec<SceneSymbol>,
    ) -> Result<bool, Diagnostic> {
        let Some(symbol) = MilitarySymbol::new(&code) else {
            self.told.add(frameless(&code));
            return Ok(false);
        };
        let frame = self.sources.frame;
        let geometry = attributes.geometry();
        let Some(ground) = geometry.and_then(|shape| place(shape, crs, frame, self.lattice)) else {
            self.off += 1;
            return Ok(true);
        };
        if symbols.len() == SCENE_SYMBOLS.count() {
            let message = format!("the overlays have more than {SCENE_SYMBOLS}");
            let help = format!("select fewer of them with `where`, or {SCENE_SYMBOLS:#}");
            return Err(frame.document.error(&self.table.file, message).with_help(help));
        }
        let texts: Vec<(SymbolText, String)> =
            TEXT_FIELDS.iter().filter_map(|row| Some((row.field, text(attributes, row.key)?))).collect();
        let field = |field| texts.iter().find(|text| text.0 == field).map(|text| text.1.as_str());
        let called =
            text(attributes, schema::NAME).filter(|_| field(SymbolText::UniqueDesignation).is_none());
        let called = called.unwrap_or_else(|| name(field, stated));
        let notes = placed_for(&code, field);
        let symbol = engaged(symbol, &code, EngagementBar::of(field), &notes);
        let found =
            FoundSymbol { code, symbol, texts: notes, fields: texts, name: called, ground: ground.as_vec3() };
        let look = SymbolLook {
            direction_deg: number(attributes, schema::DIRECTION),
            size: SymbolSize::stated(self.table.size, self.table.extent),
            rank: self.table.rank,
        };
        let span = self.table.file.span().unwrap_or_default();
        symbols.push(found.looking(look, &span, &mut collected.findings));
        Ok(true)
    }

    /// Adds every shape of a feature: as a control measure where it is one, else plain.
    fn lay_shapes(
        &mut self,
        attributes: &Attributes,
        geometry: &Geometry,
        crs: &Crs,
        measure: Option<Measure>,
        collected: &mut SceneBuilder,
    ) -> Result<(), Diagnostic> {
        let frame = self.sources.frame;
        for shape in shapes(geometry) {
            let world = |ring: &[DVec2]| -> Option<Vec<DVec2>> {
                ring.iter().map(|&at| frame.world(crs, at).ok().filter(|at| at.is_finite())).collect()
            };
            let Some(points) = world(&shape.points) else {
                self.told.add("a vertex has no place in the scene's system".to_owned());
                continue;
            };
            if !Rect::around(points.iter().copied()).meets(&self.extent) {
                self.off += 1;
                continue;
            }
            if collected.graphics.len() == SCENE_GRAPHICS.count() {
                let message = format!("the scene has more than {SCENE_GRAPHICS} graphics");
                let help = format!("select fewer of them with `where`, or {SCENE_GRAPHICS:#}");
                return Err(frame.document.error(&self.table.file, message).with_help(help));
            }
            let drawn =
                measure.as_ref().and_then(|measure| self.measure(attributes, points.clone(), measure));
            let drawn = drawn.or_else(|| {
                let holes = shape.holes.iter().filter_map(|hole| world(hole)).collect();
                self.plain(attributes, (points, holes), shape.is_area)
            });
            if let Some(drawn) = drawn {
                let name = attributes.name(None);
                let feature = collected.add(FeatureKind::Graphic, name, attributes.origin(&self.source));
                collected.graphics.push(SceneGraphic { feature, ..drawn });
            }
        }
        Ok(())
    }

    /// A control measure; `None`, and told, where it does not fit its draw rule or is not known.
    fn measure(
        &mut self,
        attributes: &Attributes,
        points: Vec<DVec2>,
        measure: &Measure,
    ) -> Option<SceneGraphic> {
        let table = self.graphic_table(attributes, measure);
        match graphic(&table, attributes, points, self.sources.frame.document) {
            Ok(drawn) => drawn,
            Err(error) => {
                self.told.add(error.message());
                None
            }
        }
    }

    /// The table that would state a feature.
    fn graphic_table(&self, attributes: &Attributes, measure: &Measure) -> GraphicTable {
        let span = self.table.file.span().unwrap_or_default();
        let stated = |text: &String| Some(Stated::new(text.clone(), span.clone()));
        let (sidc, kind) = match measure {
            Measure::Code(code) => (stated(code), None),
            Measure::Word(word) => (None, stated(word)),
        };
        let numbers = |key: &str| {
            let list = text(attributes, key)?;
            let parts = list.split([' ', ',', ';']).filter(|part| !part.is_empty());
            let numbers: Vec<f64> = parts.map(str::parse).collect::<Result<_, _>>().ok()?;
            (!numbers.is_empty()).then(|| Stated::new(numbers, span.clone()))
        };
        GraphicTable {
            name: None,
            kind,
            sidc,
            source: self.source.clone(),
            order: None,
            width: None,
            side: text(attributes, schema::IDENTITY).and_then(|word| GraphicSide::from_word(&word)),
            status: text(attributes, schema::STATUS).and_then(|word| GraphicStatus::from_word(&word)),
            designation: text(attributes, schema::UNIQUE_DESIGNATION),
            designation_2: text(attributes, schema::DESIGNATION_2),
            echelon: text(attributes, schema::ECHELON),
            country: text(attributes, schema::COUNTRY),
            hostile: text(attributes, schema::HOSTILE),
            further: text(attributes, schema::ADDITIONAL_INFORMATION),
            target: text(attributes, schema::TARGET),
            from: text(attributes, schema::DTG),
            until: text(attributes, schema::DTG_2),
            elevations: None,
            equipment: text(attributes, schema::TYPE),
            quantity: text(attributes, schema::QUANTITY),
            location: text(attributes, schema::LOCATION),
            direction: number(attributes, schema::DIRECTION),
            distances: numbers(schema::DISTANCES),
            azimuths: numbers(schema::AZIMUTHS),
        }
    }

    /// A line, an area or a point as the file draws it.
    fn plain(
        &mut self,
        attributes: &Attributes,
        (points, holes): (Vec<DVec2>, Vec<Vec<DVec2>>),
        is_area: bool,
    ) -> Option<SceneGraphic> {
        let drawn = plain_style::drawn(attributes, (points, holes), is_area, &self.name);
        if let Err(reason) = &drawn {
            self.told.add(reason.clone());
        }
        drawn.ok()
    }

    fn report(self, collected: &mut SceneBuilder) {
        let file = self.table.file.as_str();
        let span = self.table.file.span().unwrap_or_default();
        if self.off > 0 {
            let message = format!(
                "of '{file}' {} off the elevation model",
                counted(self.off, "thing lies", "things lie")
            );
            collected.findings.add(FindingCode::LeftOut, span.clone(), message);
        }
        for sentence in self.told.sentences() {
            let message = format!("of '{file}' {sentence}");
            collected.findings.add(FindingCode::SymbolIncomplete, span.clone(), message);
        }
    }
}

/// What names a control measure.
enum Measure {
    Code(String),
    Word(String),
}

/// A text or a number of a feature as text, not empty.
pub(super) fn text(attributes: &Attributes, key: &str) -> Option<String> {
    written(&attributes.get(key)?).map(|text| text.trim().to_owned()).filter(|text| !text.is_empty())
}

/// A number of a feature, which may be stated as text.
pub(super) fn number(attributes: &Attributes, key: &str) -> Option<f64> {
    text(attributes, key)?.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The features that are there at a moment; without one, each thing in its last state.
fn at_time(features: Vec<Attributes>, time: Option<Moment>) -> Vec<Attributes> {
    let moment = |attributes: &Attributes, key| text(attributes, key).and_then(|text| Moment::parse(&text));
    if let Some(time) = time {
        let is_there = |attributes: &Attributes| {
            moment(attributes, schema::BEGIN).is_none_or(|begin| begin <= time)
                && moment(attributes, schema::END).is_none_or(|end| time < end)
        };
        return features.into_iter().filter(is_there).collect();
    }
    // The last state of each thing, in the place of its first.
    let mut last: BTreeMap<String, (Vec<usize>, Option<Moment>)> = BTreeMap::new();
    let mut shown: Vec<Option<Attributes>> = Vec::new();
    for attributes in features {
        let begin = moment(&attributes, schema::BEGIN);
        let is_state = begin.is_some() || moment(&attributes, schema::END).is_some();
        let id = text(&attributes, schema::ID).filter(|_| is_state);
        let Some(id) = id else {
            shown.push(Some(attributes));
            continue;
        };
        match last.get_mut(&id) {
            Some((places, known)) if begin > *known => {
                // The first place is kept; other shapes of the state before are gone.
                places.drain(1..).for_each(|place| shown[place] = None);
                *known = begin;
                shown[places[0]] = Some(attributes);
            }
            Some((places, known)) if begin == *known => {
                places.push(shown.len());
                shown.push(Some(attributes));
            }
            Some(_) => {}
            None => {
                last.insert(id, (vec![shown.len()], begin));
                shown.push(Some(attributes));
            }
        }
    }
    shown.into_iter().flatten().collect()
}

/// One piece of a feature's shape.
struct OverlayShape {
    points: Vec<DVec2>,
    holes: Vec<Vec<DVec2>>,
    is_area: bool,
}

fn shapes(geometry: &Geometry) -> Vec<OverlayShape> {
    let line = |points: Vec<DVec2>| OverlayShape { points, holes: Vec::new(), is_area: false };
    match geometry {
        Geometry::Points(points) => points.iter().map(|&at| line(vec![at])).collect(),
        Geometry::Lines(lines) => lines.iter().cloned().map(line).collect(),
        Geometry::Polygons(polygons) => {
            let area = |Polygon { exterior, holes }: &Polygon| OverlayShape {
                points: exterior.clone(),
                holes: holes.clone(),
                is_area: true,
            };
            polygons.iter().map(area).collect()
        }
    }
}

mod plain_style;

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use sandtable_vector::hints::VectorHints;
    use sandtable_vector::read;

    fn features(states: &[(&str, &str, &str)]) -> Vec<Attributes> {
        let feature = |(id, begin, end): &(&str, &str, &str)| {
            let times = [("begin", begin), ("end", end)];
            let times: String = times
                .iter()
                .filter(|(_, time)| !time.is_empty())
                .map(|(key, time)| format!(",\"{key}\":\"{time}\""))
                .collect();
            format!(
                "{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"Point\",\"coordinates\":[0,0]}},\"properties\":{{\"id\":\"{id}\"{times}}}}}"
            )
        };
        let list: Vec<String> = states.iter().map(feature).collect();
        let text = format!("{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", list.join(","));
        let layer =
            Arc::new(read::read("a.json", text.as_bytes(), &VectorHints::default()).expect("features"));
        (0..states.len()).map(|index| Attributes::new(Arc::clone(&layer), index)).collect()
    }

    fn ids(shown: &[Attributes]) -> Vec<String> {
        let id = |one: &Attributes| {
            format!("{} {}", text(one, "id").unwrap_or_default(), text(one, "begin").unwrap_or_default())
        };
        shown.iter().map(|one| id(one).trim().to_owned()).collect()
    }

    const STATES: [(&str, &str, &str); 5] = [
        ("a", "", "1982-05-01"),
        ("a", "1982-05-01", "1982-06-01"),
        ("b", "", ""),
        ("a", "1982-06-01", ""),
        ("b", "", ""),
    ];

    #[test]
    fn each_thing_is_shown_as_it_is_at_the_moment() {
        let at = |time: &str| ids(&at_time(features(&STATES), Moment::parse(time)));
        assert_eq!(at("1982-04-01"), ["a", "b", "b"]);
        assert_eq!(at("1982-05-01"), ["a 1982-05-01", "b", "b"]);
        assert_eq!(at("1990-01-01"), ["b", "a 1982-06-01", "b"]);
    }

    #[test]
    fn without_a_moment_each_thing_is_shown_as_it_is_last() {
        assert_eq!(ids(&at_time(features(&STATES), None)), ["a 1982-06-01", "b", "b"]);
    }
}
