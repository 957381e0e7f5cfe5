//! What can be wrong with an elevation file, and the caps that a header must keep before anything is
//! allocated for it.

use crate::archive::ArchiveError;
use crate::geom::crs::CrsError;

/// The most samples a raster may have: 2²⁸, a gigabyte of 32-bit floats.
///
/// Arbitrary, but larger than any terrain that fits a scene, and small enough that a forged header cannot
/// take the machine down.
pub const MOST_SAMPLES: u64 = 1 << 28;

/// Bytes that may be decoded from a file of any size, for sparse files that hold almost nothing.
const FREE_BYTES: u64 = 64 << 20;

/// Why an elevation file was not read.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {fault}")]
pub struct DemError {
    /// The file, as the caller named it.
    pub name: String,
    /// What was wrong.
    pub fault: DemErrorKind,
}

/// What was wrong with an elevation file.
#[derive(Debug, thiserror::Error)]
pub enum DemErrorKind {
    /// Neither the content nor the extension is that of a format that is read.
    #[error(
        "{found}; elevation is read from GeoTIFF (.tif), ESRI ASCII grid (.asc), ESRI binary grid (.bil, .flt with .hdr), ENVI (.hdr), SRTM (.hgt, .hgt.zip), DTED (.dt0 to .dt2), USGS (.dem), VTP terrain (.bt, .bt.gz), Terragen (.ter), Surfer (.grd), text grids (.xyz), PNG (.png) and RAW with a stated size; convert it, for example with: gdal_translate FILE out.tif"
    )]
    UnknownFormat {
        /// What the file seems to be.
        found: String,
    },
    /// The format is read, but not this kind of it.
    #[error("this {format} uses {what}, which is not read; {remedy}")]
    Unsupported {
        /// The format.
        format: &'static str,
        /// The part that is not read.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file contradicts itself or ends too early.
    #[error("the {format} is broken: {reason}; fetch or export the file again")]
    Broken {
        /// The format.
        format: &'static str,
        /// Where and what.
        reason: String,
    },
    /// Packed content cannot be unpacked.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// More samples than are taken, or than the file can hold.
    #[error("{width} x {height} samples {reason}")]
    TooLarge {
        /// Samples per row as stated.
        width: u64,
        /// Rows as stated.
        height: u64,
        /// Which cap was broken, and what to do.
        reason: String,
    },
    /// The georeference is not understood.
    #[error("its georeference cannot be used: {reason}; {remedy}")]
    Georeference {
        /// What was found.
        reason: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The coordinate reference system is not understood.
    #[error("its coordinate system cannot be used: {0}; or state the right one as crs under [terrain]")]
    Crs(CrsError),
    /// A picture without the height of its gray values.
    #[error(
        "a PNG holds gray values, not meters: state height_scale (meters per gray value) and, where value 0 is not at 0 m, height_offset, under [terrain], or --height-scale and --height-offset on the command line"
    )]
    NoHeightScale,
    /// A color picture whose colors may be heights.
    #[error(
        "this PNG uses colors, and nothing in it says what they mean: if it is a map tile of heights, state height_encoding = \"terrain-rgb\" (Mapbox) or \"terrarium\" (Mapzen) under [terrain], or --height-encoding on the command line; if not, give the elevation as 16-bit gray, or as a GeoTIFF"
    )]
    NoHeightEncoding,
    /// Samples without a header.
    #[error(
        "a RAW file does not say what it holds: state raw = \"1201x1201:i16be\" under [terrain], or --raw 1201x1201:i16be on the command line (columns, rows, type and byte order)"
    )]
    NoRawLayout,
    /// A file that its header, a file beside it, belongs to is missing.
    #[error("this {format} needs its header, a file of the same name with .hdr, beside it; put it there")]
    NoHeader {
        /// The format.
        format: &'static str,
    },
    /// A hint that is not usable.
    #[error("{what} is {value}; it must be {wanted}")]
    Hint {
        /// Which hint.
        what: &'static str,
        /// What it was.
        value: f64,
        /// What it must be.
        wanted: &'static str,
    },
}

impl DemErrorKind {
    /// A [`DemErrorKind::Broken`].
    pub(crate) fn broken(format: &'static str, reason: impl Into<String>) -> Self {
        Self::Broken { format, reason: reason.into() }
    }
}

/// Checks a header's size before anything is allocated for it, and returns the number of samples.
///
/// `bytes_per_sample` and `file_bytes` hold the promise against what the file can contain, where one byte of
/// file can become at most `expansion` decoded bytes.
///
/// # Errors
/// [`DemErrorKind::TooLarge`], also for no sample at all.
pub(crate) fn check_size(
    size: (u64, u64),
    bytes_per_sample: u64,
    held: (usize, u64),
) -> Result<usize, DemErrorKind> {
    check_size_within(MOST_SAMPLES, size, bytes_per_sample, held)
}

/// [`check_size`] with a cap of `most` samples, for what is not allocated whole.
///
/// # Errors
/// [`DemErrorKind::TooLarge`], also for no sample at all.
pub(crate) fn check_size_within(
    most: u64,
    (width, height): (u64, u64),
    bytes_per_sample: u64,
    (file_bytes, expansion): (usize, u64),
) -> Result<usize, DemErrorKind> {
    let refused = |reason: String| DemErrorKind::TooLarge { width, height, reason };
    let samples = width.checked_mul(height).filter(|&samples| samples <= most).ok_or_else(|| {
        refused(format!(
            "are more than the {most} that are taken; cut or coarsen the file, for example with: gdal_translate -outsize 25% 25%"
        ))
    })?;
    if samples == 0 || width > u64::from(u32::MAX) || height > u64::from(u32::MAX) {
        return Err(refused("are none; the header is broken or the file is empty".into()));
    }
    let possible = (file_bytes as u64).saturating_mul(expansion);
    let possible = if expansion > 1 { possible.saturating_add(FREE_BYTES) } else { possible };
    if samples.saturating_mul(bytes_per_sample) > possible {
        return Err(refused(format!(
            "cannot be held by a file of {file_bytes} bytes; it is cut short or its header is broken"
        )));
    }
    Ok(samples as usize)
}

/// The first `N` bytes from `at`, for readers of fixed layouts.
pub(crate) fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_that_a_file_cannot_hold_are_refused() {
        assert!(check_size((10, 10), 2, (200, 1)).is_ok());
        assert!(check_size((10, 10), 2, (199, 1)).is_err());
        assert!(check_size((0, 10), 2, (200, 1)).is_err());
        assert!(check_size((u64::MAX, u64::MAX), 2, (200, 4000)).is_err());
        assert!(check_size((1 << 14, 1 << 14), 4, (1000, 4000)).is_err());
    }
}
