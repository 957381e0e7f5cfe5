//! One version of a file in a store, read by ranges of its bytes.

use std::ops::Range;

use object_store::{GetOptions, GetRange, ObjectMeta};
use tokio::task::JoinSet;
use tokio::time::timeout;

use crate::error::RemoteError;
use crate::runtime::wait_for;
use crate::store::{StoredFile, store_error};

/// The most bytes that one request asks for.
pub(crate) const MOST_REQUEST_BYTES: u64 = 1 << 20;
/// Requests that are under way at once: few enough for a server of a village, enough to hide the distance of another.
const REQUESTS_AT_ONCE: usize = 4;

/// A version of a file in a store.
#[derive(Clone, Debug)]
pub(crate) struct RemoteObject {
    file: StoredFile,
    /// Bytes of the file.
    pub size: u64,
    version: ObjectVersion,
}

/// What tells versions of a file apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ObjectVersion {
    e_tag: Option<String>,
    /// Milliseconds from 1970; 0 where the server says nothing.
    modified: i64,
}

impl ObjectVersion {
    fn of(meta: &ObjectMeta) -> Self {
        Self { e_tag: meta.e_tag.clone(), modified: meta.last_modified.timestamp_millis() }
    }

    /// The text of the version; `None` where the server says nothing of it, so that nothing may be kept.
    pub fn text(&self) -> Option<String> {
        match &self.e_tag {
            None if self.modified == 0 => None,
            e_tag => Some(format!("{} {}", e_tag.as_deref().unwrap_or_default(), self.modified)),
        }
    }

    /// The ETag, or else the time of change; `None` where the server says neither.
    pub fn tag(&self) -> Option<String> {
        let modified = (self.modified != 0).then(|| format!("modified {}", self.modified));
        self.e_tag.clone().or(modified)
    }

    /// The ETag that a server compares; a weak one it does not.
    fn comparable(&self) -> Option<String> {
        self.e_tag.clone().filter(|tag| !tag.starts_with("W/"))
    }
}

impl RemoteObject {
    /// Opens a file, and reads its first bytes, at most `head` of them.
    ///
    /// # Errors
    /// The server cannot be reached or refuses, or its reply is wrong.
    pub fn open(file: StoredFile, head: u64) -> Result<(Self, Vec<u8>), RemoteError> {
        let first = file.clone();
        let (meta, bytes) = wait_for(async move { in_time(&first, read(&first, 0..head, None)).await })??;
        Ok((Self { file, size: meta.size, version: ObjectVersion::of(&meta) }, bytes))
    }

    /// An identifier of this version of the file.
    pub fn version(&self) -> &ObjectVersion {
        &self.version
    }

    /// Reads from another place from now on.
    #[cfg(test)]
    pub fn redirect(&mut self, file: StoredFile) {
        self.file = file;
    }

    /// The bytes of ranges within the file, each of at most [`MOST_REQUEST_BYTES`], some requests at once.
    ///
    /// # Errors
    /// The server cannot be reached or refuses, its reply is wrong, or the file is another by now.
    pub fn ranges(&self, ranges: Vec<Range<u64>>) -> Result<Vec<Vec<u8>>, RemoteError> {
        let object = self.clone();
        wait_for(async move {
            let mut found = vec![Vec::new(); ranges.len()];
            let (mut waiting, mut running) = (ranges.into_iter().enumerate(), JoinSet::new());
            loop {
                while running.len() < REQUESTS_AT_ONCE
                    && let Some((index, range)) = waiting.next()
                {
                    let object = object.clone();
                    running.spawn(async move { object.range(range).await.map(|bytes| (index, bytes)) });
                }
                let Some(done) = running.join_next().await else { return Ok(found) };
                let (index, bytes) =
                    done.map_err(|_| RemoteError::BrokenReply("it cannot be taken apart"))??;
                found[index] = bytes;
            }
        })?
    }

    async fn range(&self, range: Range<u64>) -> Result<Vec<u8>, RemoteError> {
        let asked = range.end - range.start;
        let (meta, bytes) = in_time(&self.file, read(&self.file, range, self.version.comparable())).await?;
        if meta.size != self.size || ObjectVersion::of(&meta) != self.version {
            return Err(RemoteError::Changed);
        }
        let got = bytes.len() as u64;
        if got == asked { Ok(bytes) } else { Err(RemoteError::Length { asked, got }) }
    }
}

/// The result of a request for bytes of a file, with all its tries.
async fn in_time<T>(
    file: &StoredFile,
    work: impl Future<Output = Result<T, RemoteError>>,
) -> Result<T, RemoteError> {
    let longest = file.times.request;
    timeout(longest, work).await.unwrap_or(Err(RemoteError::Timeout(longest)))
}

/// The bytes of a range, or of its part before the end of the file.
async fn read(
    file: &StoredFile,
    range: Range<u64>,
    if_match: Option<String>,
) -> Result<(ObjectMeta, Vec<u8>), RemoteError> {
    let options = GetOptions { range: Some(GetRange::Bounded(range)), if_match, ..GetOptions::default() };
    let reply = file.store.get_opts(&file.path, options).await.map_err(|error| store_error(&error))?;
    let (meta, asked) = (reply.meta.clone(), reply.range.end.saturating_sub(reply.range.start));
    let bytes = reply.bytes().await.map_err(|error| store_error(&error))?;
    let got = bytes.len() as u64;
    if got == asked { Ok((meta, bytes.into())) } else { Err(RemoteError::Length { asked, got }) }
}
