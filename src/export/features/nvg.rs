//! Symbols and graphics as NATO Vector Graphics 2.0: points, polylines and polygons with their codes, fields and styles.

use super::xml_text::XmlText;
use super::{
    ExportFeature, ExportLayer, ExportShape, ExportedFeatures, FeatureExportError, MadeFile, counted, written,
};
use sandtable_base::message::numbers::trimmed;
use sandtable_draw::color::Srgba;
use sandtable_vector::overlay_schema as schema;

/// The layers that the format holds.
const HELD: [&str; 7] =
    ["symbols", "graphic_points", "graphic_lines", "graphic_areas", "ranges", "sight_lines", "labels"];

/// The file.
///
/// # Errors
/// [`FeatureExportError::Empty`].
pub(super) fn file(layers: &[ExportLayer]) -> Result<MadeFile, FeatureExportError> {
    let (held, left): (Vec<&ExportLayer>, Vec<&ExportLayer>) =
        layers.iter().partition(|layer| HELD.contains(&layer.name));
    if held.is_empty() {
        return Err(FeatureExportError::Empty("an .nvg"));
    }
    let mut xml = XmlText::new();
    xml.open("nvg", &[("xmlns", "https://tide.act.nato.int/schemas/2012/10/nvg"), ("version", "2.0.0")]);
    for layer in &held {
        xml.open("g", &[("label", layer.name)]);
        layer.features.iter().for_each(|feature| element(&mut xml, layer, feature));
        xml.close();
    }
    let held: Vec<ExportLayer> = held.into_iter().cloned().collect();
    let told = ExportedFeatures { layers: counted(&held), notes: left_out(&left, "NVG") };
    Ok(MadeFile { bytes: xml.finish().into_bytes(), told })
}

/// A note on the layers that a format does not hold.
pub(super) fn left_out(layers: &[&ExportLayer], format: &str) -> Vec<String> {
    let names: Vec<&str> = layers
        .iter()
        .map(|layer| layer.name)
        .filter(|name| !matches!(*name, "graphics_drawn" | "graphic_texts"))
        .collect();
    match names.is_empty() {
        true => Vec::new(),
        false => vec![format!(
            "left out, since {format} holds units and graphics: {}; a .gpkg has all",
            names.join(", ")
        )],
    }
}

fn element(xml: &mut XmlText, layer: &ExportLayer, feature: &ExportFeature) {
    let text = |name: &str| feature.text(name);
    let code = text(schema::SIDC);
    let label = [schema::NAME, schema::UNIQUE_DESIGNATION, "text"]
        .into_iter()
        .map(text)
        .find(|text| !text.is_empty());
    let symbol = if code.is_empty() { String::new() } else { format!("2525d:{code}") };
    let modifiers: Vec<String> = feature
        .properties
        .keys()
        .filter_map(|key| {
            Some(format!("{}:{}", schema::field_letters(key)?, text(key).replace([';', ':'], " ")))
        })
        .collect();
    let (modifiers, style) = (modifiers.join(";"), style(layer, feature));
    let places = |points: &[glam::DVec3]| {
        points
            .iter()
            .map(|at| format!("{},{}", trimmed(at.x, 9), trimmed(at.y, 9)))
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut attributes: Vec<(&str, String)> = match &feature.shape {
        ExportShape::Point(at) => vec![("x", trimmed(at.x, 9)), ("y", trimmed(at.y, 9))],
        ExportShape::Line(line) => vec![("points", places(line))],
        ExportShape::Polygon(rings) => {
            vec![("points", rings.first().map(|ring| places(ring)).unwrap_or_default())]
        }
    };
    let name = match feature.shape {
        ExportShape::Point(_) if layer.name == "labels" => "text",
        ExportShape::Point(_) => "point",
        ExportShape::Line(_) if feature.properties.contains_key(schema::WIDTH) => "corridor",
        ExportShape::Line(_) => "polyline",
        ExportShape::Polygon(_) => "polygon",
    };
    if name == "corridor" {
        attributes.push(("width", text(schema::WIDTH)));
    }
    if name == "text" {
        attributes.push(("content", text("text")));
    }
    attributes.push(("symbol", symbol));
    attributes.push(("label", label.unwrap_or_default()));
    attributes.push(("modifiers", modifiers));
    attributes.push(("course", text(schema::DIRECTION)));
    attributes.push(("style", style));
    attributes.retain(|(_, value)| !value.is_empty());
    let attributes: Vec<(&str, &str)> =
        attributes.iter().map(|(name, value)| (*name, value.as_str())).collect();
    match &feature.shape {
        ExportShape::Polygon(rings) if rings.len() > 1 => {
            xml.open(name, &attributes).open("exclude", &[]);
            for hole in &rings[1..] {
                xml.element_with("linear-ring", &[("points", &places(hole))], "");
            }
            xml.close().close();
        }
        _ => drop(xml.element_with(name, &attributes, "")),
    }
}

/// The style of what has no code.
fn style(layer: &ExportLayer, feature: &ExportFeature) -> String {
    if feature.properties.contains_key(schema::SIDC) {
        return String::new();
    }
    let stated: Vec<String> = [
        schema::STROKE,
        schema::STROKE_WIDTH,
        schema::STROKE_OPACITY,
        schema::FILL,
        schema::FILL_OPACITY,
        schema::STROKE_DASHES,
    ]
    .into_iter()
    .filter_map(|key| {
        let value = feature.properties.get(key)?;
        Some(format!("{key}:{}", written(value)))
    })
    .collect();
    if stated.is_empty() {
        let Srgba([red, green, blue, _]) = layer.look.stroke;
        return format!("stroke:#{red:02x}{green:02x}{blue:02x};fill:none");
    }
    stated.join(";")
}
