//! MilX layers (`.milxly`, and zipped `.milxlyz`), as map.army and the MSS library of gs-soft write them: symbols and tactical
//! graphics of MIL-STD-2525C or APP-6 with their points.
//!
//! A graphic's `MssStringXML` holds an escaped `<Symbol ID="…">` with an `<Attribute ID="T">` for each field, `XO` for its color
//! and `XM` for the style of a free graphic. Points are in the system that the layer names, WGS 84 unless it is that of
//! Switzerland. Location attributes are in meters and, `Attitude`, in degrees.

use glam::DVec2;

use crate::builder::{FeatureParts, LayerBuilder, Vertices};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::overlay_schema::{
    AZIMUTHS, DISTANCES, FILL, LAYER, MARKER_COLOR, NAME, STROKE, STROKE_WIDTH, WIDTH, bare_code, set,
    set_code, set_field, set_number, shared_name,
};
use crate::svg_style::{delphi_color, hex_color};
use crate::xml::{self, DecodedXml, XmlElement, XmlReader};
use sandtable_geom::crs::Crs;

const FORMAT: &str = "MilX layer";

/// Reads the graphics of all layers, or of the one that is asked for.
///
/// # Errors
/// [`VectorError`], also where no graphic is sound.
pub(super) fn read(bytes: &[u8], hints: &VectorHints) -> Result<VectorLayer, VectorError> {
    let DecodedXml { text, fault } = xml::decode(bytes, FORMAT)?;
    let mut xml = XmlReader::new(&text, FORMAT);
    let mut builder = LayerBuilder::new(Crs::wgs84());
    if hints.crs.is_some_and(|crs| *crs != Crs::wgs84()) {
        builder.note("its layers name their systems: `crs` has no effect on them");
    }
    let root = xml.root()?;
    let mut names = Vec::new();
    if root.name() == "MilXLayer" {
        names.push(read_layer(&mut xml, hints.layer, &mut builder)?);
    } else {
        while let Some(child) = xml.next_child()? {
            if child.name() == "MilXLayer" {
                names.push(read_layer(&mut xml, hints.layer, &mut builder)?);
            } else {
                xml.skip()?;
            }
        }
    }
    xml.finish()?;
    if let Some(wanted) = hints.layer.filter(|wanted| !names.iter().any(|name| name == wanted)) {
        return Err(VectorError::no_such_layer(
            wanted,
            &names.iter().map(String::as_str).collect::<Vec<_>>(),
        ));
    }
    fault.into_iter().for_each(|fault| builder.fault(fault));
    builder.finish()
}

fn child_text(element: &XmlElement<'_>, name: &str) -> Option<String> {
    element.children_named(name).next().map(XmlElement::text).filter(|text| !text.is_empty())
}

/// A graphic whose points are in the system that its layer names behind it.
struct MilXGraphic {
    line: String,
    read: Result<(Vec<DVec2>, Properties), String>,
}

/// Reads the layer just opened and adds its graphics, where it is the one that is asked for; returns its name.
fn read_layer(
    xml: &mut XmlReader<'_>,
    wanted: Option<&str>,
    builder: &mut LayerBuilder,
) -> Result<String, VectorError> {
    let (mut name, mut system, mut graphics) = ("layer".to_owned(), String::new(), Vec::new());
    while let Some(child) = xml.next_child()? {
        match child.name() {
            "Name" => {
                name = Some(shared_name(&xml.read(child)?.text()))
                    .filter(|name| !name.is_empty())
                    .unwrap_or(name)
            }
            "CoordSystemType" => system = xml.read(child)?.text(),
            "GraphicList" => {
                while let Some(child) = xml.next_child()? {
                    if child.name() == "MilXGraphic" {
                        let graphic = xml.read(child)?;
                        let line = xml.line_of(&graphic);
                        graphics.push(MilXGraphic { line, read: read_graphic(&graphic) });
                    } else {
                        xml.skip()?;
                    }
                }
            }
            _ => xml.skip()?,
        }
    }
    if wanted.is_some_and(|wanted| wanted != name) {
        return Ok(name);
    }
    let system = system_of(&system);
    for MilXGraphic { line, read } in graphics {
        let shape =
            read.and_then(|(points, properties)| Ok((parts(points, system.clone()?.as_ref())?, properties)));
        match shape {
            Ok((parts, mut properties)) => {
                set(&mut properties, LAYER, name.as_str());
                builder.add_at(parts, properties, || line.clone());
            }
            Err(reason) => builder.add_broken(&line, VectorError::broken(FORMAT, &line, reason)),
        }
    }
    Ok(name)
}

/// A point, or a line through several, in longitude and latitude.
fn parts(points: Vec<DVec2>, system: Option<&Crs>) -> Result<FeatureParts, String> {
    let place = |at: DVec2| match system {
        Some(system) => system.transform(&Crs::wgs84(), at).map_err(|error| error.to_string()),
        None => Ok(at),
    };
    let places: Vertices =
        points.into_iter().map(|at| place(at).map(|at| at.extend(f64::NAN))).collect::<Result<_, _>>()?;
    let mut parts = FeatureParts::default();
    match places.len() {
        0 => return Err("the graphic has no points".into()),
        1 => parts.add_points(places),
        _ => parts.add_line(places),
    }
    Ok(parts)
}

