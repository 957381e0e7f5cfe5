//! Coordinate reference systems and transforms between them: the one door to `proj4rs`.
//!
//! A system is made from an EPSG code, a proj string, WKT 1 text (a `.prj` file) or the parameters of a
//! projection. What is not understood is refused, never approximated; that holds for datums too: a system on
//! a datum whose shift to WGS 84 is unknown, or needs a grid file (NAD27), can be named and measured in, and
//! transforms to systems on the same datum, but not to others.
//!
//! Exactness, held against PROJ by `tests/dem_oracle.rs`: UTM, Lambert, Albers and azimuthal systems agree to
//! better than 0.1 mm. A seven-parameter datum shift is only as good as its parameters: EPSG:27700 agrees
//! with PROJ's own seven-parameter shift to about 3 mm, which itself is good to some meters (the grid
//! OSTN15 is not used).

use std::sync::Arc;

use glam::DVec2;

use crate::geom::datum_shift::DatumShift;
use crate::geom::proj_words;
use crate::geom::projection::{Definition, Ellipsoid};
use crate::geom::wkt;

/// The longest text that is looked at: real WKT is a tenth of it.
const LONGEST_TEXT: usize = 65_536;

/// A horizontal coordinate reference system; cheap to clone.
///
/// Coordinates are (easting, northing) in the system's own linear unit, or (longitude, latitude) in degrees
/// for a geographic one, whatever axis order its registry entry states.
#[derive(Clone, Debug)]
pub struct Crs {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    name: String,
    epsg: Option<u32>,
    /// The proj string that it was made from; empty where it has no place on Earth.
    text: String,
    proj: proj4rs::Proj,
    datum: DatumTie,
}

/// What is known of the way from a system's datum to WGS 84.
#[derive(Clone, Debug, PartialEq)]
enum DatumTie {
    /// A shift is stated, or none is needed.
    Tied,
    /// No shift can be had; the words that name the datum.
    Adrift(String),
}

/// Why a coordinate reference system or a transform cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CrsError {
    /// The text is neither `EPSG:n` nor a proj string that is understood.
    #[error(
        "'{text}' is not a coordinate reference system that is understood ({reason}); write EPSG:n, for example EPSG:32616, or a proj string"
    )]
    Unknown {
        /// What was given.
        text: String,
        /// What was wrong with it.
        reason: String,
    },
    /// The two systems stand on different datums and the shift between them is not known.
    #[error(
        "{from} cannot be brought to {to}: the shift from the datum '{datum}' to WGS 84 needs a grid file or was not stated; convert the data with another program first, or give the system as a proj string with +towgs84"
    )]
    Datum {
        /// Source system.
        from: String,
        /// Target system.
        to: String,
        /// The datum that is not tied to WGS 84.
        datum: String,
    },
    /// A coordinate cannot be brought from one system to the other.
    #[error("({x}, {y}) cannot be brought from {from} to {to}: {reason}")]
    Transform {
        /// Source system.
        from: String,
        /// Target system.
        to: String,
        /// Easting or longitude.
        x: f64,
        /// Northing or latitude.
        y: f64,
        /// What the projection said.
        reason: String,
    },
}

impl Crs {
    /// The system with an EPSG code.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where the code is not in the table.
    pub fn from_epsg(code: u32) -> Result<Self, CrsError> {
        let name = format!("EPSG:{code}");
        let text = epsg_text(code).ok_or_else(|| unknown(&name, "no such code in the EPSG table"))?;
        Self::build(name.clone(), Some(code), text)
    }

