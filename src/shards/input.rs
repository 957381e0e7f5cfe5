//! The inputs of a plan: their files, and whether they have changed since.
//!
//! Files that are not large together are compared by their content. Of others, which every worker would have to read for that,
//! the size, the time of the last change and both ends are compared: what a program writes anew differs in one of them, and
//! what it changes in place in the second. Of a file with an address the size and what its server calls its version, its ETag,
//! are compared: nothing of it is read for that but its beginning.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan_path::place;
use sandtable_base::limits::INPUT_BYTES;
use sandtable_dem::read::is_tile_name;
use sandtable_dem::vrt::{VrtTiles, is_vrt};
use sandtable_files::addressed;
use sandtable_files::disk::{self, ReadFileCause, ReadFileError, SystemError};
use sandtable_files::fingerprint::hexadecimal;
use sandtable_remote::address::is_address_path;
use sandtable_remote::error::RemoteError;
use sandtable_remote::open::AddressVersion;

/// The most bytes of files that are compared by their content: a tenth of a second.
const MOST_CONTENT: u64 = 64 << 20;
/// Bytes at each end of a file: so few that ten thousand tiles are compared in seconds.
const END: u64 = 64 << 10;
/// Bytes that are read at once.
const CHUNK: usize = 1 << 20;

/// Extensions of files beside an elevation file that belong to it: its system, headers, masks and places.
const COMPANIONS: [&str; 4] = ["prj", "hdr", "msk", "wld"];
/// Those of world files, of which a server is asked by name.
const WORLD_FILES: [&str; 3] = ["tfw", "blw", "pgw"];

