//! `sandtable export`: a scene as a file that modeling programs open.

use std::path::PathBuf;
use std::slice::from_ref;

use clap::Args;

use crate::cli::error::CliError;
use crate::cli::options::SceneArguments;
use crate::cli::output::{print_lines, row};
use crate::cli::output_format::output_format;
use crate::cli::progress::StepTimer;
use crate::cli::values::number;
use crate::pipeline::export::{ExportFormat, export};
use crate::pipeline::scene_file::open_scene_true_to_scale;

#[derive(Debug, Args)]
#[command(
    after_help = "Lengths and heights are meters from the south-west post, heights without exaggeration; the file says where that\n\
                  is. In a .glb north is -Z and up is Y; in an .obj north is Y and up is Z. The materials (.mtl) and textures of\n\
                  an .obj are written beside it. Light, labels and furniture are not exported."
)]
pub struct ExportArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write the scene to this file; the extension names the format, .glb or .obj
    #[arg(short, long, value_name = "OUT.glb|.obj")]
    pub output: PathBuf,
    /// The largest error of the ground at any post, in meters; under features that lie level in it, it is exact
    #[arg(long, value_name = "METERS", default_value = "1", value_parser = number::<f64>(0.0.., "write meters as a number from 0 on"))]
    pub max_error: f64,
}

pub fn run(arguments: &ExportArguments) -> Result<(), CliError> {
    let (scene, out) = (&arguments.scene, &arguments.output);
    let written = "scenes are exported as .glb or .obj";
    let format = output_format(out, from_ref(&scene.scene), ExportFormat::from_extension, written)?;
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let scene = open_scene_true_to_scale(&scene.scene, &scene.access.allow, &progress)?;
    let exported = export(&scene, out, format, arguments.max_error, &progress)?;
    steps.finish();
    let mut lines: Vec<String> = exported.files.iter().map(|path| path.display().to_string()).collect();
    lines.extend([
        row(10, "objects", exported.list.items.len()),
        row(10, "triangles", exported.list.triangle_count()),
        row(10, "materials", exported.list.materials.len()),
    ]);
    lines.extend(scene.notes.iter().map(|note| row(10, "note", note)));
    print_lines(&lines)
}
