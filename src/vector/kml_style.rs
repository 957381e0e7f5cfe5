//! Styles of KML (OGC 07-147r2, clauses 12.2 to 12.13) as properties of simplestyle: shared ones by their names, those of a pair for
//! the normal state, and those of a placemark, which count before the shared ones.

use std::collections::BTreeMap;

use crate::feature::Properties;
use crate::moment::Moment;
use crate::overlay_schema::{
    BEGIN, END, FILL, FILL_OPACITY, MARKER_COLOR, STROKE, STROKE_OPACITY, STROKE_WIDTH, set, set_number,
};
use crate::xml::XmlElement;

/// As many steps from a style to the one that it names are followed.
const MOST_STEPS: usize = 8;

/// The shared styles of a document so far; they stand before the placemarks that name them.
#[derive(Default)]
pub(crate) struct KmlStyles {
    styles: BTreeMap<String, Properties>,
    /// Names of pairs, with the style of their normal state.
    pairs: BTreeMap<String, String>,
}

impl KmlStyles {
    /// Keeps a shared `Style` or `StyleMap`.
    pub fn add(&mut self, element: &XmlElement<'_>) {
        let Some(id) = element.attribute("id") else { return };
        if element.name() == "Style" {
            self.styles.insert(id.into_owned(), style(element));
            return;
        }
        let normal = element
            .children_named("Pair")
            .find(|pair| pair.children_named("key").next().is_none_or(|key| key.text() == "normal"));
        let Some(pair) = normal else { return };
        if let Some(url) = pair.children_named("styleUrl").next() {
            self.pairs.insert(id.into_owned(), name_of(&url.text()));
        } else if let Some(inline) = pair.children_named("Style").next() {
            self.styles.insert(id.into_owned(), style(inline));
        }
    }

    /// Sets what a placemark's own style, and the one that it names, say.
    pub fn apply(&self, placemark: &XmlElement<'_>, properties: &mut Properties) {
        let url = placemark.children_named("styleUrl").next().map(|url| name_of(&url.text()));
        let mut shared = Properties::new();
        if let Some(found) = url.and_then(|name| self.find(name)) {
            shared.clone_from(found);
        }
        placemark.children_named("Style").for_each(|own| shared.extend(style(own)));
        // What the data of the placemark says of itself counts first.
        for (name, value) in shared {
            properties.entry(name).or_insert(value);
        }
    }

    fn find(&self, mut name: String) -> Option<&Properties> {
        for _ in 0..MOST_STEPS {
            if let Some(found) = self.styles.get(&name) {
                return Some(found);
            }
            name.clone_from(self.pairs.get(&name)?);
        }
        None
    }
}

/// Sets the moments of a `TimeSpan` or a `TimeStamp`.
pub(crate) fn add_time(element: &XmlElement<'_>, properties: &mut Properties) {
    let pairs = [(BEGIN, "begin"), (END, "end"), (BEGIN, "when")];
    for (property, name) in pairs {
        let moment = element.children_named(name).next().and_then(|time| Moment::parse(&time.text()));
        moment.into_iter().for_each(|moment| set(properties, property, moment.to_string()));
    }
}

/// The name of a style of the same document: what follows the `#`.
fn name_of(url: &str) -> String {
    url.rsplit('#').next().unwrap_or(url).to_owned()
}

fn style(element: &XmlElement<'_>) -> Properties {
    let mut properties = Properties::new();
    let part = |name: &str| element.children_named(name).next();
    let text = |part: &XmlElement<'_>, name: &str| part.children_named(name).next().map(XmlElement::text);
    let flag = |part: &XmlElement<'_>, name: &str| {
        text(part, name).is_none_or(|text| text != "0" && text != "false")
    };
    if let Some(line) = part("LineStyle") {
        let color = text(line, "color").and_then(|text| color(&text));
        if let Some((hex, opacity)) = color {
            set(&mut properties, STROKE, hex);
            set_number(&mut properties, STROKE_OPACITY, Some(opacity));
        }
        let width = text(line, "width").and_then(|text| text.parse().ok());
        set_number(&mut properties, STROKE_WIDTH, width.filter(|width: &f64| *width > 0.0));
    }
    if let Some(area) = part("PolyStyle") {
        match text(area, "color").and_then(|text| color(&text)).filter(|_| flag(area, "fill")) {
            Some((hex, opacity)) => {
                set(&mut properties, FILL, hex);
                set_number(&mut properties, FILL_OPACITY, Some(opacity));
            }
            None if !flag(area, "fill") => set(&mut properties, FILL, "none"),
            None => {}
        }
        if !flag(area, "outline") {
            set(&mut properties, STROKE, "none");
        }
    }
    if let Some(icon) = part("IconStyle") {
        let color = text(icon, "color").and_then(|text| color(&text));
        color.into_iter().for_each(|(hex, _)| set(&mut properties, MARKER_COLOR, hex));
    }
    properties
}

