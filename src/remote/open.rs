//! Opening files by their addresses.

use crate::error::RemoteError;
use sandtable_raster::content::FileContent;

#[cfg(feature = "cloud")]
use crate::access::RemoteAccess;
#[cfg(feature = "cloud")]
use crate::address::RemoteAddress;
#[cfg(feature = "cloud")]
use crate::file::RemoteFile;
#[cfg(feature = "cloud")]
use crate::store::StoredFile;
#[cfg(feature = "cloud")]
use crate::times::RemoteTimes;

/// A file that is read in parts, and its first bytes.
pub struct OpenedAddress {
    /// The first bytes, enough to know the format by.
    pub head: Vec<u8>,
    /// All of it.
    pub content: Box<dyn FileContent>,
}

/// The version of a file on its server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddressVersion {
    /// Bytes of the file.
    pub bytes: u64,
    /// Its ETag, or else its time of change; `None` where the server says neither.
    pub tag: Option<String>,
}

/// Opens the file at an address, to be read in parts.
///
/// # Errors
/// [`RemoteError`].
#[cfg(feature = "cloud")]
pub fn open(address: &str) -> Result<OpenedAddress, RemoteError> {
    let mut file = open_file(address)?;
    Ok(OpenedAddress { head: file.head(), content: Box::new(file) })
}

/// The bytes of the file at an address, which has at most `most`.
///
/// # Errors
/// [`RemoteError`].
#[cfg(feature = "cloud")]
pub fn read(address: &str, most: u64) -> Result<Vec<u8>, RemoteError> {
    open_file(address)?.read_whole(most)
}

/// An identifier of the version of the file at an address: the same text for the same content.
///
/// # Errors
/// [`RemoteError`].
#[cfg(feature = "cloud")]
pub fn version(address: &str) -> Result<String, RemoteError> {
    Ok(open_file(address)?.version())
}

/// The version of the file at an address that its server states.
///
/// # Errors
/// [`RemoteError`].
#[cfg(feature = "cloud")]
pub fn stated_version(address: &str) -> Result<AddressVersion, RemoteError> {
    Ok(open_file(address)?.stated_version())
}

#[cfg(feature = "cloud")]
fn open_file(address: &str) -> Result<RemoteFile, RemoteError> {
    let parsed = RemoteAddress::parse(address).ok_or(RemoteError::Address("it has no known scheme"))??;
    let access = RemoteAccess::of_run();
    let file = StoredFile::at(&parsed, &access, RemoteTimes::default())?;
    RemoteFile::open(file, &parsed.to_string(), access.blocks.as_deref())
}

#[cfg(not(feature = "cloud"))]
#[allow(missing_docs, reason = "see the other build")]
pub fn open(_: &str) -> Result<OpenedAddress, RemoteError> {
    Err(RemoteError::NotBuilt)
}

#[cfg(not(feature = "cloud"))]
#[allow(missing_docs, reason = "see the other build")]
pub fn read(_: &str, _: u64) -> Result<Vec<u8>, RemoteError> {
    Err(RemoteError::NotBuilt)
}

#[cfg(not(feature = "cloud"))]
#[allow(missing_docs, reason = "see the other build")]
pub fn version(_: &str) -> Result<String, RemoteError> {
    Err(RemoteError::NotBuilt)
}

#[cfg(not(feature = "cloud"))]
#[allow(missing_docs, reason = "see the other build")]
pub fn stated_version(_: &str) -> Result<AddressVersion, RemoteError> {
    Err(RemoteError::NotBuilt)
}

/// The bytes of a companion of a file, by its own address; `None` where there is none.
///
/// # Errors
/// [`RemoteError`], but for one that is not there.
pub fn read_companion(address: &str, most: u64) -> Result<Option<Vec<u8>>, RemoteError> {
    match read(address, most) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.is_absence() => Ok(None),
        Err(error) => Err(error),
    }
}
