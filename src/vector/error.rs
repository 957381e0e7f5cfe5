//! Errors of reading a vector file.

use std::borrow::Cow;
use std::error::Error;
use std::fmt::Display;

use sandtable_base::archive::ArchiveError;
use sandtable_base::limits::{DESIGN_BYTES, GEOJSON_BYTES, UNPACKED_VECTOR_BYTES};
use sandtable_base::message::suggest::nearest;
use sandtable_geom::crs::CrsError;

/// Most names that a message lists.
const MAX_LISTED: usize = 20;
/// Most characters of a name in a message.
pub(crate) const MAX_NAME_CHARS: usize = 60;

/// Why a vector file cannot be read. The caller adds the file's name.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum VectorError {
    #[error(
        "{bytes} bytes exceed the limit of {GEOJSON_BYTES}; cut the file down with 'ogr2ogr -clipsrc' or '-where', or {GEOJSON_BYTES:#}"
    )]
    TooLarge { bytes: usize },
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// It unpacks to more bytes than the limit for a file.
    #[error("{0}, or {UNPACKED_VECTOR_BYTES:#}")]
    Unpacked(ArchiveError),
    #[error("its \"type\" is \"{found}\", not a feature, a collection of features or a geometry; {remedy}")]
    NotGeoJson { found: String, remedy: &'static str },
    /// The file contradicts itself, ends too early, or is refused by the library that reads its format.
    #[error("the {format} is broken at {place}: {source}; fetch or export the file again")]
    Broken { format: &'static str, place: String, source: Box<dyn Error + Send + Sync> },
    #[error("this {format} holds {content}, which cannot be read; {remedy}")]
    Unsupported { format: &'static str, content: Cow<'static, str>, remedy: &'static str },
    #[error("this {format} {reason}, so its coordinate system is unknown; state it with the key 'crs'")]
    NoCrs { format: &'static str, reason: &'static str },
    #[error("its coordinate system cannot be used: {0}; state the right one with the key 'crs'")]
    Crs(#[from] CrsError),
    /// The `crs` member of a GeoJSON file is not understood.
    #[error("its \"crs\" member {found} is not understood; state the coordinate system with the key 'crs'")]
    CrsMember {
        /// The member, shortened.
        found: String,
        /// Why its name is not understood; `None` where it has none.
        source: Option<Box<CrsError>>,
    },
    #[error("it holds {} layers; choose one with 'layer': {}", names.len(), list(names))]
    WhichLayer { names: Vec<String> },
    #[error("it has no layer '{wanted}'{}; its layers are {}", did_you_mean(suggestion), list(names))]
    NoSuchLayer {
        /// The requested name, shortened.
        wanted: String,
        /// The most similar name, where one is similar.
        suggestion: Option<String>,
        names: Vec<String>,
    },
    #[error(
        "no column of this table says where its rows lie; its columns are {}; name them in its first row, such as lon and lat, easting and northing, grid reference or wkt, or state them: columns = {{ position = \"...\" }} or {{ lon = \"...\", lat = \"...\" }} or {{ x = \"...\", y = \"...\" }}",
        list(names)
    )]
    NoPlaceColumns { names: Vec<String> },
    #[error(
        "this table has no column '{wanted}'{}; its columns are {}",
        did_you_mean(suggestion),
        list(names)
    )]
    NoSuchColumn {
        /// The stated name, shortened.
        wanted: String,
        /// The most similar name, where one is similar.
        suggestion: Option<String>,
        names: Vec<String>,
    },
    #[error("this is {format}, which cannot be read; convert it: {command}")]
    OtherFormat { format: &'static str, command: String },
    #[error(
        "this is a {format}, which needs the Cargo feature '{feature}'; build sandtable with it, or convert the file: {command}"
    )]
    FeatureDisabled { format: &'static str, feature: &'static str, command: String },
    #[error(
        "neither its content nor its name tells its format; GeoJSON is read, and ESRI shapefiles, GeoPackage, FlatGeobuf, GPX, KML, KMZ, CityJSON, LandXML, DXF, OpenStreetMap (.osm, .osm.pbf), tables (.csv, .tsv, .xlsx, .ods), and the overlays MSDL, NVG, MilX, Cursor on Target and ORBAT Mapper"
    )]
    UnknownFormat,
    /// A longitude or latitude is out of range: usually meters in a file that names no system.
    #[error(
        "feature {feature} has a vertex at ({x}, {y}), which cannot be longitude and latitude in {crs}; if the file is in another system, state it with the key 'crs'"
    )]
    NotDegrees {
        /// Counts from 1, in the file's order.
        feature: usize,
        x: f64,
        y: f64,
        crs: String,
    },
    #[error(
        "feature {feature} has a vertex at ({x:e}, {y:e}); no coordinate of a map is beyond 1e9, so the file is broken: export it again"
    )]
    TooFar {
        /// Counts from 1, in the file's order.
        feature: usize,
        x: f64,
        y: f64,
    },
}

