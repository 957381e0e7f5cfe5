//! The picture that `[style.imagery]` drapes over the ground, resampled once to the scene's system.
//!
//! ```text
//!  scene's extent ∩ picture ─► pixel size: the picture's own, or what LONGEST_PX allows
//!        └─► window of the picture, means of squares of that size ─► bilinear, row by row
//! ```

use glam::{DAffine2, DVec2};
use rayon::prelude::*;

use crate::assets::Assets;
use sandtable_base::limits::COMPANION_BYTES;
use sandtable_dem::hints::{DemHints, DemOptions};
use sandtable_dem::imagery::Imagery;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, ImageryTable};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground_imagery::GroundImagery;
use sandtable_draw::pixels::Pixels;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::warp::row_positions::positions;
use sandtable_raster::windows::RasterWindow;
use sandtable_terrain::lattice::Lattice;

/// The longest side in pixels: more than a screen of 4K shows of the ground, and 64 MiB at the most. Finer pictures lose
/// detail in close views.
const LONGEST_PX: f64 = 4096.0;

/// Pixels beside the window that bilinear reading may need.
const BESIDE_PX: f64 = 2.0;

/// The document's picture of the ground; `None` where it names none.
///
/// # Errors
/// The file cannot be read, has no place or no coordinate system, or shows none of the ground.
pub fn load(
    document: &Document,
    assets: &Assets,
    crs: &Crs,
    lattice: &Lattice,
) -> Result<Option<GroundImagery>, Diagnostic> {
    let Some(table) = &document.style.imagery else { return Ok(None) };
    let bytes = assets.read(&table.file).map_err(|error| document.error(&table.file, error))?;
    let companions = assets.companions(COMPANION_BYTES.get());
    let hints = DemHints {
        companions: &|name| companions.get(name),
        ..DemOptions { crs: table.crs.clone(), ..DemOptions::default() }.into()
    };
    let imagery = Imagery::open(&table.file, &bytes, &hints);
    companions.check().map_err(|error| document.error(&table.file, error))?;
    let imagery = imagery.map_err(|error| document.error(&table.file, error))?;
    let own = imagery.crs.clone().ok_or_else(|| {
        let message = format!("{} names no coordinate system", *table.file);
        document.error(&table.file, message).with_help("state it with the key `crs` under [style.imagery]")
    })?;
    let draped = DrapedPicture { imagery, own, scene: crs, extent: lattice.map_extent() };
    draped.resampled(document, table, lattice.origin()).map(Some)
}

struct DrapedPicture<'a> {
    imagery: Imagery<'a>,
    /// The picture's system, and the scene's.
    own: Crs,
    scene: &'a Crs,
    /// The ground, map coordinates.
    extent: Rect,
}

impl DrapedPicture<'_> {
    fn resampled(
        &self,
        document: &Document,
        table: &ImageryTable,
        origin: DVec2,
    ) -> Result<GroundImagery, Diagnostic> {
        let shown = self.shown().ok_or_else(|| self.beside(document, table))?;
        let own_px_m = self.pixel_m(shown.center()).ok_or_else(|| self.beside(document, table))?;
        let size = shown.size();
        let px_m = own_px_m.max(size.max_element() / LONGEST_PX);
        let pixels = (size / px_m).ceil().clamp(DVec2::ONE, DVec2::splat(LONGEST_PX));
        let (width, height) = (pixels.x as usize, pixels.y as usize);
        let step = size / pixels;
        let window = self.window(&shown).ok_or_else(|| self.beside(document, table))?;
        // Of the two nearest whole numbers the lower: what is left is the bilinear reading's.
        let colors = self.imagery.read(window, (px_m / own_px_m).floor().max(1.0) as u32);
        let colors = colors.map_err(|error| document.error(&table.file, error))?;
        let own_from_grid = colors.grid_from_own.inverse();
        let mut data = vec![Srgba([0; 4]); width * height];
        data.par_chunks_exact_mut(width).enumerate().for_each(|(row, out)| {
            let place = |column: usize| {
                let across = DVec2::new(column as f64 + 0.5, -(row as f64 + 0.5)) * step;
                self.grid_at(DVec2::new(shown.min.x, shown.max.y) + across)
            };
            for (pixel, at) in out.iter_mut().zip(positions(width, &place)) {
                *pixel = Srgba(colors.at(&own_from_grid, at));
            }
        });
        Ok(GroundImagery {
            origin: (shown.min - origin).as_vec2(),
            size: size.as_vec2(),
            pixels: Pixels::from_data(width as u32, height as u32, data).expect("as many as the sides say"),
            is_shaded: table.shade,
        })
    }

    /// The place in the picture of a place on the map.
    fn grid_at(&self, at: DVec2) -> Option<DVec2> {
        let grid_from_map: DAffine2 = self.imagery.map_from_grid.inverse();
        self.scene.transform(&self.own, at).ok().map(|at| grid_from_map.transform_point2(at))
    }

    /// The place on the map of a place in the picture.
    fn map_at(&self, grid: DVec2) -> Option<DVec2> {
        let at = self.imagery.map_from_grid.transform_point2(grid);
        self.own.transform(self.scene, at).ok()
    }

    fn whole(&self) -> Rect {
        Rect { min: DVec2::ZERO, max: DVec2::new(self.imagery.width.into(), self.imagery.height.into()) }
    }

    /// The part of the ground's rectangle that the picture may cover; `None` where there is none.
    fn shown(&self) -> Option<Rect> {
        // A picture of a whole country may leave what the scene's projection covers; the ground does not.
        let own = Rect::around(self.extent.grid_points().filter_map(|at| self.grid_at(at)));
        let within = own.intersection(&self.whole());
        if within.is_empty() {
            return None;
        }
        let on_map = Rect::around(within.grid_points().filter_map(|grid| self.map_at(grid)));
        let shown = on_map.intersection(&self.extent);
        (!shown.is_empty() && shown.size().min_element() > 0.0).then_some(shown)
    }

    /// The shorter side of the picture's pixel at a place on the map, meters.
    fn pixel_m(&self, at: DVec2) -> Option<f64> {
        let grid = self.grid_at(at)?;
        let [east, south] =
            [DVec2::X, DVec2::Y].map(|side| Some((self.map_at(grid + side)? - self.map_at(grid)?).length()));
        let side = east?.min(south?);
        (side.is_finite() && side > 0.0).then_some(side)
    }

    /// The pixels of the picture that show a rectangle of the map.
    fn window(&self, shown: &Rect) -> Option<RasterWindow> {
        let own = Rect::around(shown.grid_points().filter_map(|at| self.grid_at(at))).grown(BESIDE_PX);
        let within = own.intersection(&self.whole());
        let (first, last) = (within.min.floor(), within.max.ceil());
        let count = last - first;
        (!within.is_empty() && count.min_element() >= 1.0).then_some(RasterWindow {
            column: first.x as u32,
            row: first.y as u32,
            width: count.x as u32,
            height: count.y as u32,
        })
    }

    fn beside(&self, document: &Document, table: &ImageryTable) -> Diagnostic {
        let corners =
            self.whole().grid_points().map(|grid| self.imagery.map_from_grid.transform_point2(grid));
        let Rect { min, max } = Rect::around(corners);
        let message = format!("{} shows none of the ground", *table.file);
        let help = format!(
            "it covers {:.6} to {:.6} and {:.6} to {:.6} in {}; if that is not its system, state the right one with \
             the key `crs`",
            min.x,
            max.x,
            min.y,
            max.y,
            self.own.name()
        );
        document.error(&table.file, message).with_help(help)
    }
}
