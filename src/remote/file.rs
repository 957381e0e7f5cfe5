//! A remote file that is read and sought like one on disk, in blocks that are fetched where they are needed.
//!
//! Blocks are small, so that little is fetched beside what is read, and neighboring blocks are fetched by one request, so that
//! they are no slower for it. What is read on and on, as tables of tiles are, is fetched ahead by a quarter of what was read.

use std::collections::BTreeSet;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use std::slice;
use std::time::{Duration, Instant};

use crate::blocks_on_disk::BlocksOnDisk;
use crate::error::RemoteError;
use crate::object::{MOST_REQUEST_BYTES, RemoteObject};
use crate::open::AddressVersion;
use crate::store::StoredFile;
use sandtable_raster::cache::LruCache;
use sandtable_raster::content::FileContent;

/// Bytes of a block. A tile of a GeoTIFF has some ten of them, so that the parts of blocks around it that are not read are a
/// tenth of it; of larger blocks more would be fetched beside it, of smaller ones the lists would grow.
pub(crate) const BLOCK_BYTES: u64 = 8 << 10;
/// The most blocks of one request.
const MOST_REQUEST_BLOCKS: u64 = MOST_REQUEST_BYTES / BLOCK_BYTES;
/// The most bytes of a file that are kept in memory.
const MEMORY_BYTES: u64 = 32 << 20;
/// The most bytes that are held for one read, and that are fetched at once: less than is kept.
const MOST_AT_ONCE: u64 = MEMORY_BYTES / 2;
/// The most bytes that are taken from disk into memory beside what is wanted.
const MOST_BESIDE: u64 = MEMORY_BYTES / 4;
/// How long an error of fetching stands for the next reads: each tile of a window would wait for a dead server in its turn.
const FAILURE_STANDS: Duration = Duration::from_secs(5);
/// Of what was read on and on, the part that is fetched ahead.
const AHEAD: u64 = 4;

/// A remote file.
#[derive(Debug)]
pub(crate) struct RemoteFile {
    object: RemoteObject,
    at: u64,
    blocks: LruCache<u64, Vec<u8>>,
    on_disk: Option<BlocksOnDisk>,
    /// The block after those that were read last, and how many these are.
    next: u64,
    run: u64,
    /// The last error of fetching, and when it was.
    failure: Option<(RemoteError, Instant)>,
}

impl RemoteFile {
    /// Opens a file of an address, whose blocks lie in a folder on disk, if any.
    ///
    /// # Errors
    /// See [`RemoteObject::open`].
    pub fn open(file: StoredFile, address: &str, disk: Option<&Path>) -> Result<Self, RemoteError> {
        let (object, head) = RemoteObject::open(file, BLOCK_BYTES)?;
        let on_disk = disk.zip(object.version().text()).map(|(folder, version)| {
            BlocksOnDisk::new(folder, address, &format!("{} {version}", object.size))
        });
        let blocks = LruCache::new(MEMORY_BYTES as usize);
        let mut file = Self { object, at: 0, blocks, on_disk, next: 1, run: 1, failure: None };
        file.put(0, &head);
        Ok(file)
    }

    /// Bytes of the file.
    pub fn size(&self) -> u64 {
        self.object.size
    }

    /// The first bytes, at most a block of them.
    pub fn head(&mut self) -> Vec<u8> {
        self.blocks.get(0).cloned().unwrap_or_default()
    }

    /// An identifier of this version of the file: its size, and the version that the server states.
    pub fn version(&self) -> String {
        format!("{} {}", self.object.size, self.object.version().text().unwrap_or_default())
    }

    /// The version of the file on its server.
    pub fn stated_version(&self) -> AddressVersion {
        AddressVersion { bytes: self.object.size, tag: self.object.version().tag() }
    }

