//! Exporting a scene as a page for browsers.

use std::path::Path;

use glam::{DVec2, Vec3};

use crate::page::{PageCamera, PageFacts, PageLabel, PageScene, PageTooLarge, page};
use crate::page_symbols::symbol_pictures;
use sandtable_base::message::choice::Choice;
use sandtable_draw::list::FeatureId;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_geom::chebyshev::ChebyshevTable;
use sandtable_geom::crs::Crs;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_picture::all_round::{AllRoundScene, all_round};
use sandtable_picture::camera;
use sandtable_picture::placed_text::PlacedText;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::plinth::base_z;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_terrain::stop_flag::StopFlag;
use sandtable_view::camera::{CameraError, ViewProjection};

/// The error of the drawn ground where none is stated: the first of these, in meters, that needs no more triangles than
/// [`MOST_TRIANGLES`].
const ERRORS_M: [f64; 8] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];

/// A phone draws as many triangles thirty times a second; colors and relief do not depend on them.
const MOST_TRIANGLES: usize = 400_000;

/// The error of longitude and latitude in degrees that is aimed at: a tenth of a millimeter.
const LON_LAT_ERROR_DEG: f64 = 1e-9;

/// The most that is accepted: one in the last digit that a page shows.
const MOST_LON_LAT_ERROR_DEG: f64 = 1e-6;

/// The picture that views are fitted to; on a narrower one they keep their width, on a wider one their height.
const VIEW_SIZE: (u32, u32) = (1280, 720);

/// A page that was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExportedPage {
    /// Its size in bytes.
    pub bytes: usize,
    /// Triangles of the ground.
    pub ground_triangles: usize,
    /// The error of the ground at any post, at most, in meters.
    pub max_error_m: f64,
}

