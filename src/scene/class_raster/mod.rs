//! Rasters of land-cover classes as vector layers: a polygon for each patch of a class on the ground.
//!
//! ```text
//!  GeoTIFF ─► window over the ground, in bands of rows ─► most frequent class of squares, at most MOST_CELLS a side
//!    ─► patches too small to be told join their neighbors ─► smooth borders that neighbors share ─► polygons in its system
//! ```
//!
//! Each polygon has the properties `class`, the number in its classification, `name`, and `cover`, the word of `[[area]]`, but water.

mod corine;
pub mod legend;
mod world_cover;

use std::io::Cursor;

use glam::DVec2;
use serde_json::Value;

use crate::assets::{AssetError, Assets};
use crate::class_raster::legend::{ClassLegend, UnknownClass, byte_of};
use sandtable_base::limits::COMPANION_BYTES;
use sandtable_base::message::choice::Choice;
use sandtable_base::message::suggest::quoted;
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::tiff::windows::{GeoTiffWindows, is_tiff};
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::class_grid::{ClassGrid, MajorityGrid, NO_CLASS};
use sandtable_raster::class_outlines::{OutlineCourse, PatchOutline, outlines};
use sandtable_raster::class_sieve::{ClassPatches, sieve};
use sandtable_raster::content::FileContent;
use sandtable_raster::error::{DemError, DemErrorKind};
use sandtable_raster::raster::Raster;
use sandtable_raster::windows::{RasterWindow, WINDOW_CACHE_BYTES, Windows};
use sandtable_remote::address::is_address;
use sandtable_vector::feature::{Feature, Geometry, Polygon, Properties, VectorLayer};

/// The longest side in cells that borders are traced in: about the pixels of a picture, so that borders look alike of finer
/// rasters.
const MOST_CELLS: u32 = 1500;

/// Cells of a side of the ground that are told as one patch: what is smaller is a few pixels of a picture.
const TOLD_SHARE: u32 = 500;

/// The fewest cells of a patch: fewer are noise of the classification.
const LEAST_CELLS: u32 = 4;

/// The most patches: as many areas of a scene are laid in some seconds. Of more the smallest join their neighbors.
const MOST_PATCHES: usize = 20_000;

/// Cells beside the ground that are read, so that what is done at the border of a window stays off it.
const BESIDE: f64 = 8.0;

/// Cells that are read at a time.
const BAND_CELLS: u32 = 1 << 22;

/// The windows over a raster from which [`ClassRaster::sampled_legend`] takes its values, in each direction, and their side in
/// cells.
const SAMPLED: (u32, u32) = (5, 128);

/// Why a raster gives no classes.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ClassRasterError {
    #[error(transparent)]
    Asset(#[from] AssetError),
    #[error(transparent)]
    Raster(#[from] DemError),
    #[error("'{name}' states no place on the ground; put its world file beside it, with the extension .tfw")]
    NoPlace { name: String },
    #[error("'{name}' names no coordinate system; state it with the key `crs`")]
    NoCrs { name: String },
    #[error(
        "'{name}' holds {found}, which is no class of land cover that is known: ESA WorldCover has 10, 20 to 90, 95 and 100, CORINE \
         111 to 523, or 1 to 44 in cells of 100 m; elevation is named by `dem` under [terrain], and other classes are drawn as \
         polygons, made for example with: gdal_polygonize.py FILE out.gpkg"
    )]
    Unknown { name: String, found: String },
}

/// The classification that a raster seems to have by values here and there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampledLegend {
    /// The classification.
    pub legend: ClassLegend,
    /// Whether elevation does not look like that: whole numbers in storage, three classes or more, and not CORINE's numbers from 1 to
    /// 44, which heights have as well.
    pub is_sure: bool,
}

/// The fewest classes that level ground and ground of a few steps cannot be taken for.
const SURE_CLASSES: usize = 3;

/// A raster of classes, opened.
pub struct ClassRaster {
    name: String,
    windows: GeoTiffWindows<Box<dyn FileContent>>,
    crs: Crs,
}

impl ClassRaster {
    /// Opens the file that a scene calls `name`, with the system that the scene states for it; `None` of one that is no TIFF by its
    /// first bytes, or cannot be opened. Of an address the extension says so: `.tif` or `.tiff`.
    ///
    /// # Errors
    /// The file is broken, or has no place.
    pub fn open(
        name: &str,
        assets: &Assets,
        stated: Option<&Crs>,
        overridden: &dyn Fn(&Crs),
    ) -> Result<Option<Self>, ClassRasterError> {
        let content: Box<dyn FileContent> = match assets.given().file(name) {
            Some(bytes) if is_tiff(bytes) => Box::new(Cursor::new(bytes.to_vec())),
            Some(_) => return Ok(None),
            None if is_address(name) && !has_tiff_extension(name) => return Ok(None),
            None => {
                // What cannot be opened is told by who reads it as vectors.
                let opened = assets.open_elevation(name, 4).ok().filter(|(head, _)| is_tiff(head));
                let Some((_, content)) = opened else { return Ok(None) };
                content
            }
        };
        let companions = assets.companions(COMPANION_BYTES.get());
        let options = DemOptions { crs: stated.cloned(), ..DemOptions::default() };
        let hints = DemHints { options, overridden, companions: &|name| companions.get(name) };
        let opened = Self::of_content(name, content, &hints);
        companions.check()?;
        opened.map(Some)
    }

