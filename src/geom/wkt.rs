//! Well-known text, version 1 (OGC 01-009), as `.prj` files hold it, in OGC's and in Esri's spelling.
//!
//! The text is a tree of `KEYWORD[value, value, …]`. A root that carries an EPSG authority is taken by its
//! code; any other by its parameters, where the projection is one that [`Definition`] can express. Of WKT 2
//! only the root's `ID["EPSG", n]` is understood.

use crate::geom::crs::epsg_text;
use crate::geom::projection::{Datum, Definition, Ellipsoid, MapProjection};

/// Nesting beyond this is no system's: real text stays below 6.
const DEEPEST: usize = 16;

/// What a text says.
#[derive(Clone, Debug, PartialEq)]
pub enum Wkt {
    /// The code of its root.
    Epsg(u32),
    /// Its parameters, where it carries no code that is known.
    Parameters(Box<Definition>),
}

/// Whether a text starts as the WKT of a horizontal or compound system does.
pub fn looks_like_wkt(text: &str) -> bool {
    const ROOTS: [&str; 8] =
        ["PROJCS", "GEOGCS", "COMPD_CS", "PROJCRS", "GEOGCRS", "COMPOUNDCRS", "GEODCRS", "BOUNDCRS"];
    let word = text.split(['[', '(']).next().unwrap_or_default().trim();
    word.len() < text.len() && ROOTS.iter().any(|root| word.eq_ignore_ascii_case(root))
}

/// Reads a horizontal system; of a compound one its horizontal part.
///
/// # Errors
/// A phrase that names what is not understood.
pub fn read(text: &str) -> Result<Wkt, String> {
    let mut parser = WktParser { rest: text };
    let root = parser.node(0)?;
    if root.is("COMPD_CS") || root.is("COMPOUNDCRS") {
        let part = root.nodes().find(|node| looks_like_wkt(&format!("{}[", node.keyword)));
        return horizontal(part.ok_or("a compound system without a horizontal part")?);
    }
    horizontal(&root)
}

fn horizontal(node: &WktNode) -> Result<Wkt, String> {
    if let Some(code) = node.epsg().filter(|&code| epsg_text(code).is_some()) {
        return Ok(Wkt::Epsg(code));
    }
    match node.keyword.to_ascii_uppercase().as_str() {
        "GEOGCS" => Ok(Wkt::Parameters(Box::new(geographic(node)?))),
        "PROJCS" => projected(node),
        other => Err(format!("{other} without an EPSG code that is in the table")),
    }
}

fn geographic(node: &WktNode) -> Result<Definition, String> {
    let datum_node = node.child("DATUM").ok_or("no DATUM")?;
    let unit = node.child("UNIT").and_then(|unit| unit.number(1)).unwrap_or(1f64.to_radians());
    if (unit - 1f64.to_radians()).abs() > 1e-9 {
        return Err(format!("an angular unit of {unit} radians; only degrees are read"));
    }
    let ellipsoid = datum_node
        .child("SPHEROID")
        .or_else(|| datum_node.child("ELLIPSOID"))
        .and_then(|node| Some(Ellipsoid { major_m: node.number(1)?, inverse_flattening: node.number(2)? }));
    let datum = datum(node, datum_node, ellipsoid);
    let meridian = node.child("PRIMEM").and_then(|node| node.number(1)).unwrap_or(0.0);
    Ok(Definition { prime_meridian_deg: meridian, ..Definition::geographic(node.name(), ellipsoid, datum) })
}

/// The datum by code, by shift, or by one of the names that leave no doubt.
fn datum(system: &WktNode, node: &WktNode, ellipsoid: Option<Ellipsoid>) -> Datum {
    if let Some(shift) = node.child("TOWGS84") {
        return Datum::ToWgs84(shift.values.iter().filter_map(WktValue::number).collect());
    }
    if let Some(code) = system.epsg().filter(|&code| epsg_text(code).is_some()) {
        return Datum::OfEpsg(code);
    }
    let name: String =
        node.name().chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase();
    let major = ellipsoid.map_or(0.0, |ellipsoid| ellipsoid.major_m);
    let known = match name.strip_prefix("d").filter(|_| node.name().starts_with("D_")).unwrap_or(&name) {
        "wgs1984" | "wgs84" | "worldgeodeticsystem1984" => Some((4326, 6_378_137.0)),
        "northamericandatum1983" | "northamerican1983" | "nad83" => Some((4269, 6_378_137.0)),
        "northamericandatum1927" | "northamerican1927" | "nad27" => Some((4267, 6_378_206.4)),
        "osgb1936" | "ordnancesurveyofgreatbritain1936" => Some((4277, 6_377_563.396)),
        _ => None,
    };
    known.filter(|(_, axis)| *axis == major).map_or(Datum::Unstated, |(code, _)| Datum::OfEpsg(code))
}

