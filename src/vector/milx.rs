//! MilX layers (`.milxly`, and zipped `.milxlyz`), as map.army and the MSS library of gs-soft write them: symbols and tactical
//! graphics of MIL-STD-2525C or APP-6 with their points.
//!
//! A graphic's `MssStringXML` holds an escaped `<Symbol ID="…">` with an `<Attribute ID="T">` for each field. Points are in the
//! system that the layer names, WGS 84 unless it is that of Switzerland.

use glam::DVec2;

use crate::builder::{FeatureParts, LayerBuilder, Vertices};
use crate::error::{VectorError, shorten};
use crate::feature::{Properties, VectorLayer};
use crate::hints::VectorHints;
use crate::overlay_schema::{LAYER, SIDC, bare_code, field_property, set};
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
    let mut builder = LayerBuilder::new(hints.crs.cloned().unwrap_or_else(Crs::wgs84));
    let root = xml.root()?;
    let mut names = Vec::new();
    let mut add = |layer: &XmlElement<'_>, xml: &XmlReader<'_>| {
        let name = child_text(layer, "Name").unwrap_or_else(|| "layer".to_owned());
        if hints.layer.is_none_or(|wanted| wanted == name) {
            add_layer(layer, &name, xml, &mut builder);
        }
        names.push(name);
    };
    if root.name() == "MilXLayer" {
        let layer = xml.read(root)?;
        add(&layer, &xml);
    } else {
        while let Some(child) = xml.next_child()? {
            if child.name() == "MilXLayer" {
                let layer = xml.read(child)?;
                add(&layer, &xml);
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

fn add_layer(layer: &XmlElement<'_>, name: &str, xml: &XmlReader<'_>, builder: &mut LayerBuilder) {
    let system = child_text(layer, "CoordSystemType").unwrap_or_default();
    let system = system_of(&system);
    let lists = layer.children_named("GraphicList");
    for graphic in lists.flat_map(|list| list.children_named("MilXGraphic")) {
        let place = || xml.line_of(graphic);
        let read = system.clone().and_then(|system| read_graphic(graphic, system.as_ref()));
        match read {
            Ok((parts, mut properties)) => {
                set(&mut properties, LAYER, name);
                builder.add_at(parts, properties, place);
            }
            Err(reason) => {
                let line = place();
                builder.add_broken(&line, VectorError::broken(FORMAT, &line, reason));
            }
        }
    }
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

fn read_graphic(
    graphic: &XmlElement<'_>,
    system: Option<&Crs>,
) -> Result<(FeatureParts, Properties), String> {
    let symbol = child_text(graphic, "MssStringXML").or_else(|| child_text(graphic, "MssString"));
    let symbol = symbol.ok_or("the graphic has no symbol")?;
    let mut properties = Properties::new();
    read_symbol(&symbol, &mut properties).map_err(|error| match error {
        VectorError::Broken { source, .. } => format!("its symbol is broken: {source}"),
        error => error.to_string(),
    })?;
    let lists = graphic.children_named("PointList");
    let points = lists.flat_map(|list| list.children_named("Point")).map(|point| {
        let number = |name| child_text(point, name).and_then(|text| text.parse::<f64>().ok());
        let at = number("X").zip(number("Y")).map(|(x, y)| DVec2::new(x, y)).filter(|at| at.is_finite());
        let at = at.ok_or("a point is no pair of numbers")?;
        match system {
            Some(system) => system.transform(&Crs::wgs84(), at).map_err(|error| error.to_string()),
            None => Ok(at),
        }
    });
    let points: Vertices =
        points.map(|at: Result<DVec2, String>| at.map(|at| at.extend(f64::NAN))).collect::<Result<_, _>>()?;
    let mut parts = FeatureParts::default();
    match points.len() {
        0 => return Err("the graphic has no points".into()),
        1 => parts.add_points(points),
        _ => parts.add_line(points),
    }
    Ok((parts, properties))
}

/// Reads the escaped symbol: its code and fields.
fn read_symbol(text: &str, properties: &mut Properties) -> Result<(), VectorError> {
    let mut xml = XmlReader::new(text, FORMAT);
    let root = xml.root()?;
    let symbol = xml.read(root)?;
    let id = symbol.attribute("ID").unwrap_or_default();
    let Some(code) = bare_code(&id) else {
        return Err(xml.broken(format!("'{}' is no symbol code", shorten(&id))));
    };
    set(properties, SIDC, code);
    for attribute in symbol.children_named("Attribute") {
        if let Some(property) = attribute.attribute("ID").and_then(|id| field_property(&id)) {
            set(properties, property, attribute.text());
        }
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
}
