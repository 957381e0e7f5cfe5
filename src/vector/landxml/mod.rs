//! LandXML 1.0, 1.1 and 1.2 (LandXML.org, 2008): alignments with their profiles and stations, survey points and the lines of
//! plans.
//!
//! | layer | what it holds |
//! |---|---|
//! | alignments | a line for each, at the elevations of its profile where it has one |
//! | stations | points along them: the start, the end and every 100 units of the file, with `station` as text |
//! | points | `CgPoints` |
//! | plan_features | lines of `PlanFeatures` and `Parcels` |
//!
//! Points are northing before easting. Arcs and spirals become chords within a centimeter. Lengths are in the file's unit
//! and are brought to that of its coordinate system, elevations to meters. Surfaces are elevation files.
//!
//! Read here are also clothoids and the other transition curves of railroads, unsymmetrical and circular vertical curves,
//! and station equations. Cross sections, pipe networks and superelevation are not.

mod horizontal;
mod stations;
mod units;
mod vertical;

use glam::{DVec2, DVec3};
use serde_json::{Number, Value};

use crate::builder::{FeatureParts, LayerBuilder};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::landxml::horizontal::{NamedPoints, Traced, trace};
use crate::landxml::stations::StationEquations;
use crate::landxml::units::LandUnits;
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_base::limits::DESIGN_VERTICES;
use sandtable_geom::azimuth::azimuth_deg;
use sandtable_geom::crs::Crs;
use sandtable_geom::profile::Profile;

const FORMAT: &str = "LandXML file";
const LAYERS: [&str; 4] = ["alignments", "stations", "points", "plan_features"];
const ALIGNMENTS: usize = 0;
const STATIONS: usize = 1;
const POINTS: usize = 2;
const PLAN_FEATURES: usize = 3;

/// The distance between stations that are points, in the file's unit.
const STATION_STEP: f64 = 100.0;

/// The most stations of an alignment that are points; of a longer one every tenth, hundredth, ....
const MOST_STATIONS: f64 = 2000.0;

/// Reads the requested layer; without a request the first that holds anything: alignments, plan features, points.
///
/// # Errors
/// [`VectorError`], also where no feature of the layer is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    VectorError::check_design_size(FORMAT, bytes)?;
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let wanted = hints.layer.map(|_| hints.choose_layer(&LAYERS)).transpose()?;
    let mut xml = XmlReader::new(&text, FORMAT);
    let file = LandFile::read(&mut xml)?;
    let layer = match wanted {
        Some(wanted) => wanted,
        None if !file.alignments.is_empty() => ALIGNMENTS,
        None if !file.plans.is_empty() => PLAN_FEATURES,
        None if !file.points.is_empty() => POINTS,
        None if file.surfaces > 0 => {
            return Err(VectorError::Unsupported {
                format: FORMAT,
                content: "surfaces and no lines or points".into(),
                remedy: "name it as `dem` under [terrain]: its surface is an elevation model",
            });
        }
        None => ALIGNMENTS,
    };
    let mut builder = LayerBuilder::new(file.system(hints)?);
    fault.into_iter().for_each(|fault| builder.fault(fault));
    if wanted.is_none() {
        note_others(&file, layer, &mut builder);
    }
    LandLayer { file: &file, xml: &xml, layer: builder, vertices_left: DESIGN_VERTICES.get() }.finish(layer)
}

/// Notes what the file holds besides the layer that is read unasked.
fn note_others(file: &LandFile<'_>, layer: usize, builder: &mut LayerBuilder) {
    let counts =
        [(ALIGNMENTS, file.alignments.len()), (PLAN_FEATURES, file.plans.len()), (POINTS, file.points.len())];
    let others = counts.into_iter().filter(|&(other, count)| other != layer && count > 0);
    let others: Vec<String> =
        others.map(|(other, count)| format!("{count} in '{}'", LAYERS[other])).collect();
    if !others.is_empty() {
        let layer = LAYERS[layer];
        builder.note(format!("the layer '{layer}' is read; other layers hold more: {}", others.join(", ")));
    }
    if file.surfaces > 0 {
        builder.note(format!(
            "surfaces are not read as lines ({}): name the file as `dem` for them",
            file.surfaces
        ));
    }
}