    /// All bytes of a file that has at most `most`.
    ///
    /// # Errors
    /// [`RemoteError::TooLarge`], and those of reading.
    pub fn read_whole(mut self, most: u64) -> Result<Vec<u8>, RemoteError> {
        let size = self.size();
        let too_large = || RemoteError::TooLarge { bytes: size, most };
        let mut bytes = Vec::new();
        usize::try_from(size).ok().filter(|_| size <= most).ok_or_else(too_large)?;
        while let start = bytes.len() as u64
            && start < size
        {
            // What a server claims is not taken before it is there.
            let part = start..size.min(start + MOST_AT_ONCE);
            self.hold(slice::from_ref(&part))?;
            bytes.try_reserve((part.end - part.start) as usize).map_err(|_| too_large())?;
            for block in blocks_of(&part) {
                let held = self.blocks.take(block);
                bytes.extend(held.ok_or(RemoteError::BrokenReply("a block of it is missing"))?);
            }
        }
        Ok(bytes)
    }

    /// Bytes of `count` blocks from `first` on, of which the file's last may be shorter.
    fn bytes_of(size: u64, first: u64, count: u64) -> u64 {
        let end = first.saturating_add(count).saturating_mul(BLOCK_BYTES).min(size);
        end.saturating_sub(first.saturating_mul(BLOCK_BYTES))
    }

    /// Caches the blocks of bytes that begin with a block.
    fn put(&mut self, first: u64, bytes: &[u8]) {
        for (block, bytes) in (first..).zip(bytes.chunks(BLOCK_BYTES as usize)) {
            self.blocks.put(block, bytes.to_vec(), bytes.len());
        }
    }

    /// Fetches the blocks of ranges within the file, of at most [`MOST_AT_ONCE`] together, that are neither in memory nor on
    /// disk.
    fn hold(&mut self, ranges: &[Range<u64>]) -> Result<(), RemoteError> {
        let size = self.size();
        let wanted: BTreeSet<u64> = ranges.iter().flat_map(blocks_of).collect();
        // A use, so that what is wanted stays while the rest is fetched.
        let mut missing: BTreeSet<u64> =
            wanted.iter().copied().filter(|block| self.blocks.get(*block).is_none()).collect();
        let mut beside = 0;
        for block in missing.clone() {
            let on_disk = self.on_disk.as_mut().filter(|_| missing.contains(&block));
            let Some((first, bytes)) = on_disk
                .and_then(|disk| disk.part_with(block, |first, count| Self::bytes_of(size, first, count)))
            else {
                continue;
            };
            // What else the part holds is kept as far as it leaves what is wanted in memory.
            let keeps_all = beside + bytes.len() as u64 <= MOST_BESIDE;
            beside += if keeps_all { bytes.len() as u64 } else { 0 };
            for (block, bytes) in (first..).zip(bytes.chunks(BLOCK_BYTES as usize)) {
                if missing.remove(&block) || keeps_all {
                    self.blocks.put(block, bytes.to_vec(), bytes.len());
                }
            }
        }
        if !missing.is_empty() {
            self.fetch(self.with_ahead(missing))?;
        }
        if let Some(last) = wanted.last() {
            let first = wanted.first().copied().unwrap_or_default();
            let goes_on = first <= self.next && *last + 1 >= self.next;
            let read = *last + 1 - first;
            self.run = if goes_on { self.run + (last + 1).saturating_sub(self.next) } else { read };
            self.next = last + 1;
        }
        Ok(())
    }

    /// The blocks that are missing, with those to be fetched ahead where the read goes on from the one before.
    fn with_ahead(&self, mut missing: BTreeSet<u64>) -> BTreeSet<u64> {
        let blocks = self.size().div_ceil(BLOCK_BYTES);
        // Of tables little is read at once; of tiles, all that is wanted.
        if missing.len() <= 2 && missing.first() == Some(&self.next) {
            let last = missing.last().copied().unwrap_or_default();
            let ahead = (self.run / AHEAD).min(MOST_REQUEST_BLOCKS);
            missing.extend(
                (last + 1..(last + 1 + ahead).min(blocks)).filter(|block| !self.blocks.contains(*block)),
            );
        }
        missing
    }

