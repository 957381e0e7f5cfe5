//! Reading the files that a user names, and writing results: whole, or not at all.

use std::fs;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

use crate::error::FileError;
use crate::output_files::OutputFiles;
use crate::png::encode_png;
use crate::synced_file::SyncedFile;
use sandtable_base::limits::INPUT_BYTES;
use sandtable_draw::pixels::Pixels;
use sandtable_remote::address::is_address_path;
use sandtable_remote::error::RemoteError;

/// The path that means standard input.
const STDIN: &str = "-";

/// A file that cannot be read.
pub type ReadFileError = FileError<ReadFileCause>;

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ReadFileCause {
    #[error("this is not a file")]
    NotAFile,
    #[error("{0} bytes are more than the {INPUT_BYTES} that are read; cut the file, or {INPUT_BYTES:#}")]
    TooLarge(u64),
    #[error("byte {0} is not UTF-8 text")]
    NotText(usize),
    #[error(
        "this is an address: elevation and what a scene names are read by address, nothing else; fetch the file"
    )]
    Address,
    #[error(
        "its server states neither an ETag nor a time of change, so that no worker would know whether it is the file that was \
         planned with; fetch the file"
    )]
    NoVersion,
    #[error(transparent)]
    Remote(#[from] RemoteError),
    #[error(transparent)]
    System(#[from] SystemError),
}

/// A file that cannot be written; nothing is left behind.
pub type WriteFileError = FileError<WriteFileCause>;

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum WriteFileCause {
    #[error("there is no such folder to write to")]
    NoFolder,
    #[error("this is a folder; name a file in it")]
    Folder,
    #[error("this is a device or a pipe; name a file")]
    Device,
    #[error("this is an address; results are written to files")]
    Address,
    #[error("this is not the name of a file")]
    NoName,
    #[error("this is an input file; name another to write to")]
    Input,
    #[error("this file may not be written over; name another, or make it writable")]
    ReadOnly,
    /// The name has another extension than `.png`.
    #[error("pictures are written as PNG; name one that ends in .png")]
    NotPng,
    /// The name of a sheet has another extension.
    #[error("pictures are written as PNG, PDF or SVG; name one that ends in .png, .pdf or .svg")]
    NotSheet,
    #[error(transparent)]
    System(#[from] SystemError),
}

/// An error of the operating system about a file.
#[derive(Debug, thiserror::Error)]
pub enum SystemError {
    /// No such file.
    #[error("there is no such file or folder")]
    NotFound,
    /// No permission.
    #[error("permission denied")]
    Denied,
    /// No space on the disk, or none that this user may take.
    #[error("the disk is full")]
    Full,
    /// A disk that is mounted to be read.
    #[error("the disk is read-only")]
    ReadOnlyDisk,
    /// Anything else.
    #[error(transparent)]
    Other(io::Error),
}

impl From<io::Error> for SystemError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NotFound,
            io::ErrorKind::PermissionDenied => Self::Denied,
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::Full,
            io::ErrorKind::ReadOnlyFilesystem => Self::ReadOnlyDisk,
            _ => Self::Other(error),
        }
    }
}

fn system(path: &Path) -> impl Fn(io::Error) -> ReadFileError + '_ {
    |error| FileError::new(path, SystemError::from(error))
}

/// Checks that a path is no address.
///
/// # Errors
/// [`ReadFileCause::Address`].
pub fn check_on_disk(path: &Path) -> Result<(), ReadFileError> {
    if is_address_path(path) { Err(ReadFileError::new(path, ReadFileCause::Address)) } else { Ok(()) }
}

/// The bytes of a regular file of at most 4 GiB.
///
/// # Errors
/// See [`ReadFileCause`].
pub fn read(path: &Path) -> Result<Vec<u8>, ReadFileError> {
    check_on_disk(path)?;
    let metadata = fs::metadata(path).map_err(system(path))?;
    if !metadata.is_file() {
        return Err(ReadFileError::new(path, ReadFileCause::NotAFile));
    }
    if metadata.len() > INPUT_BYTES.get() {
        return Err(ReadFileError::new(path, ReadFileCause::TooLarge(metadata.len())));
    }
    fs::read(path).map_err(system(path))
}

/// A regular file of any size, to be read in parts.
///
/// # Errors
/// See [`ReadFileCause`].
pub fn open(path: &Path) -> Result<fs::File, ReadFileError> {
    check_on_disk(path)?;
    // What is no file is not opened: a pipe would wait for its writer.
    if !fs::metadata(path).map_err(system(path))?.is_file() {
        return Err(ReadFileError::new(path, ReadFileCause::NotAFile));
    }
    fs::File::open(path).map_err(system(path))
}

/// The first `most` bytes of a regular file.
///
/// # Errors
/// See [`ReadFileCause`].
pub fn read_head(path: &Path, most: u64) -> Result<Vec<u8>, ReadFileError> {
    let mut head = Vec::new();
    open(path)?.take(most).read_to_end(&mut head).map_err(system(path))?;
    Ok(head)
}

