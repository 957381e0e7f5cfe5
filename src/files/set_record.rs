//! The record of files that appear together, so that a program that is killed between them leaves them whole.
//!
//! Files of one set get their names one after the other, and `kill -9` or a power cut may come between. So which parts become
//! which names is written down and on the disk before the first of them does, in each folder that gets some of them:
//!
//! ```text
//!  parts whole, on the disk ──► record whole, on the disk ──► names given ──► record removed
//!                           │                             │               │
//!    killed until here, nothing happened:       killed from here on, the next program that
//!    the next program removes the parts         writes into the folder gives the remaining names
//! ```
//!
//! A set in several folders is completed in each when something is written there next.
//!
//! A folder may be anyone's, so a record is held against what is there: it moves only parts of its own process number, of
//! the user who runs the program, without a living writer, to plain names in the same folder.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use crate::part_name::{PartName, PartRole};

/// How a record begins and ends; between are the names of a part and of its file, in turns, with zeros between all.
const HEAD: &[u8] = b"sandtable set 1";
const END: &[u8] = b"end";

/// The longest record that is read: some thousand files.
const MOST_BYTES: u64 = 1 << 20;

/// The records of a set that is being published, one a folder; removed when dropped.
#[derive(Debug)]
pub struct SetRecords(Vec<(PathBuf, File)>);

impl SetRecords {
    /// Writes the records of parts, each with the path that it becomes, under names of this process with numbers from
    /// `next_number` on.
    ///
    /// # Errors
    /// The folder whose record cannot be written, and why.
    pub fn write<'a>(
        parts: impl Iterator<Item = (&'a Path, &'a Path)>,
        next_number: &mut u64,
    ) -> Result<Self, (PathBuf, io::Error)> {
        let mut folders: BTreeMap<&Path, Vec<u8>> = BTreeMap::new();
        for (part, path) in parts {
            let folder = path.parent().unwrap_or(Path::new(""));
            let (Some(part), Some(name)) =
                (part.file_name().and_then(bytes_of), path.file_name().and_then(bytes_of))
            else {
                continue;
            };
            let record = folders.entry(folder).or_insert_with(|| [HEAD, b"\0"].concat());
            record.extend([part, b"\0", name, b"\0"].concat());
        }
        let mut records = Self(Vec::new());
        for (folder, mut content) in folders {
            content.extend(END);
            records.add(folder, &content, next_number).map_err(|error| (folder.to_owned(), error))?;
        }
        Ok(records)
    }

    fn add(&mut self, folder: &Path, content: &[u8], next_number: &mut u64) -> io::Result<()> {
        loop {
            let name = PartName { process: std::process::id(), number: *next_number, role: PartRole::Record };
            *next_number += 1;
            let path = folder.join(name.to_string());
            let mut file = match File::options().read(true).write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => continue,
                opened => opened?,
            };
            // Where the file system has no locks, nobody takes it for the record of a dead program either.
            let _ = file.lock();
            self.0.push((path, file.try_clone()?));
            file.write_all(content)?;
            file.sync_all()?;
            return sync_folder(folder);
        }
    }
}

impl Drop for SetRecords {
    fn drop(&mut self) {
        for (path, _) in &self.0 {
            let _ = fs::remove_file(path);
        }
    }
}

/// Lets the names in a folder reach the disk, where its file system can.
fn sync_folder(folder: &Path) -> io::Result<()> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded) => {
            Err(error)
        }
        _ => Ok(()),
    }
}

/// Completes the sets in `folder` whose writers are gone, as far as `mine`, a file of this process in it, has the same owner.
/// `own` are the files that this process writes there.
pub fn complete(folder: &Path, own: &BTreeSet<PathBuf>, mine: &File) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let (path, name) = (entry.path(), PartName::parse(&entry.file_name()));
        let Some(name) = name.filter(|name| name.role == PartRole::Record && !own.contains(&path)) else {
            continue;
        };
        // Where it is another's, or its writer lives, it stays.
        let _ = complete_one(folder, &path, name, own, mine);
    }
}

