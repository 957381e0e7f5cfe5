//! A first scene file for an elevation model and vector files, to be edited by hand.
//!
//! ```text
//! elevation ──► ground: range of heights, extent ──┐
//! vectors ────► survey: what each layer holds ─────┴─► text ──► DIR/scene.toml
//! ```
//!
//! The file is meant to be read: a comment on every table, sizes stated even where they are the default. File names are
//! relative to the scene file, so that a folder can be moved together with its data. Nothing is copied: the scene reads
//! data under the parent of DIR as it is; for other data the user must allow the folders of [`WrittenScene::allowed`].

mod buildings;
mod cameras;
mod crop;
pub mod demo;
mod folder;
pub mod found_files;
mod named;
mod overlays;
mod rules;
mod survey;
mod text;
mod title;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use glam::DVec2;

use crate::cameras::cameras;
use crate::crop::{around_vectors, is_on_ground, main_extent, with_straight_edges};
use crate::folder::{FolderError, SceneFolder};
use crate::found_files::SCENE_NAME;
use crate::survey::{SurveyError, SurveyedLayer};
use crate::text::{SceneDraft, VectorDraft};
use sandtable_annotate::nice::NiceNumber;
use sandtable_description::parse::parse;
use sandtable_files::disk::{self, SystemError, WriteFileError};
use sandtable_geom::rect::Rect;
use sandtable_raster::undeclared::undeclared_nodata;
use sandtable_remote::address::is_address_path;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build_with;
use sandtable_scene::planned_pictures::{ElevationNeed, PlannedPictures};
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;

/// About as many contour lines as the eye can follow.
const CONTOURS: f64 = 12.0;
/// The least interval of contours, in mean changes of heights from post to post.
const CONTOUR_STEPS: f64 = 3.0;

/// Options for a new scene file.
#[derive(Clone, Debug, Default)]
pub struct NewSceneOptions {
    /// The folder for the scene file; it is made where it does not exist.
    pub folder: PathBuf,
    /// Elevation files, tiles of one raster, or their addresses; at least one. Rasters of land cover among them count as
    /// `vectors`.
    pub dem: Vec<PathBuf>,
    /// Vector files and rasters of land cover, or their addresses.
    pub vectors: Vec<PathBuf>,
    /// Files of units and graphics, or their addresses.
    pub overlays: Vec<PathBuf>,
    /// The title; where `None`, the name of the most important settlement, of the district, of the park or of the highest
    /// peak of the vectors, else the position of the ground's middle. A file's name is a title where features have it too,
    /// and where the ground has no position on Earth.
    pub title: Option<String>,
    /// The coordinate system of elevation that names none, as a scene file states it.
    pub crs: Option<String>,
}

/// A scene file that was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenScene {
    /// The file.
    pub path: PathBuf,
    /// The folders that the scene reads besides the parent of its own.
    pub allowed: Vec<PathBuf>,
}

