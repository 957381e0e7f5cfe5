//! The title of a new scene: the name of its place.

use std::path::Path;

use glam::DVec2;

use crate::rules::LEAST_TITLE_RANK;
use crate::survey::NamedDistrict;
use crate::text::VectorDraft;
use sandtable_base::message::capitalized::capitalized;
use sandtable_files::disk;
use sandtable_geom::polygon;
use sandtable_scene::scene_model::SceneModel;

/// Words of file names that are written in capitals.
const ABBREVIATIONS: [&str; 8] = ["dem", "dtm", "dsm", "srtm", "ned", "utm", "usgs", "nasadem"];

/// The title that vectors give: the most important city, town or village on the ground, of several the nearest to its
/// middle, else the smallest district that
/// covers all of it, else the most important place of any kind; `None` where they name nothing of this.
pub(super) fn of_vectors(vectors: &[VectorDraft], scene: &SceneModel) -> Option<String> {
    let ground = scene.lattice.map_extent();
    let layers = || vectors.iter().flat_map(|vector| &vector.layers);
    let places = layers().flat_map(|layer| {
        layer.places.iter().filter_map(|place| {
            let at = layer.crs.transform(&scene.crs, place.at).ok().filter(|at| ground.contains(*at))?;
            Some((place, at.distance(ground.center())))
        })
    });
    // Of equals the one nearest to the middle.
    let place = places.min_by(|(a, a_m), (b, b_m)| a.rank.total_cmp(&b.rank).then(a_m.total_cmp(b_m)));
    let place = place.map(|(place, _)| place);
    if let Some(place) = place.filter(|place| place.rank <= LEAST_TITLE_RANK) {
        return Some(place.name.clone());
    }
    let districts = layers().flat_map(|layer| {
        let corners: Result<Vec<DVec2>, _> =
            ground.grid_points().map(|at| scene.crs.transform(&layer.crs, at)).collect();
        let corners = corners.unwrap_or_default();
        let covers = move |district: &&NamedDistrict| {
            !corners.is_empty() && corners.iter().all(|&at| holds(district, at))
        };
        layer.districts.iter().filter(covers)
    });
    let district = districts.max_by(|a, b| a.level.total_cmp(&b.level));
    district.map(|district| district.name.clone()).or(place.map(|place| place.name.clone()))
}

fn holds(district: &NamedDistrict, at: DVec2) -> bool {
    district.polygons.iter().any(|polygon| polygon::contains(polygon.rings().map(Vec::as_slice), at))
}

/// A title from the name of a file: its words with capitals, without extensions and without those that say how the file is
/// made and not what it shows. Where no other are left, the name of its folder is taken, then all words.
pub(super) fn of_file(file: &Path) -> String {
    let stem = disk::file_stem(file);
    // `N43E007.hgt.zip` has two extensions.
    let is_packed = file.extension().is_some_and(|extension| extension == "zip" || extension == "gz");
    let stem = if is_packed { disk::file_stem(Path::new(&stem)) } else { stem };
    let folder = file.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let telling = |name: &str| title_of(words(name).filter(|word| !is_technical(word)));
    [telling(&stem), telling(&folder.unwrap_or_default()), title_of(words(&stem))]
        .into_iter()
        .find(|title| !title.is_empty())
        .unwrap_or_else(|| "A scene".into())
}

/// The words of a file's name: apart by signs, and where a capital follows a small letter.
fn words(name: &str) -> impl Iterator<Item = &str> {
    name.split(['_', '-', ' ', '.']).flat_map(|part| {
        let begins_word = |at: usize| {
            let (before, after) = part.split_at(at);
            let ends_small = before.chars().next_back().is_some_and(char::is_lowercase);
            let mut after = after.chars();
            // `SainteHelens`, but not `SainteH`.
            ends_small
                && after.next().is_some_and(char::is_uppercase)
                && after.next().is_some_and(char::is_lowercase)
        };
        let ends =
            part.char_indices().map(|(at, _)| at).filter(move |&at| begins_word(at)).chain([part.len()]);
        ends.scan(0, move |start, end| Some(&part[std::mem::replace(start, end)..end]))
            .filter(|word| !word.is_empty())
    })
}

