//! Limits on the size that a header claims, checked before memory is allocated.

use glam::{U64Vec2, UVec2};

use crate::error::DemErrorKind;
use sandtable_base::limits::memory::check_memory;
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_base::limits::{RASTER_SAMPLES, SPARSE_BYTES};

/// A sample while a raster is read: a 32-bit float, and what it is decoded from.
const BYTES_PER_SAMPLE: u64 = 8;

/// The size that a header claims, to be held against the bytes of its file.
#[derive(Clone, Copy, Debug)]
pub struct SizeClaim {
    /// Samples per row.
    pub width: u64,
    /// Rows.
    pub height: u64,
    /// The fewest bytes that a sample decodes to; 0 where a file may leave samples out.
    pub bytes_per_sample: u64,
    /// The most bytes that one byte of the file decodes to.
    pub expansion: u64,
    /// Samples that take no bytes of the file, of those that width and height claim.
    pub absent: u64,
    /// The most samples that are read.
    pub most_samples: &'static WorkLimit,
}

impl SizeClaim {
    /// A claim on plain, unpacked samples of a raster in memory.
    pub fn new(width: u64, height: u64, bytes_per_sample: u64) -> Self {
        Self { width, height, bytes_per_sample, expansion: 1, absent: 0, most_samples: &RASTER_SAMPLES }
    }

    /// Returns width and height, both at least 1.
    ///
    /// # Errors
    /// The size is 0, above the cap, or more than `file_bytes` bytes or this process's memory can hold.
    pub fn check(&self, file_bytes: usize) -> Result<UVec2, DemErrorKind> {
        let Self { width, height, most_samples, .. } = *self;
        let size = U64Vec2::new(width, height);
        let samples = width.checked_mul(height).filter(|&samples| samples <= most_samples.get());
        let samples = samples.ok_or(DemErrorKind::TooLarge { size, most: most_samples })?;
        let (Ok(columns @ 1..), Ok(rows @ 1..)) = (u32::try_from(width), u32::try_from(height)) else {
            return Err(DemErrorKind::NoSamples(size));
        };
        let sparse = if self.expansion > 1 { SPARSE_BYTES.get() } else { 0 };
        let possible = (file_bytes as u64).saturating_mul(self.expansion).saturating_add(sparse);
        if samples.saturating_sub(self.absent).saturating_mul(self.bytes_per_sample) > possible {
            return Err(match self.expansion {
                1 => DemErrorKind::Truncated { size, file_bytes },
                _ => DemErrorKind::Sparse { size, file_bytes },
            });
        }
        // Others are read in windows.
        if std::ptr::eq(most_samples, &RASTER_SAMPLES) {
            check_memory(samples * BYTES_PER_SAMPLE, "the raster", "cut or coarsen it")?;
        }
        Ok(UVec2::new(columns, rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_that_a_file_cannot_hold_are_refused() {
        assert!(SizeClaim::new(10, 10, 2).check(200).is_ok());
        assert!(SizeClaim::new(10, 10, 2).check(199).is_err());
        assert!(SizeClaim::new(0, 10, 2).check(200).is_err());
        let packed = |side, bytes| SizeClaim { expansion: 4000, ..SizeClaim::new(side, side, bytes) };
        assert!(packed(u64::MAX, 2).check(200).is_err());
        assert!(packed(1 << 14, 4).check(1000).is_err());
        let said = packed(1 << 14, 4).check(1000).map_err(|error| error.to_string());
        assert!(said.is_err_and(|said| said.ends_with("raise it with `--limit sparse-bytes=…`")));
        let absent = |absent| SizeClaim { absent, ..SizeClaim::new(10, 10, 2) };
        assert!(absent(60).check(80).is_ok() && absent(60).check(79).is_err());
    }
}
