//! The scene file's tables, except those of features ([`crate::features`]).
//!
//! A scene file is TOML in UTF-8. Lengths and heights are meters, angles degrees, compass directions clockwise from
//! north, coordinates `[easting, northing]` or `[longitude, latitude]`, and file names relative to the file that states
//! them, unless the description of a key differs. Unknown keys are errors. Every number is finite.
//!
//! ```toml
//! title = "The hill"
//! crs = "EPSG:32616"
//!
//! [terrain]
//! dem = "hill.tif"
//!
//! [style]
//! ramp = "atlas"
//! contours = { interval = 20 }
//!
//! [[road]]
//! file = "roads.geojson"
//! where = { highway = ["primary", "secondary"] }
//! width = "lanes * 3.5 ?? 8"
//!
//! [[camera]]
//! name = "south"
//! eye = [500000, 4649000]
//! eye_height = 300
//! look_at = [500000, 4650000]
//! ```
//!
//! The page `scenes/README.md` lists all keys. Values include their defaults. A value that later steps check (the name
//! of a file, a point on the terrain) is [`Stated`]; [`Document::error`] makes a message that points at it.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;
use std::sync::Arc;

use crate::analyses::{AnalysisTable, VehicleTable};
use crate::bounds::Bounds::{self, Above, Within};
use crate::color::{Color, RampChoice};
use crate::declaration::{KeyDeclaration, Presence};
use crate::diagnostic::Diagnostic;
use crate::earthworks::EarthworkTable;
use crate::elevation_file::{ElevationFile, elevation_files};
use crate::feature_source::FeatureSource;
use crate::feature_value::{DefaultedValue, FeatureValue};
use crate::features::{
    AreaTable, BridgeTable, BuildingTable, CoastTable, FenceTable, LakeTable, ModelPlacement, RiverTable,
    RoadTable, ScatterTable,
};
use crate::finding_code::FindingCode;
use crate::graphics::{GraphicTable, RangeTable, SightTable, ViewshedTable};
use crate::key;
use crate::overlays::OverlayTable;
use crate::panorama_keys::{check_eye_height, check_panorama};
use crate::reader::TableReader;
use crate::selection::Selection;
use crate::source_text::SourceText;
use crate::stated::Stated;
use crate::symbols::SymbolTable;
use crate::table::Table;
use crate::table_key;
use crate::unused::UnusedDefinitions;
use crate::words::{
    CameraProjection, ContourLook, GridName, HeightEncodingWord, LabelKind, PaperName, RoadShield,
    SheetLayout, StylePreset, TableTop, VerticalUnitWord,
};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

