//! The files of a folder that a first scene can use, by their names.
//!
//! The look is bounded: at most [`MOST_NAMES`] names of the folder itself are read, no file but the start of those that
//! may be scenes is opened, and of subfolders only `scene.toml` is looked for, which `new` and `demo` write there.

use std::fs;
use std::path::{Path, PathBuf};

use sandtable_dem::read::is_tile_name;
use sandtable_files::disk;

/// More names than a screen shows by far, and few enough that the look takes no time on a slow disk.
pub const MOST_NAMES: usize = 2000;

/// The most files that are opened to see whether they are scenes.
const MOST_OPENED: usize = 50;

/// The name of a scene file in a folder of its own.
pub const SCENE_NAME: &str = "scene.toml";

/// A scene names its terrain near its start; a comment before it is shorter than this.
const HEAD_BYTES: u64 = 64 << 10;

/// Extensions of vector files that are not those of other data as a rule.
const VECTOR_EXTENSIONS: [&str; 12] =
    ["geojson", "geojsonl", "fgb", "shp", "gpkg", "kml", "kmz", "gpx", "dxf", "osm", "pbf", "cityjson"];

/// What a file is, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoundKind {
    /// A file of elevation.
    Elevation,
    /// A file of lines, polygons or points, or a raster of land cover.
    Vector,
}

/// The files of a folder that are of use, sorted by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FoundFiles {
    /// Scene files, also those of subfolders.
    pub scenes: Vec<PathBuf>,
    /// Files of elevation.
    pub elevation: Vec<PathBuf>,
    /// Vector files and rasters of land cover.
    pub vectors: Vec<PathBuf>,
    /// Whether the folder has more names than were read.
    pub has_more: bool,
}

/// What the file called `name` is; `None` where the name says neither.
pub fn kind_of_name(name: &Path) -> Option<FoundKind> {
    let extension = name.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let is_vector = VECTOR_EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(extension));
    if is_vector || is_land_cover_name(name) {
        return Some(FoundKind::Vector);
    }
    is_tile_name(&disk::file_name(name)).then_some(FoundKind::Elevation)
}

/// Whether a TIFF is called as the rasters of ESA WorldCover and CORINE are: `ESA_WorldCover_10m_2021_v200_N42E006_Map.tif`,
/// `U2018_CLC2018_V2020_20u1.tif`.
fn is_land_cover_name(name: &Path) -> bool {
    let name = disk::file_name(name).to_ascii_lowercase();
    let is_tiff = name.ends_with(".tif") || name.ends_with(".tiff");
    let has_year = |(_, after): (&str, &str)| after.starts_with(|letter: char| letter.is_ascii_digit());
    is_tiff
        && (["worldcover", "corine"].iter().any(|product| name.contains(product))
            || name.split_once("clc").is_some_and(has_year))
}

/// The files of `folder` that are of use; none where it cannot be read.
///
/// The paths are names alone where `folder` is empty, which is the current folder.
pub fn found_in(folder: &Path) -> FoundFiles {
    let place = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = fs::read_dir(place) else { return FoundFiles::default() };
    let mut names: Vec<_> =
        entries.filter_map(|entry| Some(entry.ok()?.file_name())).take(MOST_NAMES + 1).collect();
    let has_more = names.len() > MOST_NAMES;
    names.truncate(MOST_NAMES);
    names.sort();
    let mut found = FoundFiles { has_more, ..FoundFiles::default() };
    let mut opened = 0;
    for name in names.iter().filter(|name| !name.to_string_lossy().starts_with('.')) {
        let path = folder.join(name);
        let is_toml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        match kind_of_name(&path) {
            Some(FoundKind::Vector) => found.vectors.push(path),
            Some(FoundKind::Elevation) => found.elevation.push(path),
            None if is_toml && opened < MOST_OPENED => {
                opened += 1;
                if has_terrain(&path) {
                    found.scenes.push(path);
                }
            }
            None if !is_toml && opened < MOST_OPENED && path.is_dir() => {
                opened += 1;
                let own = path.join(SCENE_NAME);
                if own.is_file() && has_terrain(&own) {
                    found.scenes.push(own);
                }
            }
            None => {}
        }
    }
    found
}

/// Whether a TOML file begins as a scene does: with a table of terrain.
fn has_terrain(path: &Path) -> bool {
    let head = disk::read_head(path, HEAD_BYTES).unwrap_or_default();
    String::from_utf8_lossy(&head).lines().any(|line| line.trim_start().starts_with("[terrain]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rasters_of_land_cover_are_no_elevation_by_their_names() {
        for name in
            ["ESA_WorldCover_10m_2021_v200_N42E006_Map.tif", "a/U2018_CLC2018_V2020_20u1.tif", "corine.TIFF"]
        {
            assert_eq!(kind_of_name(Path::new(name)), Some(FoundKind::Vector), "{name}");
        }
        for name in ["dem.tif", "clc/dem.tif", "cyclcross.tif"] {
            assert_eq!(kind_of_name(Path::new(name)), Some(FoundKind::Elevation), "{name}");
        }
        assert_eq!(kind_of_name(Path::new("worldcover.png")), None);
    }

    #[test]
    fn scenes_elevation_and_vectors_are_told_apart() {
        let root = Path::new(env!("SANDTABLE_ROOT"));
        let scenes = found_in(&root.join("scenes"));
        assert!(scenes.scenes.contains(&root.join("scenes/road.toml")), "{scenes:?}");
        assert!(scenes.elevation.is_empty() && scenes.vectors.is_empty() && !scenes.has_more, "{scenes:?}");
        let data = found_in(&root.join("assets/jacksboro"));
        assert!(data.elevation.contains(&root.join("assets/jacksboro/dem.tif")), "{data:?}");
        assert!(data.vectors.contains(&root.join("assets/jacksboro/roads.geojson")), "{data:?}");
        assert!(data.scenes.is_empty(), "{data:?}");
        // Those that have a folder of their own.
        let books = found_in(&root.join("src/book"));
        assert_eq!(books.scenes, Vec::<PathBuf>::new(), "{books:?}");
        // Manifests are TOML as well.
        assert_eq!(found_in(root).scenes, Vec::<PathBuf>::new());
        assert_eq!(found_in(&root.join("nowhere")), FoundFiles::default());
    }
}