fn projected(node: &WktNode) -> Result<Wkt, String> {
    let base = geographic(node.child("GEOGCS").ok_or("no GEOGCS in the PROJCS")?)?;
    let projection = node.child("PROJECTION").ok_or("no PROJECTION in the PROJCS")?.name();
    let unit = node.child("UNIT").and_then(|unit| unit.number(1)).ok_or("no UNIT in the PROJCS")?;
    let at = |names: &[&str]| node.parameter(names);
    if projection.eq_ignore_ascii_case("Mercator_Auxiliary_Sphere") {
        return Ok(Wkt::Epsg(3857));
    }
    let definition = Definition {
        name: node.name(),
        method: method(&projection, at(&["standard_parallel_2"]).is_some())?,
        latitude_deg: at(&["latitude_of_origin", "latitude_of_center", "central_parallel"]).unwrap_or(0.0),
        longitude_deg: at(&["central_meridian", "longitude_of_center", "longitude_of_origin"]).unwrap_or(0.0),
        parallel_1_deg: at(&["standard_parallel_1"]),
        parallel_2_deg: at(&["standard_parallel_2"]),
        scale: at(&["scale_factor"]).unwrap_or(1.0),
        false_easting_m: at(&["false_easting"]).unwrap_or(0.0) * unit,
        false_northing_m: at(&["false_northing"]).unwrap_or(0.0) * unit,
        meters_per_unit: unit,
        ..base
    };
    let polar = definition.method == MapProjection::PolarStereographic;
    if !polar && node.children("AXIS").any(|axis| axis.points("SOUTH") || axis.points("WEST")) {
        return Err(format!("{projection} with axes to the south or west"));
    }
    Ok(Wkt::Parameters(Box::new(settle_parallels(definition))))
}

/// The spellings of the two standards meet here: a pole's latitude of origin is OGC's parallel of true scale,
/// and a conic with one parallel takes it from either parameter.
fn settle_parallels(mut definition: Definition) -> Definition {
    match definition.method {
        MapProjection::PolarStereographic
            if definition.parallel_1_deg.is_none() && definition.latitude_deg.abs() < 90.0 =>
        {
            definition.parallel_1_deg = Some(definition.latitude_deg);
        }
        // One parallel away from the origin is the conic with both parallels there.
        MapProjection::LambertConic1
            if definition.parallel_1_deg.is_some_and(|at| at != definition.latitude_deg) =>
        {
            definition.method = MapProjection::LambertConic2;
            definition.parallel_2_deg = definition.parallel_1_deg;
        }
        _ => {}
    }
    definition
}

fn method(name: &str, has_second_parallel: bool) -> Result<MapProjection, String> {
    Ok(match name.to_ascii_lowercase().as_str() {
        "transverse_mercator" | "gauss_kruger" => MapProjection::TransverseMercator,
        "mercator" | "mercator_1sp" | "mercator_2sp" => MapProjection::Mercator,
        "lambert_conformal_conic_1sp" => MapProjection::LambertConic1,
        "lambert_conformal_conic_2sp" => MapProjection::LambertConic2,
        "lambert_conformal_conic" if has_second_parallel => MapProjection::LambertConic2,
        "lambert_conformal_conic" => MapProjection::LambertConic1,
        "albers_conic_equal_area" | "albers" => MapProjection::Albers,
        "lambert_azimuthal_equal_area" => MapProjection::LambertAzimuthal,
        "polar_stereographic" | "stereographic_north_pole" | "stereographic_south_pole" => {
            MapProjection::PolarStereographic
        }
        _ => return Err(format!("the projection {name} is not one that is read from parameters")),
    })
}

/// `KEYWORD[value, …]`.
#[derive(Debug)]
struct WktNode {
    keyword: String,
    values: Vec<WktValue>,
}

#[derive(Debug)]
enum WktValue {
    Text(String),
    Number(f64),
    Node(WktNode),
}

impl WktValue {
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }
}

impl WktNode {
    fn is(&self, keyword: &str) -> bool {
        self.keyword.eq_ignore_ascii_case(keyword)
    }

    fn nodes(&self) -> impl Iterator<Item = &Self> {
        self.values.iter().filter_map(|value| match value {
            WktValue::Node(node) => Some(node),
            _ => None,
        })
    }

    fn children<'a>(&'a self, keyword: &'a str) -> impl Iterator<Item = &'a Self> {
        self.nodes().filter(move |node| node.is(keyword))
    }

    fn child(&self, keyword: &str) -> Option<&Self> {
        self.nodes().find(|node| node.is(keyword))
    }

    fn number(&self, index: usize) -> Option<f64> {
        self.values.get(index)?.number()
    }

    fn name(&self) -> String {
        match self.values.first() {
            Some(WktValue::Text(text)) => text.clone(),
            _ => "unnamed".into(),
        }
    }

    fn parameter(&self, names: &[&str]) -> Option<f64> {
        let named = |name: &str| {
            self.children("PARAMETER").find(|node| node.name().eq_ignore_ascii_case(name))?.number(1)
        };
        names.iter().find_map(|name| named(name))
    }

    fn epsg(&self) -> Option<u32> {
        let authority = self.child("AUTHORITY").or_else(|| self.child("ID"))?;
        if !authority.name().eq_ignore_ascii_case("EPSG") {
            return None;
        }
        match authority.values.get(1)? {
            WktValue::Text(code) => code.trim().parse().ok(),
            WktValue::Number(code) if code.fract() == 0.0 && (1.0..1e6).contains(code) => Some(*code as u32),
            _ => None,
        }
    }

