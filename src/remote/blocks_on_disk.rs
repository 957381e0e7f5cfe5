//! Blocks of remote files on disk, for later runs: as many as a limit allows, the oldest removed first.
//!
//! ```text
//! <folder>/<file, 32 digits>/<first block>-<blocks>      SHA-256 of what follows and of what it is, then the bytes
//! ```
//!
//! The name of a file's folder is made of its address and version, so that another version is another folder. A part is written
//! beside and renamed; one that is cut short, damaged or of another file does not have its own hash, and is read anew. Several
//! programs may use a folder at once: what one removes another reads anew.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use sha2::{Digest, Sha256};

use sandtable_base::limits::REMOTE_DISK_BYTES;

/// Bytes of a hash before a part.
const HASH_BYTES: usize = 32;

/// Bytes that are written before the folder is looked through again.
const WRITTEN_BEFORE_REMOVAL: u64 = 32 << 20;

/// The blocks of one version of a file.
#[derive(Debug)]
pub(crate) struct BlocksOnDisk {
    /// Of all files.
    root: PathBuf,
    /// Of this one.
    folder: PathBuf,
    name: String,
    most_bytes: u64,
    /// How many blocks the parts have, by their first.
    parts: BTreeMap<u64, u64>,
    /// Bytes that were written since the folder was looked through.
    written: u64,
}

impl BlocksOnDisk {
    /// The blocks of the file at `address` in a version, in the folder of all.
    pub fn new(root: &Path, address: &str, version: &str) -> Self {
        Self::with_limit(root, address, version, REMOTE_DISK_BYTES.get())
    }

    fn with_limit(root: &Path, address: &str, version: &str, most_bytes: u64) -> Self {
        let mut hash = Sha256::new();
        hash.update((address.len() as u64).to_le_bytes());
        hash.update(address);
        hash.update(version);
        let name: String = hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        let folder = root.join(&name);
        let parts = fs::read_dir(&folder)
            .map(|entries| entries.filter_map(|entry| part_of(entry.ok()?.file_name().to_str()?)).collect())
            .unwrap_or_default();
        Self { root: root.to_owned(), folder, name, most_bytes, parts, written: WRITTEN_BEFORE_REMOVAL }
    }

    /// The first block and the bytes of the part that holds a block; `None` where none does. `bytes_of` is how many bytes so
    /// many blocks from a first one have.
    pub fn part_with(&mut self, block: u64, bytes_of: impl Fn(u64, u64) -> u64) -> Option<(u64, Vec<u8>)> {
        let (&first, &count) =
            self.parts.range(..=block).next_back().filter(|(first, count)| block - **first < **count)?;
        let path = self.folder.join(part_name(first, count));
        let wanted = bytes_of(first, count) + HASH_BYTES as u64;
        let is_whole = fs::metadata(&path).is_ok_and(|about| about.is_file() && about.len() == wanted);
        let found = is_whole.then(|| fs::read(&path).ok()).flatten();
        let sound = found.and_then(|mut all| {
            let bytes = all.split_off(all.len().min(HASH_BYTES));
            (bytes.len() as u64 + HASH_BYTES as u64 == wanted && all == self.hash(first, &bytes))
                .then_some(bytes)
        });
        if sound.is_none() {
            self.parts.remove(&first);
            let _ = fs::remove_file(path);
        }
        sound.map(|bytes| (first, bytes))
    }

    /// Keeps blocks from `first` on, as far as the disk allows that: where it does not, they are read again.
    pub fn keep(&mut self, first: u64, count: u64, bytes: &[u8]) {
        if bytes.len() as u64 > self.most_bytes / 4 || self.write(first, count, bytes).is_err() {
            return;
        }
        self.parts.insert(first, count);
        self.written += bytes.len() as u64;
        if self.written >= WRITTEN_BEFORE_REMOVAL.min(self.most_bytes / 4) {
            self.written = 0;
            remove_oldest(&self.root, self.most_bytes);
        }
    }