    /// The system with an EPSG code, but with coordinates in another linear unit, as some files state it.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where the code is not in the table or the unit is not a positive length.
    pub fn from_epsg_in(code: u32, meters_per_unit: f64) -> Result<Self, CrsError> {
        let plain = Self::from_epsg(code)?;
        let own = plain.meters_per_unit();
        // The registry's feet are written with twelve digits or so.
        if plain.is_geographic() || (own - meters_per_unit).abs() <= 1e-10 * own {
            return Ok(plain);
        }
        let name = format!("EPSG:{code} +to_meter={meters_per_unit}");
        if !(meters_per_unit.is_finite() && meters_per_unit > 0.0) {
            return Err(unknown(&name, "the unit is not a positive length"));
        }
        let table = epsg_text(code).unwrap_or_default();
        let kept = table.split_whitespace().filter(|word| {
            !word.starts_with("+units=") && !word.starts_with("+to_meter=") && *word != "+no_defs"
        });
        let text = kept.collect::<Vec<_>>().join(" ") + &format!(" +to_meter={meters_per_unit}");
        Self::build(name, None, &text)
    }

    /// The system with given parameters; where these are those of a well-known EPSG code, that one.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where the parameters are out of range.
    pub fn from_definition(definition: &Definition) -> Result<Self, CrsError> {
        match definition.epsg_twin() {
            Some(code) => Self::from_epsg(code),
            None => {
                let text = definition.proj_text().map_err(|reason| unknown(&definition.name, &reason))?;
                Self::build(text.clone(), None, &text)
            }
        }
    }

    /// The system that `text` names: `EPSG:n` in any case, a proj string such as `+proj=utm +zone=16`, or
    /// WKT 1 as `.prj` files hold it. Both [`Crs::name`]s of this module can be read back.
    ///
    /// # Errors
    /// [`CrsError::Unknown`].
    pub fn parse(text: &str) -> Result<Self, CrsError> {
        let trimmed =
            text.trim_start_matches('\u{feff}').trim_matches(|c: char| c.is_whitespace() || c == '\0');
        if trimmed.len() > LONGEST_TEXT {
            return Err(unknown(&shortened(trimmed), "longer than any description of a system"));
        }
        match trimmed.split_once(':') {
            Some((authority, rest)) if authority.eq_ignore_ascii_case("epsg") => parse_epsg(trimmed, rest),
            _ if wkt::looks_like_wkt(trimmed) => {
                match wkt::read(trimmed).map_err(|reason| unknown(&shortened(trimmed), &reason))? {
                    wkt::Wkt::Epsg(code) => Self::from_epsg(code),
                    wkt::Wkt::Parameters(definition) => Self::from_definition(&definition),
                }
            }
            _ if trimmed.contains("+proj") => Self::build(trimmed.into(), None, trimmed),
            _ => Err(unknown(&shortened(trimmed), "no authority, no +proj and no WKT in it")),
        }
    }

    /// Makes the system that a proj string describes.
    fn build(name: String, epsg: Option<u32>, text: &str) -> Result<Self, CrsError> {
        let refused = |reason: &str| unknown(&shortened(&name), reason);
        if !text.is_ascii() {
            return Err(refused("a proj string is plain ASCII"));
        }
        let stated = text.to_owned();
        let (text, datum) = settle_datum(text);
        let proj = proj4rs::Proj::from_proj_string(&text).map_err(|error| refused(&error.to_string()))?;
        if proj.is_geocent() {
            return Err(refused("geocentric coordinates are not horizontal ones"));
        }
        let scale = proj.to_meter();
        if !(scale.is_finite() && scale > 0.0 && proj.ellipse_parameters().0.is_finite()) {
            return Err(refused("its unit or its ellipsoid is not a positive length"));
        }
        let datum = match datum {
            DatumTie::Adrift(words) if !is_like_wgs84(proj.ellipse_parameters()) => DatumTie::Adrift(words),
            DatumTie::Adrift(_) => return Self::build(name, epsg, &format!("{text} +towgs84=0,0,0")),
            DatumTie::Tied => DatumTie::Tied,
        };
        Ok(Self { inner: Arc::new(Inner { name, epsg, text: stated, proj, datum }) })
    }

    /// WGS 84 longitude and latitude, EPSG:4326.
    pub fn wgs84() -> Self {
        Self::from_epsg(4326).expect("EPSG:4326 is in the table")
    }

