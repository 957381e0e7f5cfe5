//! `sandtable new`: a first scene file of an elevation model and what vector files hold, to be changed by hand.
//!
//! ```text
//! elevation ──► ground: range of heights, extent ──┐
//! vectors ────► survey: what each layer holds ─────┴─► text ──► DIR/scene.toml ──► built once, as `check` does
//! ```
//!
//! What is written is meant to be read: a comment on every table, sizes stated even where they are the default. File
//! names are relative to the scene file, so that a folder can be moved together with its data. Nothing is copied: data
//! under the parent of DIR may be read by the scene as it is, for other data the command that is told names the folders
//! to allow.

mod paths;
mod survey;
mod text;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::annotate::nice::NiceNumber;
use crate::app::arguments::Access;
use crate::app::check::contents;
use crate::app::failure::CliError;
use crate::app::new::paths::SceneFolder;
use crate::app::new::text::{CameraDraft, GroundDraft, Vectors};
use crate::app::progress::StepTimer;
use crate::app::{files, load, output};
use crate::description::parse::parse;
use crate::scene::Scene;
use crate::scene::assets::Assets;
use crate::scene::build::build;
use crate::terrain::query::{Interpolation, ground_height};

/// What the scene file is called in its folder.
const NAME: &str = "scene.toml";

/// `new`.
#[derive(Debug, Args)]
#[command(after_help = "\
Every layer of the vector files is looked at: lines with `highway` become roads by class, with `waterway` rivers, with \
`barrier` fences and walls, with `power` power lines; polygons of water become lakes, with `building` buildings, with \
`landuse`, `natural` or `leisure` areas. A layer without such properties is taken for what its name says (roads, \
rivers, lakes, buildings), and what is left is named in a comment.

No file is written over, and none is copied.")]
pub struct NewOptions {
    /// The folder for scene.toml; it is made if it is not there
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// The elevation file; several are tiles of one raster
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    pub dem: Vec<PathBuf>,
    /// Vector files for what lies and stands on the ground
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub vectors: Vec<PathBuf>,
    /// The picture's title [default: the elevation file's name]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// The coordinate system of an elevation file that names none, for example EPSG:32616
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
}

/// Writes the scene file, builds it, and prints what is in it and how to render it.
///
/// # Errors
/// There is a scene file already; a file cannot be had or read; the folder cannot be written. Where the scene is written
/// and cannot be built, what is wrong with it.
pub fn run(options: &NewOptions) -> Result<(), CliError> {
    let steps = StepTimer::default();
    steps.begin("looking at the files");
    let scene_file = options.folder.join(NAME);
    let wrong = |reason: &str| CliError::input(format!("{}: {reason}", scene_file.display()));
    if scene_file.symlink_metadata().is_ok() {
        return Err(wrong("there is such a file already; remove it, or name another folder"));
    }
    let place = SceneFolder::new(&options.folder)?;
    let dem = options.dem.iter().map(|file| place.named(file)).collect::<Result<Vec<_>, _>>()?;
    let vectors = options.vectors.iter().map(|file| surveyed(file, &place)).collect::<Result<Vec<_>, _>>()?;
    let allow = place.to_allow(options.dem.iter().chain(&options.vectors))?;

    steps.begin("reading elevation");
    let made = !options.folder.exists();
    fs::create_dir_all(&options.folder).map_err(|error| wrong(&error.to_string()))?;
    let title = options.title.clone().unwrap_or_else(|| title_of(&options.dem[0]));
    let ground = ground(
        &scene_file,
        GroundDraft { title, dem, crs: options.crs.clone(), ..GroundDraft::default() },
        &allow,
    );
    let ground = ground.inspect_err(|_| {
        if made {
            // Only where nobody has put anything into it meanwhile.
            let _ = fs::remove_dir(&options.folder);
        }
    })?;
    files::write_whole(&scene_file, text::scene(&ground, &vectors).as_bytes())?;

    let access = Access { allow: allow.clone() };
    let scene = load::scene(&scene_file, &access, &|step| steps.begin(step));
    steps.finish();
    report(&scene_file, &allow, scene)
}