    fn write(&self, first: u64, count: u64, bytes: &[u8]) -> io::Result<()> {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        make_private(&self.folder)?;
        let beside = format!(".{}-{}.part", process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let beside = self.folder.join(beside);
        let written = fs::File::create_new(&beside).and_then(|mut file| {
            file.write_all(&self.hash(first, bytes))?;
            file.write_all(bytes)
        });
        let done = written.and_then(|()| fs::rename(&beside, self.folder.join(part_name(first, count))));
        if done.is_err() {
            let _ = fs::remove_file(&beside);
        }
        done
    }

    fn hash(&self, first: u64, bytes: &[u8]) -> Vec<u8> {
        let mut hash = Sha256::new();
        hash.update(&self.name);
        hash.update(first.to_le_bytes());
        hash.update(bytes);
        hash.finalize().to_vec()
    }
}

/// Makes a folder that other users do not read: what is read by credentials is not for all.
fn make_private(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

fn part_name(first: u64, count: u64) -> String {
    format!("{first:x}-{count:x}")
}

/// The first block and the number of blocks of a part, by its name.
fn part_of(name: &str) -> Option<(u64, u64)> {
    let (first, count) = name.split_once('-')?;
    Some((u64::from_str_radix(first, 16).ok()?, u64::from_str_radix(count, 16).ok()?))
        .filter(|(first, count)| *count > 0 && first.checked_add(*count).is_some())
}

/// Removes the oldest parts until at most `most_bytes` are left. Other programs do the same at the same time.
fn remove_oldest(root: &Path, most_bytes: u64) {
    let entries =
        |folder: &Path| fs::read_dir(folder).map(|all| all.flatten().collect::<Vec<_>>()).unwrap_or_default();
    let mut parts: Vec<(SystemTime, PathBuf, u64)> = Vec::new();
    for folder in entries(root) {
        for part in entries(&folder.path()) {
            if let Ok(about) = part.metadata().and_then(|about| Ok((about.modified()?, about.len()))) {
                parts.push((about.0, part.path(), about.1));
            }
        }
    }
    let mut total: u64 = parts.iter().map(|(_, _, bytes)| bytes).sum();
    parts.sort();
    for (_, path, bytes) in parts {
        if total <= most_bytes {
            return;
        }
        total -= bytes;
        let _ = fs::remove_file(&path);
        // Only an empty folder is removed.
        let _ = path.parent().map(fs::remove_dir);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct TestFolder(PathBuf);

    impl TestFolder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("sandtable-blocks-{name}-{}", process::id()));
            let _ = fs::remove_dir_all(&folder);
            Self(folder)
        }

        fn parts(&self) -> Vec<PathBuf> {
            let folders =
                fs::read_dir(&self.0).map(|all| all.flatten().collect()).unwrap_or_else(|_| Vec::new());
            let mut parts: Vec<PathBuf> = folders
                .iter()
                .flat_map(|folder| fs::read_dir(folder.path()).expect("readable"))
                .map(|part| part.expect("readable").path())
                .collect();
            parts.sort();
            parts
        }
    }

    impl Drop for TestFolder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn blocks(folder: &TestFolder, version: &str) -> BlocksOnDisk {
        BlocksOnDisk::with_limit(&folder.0, "s3://b/a.tif", version, 1 << 20)
    }

    fn tens(_: u64, count: u64) -> u64 {
        10 * count
    }

    #[test]
    fn what_is_kept_is_there_for_the_next_program() {
        let folder = TestFolder::new("kept");
        blocks(&folder, "1").keep(3, 2, &[7; 20]);
        let mut later = blocks(&folder, "1");
        assert_eq!(later.part_with(4, tens), Some((3, vec![7; 20])));
        assert_eq!(later.part_with(5, tens), None);
        assert_eq!(later.part_with(2, tens), None);
        assert_eq!(blocks(&folder, "2").part_with(3, tens), None);
    }

    #[test]
    fn a_damaged_or_cut_part_is_not_believed() {
        let folder = TestFolder::new("damaged");
        let original = {
            blocks(&folder, "1").keep(0, 2, &[7; 20]);
            fs::read(&folder.parts()[0]).expect("readable")
        };
        let damages: [fn(&mut Vec<u8>); 4] =
            [|all| all[0] ^= 1, |all| all[45] ^= 1, |all| all.truncate(51), |all| all.push(0)];
        for damage in damages {
            let mut bytes = original.clone();
            damage(&mut bytes);
            blocks(&folder, "1").keep(0, 2, &[7; 20]);
            fs::write(&folder.parts()[0], &bytes).expect("writable");
            let mut later = blocks(&folder, "1");
            assert_eq!(later.part_with(0, tens), None);
            assert_eq!(folder.parts(), Vec::<PathBuf>::new(), "it is removed");
        }
        // The sound part of one place at another.
        blocks(&folder, "1").keep(0, 2, &[7; 20]);
        let part = &folder.parts()[0];
        fs::rename(part, part.with_file_name("4-2")).expect("renamed");
        assert_eq!(blocks(&folder, "1").part_with(4, tens), None);
    }

    #[test]
    fn the_oldest_parts_are_removed_first() {
        let folder = TestFolder::new("oldest");
        let mut all = BlocksOnDisk::with_limit(&folder.0, "s3://b/a.tif", "1", 1000);
        for first in 0..20 {
            all.keep(first, 1, &[first as u8; 100]);
            // Later by the clock of any file system.
            let now = SystemTime::now() - std::time::Duration::from_secs(100 - first);
            let path = all.folder.join(part_name(first, 1));
            fs::File::options()
                .write(true)
                .open(path)
                .and_then(|file| file.set_modified(now))
                .expect("writable");
        }
        remove_oldest(&folder.0, 1000);
        let sizes: u64 = folder.parts().iter().map(|part| fs::metadata(part).expect("there").len()).sum();
        assert!((700..=1000).contains(&sizes), "{sizes}");
        assert_eq!(all.part_with(19, |_, _| 100), Some((19, vec![19; 100])));
        assert_eq!(all.part_with(0, |_, _| 100), None);
    }

    #[test]
    fn names_of_other_files_are_no_parts() {
        assert_eq!(part_of("1f-2"), Some((31, 2)));
        for name in ["", "-", "1-0", ".9-1.part", "x-1", "ffffffffffffffff-2"] {
            assert_eq!(part_of(name), None, "{name}");
        }
    }
}
