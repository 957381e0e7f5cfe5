//! Kinds about water.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// What no kind of water knows.
const LIMITS: &[&str] = &[
    "Water flows over the ground alone, and nothing soaks into it: soil, pipes and sluices are unknown to it.",
    "Below bridges of the scene the ground is cut through, straight from the lowest post within 30 m of the way on one side to that on the other, and along its culverts from the lowest post within 30 m before the start to that after the end; without them an embankment dams its valley. A road that crosses a stream narrower than 3 m without either is taken to have a culvert; a note counts these apart.",
    "Posts beside a hole in the data are outlets, as those at the border are: a hole swallows the water that reaches it.",
    "Flow has eight directions, but for `dinf` of `flow`; level ground and filled depressions drain away from higher and toward lower ground (Barnes, Lehman and Mulla 2014b), which is a guess at the channels in them.",
];

/// What the height above drainage does not know.
const DRAINAGE_HEIGHT_LIMITS: &[&str] = &[
    "Heights are those of filled ground above the filled bed where the water of a post first comes to it; beds are as deep as the elevations show them, which is the water's surface for most.",
    "Land that drains off the border before it comes to a stream has no value.",
    LIMITS[0],
    LIMITS[1],
    LIMITS[2],
    LIMITS[3],
];

/// What a flood does not know.
const FLOOD_LIMITS: &[&str] = &[
    "The water stands level everywhere and for as long as it takes: it has no speed, no slope, no duration and no volume that runs out.",
    "Water that the elevations show counts as ground: depths over it are those over its surface.",
    LIMITS[0],
    LIMITS[1],
];

/// What a dam break does not know.
const DAM_BREAK_LIMITS: &[&str] = &[
    "A first estimate, no simulation: no water is moved, so that there is no wave, no backwater, no flow over a pass into another valley, and no debris.",
    "The peak is a regression over 22 embankment dams that failed, good to a factor of two; a concrete dam fails faster and has a higher peak.",
    "Downstream the peak falls by half over `halving_km`: the default is an assumption on the safe side, not a law; a wide plain halves it within a few kilometers.",
    "Each reach has the normal depth of its mean section, which jumps from one reach to the next; on level beds the slope counts as 0.0001, and arrivals are those of a kinematic wave.",
    "Water that the elevations show counts as ground: behind a full dam state `volume_m3` and `height_m`.",
    "The reservoir is the side of the dam whose water, up to the level, reaches neither the border of the land nor a hole in the data; where that is both sides or none, `reservoir` must say.",
    "The dam's line is extended straight beyond its ends to hold the water; it is sought up to 30 m or a quarter of its length, at most 200 m, to both sides for the lowest ground.",
    LIMITS[0],
    LIMITS[1],
    LIMITS[3],
];

/// The layers that water needs: what lets it through embankments.
const CROSSINGS: &[LandPart] = &[LandPart::Crossings];

/// What is done about depressions.
const DEPRESSIONS: AnalysisParameter = AnalysisParameter::word(
    "depressions",
    &["fill", "breach"],
    "fill",
    "What is done about depressions: they are filled to their lowest rim, or a way out is cut where that takes away least.",
);

/// The greatest depth of a breach.
const BREACH_DEPTH: AnalysisParameter = AnalysisParameter::number(
    "breach_depth_m",
    (0.0, 1000.0),
    "m",
    ParameterDefault::Value("10"),
    "The greatest depth of a cut below the ground; a depression that needs a deeper one is filled.",
);

/// The greatest length of a breach.
const BREACH_LENGTH: AnalysisParameter = AnalysisParameter::number(
    "breach_length_m",
    (1.0, 100_000.0),
    "m",
    ParameterDefault::Value("500"),
    "The greatest distance of a way out from its pit, by column or row, and at most 1000 posts.",
);

