//! Why a vector file cannot be read.

use crate::geom::crs::CrsError;
use crate::message::suggest::nearest;

/// As many layers as a message lists.
const LAYERS_SHOWN: usize = 20;

/// Why a vector file cannot be read; the file's name is for the caller to add.
#[derive(Debug, thiserror::Error)]
pub enum VectorError {
    /// More bytes than are read into memory.
    #[error(
        "{bytes} bytes are more than the {limit} allowed; cut it down with 'ogr2ogr -clipsrc' or '-where'"
    )]
    TooLarge {
        /// The file's size.
        bytes: usize,
        /// The largest size read.
        limit: usize,
    },
    /// The text is not JSON, or its JSON is not GeoJSON.
    #[error("line {line}, column {column}: {reason}; GeoJSON (RFC 7946) is needed")]
    Malformed {
        /// Counts from 1.
        line: usize,
        /// Counts bytes from 1.
        column: usize,
        /// What the parser says.
        reason: String,
    },
    /// JSON of another kind.
    #[error("its \"type\" is \"{found}\", not a feature, a collection of features or a geometry; {remedy}")]
    NotGeoJson {
        /// The value of the top object's `type`.
        found: String,
        /// What to do about it.
        remedy: String,
    },
    /// The file contradicts itself or ends too early.
    #[error("the {format} is broken at {place}: {reason}; fetch or export the file again")]
    Broken {
        /// The format's name.
        format: &'static str,
        /// Where, as its readers count: a byte, a line, a record.
        place: String,
        /// What was found there.
        reason: String,
    },
    /// The format is read, but not this kind of it.
    #[error("this {format} holds {what}, which is not read; {remedy}")]
    Unsupported {
        /// The format's name.
        format: &'static str,
        /// What is not read.
        what: String,
        /// What to do.
        remedy: String,
    },
    /// The file does not say which system its coordinates are in, and its format has no default.
    #[error("this {format} {wanting}, so that its coordinate system is not known; say it with the key 'crs'")]
    NoCrs {
        /// The format's name.
        format: &'static str,
        /// What is not there.
        wanting: &'static str,
    },
    /// The file names a system that is not understood.
    #[error("its coordinate system cannot be used: {0}; or say the right one with the key 'crs'")]
    Crs(CrsError),
    /// Several layers, and none was asked for.
    #[error("it holds {count} layers; say which with 'layer': {found}")]
    WhichLayer {
        /// How many.
        count: usize,
        /// Their names, as many as fit.
        found: String,
        /// All their names.
        names: Vec<String>,
    },
    /// The layer that was asked for is not there.
    #[error("it has no layer '{wanted}'{meant}; its layers are {found}")]
    NoSuchLayer {
        /// What was asked for, shortened.
        wanted: String,
        /// `; did you mean 'roads'?`, or nothing.
        meant: String,
        /// The names of those that are there, as many as fit.
        found: String,
    },
    /// A format that is known but not read.
    #[error("this is {format}, which is not read; convert it: {command}")]
    OtherFormat {
        /// The format's name.
        format: &'static str,
        /// A command line that makes GeoJSON of it.
        command: String,
    },
    /// Nothing that is known.
    #[error(
        "neither its content nor its name says what format it is; GeoJSON is read, and ESRI shapefiles, GeoPackage, FlatGeobuf, GPX, KML, KMZ and OpenStreetMap (.osm, .osm.pbf)"
    )]
    UnknownFormat,
    /// The file's `crs` member is not understood.
    #[error("its \"crs\" member {found} is not understood; say which system it is in with the key 'crs'")]
    CrsMember {
        /// The member, shortened.
        found: String,
        /// Why the name is not understood, where it has one.
        #[source]
        source: Option<CrsError>,
    },
    /// Longitude and latitude out of range: most often meters in a file that names no system.
    #[error(
        "feature {feature} has a vertex at ({x}, {y}), which cannot be longitude and latitude in {crs}; if the file is in another system, say which with the key 'crs'"
    )]
    NotDegrees {
        /// Counts from 1, in the file's order.
        feature: usize,
        /// Longitude as read.
        x: f64,
        /// Latitude as read.
        y: f64,
        /// The system it was taken for.
        crs: String,
    },
}

impl VectorError {
    /// A [`VectorError::Broken`].
    pub(crate) fn broken(
        format: &'static str,
        place: impl std::fmt::Display,
        reason: impl Into<String>,
    ) -> Self {
        Self::Broken { format, place: place.to_string(), reason: reason.into() }
    }

    /// A [`VectorError::WhichLayer`] among `names`.
    pub(crate) fn which_layer(names: &[&str]) -> Self {
        let all = names.iter().map(|&name| name.to_owned()).collect();
        Self::WhichLayer { count: names.len(), found: listed(names), names: all }
    }

    /// A [`VectorError::NoSuchLayer`] among `names`; one that is most like it is proposed.
    pub(crate) fn no_such_layer(wanted: &str, names: &[&str]) -> Self {
        let meant = nearest(wanted, names.iter().copied()).map(|name| format!("; did you mean '{name}'?"));
        let wanted = wanted.chars().take(60).collect();
        Self::NoSuchLayer { wanted, meant: meant.unwrap_or_default(), found: listed(names) }
    }
}

/// The names, as many as fit, each shortened.
fn listed(names: &[&str]) -> String {
    if names.is_empty() {
        return "none".into();
    }
    let shown = names.iter().take(LAYERS_SHOWN).map(|name| name.chars().take(60).collect::<String>());
    let more = if names.len() > LAYERS_SHOWN { ", ..." } else { "" };
    shown.collect::<Vec<_>>().join(", ") + more
}
