//! The place and the coordinate system of an Erdas Imagine layer.
//!
//! ```text
//! Map_Info     projection:text │ center of the first sample │ of the last │ cell │ units:text
//! Projection   way:u16 │ number:i32 │ texts │ zone:i32 │ 15 numbers │ spheroid: name, a, b …
//!  └── Datum   name:text │ way:u16 │ 7 numbers of a shift to WGS 84 │ text
//! ProjectionX  among other things a text in Esri's WKT
//! ```
//!
//! Latitude and longitude and UTM on well-known datums are known by their EPSG code; any other system is that of the WKT, or
//! else that of the numbers, of which angles are in radians.

use glam::DVec2;

use sandtable_geom::crs::Crs;
use sandtable_geom::projection::utm_code;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;

use crate::formats::hfa::tree::{HfaFields, HfaNode, HfaTree};

/// Degrees in the units of a file that are seconds.
const DEGREES_PER_SECOND: f64 = 1.0 / 3600.0;

/// Numbers of a projection.
const PARAMETERS: usize = 15;

/// The datums with an EPSG code of their latitudes and longitudes, and their names in PROJ.
const DATUMS: [(&str, u32, &str); 4] = [
    ("WGS 84", 4326, "+datum=WGS84"),
    ("WGS 72", 4322, "+ellps=WGS72 +towgs84=0,0,4.5,0,0,0.554,0.2263"),
    ("NAD83", 4269, "+datum=NAD83"),
    ("NAD27", 4267, "+datum=NAD27"),
];

/// Where a layer lies.
pub(super) struct HfaPlace {
    /// The center of the first sample.
    pub first: DVec2,
    pub cell: DVec2,
    /// Whether rows follow each other southward.
    pub runs_south: bool,
    units: String,
}

/// A projection by its number.
struct HfaProjection {
    number: u32,
    name: String,
    zone: i32,
    parameters: [f64; PARAMETERS],
    semi_axes: (f64, f64),
}

/// A datum by its name, and the numbers that shift it to WGS 84.
struct HfaDatum {
    name: String,
    shift: Vec<f64>,
}

impl HfaPlace {
    /// `None` where the layer has none.
    pub fn read(tree: &HfaTree<impl FileContent>, layer: &HfaNode) -> Result<Option<Self>, DemErrorKind> {
        let Some(node) = tree.child(layer, |node| node.kind == "Eprj_MapInfo")? else { return Ok(None) };
        let mut fields = tree.fields(&node)?;
        let _projection = fields.text()?;
        let [first, last, cell] = [pair(&mut fields)?, pair(&mut fields)?, pair(&mut fields)?];
        let units = fields.text().unwrap_or_default();
        let factor = if units.eq_ignore_ascii_case("ds") { DEGREES_PER_SECOND } else { 1.0 };
        let place = Self { first: first * factor, cell: cell * factor, runs_south: first.y >= last.y, units };
        if place.first.is_finite() && place.cell.is_finite() && place.cell.min_element() > 0.0 {
            return Ok(Some(place));
        }
        Err(DemErrorKind::Georeference {
            reason: format!("its first sample lies at {} and its cells are {}", place.first, place.cell),
            remedy: "write it again, or place it with a world file (.igw) in a GeoTIFF",
        })
    }
}

/// Takes a pointer to two numbers.
fn pair(fields: &mut HfaFields) -> Result<DVec2, DemErrorKind> {
    fields.pointer()?;
    Ok(DVec2::new(fields.f64()?, fields.f64()?))
}