table! {
    /// A whole scene file.
    struct Document {
        with source: Arc<SourceText> = TableReader::source, "The text that it was read from; messages point into it.";
        with unused: UnusedDefinitions = TableReader::unused, "What it defines and no table uses.";
        with phase: Option<String> = TableReader::phase, "The phase that it was read for; `None` where it has none.";

        /// A scene file, or a list of them, whose tables come before this one's; what this one states counts.
        include: Option<Vec<String>> = key::text_list(), otherwise "none";
        /// Title of the picture.
        title: Option<String> = key::text(), otherwise "none";
        /// Second line under the title.
        subtitle: Option<String> = key::text(), otherwise "none";
        /// Coordinate system of the scene, `EPSG:n` or a proj string, in meters.
        crs: Option<Crs> = key::metric_crs(), otherwise "the DEM's, or the UTM zone of its center, near a pole UPS, where it is in degrees or its lengths are off by more than 1 %";
        /// Coordinate system of inline points, unless a table has its own `crs`.
        points_crs: Option<Crs> = key::crs(), otherwise "`crs`, or the DEM's where that is in meters, or the scene's";
        /// A TTF or OTF file, or a collection (TTC): the font of characters that the built-in one lacks. That one has Latin,
        /// Greek and Cyrillic.
        font: Option<Stated<String>> = key::file(), otherwise "none; characters that the built-in font lacks are boxes, and reported";
        /// The ground.
        terrain: TerrainTable = table_key::table::<TerrainTable>(), required;
        /// How the ground looks.
        style: StyleTable = table_key::table::<StyleTable>(), default {};
        /// Named sets of keys: a table of features takes those of the style that its key `style` names.
        styles: Vec<String> = key::styles(), default {};
        /// Roads, in drawing order.
        roads as "road": Vec<RoadTable> = table_key::styled_tables::<RoadTable>(), default [];
        /// Bridges that belong to no road of the scene.
        bridges as "bridge": Vec<BridgeTable> = table_key::styled_tables::<BridgeTable>(), default [];
        /// Rivers, in drawing order.
        rivers as "river": Vec<RiverTable> = table_key::styled_tables::<RiverTable>(), default [];
        /// Coastlines: the ground is level with the sea on one side of them, and above it on the other.
        coasts as "coast": Vec<CoastTable> = table_key::styled_tables::<CoastTable>(), default [];
        /// Still water: level, and cut out of the ground or filled up to it.
        lakes as "lake": Vec<LakeTable> = table_key::styled_tables::<LakeTable>(), default [];
        /// What covers the ground, in drawing order.
        areas as "area": Vec<AreaTable> = table_key::styled_tables::<AreaTable>(), default [];
        /// Ground that is dug, leveled and filled.
        earthworks as "earthwork": Vec<EarthworkTable> = table_key::styled_tables::<EarthworkTable>(), default [];
        /// Footprints raised to a height.
        buildings as "building": Vec<BuildingTable> = table_key::styled_tables::<BuildingTable>(), default [];
        /// What stands or runs along a line.
        fences as "fence": Vec<FenceTable> = table_key::styled_tables::<FenceTable>(), default [];
        /// A model file, once or many times.
        models as "model": Vec<ModelPlacement> = table_key::styled_tables::<ModelPlacement>(), default [];
        /// Models strewn over areas.
        scatters as "scatter": Vec<ScatterTable> = table_key::styled_tables::<ScatterTable>(), default [];
        /// Tactical graphics, laid over everything else on the ground.
        graphics as "graphic": Vec<GraphicTable> = table_key::styled_tables::<GraphicTable>(), default [];
        /// What observers see, as a tint of the ground.
        viewsheds as "viewshed": Vec<ViewshedTable> = table_key::styled_tables::<ViewshedTable>(), default [];
        /// Lines of sight.
        sights as "sight": Vec<SightTable> = table_key::styled_tables::<SightTable>(), default [];
        /// Rings and fans of range.
        ranges as "range": Vec<RangeTable> = table_key::styled_tables::<RangeTable>(), default [];
        /// Vehicles, by the names that analyses state.
        vehicles as "vehicle": Vec<(Stated<String>, VehicleTable)> = table_key::named_tables::<VehicleTable>(), default {};
        /// What the ground allows: slopes, obstacles, times, routes, what is seen, landing zones, water.
        analyses as "analysis": Vec<AnalysisTable> = table_key::styled_tables::<AnalysisTable>(), default [];
        /// Names and heights on the picture.
        labels as "label": Vec<LabelTable> = table_key::styled_tables::<LabelTable>(), default [];
        /// What the scene shows one after the other: one picture each.
        phases as "phase": Vec<PhaseTable> = table_key::tables::<PhaseTable>(), default [];
        /// Military symbols, standing on the ground.
        symbols as "symbol": Vec<SymbolTable> = table_key::styled_tables::<SymbolTable>(), default [];
        /// Files of units, tactical graphics and drawings.
        overlays as "overlay": Vec<OverlayTable> = table_key::styled_tables::<OverlayTable>(), default [];
        /// Views; the first is the default. Without any, one is fitted to the whole ground.
        cameras as "camera": Vec<CameraTable> = table_key::tables::<CameraTable>(), default [];
        /// Paths through the scene that `sandtable fly` follows.
        flights as "flight": Vec<FlightTable> = table_key::tables::<FlightTable>(), default [];
        /// What frames the picture.
        furniture: FurnitureTable = table_key::table::<FurnitureTable>(), default {};
    }
    check(reader) {
        let cameras = cameras.iter().flatten().map(|camera: &CameraTable| &camera.name);
        check_names(reader, "camera", cameras);
        let phases = phases.iter().flatten().map(|phase: &PhaseTable| &phase.name);
        check_names(reader, "phase", phases);
        let flights = flights.iter().flatten().map(|flight: &FlightTable| &flight.name);
        check_names(reader, "flight", flights);
    }

    /// `[terrain]`: the elevation model.
    struct TerrainTable {
        /// The elevation file, or a list of up to 256 that are tiles of one raster; the first tile with a
        /// value wins, and tiles of larger cells that nest in the finest ones' fill what these leave. A folder
        /// stands for those in it, a GDAL virtual raster (`.vrt`) for those that it lists. A table
        /// `{ file = "b.tif", offset = 1.5 }` adds `offset`, in meters, to the heights of a tile that is counted
        /// from another zero. An address (`https://`, `s3://`, `gs://`, `az://`) is read with `--allow-remote HOST`.
        dem: Stated<Vec<ElevationFile>> = elevation_files(), required;
        /// The surface that is read of a LandXML file, by its name.
        surface: Option<String> = key::filled_text(), otherwise "the file's first";
        /// Coordinate system of the DEM where the file names none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "what the file names";
        /// Meters per unit of a sample's value, of gray PNG and RAW files.
        height_scale: Option<f64> = key::number(Above(0.0, 1e6), "m"), otherwise "1 for RAW; gray PNG needs it";
        /// Height of sample value 0 of a gray PNG or RAW file.
        height_offset: f64 = key::number(Bounds::ELEVATION, "m"), default 0;
        /// A value that means no data, besides the one that the file declares.
        nodata: Option<f64> = key::number(Within(-1e39, 1e39), ""), otherwise "what the file declares";
        /// How the colors of a PNG encode heights.
        height_encoding: Option<HeightEncodingWord> = key::word::<HeightEncodingWord>(), otherwise "none; color PNG needs it";
        /// That the file is RAW, and its layout, such as `1201x1201:i16be`.
        raw: Option<Stated<String>> = key::filled_text(), otherwise "the file is not RAW";
        /// What heights are counted from, such as `NAVD88`: printed; `height --above` needs `EGM96 geoid` or `WGS 84 ellipsoid`.
        vertical_datum: Option<String> = key::filled_text(), otherwise "what the file names, if anything";
        /// The unit of the samples' values. With `height_scale` or `height_encoding`, which state meters, it has no place.
        vertical_unit: Option<Stated<VerticalUnitWord>> = key::word::<VerticalUnitWord>(),
            otherwise "what the file or the `.prj` beside it states, or meters";
        /// Whether samples without data that others enclose are filled by a membrane, up to 100000 at a place; `true` fills
        /// the source as well, so that height queries on it see no voids.
        fill_voids: Option<bool> = key::switch(), otherwise "the ground is filled, the source stays as it is read";
        /// Whether level ground is drawn as water: at 0 m and connected to the border as sea, unless `sea_level` is stated, and
        /// level basins as lakes.
        infer_water: bool = key::switch(), default true;
        /// The level of the sea: ground at or below it that is connected to the border is drawn as sea. State it where the model
        /// holds the depths of the sea; ground below 0 m alone is no sea.
        sea_level: Option<f64> = key::number(Bounds::ELEVATION, "m"), otherwise "none: level ground at 0 m is sea, by `infer_water`";
        /// Points around the part that the scene is made of, such as two corners of a map. Of a large
        /// model only that part is read.
        extent: Option<Stated<Vec<Position>>> = key::points(2),
            otherwise "the whole model; of one in degrees or turned against north, the largest part with straight edges";
        /// Distance between samples of a file without georeference; its south-west sample is at (0, 0). Of tiles whose
        /// cells do not nest: the cell that all are resampled to, in units of their system.
        cell: Option<f64> = key::number(Above(0.0, 1e6), "m"), otherwise "what the file states";
        /// Factor by which heights are stretched when they are drawn.
        vertical_exaggeration: f64 = key::number(Above(0.0, 1000.0), ""), default 1;
        /// Greatest error of the drawn ground; one pixel is what an eye can just see.
        tolerance_px: Stated<f64> = key::number(Above(0.0, 1000.0), "px"), default 1;
    }

    /// `[style]`: how the ground looks.
    struct StyleTable {
        /// A look in one word: other keys of this table, and `grid`, have its defaults where they are not stated.
        preset: Option<StylePreset> = key::word::<StylePreset>(), otherwise "none: the defaults below";
        /// Colors by height: the name of a ramp, or from 2 to 256 stops `[[height, "#rrggbb"], ...]`.
        ramp: Stated<RampChoice> = key::ramp(), default "atlas";
        /// Contour lines.
        contours: Option<ContourTable> = table_key::table::<ContourTable>(), otherwise "no contour lines";
        /// Rock drawing: strokes down the slopes of steep ground and lines along its upper edges and ridges, thinner toward the
        /// light (Geisthövel and Hurni 2018), on views straight from above.
        rock: Option<RockTable> = table_key::table::<RockTable>(), otherwise "no rock drawing, but with `preset = \"swiss\"`";
        /// How many summits, saddles and lakes without a label show their elevation, the most prominent first. Of a model of which
        /// pictures show means, hills smaller than these are missed; the elevation of those that are found is the file's.
        spot_heights: u32 = key::integer(0, 1000), default 0;
        /// A picture of the ground over the colors by height, such as an aerial photograph.
        imagery: Option<ImageryTable> = table_key::table::<ImageryTable>(), otherwise "no picture";
        /// Whether the ground looks like ground: woods, fields, meadow, scree, rock and snow, inferred from the place's climate and
        /// from elevation, slope, aspect and hollows, tint it by at most 12 of lightness and give it texture, with plots of fields
        /// that are symbols, and near by with forms too small for the model's cells; its shade is filled by the sky. Heights stay as
        /// they are. `new` switches it on.
        land_cover: Stated<bool> = key::switch(), default false;
        /// Whether the edges of the drawn triangles of the ground show, as papers on terrain print their meshes.
        wireframe: bool = key::switch(), default false;
        /// Where the light comes from.
        light: LightTable = table_key::table::<LightTable>(), default {};
        /// Distance from the near edge of the scene at which 63 % of what is seen is haze, which begins at a quarter of it; 0
        /// for clear air. Fitted to the view where it is not stated: faint in an overview, more where the horizon shows, none in plan.
        haze: Option<f64> = key::number(Within(0.0, 1e9), "m"),
            otherwise "fitted to the view";
        /// What the block stands on, with its shadow and coordinates along its near edges, in a picture that shows its
        /// edge from outside and no horizon.
        table: Stated<TableTop> = key::word::<TableTop>(), default "paper";
    }

    /// `[style.contours]`.
    struct ContourTable {
        /// Height between lines.
        interval: f64 = key::number(Within(0.01, 100_000.0), "m"), required;
        /// One in this many lines is drawn heavier.
        major_every: u32 = key::integer(1, 1000), default 5;
        /// Color of the lines.
        color: Option<Color> = key::color(), otherwise "a translucent brown";
        /// How the lines show the light. Whatever it is, those between the heavier ones fade where they would run together on
        /// steep ground, and the heavier ones stay.
        look: ContourLook = key::word::<ContourLook>(), default "plain";
    }

    /// `[style.rock]`: rock drawing by hachures.
    struct RockTable {
        /// Ground at least so steep is rock. Cells of tens of meters are less steep than the cliffs in them.
        slope: f64 = key::number(Within(10.0, 80.0), "°"), default 38;
    }

    /// `[style.imagery]`.
    struct ImageryTable {
        /// GeoTIFF in 8-bit colors, or a PNG or JPEG with its world file (`.pgw`, `.jgw`, `.wld`) beside it. Beyond it, and
        /// where it is transparent or without data, the colors by height show.
        file: Stated<String> = key::file(), required;
        /// Its coordinate system where the file and a `.prj` beside it name none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "what the file names";
        /// Whether the relief is shaded over it, or its colors are shown as they are.
        shade: bool = key::switch(), default true;
    }

    /// `[style.light]`.
    struct LightTable {
        /// Direction of the sun.
        azimuth: Option<f64> = key::number(Bounds::DIRECTION, "°"),
            otherwise "the left of the picture, the upper left in a view from above: hills lit from below look like holes";
        /// Height of the sun above the horizon.
        altitude: Option<f64> = key::number(Above(0.0, 90.0), "°"), otherwise "40";
        /// Date and time, such as "2026-06-21T09:30:00+02:00": the sun stands where it stood over the middle of the
        /// scene then.
        time: Option<Stated<String>> = key::filled_text(), otherwise "the sun of `azimuth` and `altitude`";
        /// How strongly texture shading shows: crests at all scales are lighter and drainage is darker, by up to half at 1,
        /// from whatever side the light comes, and shading by light is eased. About 0.6 brings out forms along the light.
        texture: f64 = key::number(Within(0.0, 1.0), ""), default 0;
    }

    /// `[[label]]`.
    struct LabelTable {
        /// The text; `{height}` becomes the ground's elevation in whole meters. With `file`: an expression, such as `name`;
        /// in its result `{property}` becomes the value of that property, as in `'{name} {ele} m'`.
        text: Stated<String> = key::filled_text(), required;
        /// The place that it names.
        at: Option<Stated<Position>> = key::point(), otherwise "by `file`";
        /// Instead of `at`: a vector file whose features are labeled: points where they are; lines along their course, each
        /// name again at a distance; polygons across their area. Where a name is too long for that, or with `height`, it
        /// stands at the middle of the longest line, or at a point inside.
        file: Option<Stated<String>> = key::file(), otherwise "by `at`";
        /// With `file`: the layer of a file that holds several.
        layer: Option<Stated<String>> = key::filled_text(), otherwise "the file's only layer";
        /// With `file`: the features that are labeled, as in other tables.
        selection as "where": Option<Stated<Selection>> = key::selection(), otherwise "all features";
        /// Coordinate system of `at`, or of a file that names none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`, or what the file names";
        /// Of a table (CSV, spreadsheet) as `file`, the columns by what they hold: `position`, `lon`, `lat`, `x`, `y`, `zone`, `z` or
        /// `shape`, or the name of a property.
        columns: Option<Stated<BTreeMap<String, String>>> = key::named_texts(), otherwise "by the names of the columns";
        /// The lower, the more important: labels that find no free place beside more important ones are left out. Features
        /// for which an expression gives no number come last. With `file` and `kind = "summit"`, expressions may read
        /// `prominence`: how far the model's summit there stands above the saddle to higher ground, in meters, and 0 where the
        /// model has no summit; `rank = "-prominence"` puts the most prominent first.
        rank: DefaultedValue<f64> = key::feature_number(Within(-1e9, 1e9), ""), default 0;
        /// With `file`: how many features are labeled at most, the most important first; of those with the same rank the
        /// longer or larger, then the earlier in the file.
        most: u32 = key::integer(1, 4096), default 1000;
        /// How large the letters are, of the usual size of the `kind`: a city above a village, by an expression over `place` or
        /// `population`. The nearest size of one scale is taken, whose steps differ by 15 %.
        size: DefaultedValue<f64> = key::feature_number(Within(0.5, 3.0), ""), default 1;
        /// With `file`: the number of a road, in a level shield of this class on its line, again at a distance. Of a text with
        /// several numbers between semicolons the first is taken.
        shield: Option<FeatureValue<RoadShield>> = key::feature_word::<RoadShield>(), otherwise "no shield";
        /// Height above the ground at which the leader line starts.
        height: f64 = key::number(Within(0.0, 1e7), "m"), default 0;
        /// What the label names.
        kind: LabelKind = key::word::<LabelKind>(), default "place";
    }
    check(reader) {
        reader.exclude("file", "at");
        reader.need_either("at", "file", "add `at = [x, y]`, or `file = \"name.geojson\"` for a label a feature");
        if reader.key_span("file").is_some() {
            reader.need_expression("text");
        } else {
            reader.without_effect(&["layer", "where", "columns", "most", "shield"], "on a label without a `file`", "name a `file`, or remove it");
        }
    }

    /// `[[flight]]`: a path through the scene that `sandtable fly` follows, a picture for each frame.
    struct FlightTable {
        /// Name for `--flight`; no two flights share one.
        name: Stated<String> = key::filled_text(), required;
        /// The path; of a file's lines the longest.
        source: FeatureSource = table_key::source::<2>(), inline;
        /// Height of the eye above the highest ground around it. Bends are rounded over twice as much.
        height: f64 = key::number(Above(0.0, 1e6), "m"), default 300;
        /// How fast the eye moves.
        speed: Option<f64> = key::number(Above(0.0, 1e6), "m/s"), otherwise "as fast as takes 20 seconds";
        /// How far the eye looks down from the horizon.
        pitch: f64 = key::number(Within(-60.0, 89.0), "°"), default 20;
        /// Place on the ground that the eye looks at all the way.
        look_at: Option<Stated<Position>> = key::point(), otherwise "ahead, along the path";
        /// Vertical field of view.
        field_of_view: f64 = key::number(Within(1.0, 170.0), "°"), default 45;
    }
    check(reader) {
        if reader.key_span("look_at").is_some() {
            reader.without_effect(&["pitch"], "on a flight with `look_at`", "remove one of the two");
        }
    }

    /// `[[phase]]`: a time of which the scene has a picture. Every table of features may have the key `phases`.
    struct PhaseTable {
        /// Name for `--phase`; no two phases share one.
        name: Stated<String> = key::filled_text(), required;
        /// Second line under the picture's title.
        title: Option<String> = key::text(), otherwise "the scene's `subtitle`";
    }

    /// `[[camera]]`: an eye and what it looks at, or, without them, a view that fills the picture.
    struct CameraTable {
        /// Name for `--camera`; no two cameras share one.
        name: Stated<String> = key::filled_text(), required;
        /// How the ground is drawn. `plan`, `orthographic` and `oblique` have one scale everywhere, and no eye.
        projection: CameraProjection = key::word::<CameraProjection>(), default "perspective";
        /// Of a camera with one scale: `n` of the map scale 1:n, with the middle of what it `shows` in the
        /// picture's middle.
        scale: Option<f64> = key::number(Within(1.0, 1e9), ""),
            otherwise "as large as what it shows fits the picture, `n` rounded up to two figures";
        /// Pixels per inch of the print on which `scale` is true, and of `paper`; 96 is that of screens.
        dpi: Option<f64> = key::number(Within(10.0, 10_000.0), "per inch"), otherwise "96, and 150 on `paper`";
        /// The paper that the picture fills at `dpi`, unless the command line states a size in pixels.
        paper: Option<PaperName> = key::word::<PaperName>(),
            otherwise "none: 1920 × 1080 px; with one scale that nothing states, as many in the shape of what it shows, from 1:2 to 2:1; of a panorama 16 px a degree, as high as its relief needs";
        /// Whether the paper stands upright.
        portrait: bool = key::switch(), default false;
        /// Place of the eye.
        eye: Option<Stated<Position>> = key::point(), otherwise "where the ground fills the picture";
        /// Height of the eye above the ground.
        eye_height: f64 = key::number(Within(0.0, 1e7), "m"), default 2;
        /// Elevation of the eye, instead of `eye_height`.
        eye_elevation: Option<f64> = key::number(Bounds::ELEVATION, "m"), otherwise "by `eye_height`";
        /// Place on the ground that the camera looks at.
        look_at: Option<Stated<Position>> = key::point(), otherwise "by `azimuth` and `pitch`";
        /// Height above that place that it looks at.
        look_at_height: f64 = key::number(Bounds::ELEVATION, "m"), default 0;
        /// Coordinate system of `eye` and `look_at`.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`";
        /// Of a panorama: the azimuth of its left border, clockwise from north.
        from: Option<f64> = key::number(Within(-360.0, 360.0), "°"), otherwise "180: north is in the middle";
        /// Of a panorama: the azimuth of its right border, at least 10° from the left one.
        to: Option<f64> = key::number(Within(-360.0, 360.0), "°"), otherwise "the whole circle";
        /// Of a camera without an eye: where it looks, clockwise from north; the upper border of a plan.
        azimuth: Option<f64> = key::number(Within(-360.0, 360.0), "°"),
            otherwise "0; of one in perspective up to 45° from it where that fills the picture better";
        /// Of a camera without an eye: how far it looks down from the horizon.
        pitch: Option<f64> = key::number(Within(5.0, 89.0), "°"), otherwise "what fills the picture best, from 40 to 50; 45 of an orthographic one";
        /// Of a camera without an eye: points around what it shows, such as two corners of a map.
        shows: Option<Stated<Vec<Position>>> = key::points(2), otherwise "the whole ground";
        /// Vertical field of view; 40 is about that of a normal lens held upright, 28 that of a portrait lens.
        field_of_view: Option<f64> = key::number(Within(1.0, 170.0), "°"), otherwise "40 with an eye, 28 without";
    }
    check(reader) {
        let projection = projection.unwrap_or_default();
        if projection == CameraProjection::Perspective {
            let help = "set `projection` to plan, orthographic or oblique, or remove it";
            reader.without_effect(&["scale"], "in perspective, which has no single scale", help);
            if reader.key_span("paper").is_none() {
                reader.without_effect(&["dpi"], "in perspective without `paper`", help);
            }
        } else if projection == CameraProjection::Panorama {
            check_panorama(reader, [from.flatten(), to.flatten()]);
        } else {
            let keys = ["eye", "eye_height", "eye_elevation", "look_at", "look_at_height", "field_of_view"];
            let help = "state what it `shows`, or set `projection = \"perspective\"`";
            reader.without_effect(&keys, "on a camera that is not in perspective", help);
            if projection != CameraProjection::Orthographic {
                let help = "set `projection = \"orthographic\"`, or remove it";
                reader.without_effect(&["pitch"], "on a plan or an oblique picture", help);
            }
        }
        if projection != CameraProjection::Panorama {
            let help = "set `projection = \"panorama\"`, or remove it";
            reader.without_effect(&["from", "to"], "on a camera that is no panorama", help);
        }
        if reader.key_span("paper").is_none() {
            reader.without_effect(&["portrait"], "without `paper`", "set `paper`, or remove it");
        }
        let sides_mm = paper.flatten().map(paper_mm).unwrap_or_default();
        let longest_px = sides_mm[0] / 25.4 * dpi.flatten().unwrap_or(PAPER_DPI);
        if let Some(span) = reader.key_span("dpi").filter(|_| longest_px > 16_384.0) {
            let message = format!("the picture would be {longest_px:.0} pixels long, and may be 16384");
            reader.error(span, message, "lower `dpi`, or take smaller `paper`");
        }
        if projection == CameraProjection::Perspective {
            check_eye(reader);
        }
    }

    /// `[furniture]`: what frames the picture.
    #[derive(PartialEq)]
    struct FurnitureTable {
        /// Whether the picture has its title and subtitle.
        title: bool = key::switch(), default true;
        /// Whether the picture has a north arrow.
        north_arrow: bool = key::switch(), default true;
        /// Whether the picture has a scale bar.
        scale_bar: bool = key::switch(), default true;
        /// Whether the picture has the elevation legend.
        legend: bool = key::switch(), default true;
        /// What stands on the picture, and what round it. The picture of a layout with a margin is as much smaller.
        layout: SheetLayout = key::word::<SheetLayout>(), default "compact";
        /// Whether there is a legend of the roads, waters, areas, buildings, models, graphics and military symbols that the picture shows.
        classes: Option<bool> = key::switch(), otherwise "in layouts with a margin";
        /// The classification, above and below all else.
        classification: Option<String> = key::filled_text(), otherwise "none";
        /// The day of the information, such as "2026-06-21"; magnetic north is that of this day.
        date: Option<Stated<String>> = key::filled_text(), otherwise "none, and no magnetic north";
        /// Where the data come from, a line each, in a layout with a margin.
        sources: Option<Vec<String>> = key::text_list(), otherwise "none";
        /// Lines of text under the sources.
        notes: Option<Vec<String>> = key::text_list(), otherwise "none";
        /// The coordinate grid: lines on the ground, numbered where they leave the picture and along the block's edge.
        grid: Option<GridName> = key::word::<GridName>(), otherwise "none; mgrs with `preset = \"military\"`, geographic with `preset = \"atlas\"`";
        /// Distance between its lines: meters, or minutes of arc of a geographic grid; more where that would be above 400
        /// lines. One line in 10, 5 or 2 is drawn heavier.
        grid_interval: Option<f64> = key::number(Above(0.0, 1e7), ""),
            otherwise "a round one, for lines about 100 px apart in the middle of a picture 1080 px high";
    }
    check(reader) {
        if grid.flatten() == Some(GridName::None) {
            let help = "set `grid` to metric, utm, mgrs or geographic, or remove it";
            reader.without_effect(&["grid_interval"], "without a `grid`", help);
        }
        let layout = layout.unwrap_or_default();
        if !matches!(layout, SheetLayout::Margin | SheetLayout::Military) {
            let help = "set `layout` to margin or military, or remove it";
            reader.without_effect(&["date", "sources", "notes"], "in a layout without a margin", help);
        }
        if layout != SheetLayout::Military {
            let help = "set `layout = \"military\"`, or remove it";
            reader.without_effect(&["classification"], "in another layout than military", help);
        }
    }
}

