//! Every limit on what is read and computed, in one place: [the page](self#limits-on-input-and-work) is made of it.
//!
//! A file may come from anywhere, so that sizes, counts, depths and work are held against these before memory or time is
//! spent on them; what exceeds one is refused by name, with the figure. The service has limits of its own, which are options
//! of `serve`.
//!
#![doc = include_str!("../LIMITS.md")]

use std::fmt::Write;

/// A row of the page.
#[derive(Clone, Copy, Debug)]
pub struct WorkLimit {
    /// The constant.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What is counted.
    pub unit: &'static str,
    /// Of what, and why no more.
    pub what: &'static str,
    /// What to do where more is there.
    pub remedy: &'static str,
}

/// Declares the constants of a group, and the group's rows.
macro_rules! limits {
    ($($title:literal {
        $($name:ident: $kind:ty = $value:expr, $unit:literal, $what:literal, $remedy:literal;)*
    })*) => {
        $($(
            #[doc = concat!("The most ", $unit, " ", $what, ".")]
            pub const $name: $kind = $value;
        )*)*

        /// The limits by group, in the order of the page.
        const GROUPS: &[(&str, &[WorkLimit])] = &[$(($title, &[$(WorkLimit {
            name: stringify!($name),
            value: $name as f64,
            unit: $unit,
            what: $what,
            remedy: $remedy,
        }),*])),*];
    };
}

