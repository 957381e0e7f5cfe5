//! Reading what the user names and writing what a command makes.

use std::fs;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use crate::app::failure::CliError;

/// No input file may be larger: more than any elevation tile in use, less than this machine's memory.
const MAX_BYTES: u64 = 4 << 30;

/// The bytes of a file.
///
/// # Errors
/// It cannot be read, is no regular file, or is too large; the message names it.
pub fn read(path: &Path) -> Result<Vec<u8>, CliError> {
    let wrong = |reason: String| CliError::input(format!("{}: {reason}", path.display()));
    let metadata = fs::metadata(path).map_err(|error| wrong(describe(&error)))?;
    if !metadata.is_file() {
        return Err(wrong("this is not a file".into()));
    }
    if metadata.len() > MAX_BYTES {
        return Err(wrong(format!("{} bytes are more than the {MAX_BYTES} that are read", metadata.len())));
    }
    fs::read(path).map_err(|error| wrong(describe(&error)))
}

/// The text of a file, or of standard input for `-`.
///
/// # Errors
/// As for [`read`]; or it is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, CliError> {
    let bytes = if path == Path::new("-") {
        let mut bytes = Vec::new();
        let result = io::stdin().lock().take(MAX_BYTES).read_to_end(&mut bytes);
        result.map_err(|error| CliError::input(format!("standard input: {error}")))?;
        bytes
    } else {
        read(path)?
    };
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        CliError::input(format!("{}: byte {at} is not UTF-8 text", text_name(path)))
    })
}

/// What messages call a text that [`read_text`] reads.
pub fn text_name(path: &Path) -> String {
    if path == Path::new("-") { "standard input".into() } else { path.display().to_string() }
}

/// The files in a folder, sorted by name; folders in it are left out.
///
/// # Errors
/// It cannot be read; the message names it.
pub fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let wrong = |error: io::Error| CliError::input(format!("{}: {}", folder.display(), describe(&error)));
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        if path.is_file() {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The file beside `path` with another name, if it can be read: a sidecar.
pub fn beside(path: &Path) -> impl Fn(&str) -> Option<Vec<u8>> + '_ {
    move |name: &str| {
        let plain = !name.is_empty() && !name.contains(['/', '\\']);
        plain.then(|| read(&path.with_file_name(name)).ok()).flatten()
    }
}

/// Whether the picture of `scene` could be written to `path`, as far as can be told without writing it: a
/// mistyped folder should not be told only after a long rendering.
///
/// # Errors
/// The folder is not there, `path` is a folder or a device, it is the scene file itself, or its name is that of
/// another format.
pub fn check_place(path: &Path, scene: &Path) -> Result<(), CliError> {
    check_picture_place(path, scene, "this is the scene file itself; name another with -o")
}

/// Whether a picture could be written to `path`, as far as can be told without writing it.
///
/// # Errors
/// As for [`check_file_place`]; or its name is that of another format than PNG.
pub fn check_picture_place(path: &Path, input: &Path, is_input: &str) -> Result<(), CliError> {
    check_file_place(path, input, is_input)?;
    if !is_png_name(path) {
        let reason = "pictures are written as PNG; name one that ends in .png";
        return Err(CliError::input(format!("{}: {reason}", path.display())));
    }
    Ok(())
}

/// Whether a file could be written to `path`, as far as can be told without writing it.
///
/// # Errors
/// The folder is not there, `path` is a folder or a device, or it is `input`; then with the reason `is_input`.
pub fn check_file_place(path: &Path, input: &Path, is_input: &str) -> Result<(), CliError> {
    let wrong = |reason: &str| Err(CliError::input(format!("{}: {reason}", path.display())));
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return wrong("there is no such folder to write to");
    }
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => wrong("this is a folder; name a file in it"),
        Ok(there) if !there.is_file() => wrong("this is a device or a pipe; name a file"),
        Ok(_) if path.canonicalize().ok() == input.canonicalize().ok() => wrong(is_input),
        _ if path.file_name().is_none() => wrong("this is not the name of a file"),
        _ => Ok(()),
    }
}

/// Whether `path` is none of the files that the picture is made of.
///
/// # Errors
/// It is one of `inputs`, whose links are followed.
pub fn check_no_input(path: &Path, inputs: &[PathBuf]) -> Result<(), CliError> {
    match path.canonicalize() {
        Ok(there) if inputs.contains(&there) => {
            let reason = "the scene is made of this file; name another with -o";
            Err(CliError::input(format!("{}: {reason}", path.display())))
        }
        _ => Ok(()),
    }
}

/// A name without an extension is the user's choice; another format's would belie the content.
fn is_png_name(path: &Path) -> bool {
    path.extension().is_none_or(|extension| extension.eq_ignore_ascii_case("png"))
}

/// Writes a file whole or not at all: beside its place first, then renamed into it.
///
/// # Errors
/// It cannot be written; nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CliError> {
    write_whole_with(path, |out| out.write_all(bytes))
}

/// [`write_whole`] for content that is made while it is written.
///
/// # Errors
/// It cannot be written; nothing is left behind.
pub fn write_whole_with(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<fs::File>) -> io::Result<()>,
) -> Result<(), CliError> {
    let wrong = |error: io::Error| CliError::input(format!("{}: {}", path.display(), describe(&error)));
    let name = path.file_name().ok_or_else(|| wrong(io::Error::from(io::ErrorKind::InvalidFilename)))?;
    let mut partial = name.to_owned();
    partial.push(format!(".{}.part", std::process::id()));
    let partial: PathBuf = path.with_file_name(partial);
    let fill = |file| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        out.into_inner()?.sync_all()
    };
    let written = fs::File::create(&partial).and_then(fill).and_then(|()| fs::rename(&partial, path));
    written.map_err(|error| {
        let _ = fs::remove_file(&partial);
        wrong(error)
    })
}

fn describe(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => error.to_string(),
    }
}