/// The text of a file, or of standard input for the path `-`.
///
/// # Errors
/// See [`ReadFileCause`].
pub fn read_text(path: &Path) -> Result<String, ReadFileError> {
    let bytes = if path == Path::new(STDIN) {
        let mut bytes = Vec::new();
        let read = io::stdin().lock().take(INPUT_BYTES.get()).read_to_end(&mut bytes);
        read.map_err(system(path))?;
        bytes
    } else {
        read(path)?
    };
    let not_text = |error: FromUtf8Error| ReadFileCause::NotText(error.utf8_error().valid_up_to());
    String::from_utf8(bytes).map_err(|error| FileError::new(path, not_text(error)))
}

/// The name of a file in messages: `standard input` for the path `-`.
pub fn display_name(path: &Path) -> String {
    if path == Path::new(STDIN) { "standard input".into() } else { path.display().to_string() }
}

/// The last component of a path; empty where there is none.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The last component of a path without its extension; empty where there is none.
pub fn file_stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The files in a folder, sorted by name; its subfolders are left out.
///
/// # Errors
/// The folder cannot be read.
pub fn list_folder(folder: &Path) -> Result<Vec<PathBuf>, ReadFileError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(system(folder))? {
        files.push(entry.map_err(system(folder))?.path());
    }
    files.retain(|path| path.is_file());
    files.sort();
    Ok(files)
}

/// Reads the file beside `path` that has a given name: a sidecar. `None` where it cannot be read.
pub fn beside(path: &Path) -> impl Fn(&str) -> Option<Vec<u8>> + '_ {
    move |name: &str| {
        let is_plain = !name.is_empty() && !name.contains(['/', '\\']);
        is_plain.then(|| read(&path.with_file_name(name)).ok()).flatten()
    }
}

/// Checks, without writing, that a file could be written to `path`, so that a mistyped folder is reported before the
/// work and not after it.
///
/// # Errors
/// The folder does not exist; `path` is a folder, a device, a file that may not be written to or one of `inputs`, whose
/// links are followed.
pub fn check_output<P: AsRef<Path>>(path: &Path, inputs: &[P]) -> Result<(), WriteFileError> {
    if is_address_path(path) {
        return Err(WriteFileError::new(path, WriteFileCause::Address));
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_input = || {
        let same = |output: PathBuf| {
            inputs.iter().any(|input| input.as_ref().canonicalize().is_ok_and(|input| input == output))
        };
        path.canonicalize().is_ok_and(same)
    };
    let cause = match fs::metadata(path) {
        _ if !folder.is_dir() => WriteFileCause::NoFolder,
        Ok(metadata) if metadata.is_dir() => WriteFileCause::Folder,
        Ok(metadata) if !metadata.is_file() => WriteFileCause::Device,
        Ok(_) if is_input() => WriteFileCause::Input,
        Ok(metadata) if metadata.permissions().readonly() => WriteFileCause::ReadOnly,
        _ if path.file_name().is_none() => WriteFileCause::NoName,
        _ => return Ok(()),
    };
    Err(WriteFileError::new(path, cause))
}

/// [`check_output`] for a picture, whose name must end in `.png` or have no extension.
///
/// # Errors
/// As [`check_output`], or if the extension is not `png`.
pub fn check_picture_output<P: AsRef<Path>>(path: &Path, inputs: &[P]) -> Result<(), WriteFileError> {
    check_output(path, inputs)?;
    match path.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => {
            Err(WriteFileError::new(path, WriteFileCause::NotPng))
        }
        _ => Ok(()),
    }
}

/// [`check_output`] for a sheet: the name must end in `.png`, `.pdf` or `.svg`, or have no extension.
///
/// # Errors
/// As [`check_output`], and another extension.
pub fn check_sheet_output<P: AsRef<Path>>(path: &Path, inputs: &[P]) -> Result<(), WriteFileError> {
    check_output(path, inputs)?;
    match path.extension() {
        Some(extension)
            if !["png", "pdf", "svg"].iter().any(|known| extension.eq_ignore_ascii_case(known)) =>
        {
            Err(WriteFileError::new(path, WriteFileCause::NotSheet))
        }
        _ => Ok(()),
    }
}

/// Makes a folder, and those that it lies in, where they are not there.
///
/// # Errors
/// The system refuses.
pub fn make_folder(folder: &Path) -> Result<(), WriteFileError> {
    fs::create_dir_all(folder).map_err(|error| WriteFileError::new(folder, SystemError::from(error)))
}

/// Writes a picture, which must have pixels, as PNG, without alpha where it is opaque.
///
/// # Errors
/// The file cannot be written.
pub fn write_picture(path: &Path, pixels: &Pixels) -> Result<(), WriteFileError> {
    write(path, &encode_png(pixels))
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// The system refuses.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteFileError> {
    write_with(path, |out| out.write_all(bytes))
}

/// [`write()`] for content that is made while it is written.
///
/// # Errors
/// The system or `content` fails.
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<SyncedFile<'_>>) -> io::Result<()>,
) -> Result<(), WriteFileError> {
    let mut files = OutputFiles::default();
    files.write_with(path, content)?;
    files.publish()
}