fn complete_one(
    folder: &Path,
    path: &Path,
    name: PartName,
    own: &BTreeSet<PathBuf>,
    mine: &File,
) -> io::Result<()> {
    let record = open_abandoned(path, mine)?;
    let mut content = Vec::new();
    (&record).take(MOST_BYTES + 1).read_to_end(&mut content)?;
    let mut moves = Vec::new();
    for (part, to) in parse(&content).unwrap_or_default() {
        let is_of_record = PartName::parse(&part)
            .is_some_and(|part| part.role == PartRole::Part && part.process == name.process);
        let from = folder.join(&part);
        if !is_of_record || PartName::parse(&to).is_some() || own.contains(&from) {
            continue;
        }
        match open_abandoned(&from, mine) {
            Ok(held) => moves.push((held, from, folder.join(&to))),
            // Its writer lives, under a process number that came back: the record is not its own.
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Err(error),
            // It has its name already, or is no part.
            Err(_) => {}
        }
    }
    for (_, from, to) in &moves {
        let _ = fs::rename(from, to);
    }
    fs::remove_file(path)
}

/// A plain file of the owner of `mine` that no living writer holds, locked for this process.
fn open_abandoned(path: &Path, mine: &File) -> io::Result<File> {
    if !fs::symlink_metadata(path)?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let file = File::open(path)?;
    if !have_one_owner(&file, mine)? {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    file.try_lock()?;
    Ok(file)
}

#[cfg(unix)]
fn have_one_owner(one: &File, other: &File) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    Ok(one.metadata()?.uid() == other.metadata()?.uid())
}

#[cfg(not(unix))]
fn have_one_owner(_: &File, _: &File) -> io::Result<bool> {
    Ok(true)
}

/// Whether a record of the process that writes the part at `path` is there: then the part may be one of a set that is yet to
/// be completed.
pub fn has_record(path: &Path, part: PartName) -> bool {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_of_process = |name: OsString| {
        PartName::parse(&name)
            .is_some_and(|name| name.role == PartRole::Record && name.process == part.process)
    };
    fs::read_dir(folder).is_ok_and(|mut entries| {
        entries.any(|entry| entry.is_ok_and(|entry| is_of_process(entry.file_name())))
    })
}

/// The parts and the names in a whole record; names that are not plain ones of a folder are left out. `None` where it is not
/// whole: then no part was moved.
fn parse(content: &[u8]) -> Option<Vec<(OsString, OsString)>> {
    let fields: Vec<&[u8]> = content.split(|&byte| byte == 0).collect();
    let [HEAD, pairs @ .., END] = &fields[..] else { return None };
    if !pairs.len().is_multiple_of(2) {
        return None;
    }
    let plain = |bytes: &[u8]| name_of(bytes).filter(|name| is_plain(name));
    let pair = |pair: &[&[u8]]| Some((plain(pair[0])?, plain(pair[1])?));
    Some(pairs.chunks_exact(2).filter_map(pair).collect())
}

/// Whether a name is that of a file in a folder, whatever the system.
fn is_plain(name: &OsStr) -> bool {
    let path = Path::new(name);
    path.file_name() == Some(name) && !name.as_encoded_bytes().contains(&b'\\')
}

#[cfg(unix)]
fn bytes_of(name: &OsStr) -> Option<&[u8]> {
    Some(name.as_encoded_bytes())
}

#[cfg(unix)]
fn name_of(bytes: &[u8]) -> Option<OsString> {
    use std::os::unix::ffi::OsStringExt;
    Some(OsString::from_vec(bytes.to_vec()))
}

/// Names that are not Unicode are not recorded.
#[cfg(not(unix))]
fn bytes_of(name: &OsStr) -> Option<&[u8]> {
    name.to_str().map(str::as_bytes)
}

#[cfg(not(unix))]
fn name_of(bytes: &[u8]) -> Option<OsString> {
    std::str::from_utf8(bytes).ok().map(OsString::from)
}
