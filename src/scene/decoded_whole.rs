//! Large elevation files on disk, decoded whole block by block, so that their bytes are not held beside their samples.

use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::{RasterWindow, WINDOW_CACHE_BYTES, Windows};

/// Whether a file of so many `bytes` may be large: one byte holds no more than a sample. What is not is opened once, to be read
/// whole.
pub(super) fn may_be_large(bytes: u64) -> bool {
    bytes > (WINDOW_CACHE_BYTES / size_of::<f64>()) as u64
}

/// All samples of a large file of so many `bytes`; `None` for a small one, and for one that cannot be read so.
pub(super) fn decoded_whole(mut windows: Box<dyn Windows + Send>, bytes: u64) -> Option<Raster> {
    let (size, is_wide) = (windows.size(), windows.metadata().samples.is_wide());
    let samples = u64::from(size.0) * u64::from(size.1);
    let sample_bytes = if is_wide { size_of::<f64>() } else { size_of::<f32>() } as u64;
    // A small file may claim to hold many samples that were never written.
    let is_large =
        samples * sample_bytes > WINDOW_CACHE_BYTES as u64 && samples <= RASTER_SAMPLES.get().min(bytes);
    let samples = is_large.then(|| windows.samples(RasterWindow::all(size)).ok()).flatten()?;
    Some(Raster { samples, ..windows.metadata().without_samples() })
}
