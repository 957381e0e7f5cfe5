//! Kinds about observation and fire over the land.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// Heights above the ground that ends of lines of sight may have, meters.
const ABOVE_M: (f64, f64) = (0.0, 100_000.0);

/// Distances in meters.
const DISTANCE_M: (f64, f64) = (1.0, 10_000_000.0);

const POSTS: AnalysisParameter = AnalysisParameter::plain(
    "posts",
    ParameterForm::Points { least: 1 },
    ParameterDefault::Required,
    "Where the observers stand; they are numbered from 1 in this order.",
);

const OBSERVER_HEIGHT: AnalysisParameter = AnalysisParameter::number(
    "observer_height",
    ABOVE_M,
    "m",
    ParameterDefault::Value("1.7"),
    "The height of the observers' eyes above the ground.",
);

const TARGET_HEIGHT: AnalysisParameter = AnalysisParameter::number(
    "target_height",
    ABOVE_M,
    "m",
    ParameterDefault::Value("0"),
    "The height above the ground of what is looked for; 0 for the ground itself.",
);

const RANGE: AnalysisParameter = AnalysisParameter::number(
    "range",
    DISTANCE_M,
    "m",
    ParameterDefault::Otherwise("as far as the land reaches"),
    "How far an observer sees, in plan.",
);

const REFRACTION: AnalysisParameter = AnalysisParameter::number(
    "refraction",
    (-1.0, 1.0),
    "",
    ParameterDefault::Otherwise("1/7, as surveyors take for visible light"),
    "The share of the Earth's curvature that the air's refraction cancels.",
);

/// What stands in the way of sight.
const LAYERS: &[LandPart] = &[LandPart::Obstacles];

/// How trees and buildings hide, and what all kinds of sight leave out.
const STANDING: &str = "Trees and buildings of a scene hide like ground of their height; a forest without trees of its own counts as \
    15 m high, an orchard as 4 m. Around a post nothing is in its way for 30 m, or to the next elevation posts. Of an elevation \
    file alone nothing of them is known. Weather, leafless trees and gaps between trunks are unknown.";

