//! Why a vector file cannot be read.

use crate::geom::crs::CrsError;

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
        "neither its content nor its name says what format it is; GeoJSON is read, which starts with '{{'"
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
    /// Longitude and latitude out of range: most often metres in a file that names no system.
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
