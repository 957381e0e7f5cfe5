//! The title of a new scene: the name of its place.

use std::path::Path;

use glam::DVec2;

use crate::geom::polygon;
use crate::message::capitalized::capitalized;
use crate::pipeline::files;
use crate::pipeline::new_scene::rules::LEAST_TITLE_RANK;
use crate::pipeline::new_scene::survey::NamedDistrict;
use crate::pipeline::new_scene::text::VectorDraft;
use crate::scene::SceneModel;

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

/// A title from the name of a file: words with capitals, without extensions.
pub(super) fn of_file(file: &Path) -> String {
    let stem = files::file_stem(file);
    // `N43E007.hgt.zip` has two extensions.
    let is_packed = file.extension().is_some_and(|extension| extension == "zip" || extension == "gz");
    let stem = if is_packed { files::file_stem(Path::new(&stem)) } else { stem };
    let words = stem.split(['_', '-', ' ']).filter(|word| !word.is_empty()).map(title_word);
    let title = words.collect::<Vec<_>>().join(" ");
    if title.is_empty() { "A scene".into() } else { title }
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
            ("data/red_butte-dem.tif", "Red Butte DEM"),
            ("N43E007.hgt.zip", "N43E007"),
            ("crater.bt", "Crater"),
            ("élan__vital.asc", "Élan Vital"),
            ("_.asc", "A scene"),
        ] {
            assert_eq!(of_file(Path::new(file)), wanted);
        }
    }
}
