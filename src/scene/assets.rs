//! The files that a scene names: the only place outside the command line that touches the disk.
//!
//! A scene file may come from anywhere, so what it can read is limited to where its own files are: its
//! folder and its folder's parent (which lets `scenes/a.toml` name `../data/hill.tif`), and what the user
//! allows besides. A path is judged twice: as it is written, before the disk is asked whether it exists, and
//! as the system resolves it, so that a symbolic link leads nowhere that a plain path would not.
//!
//! A file may have an address in place of a path: it is read from the hosts that the user allows, and from no others. What a
//! model at an address names lies there too.
//!
//! Paths are written with `/`; `\` is taken for it, so that a scene reads alike on every system.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::given_data::GivenData;
use sandtable_base::limits::ASSET_BYTES;
use sandtable_base::message::suggest::{nearest, quoted};
use sandtable_model::Companions;
use sandtable_model::error::CompanionError;
use sandtable_raster::content::FileContent;
use sandtable_raster::raster::Raster;
use sandtable_remote::address::is_address;
use sandtable_remote::companions::{CompanionFiles, FoundCompanion};
use sandtable_remote::error::RemoteError;
use sandtable_remote::open;

/// The most names of a folder that are looked at for the one that was meant.
const MAX_NAMES: usize = 10_000;

/// Why a file that a scene names cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// The scene file's own folder, or one that was allowed, is not there.
    #[error("the folder {} cannot be opened", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Not a path to a file.
    #[error("'{name}' is not a path that can be read: {reason}")]
    NotAPath {
        /// As written, shortened.
        name: String,
        /// What is wrong with it and what to write instead.
        reason: &'static str,
    },
    /// A path out of the folders that may be read.
    #[error(
        "'{name}' leads to {}, outside {}; if you trust the scene, run again with --allow {}",
        resolved.display(), root.display(), remedy.display()
    )]
    Outside {
        /// As written, shortened.
        name: String,
        /// Where it leads.
        resolved: PathBuf,
        /// The folder that it should be in.
        root: PathBuf,
        /// The folder to allow.
        remedy: PathBuf,
    },
    /// No such file.
    #[error("there is no file {}{}", resolved.display(), did_you_mean(meant.as_deref()))]
    Missing {
        /// Where it was looked for.
        resolved: PathBuf,
        /// The name that is there and most like it.
        meant: Option<String>,
    },
    /// A folder, a pipe or a device.
    #[error("{} is {kind}, not a file", resolved.display())]
    NotAFile {
        /// Where it is.
        resolved: PathBuf,
        /// What it is.
        kind: &'static str,
    },
    /// More bytes than [`ASSET_BYTES`], or than there is memory for.
    #[error("{} has {bytes} bytes, more than can be read: at most {ASSET_BYTES}; cut it, or {ASSET_BYTES:#}", resolved.display())]
    TooLarge {
        /// Where it is.
        resolved: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// The system cannot read it.
    #[error("{} cannot be read", resolved.display())]
    Unreadable {
        /// Where it is.
        resolved: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A file that cannot be read by its address.
    #[error("{address}")]
    Remote {
        /// The address.
        address: String,
        /// Why.
        source: RemoteError,
    },
}

impl AssetError {
    fn remote(address: &str) -> impl Fn(RemoteError) -> Self + '_ {
        |source| Self::Remote { address: address.to_owned(), source }
    }
}

fn did_you_mean(name: Option<&str>) -> String {
    name.map(|name| format!("; did you mean '{name}'?")).unwrap_or_default()
}

/// The files that one scene may read.
#[derive(Clone, Debug)]
pub struct Assets {
    folder: PathBuf,
    root: PathBuf,
    allowed: Vec<PathBuf>,
    /// As the user wrote them, links and all, for judging paths as they are written.
    allowed_as_written: Vec<PathBuf>,
    /// Every file read so far.
    read: Arc<Mutex<BTreeSet<PathBuf>>>,
    /// The elevation that takes the place of every elevation file's.
    elevation: Option<Arc<Raster>>,
    /// What is in memory, and not read.
    given: GivenData,
}

