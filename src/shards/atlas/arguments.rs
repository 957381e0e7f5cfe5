//! The arguments of an atlas.

use std::f32::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::ShardError;
use crate::planned_dataset::PlannedWord;
use sandtable_description::document::paper_mm;
use sandtable_description::words::PaperName;
use sandtable_geom::rect::Rect;
use sandtable_render::backend_name::BackendName;
use sandtable_scene::paper_sheet::PaperSheet;
use sandtable_scene::planned_pictures::{ElevationNeed, PlannedCameras, PlannedPictures};
use sandtable_scene::scene_file::{OpenSceneError, open_scene_for};
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{ParallelView, SceneView, ViewAim};
use sandtable_sheet::picture::near_ground;
use sandtable_view::camera::INCH_M;

/// The width of a pixel of a sheet at the scale 1:`scale` on the ground, meters.
pub fn pixel_m(scale: f64, dpi: f64) -> f64 {
    INCH_M * scale / dpi
}

/// Opens the scene at `path` for sheets whose pixels are `pixel_m` meters wide: a large elevation model has as many samples as
/// they show, as in any picture of that renderer.
///
/// # Errors
/// See [`OpenSceneError`].
pub fn atlas_scene(
    path: &Path,
    allowed: &[PathBuf],
    (pixel_m, backend): (f64, BackendName),
) -> Result<SceneModel, OpenSceneError> {
    let near = near_ground(backend);
    let pictures = PlannedPictures { cameras: PlannedCameras::Plans(pixel_m), size: None, near };
    open_scene_for(path, allowed, None, ElevationNeed::Pictures(&pictures), &|_| ())
}

/// The content and the paper of each sheet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtlasArguments {
    /// The scene file, from the folder of the plan.
    pub scene: PathBuf,
    /// Folders that the scene may read besides the parent of its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allow: Vec<PathBuf>,
    /// `n` of the map scale 1:n, 1 to 1e9.
    pub scale: f64,
    /// The paper of each sheet.
    pub paper: PlannedWord<PaperName>,
    /// Whether it stands upright.
    pub portrait: bool,
    /// Pixels per inch, 10 to 10000.
    pub dpi: f64,
    /// What draws each sheet. It is not written where it is the processor.
    #[serde(default, skip_serializing_if = "PlannedWord::is_default")]
    pub backend: PlannedWord<BackendName>,
}

impl AtlasArguments {
    /// The name of an argument that is out of its range, and that range.
    pub fn fault(&self) -> Option<&'static str> {
        match self {
            _ if !(1.0..=1e9).contains(&self.scale) => Some("`scale` is not 1 to 1e9"),
            _ if !(10.0..=10_000.0).contains(&self.dpi) => Some("`dpi` is not 10 to 10000"),
            _ => None,
        }
    }

    /// Opens the scene of a plan in `folder`.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(&self, folder: &Path) -> Result<SceneModel, ShardError> {
        let allowed: Vec<PathBuf> = self.allow.iter().map(|allowed| folder.join(allowed)).collect();
        Ok(atlas_scene(&folder.join(&self.scene), &allowed, (pixel_m(self.scale, self.dpi), self.backend.0))?)
    }

    /// The paper of each sheet.
    pub fn paper(&self) -> PaperSheet {
        let [longer, shorter] = paper_mm(self.paper.0);
        let size_mm = if self.portrait { [shorter, longer] } else { [longer, shorter] };
        PaperSheet { size_mm, dpi: self.dpi }
    }

    /// The view of a sheet that shows the ground in a rectangle, world X and Y.
    pub fn view(&self, name: &str, rect: Rect) -> SceneView {
        let plan = ParallelView {
            azimuth_rad: 0.0,
            pitch_rad: FRAC_PI_2,
            stretch: 1.0,
            scale: Some(self.scale),
            dpi: self.dpi,
            shown: Some(rect),
            middle: Some(rect.center()),
        };
        let aim = ViewAim::Parallel(plan);
        SceneView { name: name.to_owned(), aim, fov_y_rad: FRAC_PI_2, paper: Some(self.paper()) }
    }
}
