//! Coordinate reference systems and transforms between them: the one door to `proj4rs`.

use std::sync::Arc;

use glam::DVec2;

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
    proj: proj4rs::Proj,
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
        let unknown = |reason: String| CrsError::Unknown { text: format!("EPSG:{code}"), reason };
        let short = u16::try_from(code).map_err(|_| unknown("no such code in the EPSG table".into()))?;
        let proj = proj4rs::Proj::from_epsg_code(short).map_err(|error| unknown(error.to_string()))?;
        Ok(Self::new(format!("EPSG:{code}"), Some(code), proj))
    }

    /// The system that `text` names: `EPSG:n` in any case, or a proj string such as `+proj=utm +zone=16`.
    ///
    /// # Errors
    /// [`CrsError::Unknown`].
    pub fn parse(text: &str) -> Result<Self, CrsError> {
        let trimmed = text.trim();
        let unknown = |reason: String| CrsError::Unknown { text: text.into(), reason };
        match trimmed.split_once(':') {
            Some((authority, code)) if authority.eq_ignore_ascii_case("epsg") => {
                let code = code.parse().map_err(|_| unknown("the code is not a number".into()))?;
                Self::from_epsg(code)
            }
            _ if trimmed.contains("+proj") => {
                let proj =
                    proj4rs::Proj::from_proj_string(trimmed).map_err(|error| unknown(error.to_string()))?;
                Ok(Self::new(trimmed.into(), None, proj))
            }
            _ => Err(unknown("no authority and no +proj in it".into())),
        }
    }

    fn new(name: String, epsg: Option<u32>, proj: proj4rs::Proj) -> Self {
        Self { inner: Arc::new(Inner { name, epsg, proj }) }
    }

    /// WGS 84 longitude and latitude, EPSG:4326.
    pub fn wgs84() -> Self {
        Self::from_epsg(4326).expect("EPSG:4326 is in the table")
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

    /// Metres in one unit of its coordinates; 1 for a geographic system, whose unit is the degree.
    pub fn metres_per_unit(&self) -> f64 {
        if self.is_geographic() { 1.0 } else { self.inner.proj.to_meter() }
    }

    /// Brings `at` from this system to `to`.
    ///
    /// # Errors
    /// [`CrsError::Transform`] where the point lies outside what either projection covers.
    pub fn transform(&self, to: &Self, at: DVec2) -> Result<DVec2, CrsError> {
        if self == to {
            return Ok(at);
        }
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
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner.name == other.inner.name
    }
}
