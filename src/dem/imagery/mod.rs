//! Pictures of the ground with a georeference: aerial photographs, satellite images, scanned maps.
//!
//! GeoTIFF carries its place and its coordinate system; PNG and JPEG have a world file beside them (Esri's format: six
//! numbers, as `.pgw`, `.jgw` or `.wld`) and a `.prj`. A picture is opened by its header alone. What is read of it is a
//! window, and of that the mean of squares of pixels: the memory follows from what is asked for, not from the file.

mod reduce;
mod tiff_colors;

use std::io::Cursor;

use glam::{DAffine2, DVec2};
use image::{DynamicImage, ImageFormat, ImageReader};

use crate::companion::world_file;
use crate::dem_file::DemFile;
use crate::hints::DemHints;
use crate::imagery::reduce::{Reducer, Rgba};
use crate::imagery::tiff_colors::TiffColors;
use crate::tiff::header;
use sandtable_base::limits::IMAGERY_PIXELS;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::error::DemErrorKind;
use sandtable_raster::windows::RasterWindow;

/// Why a picture of the ground was not read.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {kind}")]
pub struct ImageryError {
    /// The file, as the caller named it.
    pub name: String,
    /// The fault.
    #[source]
    pub kind: ImageryErrorKind,
}

/// The cause of an [`ImageryError`].
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ImageryErrorKind {
    #[error(
        "it is no GeoTIFF, PNG or JPEG; convert it, for example with: gdal_translate -co TILED=YES FILE out.tif"
    )]
    UnknownFormat,
    #[error(
        "{width} x {height} pixels are more than the {IMAGERY_PIXELS} that are read of a PNG or JPEG; convert it, for example with: gdal_translate -co TILED=YES -co COMPRESS=DEFLATE FILE out.tif, or {IMAGERY_PIXELS:#}"
    )]
    TooLarge { width: u32, height: u32 },
    #[error("it states no place on the ground; put its world file beside it, with the extension {0}")]
    NoPlace(&'static str),
    #[error("its coordinate system cannot be used: {0}; state the right one with the key 'crs'")]
    Crs(#[source] CrsError),
    #[error(
        "it holds {0}, not colors of 8 bits; convert it, for example with: gdal_translate -ot Byte -scale -b 1 -b 2 -b 3 FILE out.tif"
    )]
    NoColors(String),
    #[error("the picture is broken: {0}; fetch or export the file again")]
    Undecodable(#[source] image::ImageError),
    #[error(transparent)]
    Tiff(DemErrorKind),
}

impl From<DemErrorKind> for ImageryErrorKind {
    fn from(error: DemErrorKind) -> Self {
        match error {
            DemErrorKind::Crs(error) => Self::Crs(*error),
            other => Self::Tiff(other),
        }
    }
}

/// A picture of the ground, opened and not decoded yet.
pub struct Imagery<'a> {
    name: &'a str,
    bytes: &'a [u8],
    store: Store,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Place in the picture (column, row; the first pixel's center is at 0.5) to map coordinates; can be inverted.
    pub map_from_grid: DAffine2,
    /// The coordinate reference system; `None` where nothing names one.
    pub crs: Option<Crs>,
}

enum Store {
    Tiff(Box<TiffColors>),
    Picture(ImageFormat),
}

/// Colors row by row from the upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorRaster {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue in sRGB and straight alpha; alpha is 0 where there is no data.
    pub pixels: Vec<Rgba>,
    /// Place in this raster (column, row) to place in the picture that it was read from.
    pub grid_from_own: DAffine2,
}

impl<'a> Imagery<'a> {
    /// Opens the picture in `bytes`. Of `hints` the coordinate system and the companions count: a world file, a `.prj`.
    ///
    /// # Errors
    /// It is in no format that is read, has no place or more pixels than are read, or is broken.
    pub fn open(name: &'a str, bytes: &'a [u8], hints: &DemHints) -> Result<Self, ImageryError> {
        Self::opened(name, bytes, hints).map_err(|kind| ImageryError { name: name.to_owned(), kind })
    }

