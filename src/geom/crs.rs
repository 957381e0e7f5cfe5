//! Coordinate reference systems and transforms between them; the only user of `proj4rs`.
//!
//! A system is made from an EPSG code, a proj string, WKT 1 (a `.prj` file) or the parameters of a projection. Anything
//! else is refused, never approximated. A system on a datum whose shift to WGS 84 is unknown or needs a grid file
//! (NAD27) can be named and measured in; it transforms to systems on the same datum only.
//!
//! Accuracy, checked against PROJ by `tests/dem_oracle.rs`: UTM, Lambert, Albers and azimuthal systems agree within
//! 0.1 mm. EPSG:27700 agrees within 3 mm with PROJ's own seven-parameter shift, which is good to some meters (the grid
//! OSTN15 is not used).

use std::sync::Arc;

use glam::DVec2;

use crate::crs_fault::CrsFault;
use crate::datum_shift::DatumShift;
use crate::proj_string::ProjString;
use crate::projection::{Datum, Definition, Ellipsoid, utm_code};
use crate::wkt::{self, WktSystem};

/// The southernmost and the northernmost latitude of UTM.
pub const UTM_LATITUDES_DEG: (f64, f64) = (-80.0, 84.0);

/// Meters of a degree of latitude, and of one of longitude on the equator, within one per cent.
pub const DEGREE_M: f64 = 111_320.0;

/// The longest text that is parsed, in bytes; real WKT has a tenth of it.
const LONGEST_TEXT: usize = 65_536;

/// A horizontal coordinate reference system; cheap to clone.
///
/// Coordinates are (easting, northing) in the system's own linear unit, or (longitude, latitude) in degrees for a
/// geographic one, whatever axis order its registry entry states.
#[derive(Clone, Debug)]
pub struct Crs {
    inner: Arc<CrsInner>,
}

#[derive(Debug)]
struct CrsInner {
    name: String,
    epsg: Option<u32>,
    /// The proj string that it was made from; empty for [`Crs::local`].
    text: String,
    proj: proj4rs::Proj,
    datum: DatumTie,
}

/// How a system's datum relates to WGS 84.
#[derive(Clone, Debug, PartialEq)]
enum DatumTie {
    /// A shift is stated, or none is needed.
    Known,
    /// No shift is known; the words that name the datum.
    Unknown(String),
}

/// Why there is no coordinate reference system or transform.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CrsError {
    /// The text names no system that is read.
    #[error(
        "'{text}' is not a coordinate reference system that is understood ({reason}); write EPSG:n, for example EPSG:32616, or a proj string"
    )]
    Unknown {
        /// The text, shortened.
        text: String,
        /// What is wrong with it.
        #[source]
        reason: Box<CrsFault>,
    },
    /// The two systems have different datums and the shift between them is not known.
    #[error(
        "{from} cannot be transformed to {to}: the shift from the datum '{datum}' to WGS 84 needs a grid file or was not stated; convert the data with another program first, or give the system as a proj string with +towgs84"
    )]
    Datum {
        /// Source system.
        from: String,
        /// Target system.
        to: String,
        /// The datum without a known shift.
        datum: String,
    },
    /// A coordinate lies outside what one of the projections covers.
    #[error("({x}, {y}) cannot be transformed from {from} to {to}: {reason}")]
    Transform {
        /// Source system.
        from: String,
        /// Target system.
        to: String,
        /// Easting or longitude.
        x: f64,
        /// Northing or latitude.
        y: f64,
        /// The projection's error.
        #[source]
        reason: Box<CrsFault>,
    },
}

