//! Errors of reading a model file.

use std::error::Error;
use std::sync::Arc;

use sandtable_base::limits::work_limit::WorkLimit;

/// Why a companion file cannot be loaded; its type depends on the [`Companions`](crate::Companions).
pub type CompanionError = Box<dyn Error + Send + Sync>;

/// Why the bytes of a model file do not become a [`crate::Model`].
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ModelError {
    #[error("model {name} is empty; export it again")]
    Empty { name: String },
    #[error(
        "{name} is not a model file: it starts with {start} and its extension is unknown; use 3DS (.3ds), \
         Wavefront OBJ (.obj), glTF (.gltf) or binary glTF (.glb)"
    )]
    Unknown {
        name: String,
        /// Its first bytes, in hexadecimal.
        start: String,
    },
    #[error("3DS file, byte {offset}: {reason}; export the model again")]
    ThreeDs { offset: usize, reason: String },
    #[error("OBJ file, line {line}: {reason}; correct the line or export the model again")]
    Obj {
        /// The line, from 1.
        line: usize,
        reason: String,
    },
    #[error("glTF file, {place}: {reason}")]
    Gltf {
        /// The place in the document, such as `accessors[3]`.
        place: String,
        reason: String,
    },
    #[error("glTF file, the JSON")]
    GltfJson(#[source] serde_json::Error),
    #[error("glTF file, buffers[{index}]")]
    GltfBuffer {
        index: usize,
        #[source]
        source: Arc<GltfDataError>,
    },
    #[error("the model has more than {limit} {what}; simplify it before you use it in a scene, or {limit:#}")]
    TooLarge {
        what: &'static str,
        /// The limit.
        limit: &'static WorkLimit,
    },
}

impl ModelError {
    /// An error in a 3DS file.
    pub(super) fn three_ds(offset: usize, reason: impl Into<String>) -> Self {
        Self::ThreeDs { offset, reason: reason.into() }
    }

    pub(super) fn gltf(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Gltf { place: place.into(), reason: reason.into() }
    }
}

/// Why the bytes of a glTF buffer or image cannot be loaded.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum GltfDataError {
    #[error("it has neither a uri nor bytes in the file")]
    NoSource,
    #[error("its data URI has no comma")]
    NoComma,
    #[error("its data URI has the character '{0}', which is not base64")]
    NotBase64(char),
    #[error("'{0}' is not a file beside the model")]
    NotRelative(String),
    #[error("'{0}' is not UTF-8")]
    NotUtf8(String),
    #[error("its file '{uri}' cannot be loaded")]
    Companion {
        uri: String,
        #[source]
        source: CompanionError,
    },
    #[error("{actual} of {stated} bytes are there")]
    TooShort {
        stated: u64,
        /// The length of the bytes.
        actual: usize,
    },
}