/// The parts of a file that are read.
#[derive(Default)]
struct LandFile<'a> {
    units: LandUnits,
    crs: Option<XmlElement<'a>>,
    points: Vec<(String, XmlElement<'a>)>,
    named: NamedPoints,
    alignments: Vec<XmlElement<'a>>,
    plans: Vec<XmlElement<'a>>,
    surfaces: usize,
}

impl<'a> LandFile<'a> {
    fn read(xml: &mut XmlReader<'a>) -> Result<Self, VectorError> {
        let mut file = Self::default();
        xml.root()?;
        while let Some(child) = xml.next_child()? {
            match child.name() {
                "Units" => {
                    let units = xml.read(child)?;
                    file.units = LandUnits::of(&units).ok_or_else(|| VectorError::Unsupported {
                        format: FORMAT,
                        content: "lengths in a unit that LandXML does not have".into(),
                        remedy: "save it in meters, feet or US survey feet",
                    })?;
                }
                "CoordinateSystem" => file.crs = Some(xml.read(child)?),
                "CgPoints" => file.read_points(xml)?,
                "Alignments" => read_children(xml, "Alignment", &mut file.alignments)?,
                "PlanFeatures" => read_children(xml, "PlanFeature", &mut file.plans)?,
                "Parcels" => read_children(xml, "Parcel", &mut file.plans)?,
                "Surfaces" => {
                    while let Some(child) = xml.next_child()? {
                        file.surfaces += usize::from(child.name() == "Surface");
                        xml.skip()?;
                    }
                }
                _ => xml.skip()?,
            }
        }
        xml.finish()?;
        Ok(file)
    }

    fn read_points(&mut self, xml: &mut XmlReader<'a>) -> Result<(), VectorError> {
        while let Some(child) = xml.next_child()? {
            match child.name() {
                "CgPoint" => {
                    let point = xml.read(child)?;
                    let name = point.attribute("name").map(|name| name.into_owned()).unwrap_or_default();
                    if let Some(at) = horizontal::triple(&point.text()) {
                        self.named.entry(name.clone()).or_insert(at);
                    }
                    self.points.push((name, point));
                }
                // Groups of points.
                "CgPoints" => self.read_points(xml)?,
                _ => xml.skip()?,
            }
        }
        Ok(())
    }

    /// The stated system, else the file's own.
    fn system(&self, hints: &VectorHints) -> Result<Crs, VectorError> {
        let attribute =
            |name: &str| self.crs.as_ref()?.attribute(name).filter(|text| !text.trim().is_empty());
        let code =
            attribute("epsgCode").and_then(|code| code.trim().trim_start_matches("EPSG:").parse().ok());
        let crs = hints.crs_or(code, attribute("ogcWktCode").as_deref().filter(|_| code.is_none()))?;
        crs.ok_or(VectorError::NoCrs { format: FORMAT, reason: "names no EPSG code" })
    }
}

fn read_children<'a>(
    xml: &mut XmlReader<'a>,
    name: &str,
    found: &mut Vec<XmlElement<'a>>,
) -> Result<(), VectorError> {
    while let Some(child) = xml.next_child()? {
        if child.name() == name { found.push(xml.read(child)?) } else { xml.skip()? }
    }
    Ok(())
}

/// A layer while it is built.
struct LandLayer<'a> {
    file: &'a LandFile<'a>,
    xml: &'a XmlReader<'a>,
    layer: LayerBuilder,
    vertices_left: u64,
}

