//! A picture of what a window shows, and the `[[camera]]` that draws it again.
//!
//! The picture is made of the scene's text with that camera added, from the beginning: it is the picture of `render` by
//! construction, not by care.

use std::path::{Path, PathBuf};

use glam::Vec3;

use crate::editor::SceneSource;
use crate::viewed_camera::ViewedCamera;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::OpenSceneError;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{ComposedView, PictureError, PictureSize, compose_view, draw_view};
use sandtable_sheet::sheet_file::{WriteSheetError, picture_description, write_sheet};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_view::camera::{Camera, ViewProjection};

/// The most pictures of views of a scene beside it.
const MOST_PICTURES: u32 = 100_000;
/// Places tried along the viewing direction for one that has ground.
const TRIED: u16 = 400;

/// A view to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewSnapshot {
    /// The scene as it is edited now, without the camera.
    pub source: SceneSource,
    /// The camera's name, and the picture's.
    pub name: String,
    /// The camera, as it is written in a scene file.
    pub camera: String,
    /// The picture's size.
    pub size: PictureSize,
}

/// Why a view cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum ViewSnapshotError {
    #[error("there is no ground where this view looks; turn until some is in the middle")]
    NoGround,
    #[error(
        "a view by parallel rays is not written as a camera with an eye; draw it with `sandtable render`"
    )]
    Parallel,
    #[error("{} already has {MOST_PICTURES} pictures beside it; move some elsewhere", .0.display())]
    TooMany(PathBuf),
    #[error("{} exists already; it is not replaced", .0.display())]
    Exists(PathBuf),
    #[error(transparent)]
    Scene(#[from] OpenSceneError),
    #[error(transparent)]
    Picture(#[from] PictureError),
    #[error(transparent)]
    Write(#[from] WriteSheetError),
    #[error(transparent)]
    File(#[from] WriteFileError),
}

/// The first name `view-N` that neither a camera of `scene` nor a picture beside `file` has.
///
/// # Errors
/// [`ViewSnapshotError::TooMany`].
pub fn free_name(scene: &SceneModel, file: &Path) -> Result<String, ViewSnapshotError> {
    let is_free = |name: &String| {
        !scene.cameras.iter().any(|view| view.name == *name) && !picture_path(file, name).exists()
    };
    let mut names = (1..=MOST_PICTURES).map(|number| format!("view-{number}"));
    names.find(is_free).ok_or_else(|| ViewSnapshotError::TooMany(file.to_owned()))
}

/// The picture `NAME.png` of a view, beside the scene.
pub fn picture_path(file: &Path, name: &str) -> PathBuf {
    file.with_file_name(format!("{}-{name}.png", disk::file_stem(file)))
}

/// A `[[camera]]` that sees what `camera` sees: within a millimeter of its eye, and through the place in the picture's
/// middle.
///
/// # Errors
/// [`ViewSnapshotError::NoGround`] and [`ViewSnapshotError::Parallel`].
pub fn camera_table(scene: &SceneModel, camera: &Camera, name: &str) -> Result<String, ViewSnapshotError> {
    let ViewedCamera { eye, eye_elevation_m, look_at, look_at_height_m, field_of_view_deg } =
        ViewedCamera::new(scene, camera)?;
    let name = toml_edit::Value::from(name);
    let system = match scene.crs.epsg() {
        Some(code) => format!("crs = \"EPSG:{code}\"\n"),
        None => String::new(),
    };
    Ok(format!(
        "[[camera]]\nname = {name}\neye = [{:?}, {:?}]\neye_elevation = {eye_elevation_m:?}\n\
         look_at = [{:?}, {:?}]\nlook_at_height = {look_at_height_m:?}\n{system}field_of_view = {field_of_view_deg:?}\n",
        eye.x, eye.y, look_at.x, look_at.y,
    ))
}

impl ViewedCamera {
    /// The scene-file values of `camera`.
    ///
    /// # Errors
    /// [`ViewSnapshotError::NoGround`] and [`ViewSnapshotError::Parallel`].
    pub fn new(scene: &SceneModel, camera: &Camera) -> Result<Self, ViewSnapshotError> {
        let ViewProjection::Perspective { tan_half_fov } = camera.projection() else {
            return Err(ViewSnapshotError::Parallel);
        };
        let target = ground_ahead(scene, camera).ok_or(ViewSnapshotError::NoGround)?;
        Ok(Self {
            eye: scene.lattice.map_point(camera.eye()),
            eye_elevation_m: scene.scale.elevation_m(f64::from(camera.eye().z)),
            look_at: scene.lattice.map_point(target.at),
            look_at_height_m: target.above_m,
            field_of_view_deg: (2.0 * libm::atan(f64::from(tan_half_fov))).to_degrees(),
        })
    }
}

/// A point on the viewing direction, above or below ground.
struct AimedPoint {
    /// In world space.
    at: Vec3,
    /// Meters above the ground below it, as drawn.
    above_m: f64,
}

/// The point of the viewing direction that is nearest to the ground below it, so that the camera looks at something.
fn ground_ahead(scene: &SceneModel, camera: &Camera) -> Option<AimedPoint> {
    let (min, max) = scene.bounds;
    let reach_m = camera.eye().distance(camera.eye().clamp(min, max)) + (max - min).length();
    let point = |step: u16| {
        let share = f32::from(step) / f32::from(TRIED);
        // Closer together near the eye.
        let at = camera.eye() + camera.forward() * (reach_m * share * share);
        let map = scene.lattice.map_point(at);
        let height_m = ground_height(&scene.lattice, Interpolation::Planar, map).height_m()?;
        let above_m = f64::from(at.z) - f64::from(scene.scale.world_z(height_m as f32));
        Some(AimedPoint { at, above_m })
    };
    // A short line of sight is no direction.
    let points = (TRIED / 10..=TRIED).filter_map(point);
    points.min_by(|a, b| a.above_m.abs().total_cmp(&b.above_m.abs()))
}

impl ViewSnapshot {
    /// Draws the picture and writes it beside the scene. `progress` is called with the name of each step as it begins.
    ///
    /// # Errors
    /// See [`ViewSnapshotError`]. A picture that is there is never replaced.
    pub fn write(&self, progress: &dyn Fn(&'static str)) -> Result<PathBuf, ViewSnapshotError> {
        let path = picture_path(&self.source.path, &self.name);
        let text = format!("{}\n\n{}", self.source.text.trim_end(), self.camera);
        let scene = SceneSource { text, ..self.source.clone() }.build(progress)?;
        let view = scene.view(Some(&self.name)).ok_or(ViewSnapshotError::NoGround)?;
        let drawn = draw_view(&scene, view, self.size, RenderBackend::Cpu, progress)?;
        let ComposedView { sheet, .. } = compose_view(&scene, drawn, progress);
        if path.exists() {
            return Err(ViewSnapshotError::Exists(path));
        }
        let description = picture_description(&scene, view);
        let mut files = OutputFiles::default();
        write_sheet(&mut files, &path, sheet, view.dpi(), (scene.title.as_deref(), &description))?;
        files.publish()?;
        Ok(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewing::open_to_view;
    use sandtable_picture as picture;
    use std::env;
    use std::fs;

    const SIZE: PictureSize = PictureSize { width: 64, height: 40 };

    fn scene() -> (SceneModel, SceneSource) {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
        (editor.source().build(&|_| ()).expect("sound"), editor.source().clone())
    }

    #[test]
    fn a_camera_that_is_written_and_read_again_sees_the_same() {
        let (scene, source) = scene();
        let (min, max) = scene.bounds;
        for (eye, toward) in [
            ((min + max) * 0.5 + Vec3::Z * 2_000.0, Vec3::new(0.3, 0.5, -0.6)),
            ((min + max) * 0.5 + Vec3::Z * 300.0, Vec3::new(-0.7, 0.1, 0.05)),
            (min + Vec3::new(-3_000.0, 500.0, 2_500.0), Vec3::new(1.0, 0.1, -0.4)),
        ] {
            let camera = Camera::new(eye, eye + toward * 100.0, 0.7, (64, 40), (0.5, 1e5)).expect("sound");
            let table = camera_table(&scene, &camera, "view-1").expect("there is ground");
            let text = format!("{}\n{table}", source.text);
            let again = SceneSource { text, ..source.clone() }.build(&|_| ()).expect("the camera is sound");
            let view = again.view(Some("view-1")).expect("it was added");
            let seen = picture::camera(&again, view, (64, 40)).expect("sound");
            assert!(seen.eye().distance(camera.eye()) < 1e-3, "{} {}", seen.eye(), camera.eye());
            assert!(
                seen.forward().distance(camera.forward()) < 1e-3,
                "{} {}",
                seen.forward(),
                camera.forward()
            );
            assert!((seen.tan_half_fov() - camera.tan_half_fov()).length() < 1e-5);
        }
    }

    #[test]
    fn a_view_of_the_sky_beside_the_ground_has_no_camera() {
        let (scene, _) = scene();
        let eye = scene.bounds.0 - Vec3::splat(5_000.0);
        let camera = Camera::new(eye, eye - Vec3::X, 0.7, (64, 40), (0.5, 1e5)).expect("sound");
        let table = camera_table(&scene, &camera, "view-1");
        assert!(matches!(table, Err(ViewSnapshotError::NoGround)));
    }

    #[test]
    fn a_picture_of_a_view_is_that_of_its_scene_and_never_replaces_another() {
        let folder = env::temp_dir().join(format!("sandtable-snapshot-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        fs::copy(concat!(env!("SANDTABLE_ROOT"), "assets/jacksboro/valley.asc"), folder.join("valley.asc"))
            .expect("copied");
        let file = folder.join("valley.asc");
        let source = open_to_view(&file, &[]).expect("readable").source().clone();
        let scene = source.build(&|_| ()).expect("sound");
        let view = picture::camera(&scene, &scene.cameras[0], (64, 40)).expect("sound");
        let mut names = Vec::new();
        for _ in 0..2 {
            let name = free_name(&scene, &file).expect("few");
            let camera = camera_table(&scene, &view, &name).expect("ground");
            let snapshot = ViewSnapshot { source: source.clone(), name, camera, size: SIZE };
            let path = snapshot.write(&|_| ()).expect("drawn");
            assert!(matches!(snapshot.write(&|_| ()), Err(ViewSnapshotError::Exists(_))));
            names.push(path.file_name().expect("named").to_string_lossy().into_owned());
        }
        let pixels = |name: &String| image::open(folder.join(name)).expect("a picture").to_rgba8();
        let is_same = pixels(&names[0]) == pixels(&names[1]);
        fs::remove_dir_all(&folder).ok();
        assert_eq!(names, ["valley-view-1.png", "valley-view-2.png"]);
        assert!(is_same, "the same view, called otherwise");
    }
}
