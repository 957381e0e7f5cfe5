//! Blocks of a TIFF that are stored in the common ways — plain, deflated or by LZW — straight from their bytes.
//!
//! The decoder gives a block as a value of its own, unpacked through a chain of small reads; nearly all elevation is
//! deflated, and a zlib stream that lies in memory can be inflated in one call into room that is kept. What is
//! uncommon goes by the decoder (see [`crate::dem::tiff::blocks`]); both give the same bits.

use flate2::{Decompress, FlushDecompress, Status};

use crate::dem::error::DemErrorKind;
use crate::dem::tiff::lzw;
use crate::dem::tiff::rows::{Elevation, RowDecoder, RowWords};
use crate::dem::tiff::storage::{FORMAT, Packing, Storage, TiffBlock};

/// Packed bytes beyond twice what a block unpacks to are not looked at; no packing needs more.
const MOST_GROWTH: usize = 2;

/// Bytes that even an empty stream may take.
const SLACK: usize = 1 << 10;

/// What unpacks blocks, with the room that it needs for one.
pub(crate) struct Unpacker<'a> {
    storage: &'a Storage,
    rows: RowDecoder,
    inflater: Decompress,
    unpacked: Vec<u8>,
    words: RowWords,
}

impl<'a> Unpacker<'a> {
    /// For an image whose no-data value is `nodata`; `None` where it is stored in another way.
    pub fn of(storage: &'a Storage, nodata: Option<f64>) -> Option<Self> {
        let rows = RowDecoder::of(storage, nodata).filter(|_| storage.packing != Packing::Other)?;
        Some(Self {
            storage,
            rows,
            inflater: Decompress::new(true),
            unpacked: Vec::new(),
            words: RowWords::default(),
        })
    }

    /// Where the packed bytes of a block lie in a file of `file_bytes` bytes; empty beyond its end.
    pub fn range(&self, block: TiffBlock, file_bytes: usize) -> Result<std::ops::Range<usize>, DemErrorKind> {
        let (start, bytes) = self.storage.place(block.index).ok_or_else(|| {
            DemErrorKind::broken(FORMAT, format!("its tables do not say where block {} lies", block.index))
        })?;
        let most = self.bytes_within(block).saturating_mul(MOST_GROWTH).saturating_add(SLACK);
        let start = usize::try_from(start).unwrap_or(usize::MAX).min(file_bytes);
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX).min(most);
        Ok(start..start.saturating_add(bytes).min(file_bytes))
    }

    /// The elevations of a block to `out`, whose rows lie `stride` apart and start where the block's do.
    ///
    /// # Errors
    /// The stream is broken or ends before the block's last row.
    ///
    /// # Panics
    /// Where `out` has no room for the block.
    pub fn fill<E: Elevation>(
        &mut self,
        packed: &[u8],
        block: TiffBlock,
        out: &mut [E],
        stride: usize,
    ) -> Result<(), DemErrorKind> {
        let needed = self.bytes_within(block);
        let rows = match self.storage.packing {
            Packing::Plain => packed.get(..needed).ok_or_else(|| short(block, packed.len(), needed))?,
            Packing::Lzw => {
                self.unpacked.resize(needed, 0);
                unpack_lzw(packed, block, &mut self.unpacked)?;
                &self.unpacked
            }
            Packing::Deflate | Packing::Other => {
                self.unpacked.resize(needed, 0);
                inflate(&mut self.inflater, packed, block, &mut self.unpacked)?;
                &self.unpacked
            }
        };
        let row_bytes = self.storage.row_bytes().max(1);
        for (row, out) in rows.chunks_exact(row_bytes).zip(out.chunks_mut(stride)) {
            E::fill(&self.rows, row, &mut self.words, &mut out[..block.width as usize]);
        }
        Ok(())
    }

    /// The bytes of those rows of a block that lie in the image.
    fn bytes_within(&self, block: TiffBlock) -> usize {
        self.storage.row_bytes() * block.height as usize
    }
}

/// Fills `out` with the first bytes of a stream; what follows them is not looked at.
fn inflate(
    inflater: &mut Decompress,
    packed: &[u8],
    block: TiffBlock,
    out: &mut [u8],
) -> Result<(), DemErrorKind> {
    inflater.reset(true);
    let (mut read, mut written) = (0, 0);
    while written < out.len() {
        let before = (inflater.total_in(), inflater.total_out());
        let status = inflater
            .decompress(&packed[read..], &mut out[written..], FlushDecompress::Finish)
            .map_err(|error| {
                DemErrorKind::broken(FORMAT, format!("block {} does not inflate: {error}", block.index))
            })?;
        read += (inflater.total_in() - before.0) as usize;
        written += (inflater.total_out() - before.1) as usize;
        let stuck = (inflater.total_in(), inflater.total_out()) == before;
        if (status == Status::StreamEnd || stuck) && written < out.len() {
            return Err(short(block, written, out.len()));
        }
    }
    Ok(())
}

fn unpack_lzw(packed: &[u8], block: TiffBlock, out: &mut [u8]) -> Result<(), DemErrorKind> {
    if lzw::is_ancient(packed) {
        return Err(DemErrorKind::Unsupported {
            format: FORMAT,
            what: "LZW in the order of bits of before 1991".into(),
            remedy: "convert it, for example with: gdal_translate -co COMPRESS=DEFLATE FILE out.tif",
        });
    }
    match lzw::unpack(packed, out) {
        written if written < out.len() => Err(short(block, written, out.len())),
        _ => Ok(()),
    }
}

fn short(block: TiffBlock, found: usize, wanted: usize) -> DemErrorKind {
    let index = block.index;
    DemErrorKind::broken(FORMAT, format!("block {index} holds {found} of the {wanted} bytes of its rows"))
}