impl LandLayer<'_> {
    fn finish(mut self, layer: usize) -> Result<VectorLayer, VectorError> {
        // Of degrees the numbers are what they are.
        let crs_unit_m = self.layer.crs().meters_per_unit();
        let scale =
            if self.layer.crs().is_geographic() { 1.0 } else { self.file.units.linear_m / crs_unit_m };
        let elements = match layer {
            PLAN_FEATURES => &self.file.plans,
            POINTS => return self.points(scale),
            _ => &self.file.alignments,
        };
        for element in elements {
            let place = self.xml.line_of(element);
            let added = match layer {
                PLAN_FEATURES => self.plan(element, scale),
                STATIONS => self.stations(element, scale),
                _ => self.alignment(element, scale),
            };
            if let Err(reason) = added {
                self.layer.add_broken(&place, VectorError::broken(FORMAT, &place, reason));
            }
        }
        self.layer.finish()
    }

    fn points(mut self, scale: f64) -> Result<VectorLayer, VectorError> {
        for (name, element) in &self.file.points {
            let place = self.xml.line_of(element);
            match horizontal::point(element, &self.file.named) {
                Ok(at) => {
                    let mut properties = attributes(element, &["code", "desc", "featureRef", "pntSurv"]);
                    properties.insert("name".into(), name.clone().into());
                    let mut parts = FeatureParts::default();
                    parts.add_points(vec![self.placed(at, scale)]);
                    self.layer.add_at(parts, properties, || place.clone());
                }
                Err(reason) => self.layer.add_broken(&place, VectorError::broken(FORMAT, &place, reason)),
            }
        }
        self.layer.finish()
    }

    fn placed(&self, at: DVec3, scale: f64) -> DVec3 {
        DVec3::new(at.x * scale, at.y * scale, at.z * self.file.units.elevation_m)
    }

    fn plan(&mut self, element: &XmlElement<'_>, scale: f64) -> Result<(), String> {
        let mut parts = FeatureParts::default();
        for geometry in element.children_named("CoordGeom") {
            let traced = trace(geometry, &self.file.named)?;
            self.take(traced.vertices.len())?;
            traced.notes.iter().for_each(|note| self.layer.note(note.clone()));
            parts.add_line(traced.vertices.iter().map(|&at| self.placed(at, scale)).collect());
        }
        let place = self.xml.line_of(element);
        self.layer.add_at(parts, attributes(element, &["name", "desc", "state", "code"]), || place.clone());
        Ok(())
    }

    fn take(&mut self, count: usize) -> Result<(), String> {
        let left = self.vertices_left.checked_sub(count as u64);
        self.vertices_left = left.ok_or("the file has too many vertices with those of its arcs")?;
        Ok(())
    }

    /// Traces an alignment, and reads its profile.
    fn designed(&mut self, element: &XmlElement<'_>) -> Result<LandAlignment, String> {
        let geometry = element.children_named("CoordGeom").next();
        let mut traced = trace(geometry.ok_or("an alignment has no CoordGeom")?, &self.file.named)?;
        for note in std::mem::take(&mut traced.notes) {
            self.layer.note(note);
        }
        self.take(traced.vertices.len())?;
        let start = element.number::<f64>("staStart").filter(|start| start.is_finite()).unwrap_or(0.0);
        let profiles =
            element.children_named("Profile").flat_map(|profile| profile.children_named("ProfAlign"));
        let profiles: Vec<&XmlElement<'_>> = profiles.collect();
        let mut name = None;
        let mut elevations = None;
        if let Some(first) = profiles.first() {
            name = first.attribute("name").map(|name| name.into_owned());
            if profiles.len() > 1 {
                let (alignment, kept) = (label(element), name.clone().unwrap_or_default());
                self.layer.note(format!(
                    "{alignment} has {} profiles; the first, '{}', is taken",
                    profiles.len(),
                    shorten(&kept)
                ));
            }
            match vertical::elevations(first) {
                Ok(found) => elevations = found,
                Err(reason) => {
                    let alignment = label(element);
                    self.layer.fault(format!("{alignment} is without its profile: {reason}"));
                }
            }
        }
        Ok(LandAlignment { traced, start, profile: elevations, profile_name: name })
    }

    fn alignment(&mut self, element: &XmlElement<'_>, scale: f64) -> Result<(), String> {
        let designed = self.designed(element)?;
        let line = designed.line();
        self.take(line.len())?;
        let mut properties = attributes(element, &["name", "desc", "state", "oID"]);
        let units = self.file.units;
        let length = designed.length();
        let equations = StationEquations::of(element);
        insert_number(&mut properties, "length", length * units.linear_m);
        insert_number(&mut properties, "station_start", designed.start);
        insert_number(&mut properties, "station_end", equations.written(designed.start + length));
        if let Some(name) = designed.profile_name.as_ref().filter(|_| designed.profile.is_some()) {
            properties.insert("profile".into(), name.clone().into());
        }
        let mut parts = FeatureParts::default();
        parts.add_line(line.into_iter().map(|at| self.placed(at, scale)).collect());
        let place = self.xml.line_of(element);
        self.layer.add_at(parts, properties, || place.clone());
        Ok(())
    }

    fn stations(&mut self, element: &XmlElement<'_>, scale: f64) -> Result<(), String> {
        let designed = self.designed(element)?;
        let (from, to) = (designed.start, designed.start + designed.length());
        let equations = StationEquations::of(element);
        let mut step = STATION_STEP;
        while (to - from) / step > MOST_STATIONS {
            step *= 10.0;
        }
        let first = (from / step).floor() + 1.0;
        let between = (0..=MOST_STATIONS as usize).map(|index| (first + index as f64) * step);
        let between = between.take_while(|at| *at < to).map(|at| (at, "station"));
        let all: Vec<(f64, &str)> =
            std::iter::once((from, "start")).chain(between).chain([(to, "end")]).collect();
        let name = element.attribute("name").map(|name| name.into_owned()).unwrap_or_default();
        for (station, kind) in all {
            let Some((at, heading)) = designed.at(station) else { continue };
            let mut properties = Properties::new();
            let text = stations::text(equations.written(station), self.file.units.is_imperial);
            properties.insert("name".into(), text.clone().into());
            properties.insert("station".into(), text.into());
            properties.insert("alignment".into(), name.clone().into());
            properties.insert("kind".into(), kind.into());
            insert_number(&mut properties, "azimuth", azimuth_deg(heading));
            let at = self.placed(at, scale);
            if at.z.is_finite() {
                insert_number(&mut properties, "elevation", at.z);
            }
            let mut parts = FeatureParts::default();
            parts.add_points(vec![at]);
            self.layer.add(parts, properties);
        }
        Ok(())
    }
}

