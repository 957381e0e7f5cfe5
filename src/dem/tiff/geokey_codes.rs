//! The numbers of GeoTIFF keys and of projections in them (OGC 19-008r4).

use sandtable_geom::projection::MapProjection;

/// In place of a code: the parameters are in other keys.
pub(super) const USER_DEFINED: u16 = 32767;

pub(super) const MODEL_TYPE: u16 = 1024;
pub(super) const RASTER_TYPE: u16 = 1025;
pub(super) const CITATION: u16 = 1026;
pub(super) const GEOGRAPHIC_TYPE: u16 = 2048;
pub(super) const GEODETIC_DATUM: u16 = 2050;
pub(super) const ANGULAR_UNITS: u16 = 2054;
pub(super) const ANGULAR_UNIT_SIZE: u16 = 2055;
pub(super) const ELLIPSOID: u16 = 2056;
pub(super) const SEMI_MAJOR: u16 = 2057;
pub(super) const SEMI_MINOR: u16 = 2058;
pub(super) const INVERSE_FLATTENING: u16 = 2059;
pub(super) const PRIME_MERIDIAN: u16 = 2061;
pub(super) const TO_WGS84: u16 = 2062;
pub(super) const PROJECTED_TYPE: u16 = 3072;
pub(super) const PROJECTION: u16 = 3074;
pub(super) const TRANSFORMATION: u16 = 3075;
pub(super) const LINEAR_UNITS: u16 = 3076;
pub(super) const LINEAR_UNIT_SIZE: u16 = 3077;
pub(super) const PARALLEL_1: u16 = 3078;
pub(super) const PARALLEL_2: u16 = 3079;
pub(super) const SCALE: u16 = 3092;
pub(super) const VERTICAL_TYPE: u16 = 4096;
pub(super) const VERTICAL_CITATION: u16 = 4097;
pub(super) const VERTICAL_DATUM: u16 = 4098;
pub(super) const VERTICAL_UNITS: u16 = 4099;

// Writers never agreed on one key for a parameter: any of these may hold it.
pub(super) const LATITUDES: [u16; 4] = [3081, 3085, 3089, 3094];
pub(super) const LONGITUDES: [u16; 5] = [3080, 3084, 3088, 3095, 3096];
pub(super) const SCALES: [u16; 2] = [SCALE, 3093];
pub(super) const EASTINGS: [u16; 3] = [3082, 3086, 3090];
pub(super) const NORTHINGS: [u16; 3] = [3083, 3087, 3091];

/// GeoDoubleParams and GeoAsciiParams: the tags that hold the numbers and the text of keys.
pub(super) const IN_DOUBLES: u16 = 34736;
pub(super) const IN_TEXT: u16 = 34737;

/// Keys of the natural origin, in the order of [`ProjectionKeys`].
const NATURAL: [u16; 4] = [3081, 3080, 3082, 3083];

/// A projection's code, and the keys that its parameters are written to.
pub(super) struct ProjectionKeys {
    pub method: MapProjection,
    pub code: u16,
    /// The keys for latitude, longitude, easting and northing of the origin.
    pub origin: [u16; 4],
}

/// All projections that are read and written.
pub(super) const PROJECTIONS: [ProjectionKeys; 7] = [
    ProjectionKeys { method: MapProjection::TransverseMercator, code: 1, origin: NATURAL },
    ProjectionKeys { method: MapProjection::Mercator, code: 7, origin: NATURAL },
    ProjectionKeys { method: MapProjection::LambertConic2, code: 8, origin: [3085, 3084, 3086, 3087] },
    ProjectionKeys { method: MapProjection::LambertConic1, code: 9, origin: NATURAL },
    ProjectionKeys { method: MapProjection::LambertAzimuthal, code: 10, origin: [3089, 3088, 3082, 3083] },
    ProjectionKeys { method: MapProjection::Albers, code: 11, origin: NATURAL },
    ProjectionKeys { method: MapProjection::PolarStereographic, code: 15, origin: [3081, 3095, 3082, 3083] },
];
