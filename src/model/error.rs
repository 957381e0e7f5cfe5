//! Why a model file cannot be read.

use std::error::Error;
use std::sync::Arc;

/// Why a companion file cannot be loaded; what it is depends on where companions come from.
pub type CompanionError = Box<dyn Error + Send + Sync>;

/// Why the bytes of a model file do not become a [`crate::model::Model`].
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file has no bytes.
    #[error("model {name} is empty; export it again")]
    Empty {
        /// The file's name.
        name: String,
    },
    /// Neither the content nor the extension is that of a known format.
    #[error(
        "{name} is not a model file: it starts with {start} and its extension is unknown; use 3DS (.3ds), \
         Wavefront OBJ (.obj), glTF (.gltf) or binary glTF (.glb)"
    )]
    Unknown {
        /// The file's name.
        name: String,
        /// Its first bytes, in hexadecimal.
        start: String,
    },
    /// A 3DS file breaks its format.
    #[error("3DS file, byte {offset}: {reason}; export the model again")]
    ThreeDs {
        /// The place in the file.
        offset: usize,
        /// What was found.
        reason: String,
    },
    /// An OBJ file breaks its format.
    #[error("OBJ file, line {line}: {reason}; correct the line or export the model again")]
    Obj {
        /// The line, from 1.
        line: usize,
        /// What was found.
        reason: String,
    },
    /// A glTF file breaks its format or needs what is not supported.
    #[error("glTF file, {place}: {reason}")]
    Gltf {
        /// The place in the document, such as `accessors[3]`.
        place: String,
        /// What was found and what to do.
        reason: String,
    },
    /// The JSON of a glTF file is broken.
    #[error("glTF file, the JSON")]
    GltfJson(#[source] serde_json::Error),
    /// A buffer of a glTF file cannot be loaded.
    #[error("glTF file, buffers[{index}]")]
    GltfBuffer {
        /// The buffer.
        index: usize,
        /// The cause.
        #[source]
        source: Arc<GltfDataError>,
    },
    /// The model exceeds a limit that bounds time and memory.
    #[error("the model has more than {limit} {what}; simplify it before you use it in a scene")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: usize,
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

/// Why the bytes of a glTF buffer or image cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum GltfDataError {
    /// It is neither in the file nor named by a URI.
    #[error("it has neither a uri nor bytes in the file")]
    NoSource,
    /// A data URI without a comma.
    #[error("its data URI has no comma")]
    NoComma,
    /// A data URI with a character that base64 does not use.
    #[error("its data URI has the character '{0}', which is not base64")]
    NotBase64(char),
    /// A URI that is not relative.
    #[error("'{0}' is not a file beside the model")]
    NotRelative(String),
    /// A URI that decodes to bytes that are not UTF-8.
    #[error("'{0}' is not UTF-8")]
    NotUtf8(String),
    /// The file of a URI cannot be loaded.
    #[error("its file '{uri}' cannot be loaded")]
    Companion {
        /// The URI.
        uri: String,
        /// The cause.
        #[source]
        source: CompanionError,
    },
    /// The buffer is shorter than the document says.
    #[error("{actual} of {stated} bytes are there")]
    TooShort {
        /// The length in the document.
        stated: u64,
        /// The length of the bytes.
        actual: usize,
    },
}

/// `error` and its causes in one line, as notes and messages show them.
pub fn error_chain(error: &(dyn Error + 'static)) -> String {
    let chain = std::iter::successors(Some(error), |&error| error.source());
    chain.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}
