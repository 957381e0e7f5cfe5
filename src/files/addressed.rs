//! Files that are read: on disk, or by their addresses.

use std::path::Path;

use crate::disk::{self, ReadFileError};
use crate::error::FileError;
use sandtable_dem::read;
use sandtable_raster::content::FileContent;
use sandtable_remote::address::is_address;
use sandtable_remote::companions::{CompanionFiles, FoundCompanion};
use sandtable_remote::error::RemoteError;
use sandtable_remote::open::{self, AddressVersion};

/// The address that a path is, if it is one.
fn address(path: &Path) -> Option<&str> {
    path.to_str().filter(|name| is_address(name))
}

fn failed(path: &Path) -> impl Fn(RemoteError) -> ReadFileError + '_ {
    |error| FileError::new(path, error)
}

/// The bytes of a file, of which a server sends at most `most`.
///
/// # Errors
/// As [`disk::read`]; the server's.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadFileError> {
    match address(path) {
        Some(address) => open::read(address, most).map_err(failed(path)),
        None => disk::read(path),
    }
}

/// The first bytes of an elevation file, and the file, to be read in parts.
///
/// # Errors
/// As [`disk::open`]; the server's.
pub fn open(path: &Path) -> Result<(Vec<u8>, Box<dyn FileContent>), ReadFileError> {
    match address(path) {
        Some(address) => {
            let opened = open::open(address).map_err(failed(path))?;
            Ok((opened.head, opened.content))
        }
        None => Ok((disk::read_head(path, read::HEAD_BYTES)?, Box::new(disk::open(path)?))),
    }
}

/// An identifier of the current version of an elevation file on a server.
///
/// # Errors
/// It has no address; the server's.
pub fn version(path: &Path) -> Result<String, ReadFileError> {
    let address =
        address(path).ok_or(RemoteError::Address("it has no known scheme")).map_err(failed(path))?;
    Ok(format!("{address} {}", open::version(address).map_err(failed(path))?))
}

/// The version of an elevation file that its server states.
///
/// # Errors
/// It has no address; the server's.
pub fn stated_version(path: &Path) -> Result<AddressVersion, ReadFileError> {
    let address = address(path).ok_or(RemoteError::Address("it has no known scheme"));
    address.and_then(open::stated_version).map_err(failed(path))
}

/// The companions of the file at `path`, each of at most `most` bytes where it has an address.
pub fn companions(
    path: &Path,
    most: u64,
) -> CompanionFiles<impl Fn(&str) -> FoundCompanion<ReadFileError>, ReadFileError> {
    CompanionFiles::found_by(move |name| {
        if address(path).is_none() {
            return Ok(disk::beside(path)(name));
        }
        let companion = path.with_file_name(name);
        let found = companion.to_str().map(|name| open::read_companion(name, most));
        found.transpose().map(Option::flatten).map_err(failed(&companion))
    })
}
