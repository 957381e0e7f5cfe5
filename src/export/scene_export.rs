//! Exporting a scene as a file that modeling programs open.

use std::path::{Path, PathBuf};

use crate::{SceneExport, glb, obj, prepare};
use sandtable_draw::list::DrawList;
use sandtable_files::disk::{self, WriteFileError};
use sandtable_files::output_files::OutputFiles;
use sandtable_mesh::write::remarks::Remarks;
use sandtable_picture as picture;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::stop_flag::StopFlag;

/// The largest error of exported ground in meters, where none is stated.
pub const DEFAULT_MAX_ERROR_M: f64 = 1.0;

/// A format of exported scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportFormat {
    /// Binary glTF.
    Glb,
    /// Wavefront OBJ, with its materials and textures beside it.
    Obj,
}

impl ExportFormat {
    /// The format of files with this extension, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        match extension.to_ascii_lowercase().as_str() {
            "glb" => Some(Self::Glb),
            "obj" => Some(Self::Obj),
            _ => None,
        }
    }
}

/// An exported scene.
pub struct ExportedScene {
    /// The files that were written, the requested one first.
    pub files: Vec<PathBuf>,
    /// The content.
    pub list: DrawList,
    /// The triangles that they show.
    pub triangles: usize,
    /// What the format cannot say of the content.
    pub notes: Vec<String>,
}

/// Exports a scene that was opened true to scale to `path`. The ground is off by at most `max_error_m` at every post.
/// `progress` is called with the name of each step as it begins, and `watch` says how far the longest is.
///
/// # Errors
/// A file cannot be written, or would replace one that the scene is made of.
pub fn export(
    scene: &SceneModel,
    path: &Path,
    format: ExportFormat,
    max_error_m: f64,
    progress: &dyn Fn(&'static str),
    watch: &StopFlag,
) -> Result<ExportedScene, WriteFileError> {
    disk::check_output(path, &scene.files)?;
    progress("refining terrain");
    let displayed = scene.ground().displayed_within(max_error_m as f32);
    let (list, _) = picture::draw_list(scene, &displayed, progress);
    progress("removing covered ground");
    let list = prepare::prepare(list, watch);
    progress("writing");
    let remarks = remarks(scene, max_error_m);
    let name_of = |feature| scene.feature_name(feature);
    let export = SceneExport { list: &list, name_of: &name_of, remarks: &remarks };
    let mut written = vec![path.to_owned()];
    let mut outputs = OutputFiles::default();
    match format {
        ExportFormat::Glb => outputs.write_with(path, |out| glb::write(&export, out))?,
        ExportFormat::Obj => {
            let stem = disk::file_stem(path);
            for companion in obj::companions(&list, &stem) {
                let path = path.with_file_name(companion.name);
                disk::check_output(&path, &scene.files)?;
                outputs.write(&path, &companion.bytes)?;
                written.push(path);
            }
            outputs.write_with(path, |out| obj::write(&export, &stem, out))?;
        }
    }
    let triangles = export.triangle_count();
    outputs.publish()?;
    let half_clamped = if format == ExportFormat::Obj { obj::half_clamped(&list) } else { Vec::new() };
    let note = |material: &String| {
        format!(
            "the texture of {material} ends at its borders along one axis alone, which an .obj cannot say; there it \
             repeats along both: export a .glb"
        )
    };
    let notes = half_clamped.iter().map(note).collect();
    Ok(ExportedScene { files: written, triangles, notes, list })
}

fn remarks(scene: &SceneModel, max_error_m: f64) -> Remarks {
    let origin = scene.lattice.origin();
    let title = scene.title.as_deref().unwrap_or("a scene");
    let lines = [
        format!("{title}, written by sandtable"),
        "meters from the south-west post; heights are elevations".to_owned(),
        format!("origin: easting {} northing {} in {}", origin.x, origin.y, scene.crs.name()),
        format!("the ground is off by at most {max_error_m} m at every post"),
    ];
    Remarks::new(&lines, "")
}