/// A page that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ExportPageError {
    #[error(transparent)]
    File(#[from] WriteFileError),
    #[error(transparent)]
    Camera(#[from] CameraError),
    #[error(transparent)]
    Size(#[from] PageTooLarge),
}

/// Exports a scene as a page to `path`. The ground is off by at most `max_error_m` at every post; without it by as little
/// as a page of a usual size allows. `progress` is called with the name of each step as it begins, and `watch` says how much of
/// the page is packed.
///
/// The light is that of the first view.
///
/// # Errors
/// See [`ExportPageError`].
pub fn export_page(
    scene: &SceneModel,
    path: &Path,
    max_error_m: Option<f64>,
    progress: &dyn Fn(&'static str),
    watch: &StopFlag,
) -> Result<ExportedPage, ExportPageError> {
    disk::check_output(path, &scene.files)?;
    let (bytes, exported) = page_bytes(scene, max_error_m, progress, watch)?;
    disk::write(path, &bytes)?;
    Ok(exported)
}

/// The bytes of the page that [`export_page`] writes, and what it holds.
///
/// # Errors
/// See [`ExportPageError`].
pub fn page_bytes(
    scene: &SceneModel,
    max_error_m: Option<f64>,
    progress: &dyn Fn(&'static str),
    watch: &StopFlag,
) -> Result<(Vec<u8>, ExportedPage), ExportPageError> {
    let first = camera(scene, &scene.cameras[0], VIEW_SIZE)?;
    let to_sun = scene.sunlight.to_sun(Some(&first));
    progress("refining terrain");
    let (displayed, max_error_m) = displayed(scene, max_error_m);
    let all = all_round(scene, &displayed, to_sun, progress)?;
    progress("writing");
    let facts = facts(scene, &all, max_error_m)?;
    let bytes = page(&PageScene { drawn: &all, lattice: &scene.lattice, facts: &facts }, watch)?;
    let ground_triangles = all.list.items.first().map_or(0, |ground| ground.triangles.len());
    let exported = ExportedPage { bytes: bytes.len(), ground_triangles, max_error_m };
    Ok((bytes, exported))
}

/// The ground, and its greatest error in meters of elevation.
fn displayed(scene: &SceneModel, max_error_m: Option<f64>) -> (DisplayedTerrain, f64) {
    let within = |max_error_m: f64| {
        let drawn_m = scene.scale.world_z(max_error_m) as f32;
        (scene.ground().displayed_within(drawn_m), max_error_m)
    };
    let fits = |(displayed, _): &(DisplayedTerrain, f64)| triangle_count(displayed) <= MOST_TRIANGLES;
    let first = || ERRORS_M.iter().map(|&error_m| within(error_m)).find(fits);
    match max_error_m {
        Some(max_error_m) => within(max_error_m),
        None => first().unwrap_or_else(|| within(ERRORS_M[ERRORS_M.len() - 1])),
    }
}

fn triangle_count(displayed: &DisplayedTerrain) -> usize {
    /// Counts vertices and triangles.
    #[derive(Default)]
    struct TriangleCount {
        vertices: usize,
        triangles: usize,
    }
    impl MeshSink<Vec3> for TriangleCount {
        fn vertex(&mut self, _: Vec3) -> VertexId {
            self.vertices += 1;
            VertexId::new(self.vertices - 1)
        }
        fn triangle(&mut self, _: [VertexId; 3]) {
            self.triangles += 1;
        }
    }
    let mut count = TriangleCount::default();
    displayed.emit(&mut count);
    count.triangles
}

fn facts(scene: &SceneModel, all: &AllRoundScene, max_error_m: f64) -> Result<PageFacts, CameraError> {
    let cameras: Result<_, CameraError> = scene.cameras.iter().map(|view| page_camera(scene, view)).collect();
    let furniture = &scene.furniture;
    let features = (2..).take(scene.features.len());
    let lines = |lines: &Option<Vec<String>>| lines.clone().unwrap_or_default();
    Ok(PageFacts {
        title: scene.title.clone().unwrap_or_default(),
        subtitle: scene.subtitle.clone().unwrap_or_default(),
        classification: furniture.classification.clone().unwrap_or_default(),
        credits: [lines(&furniture.sources), lines(&furniture.notes)].concat(),
        crs: scene.crs.name().to_owned(),
        lon_lat: lon_lat(scene),
        z_scale: scene.scale.0,
        max_error_m,
        bounds: [scene.bounds.0, scene.bounds.1],
        base_z: base_z(scene.bounds),
        haze_m: scene.haze_m,
        features: features.map(|id| scene.feature_name(FeatureId(id))).collect(),
        labels: scene.labels.iter().map(label).chain(all.graphic_texts.iter().map(graphic_text)).collect(),
        symbols: symbol_pictures(scene),
        cameras: cameras?,
    })
}

/// Longitude and latitude over the scene; `None` where its system has no known place.
fn lon_lat(scene: &SceneModel) -> Option<ChebyshevTable> {
    let wgs84 = Crs::wgs84();
    let rect = scene.lattice.map_extent();
    let middle = scene.crs.transform(&wgs84, rect.center()).ok()?;
    let near_middle = |at: DVec2| {
        let mut place = scene.crs.transform(&wgs84, at).ok()?;
        place.x = middle.x + libm::remainder(place.x - middle.x, 360.0);
        Some(place)
    };
    ChebyshevTable::fit(rect, LON_LAT_ERROR_DEG, near_middle)
        .filter(|table| table.error <= MOST_LON_LAT_ERROR_DEG)
}

fn label(label: &SceneLabel) -> PageLabel {
    let SceneLabel { text, ground, anchor, kind, rank, .. } = label;
    PageLabel {
        text: text.clone(),
        ground: *ground,
        anchor: *anchor,
        kind: kind.word(),
        rank: *rank,
        color: None,
    }
}

/// A text of a graphic, level at its place.
fn graphic_text(text: &PlacedText) -> PageLabel {
    let PlacedText { text, at, color, .. } = text;
    PageLabel {
        text: text.clone(),
        ground: *at,
        anchor: *at,
        kind: "graphic",
        rank: -1.0,
        color: Some(*color),
    }
}

fn page_camera(scene: &SceneModel, view: &SceneView) -> Result<PageCamera, CameraError> {
    let camera = camera(scene, view, VIEW_SIZE)?;
    let (half_height, is_parallel) = match camera.projection() {
        ViewProjection::Perspective { tan_half_fov } => (tan_half_fov, false),
        ViewProjection::Parallel(frame) => (frame.half_m.y * camera.stretch(), true),
    };
    Ok(PageCamera {
        name: view.name.clone(),
        eye: camera.eye(),
        forward: camera.forward(),
        up: camera.up(),
        half_height,
        is_parallel,
        stretch: camera.stretch(),
    })
}