/// Whether a word says how a file is made: the kind of its model, its source, system, samples or packing.
fn is_technical(word: &str) -> bool {
    let word = word.to_lowercase();
    let is_number = |text: &str| !text.is_empty() && text.chars().all(|letter| letter.is_ascii_digit());
    // `utm33s`, `epsg4326`, `srtmgl3`, `int16`, `f32`.
    let numbered = NUMBERED.iter().filter_map(|prefix| word.strip_prefix(prefix));
    let of_number = |rest: &str| {
        let rest = rest.strip_suffix(['n', 's']).unwrap_or(rest);
        rest.is_empty() || is_number(rest)
    };
    TECHNICAL.contains(&word.as_str())
        || numbered.into_iter().any(of_number)
        || is_number(&word)
        // `30m`, `1m`.
        || ["cm", "km", "m"].iter().any(|unit| word.strip_suffix(unit).is_some_and(is_number))
}

/// Words that say how a file is made.
const TECHNICAL: [&str; 38] = [
    "alos",
    "aster",
    "byte",
    "clip",
    "clipped",
    "cog",
    "copy",
    "crop",
    "cropped",
    "data",
    "deflate",
    "dem",
    "dhm",
    "dsm",
    "dtm",
    "elev",
    "elevation",
    "final",
    "float",
    "geotiff",
    "gtiff",
    "height",
    "heightmap",
    "lidar",
    "lzw",
    "merged",
    "mosaic",
    "nasadem",
    "ned",
    "raster",
    "srtm",
    "terrain",
    "terrarium",
    "tile",
    "tiled",
    "tiles",
    "usgs",
    "zstd",
];

/// What a number may follow in such a word.
const NUMBERED: [&str; 16] = [
    "epsg", "etrs", "f", "float", "glo", "i", "int", "srtmgl", "u", "uint", "utm", "v", "version", "wgs",
    "cop", "gdem",
];

/// A title of words; a last one of two letters after others, as of a country, is written in capitals.
fn title_of<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let mut words: Vec<String> = words.map(title_word).collect();
    if let [_, .., last] = &mut words[..]
        && last.len() == 2
        && last.chars().all(char::is_alphabetic)
    {
        *last = last.to_uppercase();
    }
    words.join(" ")
}

/// A word with a capital letter first; abbreviations in capitals.
fn title_word(word: &str) -> String {
    if ABBREVIATIONS.contains(&word) { word.to_uppercase() } else { capitalized(word) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_s_name_becomes_words() {
        for (file, wanted) in [
            ("data/red_butte-dem.tif", "Red Butte"),
            ("N43E007.hgt.zip", "N43E007"),
            ("crater.bt", "Crater"),
            ("SainteHelens.dem", "Sainte Helens"),
            ("élan__vital.asc", "Élan Vital"),
            ("_.asc", "A scene"),
        ] {
            assert_eq!(of_file(Path::new(file)), wanted);
        }
    }

    #[test]
    fn words_of_formats_and_systems_leave_a_title() {
        for (file, wanted) in [
            ("bigtujunga_utm11_i16_tiled.tif", "Bigtujunga"),
            ("zion_srtm_u16_deflate.tif", "Zion"),
            ("kootenai_1m.asc", "Kootenai"),
            ("poa_elevation.tif", "Poa"),
            ("utah_v2_30m.tif", "Utah"),
        ] {
            assert_eq!(of_file(Path::new(file)), wanted);
        }
    }

    #[test]
    fn a_name_that_says_nothing_leaves_the_title_to_the_folder() {
        for (file, wanted) in [
            ("taunton_uk/dtm.tif", "Taunton UK"),
            ("swellendam_za/dem_srtm_wgs84_f32.tif", "Swellendam ZA"),
            ("data/dem.tif", "DEM"),
            ("dem_utm33s.tif", "DEM Utm33s"),
        ] {
            assert_eq!(of_file(Path::new(file)), wanted);
        }
    }
}