impl Assets {
    /// The files beside `scene_file` and beside its folder, and those under the `allowed` folders.
    ///
    /// Where the scene's folder lies directly under the root of the file system, its parent is not included.
    ///
    /// # Errors
    /// [`AssetError::Folder`] where the scene's folder or an allowed one cannot be found.
    pub fn new(scene_file: &Path, allowed: &[PathBuf]) -> Result<Self, AssetError> {
        let folder = match scene_file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => canonical(parent)?,
            _ => canonical(Path::new("."))?,
        };
        let root = match folder.parent() {
            Some(parent) if parent.parent().is_some() => parent.to_path_buf(),
            _ => folder.clone(),
        };
        let written = |path: &PathBuf| {
            std::path::absolute(path).map_or_else(|_| path.clone(), |path| without_dots(&path))
        };
        let allowed_as_written = allowed.iter().map(written).collect();
        let allowed = allowed.iter().map(|path| canonical(path)).collect::<Result<_, _>>()?;
        let (read, given) = (Arc::default(), GivenData::default());
        Ok(Self { folder, root, allowed, allowed_as_written, read, elevation: None, given })
    }

    /// The folders that it may read besides its own and the one above.
    pub fn allowed(&self) -> &[PathBuf] {
        &self.allowed
    }

    /// The same files, but with `elevation` in place of the elevation that the scene names. For files that are larger than
    /// the memory, of which this is an overview.
    pub fn with_elevation(self, elevation: Arc<Raster>) -> Self {
        Self { elevation: Some(elevation), ..self }
    }

    /// The same files, and data in memory, which take the place of files of their names.
    pub fn with_given(self, given: GivenData) -> Self {
        Self { given, ..self }
    }

    /// The data in memory.
    pub fn given(&self) -> &GivenData {
        &self.given
    }

    /// The elevation that takes the place of the file that the scene calls `name`; `None` where that is to be read.
    ///
    /// # Errors
    /// [`AssetError`] where the file is not there or may not be read.
    pub fn elevation(&self, name: &str) -> Result<Option<&Raster>, AssetError> {
        let Some(elevation) = &self.elevation else { return Ok(None) };
        let path = if is_address(name) { PathBuf::from(name) } else { self.resolve(name)? };
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
        Ok(Some(elevation))
    }

    /// The companions of files, by names as the scene's own; of one with an address at most `most` bytes.
    pub fn companions(
        &self,
        most: u64,
    ) -> CompanionFiles<impl Fn(&str) -> FoundCompanion<AssetError>, AssetError> {
        CompanionFiles::found_by(move |name| self.read_companion(name, most))
    }

    fn read_companion(&self, name: &str, most: u64) -> Result<Option<Vec<u8>>, AssetError> {
        match is_address(name) {
            true => open::read_companion(name, most).map_err(AssetError::remote(name)),
            false => Ok(self.read(name).ok()),
        }
    }

    /// Adds an address to the files read.
    fn note_address(&self, name: &str) {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(PathBuf::from(name));
    }

    /// The bytes of the file that the scene calls `name`: relative to the scene file, absolute under an allowed folder, or an
    /// address.
    ///
    /// # Errors
    /// [`AssetError`].
    pub fn read(&self, name: &str) -> Result<Vec<u8>, AssetError> {
        if let Some(bytes) = self.given.file(name) {
            return Ok(bytes.to_vec());
        }
        if !is_address(name) {
            return self.read_resolved(self.resolve(name)?);
        }
        let bytes = open::read(name, ASSET_BYTES.get()).map_err(AssetError::remote(name))?;
        self.note_address(name);
        Ok(bytes)
    }

    /// The size of the file on disk that the scene calls `name`; `None` for one that is given or has an address, or that is not
    /// there.
    pub fn bytes_on_disk(&self, name: &str) -> Option<u64> {
        if is_address(name) || self.given.file(name).is_some() {
            return None;
        }
        let file = fs::metadata(self.resolve(name).ok()?).ok()?;
        file.is_file().then_some(file.len())
    }

    /// The elevation file that the scene calls `name`, of any size, to be read in parts, and its first bytes: `head` of one on
    /// disk.
    ///
    /// # Errors
    /// [`AssetError`].
    pub fn open_elevation(
        &self,
        name: &str,
        head: u64,
    ) -> Result<(Vec<u8>, Box<dyn FileContent>), AssetError> {
        if is_address(name) {
            let opened = open::open(name).map_err(AssetError::remote(name))?;
            self.note_address(name);
            return Ok((opened.head, opened.content));
        }
        let path = self.resolve(name)?;
        check_is_file(&path)?;
        let mut bytes = Vec::new();
        let opened = File::open(&path).and_then(|mut file| {
            (&mut file).take(head).read_to_end(&mut bytes)?;
            file.rewind()?;
            Ok(file)
        });
        let file = opened.map_err(|source| AssetError::Unreadable { resolved: path.clone(), source })?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
        Ok((bytes, Box::new(file)))
    }

    /// The names of the files in the folder that the scene calls `name`, after that name, in alphabetical order; `None` where
    /// that is no folder.
    ///
    /// # Errors
    /// [`AssetError`], also where the folder holds more than 10,000 names.
    pub fn folder(&self, name: &str) -> Result<Option<Vec<String>>, AssetError> {
        if is_address(name) {
            return Ok(None);
        }
        let path = self.resolve(name)?;
        if !path.is_dir() {
            return Ok(None);
        }
        let names = names_in(&path);
        if names.len() >= MAX_NAMES {
            return Err(AssetError::NotAFile { resolved: path, kind: "a folder of 10,000 names or more" });
        }
        let inside = name.trim_end_matches(['/', '\\']);
        Ok(Some(names.into_iter().map(|file| format!("{inside}/{file}")).collect()))
    }

    /// The files read so far, links followed, and the addresses, in alphabetical order: what no output may be written over.
    pub fn files_read(&self) -> Vec<PathBuf> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    fn read_resolved(&self, path: PathBuf) -> Result<Vec<u8>, AssetError> {
        let bytes = read_file(&path)?;
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(path);
        Ok(bytes)
    }

    /// The path of the file `name`, with all links resolved.
    ///
    /// # Errors
    /// [`AssetError`] where it is not there or may not be read.
    pub fn resolve(&self, name: &str) -> Result<PathBuf, AssetError> {
        self.resolve_from(&self.folder, name)
    }

    /// The files beside the model `name`, for its loader.
    ///
    /// # Errors
    /// As [`Self::resolve`].
    pub fn beside(&self, name: &str) -> Result<SiblingFiles<'_>, AssetError> {
        if is_address(name) {
            return Ok(SiblingFiles { assets: self, folder: PathBuf::from(address_folder(name)) });
        }
        if self.given.file(name).is_some() {
            return Ok(SiblingFiles { assets: self, folder: self.folder.clone() });
        }
        let model = self.resolve(name)?;
        let folder = model.parent().unwrap_or(&self.folder).to_path_buf();
        Ok(SiblingFiles { assets: self, folder })
    }

    fn resolve_from(&self, folder: &Path, name: &str) -> Result<PathBuf, AssetError> {
        let written = folder.join(checked(name)?);
        let lexical = without_dots(&written);
        if !self.allowed_as_written.iter().any(|allowed| lexical.starts_with(allowed)) {
            self.permit(name, &lexical)?;
        }
        match written.canonicalize() {
            Ok(resolved) => self.permit(name, &resolved).map(|()| resolved),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let meant = self.name_like(&lexical);
                Err(AssetError::Missing { resolved: lexical, meant })
            }
            Err(source) => Err(AssetError::Unreadable { resolved: lexical, source }),
        }
    }

    fn permit(&self, name: &str, path: &Path) -> Result<(), AssetError> {
        let absolute = is_absolute(name);
        let inside_own = !absolute && path.starts_with(&self.root);
        if inside_own || self.allowed.iter().any(|allowed| path.starts_with(allowed)) {
            return Ok(());
        }
        Err(AssetError::Outside {
            name: quoted(name),
            resolved: path.to_path_buf(),
            root: if absolute { self.folder.clone() } else { self.root.clone() },
            remedy: path.parent().unwrap_or(path).to_path_buf(),
        })
    }

    /// The name in the missing file's folder that is most like its own; only where that may be read.
    fn name_like(&self, missing: &Path) -> Option<String> {
        let folder = missing.parent()?.canonicalize().ok()?;
        let readable = |root: &PathBuf| folder.starts_with(root);
        if !readable(&self.root) && !self.allowed.iter().any(readable) {
            return None;
        }
        let names = names_in(&folder);
        nearest(missing.file_name()?.to_str()?, names.iter().map(String::as_str)).map(str::to_owned)
    }
}

