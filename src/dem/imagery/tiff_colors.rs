//! The colors of a TIFF: gray, red, green and blue, or a palette (TIFF 6.0, sections 4 to 6), in 8 bits, with alpha.
//!
//! ```text
//! chunky   │RGBA RGBA RGBA│                     one block holds all bands
//! planar   │RRR│ … │GGG│ … │BBB│ … │AAA│ …      band after band, each with as many blocks
//! ```

use std::io::{Cursor, Read, Seek};

use rayon::prelude::*;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

use crate::dem_file::DemFile;
use crate::imagery::reduce::{Reducer, Rgba};
use crate::imagery::{ColorRaster, ImageryErrorKind};
use crate::tiff::decoder::limits;
use crate::tiff::decoder::{IS_MASK, IS_REDUCED, image_kind};
use crate::tiff::fault::{self, decode_error};
use crate::tiff::header::GeoTiffHeader;
use crate::tiff::jpeg_block::{self, JpegBlock};
use crate::tiff::storage::{Packing, Predictor, Storage, TiffBlock};
use crate::tiff::unpack::{Unpacker, packed};
use sandtable_base::limits::{TIFF_IMAGES, WINDOWED_SAMPLES};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::RasterWindow;

/// The images of a TIFF that show the same ground.
pub(super) struct TiffColors {
    layout: ColorLayout,
    /// The value of all color bands that means no data.
    nodata: Option<u8>,
    full: Storage,
    /// Reduced images.
    overviews: Vec<Storage>,
}

/// The meaning of an image's bands.
#[derive(Clone, Debug, PartialEq)]
struct ColorLayout {
    bands: usize,
    photometric: u16,
    colors: ColorBands,
    alpha: Option<AlphaBand>,
}