impl Crs {
    /// The system with an EPSG code.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where the code is not in the table.
    pub fn from_epsg(code: u32) -> Result<Self, CrsError> {
        let name = format!("EPSG:{code}");
        let text = epsg_text(code).ok_or_else(|| unknown(&name, CrsFault::NoSuchCode))?;
        Self::build(name, Some(code), text)
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
            return Err(unknown(&name, CrsFault::Unit));
        }
        let table = epsg_text(code).ok_or_else(|| unknown(&name, CrsFault::NoSuchCode))?;
        let text = table.without(&["units", "to_meter", "no_defs"]);
        Self::build(name, None, ProjString(&format!("{text} +to_meter={meters_per_unit}")))
    }

    /// The system with given parameters; where these are those of a common EPSG code, that one.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where the parameters are out of range.
    pub fn from_definition(definition: &Definition) -> Result<Self, CrsError> {
        if let Some(code) = definition.epsg() {
            return Self::from_epsg(code);
        }
        let text = definition.proj_text().map_err(|error| unknown(&definition.name, error))?;
        Self::build(text.clone(), None, ProjString(&text))
    }

    /// The system that `text` names: `EPSG:n` in any case, a proj string such as `+proj=utm +zone=16`, or WKT 1 as
    /// `.prj` files hold it. It reads back every [`Crs::name`] but that of [`Crs::local`].
    ///
    /// # Errors
    /// [`CrsError::Unknown`].
    pub fn parse(text: &str) -> Result<Self, CrsError> {
        let trimmed =
            text.trim_start_matches('\u{feff}').trim_matches(|c: char| c.is_whitespace() || c == '\0');
        if trimmed.len() > LONGEST_TEXT {
            return Err(unknown(trimmed, CrsFault::TooLong));
        }
        match trimmed.split_once(':') {
            Some((authority, rest)) if authority.eq_ignore_ascii_case("epsg") => parse_epsg(trimmed, rest),
            _ if wkt::is_wkt(trimmed) => match wkt::read(trimmed).map_err(|error| unknown(trimmed, error))? {
                WktSystem::Epsg(code) => Self::from_epsg(code),
                WktSystem::Parameters(definition) => Self::from_definition(&definition),
            },
            _ if trimmed.contains("+proj") => Self::build(trimmed.into(), None, ProjString(trimmed)),
            _ => Err(unknown(trimmed, CrsFault::Notation)),
        }
    }

    /// The system of a proj string.
    fn build(name: String, epsg: Option<u32>, text: ProjString<'_>) -> Result<Self, CrsError> {
        if !text.0.is_ascii() {
            return Err(unknown(&name, CrsFault::NotAscii));
        }
        let (settled, datum) = settle_datum(text);
        let proj = proj4rs::Proj::from_proj_string(&settled)
            .map_err(|error| unknown(&name, CrsFault::from(error)))?;
        if proj.is_geocent() {
            return Err(unknown(&name, CrsFault::Geocentric));
        }
        let scale = proj.to_meter();
        if !(scale.is_finite() && scale > 0.0 && proj.ellipse_parameters().0.is_finite()) {
            return Err(unknown(&name, CrsFault::NotALength));
        }
        if datum != DatumTie::Known && is_like_wgs84(proj.ellipse_parameters()) {
            return Self::build(name, epsg, ProjString(&format!("{settled} +towgs84=0,0,0")));
        }
        Ok(Self { inner: Arc::new(CrsInner { name, epsg, text: text.0.into(), proj, datum }) })
    }

    /// WGS 84 longitude and latitude, EPSG:4326.
    pub fn wgs84() -> Self {
        Self::from_epsg(4326).expect("EPSG:4326 is in the table")
    }

    /// A plane in meters with no known place on Earth, for a raster without a system. Nothing can be transformed to or
    /// from it.
    pub fn local() -> Self {
        let proj = Self::utm_at(0.0, 0.0).inner.proj.clone();
        let datum = DatumTie::Unknown("no place on Earth".into());
        let name = "local meters".into();
        Self { inner: Arc::new(CrsInner { name, epsg: None, text: String::new(), proj, datum }) }
    }

    /// The UTM zone on WGS 84 of a longitude and latitude in degrees (the plain six-degree zones).
    pub fn utm_at(longitude: f64, latitude: f64) -> Self {
        let zone = (((longitude + 180.0).rem_euclid(360.0)) / 6.0).floor().min(59.0) as u32 + 1;
        let base = if latitude < 0.0 { 32700 } else { 32600 };
        Self::from_epsg(base + zone).expect("all UTM zones are in the table")
    }

    /// UTM in a zone, negative in the south, on the geographic system with an EPSG code: EPSG's own where it has one.
    ///
    /// # Errors
    /// [`CrsError::Unknown`] where there is no such zone, the code is not in the table, or the unit is not a positive length.
    ///
    /// ```
    /// use sandtable_geom::crs::Crs;
    /// assert_eq!(Crs::utm_on(4267, 10, 1.0).unwrap().name(), "EPSG:26710");
    /// assert!(Crs::utm_on(4267, 48, 1.0).unwrap().name().contains("+lon_0=105 "));
    /// ```
    pub fn utm_on(geographic: u32, zone: i64, meters_per_unit: f64) -> Result<Self, CrsError> {
        if let Some(code) = utm_code(geographic, zone) {
            return Self::from_epsg_in(code, meters_per_unit);
        }
        if !(1..=60).contains(&zone.unsigned_abs()) {
            return Err(unknown(&format!("UTM zone {zone}"), CrsFault::NoSuchZone));
        }
        Self::from_definition(&Definition::utm(geographic, zone, meters_per_unit))
    }

    /// Universal Polar Stereographic on WGS 84 around the pole of a latitude in degrees, eastings first.
    pub fn ups_at(latitude: f64) -> Self {
        let code = if latitude < 0.0 { 5042 } else { 5041 };
        Self::from_epsg(code).expect("both poles are in the table")
    }

    /// The UTM zone of a longitude and latitude in degrees, and UPS where UTM ends: beyond 84° north and 80° south.
    pub fn utm_or_ups_at(longitude: f64, latitude: f64) -> Self {
        let (south, north) = UTM_LATITUDES_DEG;
        if (south..=north).contains(&latitude) {
            Self::utm_at(longitude, latitude)
        } else {
            Self::ups_at(latitude)
        }
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

    /// Meters northward in one unit of its coordinates, for degrees nearly: see [`DEGREE_M`].
    pub fn meters_northward_per_unit(&self) -> f64 {
        if self.is_geographic() { DEGREE_M } else { self.meters_per_unit() }
    }

    /// Whether coordinates are eastings and northings in meters.
    pub fn is_metric(&self) -> bool {
        !self.is_geographic() && self.meters_per_unit() == 1.0
    }

    /// Semi-major and semi-minor axis of its ellipsoid in meters.
    pub fn ellipsoid(&self) -> (f64, f64) {
        self.inner.proj.ellipse_parameters()
    }

    /// Its parameters; `None` for [`Crs::local`] and for a projection that [`Definition`] cannot express.
    pub fn definition(&self) -> Option<Definition> {
        Definition::from_proj(ProjString(&self.inner.text), self.geodetic_definition())
    }

    /// Its datum and unit, without a projection.
    pub(crate) fn geodetic_definition(&self) -> Definition {
        let (major_m, minor_m) = self.ellipsoid();
        // Ellipsoids are defined with nine decimals; those computed from the axes have noise behind them.
        let rounded = |value: f64| (value * 1e9).round() / 1e9;
        let inverse_flattening =
            if major_m == minor_m { 0.0 } else { rounded(major_m / (major_m - minor_m)) };
        let ellipsoid = Ellipsoid { major_m, inverse_flattening };
        let datum = Datum::from_proj(ProjString(&self.inner.text));
        Definition {
            prime_meridian_deg: self.inner.proj.from_greenwich().to_degrees(),
            meters_per_unit: self.meters_per_unit(),
            ..Definition::geographic(self.name().into(), Some(ellipsoid), datum)
        }
    }

    /// Longitude and latitude in degrees on the datum of a projected system: WGS 84 where the shift to it is known, so that
    /// the two transform to each other; `None` for a geographic system and for [`Crs::local`].
    pub(crate) fn geographic_base(&self) -> Option<Self> {
        /// The words of a proj string that state a datum.
        const DATUM: [&str; 8] = ["datum", "ellps", "a", "b", "rf", "R", "nadgrids", "pm"];
        if self.is_geographic() || self.inner.text.is_empty() {
            return None;
        }
        if self.inner.datum == DatumTie::Known {
            return Some(Self::wgs84());
        }
        let text = format!("+proj=longlat {}", ProjString(&self.inner.text).only(&DATUM));
        Self::build(text.clone(), None, ProjString(&text)).ok()
    }

    /// The proj string of the system; empty for [`Crs::local`].
    pub fn proj_text(&self) -> &str {
        &self.inner.text
    }

    /// The datum shift that [`Crs::transform`] to `to` applies.
    ///
    /// # Errors
    /// [`CrsError::Datum`] where the shift is not known.
    ///
    /// ```
    /// use sandtable_geom::crs::Crs;
    /// let british = Crs::from_epsg(27700).unwrap();
    /// let shift = british.datum_shift_to(&Crs::wgs84()).unwrap();
    /// assert!(shift.to_string().starts_with("towgs84 446.448,-125.157,542.06"));
    /// ```
    pub fn datum_shift_to(&self, to: &Self) -> Result<DatumShift, CrsError> {
        self.check_datum(to)?;
        if self == to || (self.inner.datum == to.inner.datum && self.inner.datum != DatumTie::Known) {
            return Ok(DatumShift::NotNeeded);
        }
        Ok(DatumShift::between(ProjString(&self.inner.text), ProjString(&to.inner.text)))
    }

    /// Transforms `at` from this system to `to`.
    ///
    /// # Errors
    /// [`CrsError::Datum`] where the shift between the two datums is not known, [`CrsError::Transform`] where the point
    /// lies outside what either projection covers.
    pub fn transform(&self, to: &Self, at: DVec2) -> Result<DVec2, CrsError> {
        if self == to {
            return Ok(at);
        }
        self.check_datum(to)?;
        let failed = |reason: CrsFault| CrsError::Transform {
            from: self.name().into(),
            to: to.name().into(),
            x: at.x,
            y: at.y,
            reason: Box::new(reason),
        };
        let scale_in = if self.is_geographic() { 1f64.to_radians() } else { 1.0 };
        let mut point = (at.x * scale_in, at.y * scale_in, 0.0);
        proj4rs::transform::transform(&self.inner.proj, &to.inner.proj, &mut point)
            .map_err(|error| failed(error.into()))?;
        let scale_out = if to.is_geographic() { 1f64.to_degrees() } else { 1.0 };
        let moved = DVec2::new(point.0 * scale_out, point.1 * scale_out);
        if moved.is_finite() { Ok(moved) } else { Err(failed(CrsFault::NotFinite)) }
    }

    /// Checks that a shift between the two datums is known, or that they are the same.
    fn check_datum(&self, to: &Self) -> Result<(), CrsError> {
        match (&self.inner.datum, &to.inner.datum) {
            (from, to) if from == to => Ok(()),
            (DatumTie::Unknown(datum), _) | (_, DatumTie::Unknown(datum)) => {
                Err(CrsError::Datum { from: self.name().into(), to: to.name().into(), datum: datum.clone() })
            }
            (DatumTie::Known, DatumTie::Known) => Ok(()),
        }
    }
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner.name == other.inner.name
    }
}

