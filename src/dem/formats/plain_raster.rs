//! Rasters whose samples lie unpacked in their file: read whole, or in windows by their places.

use std::io::{Read, Seek, SeekFrom};

use crate::dem_file::DemFile;
use crate::formats::sample_layout::{FileSize, NoData, SampleLayout};
use sandtable_base::limits::WINDOWED_SAMPLES;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_raster::windows::{RasterWindow, Windows};

/// A raster and the places of its samples.
pub(super) struct PlainRaster {
    /// The raster without its samples.
    raster: Raster,
    layout: SampleLayout,
    nodata: NoData,
    scale: f64,
    offset: f64,
}

/// What a format says of a file of a given size; only its first bytes are there.
type PlainHeader = fn(&DemFile, FileSize) -> Result<PlainRaster, DemErrorKind>;

impl PlainRaster {
    /// The samples of `raster` in `layout`, unscaled; `raster` holds no samples.
    pub fn new(raster: Raster, layout: SampleLayout, nodata: NoData) -> Self {
        Self { raster, layout, nodata, scale: 1.0, offset: 0.0 }
    }

    /// This raster with heights that are its samples times `scale` plus `offset`.
    pub fn scaled(self, scale: f64, offset: f64) -> Self {
        Self { scale, offset, ..self }
    }
}

/// Reads a file whole.
pub(super) fn read(file: &DemFile, header: PlainHeader) -> Result<Raster, DemErrorKind> {
    let PlainRaster { raster, layout, nodata, scale, offset } =
        header(file, FileSize::in_memory(file.bytes))?;
    Ok(Raster { samples: layout.samples(file.bytes, nodata).scaled(scale, offset), ..raster })
}

/// Opens a file to be read in windows.
pub(super) fn windows(
    file: &DemFile,
    mut content: Box<dyn FileContent>,
    header: PlainHeader,
) -> Result<Box<dyn Windows + Send>, DemErrorKind> {
    let length =
        content.seek(SeekFrom::End(0)).map_err(|fault| DemErrorKind::unread("elevation file", fault))?;
    let size = FileSize { bytes: length as usize, most_samples: &WINDOWED_SAMPLES };
    let mut plain = header(file, size)?;
    let is_wide = plain.layout.sample.is_wide() || plain.scale != 1.0 || plain.offset != 0.0;
    plain.raster.samples = Samples::absent(0, is_wide);
    Ok(Box::new(PlainWindows { plain, content }))
}

struct PlainWindows {
    plain: PlainRaster,
    content: Box<dyn FileContent>,
}

impl Windows for PlainWindows {
    fn metadata(&self) -> &Raster {
        &self.plain.raster
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let PlainRaster { raster, layout, nodata, scale, offset } = &self.plain;
        let (lines, layout) = layout.lines(window);
        self.content.announce(&lines);
        let mut bytes = vec![0; lines.iter().map(|line| (line.end - line.start) as usize).sum()];
        let mut rest = &mut bytes[..];
        for line in lines {
            let (into, later) = rest.split_at_mut((line.end - line.start) as usize);
            let read =
                self.content.seek(SeekFrom::Start(line.start)).and_then(|_| self.content.read_exact(into));
            read.map_err(|fault| DemErrorKind::unread(raster.driver, fault))?;
            rest = later;
        }
        Ok(layout.samples(&bytes, *nodata).scaled(*scale, *offset))
    }
}
