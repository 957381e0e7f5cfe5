//! Scenes, their views and pictures.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::api::error::Error;
use crate::api::scene_data::SceneData;
use sandtable_description::finding::Finding;
use sandtable_draw::pixels::Pixels;
use sandtable_files::disk;
use sandtable_files::png::encode_png;
use sandtable_lint::opened::build_linted;
use sandtable_render::RenderBackend;
use sandtable_scene as scene;
use sandtable_scene::scene_file::build_scene;
use sandtable_scene::scene_origin::SceneOrigin;
use sandtable_sheet::picture::{PictureSize, annotate_view, draw_view_counted};
use sandtable_sheet::step_watch::StepWatch;
use sandtable_terrain::query::service::HeightService;

/// A digital terrain model: the ground, the features on it and the views of it that its file describes.
pub struct Scene {
    pub(crate) model: scene::scene_model::SceneModel,
    /// What it was opened of.
    pub(crate) origin: SceneOrigin,
    /// The scene true to scale, where an analysis has needed it and its heights are exaggerated.
    pub(crate) true_to_scale: OnceLock<Box<scene::scene_model::SceneModel>>,
}

/// The options for opening a scene.
///
/// The steps of opening one:
///
/// ```
/// use sandtable::{Scene, SceneOptions};
/// let steps = std::cell::RefCell::new(Vec::new());
/// let progress = |step| steps.borrow_mut().push(step);
/// Scene::open_with("scenes/road.toml", &SceneOptions { progress: &progress, ..Default::default() })?;
/// assert_eq!(steps.borrow().first(), Some(&"reading the scene file"));
/// # Ok::<(), sandtable::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct SceneOptions<'a> {
    /// Folders that the scene may read besides the parent of its own. Default none.
    pub allowed: &'a [PathBuf],
    /// Called with the name of each step as it begins. Default: nothing.
    pub progress: &'a dyn Fn(&'static str),
}

impl Default for SceneOptions<'_> {
    fn default() -> Self {
        Self { allowed: &[], progress: &|_| () }
    }
}

/// The view of a scene and the size of its picture.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    pub(in crate::api) view: scene::scene_view::SceneView,
    pub(in crate::api) size: PictureSize,
}

/// An annotated picture.
pub struct Picture {
    pixels: Pixels,
}