    /// A plane in meters with no known place on Earth: what a raster without a system lies in. Nothing can be
    /// transformed to or from it.
    pub fn local() -> Self {
        let proj = Self::utm_at(0.0, 0.0).inner.proj.clone();
        let datum = DatumTie::Adrift("no place on Earth".into());
        Self {
            inner: Arc::new(Inner {
                name: "local meters".into(),
                epsg: None,
                text: String::new(),
                proj,
                datum,
            }),
        }
    }

    /// The UTM zone on WGS 84 that holds a longitude and latitude in degrees (the plain six-degree zones).
    pub fn utm_at(longitude: f64, latitude: f64) -> Self {
        let zone = (((longitude + 180.0).rem_euclid(360.0)) / 6.0).floor().min(59.0) as u32 + 1;
        let base = if latitude < 0.0 { 32700 } else { 32600 };
        Self::from_epsg(base + zone).expect("all UTM zones are in the table")
    }

    /// `EPSG:n`, or the proj string it was made from.
    pub fn name(&self) -> &str {
        &self.inner.name
    }

    /// The EPSG code where it is known.
    pub fn epsg(&self) -> Option<u32> {
        self.inner.epsg
    }

    /// Whether coordinates are longitude and latitude in degrees.
    pub fn is_geographic(&self) -> bool {
        self.inner.proj.is_latlong()
    }

    /// Meters in one unit of its coordinates; 1 for a geographic system, whose unit is the degree.
    pub fn meters_per_unit(&self) -> f64 {
        if self.is_geographic() { 1.0 } else { self.inner.proj.to_meter() }
    }

    /// Whether coordinates are eastings and northings in meters.
    pub fn is_metric(&self) -> bool {
        !self.is_geographic() && self.meters_per_unit() == 1.0
    }

    /// Semi-major and semi-minor axis of its ellipsoid in meters.
    pub fn ellipsoid(&self) -> (f64, f64) {
        self.inner.proj.ellipse_parameters()
    }

    /// Its parameters; `None` where it has no place on Earth, or where its projection is none that
    /// [`Definition`] can express.
    pub fn definition(&self) -> Option<Definition> {
        let (major_m, minor_m) = self.ellipsoid();
        // The nine decimals that ellipsoids are defined with come out of the axes with noise behind them.
        let rounded = |value: f64| (value * 1e9).round() / 1e9;
        let inverse_flattening =
            if major_m == minor_m { 0.0 } else { rounded(major_m / (major_m - minor_m)) };
        let ellipsoid = Ellipsoid { major_m, inverse_flattening };
        let meridian_deg = self.inner.proj.from_greenwich().to_degrees();
        let mut definition = proj_words::definition(&self.inner.text, ellipsoid, meridian_deg)?;
        definition.name = self.name().into();
        definition.meters_per_unit = self.meters_per_unit();
        Some(definition)
    }

    /// The proj string that says the same; empty for [`Crs::local`].
    pub fn proj_text(&self) -> &str {
        &self.inner.text
    }

    /// What [`Crs::transform`] to `to` does to move positions from one datum to the other.
    ///
    /// # Errors
    /// [`CrsError::Datum`] where the shift is not known.
    ///
    /// ```
    /// use sandtable::geom::crs::Crs;
    /// let british = Crs::from_epsg(27700).unwrap();
    /// let shift = british.datum_shift_to(&Crs::wgs84()).unwrap();
    /// assert!(shift.to_string().starts_with("towgs84 446.448,-125.157,542.06"));
    /// ```
    pub fn datum_shift_to(&self, to: &Self) -> Result<DatumShift, CrsError> {
        self.check_datum(to)?;
        if self == to || (self.inner.datum == to.inner.datum && self.inner.datum != DatumTie::Tied) {
            return Ok(DatumShift::NotNeeded);
        }
        Ok(DatumShift::between(&self.inner.text, &to.inner.text))
    }