#[derive(Clone, Debug, PartialEq)]
enum ColorBands {
    /// One band, from dark to light.
    Gray,
    /// One band, from light to dark.
    InvertedGray,
    Rgb,
    /// One band of indices.
    Palette(Vec<[u8; 3]>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct AlphaBand {
    index: usize,
    /// Whether colors are multiplied by it.
    is_associated: bool,
}

impl TiffColors {
    /// The colors of a file, and the raster that it is, without samples.
    pub fn open(file: &DemFile) -> Result<(Self, Raster), ImageryErrorKind> {
        let bytes = file.bytes;
        let decoder = Decoder::new(Cursor::new(bytes)).map_err(decode_error)?;
        let mut decoder = decoder.with_limits(limits(bytes.len()));
        let full = Storage::read(&mut decoder, bytes.len(), &WINDOWED_SAMPLES)?;
        let layout = ColorLayout::read(&mut decoder, &full)?;
        let raster = GeoTiffHeader::read(&mut decoder, &full, file)?.raster;
        let nodata = raster.nodata.filter(|value| value.fract() == 0.0 && (0.0..=255.0).contains(value));
        let mut overviews = Vec::new();
        for image in 1..TIFF_IMAGES.count() {
            if decoder.seek_to_image(image).is_err() {
                break;
            }
            let kind = image_kind(&mut decoder);
            if kind & IS_REDUCED == 0 || kind & IS_MASK != 0 {
                continue;
            }
            let reduced = Storage::read(&mut decoder, bytes.len(), &WINDOWED_SAMPLES);
            let is_alike = |storage: &Storage| {
                (storage.bits, storage.bands_per_block) == (full.bits, full.bands_per_block)
            };
            overviews.extend(reduced.ok().filter(is_alike));
        }
        Ok((Self { layout, nodata: nodata.map(|value| value as u8), full, overviews }, raster))
    }

    /// See [`Imagery::read`](crate::imagery::Imagery::read).
    pub fn read(
        &self,
        bytes: &[u8],
        window: RasterWindow,
        step: u32,
    ) -> Result<ColorRaster, ImageryErrorKind> {
        let (storage, times) = self.image_for(step);
        // An overview may be rounded down: its last pixel stands for the rest.
        let span = |first: u32, count: u32, most: u32| {
            let from = (first / times).min(most - 1);
            (from, (first + count).div_ceil(times).clamp(from + 1, most) - from)
        };
        let (column, width) = span(window.column, window.width, storage.width);
        let (row, height) = span(window.row, window.height, storage.height);
        let within = RasterWindow { column, row, width, height };
        let raster = self.reduced(bytes, storage, within, (step / times).max(1))?;
        let scale = glam::DVec2::new(
            f64::from(self.full.width) / f64::from(storage.width),
            f64::from(self.full.height) / f64::from(storage.height),
        );
        Ok(ColorRaster { grid_from_own: glam::DAffine2::from_scale(scale) * raster.grid_from_own, ..raster })
    }

    /// The coarsest image whose pixels are at most `step` of the full image's, and how many.
    fn image_for(&self, step: u32) -> (&Storage, u32) {
        let times = |storage: &Storage| {
            // Overviews round their size up or down.
            let times = (self.full.width as f32 / storage.width as f32).round() as u32;
            let is_whole = self.full.width.div_ceil(times.max(1)).abs_diff(storage.width) <= 1
                && self.full.height.div_ceil(times.max(1)).abs_diff(storage.height) <= 1;
            is_whole.then_some(times)
        };
        let fitting = self.overviews.iter().filter_map(|storage| Some((storage, times(storage)?)));
        let coarsest =
            fitting.filter(|&(_, times)| (2..=step).contains(&times)).max_by_key(|&(_, times)| times);
        coarsest.unwrap_or((&self.full, 1))
    }

    fn reduced(
        &self,
        bytes: &[u8],
        storage: &Storage,
        window: RasterWindow,
        step: u32,
    ) -> Result<ColorRaster, ImageryErrorKind> {
        let mut reducer = Reducer::new(window, step);
        let blocks: Vec<TiffBlock> = storage.blocks_meeting(window).collect();
        let width = window.width as usize;
        for blocks in blocks.chunk_by(|a, b| a.window.row == b.window.row) {
            let decoded: Vec<Vec<Rgba>> = blocks
                .par_iter()
                .map(|&block| self.block(bytes, storage, block))
                .collect::<Result<_, DemErrorKind>>()?;
            let (first, rows) = (blocks[0].window.row, blocks[0].window.height);
            let from = first.max(window.row);
            let height = (first + rows).min(window.row + window.height) - from;
            let strip = RasterWindow { row: from, height, ..window };
            let mut colors = vec![[0; 4]; strip.samples()];
            for (block, decoded) in blocks.iter().zip(decoded) {
                for (to, of) in strip.shared_rows(block.window) {
                    colors[to].copy_from_slice(&decoded[of]);
                }
            }
            colors.chunks_exact(width).for_each(|row| reducer.add_row(row));
        }
        Ok(reducer.finish())
    }

    /// The colors of one block; transparent where it was never written.
    fn block(&self, bytes: &[u8], storage: &Storage, block: TiffBlock) -> Result<Vec<Rgba>, DemErrorKind> {
        let count = block.window.samples();
        let ColorLayout { bands, .. } = self.layout;
        let per_block = usize::from(storage.bands_per_block);
        let mut samples = vec![0u8; count * bands];
        let mut unpacker = Unpacker::new(storage);
        let mut unpacked = Vec::new();
        let (across, down) = storage.blocks_across_and_down();
        for first in (0..bands).step_by(per_block) {
            let index = block.index.checked_add(first as u32 * across.saturating_mul(down));
            let of_band = TiffBlock { index: index.unwrap_or(u32::MAX), ..block };
            if !storage.is_written(of_band.index) {
                return Ok(vec![[0; 4]; count]);
            }
            let mut row_bytes = storage.row_bytes();
            if storage.packing == Packing::Jpeg {
                let mut file = bytes;
                let packed = packed(storage, &mut file, of_band)?;
                let photometric = self.layout.photometric;
                let JpegBlock { samples, row_bytes: of_stream } =
                    jpeg_block::decode(&packed, storage, of_band, photometric)?;
                (unpacked, row_bytes) = (samples, of_stream);
            } else {
                unpacker.unpack(&mut &*bytes, of_band, &mut unpacked)?;
            }
            for (row, out) in unpacked
                .chunks_exact_mut(row_bytes.max(1))
                .zip(samples.chunks_exact_mut(block.window.width as usize * bands))
            {
                if storage.predictor == Predictor::Differences {
                    for at in per_block..row.len() {
                        row[at] = row[at].wrapping_add(row[at - per_block]);
                    }
                }
                for (pixel, out) in row.chunks_exact(per_block).zip(out.chunks_exact_mut(bands)) {
                    out[first..first + per_block].copy_from_slice(pixel);
                }
            }
        }
        Ok(samples.chunks_exact(bands).map(|pixel| self.layout.color(pixel, self.nodata)).collect())
    }
}

impl ColorLayout {
    fn read<R: Read + Seek>(decoder: &mut Decoder<R>, storage: &Storage) -> Result<Self, ImageryErrorKind> {
        let mut numbers = |tag: Tag| {
            decoder.find_tag_unsigned_vec::<u16>(tag).map_err(decode_error).map(Option::unwrap_or_default)
        };
        let first = |values: Vec<u16>, otherwise: u16| values.first().copied().unwrap_or(otherwise);
        let bands = usize::from(first(numbers(Tag::SamplesPerPixel)?, 1));
        let photometric = first(numbers(Tag::PhotometricInterpretation)?, u16::MAX);
        let extra = numbers(Tag::ExtraSamples)?;
        let is_byte = storage.bits == 8 && storage.predictor != Predictor::FloatBytes;
        if !is_byte {
            return Err(ImageryErrorKind::NoColors(format!("samples of {} bits", storage.bits)));
        }
        let colors = match (photometric, bands) {
            (0, 1..) => ColorBands::InvertedGray,
            (1, 1..) => ColorBands::Gray,
            (2, 3..) => ColorBands::Rgb,
            (3, 1..) => ColorBands::Palette(palette(&numbers(Tag::ColorMap)?)?),
            (jpeg_block::YCBCR, 3) if storage.packing == Packing::Jpeg => ColorBands::Rgb,
            (jpeg_block::YCBCR, _) => {
                return Err(ImageryErrorKind::NoColors("luminance and chroma (YCbCr)".into()));
            }
            (5, _) => return Err(ImageryErrorKind::NoColors("inks (CMYK)".into())),
            _ => return Err(ImageryErrorKind::NoColors(format!("{bands} bands of kind {photometric}"))),
        };
        let color_bands = if colors == ColorBands::Rgb { 3 } else { 1 };
        let alpha_of = |(index, &kind): (usize, &u16)| {
            matches!(kind, 1 | 2)
                .then_some(AlphaBand { index: color_bands + index, is_associated: kind == 1 })
                .filter(|band| band.index < bands)
        };
        Ok(Self { bands, photometric, colors, alpha: extra.iter().enumerate().find_map(alpha_of) })
    }

    fn color(&self, pixel: &[u8], nodata: Option<u8>) -> Rgba {
        let [red, green, blue] = match &self.colors {
            ColorBands::Gray => [pixel[0]; 3],
            ColorBands::InvertedGray => [255 - pixel[0]; 3],
            ColorBands::Rgb => [pixel[0], pixel[1], pixel[2]],
            ColorBands::Palette(colors) => colors.get(usize::from(pixel[0])).copied().unwrap_or_default(),
        };
        let color_bands = if self.colors == ColorBands::Rgb { 3 } else { 1 };
        if nodata.is_some_and(|nodata| pixel[..color_bands].iter().all(|&band| band == nodata)) {
            return [0; 4];
        }
        let Some(band) = self.alpha else { return [red, green, blue, 255] };
        let alpha = pixel[band.index];
        let straight = |channel: u8| match band.is_associated {
            true => (u16::from(channel) * 255 / u16::from(alpha).max(1)).min(255) as u8,
            false => channel,
        };
        [straight(red), straight(green), straight(blue), alpha]
    }
}

/// The colors of a palette, which come as all reds, all greens, all blues, in 16 bits.
fn palette(values: &[u16]) -> Result<Vec<[u8; 3]>, DemErrorKind> {
    let count = values.len() / 3;
    if count == 0 {
        return Err(fault::broken("it has no palette"));
    }
    let high = |at: usize| (values[at] >> 8) as u8;
    Ok((0..count).map(|at| [high(at), high(count + at), high(2 * count + at)]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemHints;
    use crate::imagery::Imagery;
    use tiff::encoder::{Predictor as Encoded, TiffEncoder, colortype};

    /// An image of `width` × `height` with a place, of which a pixel is (column, row, 9).
    fn file(width: u32, height: u32, predictor: Encoded) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        let encoder = TiffEncoder::new(&mut file).expect("memory");
        let mut encoder = encoder.with_predictor(predictor);
        let mut image = encoder.new_image::<colortype::RGB8>(width, height).expect("memory");
        let directory = image.encoder();
        directory.write_tag(Tag::ModelPixelScaleTag, &[10.0f64, 10.0, 0.0][..]).expect("memory");
        directory.write_tag(Tag::ModelTiepointTag, &[0.0f64, 0.0, 0.0, 5e5, 4e6, 0.0][..]).expect("memory");
        directory
            .write_tag(Tag::GeoKeyDirectoryTag, &[1u16, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32612][..])
            .expect("memory");
        directory.write_tag(Tag::GdalNodata, "0").expect("memory");
        let blue = |x: u32, y: u32| if x + y == 0 { 0 } else { 9 };
        let data: Vec<u8> =
            (0..height).flat_map(|y| (0..width).flat_map(move |x| [x as u8, y as u8, blue(x, y)])).collect();
        image.write_data(&data).expect("memory");
        file.into_inner()
    }

    #[test]
    fn windows_of_a_geotiff_hold_its_colors_and_no_data_is_transparent() {
        for predictor in [Encoded::None, Encoded::Horizontal] {
            let bytes = file(7, 5, predictor);
            let imagery = Imagery::open("a.tif", &bytes, &DemHints::default()).expect("sound");
            assert_eq!(imagery.crs.as_ref().and_then(|crs| crs.epsg()), Some(32612));
            let window = RasterWindow { column: 3, row: 2, width: 4, height: 3 };
            let read = imagery.read(window, 1).expect("sound");
            assert_eq!((read.width, read.height), (4, 3));
            assert_eq!(read.pixels[0], [3, 2, 9, 255]);
            assert_eq!(read.pixels[11], [6, 4, 9, 255]);
            let first = RasterWindow { column: 0, row: 0, width: 1, height: 1 };
            assert_eq!(imagery.read(first, 1).expect("sound").pixels, [[0; 4]]);
        }
    }

    #[test]
    fn gray_palettes_and_alpha_mean_colors() {
        let layout = |colors: ColorBands, alpha| ColorLayout { bands: 4, photometric: 2, colors, alpha };
        let straight = Some(AlphaBand { index: 3, is_associated: false });
        assert_eq!(layout(ColorBands::Rgb, straight).color(&[1, 2, 3, 4], None), [1, 2, 3, 4]);
        let associated = Some(AlphaBand { index: 3, is_associated: true });
        assert_eq!(layout(ColorBands::Rgb, associated).color(&[50, 100, 0, 100], None), [127, 255, 0, 100]);
        assert_eq!(layout(ColorBands::InvertedGray, None).color(&[5], None), [250, 250, 250, 255]);
        assert_eq!(layout(ColorBands::Gray, None).color(&[5], Some(5)), [0; 4]);
        let colors = palette(&[0, 0xff00, 0, 0x8000, 0, 0x1000]).expect("two colors");
        assert_eq!(layout(ColorBands::Palette(colors), None).color(&[1], None), [255, 128, 16, 255]);
    }

    #[test]
    fn a_file_that_ends_early_is_an_error_and_no_panic() {
        let bytes = file(7, 5, Encoded::None);
        for end in 0..bytes.len() {
            if let Ok(imagery) = Imagery::open("a.tif", &bytes[..end], &DemHints::default()) {
                let window = RasterWindow { column: 0, row: 0, width: imagery.width, height: imagery.height };
                let _ = imagery.read(window, 1);
            }
        }
    }
}