/// How targets under trees and roofs are seen.
const EDGES: &str = "A place under trees or a roof is seen where open ground within 30 m to its east, north, west or south is, \
    or else at the next elevation post; deeper it is hidden. No manual states a number: this is the program's.";

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "viewsheds",
        family: AnalysisFamily::Observation,
        title: "Viewsheds",
        summary: "The ground that posts see: how many see each place, which one sees it first, or the dead ground to all.",
        parameters: &[
            POSTS,
            OBSERVER_HEIGHT,
            TARGET_HEIGHT,
            RANGE,
            REFRACTION,
            AnalysisParameter::word(
                "show",
                &["count", "first", "dead"],
                "count",
                "What the values are: `count` the number of posts that see a place, `first` the number of the first post in \
                 their order that sees it, 0 for none, `dead` 1 where none sees it and 0 elsewhere.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Between { places: "posts", range: "range" },
        layers: LAYERS,
        source: "Line of sight over the triangles of the ground; cumulative viewshed of Wheatley 1995",
        limits: &[STANDING, EDGES, "Ground beyond the range of every post has no value."],
    },
    AnalysisKind {
        name: "intervisibility",
        family: AnalysisFamily::Observation,
        title: "Intervisibility",
        summary: "Which of these posts see each other, as links and as groups that links connect.",
        parameters: &[
            AnalysisParameter::plain(
                "posts",
                ParameterForm::Points { least: 2 },
                ParameterDefault::Required,
                "Where the posts stand; they are numbered from 1 in this order.",
            ),
            AnalysisParameter::number(
                "height",
                ABOVE_M,
                "m",
                ParameterDefault::Value("1.7"),
                "The height of eyes or antennas above the ground, the same at all posts.",
            ),
            RANGE,
            REFRACTION,
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: LAYERS,
        source: "Line of sight over the triangles of the ground; visibility graph of O'Sullivan and Turner 2001",
        limits: &[
            STANDING,
            "A link of radio may need more clearance than a line of sight, and may do with less.",
        ],
    },
    AnalysisKind {
        name: "best-posts",
        family: AnalysisFamily::Observation,
        title: "Best posts",
        summary: "The posts within an area that together see the most of another area or of the whole land.",
        parameters: &[
            AnalysisParameter::plain(
                "area",
                ParameterForm::Area,
                ParameterDefault::Otherwise("anywhere on the land"),
                "Where posts may stand.",
            ),
            AnalysisParameter::plain(
                "watch",
                ParameterForm::Area,
                ParameterDefault::Otherwise("the whole land"),
                "The ground that they watch.",
            ),
            AnalysisParameter::number(
                "count",
                (1.0, 100.0),
                "",
                ParameterDefault::Value("3"),
                "The number of posts, rounded to a whole one.",
            ),
            AnalysisParameter::number(
                "spacing",
                DISTANCE_M,
                "m",
                ParameterDefault::Value("500"),
                "The distance of the places that are tried, rounded to whole posts of the elevation model.",
            ),
            OBSERVER_HEIGHT,
            TARGET_HEIGHT,
            RANGE,
            REFRACTION,
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: LAYERS,
        source: "Greedy choice: Nemhauser, Wolsey and Fisher 1978",
        limits: &[
            STANDING,
            EDGES,
            "One post after the other is chosen, each as the best beside those before it: together they see at least \
             1 − 1/e, 63 %, of what the best choice among the same places would.",
            "Places between those tried may be better.",
        ],
    },
    AnalysisKind {
        name: "fields-of-fire",
        family: AnalysisFamily::Observation,
        title: "Fields of fire",
        summary: "The ground that weapons hit by direct fire: how many hit each place within their ranges and their sector.",
        parameters: &[
            AnalysisParameter::plain(
                "weapons",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Required,
                "Where the weapons stand; they are numbered from 1 in this order.",
            ),
            AnalysisParameter::number(
                "muzzle_height",
                ABOVE_M,
                "m",
                ParameterDefault::Value("1"),
                "The height of the muzzle above the ground.",
            ),
            AnalysisParameter::number(
                "target_height",
                ABOVE_M,
                "m",
                ParameterDefault::Value("1"),
                "The height of targets above the ground: what shows their top can be hit.",
            ),
            AnalysisParameter::number(
                "min_range",
                (0.0, 10_000_000.0),
                "m",
                ParameterDefault::Value("0"),
                "Nearer ground cannot be hit.",
            ),
            AnalysisParameter::number(
                "max_range",
                DISTANCE_M,
                "m",
                ParameterDefault::Required,
                "Farther ground cannot be hit.",
            ),
            AnalysisParameter::number(
                "clearance",
                ABOVE_M,
                "m",
                ParameterDefault::Value("0"),
                "How far the line of fire must pass above every crest; at most the height of the muzzle and of targets.",
            ),
            AnalysisParameter::number(
                "direction",
                (0.0, 360.0),
                "°",
                ParameterDefault::Value("0"),
                "The middle of the sector, clockwise from grid north.",
            ),
            AnalysisParameter::number(
                "arc",
                (0.1, 360.0),
                "°",
                ParameterDefault::Value("360"),
                "The width of the sector; 360 for all around.",
            ),
            REFRACTION,
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Between { places: "weapons", range: "max_range" },
        layers: LAYERS,
        source: "Line of sight over the triangles of the ground; fields of fire as in FM 34-130",
        limits: &[
            STANDING,
            EDGES,
            "The trajectory is the line of sight: a bullet that rises above it or falls below it may clear a crest or \
             strike one.",
        ],
    },
    AnalysisKind {
        name: "masking",
        family: AnalysisFamily::Observation,
        title: "Masking heights",
        summary: "How high above the ground a target must rise at each place for these radars to see it.",
        parameters: &[
            AnalysisParameter::plain(
                "radars",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Required,
                "Where the radars stand; they are numbered from 1 in this order.",
            ),
            AnalysisParameter::number(
                "radar_height",
                ABOVE_M,
                "m",
                ParameterDefault::Value("10"),
                "The height of their antennas above the ground.",
            ),
            RANGE,
            AnalysisParameter::number(
                "refraction",
                (-1.0, 1.0),
                "",
                ParameterDefault::Value("0.25"),
                "The share of the Earth's curvature that the air's refraction cancels; 1/4 is radar's Earth of 4/3 radius.",
            ),
            AnalysisParameter::word(
                "seen_by",
                &["any", "nearest"],
                "any",
                "Whose sight counts: `any` the radar that sees the lowest, `nearest` the nearest radar alone.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Around { places: "radars", range: "range" },
        layers: LAYERS,
        source: "The rise that clears the line of sight over the triangles of the ground; terrain masking as in FM 34-130",
        limits: &[
            STANDING,
            "Over woods and roofs a target is seen from their tops on.",
            "A radar's power, clutter and lobes are unknown: a target above the masking height may be missed.",
            "The range is measured in plan.",
            "Heights are exact to a centimeter or a ten-thousandth of them, whichever is more; where they are 0 is exact.",
        ],
    },
    AnalysisKind {
        name: "exposure",
        family: AnalysisFamily::Observation,
        title: "Exposure",
        summary: "Which stretches of a route are in sight of posts, with their lengths and times.",
        parameters: &[
            AnalysisParameter::plain(
                "route",
                ParameterForm::Line,
                ParameterDefault::Required,
                "The route, from its start to its end.",
            ),
            POSTS,
            OBSERVER_HEIGHT,
            AnalysisParameter::number(
                "target_height",
                ABOVE_M,
                "m",
                ParameterDefault::Value("1.7"),
                "The height of what moves on the route above the ground.",
            ),
            RANGE,
            REFRACTION,
            AnalysisParameter::number(
                "step",
                (0.1, 100_000.0),
                "m",
                ParameterDefault::Otherwise("half the distance between posts of the elevation model"),
                "The greatest distance of places on the route that are looked at; where two neighbors differ, the change \
                 between them is found to a millionth of their distance.",
            ),
            AnalysisParameter::number(
                "speed",
                (0.1, 1000.0),
                "km/h",
                ParameterDefault::Value("4"),
                "The speed on the route, the same throughout, for the times.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: LAYERS,
        source: "Line of sight over the triangles of the ground, at places along the route",
        limits: &[
            STANDING,
            EDGES,
            "A stretch shorter than `step` may be missed.",
            "The speed does not change with slope and surface.",
        ],
    },
];