/// Prints what was made.
fn report(scene_file: &Path, allow: &[PathBuf], scene: Result<Scene, CliError>) -> Result<(), CliError> {
    let command = |verb: &str| paths::command(verb, scene_file, allow);
    let scene = scene.map_err(|failure| match failure {
        CliError::Input(reason) => CliError::Input(format!(
            "{reason}\n{} is written, but cannot be built yet; mend it and try\n  {}",
            scene_file.display(),
            command("check")
        )),
        other => other,
    })?;
    let mut lines = vec![scene_file.display().to_string()];
    lines.extend(contents(&scene));
    lines.push("to render it:".into());
    lines.push(format!("  {}", command("render")));
    output::print(&output::text_of(&lines))
}

/// What a vector file holds.
fn surveyed(file: &Path, place: &SceneFolder) -> Result<Vectors, CliError> {
    Ok(Vectors { file: place.named(file)?, layers: survey::layers(file)? })
}

/// The same with what the elevation tells: heights, extent, and a camera that sees all of it.
fn ground(scene_file: &Path, mut ground: GroundDraft, allow: &[PathBuf]) -> Result<GroundDraft, CliError> {
    let assets = Assets::new(scene_file, allow).map_err(CliError::input)?;
    let built = |ground: &GroundDraft| {
        let document =
            parse(&scene_file.to_string_lossy(), &text::terrain(ground)).map_err(CliError::input)?;
        build(&document, &assets, &|_| ()).map_err(CliError::input)
    };
    let plain = built(&ground)?;
    let lattice = &plain.terrain.lattice;
    let (low, high) = lattice.height_range();
    ground.size_m = lattice.extent().size().max_element();
    ground.relief_m = f64::from(high - low);
    ground.crs_name = plain.crs.name().to_owned();
    ground.exaggeration = exaggeration(ground.relief_m / ground.size_m);
    ground.contours_m = NiceNumber::at_most(ground.relief_m / CONTOURS).map(|nice| nice.value());
    let scene = if ground.exaggeration == 1.0 { plain } else { built(&ground)? };
    ground.camera = camera(&scene);
    Ok(ground)
}

/// About as many contour lines as one can follow with the eye.
const CONTOURS: f64 = 12.0;

/// How many times heights are stretched, by the relief as a part of the extent: flat country shows nothing unstretched.
fn exaggeration(relief: f64) -> f64 {
    match relief {
        _ if relief > 0.05 => 1.0,
        _ if relief > 0.02 => 2.0,
        _ => 3.0,
    }
}

/// The camera that a scene without any has, as a table says it; `None` where there is no ground in the middle to look at.
fn camera(scene: &Scene) -> Option<CameraDraft> {
    let view = scene.cameras.first()?;
    let lattice = &scene.terrain.lattice;
    let exaggeration = f64::from(scene.terrain.exaggeration);
    let at = |world: glam::Vec3| lattice.origin() + world.truncate().as_dvec2();
    let look_at = at(view.target);
    let ground_m = ground_height(lattice, Interpolation::Planar, look_at).height_m()?;
    Some(CameraDraft {
        name: view.name.clone(),
        eye: at(view.eye),
        eye_elevation_m: f64::from(view.eye.z) / exaggeration,
        look_at,
        look_at_height_m: f64::from(view.target.z) - ground_m * exaggeration,
        field_of_view_deg: f64::from(view.fov_y_rad.to_degrees()),
    })
}

/// A title out of a file's name.
fn title_of(file: &Path) -> String {
    let stem = file.file_stem().map(|stem| stem.to_string_lossy().replace(['_', '-'], " "));
    stem.filter(|stem| !stem.trim().is_empty()).unwrap_or_else(|| "A scene".into())
}
