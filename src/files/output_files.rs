//! Writing files: one, or several that belong together, whole or not at all.
//!
//! Each is written as a [part](crate::part_file) beside its place. When all are whole and on the disk, they get
//! their names, one right after the other. An error or a signal before that leaves what was there before; so does
//! `kill -9`. Between the first name and the last it leaves a record, by which the next program
//! that writes into the folder gives the remaining names.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::disk::{SystemError, WriteFileCause, WriteFileError};
use crate::part_file::{self, PartFile};
use crate::synced_file::SyncedFile;

/// The longest chain of links that is followed, as in Linux.
const MOST_LINKS: usize = 40;

/// Files that are written but not published yet; dropping this removes them.
#[derive(Debug, Default)]
pub struct OutputFiles {
    parts: Vec<(PartFile, PathBuf)>,
}

impl OutputFiles {
    /// Writes `bytes` for the file at `path`.
    ///
    /// # Errors
    /// The system refuses.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), WriteFileError> {
        self.write_with(path, |out| out.write_all(bytes))
    }

    /// [`OutputFiles::write`] for content that is made while it is written.
    ///
    /// # Errors
    /// The system or `content` fails.
    pub fn write_with(
        &mut self,
        path: &Path,
        content: impl FnOnce(&mut BufWriter<SyncedFile<'_>>) -> io::Result<()>,
    ) -> Result<(), WriteFileError> {
        let failed = |error: io::Error| WriteFileError::new(path, SystemError::from(error));
        let place = followed(path).map_err(failed)?;
        if place.file_name().is_none() {
            return Err(WriteFileError::new(path, WriteFileCause::NoName));
        }
        let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty());
        let part = PartFile::create(folder.unwrap_or(Path::new("."))).map_err(failed)?;
        let fill = || {
            let mut out = BufWriter::new(SyncedFile::new(part.file()));
            content(&mut out)?;
            out.into_inner()?.finish()?;
            // A file that is replaced keeps who may read it.
            if let Ok(before) = fs::metadata(&place) {
                part.file().set_permissions(before.permissions())?;
            }
            part.file().sync_all()
        };
        fill().map_err(failed)?;
        self.parts.push((part, place));
        Ok(())
    }

    /// Puts all files in their places; where one cannot be put there, none is.
    ///
    /// # Errors
    /// The system refuses.
    pub fn publish(self) -> Result<(), WriteFileError> {
        part_file::publish(self.parts)
            .map_err(|(path, error)| WriteFileError::new(&path, SystemError::from(error)))
    }
}

/// Where a file written to `path` lies: links are followed, also one to a file that is not there yet.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = path.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::other("its links lead nowhere"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own with `old` in `a` and `b`.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("sandtable-output-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        for name in ["a", "b"] {
            fs::write(folder.join(name), "old").expect("written");
        }
        folder
    }

    fn contents(folder: &Path) -> Vec<(String, String)> {
        let entries = fs::read_dir(folder).expect("a folder");
        let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
        let read = |name: String| {
            let text = fs::read_to_string(folder.join(&name)).unwrap_or_else(|_| "a folder".into());
            (name, text)
        };
        let mut all: Vec<(String, String)> = names.map(read).collect();
        all.sort();
        all
    }

    fn named(pairs: &[(&str, &str)]) -> Vec<(String, String)> {
        pairs.iter().map(|&(name, text)| (name.into(), text.into())).collect()
    }

    #[test]
    fn files_appear_together_and_dropped_ones_leave_nothing() {
        let folder = folder("together");
        let mut files = OutputFiles::default();
        for name in ["a", "c"] {
            files.write(&folder.join(name), b"new").expect("written");
        }
        assert_eq!(fs::read_to_string(folder.join("a")).expect("there"), "old");
        assert!(!folder.join("c").exists());
        drop(files);
        assert_eq!(contents(&folder), named(&[("a", "old"), ("b", "old")]));
        let mut files = OutputFiles::default();
        for name in ["a", "c"] {
            files.write(&folder.join(name), b"new").expect("written");
        }
        files.publish().expect("published");
        assert_eq!(contents(&folder), named(&[("a", "new"), ("b", "old"), ("c", "new")]));
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn where_one_file_cannot_be_put_in_its_place_all_stay_as_they_were() {
        let folder = folder("rollback");
        let mut files = OutputFiles::default();
        for name in ["a", "c", "d"] {
            files.write(&folder.join(name), b"new").expect("written");
        }
        fs::create_dir(folder.join("d")).expect("a folder in the way");
        assert_eq!(files.publish().expect_err("refused").path, folder.join("d"));
        assert_eq!(contents(&folder), named(&[("a", "old"), ("b", "old"), ("d", "a folder")]));
        fs::remove_dir_all(folder).expect("removed");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_followed_and_permissions_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = folder("link");
        symlink("a", folder.join("near")).expect("a link");
        symlink("near", folder.join("far")).expect("a link");
        symlink("not-yet", folder.join("dangling")).expect("a link");
        symlink("round", folder.join("round")).expect("a link");
        fs::set_permissions(folder.join("a"), fs::Permissions::from_mode(0o600)).expect("set");
        let write = |name: &str| {
            let mut files = OutputFiles::default();
            files.write(&folder.join(name), b"new").and_then(|()| files.publish())
        };
        write("far").expect("written");
        write("dangling").expect("written");
        assert!(write("round").is_err());
        let is_link = |name: &str| fs::symlink_metadata(folder.join(name)).expect("there").is_symlink();
        assert!(is_link("far") && is_link("near") && is_link("dangling"));
        let text = |name: &str| fs::read_to_string(folder.join(name)).expect("there");
        assert_eq!((text("a"), text("not-yet")), ("new".into(), "new".into()));
        assert_eq!(fs::metadata(folder.join("a")).expect("there").permissions().mode() & 0o777, 0o600);
        fs::remove_dir_all(folder).expect("removed");
    }
}