/// The system of a layer's points; `None` for longitude and latitude.
fn system_of(name: &str) -> Result<Option<Crs>, String> {
    let plain: String =
        name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_uppercase();
    let code = match plain.as_str() {
        "" | "WGS84" | "LATLON" | "GEO" => return Ok(None),
        "LV03" | "CH1903" | "SWISS" | "SWISSGRID" => 21781,
        "LV95" | "CH1903LV95" => 2056,
        _ => return Err(format!("the layer's coordinate system '{}' is not known", shorten(name))),
    };
    Crs::from_epsg(code).map(Some).map_err(|error| error.to_string())
}

fn read_graphic(graphic: &XmlElement<'_>) -> Result<(Vec<DVec2>, Properties), String> {
    let symbol = child_text(graphic, "MssStringXML").or_else(|| child_text(graphic, "MssString"));
    let symbol = symbol.ok_or("the graphic has no symbol")?;
    let mut properties = Properties::new();
    read_symbol(&symbol, &mut properties).map_err(|error| match error {
        VectorError::Broken { source, .. } => format!("its symbol is broken: {source}"),
        error => error.to_string(),
    })?;
    child_text(graphic, "Name").into_iter().for_each(|name| set(&mut properties, NAME, name));
    add_location(graphic, &mut properties)?;
    let lists = graphic.children_named("PointList");
    let points = lists.flat_map(|list| list.children_named("Point")).map(|point| {
        let number = |name| child_text(point, name).and_then(|text| text.parse::<f64>().ok());
        let at = number("X").zip(number("Y")).map(|(x, y)| DVec2::new(x, y)).filter(|at| at.is_finite());
        at.ok_or_else(|| "a point is no pair of numbers".to_owned())
    });
    Ok((points.collect::<Result<_, _>>()?, properties))
}

/// Reads the escaped symbol: its code and fields.
fn read_symbol(text: &str, properties: &mut Properties) -> Result<(), VectorError> {
    let mut xml = XmlReader::new(text, FORMAT);
    let root = xml.root()?;
    let symbol = xml.read(root)?;
    let id = symbol.attribute("ID").unwrap_or_default();
    if bare_code(&id).is_none() {
        return Err(xml.broken(format!("'{}' is no symbol code", shorten(&id))));
    }
    set_code(properties, &id);
    for attribute in symbol.children_named("Attribute") {
        let Some(letters) = attribute.attribute("ID") else { continue };
        match &*letters {
            "XO" => delphi_color(&attribute.text())
                .into_iter()
                .for_each(|color| set(properties, MARKER_COLOR, hex_color(color))),
            "XM" => add_style(attribute, properties),
            letters => {
                set_field(properties, letters, &attribute.text());
            }
        }
    }
    Ok(())
}

/// The style of a free graphic: `<Line Color="clRed" Width="2"/><Fill Color="…"/>`.
fn add_style(attribute: &XmlElement<'_>, properties: &mut Properties) {
    for (name, property) in [("Line", STROKE), ("Fill", FILL)] {
        let colors =
            attribute.children_named(name).filter_map(|part| delphi_color(&part.attribute("Color")?));
        colors.for_each(|color| set(properties, property, hex_color(color)));
    }
    let widths = attribute.children_named("Line").filter_map(|line| line.number::<f64>("Width"));
    set_number(properties, STROKE_WIDTH, widths.last().filter(|width| (0.0..=100.0).contains(width)));
}

