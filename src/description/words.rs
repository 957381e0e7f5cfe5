//! The words that a key may take, one enum a key.
//!
//! To add a word, add a variant with its documentation and its spelling: the decoder, the schema, the reference page
//! and the messages read it from here.

use crate::feature_value::{FromScalar, word_of_scalar};
use crate::scalar::Scalar;
use sandtable_base::message::choice::{Choice, ChoiceWord, word};

/// A word and its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordDeclaration {
    /// The word as a scene file writes it.
    pub word: &'static str,
    /// Its meaning.
    pub doc: &'static str,
}

/// The words of a key of type `W`, in the order in which messages list them.
pub fn declarations<W: Choice>() -> Vec<WordDeclaration> {
    W::CHOICES.iter().map(|choice| WordDeclaration { word: choice.word, doc: choice.meaning }).collect()
}

/// Declares enums of words: `Variant = "word": "what it means"`. The first is the default.
macro_rules! words {
    ($(
        $(#[doc = $enum_doc:literal])+
        enum $name:ident { $($variant:ident = $word:literal: $doc:literal,)+ }
    )+) => {$(
        $(#[doc = $enum_doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name {
            $(#[doc = concat!("`", $word, "`: ", $doc)] $variant,)+
        }

        impl Default for $name {
            fn default() -> Self {
                Self::CHOICES[0].value
            }
        }

        impl Choice for $name {
            const CHOICES: &'static [ChoiceWord<Self>] = &[$(word(Self::$variant, $word, $doc)),+];
        }

        impl FromScalar for $name {
            type Limits = ();

            fn from_scalar(scalar: &Scalar, (): ()) -> Option<Self> {
                word_of_scalar(scalar)
            }
        }
    )+};
}

words! {
    /// The paving of a road.
    enum RoadSurface {
        Asphalt = "asphalt": "paved",
        Gravel = "gravel": "a made road without a seal",
        Track = "track": "worn, not made",
    }

    /// How the height of a model is found.
    enum Clamp {
        Ground = "ground": "its lowest point stands on the ground; of a built-in model, its origin",
        Relative = "relative": "its origin is `height` above the ground",
        Absolute = "absolute": "its origin is at elevation `height`",
    }

    /// What a picture shows of an analysis.
    enum AnalysisDraw {
        All = "all": "tints and hatching of its classes, its lines, areas and marks",
        Tints = "tints": "the same without hatching",
        Hatching = "hatching": "the same without tints, to lie over another analysis",
        Features = "features": "its lines, areas and marks",
        Nothing = "nothing": "nothing but its tables beside a picture with a margin",
    }

    /// A vehicle whose numbers are built in, or people on foot.
    enum BuiltInVehicle {
        Wheeled = "wheeled": "an armored personnel carrier on wheels",
        Foot = "foot": "people on foot",
        Tracked = "tracked": "a battle tank",
        Truck = "truck": "an off-road truck",
    }

    /// What a label names; decides its type and its symbol.
    enum LabelKind {
        Summit = "summit": "a summit",
        Place = "place": "a town or a farm",
        Water = "water": "a river or a lake",
        Road = "road": "a road; its name stands along it",
        Area = "area": "a forest, a parish, a range of hills; its name is spread across it",
        Point = "point": "anything else",
    }

    /// The road that a number in a shield is of, which decides its colors.
    enum RoadShield {
        Motorway = "motorway": "white on blue",
        National = "national": "white on red",
        Regional = "regional": "black on yellow",
        Local = "local": "black on white",
    }

    /// A built-in color ramp from the lowest to the highest ground, lighter with height all the way.
    enum RampName {
        Atlas = "atlas": "the lowland's tint by the climate of the place (green, olive, sand, gray green) over yellow to pale brown, and white above the snow line of the latitude",
        Desert = "desert": "red rock under sand",
        Gray = "gray": "dark to light",
        Viridis = "viridis": "blue over green to yellow in steps that look equal",
        Cividis = "cividis": "the same in blue and yellow, for eyes that tell no red from green",
    }

    /// How contour lines show the light.
    enum ContourLook {
        Plain = "plain": "lines of one color",
        Illuminated = "illuminated": "light on slopes toward the light and dark on those away from it, wider the more they face it or turn from it: the ground looks like a stack of boards (Tanaka 1950); it needs a ground of middle tones",
    }

    /// How a camera draws the ground.
    enum CameraProjection {
        Perspective = "perspective": "as an eye sees it: what is far is small",
        Plan = "plan": "straight from above, as a map, with `azimuth` up; one scale, and heights do not show",
        Orthographic = "orthographic": "by parallel rays along `azimuth` and `pitch`: one scale across the view",
        Oblique = "oblique": "the ground as in plan, and heights straight up at the same scale (a military oblique)",
        Panorama = "panorama": "on a cylinder around the `eye`, with the names of the peaks in sight and a scale of azimuths",
    }

    /// What the block of terrain stands on where its edge is in view from outside.
    enum TableTop {
        Paper = "paper": "white paper that ends in the backdrop",
        Wood = "wood": "boards of light wood",
        Ground = "ground": "plain ground, the color of dry clay",
        None = "none": "nothing; no coordinates are written along its edge",
    }

    /// A look in one word: defaults of other keys, and for print and night a look of the finished picture.
    enum StylePreset {
        Topographic = "topographic": "tints by height, contour lines, clear air",
        Relief = "relief": "shaded relief in grays, without lines",
        Satellite = "satellite": "the ground's natural cover, or `imagery`, without lines",
        Military = "military": "pale tints, light shade, contour lines, the military grid, clear air",
        Print = "print": "black on white, patterns in place of colors",
        Night = "night": "red light",
        Swiss = "swiss": "pale tints that grow lighter and warmer with height, contour lines, rock drawing on views from above, clear air",
        Atlas = "atlas": "layers of tints between round heights, their edges as fine lines, light shade, clear air, the graticule",
        Clay = "clay": "a model of one pale material, without tints or lines",
    }

    /// What stands on the picture, and what round it.
    enum SheetLayout {
        Compact = "compact": "furniture in the corners of the picture",
        None = "none": "nothing but labels and the grid",
        Margin = "margin": "the picture in a frame, furniture on the white margin, with a locator",
        Military = "military": "the same with the classification and the three norths",
    }

    /// A size of paper (ISO 216).
    enum PaperName {
        A4 = "A4": "297 × 210 mm",
        A3 = "A3": "420 × 297 mm",
        A2 = "A2": "594 × 420 mm",
        A1 = "A1": "841 × 594 mm",
        A0 = "A0": "1189 × 841 mm",
    }

    /// The lines of a coordinate grid on the ground.
    enum GridName {
        None = "none": "no lines; the block's edge has coordinates of the scene's system",
        Metric = "metric": "the scene's own coordinate system",
        Utm = "utm": "UTM on WGS 84, zone by zone, and UPS round the poles",
        Mgrs = "mgrs": "the same lines, with the letters of the 100 km squares of the military grid",
        Geographic = "geographic": "longitude and latitude on WGS 84",
    }

    /// How the colors of a PNG encode heights.
    enum HeightEncodingWord {
        TerrainRgb = "terrain-rgb": "Mapbox Terrain-RGB",
        Terrarium = "terrarium": "Mapzen Terrarium",
    }

    /// The unit of elevations.
    enum VerticalUnitWord {
        Meters = "m": "meters",
        Feet = "ft": "international feet of 0.3048 m",
        SurveyFeet = "us-ft": "US survey feet of 1200/3937 m",
    }

    /// How two segments of a road meet.
    enum Join {
        Miter = "miter": "both edges run on until they meet",
        Bevel = "bevel": "the outer corner is cut off",
        Round = "round": "the outer corner is an arc",
    }

    /// The lines on asphalt.
    enum Markings {
        Dashed = "dashed": "edge lines and a dashed center line",
        Solid = "solid": "edge lines and a solid center line",
        Edges = "edges": "edge lines only",
        None = "none": "no lines",
    }

    /// Which of road and ground follows the other.
    enum ProfileMode {
        Drape = "drape": "the road follows the ground",
        Conform = "conform": "the ground follows the road",
        Own = "own": "the ground follows the road at the elevations of its file; without these as `conform`",
    }

    /// Where a river's water lies.
    enum Water {
        Falls = "falls": "its level never rises downstream, and the ground is cut to it; it is white where it falls by more than 4 %, and bars lie in its bends on level ground",
        Drape = "drape": "on the ground as it is",
    }

    /// What the polygons of a coast hold.
    enum CoastInside {
        Sea = "sea": "the area inside of polygons is sea, such as osmdata's `water_polygons`, and the rest is land",
        Land = "land": "the area inside of polygons is land, such as osmdata's `land_polygons`, and the rest is sea",
    }

    /// Which height of the ground along its shore is a lake's level.
    enum LevelRule {
        Lowest = "lowest": "the lowest",
        Median = "median": "the median",
        Mean = "mean": "the mean",
    }

    /// What covers an area.
    enum Cover {
        Forest = "forest": "trees",
        Scrub = "scrub": "bushes",
        Meadow = "meadow": "grass",
        Field = "field": "crops in rows",
        Orchard = "orchard": "fruit trees in rows",
        Vineyard = "vineyard": "vines in rows",
        Heath = "heath": "heather",
        Wetland = "wetland": "marsh",
        Sand = "sand": "sand or beach",
        Rock = "rock": "bare rock",
        Scree = "scree": "loose stones",
        Glacier = "glacier": "ice",
        Quarry = "quarry": "a pit with benches",
        Paved = "paved": "squares and yards without houses",
        BuiltUp = "built-up": "houses and yards",
        DenseBuiltUp = "dense-built-up": "houses wall to wall, streets and courts",
        Industry = "industry": "halls and yards",
        Restricted = "restricted": "closed ground, hatched",
    }

    /// The line along an area's outline.
    enum Border {
        None = "none": "no line",
        Solid = "solid": "an unbroken line",
        Dashed = "dashed": "dashes",
    }

    /// The height of the ground under its footprint at which a building stands.
    enum BaseRule {
        Lowest = "lowest": "the lowest",
        Mean = "mean": "the mean",
        Highest = "highest": "the highest",
        Pad = "pad": "the mean, to which the ground is leveled",
        Own = "own": "none: the heights of its file, as CityJSON has them",
    }

    /// The shape of a roof.
    enum RoofShape {
        Flat = "flat": "level",
        Gabled = "gabled": "two slopes and two gables",
        Hipped = "hipped": "four slopes",
        Pyramidal = "pyramidal": "slopes that meet in one point",
        Skillion = "skillion": "one slope",
        HalfHipped = "half-hipped": "two slopes, and gables that end in small hips",
        Gambrel = "gambrel": "two slopes on each side, the lower the steeper, and two gables",
        Saltbox = "saltbox": "a long slope and a short one, and two gables",
        Mansard = "mansard": "four slopes, each steeper below",
        Round = "round": "half a barrel",
        Dome = "dome": "half a ball",
    }

    /// The shape of an earthwork.
    enum EarthworkKind {
        Crater = "crater": "a bowl with a raised rim",
        Trench = "trench": "a ditch along a line",
        Track = "track": "the two ruts of a vehicle",
        Level = "level": "level ground within an outline, with batters",
        Raise = "raise": "raised ground: a bank along a line, a mound at a point",
    }

    /// What stands or runs along a line.
    enum FenceKind {
        Fence = "fence": "posts and rails",
        Wall = "wall": "masonry",
        Hedge = "hedge": "a row of bushes",
        PowerLine = "power-line": "pylons and sagging wires",
        Trench = "trench": "a trench with a parapet",
        Obstacles = "obstacles": "a belt of obstacles",
        Boundary = "boundary": "a dashed line on the ground",
    }

    /// The height of the ground that a model stands on.
    enum Anchor {
        Origin = "origin": "that under its origin",
        Lowest = "lowest": "the lowest under its footprint",
        Highest = "highest": "the highest under its footprint",
        Mean = "mean": "the mean under its footprint",
    }

    /// What fills the gap between a model and the ground.
    enum Footing {
        None = "none": "nothing",
        Plinth = "plinth": "a block down to the ground",
        Pad = "pad": "the ground is leveled",
    }

    /// Whose a tactical graphic is.
    enum GraphicSide {
        Friend = "friend": "one's own, in blue",
        Hostile = "hostile": "the enemy's, in red",
        Neutral = "neutral": "a third side's, in green",
        Unknown = "unknown": "nobody knows, in yellow",
    }

    /// Whether a tactical graphic is there.
    enum GraphicStatus {
        Present = "present": "there, in solid lines",
        Planned = "planned": "planned, anticipated or suspected, in dashes",
    }

    /// In which order the points of an axis or arrow are.
    enum GraphicOrder {
        Standard = "standard": "by the draw rule of the standard, from its tip",
        Drawn = "drawn": "as a person draws it, from start to tip",
    }

    /// Which ground a viewshed tints.
    enum ViewshedTint {
        Both = "both": "seen ground green, hidden ground dark",
        Seen = "seen": "seen ground alone, green",
        Hidden = "hidden": "hidden ground alone, dark",
    }

    /// Which ground within a range is filled.
    enum RangeExtent {
        None = "none": "none",
        All = "all": "all of it",
        Seen = "seen": "what is in sight",
    }
}
