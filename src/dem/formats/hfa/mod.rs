//! Erdas Imagine rasters (`.img`): a Hierarchical File Architecture (HFA) with a layer of samples in blocks.
//!
//! ```text
//! root ── Layer_1 (Eimg_Layer)          columns, rows, type of samples, columns and rows of a block
//!         ├── RasterDMS (Edms_State)    where each block lies, and whether it is packed
//!         ├── Eimg_NonInitializedValue  the value for no data
//!         ├── Map_Info (Eprj_MapInfo)   the centers of the first and the last sample, the size of a cell
//!         ├── MapToPixelXForm           the same of a layer that is turned, see [`turned`]
//!         ├── Projection, ProjectionX   the coordinate system, see [`projection`]
//!         └── Statistics, overviews …   not read
//! ```
//!
//! Specification: Erdas, *Imagine .img Files* (On-Line Manuals, "File Formats and Extensions"), 1999. Everything has the least
//! significant byte first. Of several layers the first is read. The layouts of the types above are the same in all files,
//! so the dictionary that each file has of them is not read. Samples may lie in a second file of any size (`.ige`): such
//! are refused.

mod blocks;
mod fault;
mod layer;
mod projection;
mod tree;
mod turned;

use std::io::Cursor;

use glam::{DAffine2, DVec2};

use crate::dem_file::DemFile;
use crate::dem_format::{DemFormat, Recognition, any_size};
use crate::formats::hfa::blocks::HfaBlocks;
use crate::formats::hfa::fault::{NAME, broken, unsupported};
use crate::formats::hfa::layer::{HfaLayer, sample_type};
use crate::formats::hfa::projection::HfaPlace;
use crate::formats::hfa::tree::{HfaFields, HfaNode, HfaTree};
use sandtable_base::limits::work_limit::WorkLimit;
use sandtable_base::limits::{RASTER_SAMPLES, WINDOWED_SAMPLES};
use sandtable_raster::cache::LruCache;
use sandtable_raster::content::FileContent;
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::{Raster, Samples, north_up};
use sandtable_raster::windows::{RasterWindow, Windows};

pub(super) static FORMAT: DemFormat = DemFormat {
    name: NAME,
    extensions: &["img"],
    shared_extensions: &[],
    recognition: Recognition::Content {
        matches: |bytes| bytes.starts_with(tree::MAGIC),
        start: "EHFA_HEADER_TAG",
    },
    reader: read,
    windows: Some(|file, content, cache_bytes| {
        Ok(Box::new(HfaWindows::open(file, content, cache_bytes, &WINDOWED_SAMPLES)?))
    }),
    most_bytes: any_size,
    writer: None,
    windows_writer: None,
};

fn read(file: &DemFile) -> Result<Raster, DemErrorKind> {
    let mut windows = HfaWindows::open(file, Cursor::new(file.bytes), 0, &RASTER_SAMPLES)?;
    let samples = windows.samples(RasterWindow::all(windows.size()))?;
    Ok(Raster { samples, ..windows.raster })
}

/// The first layer of a file, read in windows.
struct HfaWindows<R> {
    tree: HfaTree<R>,
    layer: HfaLayer,
    blocks: HfaBlocks,
    /// The raster without its samples.
    raster: Raster,
    kept: LruCache<u32, Samples>,
}

impl<R: FileContent> HfaWindows<R> {
    /// Opens a file of at most `most` samples, of which up to `cache_bytes` are kept.
    fn open(
        file: &DemFile,
        content: R,
        cache_bytes: usize,
        most: &'static WorkLimit,
    ) -> Result<Self, DemErrorKind> {
        let tree = HfaTree::new(content)?;
        let node = tree.children(tree.root()?).find_map(|node| match node {
            Ok(node) if node.kind != "Eimg_Layer" => None,
            other => Some(other),
        });
        let node = node.ok_or_else(|| broken("it has no layer of samples"))??;
        let layer = HfaLayer::read(&tree, &node)?;
        let child = |kind: &str| tree.child(&node, |node| node.kind == kind);
        let nodata = match child("Eimg_NonInitializedValue")? {
            Some(node) => Some(value(&mut tree.fields(&node)?)?),
            None => None,
        };
        let blocks = match child("Edms_State")? {
            Some(state) => HfaBlocks::read(&tree, &state, &layer, most)?,
            None => return Err(elsewhere(&tree, &node)?),
        };
        let place = HfaPlace::read(&tree, &node)?;
        let stated = match &place {
            Some(place) => Some(place.map_from_grid()),
            None => turned::map_from_grid(&tree, &node)?,
        };
        let raster = Raster::without_place(layer.columns, layer.rows);
        let raster = file.placed(raster, stated, &["igw", "imgw", "wld"])?;
        let raster = Raster {
            driver: "HFA",
            data_type: layer.sample.gdal_name(),
            samples: Samples::absent(0, layer.sample.is_wide()),
            crs: file.crs_or(|| projection::crs(&tree, &node, place.as_ref()))?,
            nodata,
            ..raster
        };
        Ok(Self { tree, layer, blocks, raster, kept: LruCache::new(cache_bytes) })
    }

