//! Kinds about earth that is moved.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield};
use crate::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// The ground before.
const AGAINST: AnalysisParameter = AnalysisParameter::plain(
    "against",
    ParameterForm::Ground,
    ParameterDefault::Required,
    "The ground before: an elevation file, `source`, the elevation before the scene's earthworks, or `phase:NAME`, the ground of the \
     scene in another phase.",
);

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "cut-fill",
        family: AnalysisFamily::Earth,
        title: "Cut and fill",
        summary: "How much higher the ground is than another one, and the volumes of earth cut and filled.",
        parameters: &[
            AGAINST,
            AnalysisParameter::plain(
                "area",
                ParameterForm::Area,
                ParameterDefault::Otherwise("the whole land"),
                "The area whose volumes count.",
            ),
        ],
        yields: AnalysisYield::Both,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Prisms on cells, a post's difference times its share of the cells around it",
        limits: &[
            "A cell that holds both cut and fill counts each post's quarter by that post: its net volume is that of the \
         bilinear surface, while cut and fill are both too great, by at most the cell's area times the lesser of its \
         greatest cut and its greatest fill.",
            "The border of an area runs along the borders of the posts' own quarters.",
            "Earth swells when it is dug and shrinks when it is compacted, which the volumes leave out.",
        ],
    },
    AnalysisKind {
        name: "haul",
        family: AnalysisFamily::Earth,
        title: "Hauls of earth",
        summary: "Which cut goes to which fill between two states of the ground, so that volume times distance is the least.",
        parameters: &[
            AGAINST,
            AnalysisParameter::plain(
                "area",
                ParameterForm::Area,
                ParameterDefault::Otherwise("the whole land"),
                "The area whose earth is hauled.",
            ),
            AnalysisParameter::number(
                "block_m",
                (0.1, 100_000.0),
                "m",
                ParameterDefault::Otherwise(
                    "the smallest of 1, 2, 5, 10, … m that gives up to 400 blocks of cut and of fill",
                ),
                "The side of the square blocks in which earth is gathered.",
            ),
            AnalysisParameter::number(
                "swell",
                (0.5, 2.0),
                "",
                ParameterDefault::Value("1"),
                "The volume of fill for each cubic meter of cut. All volumes count as cut.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Stark and Mayer 1983, as the transportation problem of Hitchcock 1941, solved exactly by cheapest paths \
                 (Edmonds and Karp 1972)",
        limits: &[
            "The plan is the best one for the centroids of blocks; a plan for every post differs by at most the figure \
             `haul, uncertain by blocks`.",
            "Distances are straight and level: roads, slopes, water and the order of works count nothing.",
            "What is left over is waste, and what is missing is borrow, both without a haul.",
        ],
    },
    AnalysisKind {
        name: "berms",
        family: AnalysisFamily::Earth,
        title: "Berms and ditches",
        summary: "How high a berm along a line must be for its crest to reach a level, and how deep a ditch gives its earth.",
        parameters: &[
            AnalysisParameter::plain(
                "line",
                ParameterForm::Line,
                ParameterDefault::Required,
                "The line of the berm.",
            ),
            AnalysisParameter::number(
                "level_m",
                (-1e5, 1e5),
                "m",
                ParameterDefault::Required,
                "The level of the crest.",
            ),
            AnalysisParameter::number(
                "crest_m",
                (0.0, 100.0),
                "m",
                ParameterDefault::Value("1"),
                "The width of the crest.",
            ),
            AnalysisParameter::number(
                "side_run",
                (0.0, 10.0),
                "",
                ParameterDefault::Value("1.5"),
                "Meters across for each meter up, on each side of berm and ditch.",
            ),
            AnalysisParameter::number(
                "ditch_m",
                (0.1, 100.0),
                "m",
                ParameterDefault::Value("2"),
                "The width of the ditch's bottom.",
            ),
            AnalysisParameter::number(
                "swell",
                (0.5, 2.0),
                "",
                ParameterDefault::Value("1"),
                "The volume of the berm for each cubic meter of the ditch.",
            ),
            AnalysisParameter::number(
                "step_m",
                (0.1, 10000.0),
                "m",
                ParameterDefault::Value("10"),
                "The distance between stations.",
            ),
        ],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: &[],
        source: "Trapezoid sections, volumes by average end areas",
        limits: &[
            "The ground across the line counts as level, and as straight between stations; bends add nothing.",
        ],
    },
];
