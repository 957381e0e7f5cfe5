//! Styles of layers for QGIS (QML, version 3): single symbols, symbols of units as pictures, labels.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::xml_text::XmlText;
use super::{ExportKind, ExportLayer};
use sandtable_draw::color::Srgba;

/// The height of a unit's frame in millimeters.
pub(super) const FRAME_MM: f32 = 6.0;

/// A picture for the features of a code.
pub(super) struct CodePicture {
    /// The value of the property `sidc`.
    pub code: String,
    /// The text of an SVG picture.
    pub svg: String,
    /// Its width and height in frames of a unit.
    pub size: [f32; 2],
    /// Where its place lies, from its middle, in frames, Y down.
    pub anchor: [f32; 2],
}

/// The style of a layer; `pictures` are those of its codes.
pub(super) fn qml(layer: &ExportLayer, pictures: &[CodePicture]) -> String {
    let mut xml = XmlText::new();
    xml.open(
        "qgis",
        &[
            ("version", "3.22.0"),
            ("styleCategories", "Symbology|Labeling"),
            ("labelsEnabled", if layer.label.is_empty() { "0" } else { "1" }),
        ],
    );
    if pictures.is_empty() {
        xml.open("renderer-v2", &[("type", "singleSymbol"), ("symbollevels", "0"), ("enableorderby", "0")]);
        xml.open("symbols", &[]);
        symbol(&mut xml, layer, "0", None);
        xml.close().close();
    } else {
        xml.open(
            "renderer-v2",
            &[("type", "categorizedSymbol"), ("attr", "sidc"), ("symbollevels", "0"), ("enableorderby", "0")],
        );
        xml.open("categories", &[]);
        for (index, picture) in pictures.iter().enumerate() {
            let number = index.to_string();
            xml.element_with(
                "category",
                &[
                    ("value", &picture.code),
                    ("symbol", &number),
                    ("label", &picture.code),
                    ("render", "true"),
                ],
                "",
            );
        }
        xml.close();
        xml.open("symbols", &[]);
        for (index, picture) in pictures.iter().enumerate() {
            symbol(&mut xml, layer, &index.to_string(), Some(picture));
        }
        xml.close().close();
    }
    if !layer.label.is_empty() {
        labeling(&mut xml, layer);
    }
    xml.finish()
}

fn rgba(Srgba([red, green, blue, alpha]): Srgba) -> String {
    format!("{red},{green},{blue},{alpha}")
}

fn symbol(xml: &mut XmlText, layer: &ExportLayer, name: &str, picture: Option<&CodePicture>) {
    let (kind, class) = match (layer.kind, picture) {
        (ExportKind::Points, Some(_)) => ("marker", "SvgMarker"),
        (ExportKind::Points, None) => ("marker", "SimpleMarker"),
        (ExportKind::Lines, _) => ("line", "SimpleLine"),
        (ExportKind::Polygons, _) => ("fill", "SimpleFill"),
    };
    xml.open(
        "symbol",
        &[("name", name), ("type", kind), ("alpha", "1"), ("clip_to_extent", "1"), ("force_rhr", "0")],
    );
    xml.open("layer", &[("class", class), ("enabled", "1"), ("pass", "0"), ("locked", "0")]);
    xml.open("Option", &[("type", "Map")]);
    let mut option = |key: &str, value: &str| {
        xml.element_with("Option", &[("type", "QString"), ("name", key), ("value", value)], "");
    };
    let (stroke, width) = (rgba(layer.look.stroke), format!("{:.2}", layer.look.width_mm));
    match (layer.kind, picture) {
        (ExportKind::Points, Some(picture)) => {
            option("name", &format!("base64:{}", STANDARD.encode(&picture.svg)));
            // The size of a picture is its width; its place is moved to the point.
            option("size", &format!("{:.3}", picture.size[0] * FRAME_MM));
            option("size_unit", "MM");
            option(
                "offset",
                &format!("{:.3},{:.3}", -picture.anchor[0] * FRAME_MM, -picture.anchor[1] * FRAME_MM),
            );
            option("offset_unit", "MM");
        }
        (ExportKind::Points, None) => {
            option("name", "circle");
            option("color", &stroke);
            option("outline_color", "255,255,255,255");
            option("size", &width);
            option("size_unit", "MM");
        }
        (ExportKind::Lines, _) => {
            option("line_color", &stroke);
            option("line_width", &width);
            option("line_width_unit", "MM");
            option("capstyle", "round");
            option("joinstyle", "round");
        }
        (ExportKind::Polygons, _) => {
            option("color", &layer.look.fill.map_or_else(|| "0,0,0,0".to_owned(), rgba));
            option("style", if layer.look.fill.is_some() { "solid" } else { "no" });
            option("outline_color", &stroke);
            option("outline_width", &width);
            option("outline_width_unit", "MM");
            option("outline_style", "solid");
        }
    }
    xml.close().close().close();
}

fn labeling(xml: &mut XmlText, layer: &ExportLayer) {
    xml.open("labeling", &[("type", "simple")]);
    xml.open("settings", &[("calloutType", "simple")]);
    let ink = rgba(layer.look.stroke);
    xml.open(
        "text-style",
        &[
            ("fieldName", layer.label),
            ("isExpression", "0"),
            ("fontSize", "8"),
            ("fontSizeUnit", "Point"),
            ("textColor", &ink),
        ],
    );
    xml.element_with(
        "text-buffer",
        &[
            ("bufferDraw", "1"),
            ("bufferSize", "0.8"),
            ("bufferSizeUnits", "MM"),
            ("bufferColor", "253,252,249,255"),
        ],
        "",
    );
    xml.close();
    let placement = match layer.kind {
        ExportKind::Points => "0",
        ExportKind::Lines => "2",
        ExportKind::Polygons => "1",
    };
    xml.element_with("placement", &[("placement", placement), ("dist", "1")], "");
    xml.close().close();
}
