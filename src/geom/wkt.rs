//! Reads well-known text, version 1 (OGC 01-009), as `.prj` files hold it, in OGC's and in Esri's spelling.
//!
//! The text is a tree of `KEYWORD[value, value, …]`. A root with an EPSG authority gives its code; any other gives its
//! parameters, where [`Definition`] can express the projection. Of WKT 2 only the root's `ID["EPSG", n]` is read.
//!
//! The crate `proj4wkt` does not serve: its result has no datum name, so NAD27 passes for a bare ellipsoid and no system
//! is traced to its code; it drops the code of a WKT 2 root, and its parser has no limit of nesting.

use crate::crs::epsg_text;
use crate::projection::{Datum, Definition, Ellipsoid, MapProjection};

/// The deepest nesting that is read; real text stays below 6.
const MAX_DEPTH: usize = 16;

/// The system that a text describes.
#[derive(Clone, Debug, PartialEq)]
pub enum WktSystem {
    /// The code of its root.
    Epsg(u32),
    /// Its parameters, where the root has no known code.
    Parameters(Box<Definition>),
}

/// Why a text was not read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WktError {
    /// Brackets are nested deeper than in any real text.
    #[error("brackets nested deeper than any system needs")]
    Depth,
    /// A value has no keyword.
    #[error("a keyword is missing before '{0}'")]
    NoKeyword(String),
    /// A bracket or a quotation mark is not closed.
    #[error("a {0} is not closed")]
    Unclosed(&'static str),
    /// A number is malformed.
    #[error("'{0}' is not a number")]
    NotANumber(String),
    /// A node that every system has is not there.
    #[error("no {0}")]
    NoNode(&'static str),
    /// A compound system has no horizontal part.
    #[error("a compound system without a horizontal part")]
    NoHorizontalPart,
    /// The root is read by its EPSG code only, and has no known one.
    #[error("{0} without an EPSG code that is in the table")]
    NoCode(String),
    /// Angles are not in degrees.
    #[error("an angular unit of {0} radians; only degrees are read")]
    AngularUnit(f64),
    /// Coordinates count southward or westward.
    #[error("{0} with axes to the south or west")]
    Axes(String),
    /// The projection is not one of [`MapProjection`].
    #[error("the projection {0} is not one that is read from parameters")]
    Projection(String),
}

/// Whether a text starts as the WKT of a horizontal or compound system does.
pub fn is_wkt(text: &str) -> bool {
    text.split_once(['[', '(']).is_some_and(|(keyword, _)| is_root(keyword.trim()))
}

fn is_root(keyword: &str) -> bool {
    const ROOTS: [&str; 8] =
        ["PROJCS", "GEOGCS", "COMPD_CS", "PROJCRS", "GEOGCRS", "COMPOUNDCRS", "GEODCRS", "BOUNDCRS"];
    ROOTS.iter().any(|root| keyword.eq_ignore_ascii_case(root))
}

/// Reads a horizontal system; of a compound one its horizontal part.
///
/// # Errors
/// [`WktError`].
pub fn read(text: &str) -> Result<WktSystem, WktError> {
    let root = WktParser { rest: text }.node(0)?;
    if root.is("COMPD_CS") || root.is("COMPOUNDCRS") {
        let part = root.nodes().find(|node| is_root(&node.keyword));
        return horizontal(part.ok_or(WktError::NoHorizontalPart)?);
    }
    horizontal(&root)
}

fn horizontal(node: &WktNode) -> Result<WktSystem, WktError> {
    if let Some(code) = node.epsg() {
        return Ok(WktSystem::Epsg(code));
    }
    match node.keyword.to_ascii_uppercase() {
        keyword if keyword == "GEOGCS" => Ok(WktSystem::Parameters(Box::new(geographic(node)?))),
        keyword if keyword == "PROJCS" => projected(node),
        other => Err(WktError::NoCode(other)),
    }
}

fn geographic(node: &WktNode) -> Result<Definition, WktError> {
    let datum_node = node.child("DATUM").ok_or(WktError::NoNode("DATUM"))?;
    let unit = node.child("UNIT").and_then(|unit| unit.number(1)).unwrap_or(1f64.to_radians());
    if (unit - 1f64.to_radians()).abs() > 1e-9 {
        return Err(WktError::AngularUnit(unit));
    }
    let ellipsoid = datum_node
        .child("SPHEROID")
        .or_else(|| datum_node.child("ELLIPSOID"))
        .and_then(|node| Some(Ellipsoid { major_m: node.number(1)?, inverse_flattening: node.number(2)? }));
    let datum = datum(node, datum_node, ellipsoid);
    let prime_meridian_deg = node.child("PRIMEM").and_then(|node| node.number(1)).unwrap_or(0.0);
    Ok(Definition { prime_meridian_deg, ..Definition::geographic(node.name().into(), ellipsoid, datum) })
}

/// The datum by shift, by code, or by one of the names that leave no doubt.
fn datum(system: &WktNode, node: &WktNode, ellipsoid: Option<Ellipsoid>) -> Datum {
    if let Some(shift) = node.child("TOWGS84") {
        return Datum::ToWgs84(shift.values.iter().filter_map(WktValue::number).collect());
    }
    if let Some(code) = system.epsg() {
        return Datum::OfEpsg(code);
    }
    let name: String = node.name().chars().filter(char::is_ascii_alphanumeric).collect();
    let name = name.to_ascii_lowercase();
    let known = match name.strip_prefix("d").filter(|_| node.name().starts_with("D_")).unwrap_or(&name) {
        "wgs1984" | "wgs84" | "worldgeodeticsystem1984" => Some((4326, 6_378_137.0)),
        "northamericandatum1983" | "northamerican1983" | "nad83" => Some((4269, 6_378_137.0)),
        "northamericandatum1927" | "northamerican1927" | "nad27" => Some((4267, 6_378_206.4)),
        "osgb1936" | "ordnancesurveyofgreatbritain1936" => Some((4277, 6_377_563.396)),
        _ => None,
    };
    let major_m = ellipsoid.map_or(0.0, |ellipsoid| ellipsoid.major_m);
    known.filter(|(_, axis_m)| *axis_m == major_m).map_or(Datum::Unstated, |(code, _)| Datum::OfEpsg(code))
}

fn projected(node: &WktNode) -> Result<WktSystem, WktError> {
    let base = geographic(node.child("GEOGCS").ok_or(WktError::NoNode("GEOGCS in the PROJCS"))?)?;
    let projection = node.child("PROJECTION").ok_or(WktError::NoNode("PROJECTION in the PROJCS"))?.name();
    let unit = node.child("UNIT").and_then(|unit| unit.number(1));
    let unit = unit.ok_or(WktError::NoNode("UNIT in the PROJCS"))?;
    let at = |names: &[&str]| node.parameter(names);
    if projection.eq_ignore_ascii_case("Mercator_Auxiliary_Sphere") {
        return Ok(WktSystem::Epsg(3857));
    }
    let mut definition = Definition {
        name: node.name().into(),
        method: method(projection, at(&["standard_parallel_2"]).is_some())?,
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
    let is_polar = definition.method == MapProjection::PolarStereographic;
    let is_reversed = |axis: &WktNode| axis.child("SOUTH").or_else(|| axis.child("WEST")).is_some();
    if !is_polar && node.nodes().any(|node| node.is("AXIS") && is_reversed(node)) {
        return Err(WktError::Axes(projection.into()));
    }
    settle_parallels(&mut definition);
    Ok(WktSystem::Parameters(Box::new(definition)))
}

/// Reconciles the spellings of the two standards: OGC states a pole's parallel of true scale as its latitude of origin,
/// and a conic with one parallel may state it as either parameter.
fn settle_parallels(definition: &mut Definition) {
    let Definition { method, latitude_deg, parallel_1_deg, .. } = *definition;
    match (method, parallel_1_deg) {
        (MapProjection::PolarStereographic, None) if latitude_deg.abs() < 90.0 => {
            definition.parallel_1_deg = Some(latitude_deg);
        }
        // One parallel away from the origin is the conic with both parallels there.
        (MapProjection::LambertConic1, Some(parallel_deg)) if parallel_deg != latitude_deg => {
            definition.method = MapProjection::LambertConic2;
            definition.parallel_2_deg = parallel_1_deg;
        }
        _ => {}
    }
}

fn method(name: &str, has_second_parallel: bool) -> Result<MapProjection, WktError> {
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
        _ => return Err(WktError::Projection(name.into())),
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
        if let Self::Number(number) = self { Some(*number) } else { None }
    }
}

impl WktNode {
    fn is(&self, keyword: &str) -> bool {
        self.keyword.eq_ignore_ascii_case(keyword)
    }

    fn nodes(&self) -> impl Iterator<Item = &Self> {
        self.values
            .iter()
            .filter_map(|value| if let WktValue::Node(node) = value { Some(node) } else { None })
    }

    fn child(&self, keyword: &str) -> Option<&Self> {
        self.nodes().find(|node| node.is(keyword))
    }

    fn number(&self, index: usize) -> Option<f64> {
        self.values.get(index)?.number()
    }

    fn name(&self) -> &str {
        if let Some(WktValue::Text(text)) = self.values.first() { text } else { "unnamed" }
    }

    fn parameter(&self, names: &[&str]) -> Option<f64> {
        let named = |name: &&str| {
            let is_named = |node: &&Self| node.is("PARAMETER") && node.name().eq_ignore_ascii_case(name);
            self.nodes().find(is_named)?.number(1)
        };
        names.iter().find_map(named)
    }

    /// The EPSG code of its authority, where the table has it.
    fn epsg(&self) -> Option<u32> {
        let authority = self.child("AUTHORITY").or_else(|| self.child("ID"))?;
        let code = match authority.values.get(1)? {
            WktValue::Text(code) => code.trim().parse().ok()?,
            WktValue::Number(code) if code.fract() == 0.0 && (1.0..1e6).contains(code) => *code as u32,
            _ => return None,
        };
        (authority.name().eq_ignore_ascii_case("EPSG") && epsg_text(code).is_some()).then_some(code)
    }
}

struct WktParser<'a> {
    rest: &'a str,
}