    fn fetch(&mut self, missing: BTreeSet<u64>) -> Result<(), RemoteError> {
        let size = self.size();
        let runs = runs_of(&missing);
        let ranges = runs.iter().map(|run| {
            run.start * BLOCK_BYTES
                ..(run.start * BLOCK_BYTES + Self::bytes_of(size, run.start, run.end - run.start))
        });
        if let Some((error, _)) = self.failure.as_ref().filter(|(_, at)| at.elapsed() < FAILURE_STANDS) {
            return Err(error.clone());
        }
        let found = self.object.ranges(ranges.collect());
        self.failure = found.as_ref().err().map(|error| (error.clone(), Instant::now()));
        let found = found?;
        for (run, bytes) in runs.iter().zip(found) {
            if let Some(disk) = &mut self.on_disk {
                disk.keep(run.start, run.end - run.start, &bytes);
            }
            self.put(run.start, &bytes);
        }
        Ok(())
    }
}

/// The blocks that a range of bytes meets.
fn blocks_of(range: &Range<u64>) -> Range<u64> {
    range.start / BLOCK_BYTES..range.end.div_ceil(BLOCK_BYTES)
}

/// Neighboring blocks, joined as far as one request goes.
fn runs_of(blocks: &BTreeSet<u64>) -> Vec<Range<u64>> {
    let mut runs: Vec<Range<u64>> = Vec::new();
    for &block in blocks {
        match runs.last_mut() {
            Some(run) if run.end == block && run.end - run.start < MOST_REQUEST_BLOCKS => run.end += 1,
            _ => runs.push(block..block + 1),
        }
    }
    runs
}

impl Read for RemoteFile {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let end = self.size().min(self.at.saturating_add((out.len() as u64).min(MOST_AT_ONCE)));
        if self.at >= end {
            return Ok(0);
        }
        self.hold(slice::from_ref(&(self.at..end))).map_err(io::Error::other)?;
        let mut filled = 0;
        for block in blocks_of(&(self.at..end)) {
            let held = self.blocks.get(block).ok_or_else(|| io::Error::other("a block is missing"))?;
            let from = (self.at + filled as u64 - block * BLOCK_BYTES) as usize;
            let count = (held.len() - from).min((end - self.at) as usize - filled);
            out[filled..filled + count].copy_from_slice(&held[from..from + count]);
            filled += count;
        }
        self.at += filled as u64;
        Ok(filled)
    }
}

impl Seek for RemoteFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::End(by) => self.size().checked_add_signed(by),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
        };
        self.at = at.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        Ok(self.at)
    }
}