/// The files beside a model: its textures, buffers and material libraries.
#[derive(Clone, Debug)]
pub struct SiblingFiles<'a> {
    assets: &'a Assets,
    /// Their folder, or its address.
    folder: PathBuf,
}

impl SiblingFiles<'_> {
    /// The path of the file that the model calls `name`.
    ///
    /// Tried in this order: as named; the same in another case, folder by folder, since many models were made
    /// where case does not matter; and the bare file name beside the model, since many name the folder of the
    /// machine that they were made on.
    ///
    /// # Errors
    /// The error of the name as written.
    pub fn resolve(&self, name: &str) -> Result<PathBuf, AssetError> {
        let first = match self.assets.resolve_from(&self.folder, name) {
            Ok(found) => return Ok(found),
            Err(error) => error,
        };
        let slashed = name.replace('\\', "/");
        let bare = slashed.rsplit('/').next().unwrap_or(&slashed);
        let tries = [self.in_any_case(&slashed), self.in_any_case(bare)];
        let found =
            tries.into_iter().flatten().find_map(|name| self.assets.resolve_from(&self.folder, &name).ok());
        found.ok_or(first)
    }

    /// A file beside a model at an address: as named, or else by its bare name beside the model.
    fn read_beside(&self, folder: &str, name: &str) -> Result<Vec<u8>, AssetError> {
        let refused = || AssetError::NotAPath {
            name: quoted(name),
            reason: "it leads away from the server that the model is on",
        };
        let read = |name: &str| {
            let address = address_beside(folder, &checked(name)?).ok_or_else(refused)?;
            self.assets.read(&address)
        };
        let slashed = name.replace('\\', "/");
        let bare = slashed.rsplit('/').next().unwrap_or(&slashed);
        read(name).or_else(|first| match bare == slashed {
            true => Err(first),
            false => read(bare).map_err(|_| first),
        })
    }

    /// `name` as the disk writes it, looked up beside the model.
    fn in_any_case(&self, name: &str) -> Option<String> {
        checked(name).ok().filter(|_| !is_absolute(name))?;
        let mut found: Vec<String> = Vec::new();
        for part in name.split('/').filter(|part| !matches!(*part, "" | ".")) {
            let so_far = self.folder.join(found.join("/"));
            found.push(match part {
                ".." => part.to_owned(),
                _ => {
                    self.assets.permit(name, &so_far.canonicalize().ok()?).ok()?;
                    let wanted = part.to_lowercase();
                    names_in(&so_far).into_iter().find(|name| name.to_lowercase() == wanted)?
                }
            });
        }
        Some(found.join("/"))
    }
}

