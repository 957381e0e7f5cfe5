//! Files of a scene: pictures, models and pages.

use std::path::Path;

use crate::api::error::Error;
use crate::api::scene::{Scene, View};
use sandtable_export::scene_export::{DEFAULT_MAX_ERROR_M, ExportFormat, export};
use sandtable_export::scene_page::page_bytes;
use sandtable_files::disk;
use sandtable_files::output_files::OutputFiles;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::build_exaggerated;
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_sheet::picture::{compose_view, draw_view_counted};
use sandtable_sheet::sheet_file::{picture_description, write_sheet};
use sandtable_sheet::step_watch::StepWatch;

impl Scene {
    /// Writes a file in the format of its extension: a picture of `view` as `.png`, or with letters and lines as vectors as
    /// `.pdf` or `.svg`; the scene as a model, true to scale, as `.glb` or `.obj`, or as a page for browsers as `.html`. The bytes
    /// are those of `sandtable render` and `sandtable export`. No file that the scene is made of is written over.
    ///
    /// # Errors
    /// [`Error::NoSceneFormat`] of another extension; [`Error::Picture`], [`Error::WriteSheet`], [`Error::ExportPage`];
    /// [`Error::WriteFile`] where the system refuses; [`Error::OpenScene`] where the scene cannot be opened again.
    pub fn save(&self, view: &View, path: impl AsRef<Path>) -> Result<(), Error> {
        self.save_watched(view, path, &StepWatch::default())
    }

    /// [`Self::save`], which says how far it is.
    ///
    /// # Errors
    /// As [`Self::save`].
    pub fn save_watched(&self, view: &View, path: impl AsRef<Path>, watch: &StepWatch) -> Result<(), Error> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match (extension.as_str(), ExportFormat::from_extension(&extension)) {
            ("png" | "pdf" | "svg", _) => self.save_picture(view, path, watch),
            (_, Some(format)) => self.save_model(path, format, watch),
            ("html", None) => {
                disk::check_output(path, &self.model.files)?;
                Ok(disk::write(path, &self.page_watched(watch)?)?)
            }
            _ => Err(Error::NoSceneFormat(path.to_owned())),
        }
    }

    /// The scene as a page for browsers, which needs no network: the bytes that [`Self::save`] writes.
    ///
    /// # Errors
    /// [`Error::ExportPage`].
    pub fn page(&self) -> Result<Vec<u8>, Error> {
        self.page_watched(&StepWatch::default())
    }

    /// [`Self::page`], which says how far it is.
    ///
    /// # Errors
    /// As [`Self::page`].
    pub fn page_watched(&self, watch: &StepWatch) -> Result<Vec<u8>, Error> {
        Ok(page_bytes(&self.model, None, &|step| watch.begin(step), watch.counted())?.0)
    }

    fn save_picture(&self, View { view, size }: &View, path: &Path, watch: &StepWatch) -> Result<(), Error> {
        let scene = &self.model;
        disk::check_output(path, &scene.files)?;
        let progress = |step| watch.begin(step);
        let drawn = draw_view_counted(scene, view, *size, RenderBackend::Cpu, &progress, watch.drawn())?;
        let sheet = compose_view(scene, drawn, &progress).sheet;
        let (mut outputs, description) = (OutputFiles::default(), picture_description(scene, view));
        write_sheet(&mut outputs, path, sheet, view.dpi(), (scene.title.as_deref(), &description))?;
        Ok(outputs.publish()?)
    }

    fn save_model(&self, path: &Path, format: ExportFormat, watch: &StepWatch) -> Result<(), Error> {
        let opened;
        let scene = match self.model.scale {
            VerticalScale(1.0) => &self.model,
            _ => {
                opened = build_exaggerated(&self.origin, 1.0, &|step| watch.begin(step))?;
                &opened
            }
        };
        export(scene, path, format, DEFAULT_MAX_ERROR_M, &|step| watch.begin(step), watch.counted())?;
        Ok(())
    }
}