impl FileContent for RemoteFile {
    fn announce(&mut self, ranges: &[Range<u64>]) {
        let (size, mut total) = (self.size(), 0);
        let within = ranges.iter().map(|range| range.start.min(size)..range.end.min(size));
        let fitting = within.filter(|range| !range.is_empty()).take_while(|range| {
            total += range.end - range.start + 2 * BLOCK_BYTES;
            total <= MOST_AT_ONCE
        });
        // What cannot be fetched is an error of the read that needs it.
        let _ = self.hold(&fitting.collect::<Vec<_>>());
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use object_store::memory::InMemory;
    use object_store::path::Path as StorePath;
    use object_store::{ObjectStore, ObjectStoreExt, PutPayload};
    use proptest::prelude::*;

    use super::*;
    use crate::runtime::wait_for;
    use crate::times::RemoteTimes;

    fn content(count: usize, seed: u8) -> Vec<u8> {
        (0..count).map(|at| (at / 7 % 251) as u8 ^ (at >> 11) as u8 ^ seed).collect()
    }

    fn put(store: &Arc<InMemory>, bytes: Vec<u8>) {
        let store = Arc::clone(store);
        let put =
            async move { store.put(&StorePath::from("a.tif"), PutPayload::from(bytes)).await.map(drop) };
        wait_for(put).expect("a thread").expect("put");
    }

    fn stored(bytes: Vec<u8>) -> (Arc<InMemory>, StoredFile) {
        let store = Arc::new(InMemory::new());
        put(&store, bytes);
        let shared: Arc<dyn ObjectStore> = Arc::<InMemory>::clone(&store);
        let path = StorePath::from("a.tif");
        (store, StoredFile { store: shared, path, times: RemoteTimes::default() })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn what_is_read_is_what_the_file_holds(
            size in 1..200_000usize,
            reads in proptest::collection::vec((0..210_000u64, 0..90_000usize, any::<bool>()), 1..20),
        ) {
            let bytes = content(size, 0);
            let mut file = RemoteFile::open(stored(bytes.clone()).1, "s3://b/a.tif", None).expect("sound");
            prop_assert_eq!(file.head(), &bytes[..size.min(BLOCK_BYTES as usize)]);
            for (at, count, is_announced) in reads {
                let range = (at as usize).min(size)..(at as usize + count).min(size).max((at as usize).min(size));
                if is_announced {
                    file.announce(slice::from_ref(&(at..at + count as u64)));
                }
                file.seek(SeekFrom::Start(at)).expect("sought");
                let mut found = Vec::new();
                (&mut file).take(count as u64).read_to_end(&mut found).expect("read");
                prop_assert_eq!(&found, &bytes[range]);
            }
            prop_assert_eq!(file.read_whole(size as u64).expect("read"), bytes);
        }
    }

    #[test]
    fn a_file_that_changes_while_it_is_read_is_an_error() {
        let (store, place) = stored(content(100_000, 0));
        let mut file = RemoteFile::open(place, "s3://b/a.tif", None).expect("sound");
        put(&store, content(100_000, 1));
        file.seek(SeekFrom::Start(50_000)).expect("sought");
        let error = file.read(&mut [0; 10]).expect_err("it changed");
        assert!(error.to_string().contains("changed while it was read"), "{error}");
    }

    #[test]
    fn blocks_on_disk_are_read_in_place_of_the_store() {
        let folder = std::env::temp_dir().join(format!("sandtable-remote-file-{}", std::process::id()));
        let bytes = content(300_000, 0);
        let (_, place) = stored(bytes.clone());
        let open = || RemoteFile::open(place.clone(), "s3://b/a.tif", Some(&folder)).expect("sound");
        let mut found = vec![0; 100_000];
        let read = |file: &mut RemoteFile, out: &mut Vec<u8>| {
            file.seek(SeekFrom::Start(70_000)).and_then(|_| file.read_exact(out)).expect("read");
        };
        read(&mut open(), &mut found);
        assert_eq!(found, bytes[70_000..170_000]);
        // Bytes that are on disk are not asked for: the store would not have them any more.
        let mut later = open();
        let (_, gone) = stored(content(1, 0));
        later.object.redirect(gone);
        read(&mut later, &mut found);
        assert_eq!(found, bytes[70_000..170_000]);
        assert!(later.seek(SeekFrom::Start(290_000)).and_then(|_| later.read(&mut [0; 9])).is_err());
        std::fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn neighboring_blocks_are_one_request_and_a_request_has_a_bound() {
        let blocks = BTreeSet::from_iter([1, 2, 3, 7].into_iter().chain(100..300));
        let runs = runs_of(&blocks);
        assert_eq!(runs, [1..4, 7..8, 100..228, 228..300]);
    }

    #[test]
    fn what_is_read_whole_has_a_bound() {
        let (_, place) = stored(content(5000, 0));
        let open = || RemoteFile::open(place.clone(), "s3://b/a.tif", None).expect("sound");
        assert_eq!(open().read_whole(4999), Err(RemoteError::TooLarge { bytes: 5000, most: 4999 }));
        assert_eq!(open().read_whole(5000).map(|bytes| bytes.len()), Ok(5000));
    }
}