    /// Copies the samples that a block shares with a window.
    fn copy(
        &mut self,
        block: RasterWindow,
        index: u32,
        window: RasterWindow,
        out: &mut Samples,
    ) -> Result<(), DemErrorKind> {
        let decoded = match self.kept.take(index) {
            Some(kept) => kept,
            None => self.blocks.samples(&self.tree, index as usize, &self.layer, self.raster.nodata)?,
        };
        for (to, from) in window.shared_rows(block) {
            out.copy_from(to, &decoded, from);
        }
        let bytes = decoded.bytes();
        self.kept.put(index, decoded, bytes);
        Ok(())
    }
}

impl<R: FileContent> Windows for HfaWindows<R> {
    fn metadata(&self) -> &Raster {
        &self.raster
    }

    fn samples(&mut self, window: RasterWindow) -> Result<Samples, DemErrorKind> {
        window.assert_within(self.size());
        let (width, height) = (self.layer.block_columns, self.layer.block_rows);
        let (across, _) = self.layer.blocks_across_and_down();
        let span = |first: u32, count: u32, block: u32| first / block..(first + count).div_ceil(block);
        let columns = span(window.column, window.width, width);
        let met: Vec<(u32, u32)> = span(window.row, window.height, height)
            .flat_map(|down| columns.clone().map(move |across| (across, down)))
            .collect();
        let index = |(column, row): (u32, u32)| row * across as u32 + column;
        let missing = met.iter().map(|&at| index(at)).filter(|&index| !self.kept.contains(index));
        let mut announced: Vec<_> =
            missing.filter_map(|index| self.blocks.stored(index as usize, &self.layer)).collect();
        announced.sort_by_key(|range| range.start);
        self.tree.announce(&announced);
        let mut samples = Samples::absent(window.samples(), self.layer.sample.is_wide());
        for at in met {
            let block = RasterWindow { column: at.0 * width, row: at.1 * height, width, height };
            self.copy(block, index(at), window, &mut samples)?;
        }
        Ok(samples)
    }
}

/// Why a layer has no samples in this file.
fn elsewhere(tree: &HfaTree<impl FileContent>, layer: &HfaNode) -> Result<DemErrorKind, DemErrorKind> {
    let external = tree.child(layer, |node| node.kind == "ImgExternalRaster")?;
    Ok(match external {
        Some(_) => unsupported("samples in another file, of the extension .ige"),
        None => broken("its layer has no table of blocks"),
    })
}

/// The only value of a pointer to a matrix.
fn value(fields: &mut HfaFields) -> Result<f64, DemErrorKind> {
    let count = fields.pointer()?;
    let (rows, columns, kind, _object) = (fields.u32()?, fields.u32()?, fields.u16()?, fields.u16()?);
    let sample = sample_type(kind)?;
    if count == 0 || rows == 0 || columns == 0 {
        return Err(broken("its value for no data is none"));
    }
    fields.sample(sample)
}

