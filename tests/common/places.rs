//! Whole real places as scenes: elevation, roads, water, buildings, what covers the ground and what stands on it.

use std::path::PathBuf;

use super::data::data;

/// Their names.
pub const PLACES: [&str; 5] = ["swellendam", "porto_alegre", "monaco", "taunton", "wake"];

/// A place's name, its folder in the test data, and its scene with `PLACE` for that folder.
const SCENES: [(&str, &str, &str); 5] = [
    ("swellendam", "swellendam_za", include_str!("places/swellendam.toml")),
    ("porto_alegre", "porto_alegre_br", include_str!("places/porto_alegre.toml")),
    ("monaco", "monaco", include_str!("places/monaco.toml")),
    ("taunton", "taunton_uk", include_str!("places/taunton.toml")),
    ("wake", "wake_nc_us", include_str!("places/wake.toml")),
];

/// The scene of a place and the folders it reads from; `None` with a loud line where there is no data.
pub fn text_of(place: &str) -> Option<(String, Vec<PathBuf>)> {
    let (_, folder, text) =
        SCENES.into_iter().find(|(name, _, _)| *name == place).expect("one of the places");
    let folder = data(&format!("scenes/{folder}"))?;
    Some((text.replace("PLACE", &folder.to_string_lossy()), vec![folder]))
}
