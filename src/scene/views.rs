//! Cameras in world space.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

use glam::{DVec2, Vec3};

use crate::build_errors::BuildErrorSink;
use crate::paper_sheet::PaperSheet;
use crate::scene_findings::SceneFindings;
use crate::scene_view::{FittedView, PanoramaView, ParallelView, SceneView, ViewAim};
use crate::vertical_scale::DrawnGround;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{CameraTable, Document, PAPER_DPI, paper_mm};
use sandtable_description::finding_code::FindingCode;
use sandtable_description::panorama_keys::panorama_span_deg;
use sandtable_description::stated::Stated;
use sandtable_description::words::{CameraProjection, SheetLayout};
use sandtable_geom::position::Position;
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The document's cameras; without any, one that is fitted to the whole ground. `errors` keeps one where the eye of a camera
/// without `eye_elevation` lies off the ground, its target does, or the two coincide.
pub fn cameras(frame: &WorldFrame<'_>, lattice: &Lattice, errors: &mut BuildErrorSink) -> Vec<SceneView> {
    if frame.document.cameras.is_empty() {
        return vec![overview()];
    }
    let tables = frame.document.cameras.iter();
    tables.filter_map(|table| errors.keep(camera(table, frame, lattice))).collect()
}

/// The field of view of a camera with an eye, degrees.
const EYE_FOV_DEG: f64 = 40.0;
/// The field of view of a fitted camera, degrees: long lenses keep the far ground large.
const FITTED_FOV_DEG: f64 = 28.0;

fn camera(table: &CameraTable, frame: &WorldFrame<'_>, lattice: &Lattice) -> Result<SceneView, Diagnostic> {
    let aim = match (eye_and_target(table), panorama_eye(table)) {
        (Some([eye, look_at]), _) => aimed(table, eye, look_at, frame, lattice)?,
        (None, Some(eye)) => ViewAim::Panorama(panorama(table, eye, frame, lattice)?),
        (None, None) => aim_without_eye(table, frame, &plan(lattice))?,
    };
    Ok(SceneView {
        name: table.name.to_string(),
        aim,
        fov_y_rad: fov_y_rad(Some(table)),
        paper: paper(table),
    })
}

/// The ground of a lattice in world space.
fn plan(lattice: &Lattice) -> Rect {
    Rect { min: DVec2::ZERO, max: lattice.extent().size() }
}

/// Where a camera has its eye, and where it looks; `None` where its eye depends on what it shows, or where it has none.
pub(super) fn eye_and_target(table: &CameraTable) -> Option<[&Stated<Position>; 2]> {
    let is_perspective = table.projection == CameraProjection::Perspective;
    let places = table.eye.as_ref().zip(table.look_at.as_ref());
    places.filter(|_| is_perspective).map(|(eye, look_at)| [eye, look_at])
}

/// Where a panorama has its eye; `None` for other cameras.
pub(super) fn panorama_eye(table: &CameraTable) -> Option<&Stated<Position>> {
    table.eye.as_ref().filter(|_| table.projection == CameraProjection::Panorama)
}

/// The azimuth of the left border of a panorama where it is not stated: north is in the middle.
const PANORAMA_FROM_DEG: f64 = 180.0;

fn panorama(
    table: &CameraTable,
    eye: &Stated<Position>,
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
) -> Result<PanoramaView, Diagnostic> {
    if matches!(frame.document.furniture.layout, SheetLayout::Margin | SheetLayout::Military) {
        let message = "a panorama has no margin, and the scene's `layout` has one";
        let help = "set `layout` to compact or none, or give the panorama a scene file of its own";
        return Err(frame.document.error(&table.name, message).with_help(help));
    }
    let eye_world = frame.point(eye, table.crs.as_ref())?;
    let ground = frame.on_ground(lattice, eye, eye_world)?;
    let elevation_m = table.eye_elevation.map_or_else(
        || frame.scale.elevation_m(ground.z) + table.eye_height as f32,
        |elevation| elevation as f32,
    );
    Ok(PanoramaView {
        // The eye's height is drawn as high as the ground's, so that it sees what it would see.
        eye: ground.with_z(frame.scale.world_z(elevation_m)),
        from_rad: table.from.unwrap_or(PANORAMA_FROM_DEG).to_radians() as f32,
        span_rad: panorama_span_deg(table.from, table.to).to_radians() as f32,
    })
}

/// The vertical field of view of a camera, radians; without one, that of a view of the whole ground.
pub(super) fn fov_y_rad(table: Option<&CameraTable>) -> f32 {
    let usual = match table.and_then(eye_and_target) {
        Some(_) => EYE_FOV_DEG,
        None => FITTED_FOV_DEG,
    };
    (table.and_then(|table| table.field_of_view).unwrap_or(usual) as f32).to_radians()
}

/// The aim of a camera without an eye of its own, on ground that fills the rectangle `ground` of world space.
pub(super) fn aim_without_eye(
    table: &CameraTable,
    frame: &WorldFrame<'_>,
    ground: &Rect,
) -> Result<ViewAim, Diagnostic> {
    Ok(match table.projection {
        CameraProjection::Perspective => ViewAim::Fitted(fitted(table, frame, ground)?),
        _ => ViewAim::Parallel(parallel(table, frame, ground)?),
    })
}