impl Companions for SiblingFiles<'_> {
    fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
        match self.folder.to_str().filter(|folder| is_address(folder)) {
            Some(folder) => Ok(self.read_beside(folder, name)?),
            None => Ok(self.assets.read_resolved(self.resolve(name)?)?),
        }
    }
}

/// The address of the folder of a file with an address.
fn address_folder(address: &str) -> &str {
    address.rsplit_once('/').map_or(address, |(folder, _)| folder)
}

/// The address of a file from that of a folder; `None` where the way leads out of the host or bucket.
fn address_beside(folder: &str, name: &Path) -> Option<String> {
    let (scheme, rest) = folder.split_once("://")?;
    let mut parts: Vec<&str> = rest.split('/').collect();
    for component in name.components() {
        match component {
            Component::CurDir => {}
            // The first part is the host or bucket.
            Component::ParentDir if parts.len() > 1 => drop(parts.pop()),
            Component::Normal(part) => parts.push(part.to_str()?),
            _ => return None,
        }
    }
    Some(format!("{scheme}://{}", parts.join("/")))
}

fn canonical(path: &Path) -> Result<PathBuf, AssetError> {
    path.canonicalize().map_err(|source| AssetError::Folder { path: path.into(), source })
}

/// Whether a path starts at the root of a file system rather than at the scene.
fn is_absolute(name: &str) -> bool {
    name.starts_with(['/', '\\']) || Path::new(name).is_absolute()
}