limits! {
    "Elevation and pictures of the ground" {
        RASTER_SAMPLES: u64 = 16_385 * 16_385, "samples",
            "of a raster in memory, 16,385 a side: a gigabyte of 32-bit floats, larger than any terrain that fits a scene",
            "cut or coarsen it, or name an `extent`";
        TILE_SAMPLES: u64 = 2 * RASTER_SAMPLES, "samples",
            "of all tiles that are joined, which overlap",
            "join fewer tiles";
        SPARSE_BYTES: u64 = 64 << 20, "bytes",
            "that a packed raster of any file size may claim to hold; beyond, the file must be large enough for what it claims",
            "fetch the file again: it is cut short";
        WINDOWED_SAMPLES: u64 = 1 << 36, "samples",
            "of a raster that is read where it is needed, 262,144 a side",
            "cut it";
        BLOCK_SAMPLES: u64 = 1 << 22, "samples",
            "of one tile or strip of a GeoTIFF that is so read, 2048 a side",
            "rewrite it in tiles: gdal_translate -co TILED=YES";
        TIFF_TAG_BYTES: usize = 16 << 20, "bytes",
            "of one tag of a TIFF: the offsets of a million blocks",
            "rewrite it with larger tiles";
        TIFF_IMAGES: usize = 64, "images",
            "of a TIFF that are looked at: overviews and masks",
            "later ones are not seen";
        COMPANION_BYTES: u64 = 64 << 20, "bytes",
            "of a packed companion: a mask of the largest raster, a bit a sample",
            "unpack it beside the file";
        GRID_POINTS: u64 = 1 << 26, "points",
            "of one file of scattered points: 1.5 GiB",
            "thin or cut the file";
        IMAGERY_PIXELS: u64 = 64 << 20, "pixels",
            "of a PNG or JPEG picture of the ground, which is decoded whole: 256 MiB",
            "make a tiled GeoTIFF of it, which is read in parts";
    }
    "Files and archives" {
        INPUT_BYTES: u64 = 4 << 30, "bytes",
            "of a file on the command line or from standard input",
            "cut the file";
        ASSET_BYTES: u64 = 2 << 30, "bytes",
            "of a file that a scene names",
            "cut the file";
        UNPACKED_RASTER_BYTES: u64 = 1 << 30, "bytes",
            "of an unpacked elevation file: a raster of the most samples",
            "unpack it before";
        UNPACKED_VECTOR_BYTES: u64 = 512 << 20, "bytes",
            "of an unpacked vector file; a city's OpenStreetMap XML is a tenth of it",
            "unpack it before";
    }
    "Scene files" {
        SCENE_BYTES: usize = 4 << 20, "bytes",
            "of a scene file with what it includes: some hundred thousand points. Reading costs up to a hundred bytes of memory for each byte of a hostile file",
            "move points to a vector file";
        STYLE_BYTES: usize = 16 << 20, "bytes",
            "that styles may add, each counted as often as it is used",
            "state less in styles that many tables use";
        SCENE_TABLES: usize = 10_000, "tables",
            "of one kind, such as `[[road]]`; far above what a picture can show",
            "move features to a vector file";
        INLINE_POINTS: usize = 100_000, "points",
            "of one feature in a scene file",
            "move them to a vector file";
        SCENE_TEXT: usize = 4096, "characters",
            "of a text in a scene file",
            "shorten it";
        SCENE_LIST: usize = 256, "values",
            "of a list: stops of a ramp, values of a selection, files of a mosaic",
            "name a folder, or say it with an expression";
        INCLUDED_FILES: usize = 64, "files",
            "that a scene includes",
            "join some";
        INCLUDE_DEPTH: usize = 8, "levels",
            "of files that include others",
            "include from the scene file itself";
        EXPRESSION_BYTES: usize = 4096, "bytes",
            "of an expression, about a screen",
            "shorten it, or compute the property before";
        EXPRESSION_DEPTH: usize = 200, "levels",
            "of brackets and chains of operators in an expression, which bounds the stack",
            "part it";
    }
    "Vector files" {
        GEOJSON_BYTES: usize = 64 << 20, "bytes",
            "of a GeoJSON file: a hostile one takes thirty-five bytes of memory for each of its own",
            "cut it, or convert it to FlatGeobuf or GeoPackage";
        OSM_BYTES: usize = 2 << 30, "bytes",
            "of memory for an OpenStreetMap extract",
            "cut it with osmium extract";
        OSM_AREA_VERTICES: usize = 1 << 25, "vertices",
            "of all areas of an OpenStreetMap extract, whose relations may name the same ways again and again",
            "cut it with osmium extract";
        RING_STEPS: u64 = 1 << 31, "steps",
            "that sort the rings of one file into polygons and holes: seconds, and a hundred times what real layers take",
            "mend the file: ogr2ogr -makevalid";
        XML_DEPTH: usize = 64, "levels",
            "of elements in KML, GPX and OpenStreetMap XML",
            "flatten its folders";
        GEOMETRY_DEPTH: usize = 16, "levels",
            "of collections in a GeoPackage's geometry",
            "take the collections apart";
    }
    "Models" {
        MODEL_TRIANGLES: usize = 1 << 22, "triangles",
            "of a model with all its instances: some hundred megabytes",
            "simplify the model";
        MODEL_ELEMENTS: usize = 1 << 25, "elements",
            "read from all accessors of a glTF model, instances included",
            "simplify the model";
        TEXTURE_SIDE: u32 = 8192, "pixels",
            "along a side of a texture, which every graphics adapter supports",
            "shrink the texture";
        TEXTURE_PIXELS: u64 = 64 << 20, "pixels",
            "of all textures of a model: 256 MiB",
            "shrink the textures";
    }
    "Scenes" {
        GROUND_POSTS: u64 = 4097 * 4097, "posts",
            "of ground that is made finer for narrow roads and shores: 800 MB with all that is computed for them; the ground stays coarser than they would need",
            "name an `extent`";
        GROUND_ROW_POSTS: u64 = 8192, "posts",
            "in a row of such ground: the largest texture of most graphics adapters",
            "name an `extent`";
        RING_CROSSINGS: usize = 100_000, "crossings",
            "of all polygons of a scene with themselves: a hundred megabytes and a second of resolving them",
            "mend the polygons: ogr2ogr -makevalid";
        ROAD_PAIRS: usize = 20_000_000, "pairs",
            "of legs of roads that are compared for crossings; a city has some hundred thousand. Beyond, roads are not held level where they cross",
            "part the roads by class or area";
        ROAD_CROSSINGS: usize = 1_000_000, "crossings",
            "of roads that are kept, as above",
            "part the roads by class or area";
        ROAD_STATIONS: f64 = 2e7, "stations",
            "of roads that the ground follows: 100,000 km over cells of 15 m, and 2 GB",
            "leave lesser roads draped, or name an `extent`";
        RIVER_POSTS: usize = 200_000_000, "posts",
            "that the beds of rivers cover, each counted for every cell that the river crosses beside it: some seconds",
            "narrow the rivers, or name an `extent`";
        EARTHWORK_STEPS: f64 = 1e9, "steps",
            "of some nanoseconds that all earthworks take together",
            "make them smaller, or the slopes steeper";
        LEVELED_PADS: usize = 10_000, "pads",
            "that models have leveled for them",
            "set `ground` of most models to a kind that needs none";
        LEVELED_CELLS: u64 = 10_000_000, "cells",
            "of ground that the footprints of such models cover",
            "check the unit of the models";
        SCENE_MODELS: usize = 1_000_000, "models",
            "of a scene: fifty megabytes of places",
            "thin them";
        SCATTER_SQUARES: usize = 1 << 25, "places",
            "that patterns of scattered models may have: a second's work",
            "state a lower density, or a smaller area";
        LINE_PIECES: f64 = 300_000.0, "pieces",
            "along lines: posts, pylons, obstacles, dashes, lengths of hedge; a few hundred megabytes",
            "take longer spacings, or fewer lines";
        BRIDGE_PIERS: f64 = 200_000.0, "piers",
            "of all bridges",
            "take a larger `pier_spacing`";
        SCENE_GRAPHICS: usize = 4096, "graphics",
            "of a scene; more hide the ground that they lie on",
            "draw fewer";
        SCENE_SYMBOLS: usize = 4096, "symbols",
            "of a scene; later ones are left out, with a note",
            "draw fewer";
    }
    "Answers" {
        PROFILE_STEPS: f64 = 1e7, "steps",
            "along a profile",
            "take longer ones";
        FLIGHT_FRAMES: f64 = 90_000.0, "frames",
            "of a flight: an hour",
            "state fewer --seconds or a smaller --fps";
    }
}