    /// Opens a TIFF from its content.
    ///
    /// # Errors
    /// It is broken, or has no place.
    pub fn of_content(
        name: &str,
        content: Box<dyn FileContent>,
        hints: &DemHints<'_>,
    ) -> Result<Self, ClassRasterError> {
        let windows = GeoTiffWindows::open(name, content, hints, WINDOW_CACHE_BYTES)?;
        let name = name.to_owned();
        let raster = windows.metadata();
        if !raster.georeferenced {
            return Err(ClassRasterError::NoPlace { name: quoted(&name) });
        }
        let Some(crs) = raster.crs.clone() else {
            return Err(ClassRasterError::NoCrs { name: quoted(&name) });
        };
        Ok(Self { name, windows, crs })
    }

    /// The polygons of the classes on `ground`, a rectangle of `ground_crs`, which cover it without gap or overlap where the
    /// raster has data. None where it covers none of the ground, which a note says.
    ///
    /// # Errors
    /// The raster is broken, or holds other values than classes.
    pub fn layer(mut self, ground: &Rect, ground_crs: &Crs) -> Result<VectorLayer, ClassRasterError> {
        let mut layer = VectorLayer {
            features: Vec::new(),
            crs: self.crs.clone(),
            notes: Vec::new(),
            faults: Vec::new(),
        };
        let Some(window) = self.window(ground, ground_crs) else {
            layer.notes.push(self.beside());
            return Ok(layer);
        };
        let step = window.width.max(window.height).div_ceil(MOST_CELLS);
        let (mut grid, legend) = self.grid(window, step)?;
        let side = grid.width().max(grid.height());
        sieve_to_few(&mut grid, LEAST_CELLS.max((side / TOLD_SHARE).pow(2)));
        let place = PlacedWindow { raster: self.windows.metadata(), window, step };
        let found = outlines(&grid, OutlineCourse::Smooth);
        layer.features = found.into_iter().filter_map(|outline| place.feature(outline, legend)).collect();
        Ok(layer)
    }

    /// The cells of the raster over the ground and some beside it.
    fn window(&self, ground: &Rect, ground_crs: &Crs) -> Option<RasterWindow> {
        let raster = self.windows.metadata();
        let grid_at = |at| ground_crs.transform(&self.crs, at).ok().map(|at| raster.grid_from_map(at));
        let around = Rect::around(ground.grid_points().filter_map(grid_at));
        let whole = Rect { min: DVec2::ZERO, max: raster.grid_size() };
        if around.is_empty() || around.intersection(&whole).is_empty() {
            return None;
        }
        let step = (around.size().max_element() / f64::from(MOST_CELLS)).ceil().max(1.0);
        let within = around.grown(BESIDE * step).intersection(&whole);
        let (first, last) = (within.min.floor(), within.max.ceil());
        let count = last - first;
        (count.min_element() >= 1.0).then_some(RasterWindow {
            column: first.x as u32,
            row: first.y as u32,
            width: count.x as u32,
            height: count.y as u32,
        })
    }

    /// The classes of a window by squares of `step` cells, as bytes of [`legend`], and the classification.
    fn grid(
        &mut self,
        window: RasterWindow,
        step: u32,
    ) -> Result<(ClassGrid, ClassLegend), ClassRasterError> {
        let mut grid = MajorityGrid::new(window.width, step);
        let mut is_present = [false; 256];
        for band in window.bands(BAND_CELLS) {
            let bytes = self.bytes(band)?;
            bytes.iter().for_each(|byte| is_present[usize::from(*byte)] = true);
            bytes.chunks_exact(window.width as usize).for_each(|row| grid.add_row(row));
        }
        let legend = self.legend(&is_present)?;
        Ok((grid.finish(), legend))
    }

    /// The bytes of the values of a window.
    fn bytes(&mut self, window: RasterWindow) -> Result<Vec<u8>, ClassRasterError> {
        let failed = |kind: DemErrorKind| DemError { name: self.name.clone(), kind };
        let samples = self.windows.samples(window).map_err(failed)?;
        let byte = |value: f64| byte_of(value).ok_or(UnknownClass(value));
        samples.iter().map(byte).collect::<Result<_, _>>().map_err(|unknown| self.unknown(unknown))
    }

