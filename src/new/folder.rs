//! The folder of a new scene file, and where the scene's data lies relative to it.

use std::path::{Component, Path, PathBuf};

use sandtable_files::disk::SystemError;
use sandtable_files::error::FileError;
use sandtable_remote::address::is_address;

/// The folder of a new scene file.
pub(super) struct SceneFolder {
    /// Without links, whether it exists or not.
    folder: PathBuf,
}

/// A folder or a file that a new scene cannot use.
pub type FolderError = FileError<FolderCause>;

/// Why a new scene cannot use a folder or a file.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum FolderCause {
    #[error("this is not a folder")]
    NotAFolder,
    #[error("name the folder without `..` in it")]
    Parent,
    #[error("there is no such place")]
    Nowhere,
    #[error("there is no such file")]
    NoFile,
    #[error("this is not a file")]
    NotAFile,
    #[error("its name is not Unicode text; rename it")]
    NotText,
    #[error(transparent)]
    System(#[from] SystemError),
}

impl SceneFolder {
    /// The folder at `path`, which need not exist.
    ///
    /// # Errors
    /// See [`FolderCause`].
    pub fn new(path: &Path) -> Result<Self, FolderError> {
        if path.exists() && !path.is_dir() {
            return Err(FileError::new(path, FolderCause::NotAFolder));
        }
        let absolute =
            std::path::absolute(path).map_err(|error| FileError::new(path, SystemError::from(error)))?;
        let existing = absolute.ancestors().find_map(|above| Some((above, above.canonicalize().ok()?)));
        let (above, real) = existing.ok_or_else(|| FileError::new(path, FolderCause::Nowhere))?;
        let rest = absolute.strip_prefix(above).unwrap_or(Path::new(""));
        if rest.components().any(|part| part == Component::ParentDir) {
            return Err(FileError::new(path, FolderCause::Parent));
        }
        Ok(Self { folder: real.join(rest) })
    }

    /// The name of a file in the scene file: relative to its folder, with `/`, or its address.
    ///
    /// # Errors
    /// See [`FolderCause`].
    pub fn name_of(&self, file: &Path) -> Result<String, FolderError> {
        let address = file.to_str().filter(|name| is_address(name));
        address.map_or_else(|| self.relative(file), |address| Ok(address.to_owned()))
    }

    fn relative(&self, file: &Path) -> Result<String, FolderError> {
        let real = real(file)?;
        let shared = self.folder.components().zip(real.components()).take_while(|(a, b)| a == b).count();
        let up = self.folder.components().skip(shared).map(|_| Some(".."));
        let down = real.components().skip(shared).map(|part| part.as_os_str().to_str());
        let parts: Option<Vec<&str>> = up.chain(down).collect();
        parts.map(|parts| parts.join("/")).ok_or_else(|| FileError::new(file, FolderCause::NotText))
    }

    /// The folders of those `files` that do not lie under the parent of the scene's folder, so that the user must allow
    /// them. Sorted, none within another.
    ///
    /// # Errors
    /// See [`FolderCause`].
    pub fn folders_to_allow<'f>(
        &self,
        files: impl Iterator<Item = &'f PathBuf>,
    ) -> Result<Vec<PathBuf>, FolderError> {
        // As in `Assets`: the root of the file system is not a parent.
        let root = self.folder.parent().filter(|parent| parent.parent().is_some()).unwrap_or(&self.folder);
        let mut folders = Vec::new();
        for file in files {
            let real = real(file)?;
            if !real.starts_with(root) {
                folders.push(real.parent().unwrap_or(&real).to_path_buf());
            }
        }
        Ok(outermost(folders))
    }
}

/// The folders sorted, without those within others.
fn outermost(mut folders: Vec<PathBuf>) -> Vec<PathBuf> {
    folders.sort();
    folders.dedup_by(|after, before| after.starts_with(before));
    folders
}

fn real(file: &Path) -> Result<PathBuf, FolderError> {
    let real = file.canonicalize().map_err(|_| FileError::new(file, FolderCause::NoFile))?;
    if real.is_file() { Ok(real) } else { Err(FileError::new(file, FolderCause::NotAFile)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_within_others_are_not_allowed_twice() {
        let folders = vec![PathBuf::from("/b"), "/a/x".into(), "/a".into(), "/ab".into()];
        assert_eq!(outermost(folders), [Path::new("/a"), Path::new("/ab"), Path::new("/b")]);
    }
}