/// A color `aabbggrr` as `#rrggbb`, and its opacity.
fn color(text: &str) -> Option<(String, f64)> {
    let digits = text.trim().trim_start_matches('#');
    if digits.len() != 8 {
        return None;
    }
    let [alpha, blue, green, red] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
    Some((format!("#{red:02x}{green:02x}{blue:02x}"), (f64::from(alpha) / 255.0 * 1000.0).round() / 1000.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::VectorHints;
    use crate::read::read;

    const SHARED: &str = "<Style id='red'><LineStyle><color>800000ff</color><width>3</width></LineStyle>\
        <PolyStyle><color>ff00ff00</color><fill>0</fill></PolyStyle><IconStyle><color>ffff0000</color></IconStyle></Style>\
        <StyleMap id='pair'><Pair><key>highlight</key><styleUrl>#none</styleUrl></Pair><Pair><key>normal</key><styleUrl>#red</styleUrl></Pair></StyleMap>\
        <StyleMap id='circle'><Pair><key>normal</key><styleUrl>#circle</styleUrl></Pair></StyleMap>";

    fn properties(placemark: &str) -> Properties {
        let text = format!(
            "<kml><Document>{SHARED}<Placemark>{placemark}<Point><coordinates>1,2</coordinates></Point></Placemark></Document></kml>"
        );
        let layer = read("a.kml", text.as_bytes(), &VectorHints::default()).expect("a document");
        layer.features[0].properties.clone()
    }

    #[test]
    fn shared_styles_and_pairs_become_properties_of_simplestyle() {
        for url in ["#red", "#pair"] {
            let found = properties(&format!("<styleUrl>{url}</styleUrl>"));
            for (name, expected) in [("stroke", "#ff0000"), ("fill", "none"), ("marker-color", "#0000ff")] {
                assert_eq!(found[name], expected, "{url} {name}");
            }
            assert_eq!(
                (found["stroke-width"].as_f64(), found["stroke-opacity"].as_f64()),
                (Some(3.0), Some(0.502))
            );
        }
        assert!(!properties("<styleUrl>#circle</styleUrl>").contains_key("stroke"));
        assert!(!properties("<styleUrl>other.kml#far</styleUrl>").contains_key("stroke"));
    }

    #[test]
    fn a_placemark_s_own_style_counts_before_the_shared_and_its_data_before_both() {
        let own = "<styleUrl>#red</styleUrl><Style><LineStyle><color>ff00ffff</color></LineStyle></Style>";
        let found = properties(own);
        assert_eq!((found["stroke"].as_str(), found["fill"].as_str()), (Some("#ffff00"), Some("none")));
        let data = "<ExtendedData><Data name='stroke'><value>#123456</value></Data></ExtendedData>";
        assert_eq!(properties(&format!("{own}{data}"))["stroke"], "#123456");
    }

    #[test]
    fn times_are_moments() {
        let span =
            properties("<TimeSpan><begin>1982-05-21T08:00:00-04:00</begin><end>1982-05-28</end></TimeSpan>");
        assert_eq!(
            (span["begin"].as_str(), span["end"].as_str()),
            (Some("1982-05-21T12:00:00Z"), Some("1982-05-28T00:00:00Z"))
        );
        assert_eq!(
            properties("<TimeStamp><when>1982-05-21</when></TimeStamp>")["begin"],
            "1982-05-21T00:00:00Z"
        );
        assert!(!properties("<TimeStamp><when>soon</when></TimeStamp>").contains_key("begin"));
    }
}