/// An input of a plan, as it was when the plan was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanInput {
    /// Where it is, from the folder of the plan; or its address.
    pub path: PathBuf,
    /// Its size.
    pub bytes: u64,
    /// What `sha256` is made of.
    pub check: InputCheck,
    /// In hexadecimal digits; empty of a file with an address.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub sha256: String,
    /// What the server of a file with an address calls its version: its ETag, or else its time of change.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<String>,
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
    /// None: the version that the server states is compared.
    Version,
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
        if is_address_path(path) {
            return Self::at_address(path);
        }
        let failed = |error: io::Error| ReadFileError::new(path, SystemError::from(error));
        let mut file = disk::open(path)?;
        let metadata = file.metadata().map_err(failed)?;
        let bytes = metadata.len();
        if check == InputCheck::Content || bytes <= 2 * END {
            let sha256 = hash(&mut file, bytes).map_err(failed)?;
            let check = InputCheck::Content;
            return Ok(Self { path: stated, bytes, check, sha256, version: None, modified: None });
        }
        let sha256 = hash_of_ends(&mut file, bytes).map_err(failed)?;
        let since = metadata.modified().map_err(failed)?.duration_since(SystemTime::UNIX_EPOCH);
        let modified = since.map_or(0, |since| u64::try_from(since.as_nanos()).unwrap_or(u64::MAX));
        let check = InputCheck::Ends;
        Ok(Self { path: stated, bytes, check, sha256, version: None, modified: Some(modified) })
    }

    /// A file with an address.
    fn at_address(path: &Path) -> Result<Self, ReadFileError> {
        let AddressVersion { bytes, tag } = addressed::stated_version(path)?;
        let version = Some(tag.ok_or_else(|| ReadFileError::new(path, ReadFileCause::NoVersion))?);
        let (path, check) = (path.to_owned(), InputCheck::Version);
        Ok(Self { path, bytes, check, sha256: String::new(), version, modified: None })
    }

    /// Checks that the file is what it was.
    ///
    /// # Errors
    /// [`PlanFault::Stale`], or it cannot be read.
    pub fn verify(&self, folder: &Path) -> Result<(), ShardError> {
        let path = place(&self.path, folder);
        let stale = |what: String| ShardError::from(PlanError::new(&path, PlanFault::Stale(what)));
        let bytes = fs::metadata(&path).map_or(0, |metadata| metadata.len());
        if path.is_file() && bytes != self.bytes {
            return Err(stale(format!(
                "it had {} bytes when it was planned with, and has {bytes}",
                self.bytes
            )));
        }
        let now = Self::new(&path, self.path.clone(), self.check).map_err(|error| match error.cause {
            ReadFileCause::System(SystemError::NotFound)
            | ReadFileCause::NotAFile
            | ReadFileCause::Remote(RemoteError::Missing) => {
                stale("this input of the plan is not there".into())
            }
            cause => ReadFileError { path: error.path, cause }.into(),
        })?;
        if now == *self {
            return Ok(());
        }
        if is_address_path(&path) {
            let known = |input: &Self| {
                let version = input.version.as_deref().unwrap_or("none");
                format!("{} bytes and the version {version}", input.bytes)
            };
            let (before, now) = (known(self), known(&now));
            return Err(stale(format!("it had {before} when it was planned with, and has {now}")));
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

/// The files that the elevation at `path` is read of: one, the tiles of a folder or of a virtual raster, and those that may
/// belong to them.
///
/// # Errors
/// A file or a folder cannot be read.
pub fn elevation_files(path: &Path) -> Result<Vec<PathBuf>, ReadFileError> {
    if is_address_path(path) {
        return addressed_files(path);
    }
    if path.is_dir() {
        let all = disk::list_folder(path)?;
        let tiles: BTreeSet<String> =
            all.iter().map(|file| disk::file_name(file)).filter(|name| is_tile_name(name)).collect();
        return Ok(with_companions(all, &tiles));
    }
    let mut folders: BTreeMap<PathBuf, BTreeSet<String>> = BTreeMap::new();
    let mut add = |file: &Path| {
        let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        folders.entry(folder.to_owned()).or_default().insert(disk::file_name(file));
    };
    let own = disk::file_name(path);
    if is_vrt(&own) {
        // What it says wrong was an error of opening it.
        let tiles = VrtTiles::read(&disk::read(path)?).map(|vrt| vrt.paths(path)).unwrap_or_default();
        tiles.iter().for_each(|tile| add(tile));
    } else {
        add(path);
    }
    let mut found = vec![path.to_owned()];
    for (folder, tiles) in &folders {
        let all = disk::list_folder(folder)?.into_iter().map(|file| folder.join(disk::file_name(&file)));
        let others = with_companions(all.collect(), tiles).into_iter();
        found.extend(others.filter(|file| disk::file_name(file) != own));
    }
    Ok(found)
}

/// The same of elevation with an address: the file, the tiles of a virtual raster, and the companions of either that are there
/// of those that the readers look for. A folder on a server has no list.
fn addressed_files(path: &Path) -> Result<Vec<PathBuf>, ReadFileError> {
    let mut found = vec![path.to_owned()];
    if is_vrt(&disk::file_name(path)) {
        // What it says wrong was an error of opening it.
        found.extend(
            VrtTiles::read(&addressed::read(path, INPUT_BYTES.get())?)
                .map(|vrt| vrt.paths(path))
                .unwrap_or_default(),
        );
        return Ok(found);
    }
    let name = disk::file_name(path);
    let companions = COMPANIONS.iter().chain(&WORLD_FILES).map(|extension| path.with_extension(extension));
    let after_name = ["hdr", "msk"].map(|extension| path.with_file_name(format!("{name}.{extension}")));
    for companion in companions.chain(after_name).filter(|companion| companion != path) {
        match addressed::stated_version(&companion) {
            Ok(_) => found.push(companion),
            Err(ReadFileError { cause: ReadFileCause::Remote(error), .. }) if error.is_absence() => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

/// Those of the files in a folder that are the tiles, or may belong to them.
fn with_companions(files: Vec<PathBuf>, tiles: &BTreeSet<String>) -> Vec<PathBuf> {
    let stem = |tile: &String| Some(Path::new(tile).file_stem()?.to_str()?.to_owned());
    let stems: BTreeSet<String> = tiles.iter().cloned().chain(tiles.iter().filter_map(stem)).collect();
    let belongs = |file: &PathBuf| {
        let name = disk::file_name(file);
        tiles.contains(&name) || is_companion_name(&name, |stem| stems.contains(stem))
    };
    files.into_iter().filter(belongs).collect()
}

fn is_companion_name(name: &str, is_stem: impl Fn(&str) -> bool) -> bool {
    let Some((stem, extension)) = name.rsplit_once('.') else { return false };
    let extension = extension.to_ascii_lowercase();
    // World files: .tfw, .pgw, .pngw.
    let is_world_file = (3..=5).contains(&extension.len()) && extension.ends_with('w') && extension != "raw";
    (is_world_file || COMPANIONS.contains(&extension.as_str())) && is_stem(stem)
}

/// The SHA-256 of the next `bytes` bytes of a file.
///
/// # Errors
/// There are fewer, or they cannot be read.
pub fn hash(file: &mut File, bytes: u64) -> io::Result<String> {
    let mut whole = Sha256::new();
    add(&mut whole, file, bytes)?;
    Ok(hexadecimal(&whole.finalize()))
}

fn hash_of_ends(file: &mut File, bytes: u64) -> io::Result<String> {
    let mut whole = Sha256::new();
    add(&mut whole, file, END)?;
    file.seek(SeekFrom::Start(bytes - END))?;
    add(&mut whole, file, END)?;
    Ok(hexadecimal(&whole.finalize()))
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
        let is_mine = |name: &str| is_companion_name(name, |stem| ["dem.tif", "dem"].contains(&stem));
        for name in ["dem.prj", "dem.tfw", "dem.tif.msk", "dem.PRJ", "dem.wld", "dem.tif.hdr"] {
            assert!(is_mine(name), "{name}");
        }
        for name in ["dem.tif", "dem.txt", "other.prj", "dem", "dem.png", "dem.raw", "dem2.tfw"] {
            assert!(!is_mine(name), "{name}");
        }
    }

    #[test]
    fn the_files_of_a_virtual_raster_are_those_that_it_lists_and_theirs() {
        let folder = std::env::temp_dir().join(format!("sandtable-inputs-{}", std::process::id()));
        fs::create_dir_all(folder.join("tiles")).expect("a folder");
        let vrt = "<VRTDataset rasterXSize=\"1\" rasterYSize=\"1\"><VRTRasterBand><SimpleSource>\
                   <SourceFilename relativeToVRT=\"1\">tiles/a.bil</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
        for name in ["a.vrt", "a.prj", "tiles/a.bil", "tiles/a.hdr", "tiles/b.bil"] {
            fs::write(folder.join(name), if name == "a.vrt" { vrt } else { "" }).expect("a file");
        }
        let found = elevation_files(&folder.join("a.vrt")).expect("readable");
        let found: Vec<&Path> = found.iter().map(|file| file.strip_prefix(&folder).expect("there")).collect();
        assert_eq!(found, ["a.vrt", "tiles/a.bil", "tiles/a.hdr"].map(Path::new));
        let found = elevation_files(&folder.join("tiles/a.bil")).expect("readable");
        assert_eq!(found, ["tiles/a.bil", "tiles/a.hdr"].map(|name| folder.join(name)));
        fs::remove_dir_all(folder).expect("its own folder");
    }
}
