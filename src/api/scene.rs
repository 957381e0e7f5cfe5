//! Scenes, their views and pictures.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::api::error::Error;
use sandtable_description::finding::Finding;
use sandtable_draw::pixels::Pixels;
use sandtable_files::disk;
use sandtable_lint::opened::open_linted;
use sandtable_render::RenderBackend;
use sandtable_scene as scene;
use sandtable_scene::scene_file::open_scene;
use sandtable_sheet::picture::{PictureSize, render_view};
use sandtable_terrain::query::service::HeightService;

/// A digital terrain model: the ground, the features on it and the views of it that its file describes.
pub struct Scene {
    pub(crate) model: scene::scene_model::SceneModel,
    /// Where it was opened, and the folders that it may read.
    pub(crate) path: PathBuf,
    pub(crate) allowed: Vec<PathBuf>,
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
    view: scene::scene_view::SceneView,
    size: PictureSize,
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
        let model = open_scene(path.as_ref(), options.allowed, options.progress)?;
        Ok(Self::of(model, path.as_ref(), options))
    }

    /// [`Scene::open_with`], and the findings of the command `check` about the scene.
    ///
    /// # Errors
    /// [`Error::OpenScene`].
    pub fn open_checked(
        path: impl AsRef<Path>,
        options: &SceneOptions<'_>,
    ) -> Result<(Self, Vec<Finding>), Error> {
        let (model, findings) = open_linted(path.as_ref(), options.allowed, options.progress)?;
        Ok((Self::of(model, path.as_ref(), options), findings))
    }

    fn of(model: scene::scene_model::SceneModel, path: &Path, options: &SceneOptions<'_>) -> Self {
        Self {
            model,
            path: path.to_owned(),
            allowed: options.allowed.to_vec(),
            true_to_scale: OnceLock::new(),
        }
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
        let rendered = render_view(&self.model, &view.view, view.size, RenderBackend::Cpu, &|_| ())?;
        Ok(Picture { pixels: rendered.pixels })
    }
}

impl View {
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
