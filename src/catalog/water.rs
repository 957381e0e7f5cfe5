//! Kinds about water.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{AnalysisParameter, ParameterDefault};

/// What no kind of water knows.
const LIMITS: &[&str] = &[
    "Water flows over the ground alone, and nothing soaks into it: soil, pipes and sluices are unknown to it.",
    "Below bridges and culverts of the scene the ground is cut through, straight from the lowest post within 30 m of the way on one side to that on the other; without them an embankment dams its valley. A road that crosses a stream narrower than 3 m without a bridge is taken to have a culvert.",
    "Posts beside a hole in the data are outlets, as those at the border are: a hole swallows the water that reaches it.",
    "Flow has eight directions; level ground and filled depressions drain away from higher and toward lower ground (Barnes, Lehman and Mulla 2014b), which is a guess at the channels in them.",
];

/// The layers that water needs: what lets it through embankments.
const CROSSINGS: &[LandPart] = &[LandPart::Crossings];

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[
    AnalysisKind {
        name: "fill",
        family: AnalysisFamily::Water,
        title: "Depressions",
        summary: "The depressions of the ground: their depth, or the ground with them filled to their lowest rim.",
        parameters: &[AnalysisParameter::word(
            "show",
            &["depth", "filled"],
            "depth",
            "What the values are: the depth below the rim, or the filled ground.",
        )],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "Barnes, Lehman and Mulla 2014 (Priority-Flood)",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "flow",
        family: AnalysisFamily::Water,
        title: "Flow",
        summary: "The area that drains through each post, or the direction in which it drains.",
        parameters: &[AnalysisParameter::word(
            "show",
            &["accumulation", "direction"],
            "accumulation",
            "What the values are: the drained area in m², or directions from 1 east counter-clockwise to 8 south-east, 0 off the land.",
        )],
        yields: AnalysisYield::Raster,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "O'Callaghan and Mark 1984 (D8) on ground filled after Barnes, Lehman and Mulla 2014",
        limits: LIMITS,
    },
    AnalysisKind {
        name: "streams",
        family: AnalysisFamily::Water,
        title: "Streams",
        summary: "The ways of water that drain at least an area, as lines with Strahler's order.",
        parameters: &[AnalysisParameter::number(
            "area_m2",
            (1.0, 1e12),
            "m²",
            ParameterDefault::Value("500000"),
            "The least area that drains through a stream.",
        )],
        yields: AnalysisYield::Features,
        reach: AnalysisReach::Whole,
        layers: CROSSINGS,
        source: "O'Callaghan and Mark 1984; Strahler 1957",
        limits: LIMITS,
    },
];
