//! Files that are read: on disk, or by their addresses.

use std::cell::RefCell;
use std::path::Path;

use crate::dem::formats::FileContent;
use crate::dem::read;
use crate::pipeline::error::FileError;
use crate::pipeline::files::{self, ReadFileError};
use crate::remote::address::is_address;
use crate::remote::error::RemoteError;
use crate::remote::open::{self, AddressVersion};

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
/// As [`files::read`]; the server's.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, ReadFileError> {
    match address(path) {
        Some(address) => open::read(address, most).map_err(failed(path)),
        None => files::read(path),
    }
}

/// The first bytes of an elevation file, and the file, to be read in parts.
///
/// # Errors
/// As [`files::open`]; the server's.
pub fn open(path: &Path) -> Result<(Vec<u8>, Box<dyn FileContent>), ReadFileError> {
    match address(path) {
        Some(address) => {
            let opened = open::open(address).map_err(failed(path))?;
            Ok((opened.head, opened.content))
        }
        None => Ok((files::read_head(path, read::HEAD_BYTES)?, Box::new(files::open(path)?))),
    }
}

/// What tells this version of an elevation file with an address from others.
///
/// # Errors
/// It has no address; the server's.
pub fn version(path: &Path) -> Result<String, ReadFileError> {
    let address =
        address(path).ok_or(RemoteError::Address("it has no known scheme")).map_err(failed(path))?;
    Ok(format!("{address} {}", open::version(address).map_err(failed(path))?))
}

/// Which version of an elevation file with an address its server has.
///
/// # Errors
/// It has no address; the server's.
pub fn stated_version(path: &Path) -> Result<AddressVersion, ReadFileError> {
    let address = address(path).ok_or(RemoteError::Address("it has no known scheme"));
    address.and_then(open::stated_version).map_err(failed(path))
}

/// The companions of a file. A file that is not there is none; a server that does not answer is an error of all.
pub struct CompanionFiles<'a> {
    path: &'a Path,
    most_bytes: u64,
    fault: RefCell<Option<ReadFileError>>,
}

impl<'a> CompanionFiles<'a> {
    /// Those of the file at `path`, each of at most `most_bytes` where it has an address.
    pub fn beside(path: &'a Path, most_bytes: u64) -> Self {
        Self { path, most_bytes, fault: RefCell::default() }
    }

    /// The bytes of one by its name; `None` where there is none.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        if address(self.path).is_none() {
            return files::beside(self.path)(name);
        }
        // A server that is waited for in vain is not waited for again.
        if self.fault.borrow().is_some() {
            return None;
        }
        let path = self.path.with_file_name(name);
        let found = open::read_companion(path.to_str()?, self.most_bytes);
        found.unwrap_or_else(|error| {
            self.fault.borrow_mut().get_or_insert(failed(&path)(error));
            None
        })
    }

    /// Checks that each was found or is not there.
    ///
    /// # Errors
    /// The first error of a server since the last check.
    pub fn check(&self) -> Result<(), ReadFileError> {
        self.fault.take().map_or(Ok(()), Err)
    }
}
