//! Where a new scene and its data lie to each other.

use std::path::{Component, Path, PathBuf};

use crate::app::failure::CliError;

/// The folder of a new scene file.
pub(super) struct SceneFolder {
    /// Without links, whether it is there yet or not.
    folder: PathBuf,
}

impl SceneFolder {
    /// The folder at `path`, which need not be there.
    ///
    /// # Errors
    /// It has no name, or there is a file in its way.
    pub fn new(path: &Path) -> Result<Self, CliError> {
        let wrong = |reason: String| CliError::input(format!("{}: {reason}", path.display()));
        if path.exists() && !path.is_dir() {
            return Err(wrong("this is not a folder".into()));
        }
        let absolute = std::path::absolute(path).map_err(|error| wrong(error.to_string()))?;
        let there = absolute.ancestors().find_map(|above| Some((above, above.canonicalize().ok()?)));
        let (above, real) = there.ok_or_else(|| wrong("there is no such place".into()))?;
        let rest = absolute.strip_prefix(above).unwrap_or(Path::new(""));
        if rest.components().any(|part| part == Component::ParentDir) {
            return Err(wrong("name the folder without `..` in it".into()));
        }
        Ok(Self { folder: real.join(rest) })
    }

    /// What the scene file calls `file`: relative to its own folder, with `/`.
    ///
    /// # Errors
    /// There is no such file, or its name is not text.
    pub fn named(&self, file: &Path) -> Result<String, CliError> {
        let real = real(file)?;
        let shared = self.folder.components().zip(real.components()).take_while(|(a, b)| a == b).count();
        let up = self.folder.components().skip(shared).map(|_| "..");
        let down = real.components().skip(shared).map(|part| part.as_os_str().to_str());
        let parts: Option<Vec<&str>> = up.map(Some).chain(down).collect();
        let wrong =
            || CliError::input(format!("{}: its name is not Unicode text; rename it", file.display()));
        parts.map(|parts| parts.join("/")).ok_or_else(wrong)
    }

    /// The folders of those `files` that the scene may not read as it is: all that do not lie under the parent of its
    /// own. Sorted, none within another.
    ///
    /// # Errors
    /// There is no such file.
    pub fn to_allow<'f>(&self, files: impl Iterator<Item = &'f PathBuf>) -> Result<Vec<PathBuf>, CliError> {
        // As `Assets` has it: not where the parent is the root of the file system.
        let root = self.folder.parent().filter(|parent| parent.parent().is_some()).unwrap_or(&self.folder);
        let mut folders = Vec::new();
        for file in files {
            let real = real(file)?;
            if !real.starts_with(root) {
                folders.push(real.parent().unwrap_or(&real).to_path_buf());
            }
        }
        folders.sort();
        folders.dedup_by(|after, before| after.starts_with(before));
        Ok(folders)
    }
}

fn real(file: &Path) -> Result<PathBuf, CliError> {
    let wrong = |reason: &str| CliError::input(format!("{}: {reason}", file.display()));
    let real = file.canonicalize().map_err(|_| wrong("there is no such file"))?;
    if real.is_file() { Ok(real) } else { Err(wrong("this is not a file")) }
}

/// A command on the scene, as a shell reads it.
pub(super) fn command(verb: &str, scene: &Path, allow: &[PathBuf]) -> String {
    let allowed = allow.iter().map(|folder| format!(" --allow {}", shell(folder)));
    format!("sandtable {verb} {}{}", shell(scene), allowed.collect::<String>())
}

/// A path as a shell reads it.
fn shell(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+,:@%".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_a_space_or_a_quote_is_one_word_of_the_shell() {
        assert_eq!(shell(Path::new("a/b-1.toml")), "a/b-1.toml");
        assert_eq!(shell(Path::new("a b's")), "'a b'\\''s'");
    }

    #[test]
    fn folders_within_others_are_not_allowed_twice() {
        let mut folders = vec![PathBuf::from("/b"), "/a/x".into(), "/a".into(), "/ab".into()];
        folders.sort();
        folders.dedup_by(|after, before| after.starts_with(before));
        assert_eq!(folders, [Path::new("/a"), Path::new("/ab"), Path::new("/b")]);
    }
}