impl Scene {
    /// Opens a scene file and the files that it names under the parent of its folder.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::open_with(path, &SceneOptions::default())
    }

    /// [`Scene::open`] with options.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    pub fn open_with(path: impl AsRef<Path>, options: &SceneOptions<'_>) -> Result<Self, Error> {
        Self::of(SceneOrigin::file(path.as_ref(), options.allowed), options)
    }

    /// The scene of a text that is in no file. Messages show `path`, and names of files are relative to its folder, as if the
    /// text were there; what `data` has is not read. The text is that of a scene file.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    ///
    /// ```
    /// use sandtable::{Dem, Samples, Scene, SceneData, SceneOptions};
    /// let samples = Samples::F32((0..100).map(|sample| f32::from(sample % 10_i8)).collect());
    /// let dem = Dem::from_samples(10, samples, [500.0, 10.0, 0.0, 900.0, 0.0, -10.0], None)?;
    /// let mut data = SceneData::default();
    /// data.add_dem("memory:hill", &dem);
    /// let text = "[terrain]\ndem = \"memory:hill\"\n";
    /// let scene = Scene::from_text("hill.toml", text, &data, &SceneOptions::default())?;
    /// assert_eq!(scene.view_names().count(), 1);
    /// # Ok::<(), sandtable::Error>(())
    /// ```
    pub fn from_text(
        path: impl AsRef<Path>,
        text: &str,
        data: &SceneData,
        options: &SceneOptions<'_>,
    ) -> Result<Self, Error> {
        let origin = SceneOrigin::text(path.as_ref(), text, options.allowed);
        Self::of(SceneOrigin { given: data.given.clone(), ..origin }, options)
    }

    /// [`Scene::open_with`], and the findings of the command `check` about the scene.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    pub fn open_checked(
        path: impl AsRef<Path>,
        options: &SceneOptions<'_>,
    ) -> Result<(Self, Vec<Finding>), Error> {
        let origin = SceneOrigin::file(path.as_ref(), options.allowed);
        let (model, findings) = build_linted(&origin, options.progress)?;
        Ok((Self { model, origin, true_to_scale: OnceLock::new() }, findings))
    }

    fn of(origin: SceneOrigin, options: &SceneOptions<'_>) -> Result<Self, Error> {
        let model = build_scene(&origin, options.progress)?;
        Ok(Self { model, origin, true_to_scale: OnceLock::new() })
    }

    /// Reads the scene again and checks it, as the command `check` does.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    pub fn check(&self) -> Result<Vec<Finding>, Error> {
        Ok(build_linted(&self.origin, &|_| ())?.1)
    }

    /// What was found while it was built, in order of the building: fewer than [`Self::check`] finds.
    pub fn findings(&self) -> &[Finding] {
        &self.model.findings
    }

    /// Notes for the user about the build: features off the model, missing textures, earth moved.
    pub fn notes(&self) -> Vec<&str> {
        self.model.notes()
    }

    /// The names of the views; the first is the default.
    pub fn view_names(&self) -> impl Iterator<Item = &str> {
        self.model.cameras.iter().map(|view| view.name.as_str())
    }

    /// The view called `name`, as large as its paper, or 1920 by 1080 pixels; a parallel view without a stated scale has as
    /// many pixels, in the aspect ratio of the ground that it shows.
    ///
    /// # Errors
    /// [`Error::NoView`].
    pub fn view(&self, name: &str) -> Result<View, Error> {
        let no_view = || Error::NoView(name.to_owned(), self.view_names().collect::<Vec<_>>().join(", "));
        let view = self.model.view(Some(name)).ok_or_else(no_view)?.clone();
        let size = PictureSize::of(&self.model, &view);
        Ok(View { view, size })
    }

    /// Answers heights of the ground and the decks over it, in map coordinates.
    pub fn heights(&self) -> &HeightService {
        &self.model.heights
    }

    /// Renders a view and paints its annotations. The same scene gives the same bytes on every machine.
    ///
    /// # Errors
    /// [`Error::Picture`].
    pub fn render(&self, view: &View) -> Result<Picture, Error> {
        self.render_watched(view, &StepWatch::default())
    }

    /// [`Self::render`], which says how far it is.
    ///
    /// # Errors
    /// [`Error::Picture`].
    ///
    /// ```
    /// use sandtable::{Scene, StepWatch};
    /// let (scene, watch) = (Scene::open("scenes/road.toml")?, StepWatch::default());
    /// // Another thread reads `watch.step()` and `watch.share()` meanwhile.
    /// scene.render_watched(&scene.view("front")?.with_size(64, 36), &watch)?;
    /// assert_eq!(watch.step(), "annotating");
    /// # Ok::<(), sandtable::Error>(())
    /// ```
    pub fn render_watched(&self, view: &View, watch: &StepWatch) -> Result<Picture, Error> {
        let (model, progress) = (&self.model, |step| watch.begin(step));
        let drawn =
            draw_view_counted(model, &view.view, view.size, RenderBackend::Cpu, &progress, watch.drawn())?;
        Ok(Picture { pixels: annotate_view(model, drawn, &progress).pixels })
    }
}

impl View {
    /// Pixels across and down of its picture.
    pub fn size(&self) -> (u32, u32) {
        (self.size.width, self.size.height)
    }

    /// This view on a picture of another size, 16 to 16384 pixels each side.
    pub fn with_size(self, width: u32, height: u32) -> Self {
        Self { size: PictureSize { width, height }, ..self }
    }
}

impl Picture {
    pub(crate) fn new(pixels: Pixels) -> Self {
        Self { pixels }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.pixels.width(), self.pixels.height())
    }

    /// The pixels row by row from the top, red, green, blue and alpha each.
    pub fn rgba(&self) -> &[u8] {
        self.pixels.bytes()
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Vec<u8> {
        encode_png(&self.pixels)
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    /// [`Error::WriteFile`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        disk::check_picture_output::<&Path>(path, &[])?;
        Ok(disk::write_picture(path, &self.pixels)?)
    }
}