    fn opened(name: &'a str, bytes: &'a [u8], hints: &DemHints) -> Result<Self, ImageryErrorKind> {
        let file = DemFile { name, bytes, hints };
        if header::recognizes(bytes) {
            let (colors, raster) = TiffColors::open(&file)?;
            if !raster.georeferenced {
                return Err(ImageryErrorKind::NoPlace(".tfw or .wld"));
            }
            let store = Store::Tiff(Box::new(colors));
            let (width, height) = (raster.width, raster.height);
            return Ok(Self {
                name,
                bytes,
                store,
                width,
                height,
                map_from_grid: raster.map_from_grid,
                crs: raster.crs,
            });
        }
        let (format, world_files, remedy): (_, &[&str], _) = match image::guess_format(bytes) {
            Ok(ImageFormat::Png) => (ImageFormat::Png, &["pgw", "pngw", "wld"], ".pgw or .wld"),
            Ok(ImageFormat::Jpeg) => (ImageFormat::Jpeg, &["jgw", "jpgw", "jpegw", "wld"], ".jgw or .wld"),
            _ => return Err(ImageryErrorKind::UnknownFormat),
        };
        let reader = ImageReader::with_format(Cursor::new(bytes), format);
        let (width, height) = reader.into_dimensions().map_err(ImageryErrorKind::Undecodable)?;
        if u64::from(width) * u64::from(height) > IMAGERY_PIXELS.get() {
            return Err(ImageryErrorKind::TooLarge { width, height });
        }
        let text = world_files.iter().find_map(|extension| file.companion(extension));
        let text = text.ok_or(ImageryErrorKind::NoPlace(remedy))?;
        let map_from_grid = world_file(&String::from_utf8_lossy(&text))?;
        Ok(Self {
            name,
            bytes,
            store: Store::Picture(format),
            width,
            height,
            map_from_grid,
            crs: file.crs()?,
        })
    }

    /// The part of the picture in `window`, which lies within it: one color for each square of `step` pixels a side, the
    /// mean of their light; the squares at the right and the lower border may hold fewer. A GeoTIFF's overviews are read
    /// where they are fine enough.
    ///
    /// # Errors
    /// The picture is broken.
    pub fn read(&self, window: RasterWindow, step: u32) -> Result<ColorRaster, ImageryError> {
        window.assert_within((self.width, self.height));
        let raster = match &self.store {
            Store::Tiff(colors) => colors.read(self.bytes, window, step.max(1)),
            Store::Picture(format) => self.decode(*format).map(|image| reduced(&image, window, step.max(1))),
        };
        raster.map_err(|kind| ImageryError { name: self.name.to_owned(), kind })
    }

    fn decode(&self, format: ImageFormat) -> Result<image::RgbaImage, ImageryErrorKind> {
        let mut reader = ImageReader::with_format(Cursor::new(self.bytes), format);
        let mut limits = image::Limits::default();
        // 16-bit colors with alpha take 8 bytes a pixel.
        limits.max_alloc = Some(IMAGERY_PIXELS.get() * 8 + (64 << 20));
        reader.limits(limits);
        reader.decode().map(DynamicImage::into_rgba8).map_err(ImageryErrorKind::Undecodable)
    }
}

fn reduced(image: &image::RgbaImage, window: RasterWindow, step: u32) -> ColorRaster {
    let mut reducer = Reducer::new(window, step);
    let (first, last) = (window.column as usize, (window.column + window.width) as usize);
    let rows = image.rows().skip(window.row as usize).take(window.height as usize);
    let mut colors = Vec::with_capacity(window.width as usize);
    for row in rows {
        colors.clear();
        colors.extend(row.skip(first).take(last - first).map(|pixel| pixel.0));
        reducer.add_row(&colors);
    }
    reducer.finish()
}