/// Pixels per inch on paper where none are stated: fine enough for its lines, and a page is drawn in a second.
pub const PAPER_DPI: f64 = 150.0;

/// The longer and the shorter side of a paper in millimeters.
pub fn paper_mm(paper: PaperName) -> [f64; 2] {
    match paper {
        PaperName::A4 => [297.0, 210.0],
        PaperName::A3 => [420.0, 297.0],
        PaperName::A2 => [594.0, 420.0],
        PaperName::A1 => [841.0, 594.0],
        PaperName::A0 => [1189.0, 841.0],
    }
}

impl LabelTable {
    /// The features that it labels; `None` for a label at one place.
    pub fn source(&self) -> Option<FeatureSource> {
        FeatureSource::of_file(&self.file, &self.layer, &self.selection, &self.crs, &self.columns)
    }
}

impl Document {
    /// The keys outside tables, and the tables with their keys.
    pub const DECLARATIONS: &'static [KeyDeclaration] = <Self as Table>::KEYS;

    /// The title of the phase that the scene is read for.
    pub fn phase_title(&self) -> Option<&str> {
        let is_chosen = |phase: &&PhaseTable| Some(phase.name.as_str()) == self.phase.as_deref();
        self.phases.iter().find(is_chosen)?.title.as_deref()
    }

