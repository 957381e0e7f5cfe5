//! Why a model cannot be read.

/// Why the bytes of a model file do not become a [`crate::model::Model`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The file holds nothing.
    #[error("model {name} is empty; export it again")]
    Empty {
        /// The file's name.
        name: String,
    },
    /// Neither the content nor the extension says what it is.
    #[error(
        "{name} is no model file that can be read: it starts with {start} and its extension says nothing; \
         3DS (.3ds), Wavefront OBJ (.obj), glTF (.gltf) and binary glTF (.glb) can"
    )]
    Unknown {
        /// The file's name.
        name: String,
        /// Its first bytes, in hexadecimal.
        start: String,
    },
    /// A 3DS file breaks its own format.
    #[error("3DS file, byte {offset}: {reason}; export the model again")]
    ThreeDs {
        /// Where in the file.
        offset: usize,
        /// What was found.
        reason: String,
    },
    /// An OBJ file breaks its own format.
    #[error("OBJ file, line {line}: {reason}; correct the line or export the model again")]
    Obj {
        /// The line, from 1.
        line: usize,
        /// What was found.
        reason: String,
    },
    /// A glTF file breaks its own format or needs what is not supported.
    #[error("glTF file, {place}: {reason}")]
    Gltf {
        /// Where in the document, such as `accessors[3]`.
        place: String,
        /// What was found and what to do.
        reason: String,
    },
    /// More than a picture can use.
    #[error("the model has more than {limit} {what}; simplify it before it is set in a scene")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// The most there may be.
        limit: usize,
    },
}

impl ModelError {
    /// A fault of a 3DS file.
    pub(super) fn three_ds(offset: usize, reason: impl Into<String>) -> Self {
        Self::ThreeDs { offset, reason: reason.into() }
    }

    /// A fault of an OBJ file.
    pub(super) fn obj(line: usize, reason: impl Into<String>) -> Self {
        Self::Obj { line, reason: reason.into() }
    }

    /// A fault of a glTF file.
    pub(super) fn gltf(place: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Gltf { place: place.into(), reason: reason.into() }
    }
}
