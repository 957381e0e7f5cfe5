//! `sandtable export`: a scene as a file that modeling programs open.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use crate::app::arguments::{Access, meters_from_zero};
use crate::app::failure::CliError;
use crate::app::progress::StepTimer;
use crate::app::{files, load, output};
use crate::draw::list::FeatureId;
use crate::export::{SceneExport, glb, obj, prepare};
use crate::mesh::write::Remarks;
use crate::roam::criterion::flat::Flat;
use crate::roam::displayed::DisplayedTerrain;
use crate::roam::refine::rebuild::rebuild;
use crate::scene::picture;
use crate::scene::{Scene, SceneFeature, Terrain};

/// `export`.
#[derive(Debug, Args)]
#[command(
    after_help = "Lengths and heights are meters, heights without exaggeration, counted from the south-west post; the file\n\
                  says where that is. In a .glb north is -Z and up is Y; in an .obj north is Y and up is Z.\n\
                  Beside an .obj go its .mtl and its textures. Light, labels and furniture are not exported."
)]
pub struct ExportOptions {
    /// The scene file
    pub scene: PathBuf,
    /// Where the scene goes; the name says the format, .glb or .obj
    #[arg(short, long, value_name = "OUT.glb|.obj")]
    pub output: PathBuf,
    /// How far the ground may be off at any post, in meters; where something lies level in it, it is exact
    #[arg(long, value_name = "METERS", default_value = "1", value_parser = meters_from_zero)]
    pub max_error: f64,
    /// Which folders may be read.
    #[command(flatten)]
    pub access: Access,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ExportFormat {
    Glb,
    Obj,
}

/// Writes the scene and prints what is in the file.
///
/// # Errors
/// Whatever is wrong with the scene; the file's name is that of no format, or it cannot be written.
pub fn run(options: &ExportOptions) -> Result<(), CliError> {
    let format = format_of(&options.output)?;
    files::check_file_place(
        &options.output,
        &options.scene,
        "this is the scene file itself; name another with -o",
    )?;
    let steps = StepTimer::default();
    let step = |step| steps.begin(step);
    let scene = load::unstretched(&options.scene, &options.access, &step)?;
    files::check_no_input(&options.output, &scene.files)?;
    step("refining terrain");
    let displayed = Arc::new(display(&scene.terrain, options.max_error as f32));
    let (list, _) = picture::draw_list(&scene, &displayed, &step);
    step("taking out what is covered");
    let list = prepare::prepare(list);
    step("writing");
    let name_of = |feature| name_of(&scene.features, feature);
    let export = SceneExport { list: &list, name_of: &name_of, remarks: &remarks(options, &scene) };
    let written = write(&options.output, format, &export, &scene.files)?;
    steps.finish();
    let count = |name: &str, count: usize| format!("  {name:<10} {count}");
    let mut lines: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    lines.extend([
        count("objects", list.items.len()),
        count("triangles", list.triangle_count()),
        count("materials", list.materials.len()),
    ]);
    lines.extend(scene.notes.iter().map(|note| format!("  note       {note}")));
    output::print(&output::text_of(&lines))
}

fn format_of(path: &Path) -> Result<ExportFormat, CliError> {
    match path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase().as_str() {
        "glb" => Ok(ExportFormat::Glb),
        "obj" => Ok(ExportFormat::Obj),
        _ => Err(CliError::Usage(format!(
            "{}: scenes are exported as .glb or .obj; name a file that ends so",
            path.display()
        ))),
    }
}

/// The terrain with object-space errors up to `max_error_m`.
fn display(terrain: &Terrain, max_error_m: f32) -> DisplayedTerrain {
    let patches: Vec<_> = terrain.layout.patches().collect();
    let criterion = Flat::new(&terrain.layout, terrain.errors(), max_error_m);
    let active = rebuild(&terrain.layout, &criterion, patches.iter().copied());
    DisplayedTerrain::new(Arc::clone(terrain.displayed()), active, patches)
}

/// Writes all files, what others need first; returns their places, the asked one first.
fn write(
    path: &Path,
    format: ExportFormat,
    export: &SceneExport<'_>,
    inputs: &[PathBuf],
) -> Result<Vec<PathBuf>, CliError> {
    let mut written = vec![path.to_owned()];
    match format {
        ExportFormat::Glb => files::write_whole_with(path, |out| glb::write(export, out))?,
        ExportFormat::Obj => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            for companion in obj::companions(export.list, &stem) {
                let place = path.with_file_name(companion.name);
                files::check_no_input(&place, inputs)?;
                files::write_whole(&place, &companion.bytes)?;
                written.push(place);
            }
            files::write_whole_with(path, |out| obj::write(export, &stem, out))?;
        }
    }
    Ok(written)
}

fn name_of(features: &[SceneFeature], FeatureId(id): FeatureId) -> String {
    if FeatureId(id) == FeatureId::GROUND {
        return "ground".into();
    }
    let first = FeatureId::GROUND.0 + 1;
    let feature = id.checked_sub(first).and_then(|index| features.get(index as usize));
    feature.map_or_else(String::new, |SceneFeature { kind, name }| match name.as_str() {
        "" => kind.noun(1).to_owned(),
        name => format!("{} {name}", kind.noun(1)),
    })
}

fn remarks(options: &ExportOptions, scene: &Scene) -> Remarks {
    let origin = scene.terrain.lattice.origin();
    let title = scene.title.clone().unwrap_or_else(|| "a scene".into());
    let lines = [
        format!("{title}, written by sandtable"),
        "meters from the south-west post; heights are elevations".to_owned(),
        format!("origin: easting {} northing {} in {}", origin.x, origin.y, scene.crs.name()),
        format!("the ground is off by at most {} m at every post", options.max_error),
    ];
    Remarks::new(&lines, "")
}