/// The proj string of an EPSG code.
pub(crate) fn epsg_text(code: u32) -> Option<ProjString<'static>> {
    let definition = crs_definitions::from_code(u16::try_from(code).ok()?)?;
    (!definition.proj4.is_empty()).then_some(ProjString(definition.proj4))
}

/// Parses `n` or `n +to_meter=x`, what follows `EPSG:`.
fn parse_epsg(text: &str, rest: &str) -> Result<Crs, CrsError> {
    let (code, unit) = rest.trim().split_once(char::is_whitespace).unwrap_or((rest.trim(), ""));
    let code = code.parse().map_err(|_| unknown(text, CrsFault::CodeNotANumber))?;
    match unit.trim().strip_prefix("+to_meter=").map(str::parse) {
        Some(Ok(meters)) => Crs::from_epsg_in(code, meters),
        None if unit.trim().is_empty() => Crs::from_epsg(code),
        _ => Err(unknown(text, CrsFault::AfterCode)),
    }
}

/// The proj string to build from, and how its datum relates to WGS 84. A datum that needs grids is replaced by its
/// ellipsoid, so that the system itself can be built.
fn settle_datum(text: ProjString<'_>) -> (String, DatumTie) {
    let unchanged = text.0.to_owned();
    match (text.value("nadgrids"), text.value("towgs84"), text.value("datum")) {
        (Some("@null"), ..) => (unchanged, DatumTie::Known),
        (Some(grids), ..) => (text.without(&["nadgrids"]), DatumTie::Unknown(grids.into())),
        (None, Some(_), _) => (unchanged, DatumTie::Known),
        (None, None, Some(name)) if name.eq_ignore_ascii_case("nad27") => {
            (text.without(&["datum"]) + " +ellps=clrk66", DatumTie::Unknown("NAD27".into()))
        }
        (None, None, Some(_)) => (unchanged, DatumTie::Known),
        (None, None, None) => (unchanged, DatumTie::Unknown(text.only(&["ellps", "a", "b", "rf", "R"]))),
    }
}