    fn legend(&self, is_present: &[bool; 256]) -> Result<ClassLegend, ClassRasterError> {
        let present: Vec<u8> =
            (0..=u8::MAX).filter(|byte| *byte != NO_CLASS && is_present[usize::from(*byte)]).collect();
        ClassLegend::of(&present, self.cell_m()).map_err(|unknown| self.unknown(unknown))
    }

    /// The classification by values here and there in the raster.
    ///
    /// # Errors
    /// The raster is broken, or holds other values than classes, or none, there.
    pub fn sampled_legend(&mut self) -> Result<SampledLegend, ClassRasterError> {
        let (width, height) = self.windows.size();
        let (count, side) = SAMPLED;
        let first = |index: u32, most: u32| {
            (u64::from(most.saturating_sub(side)) * u64::from(index) / u64::from(count - 1)) as u32
        };
        let mut is_present = [false; 256];
        for (row, column) in (0..count).flat_map(|row| (0..count).map(move |column| (row, column))) {
            let (column, row) = (first(column, width), first(row, height));
            let (width, height) = (side.min(width - column), side.min(height - row));
            let bytes = self.bytes(RasterWindow { column, row, width, height })?;
            bytes.iter().for_each(|byte| is_present[usize::from(*byte)] = true);
        }
        is_present[usize::from(NO_CLASS)] = false;
        let classes = is_present.iter().filter(|is_present| **is_present).count();
        if classes == 0 {
            return Err(self.unknown(UnknownClass(f64::NAN)));
        }
        let legend = self.legend(&is_present)?;
        let is_whole = !self.windows.metadata().data_type.starts_with("Float");
        let is_sure = is_whole && classes >= SURE_CLASSES && legend != ClassLegend::CorineNumbers;
        Ok(SampledLegend { legend, is_sure })
    }

    /// The side of a cell from row to row, meters.
    fn cell_m(&self) -> f64 {
        let side = self.windows.metadata().map_from_grid.matrix2.y_axis.length();
        side * self.crs.meters_northward_per_unit()
    }

    fn unknown(&self, UnknownClass(value): UnknownClass) -> ClassRasterError {
        let data_type = self.windows.metadata().data_type;
        let value = if value.is_nan() { "no data".to_owned() } else { value.to_string() };
        let found = format!("{value} ({data_type}) in cells of {:.1} m", self.cell_m());
        ClassRasterError::Unknown { name: quoted(&self.name), found }
    }

    /// The note of a raster that covers none of the ground.
    fn beside(&self) -> String {
        let Rect { min, max } = self.windows.metadata().extent();
        format!(
            "it covers none of the ground, but {:.4} to {:.4} and {:.4} to {:.4} in {}; if that is not its system, state the \
             right one with the key `crs`",
            min.x,
            max.x,
            min.y,
            max.y,
            self.crs.name()
        )
    }
}

/// Whether an address without its query ends as those of TIFF files do.
fn has_tiff_extension(address: &str) -> bool {
    let path = address.split(['?', '#']).next().unwrap_or_default().to_ascii_lowercase();
    path.ends_with(".tif") || path.ends_with(".tiff")
}

/// Merges patches of fewer than `least` cells, and of more where too many are left.
fn sieve_to_few(grid: &mut ClassGrid, mut least: u32) {
    loop {
        sieve(grid, least);
        if ClassPatches::of(grid).classes.len() <= MOST_PATCHES {
            return;
        }
        least *= 2;
    }
}

/// A window of a raster in squares of cells.
struct PlacedWindow<'a> {
    raster: &'a Raster,
    window: RasterWindow,
    step: u32,
}

impl PlacedWindow<'_> {
    /// The polygon of an outline; `None` of no class.
    fn feature(&self, outline: PatchOutline, legend: ClassLegend) -> Option<Feature> {
        let class = legend.class(outline.class)?;
        let ring = |ring: Vec<DVec2>| ring.into_iter().map(|at| self.map_at(at)).collect();
        let holes = outline.holes.into_iter().map(ring).collect();
        let geometry = Geometry::Polygons(vec![Polygon { exterior: ring(outline.exterior), holes }]);
        let mut properties = Properties::new();
        properties.insert("class".to_owned(), Value::from(class.code));
        properties.insert("name".to_owned(), Value::from(class.name));
        if let Some(cover) = class.cover {
            properties.insert("cover".to_owned(), Value::from(cover.word()));
        }
        Some(Feature { geometry, elevations: None, properties })
    }

    /// The place on the map of a place in the grid of squares, of which the last may hang over.
    fn map_at(&self, at: DVec2) -> DVec2 {
        let RasterWindow { column, row, width, height } = self.window;
        let cells = (at * f64::from(self.step)).min(DVec2::new(width.into(), height.into()));
        self.raster.map_from_grid.transform_point2(cells + DVec2::new(column.into(), row.into()))
    }
}
