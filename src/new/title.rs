//! The title of a new scene: the name of its place.

use std::path::Path;

use glam::DVec2;

use crate::named::NamedDistrict;
use crate::rules::LEAST_TITLE_RANK;
use crate::text::VectorDraft;
use sandtable_base::message::capitalized::capitalized;
use sandtable_files::disk;
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_vector::feature::Polygon;

/// Words of file names that are written in capitals.
const ABBREVIATIONS: [&str; 8] = ["dem", "dtm", "dsm", "srtm", "ned", "utm", "usgs", "nasadem"];

/// As many places along each side of the ground tell how much of it an area covers.
const SAMPLES: u32 = 24;
/// The least share of the ground that a park covers for its name to be the title, and that a layer's only area does.
const LEAST_COVERED: [f64; 2] = [0.1, 0.3];
/// Ground whose longer side is shorter than this has its position in hundredths of a degree, else in tenths: meters.
const SMALL_M: f64 = 10_000.0;

/// The title of a scene:
///
/// 1. the name of its place by its vectors, see [`of_vectors`];
/// 2. the words of the elevation file's name, or of its folder's, where a feature's name holds them too: only then they
///    are known to name a place;
/// 3. the position of its middle on Earth, such as `36.3° N 84.2° W`;
/// 4. of ground without a position on Earth the words of the file's name.
pub(super) fn of_scene(file: &Path, vectors: &[VectorDraft], scene: &SceneModel) -> String {
    let names = || vectors.iter().flat_map(|vector| &vector.layers).flat_map(|layer| &layer.names);
    let is_place = |title: &String| names().any(|name| name.to_lowercase().contains(&title.to_lowercase()));
    of_vectors(vectors, scene)
        .or_else(|| telling(file).into_iter().find(is_place))
        .or_else(|| of_middle(scene))
        .unwrap_or_else(|| of_file(file))
}

/// The position of the middle of the ground, in degrees; `None` where it has none on Earth.
fn of_middle(scene: &SceneModel) -> Option<String> {
    let ground = scene.lattice.map_extent();
    let DVec2 { x: lon, y: lat } = scene.crs.transform(&Crs::wgs84(), ground.center()).ok()?;
    let decimals = if ground.size().max_element() < SMALL_M { 2 } else { 1 };
    let (north, east) = (if lat < 0.0 { "S" } else { "N" }, if lon < 0.0 { "W" } else { "E" });
    let degrees = |angle: f64| format!("{:.decimals$}°", angle.abs());
    (lon.is_finite() && lat.is_finite()).then(|| format!("{} {north} {} {east}", degrees(lat), degrees(lon)))
}

/// The title that vectors give: the most important city, town or village on the ground, of several the nearest to its
/// middle; else the smallest district that covers all of it; else the park or the only area that covers most of it; else
/// the most important place of any kind; else the highest peak. `None` where they name nothing of this.
fn of_vectors(vectors: &[VectorDraft], scene: &SceneModel) -> Option<String> {
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
            !corners.is_empty() && corners.iter().all(|&at| holds(&district.polygons, at))
        };
        layer.districts.iter().filter(covers)
    });
    let district = districts.max_by(|a, b| a.level.total_cmp(&b.level));
    district
        .map(|district| district.name.clone())
        .or_else(|| area(vectors, scene))
        .or_else(|| place.map(|place| place.name.clone()))
        .or_else(|| peak(vectors, scene))
}

/// The park that covers the most of the ground, or the only area of a layer.
fn area(vectors: &[VectorDraft], scene: &SceneModel) -> Option<String> {
    let layers = || vectors.iter().flat_map(|vector| &vector.layers);
    let [least_park, least_only] = LEAST_COVERED;
    let parks = layers().flat_map(|layer| layer.parks.iter().map(move |park| (layer, park, least_park)));
    let only = layers().filter_map(|layer| Some((layer, layer.only_area.as_ref()?, least_only)));
    let covering = parks.chain(only).filter_map(|(layer, area, least)| {
        let share = covered_share(&area.polygons, &layer.crs, scene);
        (share >= least).then_some((share, area))
    });
    covering.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, area)| area.name.clone())
}

/// The share of the ground with data that lies within `polygons`.
fn covered_share(polygons: &[Polygon], crs: &Crs, scene: &SceneModel) -> f64 {
    let lattice = &scene.lattice;
    let extent = lattice.extent();
    let share = |index: u32| (f64::from(index) + 0.5) / f64::from(SAMPLES);
    let places = (0..SAMPLES * SAMPLES)
        .map(|index| extent.size() * DVec2::new(share(index % SAMPLES), share(index / SAMPLES)));
    let on_ground = places.filter(|at| {
        lattice
            .cell_at(*at)
            .is_some_and(|(cell, _)| !lattice.corner_heights(cell).iter().all(|at| at.is_nan()))
    });
    let (inside, all) = on_ground.fold((0_u32, 0_u32), |(inside, all), at| {
        let at = scene.crs.transform(crs, at + lattice.origin());
        let is_inside = at.is_ok_and(|at| holds(polygons, at));
        (inside + u32::from(is_inside), all + 1)
    });
    f64::from(inside) / f64::from(all.max(1))
}

/// The peak on the highest ground.
fn peak(vectors: &[VectorDraft], scene: &SceneModel) -> Option<String> {
    let layers = vectors.iter().flat_map(|vector| &vector.layers);
    let peaks = layers.flat_map(|layer| layer.peaks.iter().map(move |peak| (layer, peak)));
    let on_ground = peaks.filter_map(|(layer, peak)| {
        let at = layer.crs.transform(&scene.crs, peak.at).ok()?;
        let height_m = ground_height(&scene.lattice, Interpolation::Planar, at).height_m()?;
        Some((height_m, peak))
    });
    on_ground.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, peak)| peak.name.clone())
}

fn holds(polygons: &[Polygon], at: DVec2) -> bool {
    polygons.iter().any(|polygon| polygon::contains(polygon.rings().map(Vec::as_slice), at))
}

/// A title from the name of a file: its words with capitals, without extensions and without those that say how the file is
/// made and not what it shows. Where no other are left, the name of its folder is taken, then all words.
fn of_file(file: &Path) -> String {
    let whole = title_of(words(&stem(file)));
    telling(file)
        .into_iter()
        .chain([whole])
        .find(|title| !title.is_empty())
        .unwrap_or_else(|| "A scene".into())
}

/// The words of the name of a file, and of its folder, that do not say how it is made; none that are empty.
fn telling(file: &Path) -> Vec<String> {
    let folder = file.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
    let names = [stem(file), folder.unwrap_or_default()];
    let titles = names.iter().map(|name| title_of(words(name).filter(|word| !is_technical(word))));
    titles.filter(|title| !title.is_empty()).collect()
}

/// The name of a layer for a legend: its words, or those of its file's name.
pub(super) fn of_layer(layer: Option<&str>, file: &str) -> String {
    let name = layer.map_or_else(|| stem(Path::new(file)), str::to_owned);
    capitalized(&words(&name).collect::<Vec<_>>().join(" "))
}

/// The name of a file without extensions.
fn stem(file: &Path) -> String {
    let stem = disk::file_stem(file);
    // `N43E007.hgt.zip` has two extensions.
    let is_packed = file.extension().is_some_and(|extension| extension == "zip" || extension == "gz");
    if is_packed { disk::file_stem(Path::new(&stem)) } else { stem }
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
