//! The inputs of a plan: which files they are, and whether they still are what was planned with.
//!
//! Files that are not large together are compared by their content. Of others, which every worker would have to read for that,
//! the size, the time of the last change and both ends are compared: what a program writes anew differs in one of them, and
//! what it changes in place in the second.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::dem::read::is_tile_name;
use crate::pipeline::files::{self, ReadFileCause, ReadFileError, SystemError};
use crate::pipeline::shards::error::{PlanError, PlanFault, ShardError};

/// The most bytes of files that are compared by their content: a tenth of a second.
const MOST_CONTENT: u64 = 64 << 20;
/// Bytes at each end of a file: so few that ten thousand tiles are compared in seconds.
const END: u64 = 64 << 10;
/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;

/// Extensions of files beside an elevation file that belong to it: its system, headers, masks and places.
const COMPANIONS: [&str; 4] = ["prj", "hdr", "msk", "wld"];

/// An input of a plan, as it was then.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanInput {
    /// Where it is, from the folder of the plan.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// What `sha256` is made of.
    pub check: InputCheck,
    /// In hexadecimal digits.
    pub sha256: String,
    /// Nanoseconds from 1970 to its last change, where only its ends are hashed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modified: Option<u64>,
}

/// The bytes of an input that are hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum InputCheck {
    /// All.
    Content,
    /// The first and the last 64 KiB.
    Ends,
}

impl PlanInput {
    /// Files that a plan reads, each with the path by which it calls it.
    ///
    /// # Errors
    /// One cannot be read.
    pub fn all(files: &[(PathBuf, PathBuf)]) -> Result<Vec<Self>, ReadFileError> {
        let bytes =
            files.iter().filter_map(|(path, _)| fs::metadata(path).ok()).map(|metadata| metadata.len());
        let check = if bytes.sum::<u64>() <= MOST_CONTENT { InputCheck::Content } else { InputCheck::Ends };
        files.par_iter().map(|(path, stated)| Self::new(path, stated.clone(), check)).collect()
    }

    fn new(path: &Path, stated: PathBuf, check: InputCheck) -> Result<Self, ReadFileError> {
        let failed = |error: io::Error| ReadFileError::new(path, SystemError::from(error));
        let mut file = files::open(path)?;
        let metadata = file.metadata().map_err(failed)?;
        let bytes = metadata.len();
        if check == InputCheck::Content || bytes <= 2 * END {
            let sha256 = hash(&mut file, bytes).map_err(failed)?;
            return Ok(Self { path: stated, bytes, check: InputCheck::Content, sha256, modified: None });
        }
        let sha256 = hash_of_ends(&mut file, bytes).map_err(failed)?;
        let since = metadata.modified().map_err(failed)?.duration_since(SystemTime::UNIX_EPOCH);
        let modified = since.map_or(0, |since| u64::try_from(since.as_nanos()).unwrap_or(u64::MAX));
        Ok(Self { path: stated, bytes, check: InputCheck::Ends, sha256, modified: Some(modified) })
    }

    /// Checks that the file is what it was.
    ///
    /// # Errors
    /// [`PlanFault::Stale`], or it cannot be read.
    pub fn verify(&self, folder: &Path) -> Result<(), ShardError> {
        let path = folder.join(&self.path);
        let stale = |what: String| ShardError::from(PlanError::new(&path, PlanFault::Stale(what)));
        let bytes = fs::metadata(&path).map_or(0, |metadata| metadata.len());
        if path.is_file() && bytes != self.bytes {
            return Err(stale(format!(
                "it had {} bytes when it was planned with, and has {bytes}",
                self.bytes
            )));
        }
        let now = Self::new(&path, self.path.clone(), self.check).map_err(|error| match error.cause {
            ReadFileCause::System(SystemError::NotFound) | ReadFileCause::NotAFile => {
                stale("this input of the plan is not there".into())
            }
            cause => ReadFileError { path: error.path, cause }.into(),
        })?;
        if now == *self {
            return Ok(());
        }
        Err(stale(match now.sha256 == self.sha256 {
            false => "its content is not the one that was planned with".into(),
            true => {
                "its time of change is not the one that was planned with (`cp -p` and `rsync -t` keep that of a copy)"
                    .into()
            }
        }))
    }
}

