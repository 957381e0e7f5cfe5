//! Finds the number of elevation samples that planned pictures show, before any is read.
//!
//! A camera that is far from all of the ground has many samples in a pixel, so that means over squares of them give the same
//! picture:
//!
//! ```text
//!   eye
//!    ╲╲  ╲          fitted: the eye that has level ground of this extent fill the picture; nearest is what the
//!     ╲ ╲   ╲       lower border of the picture shows
//!      ╲  ╲    ╲    stated: no ground is nearer than the extent's border, nor than the highest ground on Earth
//! ▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔  parallel rays: a pixel is as wide everywhere
//! ```
//!
//! The heights are not known yet. On ground that rises up to half way to the eye, a pixel is half as wide as on level ground:
//! so squares are no wider than half a pixel there, and hills up to that height lose nothing that a pixel shows. Higher ground
//! has a fitted eye move away.

use glam::{DVec2, Vec2, Vec3};

use crate::framing::fit::{ParallelSpan, fitted_eye};
use crate::framing::fitted_view::{free_frame, half_picture, pitches, turns};
use crate::framing::parallel_view::pixels_per_meter;
use crate::framing::shaped_page::pages;
use crate::paper_sheet::{PaperSheet, SCREEN_PX};
use crate::planned_pictures::{PlannedCameras, PlannedPictures};
use crate::scene_view::{FittedView, ParallelView, ViewAim};
use crate::views;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{CameraTable, Document};
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;
use sandtable_raster::raster::Raster;
use sandtable_view::axes::DirectionAxes;

/// The width of a square of samples, in pixels of level ground.
pub const SQUARE_PX: f64 = 0.5;

/// Higher than any ground on Earth, meters.
const HIGHEST_GROUND_M: f64 = 9000.0;

/// Samples along a side that are kept however small a picture is: enough for the shape of its ground.
const LEAST_SIDE: u32 = 256;

/// Elevation that is not read yet, in the system of its ground.
pub(crate) struct UnreadGround<'a> {
    /// The raster without its samples.
    pub whole: &'a Raster,
    /// The system that the ground is made in.
    pub crs: &'a Crs,
    /// The system that the scene or its elevation states.
    pub stated_crs: &'a Crs,
}

/// The greatest power of two so that squares of as many by as many samples are no wider than [`SQUARE_PX`] in all of
/// `pictures` of `document`; 1 where a camera may come near the ground.
pub(crate) fn shown_step(pictures: &PlannedPictures, document: &Document, ground: &UnreadGround<'_>) -> u32 {
    let widest = widest_square(pictures, document, ground);
    let most = ground.whole.width.min(ground.whole.height) / LEAST_SIDE;
    let step = widest.unwrap_or(1.0).clamp(1.0, f64::from(most.max(1)));
    1 << (step as u32).ilog2()
}

/// Samples along the side of the widest square that no picture shows wider than [`SQUARE_PX`]; `None` where that is not known.
fn widest_square(pictures: &PlannedPictures, document: &Document, ground: &UnreadGround<'_>) -> Option<f64> {
    let own = ground.whole.crs.as_ref().unwrap_or(ground.stated_crs);
    let points: Result<Vec<DVec2>, _> =
        ground.whole.extent().grid_points().map(|at| own.transform(ground.crs, at)).collect();
    let extent = Rect::around(points.ok()?);
    let count = DVec2::new(ground.whole.width.into(), ground.whole.height.into());
    let cell_m = (extent.size() / count).max_element();
    let frame = WorldFrame::new(document, ground.crs, ground.stated_crs, extent);
    let plan = Rect { min: DVec2::ZERO, max: extent.size() };
    let cameras = &document.cameras;
    let planned: Vec<Option<&CameraTable>> = match &pictures.cameras {
        PlannedCameras::All if !cameras.is_empty() => cameras.iter().map(Some).collect(),
        PlannedCameras::All | PlannedCameras::First => vec![cameras.first()],
        PlannedCameras::Named(name) => vec![Some(cameras.iter().find(|table| *table.name == *name)?)],
        PlannedCameras::Plans(pixel_m) => return Some(pixel_m * SQUARE_PX / cell_m),
    };
    let mut pixel_m = f64::INFINITY;
    for table in planned {
        let paper = table.and_then(views::paper);
        let size = pictures.size.or(paper.as_ref().map(PaperSheet::size_px));
        // What is wrong with a camera is reported when it is made.
        pixel_m = pixel_m.min(finest_pixel_m(table, &frame, &plan, size).ok()??);
    }
    let squares = pixel_m * SQUARE_PX / cell_m;
    squares.is_finite().then_some(squares)
}