/// A scene file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum NewSceneError {
    #[error("{}: this file exists already; remove it, or name another folder", .0.display())]
    Exists(PathBuf),
    #[error("{}: this is land cover and no elevation; name an elevation file, too", file_list(.0))]
    NoElevation(Vec<PathBuf>),
    #[error(transparent)]
    Folder(#[from] FolderError),
    #[error(transparent)]
    Survey(#[from] SurveyError),
    #[error(transparent)]
    Ground(#[from] OpenSceneError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
}

fn file_list(files: &[PathBuf]) -> String {
    files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Writes a scene file. `progress` is called with the name of each step as it begins.
///
/// # Errors
/// See [`NewSceneError`]; nothing is written then, and no folder stays behind.
pub fn write(
    options: &NewSceneOptions,
    progress: &dyn Fn(&'static str),
) -> Result<WrittenScene, NewSceneError> {
    progress("surveying files");
    let path = options.folder.join(SCENE_NAME);
    if path.symlink_metadata().is_ok() {
        return Err(NewSceneError::Exists(path));
    }
    let folder = SceneFolder::new(&options.folder)?;
    let (elevation, covers) = elevation_and_covers(&options.dem);
    if elevation.is_empty() {
        return Err(NewSceneError::NoElevation(options.dem.clone()));
    }
    let dem = elevation.iter().map(|file| folder.name_of(file)).collect::<Result<Vec<_>, _>>()?;
    let mut vectors = covers
        .into_iter()
        .chain(&options.vectors)
        .map(|file| survey_file(file, &folder))
        .collect::<Result<Vec<_>, _>>()?;
    let overlays =
        options.overlays.iter().map(|file| overlays::survey(file, &folder)).collect::<Result<Vec<_>, _>>()?;
    let on_disk = options
        .dem
        .iter()
        .chain(&options.vectors)
        .chain(&options.overlays)
        .filter(|file| !is_address_path(file));
    let allowed = folder.folders_to_allow(on_disk)?;

    progress("reading elevation");
    let draft = SceneDraft { dem, crs: options.crs.clone(), ..SceneDraft::default() };
    let is_new = !options.folder.exists();
    let system = |error: io::Error| WriteFileError::new(&path, SystemError::from(error));
    fs::create_dir_all(&options.folder).map_err(system)?;
    let mut draft = complete(&path, draft, &mut vectors, &allowed, elevation[0]).inspect_err(|_| {
        if is_new {
            // Does nothing where the folder is no longer empty.
            let _ = fs::remove_dir(&options.folder);
        }
    })?;
    if let Some(title) = &options.title {
        draft.title = title.clone();
    }
    disk::write(&path, text::scene(&draft, &vectors, &overlays).as_bytes())?;
    Ok(WrittenScene { path, allowed })
}

fn survey_file(file: &Path, folder: &SceneFolder) -> Result<VectorDraft, NewSceneError> {
    let name = folder.name_of(file)?;
    Ok(match survey::land_cover(file)? {
        Some(cover) => VectorDraft { file: name, layers: Vec::new(), land_cover: Some(cover.legend) },
        None => VectorDraft { file: name, layers: survey::layers(file)?, land_cover: None },
    })
}

/// Those of the files named as elevation that are, and those that are surely rasters of land cover.
fn elevation_and_covers(files: &[PathBuf]) -> (Vec<&PathBuf>, Vec<&PathBuf>) {
    let is_cover = |file: &&PathBuf| {
        let cover = survey::land_cover(file).ok().flatten();
        cover.is_some_and(|cover| cover.is_sure)
    };
    let (covers, elevation) = files.iter().partition(is_cover);
    (elevation, covers)
}

/// Completes the draft from the elevation, whose first file is `dem`: heights, extent, cameras and title.
fn complete(
    path: &Path,
    mut draft: SceneDraft,
    vectors: &mut [VectorDraft],
    allowed: &[PathBuf],
    dem: &Path,
) -> Result<SceneDraft, OpenSceneError> {
    let assets = Assets::new(path, allowed)?;
    // What is found of the ground is as fine as its first picture.
    let pictures = PlannedPictures::default();
    let built = |draft: &SceneDraft| {
        let document = parse(&path.to_string_lossy(), &text::terrain(draft))?;
        Ok::<_, OpenSceneError>(build_with(&document, &assets, ElevationNeed::Pictures(&pictures), &|_| ())?)
    };
    let mut scene = built(&draft)?;
    draft.nodata = undeclared_nodata(scene.heights.snapshot().source());
    let surveyed = vectors;
    let vectors = main_extent(surveyed, &scene);
    let around_vectors = around_vectors(vectors, scene.lattice.map_extent());
    draft.extent = around_vectors.map(|extent| extent.stated_in(&scene));
    if !draft.nodata.is_empty() {
        scene = built(&draft)?;
        let straight = || with_straight_edges(&scene.lattice).map(|extent| extent.stated_in(&scene));
        draft.extent = draft.extent.or_else(straight);
    }
    if draft.extent.is_some() {
        scene = built(&draft)?;
    }
    draft.has_sea_bed = has_sea_bed(surveyed, &scene);
    draft.title = title::of_scene(dem, surveyed, &scene);
    for layer in surveyed.iter_mut().flat_map(|vector| &mut vector.layers) {
        layer.is_on_ground = is_on_ground(layer, &scene);
        let buildings = layer.buildings.as_ref();
        layer.building_height_m = buildings.and_then(|found| found.likely_height_m(&layer.crs, &scene.crs));
    }
    let (lattice, (low, high)) = (&scene.lattice, scene.height_range_m);
    let size_m = lattice.extent().size().max_element();
    draft.relief_m = f64::from(high - low);
    draft.crs_name = scene.stated_crs.name().to_owned();
    draft.exaggeration = exaggeration(draft.relief_m / size_m);
    draft.post_m = lattice.measured_cell().max_element();
    draft.contours_m = contour_interval(lattice, draft.relief_m);
    draft.cameras = cameras(&scene, vectors, draft.exaggeration);
    for camera in &mut draft.cameras {
        camera.shown = camera.shown.map(|shown| stated(shown, &scene));
    }
    Ok(draft)
}

/// Whether a coastline of the vectors runs through ground below 0 m that reaches the border, and no level sea shows.
fn has_sea_bed(vectors: &[VectorDraft], scene: &SceneModel) -> bool {
    let water = scene.water();
    let ground = scene.lattice.map_extent();
    let is_on_ground = |layer: &SurveyedLayer| {
        let mut coast = layer.coast.iter().filter_map(|at| layer.crs.transform(&scene.crs, *at).ok());
        coast.any(|at| ground.contains(at))
    };
    water.sea_posts == 0
        && water.open_low_posts > 0
        && vectors.iter().flat_map(|vector| &vector.layers).any(is_on_ground)
}

/// A rectangle of the ground, in the system of inline points; where that is another one, the largest whose sides cut
/// through none of its corners. What has no place in that system stays as it is.
fn stated(rect: Rect, scene: &SceneModel) -> Rect {
    if scene.stated_crs == scene.crs {
        return rect;
    }
    let corner = |x: f64, y: f64| scene.crs.transform(&scene.stated_crs, DVec2::new(x, y));
    let Rect { min, max } = rect;
    let corners = [corner(min.x, min.y), corner(max.x, min.y), corner(min.x, max.y), corner(max.x, max.y)];
    let [Ok(low_left), Ok(low_right), Ok(high_left), Ok(high_right)] = corners else { return rect };
    let inner = Rect {
        min: DVec2::new(low_left.x.max(high_left.x), low_left.y.max(low_right.y)),
        max: DVec2::new(low_right.x.min(high_right.x), high_left.y.min(high_right.y)),
    };
    if inner.is_empty() { Rect::around([low_left, low_right, high_left, high_right]) } else { inner }
}

/// The interval of contours in meters; `None` on level ground.
///
/// It is wider than the relief asks for where the ground changes more from post to post: between such posts lines would tell
/// the noise of the model, as roofs and trees in one of radar.
fn contour_interval(lattice: &Lattice, relief_m: f64) -> Option<f64> {
    let wanted = NiceNumber::at_most(relief_m / CONTOURS)?.value();
    let told = NiceNumber::at_least(CONTOUR_STEPS * mean_step_m(lattice)).map_or(0.0, |nice| nice.value());
    Some(wanted.max(told))
}

/// The mean change of heights from a post to the next one, in meters.
fn mean_step_m(lattice: &Lattice) -> f64 {
    let columns = lattice.columns() as usize;
    let rows = lattice.heights().chunks_exact(columns);
    let eastward = rows.clone().flat_map(|row| row.windows(2).map(|pair| (pair[0], pair[1])));
    let northward = rows
        .clone()
        .zip(rows.skip(1))
        .flat_map(|(south, north)| south.iter().copied().zip(north.iter().copied()));
    let steps = eastward
        .chain(northward)
        .map(|(from, to)| f64::from((to - from).abs()))
        .filter(|step| !step.is_nan());
    let (sum, count) = steps.fold((0.0, 0_u32), |(sum, count), step| (sum + step, count + 1));
    sum / f64::from(count.max(1))
}

/// The vertical exaggeration for a relief as a share of the extent: flat country shows nothing at true scale.
fn exaggeration(relief: f64) -> f64 {
    match relief {
        _ if relief > 0.05 => 1.0,
        _ if relief > 0.02 => 2.0,
        _ => 3.0,
    }
}