    /// Whether this axis points the given way.
    fn points(&self, way: &str) -> bool {
        self.nodes().any(|node| node.is(way))
    }
}

struct WktParser<'a> {
    rest: &'a str,
}

impl WktParser<'_> {
    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn eat(&mut self, any: &[char]) -> bool {
        self.skip_blanks();
        match self.rest.strip_prefix(any) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    /// A keyword with its values; one without brackets, such as `EAST`, has none.
    fn node(&mut self, depth: usize) -> Result<WktNode, String> {
        if depth > DEEPEST {
            return Err("brackets nested deeper than any system needs".into());
        }
        self.skip_blanks();
        let end = self.rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(self.rest.len());
        let (keyword, rest) = self.rest.split_at(end);
        let mut node = WktNode { keyword: keyword.into(), values: Vec::new() };
        if keyword.is_empty() {
            return Err(format!(
                "a keyword is missing before '{}'",
                rest.chars().take(12).collect::<String>()
            ));
        }
        self.rest = rest;
        if self.eat(&['[', '(']) {
            loop {
                let value = self.value(depth)?;
                node.values.push(value);
                if self.eat(&[']', ')']) {
                    break;
                }
                if !self.eat(&[',']) {
                    return Err("a bracket is not closed".into());
                }
            }
        }
        Ok(node)
    }

    fn value(&mut self, depth: usize) -> Result<WktValue, String> {
        self.skip_blanks();
        if let Some(rest) = self.rest.strip_prefix('"') {
            let (text, rest) = rest.split_once('"').ok_or("a quotation mark is not closed")?;
            self.rest = rest;
            return Ok(WktValue::Text(text.into()));
        }
        if self.rest.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
            let end = self.rest.find(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c)));
            let (number, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest;
            return number.parse().map(WktValue::Number).map_err(|_| format!("'{number}' is not a number"));
        }
        self.node(depth + 1).map(WktValue::Node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::crs::Crs;

    const UTM_12: &str = r#"PROJCS["WGS_1984_UTM_Zone_12N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",
        SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],
        PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],
        PARAMETER["Central_Meridian",-111.0],PARAMETER["Scale_Factor",0.9996],
        PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]"#;

    #[test]
    fn esri_text_of_a_utm_zone_is_the_epsg_system() {
        assert_eq!(Crs::parse(UTM_12).expect("plain WKT").epsg(), Some(32612));
    }

    #[test]
    fn british_text_is_the_national_grid() {
        let text = r#"PROJCS["OSGB_1936_British_National_Grid",GEOGCS["GCS_OSGB 1936",DATUM["D_OSGB_1936",
            SPHEROID["Airy_1830",6377563.396,299.3249646]],PRIMEM["Greenwich",0],UNIT["Degree",0.017453292519943295]],
            PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",49],PARAMETER["central_meridian",-2],
            PARAMETER["scale_factor",0.9996012717],PARAMETER["false_easting",400000],
            PARAMETER["false_northing",-100000],UNIT["Meter",1]]"#;
        assert_eq!(Crs::parse(text).expect("plain WKT").epsg(), Some(27700));
    }

    #[test]
    fn a_conic_in_feet_is_read_by_its_parameters() {
        let text = UTM_12
            .replace("Transverse_Mercator", "Lambert_Conformal_Conic")
            .replace(
                r#""Scale_Factor",0.9996"#,
                r#""Standard_Parallel_1",36.0],PARAMETER["Standard_Parallel_2",34.5"#,
            )
            .replace(r#"UNIT["Meter",1.0]"#, r#"UNIT["Foot_US",0.3048006096012192]"#);
        let crs = Crs::parse(&text).expect("plain WKT");
        assert_eq!(crs.epsg(), None);
        assert_eq!(crs.meters_per_unit(), 0.304_800_609_601_219_2);
        assert!(crs.name().contains("+lat_1=36 +lat_2=34.5"), "{}", crs.name());
        assert!(crs.name().contains("+x_0=152400.3048"), "{}", crs.name());
    }

    #[test]
    fn a_code_at_the_root_wins_and_compound_text_gives_its_horizontal_part() {
        let coded =
            UTM_12.replace(r#"UNIT["Meter",1.0]]"#, r#"UNIT["Meter",1.0],AUTHORITY["EPSG","32612"]]"#);
        assert_eq!(read(&coded), Ok(Wkt::Epsg(32612)));
        let compound = format!(r#"COMPD_CS["both",{coded},VERT_CS["sea level",UNIT["metre",1]]]"#);
        assert_eq!(read(&compound), Ok(Wkt::Epsg(32612)));
    }

    #[test]
    fn what_is_not_read_is_refused_by_name() {
        let odd = UTM_12.replace("Transverse_Mercator", "Krovak");
        assert!(read(&odd).expect_err("no Krovak").contains("Krovak"));
        assert!(read(&"PROJCS[".repeat(500)).is_err());
        for end in 0..UTM_12.len() {
            let _ = read(&UTM_12[..end]);
        }
    }
}