impl<'a> WktParser<'a> {
    /// Skips blanks and one of `marks`; returns whether there was one.
    fn skip(&mut self, marks: [char; 2]) -> bool {
        self.rest = self.rest.trim_start();
        let after = self.rest.strip_prefix(marks);
        self.rest = after.unwrap_or(self.rest);
        after.is_some()
    }

    /// Takes the characters that `is_taken` accepts.
    fn take(&mut self, is_taken: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c: char| !is_taken(c)).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        taken
    }

    /// A keyword with its values; one without brackets, such as `EAST`, has none.
    fn node(&mut self, depth: usize) -> Result<WktNode, WktError> {
        if depth > MAX_DEPTH {
            return Err(WktError::Depth);
        }
        self.rest = self.rest.trim_start();
        let keyword = self.take(|c| c.is_ascii_alphanumeric() || c == '_');
        if keyword.is_empty() {
            return Err(WktError::NoKeyword(self.rest.chars().take(12).collect()));
        }
        let mut node = WktNode { keyword: keyword.into(), values: Vec::new() };
        if self.skip(['[', '(']) {
            loop {
                node.values.push(self.value(depth)?);
                if self.skip([']', ')']) {
                    break;
                }
                if !self.skip([',', ',']) {
                    return Err(WktError::Unclosed("bracket"));
                }
            }
        }
        Ok(node)
    }

    fn value(&mut self, depth: usize) -> Result<WktValue, WktError> {
        self.rest = self.rest.trim_start();
        if let Some(rest) = self.rest.strip_prefix('"') {
            let (text, rest) = rest.split_once('"').ok_or(WktError::Unclosed("quotation mark"))?;
            self.rest = rest;
            return Ok(WktValue::Text(text.into()));
        }
        if self.rest.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
            let number = self.take(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
            return number.parse().map(WktValue::Number).map_err(|_| WktError::NotANumber(number.into()));
        }
        self.node(depth + 1).map(WktValue::Node)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;

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
        assert_eq!(read(&coded), Ok(WktSystem::Epsg(32612)));
        let compound = format!(r#"COMPD_CS["both",{coded},VERT_CS["sea level",UNIT["metre",1]]]"#);
        assert_eq!(read(&compound), Ok(WktSystem::Epsg(32612)));
    }

    #[test]
    fn what_is_not_read_is_refused_by_name() {
        let odd = UTM_12.replace("Transverse_Mercator", "Krovak");
        assert!(read(&odd).expect_err("no Krovak").to_string().contains("Krovak"));
        assert!(read(&"PROJCS[".repeat(500)).is_err());
        for end in 0..UTM_12.len() {
            let _ = read(&UTM_12[..end]);
        }
    }
}
