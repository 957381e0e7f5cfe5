//! Kinds about the form of the ground.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield};
use crate::parameter::{AnalysisParameter, ParameterDefault};

/// The two ways of taking a slope from neighbors.
const METHOD: AnalysisParameter = AnalysisParameter::word(
    "method",
    &["horn", "zevenbergen-thorne"],
    "horn",
    "How the slope follows from neighbors: `horn` from eight with weights 1-2-1, `zevenbergen-thorne` from four.",
);

/// What kinds that read a window of 3 × 3 posts do not know.
const BORDER: &str = "Posts at the border, and beside a post without data, have no data.";

/// What all slopes of a lattice do not know.
const COARSE: &str = "Ground between posts may be steeper: coarse elevation models flatten slopes.";

/// The height between contours or bands.
const INTERVAL: AnalysisParameter = AnalysisParameter::number(
    "interval",
    (0.01, 1e6),
    "m",
    ParameterDefault::Otherwise("1, 2 or 5 times a power of ten, for at most 20 intervals"),
    "The height between one line and the next.",
);

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "slope",
        family: AnalysisFamily::Surface,
        title: "Slope",
        summary: "The slope of the ground at each post.",
        parameters: &[
            AnalysisParameter::word("unit", &["percent", "degrees"], "percent", "The unit of the slope."),
            METHOD,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(1),
        layers: &[],
        source: "Horn 1981; Zevenbergen and Thorne 1987; classes of FM 5-33",
        limits: &[COARSE, BORDER],
    },
    AnalysisKind {
        name: "aspect",
        family: AnalysisFamily::Surface,
        title: "Aspect",
        summary: "The azimuth toward which the ground falls at each post, clockwise from the grid's north.",
        parameters: &[METHOD],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(1),
        layers: &[],
        source: "Horn 1981; Zevenbergen and Thorne 1987",
        limits: &[
            "gdaldem aspect rounds sums of heights and differs on nearly level ground.",
            "Level ground has no aspect and no data.",
            BORDER,
        ],
    },
    AnalysisKind {
        name: "hillshade",
        family: AnalysisFamily::Surface,
        title: "Hillshade",
        summary: "How directly the ground faces the sun at each post, from 1 to 255.",
        parameters: &[
            AnalysisParameter::word(
                "light",
                &["sun", "multidirectional"],
                "sun",
                "Where light comes from: `sun` from its azimuth, `multidirectional` from 225°, 270°, 315° and 360°, each \
                 weighted by how nearly the ground falls along it; `azimuth` then has no effect.",
            ),
            AnalysisParameter::number(
                "azimuth",
                (0.0, 360.0),
                "°",
                ParameterDefault::Value("315"),
                "The sun's azimuth, clockwise from the grid's north.",
            ),
            AnalysisParameter::number(
                "altitude",
                (0.0, 90.0),
                "°",
                ParameterDefault::Value("45"),
                "The sun's altitude above the horizon.",
            ),
            AnalysisParameter::number(
                "exaggeration",
                (0.01, 100.0),
                "",
                ParameterDefault::Value("1"),
                "What heights are multiplied with.",
            ),
            METHOD,
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(1),
        layers: &[],
        source: "Horn 1981; Mark 1992 (multidirectional); as gdaldem hillshade",
        limits: &["Ground casts no shadow on other ground.", BORDER],
    },
    AnalysisKind {
        name: "curvature",
        family: AnalysisFamily::Surface,
        title: "Curvature",
        summary: "How the ground bends at each post, positive where it is convex.",
        parameters: &[AnalysisParameter::word(
            "direction",
            &["profile", "plan", "tangential", "mean"],
            "profile",
            "Which curvature: `profile` along the fall line, `plan` of the contour, `tangential` of the section across \
             the fall line, `mean` over all directions.",
        )],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Posts(1),
        layers: &[],
        source: "Evans 1980; Minár, Evans and Jenčo 2020",
        limits: &["Level ground has no direction of fall: all but the mean curvature are 0 there.", BORDER],
    },
    AnalysisKind {
        name: "ruggedness",
        family: AnalysisFamily::Surface,
        title: "Ruggedness",
        summary: "How uneven the ground is around each post.",
        parameters: &[
            AnalysisParameter::word(
                "measure",
                &["tri", "tpi", "vrm", "roughness"],
                "tri",
                "What is measured: `tri` the differences from the eight neighbors, `tpi` the height above the mean of the \
                 square's other posts, `vrm` how far normals differ in direction, from 0 to 1, `roughness` the \
                 difference of the highest post and the lowest.",
            ),
            AnalysisParameter::number(
                "radius",
                (1.0, 200.0),
                "posts",
                ParameterDefault::Value("1"),
                "How far the square around a post reaches to each side, a whole number; `tri` allows 1 alone.",
            ),
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::PostsBy("radius"),
        layers: &[],
        source: "Riley, DeGloria and Elliot 1999 (TRI); Weiss 2001 (TPI); Sappington, Longshore and Thompson 2007 (VRM); \
                 Wilson et al. 2007 (roughness)",
        limits: &[
            "The neighborhood is a square; Weiss's was a ring.",
            "Posts whose square reaches beyond the border, or holds a post without data, have no data.",
        ],
    },
    AnalysisKind {
        name: "geomorphons",
        family: AnalysisFamily::Surface,
        title: "Landforms",
        summary: "Which of ten landforms a post belongs to, by what it sees in eight directions.",
        parameters: &[
            AnalysisParameter::number(
                "radius",
                (2.0, 500.0),
                "posts",
                ParameterDefault::Value("20"),
                "How far a post sees, a whole number of the longer side of a cell; posts that far do not count.",
            ),
            AnalysisParameter::number(
                "skip",
                (0.0, 499.0),
                "posts",
                ParameterDefault::Value("0"),
                "How many posts next to the post do not count, a whole number.",
            ),
            AnalysisParameter::number(
                "flatness",
                (0.0, 45.0),
                "°",
                ParameterDefault::Value("1"),
                "Which slope of a line of sight still counts as level.",
            ),
            AnalysisParameter::word(
                "comparison",
                &["signed", "magnitude"],
                "signed",
                "How rise and fall along a line of sight are compared: `signed`, so that evenly sloping ground is a slope, \
                 or by `magnitude` as r.geomorphon does, where a line of even slope counts as level.",
            ),
        ],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::PostsBy("radius"),
        layers: &[],
        source: "Jasiewicz and Stepinski 2013, as r.geomorphon",
        limits: &[
            "Forms wider than the radius are not seen, and sight ends at the border.",
            "Posts at the border have no data.",
            "r.geomorphon never reads the southernmost row: within the radius of it forms differ, here it counts.",
        ],
    },
    AnalysisKind {
        name: "contours",
        family: AnalysisFamily::Surface,
        title: "Contours",
        summary: "Lines of equal height at the multiples of an interval.",
        parameters: &[
            INTERVAL,
            AnalysisParameter::number(
                "every",
                (1.0, 100.0),
                "lines",
                ParameterDefault::Value("5"),
                "Every which line is an index line with its height; rounded.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Lorensen and Cline 1987, in the plane",
        limits: &[
            "Lines are straight within a cell, and end at the border and at cells with a post without data.",
            "Lines that would cross cells more than 8 million times are an error.",
        ],
    },
    AnalysisKind {
        name: "elevation-bands",
        family: AnalysisFamily::Surface,
        title: "Elevation bands",
        summary: "The band of heights that each post belongs to, by its lower bound.",
        parameters: &[INTERVAL],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Hypsometric tints",
        limits: &["Bands are those of posts: their edges follow cells, not contours.", "At most 250 bands."],
    },
    AnalysisKind {
        name: "peaks",
        family: AnalysisFamily::Surface,
        title: "Peaks",
        summary: "Summits with their prominence and isolation, the most prominent first.",
        parameters: &[
            AnalysisParameter::number(
                "prominence",
                (0.0, 10_000.0),
                "m",
                ParameterDefault::Value("30"),
                "How far a peak rises at least above the highest pass to higher ground.",
            ),
            AnalysisParameter::number(
                "isolation",
                (0.0, 1e7),
                "m",
                ParameterDefault::Value("0"),
                "How far away the nearest higher ground is at least.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Carr, Snoeyink and Axen 2003; Kirmse and de Ferranti 2017",
        limits: &[
            "Ground beyond the border may be higher: prominence and isolation are those within the land.",
            "The highest peak of connected ground has its height above the lowest post as prominence.",
            "Summits at the border or beside a post without data are left out.",
        ],
    },
    AnalysisKind {
        name: "passes",
        family: AnalysisFamily::Surface,
        title: "Passes",
        summary: "The highest ways between summits, the deepest pass first.",
        parameters: &[AnalysisParameter::number(
            "depth",
            (0.0, 10_000.0),
            "m",
            ParameterDefault::Value("30"),
            "How far the lower of the two summits rises at least above the pass.",
        )],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Carr, Snoeyink and Axen 2003; Kirmse and de Ferranti 2017",
        limits: &[
            "A pass to summits beyond the border is not known.",
            "Passes at the border or beside a post without data are left out.",
        ],
    },
    AnalysisKind {
        name: "form-lines",
        family: AnalysisFamily::Surface,
        title: "Ridge and valley lines",
        summary: "Lines of steepest slope from passes: up along ridges to summits, and down valleys.",
        parameters: &[
            AnalysisParameter::word("form", &["both", "ridges", "valleys"], "both", "Which lines are drawn."),
            AnalysisParameter::number(
                "depth",
                (0.0, 10_000.0),
                "m",
                ParameterDefault::Value("30"),
                "How far the lower of the two summits beside a pass rises at least above it.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Maxwell 1870, On hills and dales; passes as Carr, Snoeyink and Axen 2003",
        limits: &[
            "Spurs and side valleys without a pass at their head have no line.",
            "Valley lines end in the first depression: fill depressions before, where they are errors of the model.",
            "Lines go from post to post, in eight directions.",
        ],
    },
];