    /// Brings `at` from this system to `to`.
    ///
    /// # Errors
    /// [`CrsError::Datum`] where the shift between the two datums is not known, [`CrsError::Transform`] where
    /// the point lies outside what either projection covers.
    pub fn transform(&self, to: &Self, at: DVec2) -> Result<DVec2, CrsError> {
        if self == to {
            return Ok(at);
        }
        self.check_datum(to)?;
        let failed = |reason: String| CrsError::Transform {
            from: self.name().into(),
            to: to.name().into(),
            x: at.x,
            y: at.y,
            reason,
        };
        let scale_in = if self.is_geographic() { 1f64.to_radians() } else { 1.0 };
        let mut point = (at.x * scale_in, at.y * scale_in, 0.0);
        proj4rs::transform::transform(&self.inner.proj, &to.inner.proj, &mut point)
            .map_err(|error| failed(error.to_string()))?;
        let scale_out = if to.is_geographic() { 1f64.to_degrees() } else { 1.0 };
        let moved = DVec2::new(point.0 * scale_out, point.1 * scale_out);
        if moved.is_finite() { Ok(moved) } else { Err(failed("the result is not finite".into())) }
    }

    /// Whether the datums of the two can be brought together: both tied to WGS 84, or one and the same.
    fn check_datum(&self, to: &Self) -> Result<(), CrsError> {
        let datum = match (&self.inner.datum, &to.inner.datum) {
            (ours, theirs) if ours == theirs => return Ok(()),
            (DatumTie::Adrift(words), _) | (_, DatumTie::Adrift(words)) => words.clone(),
            (DatumTie::Tied, DatumTie::Tied) => return Ok(()),
        };
        Err(CrsError::Datum { from: self.name().into(), to: to.name().into(), datum })
    }
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner.name == other.inner.name
    }
}

/// The proj string of an EPSG code.
pub(crate) fn epsg_text(code: u32) -> Option<&'static str> {
    let definition = crs_definitions::from_code(u16::try_from(code).ok()?)?;
    (!definition.proj4.is_empty()).then_some(definition.proj4)
}

/// `n` or `n +to_meter=x`, what follows `EPSG:`.
fn parse_epsg(text: &str, rest: &str) -> Result<Crs, CrsError> {
    let (code, unit) = rest.trim().split_once(char::is_whitespace).unwrap_or((rest.trim(), ""));
    let code = code.parse().map_err(|_| unknown(&shortened(text), "the code is not a number"))?;
    match unit.trim().strip_prefix("+to_meter=").map(str::parse) {
        Some(Ok(meters)) => Crs::from_epsg_in(code, meters),
        None if unit.trim().is_empty() => Crs::from_epsg(code),
        _ => Err(unknown(&shortened(text), "only +to_meter=number may follow the code")),
    }
}

/// The proj string to build from, and what its words say of the datum. A datum that needs grids is replaced
/// by its ellipsoid, so that the system itself can still be had.
fn settle_datum(text: &str) -> (String, DatumTie) {
    let mut words: Vec<&str> = text.split_whitespace().collect();
    let value = |key: &str, words: &[&str]| -> Option<String> {
        words.iter().find_map(|word| word.strip_prefix(key)).map(str::to_owned)
    };
    if let Some(grids) = value("+nadgrids=", &words) {
        if grids == "@null" {
            return (text.into(), DatumTie::Tied);
        }
        words.retain(|word| !word.starts_with("+nadgrids="));
        return (words.join(" "), DatumTie::Adrift(grids));
    }
    let datum = value("+datum=", &words);
    if value("+towgs84=", &words).is_some() {
        return (text.into(), DatumTie::Tied);
    }
    match datum {
        Some(name) if name.eq_ignore_ascii_case("nad27") => {
            words.retain(|word| !word.starts_with("+datum="));
            words.push("+ellps=clrk66");
            (words.join(" "), DatumTie::Adrift("NAD27".into()))
        }
        Some(_) => (text.into(), DatumTie::Tied),
        None => {
            let shape =
                |word: &&&str| ["+ellps=", "+a=", "+b=", "+rf=", "+R="].iter().any(|k| word.starts_with(k));
            let named = words.iter().filter(shape).copied().collect::<Vec<_>>().join(" ");
            (text.into(), DatumTie::Adrift(named))
        }
    }
}

