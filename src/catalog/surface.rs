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
        limits: &["Level ground has no aspect and no data.", BORDER],
    },
    AnalysisKind {
        name: "hillshade",
        family: AnalysisFamily::Surface,
        title: "Hillshade",
        summary: "How directly the ground faces the sun at each post, from 1 to 255.",
        parameters: &[
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
        source: "Horn 1981, as gdaldem hillshade",
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
];
