//! The files opened last, kept in the user's folder of settings.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

/// How many files are kept; more would not be looked through.
const KEPT: usize = 12;
/// The most bytes read of the list: far more than twelve paths have.
const LONGEST: u64 = 64 << 10;

/// The files opened last, the newest first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecentFiles {
    /// Absolute paths.
    pub paths: Vec<PathBuf>,
    file: Option<PathBuf>,
}

impl RecentFiles {
    /// The list of this user; an empty one where there is none, and where the system has no folder for settings.
    pub fn of_user() -> Self {
        settings_folder().map_or_else(Self::default, |folder| Self::in_file(&folder.join("recent")))
    }

    /// The list in `file`, which need not be there.
    pub fn in_file(file: &Path) -> Self {
        let is_short = fs::metadata(file).is_ok_and(|metadata| metadata.len() <= LONGEST);
        let text = if is_short { fs::read_to_string(file).unwrap_or_default() } else { String::new() };
        let paths = text.lines().filter(|line| !line.is_empty()).take(KEPT).map(PathBuf::from).collect();
        Self { paths, file: Some(file.to_owned()) }
    }

    /// Puts a file first. The list is written on a best effort: a window works without it.
    pub fn add(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        if path.to_string_lossy().contains('\n') {
            return;
        }
        self.paths.retain(|other| *other != path);
        self.paths.insert(0, path);
        self.paths.truncate(KEPT);
        if let Some(file) = &self.file {
            let lines: String = self.paths.iter().map(|path| format!("{}\n", path.display())).collect();
            if let Some(folder) = file.parent() {
                let _ = fs::create_dir_all(folder);
            }
            let _ = fs::write(file, lines);
        }
    }
}

/// Where programs keep settings: `$XDG_CONFIG_HOME`, `%APPDATA%` or `~/.config`, each with `sandtable` below it.
fn settings_folder() -> Option<PathBuf> {
    let folder = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let base = folder("XDG_CONFIG_HOME").or_else(|| folder("APPDATA"));
    let base = base.or_else(|| Some(folder("HOME")?.join(".config")))?;
    Some(base.join("sandtable"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_file_comes_first_once_and_the_list_outlives_the_window() {
        let folder = env::temp_dir().join(format!("sandtable-recent-{}", std::process::id()));
        let file = folder.join("deep/recent");
        let mut recent = RecentFiles::in_file(&file);
        assert!(recent.paths.is_empty());
        for number in 0..20 {
            recent.add(Path::new(&format!("/scenes/{number}.toml")));
        }
        recent.add(Path::new("/scenes/15.toml"));
        let again = RecentFiles::in_file(&file);
        fs::remove_dir_all(folder).ok();
        assert_eq!(again.paths.len(), KEPT);
        assert_eq!(again.paths[..2], [PathBuf::from("/scenes/15.toml"), PathBuf::from("/scenes/19.toml")]);
    }
}
