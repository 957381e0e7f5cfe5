//! A picture of `sandtable render` before it is written: made beside others where the processor draws.

use std::path::Path;

use crate::progress::StepTimer;
use crate::render::RenderArguments;
use sandtable_render::RenderBackend;
use sandtable_render::drawn_rows::DrawnRows;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_sheet::picture::{
    ComposedView, DrawnView, PictureError, PictureSize, bytes_of_making, compose_view, draw_view_counted,
};
use sandtable_sheet::picture_statistics::PictureStatistics;
use sandtable_sheet::sidecar::SidecarDraft;

/// Makes the pictures of a scene.
pub struct PictureMaker<'a> {
    pub arguments: &'a RenderArguments,
    pub backend: RenderBackend,
    pub scene: &'a SceneModel,
    /// The scene file.
    pub file: &'a Path,
    /// The scene's, where sidecars state it.
    pub fingerprint: Option<&'a str>,
    pub steps: &'a StepTimer,
}

/// A picture that is made.
pub enum MadePicture {
    /// Without annotations: its buffers are written, or an adapter draws, which draws one after the other.
    Drawn(Box<DrawnView>),
    Composed(Box<ComposedPicture>),
}

/// A picture whose annotations are laid out.
pub struct ComposedPicture {
    pub view: ComposedView,
    /// The sidecar, where one is written.
    pub draft: Option<SidecarDraft>,
    /// Measured where JSON is printed.
    pub statistics: Option<PictureStatistics>,
}

impl PictureMaker<'_> {
    /// The picture of a view, number `index` of those of the scene, in its own size or in that of a picture on a sheet.
    pub fn made(
        &self,
        (index, view): (usize, &SceneView),
        small: Option<[u32; 2]>,
        progress: &dyn Fn(&'static str),
    ) -> Result<MadePicture, PictureError> {
        let Self { arguments, scene, .. } = *self;
        if let (ViewAim::Panorama(_), Some(_)) = (view.aim, &arguments.buffers) {
            return Err(PictureError::PanoramaPixels);
        }
        let own_size = || arguments.size.unwrap_or_else(|| PictureSize::of(scene, view));
        let size = small.map_or_else(own_size, |[width, height]| PictureSize { width, height });
        // Of pictures that are drawn at once rows are not counted.
        let uncounted = DrawnRows::default();
        let rows = if index == 0 { self.steps.step_watch().drawn() } else { &uncounted };
        let drawn = draw_view_counted(scene, view, size, self.backend, progress, rows)?;
        let is_alone = arguments.buffers.is_some() || matches!(self.backend, RenderBackend::Gpu(_));
        Ok(match is_alone {
            true => MadePicture::Drawn(Box::new(drawn)),
            false => MadePicture::Composed(self.composed(view, drawn, progress)),
        })
    }

    /// A picture that is drawn, with its annotations laid out.
    pub fn composed(
        &self,
        view: &SceneView,
        drawn: DrawnView,
        progress: &dyn Fn(&'static str),
    ) -> Box<ComposedPicture> {
        let statistics = self.arguments.json.then(|| PictureStatistics::new(&drawn.picture));
        let draft = self.fingerprint.map(|fingerprint| {
            progress("describing the picture");
            SidecarDraft::new(self.scene, (self.file, fingerprint), view, &drawn)
        });
        Box::new(ComposedPicture { view: compose_view(self.scene, drawn, progress), draft, statistics })
    }
}

impl MadePicture {
    /// About how much memory making it has taken, in bytes; more than there is where it is made alone.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Drawn(_) => u64::MAX,
            Self::Composed(picture) => bytes_of_making(&picture.view.drawn, &picture.view.sheet.pixels),
        }
    }
}