/// The coordinate system of a layer; `None` where it names none.
pub(super) fn crs(
    tree: &HfaTree<impl FileContent>,
    layer: &HfaNode,
    place: Option<&HfaPlace>,
) -> Result<Option<Crs>, DemErrorKind> {
    let wkt = match tree.child(layer, |node| node.name == "ProjectionX")? {
        Some(node) => wkt(tree.fields(&node)?.rest()),
        None => None,
    };
    let Some(node) = tree.child(layer, |node| node.kind == "Eprj_ProParameters")? else {
        return Ok(wkt.map(|wkt| Crs::parse(&wkt)).transpose()?);
    };
    let projection = HfaProjection::read(&mut tree.fields(&node)?)?;
    let datum = match tree.child(&node, |node| node.kind == "Eprj_Datum")? {
        Some(node) => HfaDatum::read(&mut tree.fields(&node)?)?,
        None => HfaDatum { name: String::new(), shift: Vec::new() },
    };
    let is_metric = place.is_none_or(|place| matches!(&*place.units, "" | "meters" | "dd" | "ds"));
    if let Some(code) = projection.code(&datum).filter(|_| is_metric) {
        return Ok(Some(Crs::from_epsg(code)?));
    }
    let parsed = wkt.map(|wkt| Crs::parse(&wkt));
    if let Some(Ok(crs)) = parsed {
        return Ok(Some(crs));
    }
    match (projection.proj_text(&datum).filter(|_| is_metric), parsed) {
        (Some(text), _) => Ok(Some(Crs::parse(&text)?)),
        (None, Some(Err(error))) => Err(error.into()),
        (None, _) => Err(DemErrorKind::Georeference {
            reason: format!(
                "projection {} of Erdas Imagine ('{}') on '{}' in '{}' is not known",
                projection.number,
                projection.name,
                datum.name,
                place.map_or("", |place| &place.units)
            ),
            remedy: "state the right system as crs under [terrain]",
        }),
    }
}

/// The text in WKT among bytes.
fn wkt(bytes: &[u8]) -> Option<String> {
    const STARTS: [&[u8]; 2] = [b"PROJCS[", b"GEOGCS["];
    let start = (0..bytes.len()).find(|&at| STARTS.iter().any(|start| bytes[at..].starts_with(start)))?;
    let text = bytes[start..].split(|byte| *byte == 0).next()?;
    Some(String::from_utf8_lossy(text).into_owned())
}

impl HfaDatum {
    fn read(fields: &mut HfaFields) -> Result<Self, DemErrorKind> {
        let name = fields.text()?;
        let way = fields.u16()?;
        let shift = if way == 0 { fields.numbers(7).unwrap_or_default() } else { Vec::new() };
        Ok(Self { name, shift })
    }

    fn known(&self) -> Option<(u32, &'static str)> {
        let known = DATUMS.iter().find(|(name, ..)| name.eq_ignore_ascii_case(&self.name))?;
        Some((known.1, known.2))
    }
}

impl HfaProjection {
    fn read(fields: &mut HfaFields) -> Result<Self, DemErrorKind> {
        let (_way, number) = (fields.u16()?, fields.u32()?);
        let (_program, name) = (fields.text()?, fields.text()?);
        let zone = fields.u32()? as i32;
        let mut parameters = [0.0; PARAMETERS];
        for (to, from) in parameters.iter_mut().zip(fields.numbers(PARAMETERS)?) {
            *to = from;
        }
        let mut spheroid = || -> Result<_, DemErrorKind> {
            fields.pointer()?;
            let _name = fields.text()?;
            Ok((fields.f64()?, fields.f64()?))
        };
        let semi_axes = spheroid().unwrap_or((0.0, 0.0));
        Ok(Self { number, name, zone, parameters, semi_axes })
    }

    /// The EPSG code of latitudes and longitudes, and of UTM, on a well-known datum.
    fn code(&self, datum: &HfaDatum) -> Option<u32> {
        let (geographic, _) = datum.known()?;
        let zone = i64::from(self.zone);
        match self.number {
            0 => Some(geographic),
            1 => utm_code(geographic, if self.parameters[3] < 0.0 { -zone } else { zone }),
            _ => None,
        }
    }