    /// An error about a value; `cause` is an error or a sentence.
    pub fn error<T>(&self, value: &Stated<T>, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Diagnostic {
        self.error_at(value.span().unwrap_or_default(), cause)
    }

    /// An error about the bytes `span` of the scene file; `cause` is an error or a sentence.
    pub fn error_at(&self, span: Range<usize>, cause: impl Into<Box<dyn Error + Send + Sync>>) -> Diagnostic {
        Diagnostic::new(&self.source, span, cause)
    }
}

/// Reports keys of a camera in perspective that do not go together.
fn check_eye(reader: &mut TableReader<'_, '_>) {
    check_eye_height(reader);
    for (stated, missing) in [("eye", "look_at"), ("look_at", "eye")] {
        if let (Some(span), None) = (reader.value_span(stated), reader.value_span(missing)) {
            let help = "state both, or neither for a view that fills the picture";
            reader.error(span, format!("the camera has `{stated}` without `{missing}`"), help);
        }
    }
    if reader.value_span("eye").is_some() {
        for key in ["azimuth", "pitch", "shows"] {
            if let Some(span) = reader.key_span(key) {
                let message = format!("`{key}` has no effect on a camera with an `eye`");
                reader.coded(
                    FindingCode::NoEffect,
                    span,
                    message,
                    "remove it, or remove `eye` and `look_at`",
                );
            }
        }
    } else {
        for key in ["eye_height", "eye_elevation", "look_at_height"] {
            if let Some(span) = reader.key_span(key) {
                let message = format!("`{key}` has no effect on a camera without an `eye`");
                reader.coded(FindingCode::NoEffect, span, message, "state `eye` and `look_at`, or remove it");
            }
        }
    }
}

/// Reports things of one kind with the name of an earlier one.
fn check_names<'a>(
    reader: &mut TableReader<'_, '_>,
    kind: &str,
    names: impl IntoIterator<Item = &'a Stated<String>>,
) {
    let (source, mut seen) = (reader.source(), BTreeMap::new());
    for name in names {
        let span = name.span().unwrap_or_default();
        let first = *seen.entry(name.as_str()).or_insert(span.start);
        if first == span.start {
            continue;
        }
        let (line, file) = (source.line_column(first).line, source.name_at(first));
        let other = if file == source.name_at(span.start) { String::new() } else { format!(" of {file}") };
        let message = format!("the {kind} on line {line}{other} already has this name");
        reader.coded(
            FindingCode::DuplicateName,
            span,
            message,
            format!("give each {kind} a name of its own"),
        );
    }
}