/// The width of the pixel that shows the least ground on a picture of a stated size, or of the one that it would have, meters;
/// `None` where the camera may be at the ground.
fn finest_pixel_m(
    table: Option<&CameraTable>,
    frame: &WorldFrame<'_>,
    plan: &Rect,
    stated: Option<(u32, u32)>,
) -> Result<Option<f64>, Diagnostic> {
    let size = stated.unwrap_or(SCREEN_PX);
    let half = half_picture(views::fov_y_rad(table), size);
    let aim = match table {
        None => views::overview().aim,
        Some(table) if views::panorama_eye(table).is_some() => return Ok(None),
        Some(table) => match views::eye_and_target(table) {
            Some([eye, _]) => {
                let eye = (frame.point(eye, table.crs.as_ref())?, table.eye_elevation);
                return Ok(stated_depth_m(eye, half, frame, plan).map(|depth| pixel_m(depth, half, size)));
            }
            None => views::aim_without_eye(table, frame, plan)?,
        },
    };
    Ok(match aim {
        ViewAim::Fitted(view) => fitted_depth_m(&view, half, plan).map(|depth| pixel_m(depth, half, size)),
        ViewAim::Parallel(view) => match stated {
            None if view.scale.is_none() => {
                pages().map(|page| parallel_pixel_m(&view, plan, page)).reduce(f64::min)
            }
            _ => Some(parallel_pixel_m(&view, plan, size)),
        },
        ViewAim::At { .. } | ViewAim::Panorama(_) => None,
    })
}

/// The width of a pixel at a depth, meters.
fn pixel_m(depth_m: f64, half: Vec2, (_, height): (u32, u32)) -> f64 {
    2.0 * depth_m * f64::from(half.y) / f64::from(height)
}

/// The least depth at which a camera with a stated eye sees ground.
fn stated_depth_m(
    (eye, elevation_m): (DVec2, Option<f64>),
    half: Vec2,
    frame: &WorldFrame<'_>,
    plan: &Rect,
) -> Option<f64> {
    let aside = eye.distance(eye.clamp(plan.min, plan.max));
    let above_m = elevation_m.map_or(0.0, |elevation| (elevation - HIGHEST_GROUND_M).max(0.0));
    let nearest = aside.hypot(f64::from(frame.scale.world_z(above_m as f32)));
    // In a corner of the picture, depth is less than distance.
    let depth_m = nearest / f64::from(half.length()).hypot(1.0);
    (depth_m > 0.0).then_some(depth_m)
}

/// The least depth at which a fitted camera sees level ground.
fn fitted_depth_m(view: &FittedView, half: Vec2, plan: &Rect) -> Option<f64> {
    let corners = corners(&view.shown.unwrap_or(*plan));
    let pitches: Vec<f32> = view.pitch_rad.map_or_else(|| pitches().collect(), |pitch| vec![pitch]);
    let azimuths: Vec<f32> = view.azimuth_rad.map_or_else(|| turns().collect(), |azimuth| vec![azimuth]);
    let depth_m = |axes: DirectionAxes| {
        let eye = fitted_eye(&corners, &axes, &free_frame(half));
        let lower_border = axes.forward - axes.up * half.y;
        f64::from(eye.z / -lower_border.z)
    };
    let all = pitches.iter().flat_map(|&pitch| {
        azimuths.iter().map(move |&azimuth| DirectionAxes::new(azimuth, pitch)).map(depth_m)
    });
    Some(all.fold(f64::INFINITY, f64::min)).filter(|depth| *depth > 0.0)
}

/// The width of a pixel of a view with parallel rays: relief only makes what it shows larger, and its scale smaller.
fn parallel_pixel_m(view: &ParallelView, plan: &Rect, size: (u32, u32)) -> f64 {
    let axes = DirectionAxes::new(view.azimuth_rad, view.pitch_rad);
    let shown = ParallelSpan::new(corners(&view.shown.unwrap_or(*plan)), &axes);
    pixels_per_meter(view, &shown, size).max_element().recip()
}

/// The corners of a rectangle of level ground.
fn corners(rect: &Rect) -> [Vec3; 4] {
    let Rect { min, max } = *rect;
    [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)].map(|at| at.as_vec2().extend(0.0))
}
