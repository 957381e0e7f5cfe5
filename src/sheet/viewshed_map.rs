//! The map of a viewshed: tinted and shaded ground, darkened where it is hidden.
//!
//! Every post has one color. A pixel larger than a cell is the mean of the posts under it, a smaller one a bilinear
//! blend of the four posts around it. Means are taken in linear light.

use glam::{DVec2, Vec2, Vec3};
use rayon::prelude::*;

use crate::relief::{RELIEF, shaded};
use sandtable_annotate::legend::Legend;
use sandtable_annotate::map::{MapFurniture, ObserverOverlay, compose, draw_observer, sheet_size};
use sandtable_draw::color::Srgba;
use sandtable_draw::ground::ColorRamp;
use sandtable_draw::pixels::Pixels;
use sandtable_geom::crs::Crs;
use sandtable_geom::declination::true_north;
use sandtable_scene::climate::Climate;
use sandtable_scene::ramps::{self, TintedGround};
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::sight::viewshed::{PostVisibility, Viewshed, ViewshedOptions};

/// The map fits into this size, so that the sheet with its furniture is no wider than a screen of 1920 pixels.
const LARGEST_PX: DVec2 = DVec2::new(1560.0, 1560.0);
/// The shortest side, for long and narrow ground.
const LEAST_PX: f64 = 48.0;
/// The tint of hidden ground and its share: dark enough to distinguish, light enough to read.
const DUSK: Srgba = Srgba::opaque(0x3a, 0x42, 0x5c);
const DUSK_SHARE: f32 = 0.66;
/// The tint of ground that was not looked at, and its share: faded toward paper.
const FADED: Srgba = Srgba::opaque(0xf4, 0xf2, 0xec);
const FADED_SHARE: f32 = 0.62;
/// The color of posts without data.
const EMPTY: Srgba = Srgba::opaque(0xe6, 0xe4, 0xde);

/// The texts of the sheet.
pub struct SheetText {
    /// The title.
    pub title: String,
    /// The line below it.
    pub subtitle: String,
    /// The vertical datum, where the file states it.
    pub vertical_datum: Option<String>,
}

/// The sheet with the map of a viewshed on a lattice in the coordinates of `crs`.
pub fn viewshed_map(
    (lattice, crs): (&Lattice, &Crs),
    viewshed: &Viewshed,
    options: &ViewshedOptions,
    text: SheetText,
) -> Pixels {
    let (low_m, high_m) = lattice.height_range();
    let ramp =
        ramps::atlas(&TintedGround { range_m: (low_m, high_m), climate: Climate::at(None), has_sea: false });
    let colors = colors(lattice, viewshed, &ramp);
    let frame = MapFrame::around(lattice);
    let mut map = frame.resampled(&colors);
    let outlook = outlook(lattice, options, &frame);
    draw_observer(&mut map, &outlook, sheet_size((frame.width, frame.height)));
    let furniture = MapFurniture {
        title: text.title,
        subtitle: text.subtitle,
        tints: key(viewshed, ramp.linear_at(low_m + 0.3 * (high_m - low_m))),
        legend: Legend {
            ramp,
            low_m,
            high_m,
            vertical_exaggeration: 1.0,
            model_enlargement: None,
            has_inferred_cover: false,
            has_voids: false,
            contour_interval: None,
            vertical_datum: text.vertical_datum,
        },
        pixels_per_meter: frame.pixels_per_m as f32,
        true_north: true_north(crs, lattice.map_extent().center()).map(|north| north.as_vec2()),
    };
    compose(&map, &furniture).0
}

/// Swatches of the kinds of posts that occur, on ground of this tint.
fn key(viewshed: &Viewshed, tint: Vec3) -> Vec<(Srgba, String)> {
    let counts = viewshed.counts();
    let entries = [
        (PostVisibility::Visible, counts.visible, "In sight"),
        (PostVisibility::Hidden, counts.hidden, "Hidden"),
        (PostVisibility::Beyond, counts.beyond, "Not looked at"),
        (PostVisibility::NoData, counts.no_data, "No data"),
    ];
    let entries = entries.into_iter().filter(|&(_, count, _)| count > 0);
    entries.map(|(post, _, text)| (Srgba::from_linear(tinted(post, tint)), text.to_owned())).collect()
}