impl ColorRaster {
    /// The color at a place in the picture that it was read from, bilinear, weighted by alpha; transparent beyond.
    pub fn at(&self, own_from_grid: &DAffine2, place: DVec2) -> Rgba {
        let at = own_from_grid.transform_point2(place);
        let size = DVec2::new(self.width.into(), self.height.into());
        if !(at.cmpge(DVec2::ZERO).all() && at.cmple(size).all()) {
            return [0; 4];
        }
        let centered = (at - 0.5).clamp(DVec2::ZERO, size - 1.0);
        let first = centered.floor().min((size - 2.0).max(DVec2::ZERO));
        let part = (centered - first).as_vec2();
        let (column, row) = (first.x as usize, first.y as usize);
        let (east, south) = (usize::from(self.width > 1), usize::from(self.height > 1));
        let pixel = |column: usize, row: usize| self.pixels[row * self.width as usize + column];
        reduce::blended([
            (pixel(column, row), (1.0 - part.x) * (1.0 - part.y)),
            (pixel(column + east, row), part.x * (1.0 - part.y)),
            (pixel(column, row + south), (1.0 - part.x) * part.y),
            (pixel(column + east, row + south), part.x * part.y),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hints::DemOptions;

    fn png(width: u32, height: u32, color: impl Fn(u32, u32) -> Rgba) -> Vec<u8> {
        let image = image::RgbaImage::from_fn(width, height, |x, y| image::Rgba(color(x, y)));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).expect("memory");
        bytes.into_inner()
    }

    fn all(imagery: &Imagery) -> RasterWindow {
        RasterWindow { column: 0, row: 0, width: imagery.width, height: imagery.height }
    }

    #[test]
    fn a_png_lies_where_its_world_file_says() {
        let bytes = png(4, 2, |x, y| [10 * x as u8, 100 * y as u8, 7, 255]);
        let beside = |name: &str| match name {
            "a.pgw" => Some(b"2\n0\n0\n-2\n501\n4007\n".to_vec()),
            "a.prj" => Some(b"EPSG:32616".to_vec()),
            _ => None,
        };
        let hints = DemHints { companions: &beside, ..DemHints::default() };
        let imagery = Imagery::open("a.png", &bytes, &hints).expect("a small picture");
        assert_eq!(imagery.map_from_grid.transform_point2(DVec2::ZERO), DVec2::new(500.0, 4008.0));
        assert_eq!(imagery.crs.as_ref().and_then(Crs::epsg), Some(32616));
        let read = imagery.read(all(&imagery), 1).expect("sound");
        assert_eq!((read.width, read.height, read.pixels[6]), (4, 2, [20, 100, 7, 255]));
        assert_eq!(read.at(&DAffine2::IDENTITY, DVec2::new(2.5, 1.5)), [20, 100, 7, 255]);
        assert_eq!(read.at(&DAffine2::IDENTITY, DVec2::new(4.1, 1.5)), [0; 4]);
    }

    #[test]
    fn squares_of_pixels_become_their_mean_light_and_holes_stay_holes() {
        let color = |x: u32, _| if x < 2 { [if x == 0 { 255 } else { 0 }; 4] } else { [255, 0, 0, 0] };
        let bytes = png(5, 2, |x, y| if x == 4 { [9, 9, 9, 255] } else { color(x, y) });
        let world = |_: &str| Some(b"1 0 0 -1 0 0".to_vec());
        let hints = DemHints {
            companions: &world,
            ..DemOptions { crs: Some(Crs::wgs84()), ..DemOptions::default() }.into()
        };
        let imagery = Imagery::open("a.png", &bytes, &hints).expect("a small picture");
        let read = imagery.read(all(&imagery), 2).expect("sound");
        assert_eq!((read.width, read.height), (3, 1));
        assert_eq!(read.pixels, [[255, 255, 255, 128], [0, 0, 0, 0], [9, 9, 9, 255]]);
        assert_eq!(read.grid_from_own.transform_point2(DVec2::ONE), DVec2::splat(2.0));
    }

    #[test]
    fn what_cannot_be_placed_is_refused_with_the_remedy() {
        let message = |bytes: &[u8]| {
            let opened = Imagery::open("d/a.png", bytes, &DemHints::default());
            opened.err().expect("refused").to_string()
        };
        assert!(message(&png(2, 2, |_, _| [1; 4])).contains(".pgw"));
        assert!(message(b"GIF89a").contains("gdal_translate"));
        assert!(message(&png(2, 2, |_, _| [1; 4])[..20]).contains("broken"));
    }
}