impl HfaPlace {
    fn map_from_grid(&self) -> DAffine2 {
        let cell = if self.runs_south { self.cell } else { DVec2::new(self.cell.x, -self.cell.y) };
        north_up(self.first - DVec2::new(0.5, -0.5) * cell, cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::hfa::tree::tests::{HfaFile, pointer};
    use crate::hints::DemHints;
    use crate::read;

    fn raster(bytes: &[u8]) -> Result<Raster, String> {
        read::read("a.img", bytes, &DemHints::default()).map_err(|error| error.to_string())
    }

    /// A layer of 3 × 2 samples of 16 bits in blocks of 2 × 2, the first as they are, the second by runs; 9 is no data.
    fn layer() -> HfaFile {
        let mut file = HfaFile::default();
        let plain = file.put(&[1, -2, 9, 4].map(i16::to_le_bytes).concat());
        // The least value, two runs, the place of their values; values of 8 bits; a run of 1 and one of 3.
        let packed = [
            &(-5_i32).to_le_bytes()[..],
            &2_i32.to_le_bytes(),
            &16_i32.to_le_bytes(),
            &[8, 1, 0x40, 3, 15, 11],
        ]
        .concat();
        let runs = file.put(&packed);
        let block = |offset: u32, size: u32, valid: u16, packing: u16| {
            [
                &0_u16.to_le_bytes()[..],
                &offset.to_le_bytes(),
                &size.to_le_bytes(),
                &valid.to_le_bytes(),
                &packing.to_le_bytes(),
            ]
            .concat()
        };
        let mut state = [2_u32, 4, 8].map(u32::to_le_bytes).concat();
        state.extend(1_u16.to_le_bytes());
        let table = [block(plain, 8, 1, 0), block(runs, packed.len() as u32, 1, 1)].concat();
        state.extend(pointer(2, &table));
        let mut head = [3_u32, 2].map(u32::to_le_bytes).concat();
        head.extend([1_u16, 6].map(u16::to_le_bytes).concat());
        head.extend([2_u32, 2].map(u32::to_le_bytes).concat());
        let nodata = [&[1, 0, 0, 0, 1, 0, 0, 0, 10, 0, 0, 0][..], &9_f64.to_le_bytes()].concat();
        file.node("Layer_1", "Eimg_Layer", &head);
        file.child("RasterDMS", "Edms_State", &state);
        file.child("Eimg_NonInitializedValue", "Eimg_NonInitializedValue", &pointer(1, &nodata));
        file
    }

    #[test]
    fn blocks_of_samples_and_of_runs_make_a_raster() {
        let mut file = layer();
        let pair = |x: f64, y: f64| pointer(1, &[x, y].map(f64::to_le_bytes).concat());
        let text = |text: &[u8]| pointer(text.len() as u32, text);
        let map = [text(b"a\0"), pair(105.0, 195.0), pair(125.0, 185.0), pair(10.0, 10.0), text(b"meters\0")]
            .concat();
        file.child("Map_Info", "Eprj_MapInfo", &map);
        let raster = raster(&file.bytes()).expect("sound");
        assert_eq!((raster.width, raster.height, raster.nodata), (3, 2, Some(9.0)));
        // The values 15 and 11 of runs, above −5.
        assert_eq!(
            [raster.at(0, 0), raster.at(1, 0), raster.at(2, 0), raster.at(1, 1), raster.at(2, 1)],
            [1.0, -2.0, 10.0, 4.0, 6.0]
        );
        assert!(raster.at(0, 1).is_nan());
        assert_eq!((raster.driver, raster.data_type), ("HFA", "Int16"));
        assert_eq!(raster.geotransform(), [100.0, 10.0, 0.0, 200.0, 0.0, -10.0]);
        assert!(raster.georeferenced && raster.crs.is_none());
    }

    #[test]
    fn samples_beside_the_file_and_other_strange_things_are_refused() {
        let mut beside = HfaFile::default();
        let head = [
            &[3_u32, 2].map(u32::to_le_bytes).concat()[..],
            &[1, 0, 6, 0],
            &[2_u32, 2].map(u32::to_le_bytes).concat(),
        ]
        .concat();
        beside.node("Layer_1", "Eimg_Layer", &head);
        assert!(raster(&beside.bytes()).expect_err("no samples").contains("no table of blocks"));
        beside.child("ExternalRasterDMS", "ImgExternalRaster", &[0; 8]);
        assert!(raster(&beside.bytes()).expect_err("elsewhere").contains(".ige"));
        assert!(raster(&HfaFile::default().bytes()).expect_err("empty").contains("no layer"));
        let mut bits = HfaFile::default();
        bits.node("Layer_1", "Eimg_Layer", &[&head[..10], &[0, 0], &head[12..]].concat());
        assert!(raster(&bits.bytes()).expect_err("bits").contains("less than 8 bits"));
        let mut vast = HfaFile::default();
        vast.node("Layer_1", "Eimg_Layer", &[&[0xff; 8][..], &head[8..]].concat());
        vast.child("RasterDMS", "Edms_State", &[0; 40]);
        assert!(raster(&vast.bytes()).expect_err("vast").contains("4294967295 x 4294967295"));
    }

    #[test]
    fn a_file_cut_anywhere_or_with_bytes_turned_is_read_or_refused() {
        let bytes = layer().bytes();
        for at in 0..bytes.len() {
            let _ = raster(&bytes[..at]);
            for value in [0, 1, 0x40, 0x7f, 0xc0, 0xff] {
                let mut turned = bytes.clone();
                turned[at] = value;
                if let Ok(raster) = raster(&turned) {
                    assert_eq!(raster.samples.len(), raster.width as usize * raster.height as usize);
                }
            }
        }
    }
}