/// Whether an ellipsoid is WGS 84's or GRS 80's, on which modern datums stand within a meter or two of
/// WGS 84, as PROJ too takes them. The two differ by 0.1 mm at the pole.
fn is_like_wgs84((major, minor): (f64, f64)) -> bool {
    (major - 6_378_137.0).abs() < 1e-3 && (minor - 6_356_752.314_2).abs() < 1e-3
}

fn unknown(text: &str, reason: &str) -> CrsError {
    CrsError::Unknown { text: text.into(), reason: reason.into() }
}

/// The first characters of a long text, for a message.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 60;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec2, b: DVec2, within: f64) {
        assert!(a.distance(b) <= within, "{a} is not within {within} of {b}");
    }

    #[test]
    fn utm_agrees_with_proj() {
        let utm = Crs::from_epsg(32616).expect("a zone");
        // cs2cs EPSG:4326 EPSG:32616
        let moved = Crs::wgs84().transform(&utm, DVec2::new(-87.0, 0.0)).expect("inside");
        close(moved, DVec2::new(500_000.0, 0.0), 1e-4);
        assert_eq!(Crs::utm_at(-85.3, 34.9), utm);
    }

    #[test]
    fn a_system_in_feet_is_its_metric_self_divided_by_the_unit() {
        let metric = Crs::from_epsg(2853).expect("known");
        let feet = Crs::from_epsg_in(2853, 1200.0 / 3937.0).expect("known");
        let at = DVec2::new(-78.0, 38.5);
        let m = Crs::wgs84().transform(&metric, at).expect("inside");
        let ft = Crs::wgs84().transform(&feet, at).expect("inside");
        close(ft * (1200.0 / 3937.0), m, 1e-6);
        assert_eq!(feet.epsg(), None);
        assert_eq!(Crs::parse(feet.name()), Ok(feet));
    }

    #[test]
    fn a_datum_that_needs_a_grid_is_refused_but_its_own_systems_agree() {
        let utm = Crs::from_epsg(26711).expect("NAD27 can be named");
        let degrees = Crs::from_epsg(4267).expect("NAD27 can be named");
        let at = DVec2::new(440_720.0, 3_751_320.0);
        let refused = utm.transform(&Crs::wgs84(), at).expect_err("no grid");
        assert!(refused.to_string().contains("NAD27"), "{refused}");
        let there = utm.transform(&degrees, at).expect("same datum");
        close(degrees.transform(&utm, there).expect("same datum"), at, 1e-4);
    }

    #[test]
    fn an_old_ellipsoid_without_a_shift_is_refused_a_new_one_is_taken() {
        let old = Crs::parse("+proj=utm +zone=31 +ellps=intl").expect("fine");
        let new = Crs::parse("+proj=utm +zone=31 +ellps=GRS80").expect("fine");
        let at = DVec2::new(500_000.0, 5_000_000.0);
        assert!(matches!(old.transform(&Crs::wgs84(), at), Err(CrsError::Datum { .. })));
        assert!(new.transform(&Crs::wgs84(), at).is_ok());
        let british = Crs::from_epsg(27700).expect("known");
        let shifted = british.transform(&Crs::from_epsg(25830).expect("known"), DVec2::new(3.2e5, 1.3e5));
        let wgs = british.transform(&Crs::from_epsg(32630).expect("known"), DVec2::new(3.2e5, 1.3e5));
        close(shifted.expect("inside"), wgs.expect("inside"), 1e-3);
    }

    #[test]
    fn nonsense_is_refused_with_the_way_to_write_it() {
        for text in [
            "",
            "EPSG:",
            "EPSG:0",
            "EPSG:99999999999",
            "EPSG:4326 meters",
            "+proj=nowhere",
            "PROJCS[",
            "utm 16",
            "+proj=geocent",
            "+proj=utm +zone=1é",
            "+proj=tmerc +to_meter=0",
        ] {
            let error = Crs::parse(text).expect_err(text);
            assert!(error.to_string().contains("EPSG:32616"), "{text}: {error}");
        }
    }
}