/// The page: the text of `src/LIMITS.md`.
pub fn page() -> String {
    let mut page = String::from(
        "# Limits on input and work\n\nWhat exceeds one of these is refused, or left out with a note, before memory or time is \
         spent on it; the message has the figure.\n",
    );
    for (title, limits) in GROUPS {
        let _ = write!(page, "\n## {title}\n\n| at most | | where more is needed |\n|--:|---|---|\n");
        for WorkLimit { value, unit, what, remedy, .. } in *limits {
            let _ = writeln!(page, "| {} {unit} | {what} | {remedy} |", grouped(*value));
        }
    }
    page
}

/// A whole number with commas between its thousands.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut grouped = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_page_holds_every_limit() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/LIMITS.md");
        if std::env::var_os("SANDTABLE_BLESS").is_some() {
            std::fs::write(file, page()).expect("writable");
        }
        let found = std::fs::read_to_string(file).expect("the page is there");
        assert!(found == page(), "src/LIMITS.md is old; run the test again with SANDTABLE_BLESS=1");
    }

    #[test]
    fn limits_have_names_of_their_own_and_say_what_to_do() {
        let all: Vec<&WorkLimit> = GROUPS.iter().flat_map(|(_, limits)| *limits).collect();
        let names: BTreeSet<&str> = all.iter().map(|limit| limit.name).collect();
        assert!(names.len() == all.len() && all.len() > 40);
        assert!(all.iter().all(|limit| limit.value >= 8.0 && !limit.remedy.is_empty()));
        assert_eq!(grouped(268_468_225.0), "268,468,225");
    }
}
