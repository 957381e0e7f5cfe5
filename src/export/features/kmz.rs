//! Features as KMZ (KML 2.2, OGC 07-147r2): a folder a layer, symbols as pictures that stand with their place on the ground.

use std::collections::BTreeMap;

use glam::DVec3;

use super::xml_text::XmlText;
use super::{
    ExportFeature, ExportKind, ExportLayer, ExportShape, ExportedFeatures, FeatureExportError, MadeFile,
    counted, written,
};
use crate::page::PageSymbol;
use crate::page_symbols::symbol_picture;
use sandtable_base::archive::zip;
use sandtable_base::message::numbers::trimmed;
use sandtable_draw::color::Srgba;
use sandtable_files::png::encode_png;
use sandtable_scene::scene_model::SceneModel;

/// Pixels of a line of a millimeter.
const PX_PER_MM: f32 = 3.8;
/// The size of pictures in a viewer, against that in pictures 1080 pixels high.
const ICON_SCALE: f64 = 1.0;
/// A viewer draws a picture this high at the scale 1, pixels.
const ICON_PX: f64 = 32.0;

/// The file.
///
/// # Errors
/// [`FeatureExportError`].
pub(super) fn file(
    layers: &[ExportLayer],
    title: &str,
    scene: &SceneModel,
) -> Result<MadeFile, FeatureExportError> {
    if layers.is_empty() {
        return Err(FeatureExportError::Empty("a .kmz"));
    }
    let mut icons = Icons { scene, known: BTreeMap::new(), files: Vec::new() };
    let mut xml = XmlText::new();
    xml.open("kml", &[("xmlns", "http://www.opengis.net/kml/2.2")])
        .open("Document", &[])
        .element("name", title);
    for layer in layers {
        style(&mut xml, layer);
    }
    let mut folders = Vec::new();
    for layer in layers {
        let mut marks = Vec::new();
        for feature in &layer.features {
            let icon = feature.symbol.and_then(|index| icons.of(index));
            marks.push((feature, icon));
        }
        folders.push((layer, marks));
    }
    for (number, icon) in icons.files.iter().enumerate() {
        icon_style(&mut xml, number, icon);
    }
    for (layer, marks) in &folders {
        xml.open("Folder", &[]).element("name", layer.name);
        for (feature, icon) in marks {
            placemark(&mut xml, layer, feature, *icon);
        }
        xml.close();
    }
    let document = xml.finish();
    let names: Vec<String> = (0..icons.files.len()).map(|number| format!("symbols/{number}.png")).collect();
    let pictures: Vec<Vec<u8>> = icons.files.iter().map(|icon| encode_png(&icon.pixels)).collect();
    let mut members: Vec<(&str, &[u8])> = vec![("doc.kml", document.as_bytes())];
    members.extend(names.iter().map(String::as_str).zip(pictures.iter().map(Vec::as_slice)));
    let bytes = zip(&members).map_err(|error| FeatureExportError::Make(error.to_string()))?;
    Ok(MadeFile { bytes, told: ExportedFeatures { layers: counted(layers), notes: Vec::new() } })
}

/// The pictures of symbols, each once.
struct Icons<'a> {
    scene: &'a SceneModel,
    /// By code and texts.
    known: BTreeMap<String, Option<usize>>,
    files: Vec<PageSymbol>,
}

impl Icons<'_> {
    fn of(&mut self, index: usize) -> Option<usize> {
        let symbol = self.scene.military.get(index)?;
        let key = format!("{} {:?}", symbol.code.digits(), symbol.texts);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let number = symbol_picture(self.scene, symbol).map(|picture| {
            self.files.push(picture);
            self.files.len() - 1
        });
        self.known.insert(key, number);
        number
    }
}

/// A color as KML writes it: alpha, blue, green, red.
fn color(Srgba([red, green, blue, alpha]): Srgba) -> String {
    format!("{alpha:02x}{blue:02x}{green:02x}{red:02x}")
}