/// The files that the elevation at `path` is read of: the tiles of a folder, or one, and those that may belong to them.
///
/// # Errors
/// The folder cannot be read.
pub fn elevation_files(path: &Path) -> Result<Vec<PathBuf>, ReadFileError> {
    if path.is_dir() {
        let all = files::list_folder(path)?;
        let stems: Vec<String> =
            all.iter().map(|file| files::file_name(file)).filter(|name| is_tile_name(name)).collect();
        let belongs = |file: &PathBuf| {
            let name = files::file_name(file);
            is_tile_name(&name) || is_companion_name(&name, |stem| stems.iter().any(|tile| is_of(tile, stem)))
        };
        return Ok(all.into_iter().filter(belongs).collect());
    }
    let own = files::file_name(path);
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = files::list_folder(folder)?.into_iter().map(|file| folder.join(files::file_name(&file)));
    let belongs = |file: &PathBuf| is_companion_name(&files::file_name(file), |stem| is_of(&own, stem));
    Ok([path.to_owned()].into_iter().chain(beside.filter(belongs).filter(|file| file != path)).collect())
}

/// Whether `stem` is a file's name, or that without its extension.
fn is_of(name: &str, stem: &str) -> bool {
    name == stem || Path::new(name).file_stem().is_some_and(|own| own == stem)
}

fn is_companion_name(name: &str, is_stem: impl Fn(&str) -> bool) -> bool {
    let Some((stem, extension)) = name.rsplit_once('.') else { return false };
    let extension = extension.to_ascii_lowercase();
    // World files: .tfw, .pgw, .pngw.
    let is_world_file = (3..=5).contains(&extension.len()) && extension.ends_with('w') && extension != "raw";
    (is_world_file || COMPANIONS.contains(&extension.as_str())) && is_stem(stem)
}

/// The SHA-256 of bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    hex(Sha256::digest(bytes).as_slice())
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 of the next `bytes` bytes of a file.
///
/// # Errors
/// There are fewer, or they cannot be read.
pub fn hash(file: &mut File, bytes: u64) -> io::Result<String> {
    let mut whole = Sha256::new();
    add(&mut whole, file, bytes)?;
    Ok(hex(whole.finalize().as_slice()))
}

fn hash_of_ends(file: &mut File, bytes: u64) -> io::Result<String> {
    let mut whole = Sha256::new();
    add(&mut whole, file, END)?;
    file.seek(SeekFrom::Start(bytes - END))?;
    add(&mut whole, file, END)?;
    Ok(hex(whole.finalize().as_slice()))
}

fn add(whole: &mut Sha256, file: &mut File, bytes: u64) -> io::Result<()> {
    let mut chunk = vec![0; CHUNK.min(usize::try_from(bytes).unwrap_or(CHUNK))];
    let mut left = bytes;
    while left > 0 {
        let most = chunk.len().min(usize::try_from(left).unwrap_or(usize::MAX));
        file.read_exact(&mut chunk[..most])?;
        whole.update(&chunk[..most]);
        left -= most as u64;
    }
    Ok(())
}

/// Whether there is a regular file of so many bytes.
pub fn has_size(path: &Path, bytes: u64) -> bool {
    fs::metadata(path).is_ok_and(|metadata| metadata.is_file() && metadata.len() == bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_elevation_file_has_its_system_and_place_beside_it() {
        let is_mine = |name: &str| is_companion_name(name, |stem| is_of("dem.tif", stem));
        for name in ["dem.prj", "dem.tfw", "dem.tif.msk", "dem.PRJ", "dem.wld", "dem.tif.hdr"] {
            assert!(is_mine(name), "{name}");
        }
        for name in ["dem.tif", "dem.txt", "other.prj", "dem", "dem.png", "dem.raw", "dem2.tfw"] {
            assert!(!is_mine(name), "{name}");
        }
    }

    #[test]
    fn known_bytes_have_their_known_hash() {
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), expected);
    }
}
