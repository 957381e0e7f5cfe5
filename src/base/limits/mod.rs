//! Every limit on what is read and computed, in one place: [the page](self#limits-on-input-and-work) is made of it.
//!
//! A file may come from anywhere, so that sizes, counts, depths and work are held against these before memory or time is
//! spent on them; what exceeds one is refused by name, with the figure. A program may set most of them for its whole run, by
//! [`set_limit`](set_limit::set_limit), before any is read. The service has limits of its own, which are options of `serve`.
//!
#![doc = include_str!("../LIMITS.md")]

pub mod memory;
mod page;
pub mod set_limit;
pub mod work_limit;

use crate::limits::work_limit::Highest::{self, Fixed, To};
use crate::limits::work_limit::WorkLimit;

/// What is numbered by 32 bits.
const COUNT: Highest = To(u32::MAX as u64);

/// What has two triangles for each, numbered by 32 bits.
const POSTS: Highest = To(1 << 30);

/// Bytes: more than any machine's memory.
const BYTES: Highest = To(1 << 44);

/// Steps of work: days.
const STEPS: Highest = To(1 << 50);

/// Declares the limits of a group, and the groups.
macro_rules! limits {
    ($($title:literal {
        $($name:ident = $default:expr => $highest:expr, $unit:literal, $what:literal, $remedy:literal;)*
    })*) => {
        $($(
            #[doc = concat!("The most ", $unit, " ", $what, ".")]
            pub static $name: WorkLimit = WorkLimit::new(stringify!($name), $default, $highest, [$unit, $what, $remedy]);
        )*)*

        /// The limits by group, in the order of the page.
        static GROUPS: &[(&str, &[&WorkLimit])] = &[$(($title, &[$(&$name),*])),*];
    };
}