/// `name` as a path, unless it is something else.
fn checked(name: &str) -> Result<PathBuf, AssetError> {
    let refused = |reason| Err(AssetError::NotAPath { name: quoted(name), reason });
    let letter = |character: char| character.is_ascii_alphanumeric() || matches!(character, '+' | '-' | '.');
    let scheme = name.split_once(':').map(|(scheme, _)| scheme);
    match scheme {
        _ if name.trim().is_empty() => refused("it is empty"),
        _ if name.contains('\0') => refused("it contains a NUL character"),
        _ if name.len() > 4096 => refused("it is longer than 4096 bytes"),
        _ if Path::new(name).is_absolute() => Ok(PathBuf::from(name)),
        Some("data") => refused("it is data, not the name of a file"),
        Some(scheme) if scheme.len() == 1 && letter(scheme.chars().next().unwrap_or(' ')) => {
            refused("it names a Windows drive; write a path relative to the scene file, with /")
        }
        Some(scheme) if !scheme.is_empty() && scheme.chars().all(letter) => {
            refused("it reads as a URL; fetch the file and write its path relative to the scene file")
        }
        _ if name.starts_with("\\\\") || name.starts_with("//") => {
            refused("it names a network share; write a path relative to the scene file, with /")
        }
        _ => Ok(PathBuf::from(name.replace('\\', "/"))),
    }
}

/// `path` with `.` and `..` taken out as they are written, whatever is on the disk.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(plain.pop()),
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

/// The names in a folder, sorted, so that the same one is found on every machine.
fn names_in(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let named = entries.take(MAX_NAMES).filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = named.collect();
    names.sort();
    names
}

/// What the system knows of a regular file. That is asked before it is opened, since opening a pipe waits for somebody to
/// write to it.
fn check_is_file(resolved: &Path) -> Result<fs::Metadata, AssetError> {
    let about = fs::metadata(resolved)
        .map_err(|source| AssetError::Unreadable { resolved: resolved.into(), source })?;
    if !about.is_file() {
        let kind = if about.is_dir() { "a folder" } else { "a pipe or a device" };
        return Err(AssetError::NotAFile { resolved: resolved.into(), kind });
    }
    Ok(about)
}

/// All bytes of a regular file.
fn read_file(resolved: &Path) -> Result<Vec<u8>, AssetError> {
    let unreadable = |source| AssetError::Unreadable { resolved: resolved.into(), source };
    let about = check_is_file(resolved)?;
    let too_large = |bytes| AssetError::TooLarge { resolved: resolved.into(), bytes };
    let (size, most) = (about.len(), ASSET_BYTES.get());
    let mut bytes = Vec::new();
    let room = usize::try_from(size).ok().filter(|_| size <= most).ok_or_else(|| too_large(size))?;
    bytes.try_reserve_exact(room).map_err(|_| too_large(size))?;
    let file = File::open(resolved).map_err(unreadable)?;
    let count = file.take(most + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if count as u64 > most { Err(too_large(count as u64)) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_path_is_refused_before_the_disk_is_asked() {
        for (name, reason) in [
            ("", "empty"),
            ("a\0b", "NUL"),
            ("http://example.org/a.tif", "URL"),
            ("file:///etc/passwd", "URL"),
            ("FILE:a", "URL"),
            ("data:,x", "data"),
            ("C:\\dem\\a.tif", "Windows drive"),
            ("c:a.tif", "Windows drive"),
            ("\\\\server\\share\\a.tif", "network share"),
        ] {
            match checked(name) {
                Err(error) => assert!(error.to_string().contains(reason), "{name}: {error}"),
                Ok(path) => assert!(cfg!(windows) && path.is_absolute(), "{name}"),
            }
        }
        assert_eq!(checked("a\\b.tif").expect("a path"), Path::new("a/b.tif"));
        assert!(checked("über 山/a (1).tif").is_ok());
    }

    #[test]
    fn what_a_model_at_an_address_names_lies_on_its_server() {
        let folder = address_folder("https://example.org/models/barn.gltf");
        let beside = |name: &str| address_beside(folder, Path::new(name));
        assert_eq!(beside("a b/roof.png").as_deref(), Some("https://example.org/models/a b/roof.png"));
        assert_eq!(beside("./../wood.png").as_deref(), Some("https://example.org/wood.png"));
        assert_eq!(beside("../../wood.png"), None);
        assert_eq!(beside("/wood.png"), None);
    }

    #[test]
    fn dots_are_taken_out_as_written() {
        assert_eq!(without_dots(Path::new("/a/./b/../../c")), Path::new("/c"));
        assert_eq!(without_dots(Path::new("/../..")), Path::new("/"));
    }
}