/// An alignment with its profile, in the file's units.
struct LandAlignment {
    traced: Traced,
    /// The station of its first vertex.
    start: f64,
    profile: Option<Profile>,
    profile_name: Option<String>,
}

impl LandAlignment {
    fn length(&self) -> f64 {
        self.traced.distances.last().copied().unwrap_or_default()
    }

    /// The vertices with those where the profile bends, at its elevations; without a profile at their own.
    fn line(&self) -> Vec<DVec3> {
        let Some(profile) = &self.profile else { return self.traced.vertices.clone() };
        let length = self.length();
        let bends = profile.stations().iter().map(|station| station - self.start);
        let bends = bends.filter(|distance| *distance > 0.0 && *distance < length);
        let mut distances: Vec<f64> = self.traced.distances.iter().copied().chain(bends).collect();
        distances.sort_by(f64::total_cmp);
        // Nearer to each other than a centimeter two vertices say no more than one.
        distances.dedup_by(|next, last| *next - *last < 0.01);
        distances.into_iter().filter_map(|distance| Some(self.at(self.start + distance)?.0)).collect()
    }

    /// The place at a station, at the elevation of the profile, and the direction there.
    fn at(&self, station: f64) -> Option<(DVec3, DVec2)> {
        let Traced { vertices, distances, .. } = &self.traced;
        let distance = station - self.start;
        let index = distances.partition_point(|&at| at <= distance).clamp(1, distances.len().max(2) - 1);
        let (from, to) = (vertices.get(index - 1)?, vertices.get(index)?);
        let leg = distances[index] - distances[index - 1];
        let share = if leg > 0.0 { ((distance - distances[index - 1]) / leg).clamp(0.0, 1.0) } else { 0.0 };
        let mut at = from.lerp(*to, share);
        if let Some(profile) = &self.profile {
            let [first, last] = profile.span();
            // Rounded stations of both ends.
            let is_on = station >= first - 0.01 && station <= last + 0.01;
            at.z = if is_on { profile.at(station) } else { f64::NAN };
        }
        Some((at, (to - from).truncate()))
    }
}

fn label(element: &XmlElement<'_>) -> String {
    let name = element.attribute("name").unwrap_or_default();
    format!("the alignment '{}'", shorten(&name))
}

/// The attributes of an element that are there.
fn attributes(element: &XmlElement<'_>, names: &[&str]) -> Properties {
    let value = |name: &&str| Some(((*name).to_owned(), Value::from(element.attribute(name)?.into_owned())));
    names.iter().filter_map(value).collect()
}

fn insert_number(properties: &mut Properties, name: &str, number: f64) {
    // Rounded to a tenth of a millimeter: sums of lengths have no more.
    let rounded = (number * 1e4).round() / 1e4;
    if let Some(number) = Number::from_f64(rounded) {
        properties.insert(name.to_owned(), number.into());
    }
}

#[cfg(test)]
mod tests;