limits! {
    "Elevation and pictures of the ground" {
        RASTER_SAMPLES = 16_385 * 16_385 => POSTS, "samples",
            "of a raster in memory, 16,385 a side: a gigabyte of 32-bit floats, larger than any terrain that fits a scene",
            "cut or coarsen it, or name an `extent`";
        REDUCED_SAMPLES = 1 << 24 => POSTS, "samples",
            "that pictures show of an elevation model with more than a raster in memory has: means of squares of its samples",
            "name an `extent`";
        PICTURED_SAMPLES = 1 << 25 => POSTS, "samples",
            "of an elevation model that pictures read whole although they show fewer, 5,793 a side, in about a second; of a larger one they read means of squares of samples, no wider than half a pixel, and windows of all near the eye",
            "name an `extent`";
        TILE_SAMPLES = 2 * 16_385 * 16_385 => To(1 << 31), "samples",
            "of all tiles that are joined, which overlap",
            "join fewer tiles";
        SPARSE_BYTES = 64 << 20 => BYTES, "bytes",
            "that a packed raster of any file size may claim to hold; beyond, the file must be large enough for what it claims",
            "fetch the file again: it is cut short";
        WINDOWED_SAMPLES = 1 << 36 => To(1 << 40), "samples",
            "of a raster that is read where it is needed, 262,144 a side",
            "cut it";
        VIEWED_SAMPLES = 1 << 25 => POSTS, "samples",
            "of an elevation file that the window holds in memory, 5,793 a side: two gigabytes with what is measured of them",
            "a larger GeoTIFF in meters is shown in pages that are read as they are needed";
        QUERIED_SAMPLES = 1 << 24 => POSTS, "samples",
            "that are read of such a file for one question, 4,096 a side",
            "measure a shorter line or a smaller outline";
        BLOCK_SAMPLES = 1 << 22 => POSTS, "samples",
            "of one tile or strip of a GeoTIFF that is so read, 2048 a side",
            "rewrite it in tiles: gdal_translate -co TILED=YES";
        TIFF_TAG_BYTES = 16 << 20 => COUNT, "bytes",
            "of one tag of a TIFF: the offsets of a million blocks",
            "rewrite it with larger tiles";
        TIFF_IMAGES = 64 => To(1 << 16), "images",
            "of a TIFF that are looked at: overviews and masks",
            "later ones are not seen";
        COMPANION_BYTES = 64 << 20 => BYTES, "bytes",
            "of a packed companion: a mask of the largest raster, a bit a sample",
            "unpack it beside the file";
        VRT_BYTES = 64 << 20 => COUNT, "bytes",
            "of a virtual raster, which lists a hundred thousand tiles in so many",
            "name fewer tiles";
        GRID_POINTS = 1 << 26 => To(1 << 29), "points",
            "of one file of scattered points: 1.5 GiB",
            "thin or cut the file";
        IMAGERY_PIXELS = 64 << 20 => COUNT, "pixels",
            "of a PNG or JPEG picture of the ground, which is decoded whole: 256 MiB",
            "make a tiled GeoTIFF of it, which is read in parts";
    }
    "Files and archives" {
        INPUT_BYTES = 4 << 30 => BYTES, "bytes",
            "of a file on the command line or from standard input",
            "cut the file";
        ASSET_BYTES = 2 << 30 => BYTES, "bytes",
            "of a file that a scene names",
            "cut the file";
        UNPACKED_RASTER_BYTES = 1 << 30 => BYTES, "bytes",
            "of an unpacked elevation file: a raster of the most samples",
            "unpack it before";
        REMOTE_DISK_BYTES = 1 << 30 => BYTES, "bytes",
            "of files read by address that are kept on disk for later runs; the oldest are removed first",
            "what is not kept is fetched again";
        UNPACKED_VECTOR_BYTES = 512 << 20 => BYTES, "bytes",
            "of an unpacked vector file; a city's OpenStreetMap XML is a tenth of it",
            "unpack it before";
    }
    "Scene files" {
        SCENE_BYTES = 4 << 20 => COUNT, "bytes",
            "of a scene file with what it includes: some hundred thousand points. Reading costs up to a hundred bytes of memory for each byte of a hostile file",
            "move points to a vector file";
        STYLE_BYTES = 16 << 20 => COUNT, "bytes",
            "that styles may add, each counted as often as it is used",
            "state less in styles that many tables use";
        SCENE_TABLES = 10_000 => COUNT, "tables",
            "of one kind, such as `[[road]]`; far above what a picture can show",
            "move features to a vector file";
        INLINE_POINTS = 100_000 => COUNT, "points",
            "of one feature in a scene file",
            "move them to a vector file";
        SCENE_TEXT = 4096 => COUNT, "characters",
            "of a text in a scene file",
            "shorten it";
        SCENE_LIST = 256 => COUNT, "values",
            "of a list: stops of a ramp, values of a selection, files of a mosaic",
            "name a folder, or say it with an expression";
        INCLUDED_FILES = 64 => COUNT, "files",
            "that a scene includes",
            "join some";
        INCLUDE_DEPTH = 8 => Fixed, "levels",
            "of files that include others",
            "include from the scene file itself";
        EXPRESSION_BYTES = 4096 => COUNT, "bytes",
            "of an expression, about a screen",
            "shorten it, or compute the property before";
        EXPRESSION_DEPTH = 200 => Fixed, "levels",
            "of brackets and chains of operators in an expression, which bounds the stack",
            "part it";
    }
    "Vector files" {
        GEOJSON_BYTES = 64 << 20 => COUNT, "bytes",
            "of a GeoJSON file: a hostile one takes thirty-five bytes of memory for each of its own",
            "cut it, or convert it to FlatGeobuf or GeoPackage";
        OSM_BYTES = 2 << 30 => BYTES, "bytes",
            "of memory for an OpenStreetMap extract",
            "cut it with osmium extract";
        OSM_AREA_VERTICES = 1 << 25 => COUNT, "vertices",
            "of all areas of an OpenStreetMap extract, whose relations may name the same ways again and again",
            "cut it with osmium extract";
        OVERLAY_VERTICES = 1 << 24 => COUNT, "vertices",
            "of all circles, arcs and racetracks of an NVG file, each of which a few letters state",
            "leave some of them out";
        RING_STEPS = 1 << 31 => STEPS, "steps",
            "that sort the rings of one file into polygons and holes: seconds, and a hundred times what real layers take",
            "mend the file: ogr2ogr -makevalid";
        XML_DEPTH = 64 => Fixed, "levels",
            "of elements in XML: KML, GPX, OpenStreetMap, overlays and scenarios",
            "flatten its folders";
        DESIGN_BYTES = 128 << 20 => COUNT, "bytes",
            "of a DXF or LandXML file that is read for its lines: a hostile one takes thirty bytes of memory for each of its own",
            "part it by its layers";
        DESIGN_VERTICES = 1 << 23 => COUNT, "vertices",
            "of a CityJSON, LandXML or DXF file with the chords of its curves, its templates and its blocks wherever they are placed: some five hundred megabytes",
            "cut it, for example with: cjio IN subset --bbox";
        GEOMETRY_DEPTH = 16 => Fixed, "levels",
            "of collections in a GeoPackage's geometry",
            "take the collections apart";
    }
    "Models" {
        MODEL_TRIANGLES = 1 << 22 => POSTS, "triangles",
            "of a model with all its instances: some hundred megabytes",
            "simplify the model";
        MODEL_ELEMENTS = 1 << 25 => COUNT, "elements",
            "read from all accessors of a glTF model, instances included",
            "simplify the model";
        TEXTURE_SIDE = 8192 => Fixed, "pixels",
            "along a side of a texture, which every graphics adapter supports",
            "shrink the texture";
        TEXTURE_PIXELS = 64 << 20 => COUNT, "pixels",
            "of all textures of a model: 256 MiB",
            "shrink the textures";
    }
    "Scenes" {
        GROUND_POSTS = 4097 * 4097 => POSTS, "posts",
            "of ground that is made finer for narrow roads and shores: 800 MB with all that is computed for them; the ground stays coarser than they would need",
            "name an `extent`";
        GROUND_ROW_POSTS = 8192 => To(1 << 16), "posts",
            "in a row of such ground: the largest texture of most graphics adapters",
            "name an `extent`";
        RING_CROSSINGS = 100_000 => COUNT, "crossings",
            "of all polygons of a scene with themselves: a hundred megabytes and a second of resolving them",
            "mend the polygons: ogr2ogr -makevalid";
        ROAD_PAIRS = 20_000_000 => STEPS, "pairs",
            "of legs of roads that are compared for crossings; a city has some hundred thousand. Beyond, roads are not held level where they cross",
            "part the roads by class or area";
        ROAD_CROSSINGS = 1_000_000 => COUNT, "crossings",
            "of roads that are kept, as above",
            "part the roads by class or area";
        ROAD_STATIONS = 20_000_000 => COUNT, "stations",
            "of roads that the ground follows: 100,000 km over cells of 15 m, and 2 GB",
            "leave lesser roads draped, or name an `extent`";
        RIVER_POSTS = 200_000_000 => STEPS, "posts",
            "that the beds of rivers cover, each counted for every cell that the river crosses beside it: some seconds",
            "narrow the rivers, or name an `extent`";
        EARTHWORK_STEPS = 1_000_000_000 => STEPS, "steps",
            "of some nanoseconds that all earthworks take together",
            "make them smaller, or the slopes steeper";
        LEVELED_PADS = 10_000 => COUNT, "pads",
            "that models have leveled for them",
            "set `ground` of most models to a kind that needs none";
        LEVELED_CELLS = 10_000_000 => COUNT, "cells",
            "of ground that the footprints of such models cover",
            "check the unit of the models";
        SCENE_MODELS = 1_000_000 => COUNT, "models",
            "of a scene: fifty megabytes of places",
            "thin them";
        SCATTER_SQUARES = 1 << 25 => COUNT, "places",
            "that patterns of scattered models may have: a second's work",
            "state a lower density, or a smaller area";
        LINE_PIECES = 300_000 => COUNT, "pieces",
            "along lines: posts, pylons, obstacles, dashes, lengths of hedge; a few hundred megabytes",
            "take longer spacings, or fewer lines";
        BRIDGE_PIERS = 200_000 => COUNT, "piers",
            "of all bridges",
            "take a larger `pier_spacing`";
        SCENE_GRAPHICS = 4096 => COUNT, "graphics",
            "of a scene; more hide the ground that they lie on",
            "draw fewer";
        SCENE_SYMBOLS = 65_536 => COUNT, "symbols",
            "of a scene; later ones are left out, with a note",
            "draw fewer";
    }
    "Answers" {
        PROFILE_STEPS = 10_000_000 => COUNT, "steps",
            "along a profile",
            "take longer ones";
        GEOID_NODES = 1 << 14 => COUNT, "nodes",
            "of the geoid that one query computes, a millisecond each: heights over 16 by 16 degrees",
            "ask for fewer heights, or for heights closer together";
        FLIGHT_FRAMES = 90_000 => COUNT, "frames",
            "of a flight: an hour",
            "state fewer --seconds or a smaller --fps";
    }
    "Plans" {
        PLAN_SHARDS = 1_000_000 => COUNT, "shards",
            "of a plan: folders of two million files",
            "plan larger shards, or parts of the work";
        PLAN_POINTS = 1 << 30 => To(1 << 40), "points",
            "of a plan, whose positions take 20 bytes of disk each",
            "plan parts of the file";
        PLAN_OBSERVERS = 1_000_000 => COUNT, "observers",
            "of a plan of viewsheds, each some milliseconds to minutes of work",
            "plan parts of the file";
    }
}

/// All limits, in the order of the page.
pub fn all() -> impl Iterator<Item = &'static WorkLimit> {
    GROUPS.iter().flat_map(|(_, limits)| *limits).copied()
}