fn style(xml: &mut XmlText, layer: &ExportLayer) {
    let (stroke, width) = (color(layer.look.stroke), (layer.look.width_mm * PX_PER_MM).max(1.0));
    xml.open("Style", &[("id", layer.name)]);
    xml.open("LineStyle", &[])
        .element("color", &stroke)
        .element("width", &trimmed(f64::from(width), 2))
        .close();
    if layer.kind == ExportKind::Polygons {
        xml.open("PolyStyle", &[]);
        match layer.look.fill {
            Some(fill) => xml.element("color", &color(fill)),
            None => xml.element("fill", "0"),
        };
        xml.close();
    }
    if layer.kind == ExportKind::Points {
        xml.open("IconStyle", &[]).element("color", &stroke).element("scale", "0.4");
        xml.open("Icon", &[])
            .element("href", "http://maps.google.com/mapfiles/kml/shapes/placemark_circle.png")
            .close();
        xml.close();
        xml.open("LabelStyle", &[]).element("color", &stroke).element("scale", "0.8").close();
    }
    xml.close();
}

fn icon_style(xml: &mut XmlText, number: usize, icon: &PageSymbol) {
    let (width, height) = (f64::from(icon.pixels.width()), f64::from(icon.pixels.height()));
    let scale = width.max(height) / ICON_PX * ICON_SCALE;
    let hot = [f64::from(icon.anchor_px.x) / width, 1.0 - f64::from(icon.anchor_px.y) / height];
    xml.open("Style", &[("id", &format!("symbol-{number}"))]);
    xml.open("IconStyle", &[]).element("scale", &trimmed(scale, 3));
    xml.open("Icon", &[]).element("href", &format!("symbols/{number}.png")).close();
    let [x, y] = hot.map(|share| trimmed(share, 4));
    xml.element_with("hotSpot", &[("x", &x), ("y", &y), ("xunits", "fraction"), ("yunits", "fraction")], "");
    xml.close();
    // The picture says what the symbol is called.
    xml.open("LabelStyle", &[]).element("scale", "0").close();
    xml.close();
}

fn placemark(xml: &mut XmlText, layer: &ExportLayer, feature: &ExportFeature, icon: Option<usize>) {
    xml.open("Placemark", &[]);
    let text = |name: &str| feature.text(name);
    let name = [layer.label, "name", "text"].into_iter().map(text).find(|name| !name.is_empty());
    if let Some(name) = name {
        xml.element("name", &name);
    }
    let style = icon.map_or_else(|| format!("#{}", layer.name), |number| format!("#symbol-{number}"));
    xml.element("styleUrl", &style);
    if !feature.properties.is_empty() {
        xml.open("ExtendedData", &[]);
        for (key, value) in &feature.properties {
            let value = written(value);
            xml.open("Data", &[("name", key)]).element("value", &value).close();
        }
        xml.close();
    }
    match &feature.shape {
        ExportShape::Point(at) => {
            xml.open("Point", &[])
                .element("altitudeMode", "clampToGround")
                .element("coordinates", &tuple(at))
                .close();
        }
        ExportShape::Line(line) => {
            xml.open("LineString", &[])
                .element("tessellate", "1")
                .element("coordinates", &tuples(line.iter()))
                .close();
        }
        ExportShape::Polygon(rings) => {
            xml.open("Polygon", &[]).element("tessellate", "1");
            for (index, ring) in rings.iter().enumerate() {
                let side = if index == 0 { "outerBoundaryIs" } else { "innerBoundaryIs" };
                xml.open(side, &[]).open("LinearRing", &[]);
                xml.element("coordinates", &tuples(ring.iter().chain(ring.first()))).close().close();
            }
            xml.close();
        }
    }
    xml.close();
}

fn tuple(at: &DVec3) -> String {
    let (x, y) = (trimmed(at.x, 9), trimmed(at.y, 9));
    if at.z.is_finite() { format!("{x},{y},{}", trimmed(at.z, 3)) } else { format!("{x},{y}") }
}

fn tuples<'a>(places: impl Iterator<Item = &'a DVec3>) -> String {
    places.map(tuple).collect::<Vec<_>>().join(" ")
}