impl VectorError {
    /// Refuses a file of a design that is larger than the limit.
    ///
    /// # Errors
    /// It is.
    pub(crate) fn check_design_size(format: &'static str, bytes: &[u8]) -> Result<(), Self> {
        if bytes.len() <= DESIGN_BYTES.count() {
            return Ok(());
        }
        let content =
            format!("{} bytes, more than the limit of {DESIGN_BYTES}; {DESIGN_BYTES:#}", bytes.len());
        Err(Self::Unsupported { format, content: content.into(), remedy: "part it by its layers" })
    }

    /// A [`VectorError::Broken`].
    pub(crate) fn broken(
        format: &'static str,
        place: impl Display,
        source: impl Into<Box<dyn Error + Send + Sync>>,
    ) -> Self {
        Self::Broken { format, place: place.to_string(), source: source.into() }
    }

    /// Returns what is wrong with the record at `place`, unless the error knows a place of its own, where the rest of the
    /// file is read.
    pub(crate) fn of_record(&self, place: &str) -> String {
        match self {
            Self::Broken { place, source, .. } => format!("{place}: {source}"),
            Self::Unsupported { content, .. } => format!("{place}: {content}, which cannot be read"),
            Self::NotDegrees { x, y, crs, .. } => {
                format!("{place}: a vertex at ({x}, {y}) cannot be longitude and latitude in {crs}")
            }
            Self::TooFar { x, y, .. } => format!("{place}: a vertex at ({x:e}, {y:e}) lies on no map"),
            other => format!("{place}: {other}"),
        }
    }

    /// A [`VectorError::Unsupported`] about curves, which no reader turns into lines.
    pub(crate) fn curves(format: &'static str, kind: &str) -> Self {
        Self::Unsupported {
            format,
            content: format!("shapes of the type {kind}").into(),
            remedy: "convert them, for example with: ogr2ogr -nlt CONVERT_TO_LINEAR",
        }
    }

    /// A [`VectorError::WhichLayer`] among `names`.
    pub(crate) fn which_layer(names: &[&str]) -> Self {
        Self::WhichLayer { names: names.iter().copied().map(str::to_owned).collect() }
    }

    /// A [`VectorError::NoSuchColumn`] among `names`.
    pub(crate) fn no_such_column(wanted: &str, names: &[String]) -> Self {
        let suggestion = nearest(wanted, names.iter().map(String::as_str)).map(str::to_owned);
        Self::NoSuchColumn { wanted: shorten(wanted), suggestion, names: names.to_vec() }
    }

    /// A [`VectorError::NoSuchLayer`] among `names`.
    pub(crate) fn no_such_layer(wanted: &str, names: &[&str]) -> Self {
        let suggestion = nearest(wanted, names.iter().copied()).map(str::to_owned);
        Self::NoSuchLayer {
            wanted: shorten(wanted),
            suggestion,
            names: names.iter().copied().map(str::to_owned).collect(),
        }
    }
}

/// Returns the first [`MAX_NAME_CHARS`] characters of `name`.
pub(crate) fn shorten(name: &str) -> String {
    name.chars().take(MAX_NAME_CHARS).collect()
}

/// Returns `; did you mean 'roads'?` for a suggestion, else nothing.
pub fn did_you_mean(suggestion: &Option<String>) -> String {
    suggestion.as_ref().map_or_else(String::new, |name| format!("; did you mean '{name}'?"))
}

/// Returns the first names, each shortened, separated by commas; `none` of no names.
pub fn list(names: &[String]) -> String {
    if names.is_empty() {
        return "none".into();
    }
    let shown: Vec<String> = names.iter().take(MAX_LISTED).map(|name| shorten(name)).collect();
    let more = if names.len() > MAX_LISTED { ", ..." } else { "" };
    shown.join(", ") + more
}