    /// The projection in PROJ's words; `None` where it has none here.
    fn proj_text(&self, datum: &HfaDatum) -> Option<String> {
        let number = |at: usize| self.parameters[at];
        let degrees = |at: usize| number(at).to_degrees();
        let origin = || format!("+lon_0={} +lat_0={}", degrees(4), degrees(5));
        let parallels = || format!("+lat_1={} +lat_2={}", degrees(2), degrees(3));
        let projection = match self.number {
            0 => "longlat".into(),
            1 => {
                let south = if number(3) < 0.0 { " +south" } else { "" };
                format!("utm +zone={}{south}", self.zone)
            }
            3 => format!("aea {} {}", parallels(), origin()),
            4 => format!("lcc {} {}", parallels(), origin()),
            5 => format!("merc +lon_0={} +lat_ts={}", degrees(4), degrees(5)),
            6 => {
                let pole = if degrees(5) < 0.0 { -90 } else { 90 };
                format!("stere +lat_0={pole} +lon_0={} +lat_ts={}", degrees(4), degrees(5))
            }
            9 => format!("tmerc +k={} {}", number(2), origin()),
            11 => format!("laea {}", origin()),
            _ => return None,
        };
        let false_origin = if self.number > 1 {
            format!(" +x_0={} +y_0={} +units=m", number(6), number(7))
        } else {
            String::new()
        };
        let figure = match datum.known() {
            Some((_, words)) => words.to_owned(),
            None => {
                let (a, b) = self.semi_axes;
                if !(a.is_finite() && b.is_finite() && a > 0.0 && b > 0.0) {
                    return None;
                }
                let shift: Vec<String> = datum.shift.iter().take(3).map(f64::to_string).collect();
                let turns = datum.shift.iter().skip(3).any(|number| *number != 0.0);
                if shift.len() < 3 || turns {
                    return None;
                }
                format!("+a={a} +b={b} +towgs84={}", shift.join(","))
            }
        };
        Some(format!("+proj={projection}{false_origin} {figure}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection(number: u32, zone: i32, parameters: &[f64]) -> HfaProjection {
        let mut all = [0.0; PARAMETERS];
        all[..parameters.len()].copy_from_slice(parameters);
        HfaProjection {
            number,
            name: String::new(),
            zone,
            parameters: all,
            semi_axes: (6_378_388.0, 6_356_911.9),
        }
    }

    fn datum(name: &str, shift: &[f64]) -> HfaDatum {
        HfaDatum { name: name.into(), shift: shift.to_vec() }
    }

    #[test]
    fn degrees_and_utm_on_well_known_datums_have_a_code() {
        assert_eq!(projection(0, 0, &[]).code(&datum("NAD83", &[])), Some(4269));
        assert_eq!(projection(1, 12, &[0.0, 0.0, 0.0, 1.0]).code(&datum("WGS 84", &[])), Some(32612));
        assert_eq!(projection(1, 33, &[0.0, 0.0, 0.0, -1.0]).code(&datum("WGS 84", &[])), Some(32733));
        assert_eq!(projection(1, 12, &[]).code(&datum("Potsdam", &[])), None);
    }

    #[test]
    fn other_systems_are_those_of_their_numbers() {
        let albers = projection(3, 0, &[0.0, 0.0, 0.5, 0.75, -1.5, 0.4, 100.0, 200.0]);
        let text = albers.proj_text(&datum("NAD83", &[])).expect("known");
        assert!(text.starts_with("+proj=aea +lat_1=28.64"), "{text}");
        assert!(text.ends_with(" +x_0=100 +y_0=200 +units=m +datum=NAD83"), "{text}");
        let crs = Crs::parse(&text).expect("sound");
        assert!(crs.is_metric());
        let utm = projection(1, 32, &[])
            .proj_text(&datum("European 1950", &[-87.0, -98.0, -121.0, 0.0]))
            .expect("known");
        assert_eq!(utm, "+proj=utm +zone=32 +a=6378388 +b=6356911.9 +towgs84=-87,-98,-121");
        assert!(Crs::parse(&utm).is_ok());
        assert_eq!(
            projection(2, 4400, &[]).proj_text(&datum("NAD83", &[])),
            None,
            "state planes have numbers of their own"
        );
        assert_eq!(
            projection(0, 0, &[]).proj_text(&datum("a", &[1.0, 2.0, 3.0, 0.1])),
            None,
            "turns differ in sign"
        );
    }

    #[test]
    fn the_text_of_esri_is_found_among_other_bytes() {
        assert_eq!(wkt(b"\x01\0\0PE_COORDSYS\0GEOGCS[\"a\"]\0rest").as_deref(), Some("GEOGCS[\"a\"]"));
        assert_eq!(wkt(b"PROJCS"), None);
    }
}