fn aimed(
    table: &CameraTable,
    eye: &Stated<Position>,
    look_at: &Stated<Position>,
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
) -> Result<ViewAim, Diagnostic> {
    let eye_world = frame.point(eye, table.crs.as_ref())?;
    let eye = match table.eye_elevation {
        Some(elevation) => eye_world.as_vec2().extend(frame.scale.world_z(elevation as f32)),
        None => {
            let ground = frame.on_ground(lattice, eye, eye_world).map_err(|error| {
                error.with_help("give the camera an eye_elevation where its eye is not above the model")
            })?;
            ground + Vec3::Z * table.eye_height as f32
        }
    };
    let target_world = frame.point(look_at, table.crs.as_ref())?;
    let target = frame.on_ground(lattice, look_at, target_world)?;
    let target = target + Vec3::Z * table.look_at_height as f32;
    if (target - eye).try_normalize().is_none() {
        let message = "the camera looks at the place where its eye is";
        let help = "move look_at, or give it another look_at_height";
        return Err(frame.document.error(look_at, message).with_help(help));
    }
    Ok(ViewAim::At { eye, target })
}

fn fitted(table: &CameraTable, frame: &WorldFrame<'_>, ground: &Rect) -> Result<FittedView, Diagnostic> {
    let radians = |degrees: f64| degrees.to_radians() as f32;
    Ok(FittedView {
        azimuth_rad: table.azimuth.map(radians),
        pitch_rad: table.pitch.map(radians),
        shown: shown(table, frame, ground)?,
    })
}

/// The paper of a camera.
pub(super) fn paper(table: &CameraTable) -> Option<PaperSheet> {
    let [longer, shorter] = paper_mm(table.paper?);
    let size_mm = if table.portrait { [shorter, longer] } else { [longer, shorter] };
    Some(PaperSheet { size_mm, dpi: table.dpi.unwrap_or(PAPER_DPI) })
}

/// The dots per inch of a screen, by convention.
const SCREEN_DPI: f64 = 96.0;

fn parallel(table: &CameraTable, frame: &WorldFrame<'_>, ground: &Rect) -> Result<ParallelView, Diagnostic> {
    let radians = |degrees: f64| degrees.to_radians() as f32;
    let (pitch_rad, stretch) = match table.projection {
        CameraProjection::Plan => (FRAC_PI_2, 1.0),
        // Rays that fall by 45° show level ground as it is where the picture is stretched by the square root of 2.
        CameraProjection::Oblique => (FRAC_PI_4, SQRT_2),
        CameraProjection::Orthographic | CameraProjection::Perspective | CameraProjection::Panorama => {
            (table.pitch.map_or(FRAC_PI_4, radians), 1.0)
        }
    };
    Ok(ParallelView {
        azimuth_rad: radians(table.azimuth.unwrap_or(0.0)),
        pitch_rad,
        stretch,
        scale: table.scale,
        dpi: table.dpi.unwrap_or(if table.paper.is_some() { PAPER_DPI } else { SCREEN_DPI }),
        shown: shown(table, frame, ground)?,
        middle: None,
    })
}

/// The ground around the points that a camera shows; `None` where it names none.
fn shown(table: &CameraTable, frame: &WorldFrame<'_>, ground: &Rect) -> Result<Option<Rect>, Diagnostic> {
    let shown = table.shows.as_ref().map(|shows| {
        let corners: Result<Vec<DVec2>, _> =
            shows.iter().map(|corner| frame.position(corner, table.crs.as_ref())).collect();
        let corners = corners.map_err(|error| frame.document.error(shows, error))?;
        let shown = Rect::around(corners).intersection(ground);
        if shown.is_empty() {
            let help = "name points on it, or remove `shows` to see all of it";
            let message = "the camera shows nothing of the elevation model";
            return Err(frame.document.error(shows, message).with_help(help));
        }
        Ok(shown)
    });
    shown.transpose()
}

/// Finds the cameras whose eye is under the ground.
pub fn find_buried(
    document: &Document,
    cameras: &[SceneView],
    ground: DrawnGround<'_>,
    findings: &mut SceneFindings,
) {
    let lattice = ground.lattice;
    let depth_m = |view: &SceneView| {
        let eye = match view.aim {
            ViewAim::At { eye, .. } | ViewAim::Panorama(PanoramaView { eye, .. }) => eye,
            ViewAim::Fitted(_) | ViewAim::Parallel(_) => return None,
        };
        let at = lattice.map_point(eye);
        let height = ground_height(lattice, Interpolation::Planar, at).height_m()?;
        Some(height - f64::from(ground.scale.elevation_m(eye.z))).filter(|&depth| depth > 0.0)
    };
    for (view, table) in cameras.iter().zip(&document.cameras) {
        if let Some(depth) = depth_m(view) {
            let message = format!("camera '{}' has its eye {depth:.1} m under the ground", view.name);
            let span = table.eye.as_ref().and_then(Stated::span).unwrap_or_default();
            findings.add(FindingCode::CameraUnderground, span, message);
        }
    }
}

/// A view that is fitted to the whole ground.
pub(super) fn overview() -> SceneView {
    let view = FittedView { azimuth_rad: None, pitch_rad: None, shown: None };
    SceneView { name: "overview".into(), aim: ViewAim::Fitted(view), fov_y_rad: fov_y_rad(None), paper: None }
}