/// The distances and the direction that a graphic has besides its points.
fn add_location(graphic: &XmlElement<'_>, properties: &mut Properties) -> Result<(), String> {
    let mut distances = Vec::new();
    let lists = graphic.children_named("LocationAttributeList");
    for attribute in lists.flat_map(|list| list.children_named("LocationAttribute")) {
        let Some(kind) = child_text(attribute, "AttrType") else { continue };
        let text = child_text(attribute, "Value").unwrap_or_default();
        let value: f64 = text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            format!("the {} '{}' of the graphic is no number", shorten(&kind), shorten(&text))
        })?;
        match kind.as_str() {
            "Width" => set_number(properties, WIDTH, Some(value).filter(|width| *width > 0.0)),
            "Attitude" => set(properties, AZIMUTHS, value.to_string()),
            _ => distances.push(value.to_string()),
        }
    }
    if !distances.is_empty() {
        set(properties, DISTANCES, distances.join(" "));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;
    use sandtable_base::archive::zip;

    fn document(graphics: &str, system: &str) -> String {
        format!(
            "<MilXDocument_Layer xmlns='http://gs-soft.com/MilX/V3.1'><MilXLayer><Name>Friend</Name><GraphicList>{graphics}</GraphicList>\
             <CoordSystemType>{system}</CoordSystemType></MilXLayer></MilXDocument_Layer>"
        )
    }

    fn graphic(symbol: &str, points: &[[f64; 2]]) -> String {
        let points: String =
            points.iter().map(|[x, y]| format!("<Point><X>{x}</X><Y>{y}</Y></Point>")).collect();
        format!(
            "<MilXGraphic><MssStringXML>{symbol}</MssStringXML><PointList>{points}</PointList></MilXGraphic>"
        )
    }

    const COMPANY: &str = "&lt;Symbol ID=\"SFGPUCIA---E--G\"&gt;&lt;Attribute ID=\"T\"&gt;A&lt;/Attribute&gt;&lt;Attribute ID=\"XO\"&gt;$80FF&lt;/Attribute&gt;&lt;/Symbol&gt;";
    const LINE: &str = "&lt;Symbol ID=\"GFGPGLP-------X\"/&gt;";

    #[test]
    fn graphics_have_their_code_fields_points_and_layer() {
        let text = document(
            &(graphic(COMPANY, &[[-59.0, -51.5]]) + &graphic(LINE, &[[-59.0, -51.5], [-58.0, -51.0]])),
            "WGS84",
        );
        for bytes in [text.clone().into_bytes(), zip(&[("a.milxly", text.as_bytes())]).expect("memory")] {
            let layer = read::read("a.milxlyz", &bytes, &VectorHints::default()).expect("a layer");
            let [company, line] = &layer.features[..] else { panic!("two: {:?}", layer.features) };
            assert_eq!(company.properties["sidc"], "SFGPUCIA---E--G");
            assert_eq!(company.properties["unique_designation"], "A");
            assert_eq!(company.properties["layer"], "Friend");
            assert_eq!((company.points().len(), line.lines()[0].len()), (1, 2));
        }
    }

    #[test]
    fn points_of_the_swiss_grid_are_brought_to_degrees() {
        let text = document(&graphic(COMPANY, &[[600_000.0, 200_000.0]]), "LV03");
        let layer = read::read("a.milxly", text.as_bytes(), &VectorHints::default()).expect("a layer");
        let at = layer.features[0].points()[0];
        assert!((at - DVec2::new(7.438_637, 46.951_081)).length() < 1e-4, "{at}");
    }

    #[test]
    fn graphics_that_are_broken_are_told_and_left_out() {
        let odd =
            ["&lt;Symbol ID=\"tank\"/&gt;", "&lt;Symbol", ""].map(|symbol| graphic(symbol, &[[0.0, 0.0]]));
        let text =
            document(&(odd.concat() + &graphic(COMPANY, &[]) + &graphic(COMPANY, &[[1.0, 2.0]])), "WGS84");
        let layer = read::read("a.milxly", text.as_bytes(), &VectorHints::default()).expect("one is sound");
        assert_eq!(layer.features.len(), 1);
        assert!(layer.faults[0].contains("4 records that cannot be read"), "{:?}", layer.faults);
        let text = document(&graphic(COMPANY, &[[1.0, 2.0]]), "Mars");
        let error = read::read("a.milxly", text.as_bytes(), &VectorHints::default())
            .expect_err("unknown")
            .to_string();
        assert!(error.contains("'Mars' is not known"), "{error}");
    }

    #[test]
    fn graphics_have_their_name_colors_and_sizes() {
        let symbol = "&lt;Symbol ID=\"G*F*ACSC--****X\"&gt;&lt;Attribute ID=\"XO\"&gt;$000080FF&lt;/Attribute&gt;\
            &lt;Attribute ID=\"F\"&gt;R&lt;/Attribute&gt;&lt;Attribute ID=\"XM\"&gt;&lt;Line Color=\"clRed\" Width=\"3\"/&gt;\
            &lt;Fill Color=\"$00FF0000\"/&gt;&lt;/Attribute&gt;&lt;/Symbol&gt;";
        let located = |kind: &str, value: &str| {
            format!(
                "<LocationAttribute><AttrType>{kind}</AttrType><Value>{value}</Value></LocationAttribute>"
            )
        };
        let with = |locations: String| {
            let list = format!(
                "<Name>FSA</Name><LocationAttributeList>{locations}</LocationAttributeList></MilXGraphic>"
            );
            graphic(symbol, &[[8.0, 47.0]]).replace("</MilXGraphic>", &list)
        };
        let text = document(
            &(with(located("Radius", "500") + &located("Attitude", "45")) + &with(located("Width", "x"))),
            "WGS84",
        );
        let layer = read::read("a.milxly", text.as_bytes(), &VectorHints::default()).expect("one is sound");
        let expected = serde_json::json!({
            "sidc": "GFFPACSC------X", "name": "FSA", "layer": "Friend", "marker-color": "#ff8000", "reinforced": "(+)",
            "stroke": "#ff0000", "stroke-width": 3.0, "fill": "#0000ff", "distances": "500", "azimuths": "45",
        });
        assert_eq!(serde_json::to_value(&layer.features[0].properties).expect("texts"), expected);
        assert!(layer.faults[0].contains("the Width 'x' of the graphic is no number"), "{:?}", layer.faults);
    }
}
