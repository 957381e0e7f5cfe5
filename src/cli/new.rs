//! `sandtable new`: a first scene file of an elevation model and vector files.

use std::path::{Path, PathBuf};

use clap::Args;

use crate::check::contents;
use crate::error::CliError;
use crate::output::print_summary;
use crate::progress::StepTimer;
use sandtable_new::{self as new_scene, NewSceneOptions, WrittenScene};
use sandtable_remote::access::RemoteAccess;
use sandtable_remote::address::{AllowedHost, is_address_path};
use sandtable_scene::planned_pictures::{ElevationNeed, PlannedPictures};
use sandtable_scene::scene_file::open_scene_for;

#[derive(Debug, Args)]
#[command(after_help = "\
Every layer of the vector files is surveyed: lines with `highway` become roads by class, with `waterway` rivers, with \
`barrier` fences and walls, with `power` power lines; polygons of water become lakes, with `building` buildings, with \
`landuse`, `natural` or `leisure` areas. A layer without such properties is classified by its name (roads, rivers, \
lakes, buildings). The schemas of Geofabrik, BGT, TIGER/Line, Ordnance Survey and BD TOPO are known as well. Cities, \
towns, villages and peaks with names become labels, the most important first. A layer of no known schema is drawn by its \
shapes, its named points as labels, and is named in the legend; what is left of other layers is named in a comment, with \
its properties.

No file is overwritten, and none is copied.")]
pub struct NewArguments {
    /// The folder for scene.toml; it is made if it does not exist
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// The elevation file, or its address; several are tiles of one raster
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    pub dem: Vec<PathBuf>,
    /// Vector files for the features on the ground and rasters of land cover (ESA WorldCover, CORINE), or their addresses
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub vectors: Vec<PathBuf>,
    /// Files of units and graphics, or their addresses: ORBAT Mapper, MSDL, NVG, MilX, Cursor on Target, KML, tables; those of
    /// several moments become phases
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub overlay: Vec<PathBuf>,
    /// The picture's title [default: the place's name from the vectors, else the position of its middle]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// The coordinate system of an elevation file that names none, for example EPSG:32616
    #[arg(long, value_name = "CRS")]
    pub crs: Option<String>,
}

/// Writes the scene file, builds the scene, and prints its contents and the command that renders it.
pub fn run(arguments: &NewArguments) -> Result<(), CliError> {
    let steps = StepTimer::default();
    let progress = |step| steps.begin(step);
    let options = NewSceneOptions {
        folder: arguments.folder.clone(),
        dem: arguments.dem.clone(),
        vectors: arguments.vectors.clone(),
        overlays: arguments.overlay.clone(),
        title: arguments.title.clone(),
        crs: arguments.crs.clone(),
    };
    let WrittenScene { path, allowed } = new_scene::write(&options, &progress)?;
    // It is rendered next, by its first camera.
    let pictures = PlannedPictures::default();
    let scene = open_scene_for(&path, &allowed, None, ElevationNeed::Pictures(&pictures), &progress);
    steps.finish();
    let hosts = match arguments
        .dem
        .iter()
        .chain(&arguments.vectors)
        .chain(&arguments.overlay)
        .any(|file| is_address_path(file))
    {
        true => RemoteAccess::of_run().hosts,
        false => Vec::new(),
    };
    let command = |verb: &str| command(verb, &path, &allowed, &hosts);
    let scene = scene.map_err(|error| {
        let (path, check) = (path.display(), command("check"));
        let hint = format!("{path} is written, but cannot be built yet; correct it and try\n  {check}");
        CliError::Input { error: error.into(), hint: Some(hint) }
    })?;
    let mut lines = vec![path.display().to_string()];
    lines.extend(contents(&scene));
    lines.extend(["to render it:".into(), format!("  {}", command("render"))]);
    print_summary(&lines)
}

/// A command on the scene, as a shell reads it.
fn command(verb: &str, scene: &Path, allowed: &[PathBuf], hosts: &[AllowedHost]) -> String {
    let allow = allowed.iter().map(|folder| format!(" --allow {}", shell(folder)));
    let hosts = hosts.iter().map(|host| format!(" --allow-remote {}", shell(Path::new(host.name()))));
    format!("sandtable {verb} {}{}", shell(scene), allow.chain(hosts).collect::<String>())
}

/// A path as a shell reads it.
pub fn shell(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+,:@%".contains(letter);
    if !text.is_empty() && text.chars().all(is_plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_a_space_or_a_quote_is_one_word_of_the_shell() {
        assert_eq!(shell(Path::new("a/b-1.toml")), "a/b-1.toml");
        assert_eq!(shell(Path::new("a b's")), "'a b'\\''s'");
    }
}