/// The least area of a stream.
const STREAM_AREA: AnalysisParameter = AnalysisParameter::number(
    "area_m2",
    (1.0, 1e12),
    "m²",
    ParameterDefault::Value("500000"),
    "The least area that drains through a stream.",
);

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "fill",
        family: AnalysisFamily::Water,
        title: "Depressions",
        summary: "The depressions of the ground: their depth, or the ground with them filled or breached.",
        parameters: &[
            AnalysisParameter::word(
                "show",
                &["depth", "filled"],
                "depth",
                "What the values are: the depth below the rim, below 0 where a way out is cut; or the ground without depressions.",
            ),
            DEPRESSIONS,
            BREACH_DEPTH,
            BREACH_LENGTH,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "Barnes, Lehman and Mulla 2014 (the surface of Priority-Flood); Cordonnier, Bovy and Braun 2019 (by the graph of basins); Lindsay 2016 (breaching)",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "flow",
        family: AnalysisFamily::Water,
        title: "Flow",
        summary: "The area that drains through each post, or the direction in which it drains.",
        parameters: &[
            AnalysisParameter::word(
                "show",
                &["accumulation", "direction"],
                "accumulation",
                "What the values are: the drained area in m², or directions: of `d8` from 1 east counter-clockwise to 8 south-east, 0 off the land; of `dinf` in degrees from the east counter-clockwise.",
            ),
            AnalysisParameter::word(
                "method",
                &["d8", "dinf"],
                "d8",
                "In eight directions, or in any, water between two neighbors going to both.",
            ),
            DEPRESSIONS,
            BREACH_DEPTH,
            BREACH_LENGTH,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "O'Callaghan and Mark 1984 (D8), Tarboton 1997 (D-infinity); Barnes, Lehman and Mulla 2014 (depressions) and 2014b (flats); Lindsay 2016 (breaching)",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "streams",
        family: AnalysisFamily::Water,
        title: "Streams",
        summary: "The ways of water that drain at least an area, as lines with Strahler's order and Shreve's magnitude.",
        parameters: &[
            STREAM_AREA,
            AnalysisParameter::word(
                "order",
                &["strahler", "shreve"],
                "strahler",
                "The order of a stream, which gives its width on pictures: Strahler's, or Shreve's magnitude, the number of sources above it. Both are properties.",
            ),
            DEPRESSIONS,
            BREACH_DEPTH,
            BREACH_LENGTH,
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "O'Callaghan and Mark 1984; Strahler 1957; Shreve 1966; Lindsay 2016 (breaching)",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "basins",
        family: AnalysisFamily::Water,
        title: "Basins",
        summary: "The land that drains through each of several outlets, with a table of their areas.",
        parameters: &[
            AnalysisParameter::plain(
                "pour_points",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Otherwise("where at least `area_m2` drains off the land"),
                "The outlets, at most 250; what drains through one above another is the upper one's.",
            ),
            AnalysisParameter::number(
                "snap_m",
                (0.0, 10_000.0),
                "m",
                ParameterDefault::Value("0"),
                "How far a pour point is moved, to the post that drains most.",
            ),
            AnalysisParameter::number(
                "area_m2",
                (1.0, 1e12),
                "m²",
                ParameterDefault::Value("500000"),
                "The least area of a basin without pour points; the 250 largest are told.",
            ),
            DEPRESSIONS,
            BREACH_DEPTH,
            BREACH_LENGTH,
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "O'Callaghan and Mark 1984; Barnes, Lehman and Mulla 2014 and 2014b",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "drainage-height",
        family: AnalysisFamily::Water,
        title: "Height above drainage",
        summary: "The height of each post above the stream that it drains to.",
        parameters: &[
            STREAM_AREA,
            AnalysisParameter::word(
                "drainage",
                &["streams", "water", "both"],
                "streams",
                "What is drained to: ways of water that drain at least `area_m2`, the scene's rivers, lakes and sea, or both.",
            ),
            AnalysisParameter::numbers(
                "classes",
                (0.01, 1000.0),
                "m",
                ParameterDefault::Value("1,2,5,10,20"),
                "The heights between classes.",
            ),
            DEPRESSIONS,
            BREACH_DEPTH,
            BREACH_LENGTH,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: &[LandPart::Water, LandPart::Crossings],
        source: "Nobre et al. 2011 (HAND)",
        limits: DRAINAGE_HEIGHT_LIMITS,
    },
    AnalysisKind {
        name: "flood",
        family: AnalysisFamily::Water,
        title: "Flood",
        summary: "The ground below a level of water, all of it or what water reaches from a source, with its depth, area and volume.",
        parameters: &[
            AnalysisParameter::number(
                "level_m",
                (-500.0, 9000.0),
                "m",
                ParameterDefault::Required,
                "The level of the water, an elevation.",
            ),
            AnalysisParameter::plain(
                "from",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Otherwise("everywhere below the level, whether water gets there or not"),
                "Where the water comes from: it floods what is joined to these points.",
            ),
            AnalysisParameter::plain(
                "from_line",
                ParameterForm::Line,
                ParameterDefault::Otherwise("no line"),
                "A line that the water comes from, such as a coast or a broken dike.",
            ),
            AnalysisParameter::word(
                "connect",
                &["corners", "sides"],
                "corners",
                "Whether water passes between posts that meet at corners alone; `sides` keeps it behind banks one post wide.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "Poulter and Halpin 2008 (bathtub with the eight-side or the four-side rule)",
        limits: FLOOD_LIMITS,
    },
    AnalysisKind {
        name: "dam-break",
        family: AnalysisFamily::Water,
        title: "Dam break",
        summary: "What a dam that fails would flood, by formulas: its peak discharge, and the depth at which that flows down the valley.",
        parameters: &[
            AnalysisParameter::plain(
                "dam",
                ParameterForm::Line,
                ParameterDefault::Required,
                "The dam, from one side of the valley to the other.",
            ),
            AnalysisParameter::number(
                "level_m",
                (-500.0, 9000.0),
                "m",
                ParameterDefault::Required,
                "The level of the water behind the dam, an elevation.",
            ),
            AnalysisParameter::plain(
                "reservoir",
                ParameterForm::Points { least: 1 },
                ParameterDefault::Otherwise(
                    "the side of the dam where its line and the ground hold water up to the level, while on the other, which begins no higher, it leaves the land",
                ),
                "A point in the water behind the dam. Needed where both sides of the dam hold water up to the level, or neither does.",
            ),
            AnalysisParameter::number(
                "volume_m3",
                (1.0, 1e12),
                "m³",
                ParameterDefault::Otherwise("what the ground behind the dam holds up to the level"),
                "The volume of the water above the bottom of the breach.",
            ),
            AnalysisParameter::number(
                "height_m",
                (0.1, 500.0),
                "m",
                ParameterDefault::Otherwise(
                    "from the level down to the lowest ground beside the dam on its lower side",
                ),
                "The height of the water above the bottom of the breach.",
            ),
            AnalysisParameter::number(
                "way_km",
                (0.1, 500.0),
                "km",
                ParameterDefault::Value("30"),
                "How far down the valley the flood is followed.",
            ),
            AnalysisParameter::number(
                "reach_m",
                (50.0, 10_000.0),
                "m",
                ParameterDefault::Value("500"),
                "The length of the parts of the valley that have a depth each.",
            ),
            AnalysisParameter::number(
                "halving_km",
                (0.5, 1000.0),
                "km",
                ParameterDefault::Value("50"),
                "The way over which the peak discharge falls to its half.",
            ),
            AnalysisParameter::number(
                "roughness",
                (0.01, 0.3),
                "s/m^⅓",
                ParameterDefault::Value("0.06"),
                "Manning's roughness of the valley: 0.03 pasture, 0.06 scrub and fields with hedges, 0.1 woods.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "Froehlich 1995 (peak discharge of embankment dams); Zheng et al. 2018 (sections from heights above drainage, Manning's formula); Nobre et al. 2011",
        limits: DAM_BREAK_LIMITS,
    },
];
