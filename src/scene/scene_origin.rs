//! What a scene is made of: its file or its text, and what it may read.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::assets::Assets;
use crate::given_data::GivenData;
use crate::scene_file::OpenSceneError;
use sandtable_description::document::Document;
use sandtable_description::parse::parse_in_phase;
use sandtable_files::disk;

/// Where a scene comes from. It may be read any number of times.
#[derive(Clone, Debug)]
pub struct SceneOrigin {
    /// The scene file; of a text the path that its relative names start from, and that messages show.
    pub path: PathBuf,
    /// The text of a scene that has no file.
    pub text: Option<Arc<str>>,
    /// Folders that it may read besides the parent of its own.
    pub allowed: Vec<PathBuf>,
    /// Data in memory that it names.
    pub given: GivenData,
}

impl SceneOrigin {
    /// The scene file at `path`, which may read the folders `allowed` besides the parent of its own.
    pub fn file(path: &Path, allowed: &[PathBuf]) -> Self {
        Self { path: path.to_owned(), text: None, allowed: allowed.to_vec(), given: GivenData::default() }
    }

    /// A scene that has no file, of the text `text`; it reads files as one at `path` would.
    pub fn text(path: &Path, text: &str, allowed: &[PathBuf]) -> Self {
        Self { text: Some(text.into()), ..Self::file(path, allowed) }
    }

    /// Reads and parses it; files that it includes are read, those of its features are not.
    ///
    /// # Errors
    /// See [`OpenSceneError`].
    pub fn document(&self, phase: Option<&str>) -> Result<(Document, Assets), OpenSceneError> {
        let read;
        let bytes = match &self.text {
            Some(text) => text.as_bytes(),
            None => {
                read = disk::read(&self.path)?;
                &read
            }
        };
        let assets = Assets::new(&self.path, &self.allowed)?.with_given(self.given.clone());
        let load = |name: &str| assets.read(name).map_err(Into::into);
        let document = parse_in_phase(&self.path.to_string_lossy(), bytes, &load, phase)?;
        Ok((document, assets))
    }
}