/// Whether an ellipsoid is WGS 84's or GRS 80's, which differ by 0.1 mm at the pole. Modern datums on them lie within a
/// meter or two of WGS 84, and PROJ too takes them to coincide.
fn is_like_wgs84((major, minor): (f64, f64)) -> bool {
    (major - 6_378_137.0).abs() < 1e-3 && (minor - 6_356_752.314_2).abs() < 1e-3
}

fn unknown(text: &str, reason: impl Into<CrsFault>) -> CrsError {
    /// The characters of a long text that a message shows.
    const SHOWN: usize = 60;
    let text = match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.into(),
    };
    CrsError::Unknown { text, reason: Box::new(reason.into()) }
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
    fn a_zone_without_a_code_is_the_zone_on_its_datum() {
        let far = Crs::utm_on(4267, 48, 1.0).expect("a zone");
        assert_eq!((far.epsg(), far.is_metric()), (None, true));
        let degrees = Crs::from_epsg(4267).expect("NAD27 can be named");
        let origin = degrees.transform(&far, DVec2::new(105.0, 0.0)).expect("same datum");
        close(origin, DVec2::new(500_000.0, 0.0), 1e-4);
        assert!(matches!(far.transform(&Crs::wgs84(), origin), Err(CrsError::Datum { .. })));
        assert_eq!(Crs::parse(far.name()), Ok(far));
        let south = Crs::utm_on(4267, -48, 1.0).expect("a zone");
        let origin = degrees.transform(&south, DVec2::new(105.0, 0.0)).expect("same datum");
        close(origin, DVec2::new(500_000.0, 1e7), 1e-4);
        for zone in [0, 61, -61, i64::MIN] {
            assert!(Crs::utm_on(4267, zone, 1.0).expect_err("no zone").to_string().contains("1 to 60"));
        }
    }

    #[test]
    fn polar_stereographic_has_its_pole_at_2000_km() {
        // The distance from the pole is that of Snyder 1987, equations 21-33 and 21-34.
        for (latitude, x, apart) in
            [(90.0, 0.0, 0.0), (-90.0, 0.0, 0.0), (84.0, 90.0, 666_727.704), (-80.0, 45.0, 1_112_951.137)]
        {
            let (ups, pole) = (Crs::ups_at(latitude), DVec2::splat(2e6));
            let at = Crs::wgs84().transform(&ups, DVec2::new(x, latitude)).expect("inside");
            assert!((at.distance(pole) - apart).abs() < 0.01, "{at}");
            let back = ups.transform(&Crs::wgs84(), at).expect("inside");
            assert!((back.y - latitude).abs() < 1e-7, "{back}");
        }
        let codes = [(0.0, 84.0), (0.0, 84.1), (15.0, -80.0), (15.0, -80.1)];
        let codes = codes.map(|(longitude, latitude)| Crs::utm_or_ups_at(longitude, latitude).epsg());
        assert_eq!(codes, [Some(32631), Some(5041), Some(32733), Some(5042)]);
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
    fn nonsense_is_refused_with_an_example() {
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