/// The tint of a post.
fn tinted(post: PostVisibility, tint: Vec3) -> Vec3 {
    match post {
        PostVisibility::Visible => tint,
        PostVisibility::Hidden => (tint * 0.55).lerp(DUSK.linear(), DUSK_SHARE),
        PostVisibility::Beyond => tint.lerp(FADED.linear(), FADED_SHARE),
        PostVisibility::NoData => EMPTY.linear(),
    }
}

/// The color of every post in linear light.
fn colors(lattice: &Lattice, viewshed: &Viewshed, ramp: &ColorRamp) -> Vec<Vec3> {
    let shaded = shaded(lattice, ramp, RELIEF, |index, tint| tinted(viewshed.posts[index], tint));
    shaded.into_iter().map(|color| color.unwrap_or(EMPTY.linear())).collect()
}

/// The map's square pixels over the lattice: north up, half a cell beyond the outer posts.
struct MapFrame {
    width: u32,
    height: u32,
    pixels_per_m: f64,
    /// Posts per pixel, eastward and northward.
    step: DVec2,
    columns: u32,
    rows: u32,
}

impl MapFrame {
    fn around(lattice: &Lattice) -> Self {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let extent_m = DVec2::new(f64::from(columns), f64::from(rows)) * lattice.cell();
        let pixels_per_m = (LARGEST_PX / extent_m).min_element();
        let size = (extent_m * pixels_per_m).round().max(DVec2::splat(LEAST_PX));
        let step = DVec2::new(f64::from(columns), f64::from(rows)) / size;
        Self { width: size.x as u32, height: size.y as u32, pixels_per_m, step, columns, rows }
    }

    /// Pixels of a grid position; Y down.
    fn pixel_at(&self, grid: DVec2) -> Vec2 {
        let across = (grid + 0.5) / self.step;
        Vec2::new(across.x as f32, (f64::from(self.height) - across.y) as f32)
    }

    fn resampled(&self, colors: &[Vec3]) -> Pixels {
        let mut pixels = Pixels::filled(self.width, self.height, EMPTY);
        let rows = pixels.data_mut().par_chunks_mut(self.width as usize);
        rows.enumerate().for_each(|(y, row)| {
            let north = under(f64::from(self.height) - y as f64 - 1.0, self.step.y, self.rows);
            for (x, pixel) in row.iter_mut().enumerate() {
                let east = under(x as f64, self.step.x, self.columns);
                *pixel = Srgba::from_linear(self.mean(colors, &east, &north));
            }
        });
        pixels
    }

    fn mean(&self, colors: &[Vec3], east: &[(u32, f32)], north: &[(u32, f32)]) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for &(row, share) in north {
            let row = &colors[row as usize * self.columns as usize..];
            for &(column, weight) in east {
                sum += row[column as usize] * (weight * share);
            }
        }
        sum
    }
}

/// The posts under a pixel along one axis with their weights, whose sum is 1.
fn under(pixel: f64, step: f64, count: u32) -> Vec<(u32, f32)> {
    let last = count - 1;
    if step <= 1.0 {
        let at = ((pixel + 0.5) * step - 0.5).clamp(0.0, f64::from(last));
        let (low, part) = (at.floor(), at.fract() as f32);
        return vec![(low as u32, 1.0 - part), ((low as u32 + 1).min(last), part)];
    }
    let (start, end) = (pixel * step, (pixel + 1.0) * step);
    (start as u32..=(end as u32).min(last))
        .map(|post| {
            let covered = (f64::from(post) + 1.0).min(end) - f64::from(post).max(start);
            (post, (covered.max(0.0) / step) as f32)
        })
        .collect()
}

fn outlook(lattice: &Lattice, options: &ViewshedOptions, frame: &MapFrame) -> ObserverOverlay {
    let grid = lattice.grid_at(options.observer.at - lattice.map_position(Post { column: 0, row: 0 }));
    let sector = options.sector;
    ObserverOverlay {
        at_px: frame.pixel_at(grid),
        range_px: options.range_m.is_finite().then_some((options.range_m * frame.pixels_per_m) as f32),
        sector_deg: (sector.width_deg < 360.0).then_some((sector.from_deg as f32, sector.width_deg as f32)),
    }
}
