//! Files of a scene: pictures, models and pages.

use std::path::Path;

use crate::api::error::Error;
use crate::api::scene::{Scene, View};
use sandtable_export::scene_export::{DEFAULT_MAX_ERROR_M, ExportFormat, export};
use sandtable_export::scene_page::page_bytes;
use sandtable_files::disk;
use sandtable_files::output_files::OutputFiles;
use sandtable_render::RenderBackend;
use sandtable_scene::scene_file::{build_exaggerated, build_scene};
use sandtable_scene::vertical_scale::VerticalScale;
use sandtable_sheet::picture::{compose_view, draw_view};
use sandtable_sheet::sheet_file::{picture_description, write_sheet};

impl Scene {
    /// Writes a file in the format of its extension: a picture of `view` as `.png`, or with letters and lines as vectors as
    /// `.pdf` or `.svg`; the scene as a model, true to scale, as `.glb` or `.obj`, or as a page for browsers as `.html`. The bytes
    /// are those of `sandtable render` and `sandtable export`. No file that the scene is made of is written over.
    ///
    /// # Errors
    /// [`Error::NoSceneFormat`] of another extension; [`Error::Picture`], [`Error::WriteSheet`], [`Error::ExportPage`];
    /// [`Error::WriteFile`] where the system refuses; [`Error::OpenScene`] where the scene cannot be opened again.
    pub fn save(&self, view: &View, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match (extension.as_str(), ExportFormat::from_extension(&extension)) {
            ("png" | "pdf" | "svg", _) => self.save_picture(view, path),
            (_, Some(format)) => self.save_model(path, format),
            ("html", None) => {
                disk::check_output(path, &self.model.files)?;
                Ok(disk::write(path, &self.page()?)?)
            }
            _ => Err(Error::NoSceneFormat(path.to_owned())),
        }
    }

    /// The scene as a page for browsers, which needs no network: the bytes that [`Self::save`] writes.
    ///
    /// # Errors
    /// [`Error::ExportPage`]; [`Error::OpenScene`] where the scene cannot be opened again.
    pub fn page(&self) -> Result<Vec<u8>, Error> {
        // Its light is that of the first view.
        let mut scene = build_scene(&self.origin, &|_| ())?;
        Ok(page_bytes(&mut scene, None, &|_| ())?.0)
    }

    fn save_picture(&self, View { view, size }: &View, path: &Path) -> Result<(), Error> {
        let scene = &self.model;
        disk::check_output(path, &scene.files)?;
        let drawn = draw_view(scene, view, *size, RenderBackend::Cpu, &|_| ())?;
        let sheet = compose_view(scene, drawn, &|_| ()).sheet;
        let (mut outputs, description) = (OutputFiles::default(), picture_description(scene, view));
        write_sheet(&mut outputs, path, sheet, view.dpi(), (scene.title.as_deref(), &description))?;
        Ok(outputs.publish()?)
    }

    fn save_model(&self, path: &Path, format: ExportFormat) -> Result<(), Error> {
        let opened;
        let scene = match self.model.scale {
            VerticalScale(1.0) => &self.model,
            _ => {
                opened = build_exaggerated(&self.origin, 1.0, &|_| ())?;
                &opened
            }
        };
        export(scene, path, format, DEFAULT_MAX_ERROR_M, &|_| ())?;
        Ok(())
    }
}
