//! Kinds about landing and sites.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield, LandPart};
use crate::parameter::{AnalysisParameter, ParameterDefault::Value};

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[AnalysisKind {
    name: "landing-zones",
    family: AnalysisFamily::Landing,
    title: "Helicopter landing zones",
    summary: "Where a helicopter can land: 0 unsuited, 1 with caution, 2 suited, with the best sites.",
    parameters: &[
        AnalysisParameter::word(
            "size",
            &["1", "2", "3", "4", "5", "6", "7"],
            "3",
            "The size of the touchdown point: 25, 35, 50, 80, 100, 125 or 150 m across.",
        ),
        AnalysisParameter::number(
            "free_slope",
            (0.0, 45.0),
            "°",
            Value("7"),
            "The greatest slope without caution.",
        ),
        AnalysisParameter::number(
            "greatest_slope",
            (0.0, 45.0),
            "°",
            Value("15"),
            "The greatest slope at all.",
        ),
        AnalysisParameter::number(
            "obstacle_ratio",
            (1.0, 100.0),
            "",
            Value("10"),
            "How many meters from the disk an approach or departure needs for each meter of an obstacle's height.",
        ),
        AnalysisParameter::number(
            "approach_m",
            (0.0, 10000.0),
            "m",
            Value("500"),
            "How far from the disk approach and departure must be clear.",
        ),
        AnalysisParameter::number("count", (0.0, 100.0), "", Value("3"), "The greatest number of sites."),
        AnalysisParameter::number(
            "separation_m",
            (0.0, 100_000.0),
            "m",
            Value("50"),
            "The least distance between the edges of two sites.",
        ),
    ],
    yields: AnalysisYield::Both,
    reach: AnalysisReach::Whole,
    layers: &[LandPart::Cover, LandPart::Water, LandPart::Obstacles],
    source: "FM 3-21.38, chapter 4",
    limits: &[
        "Approach and departure are opposite, straight, and in the directions of the eight neighbors of a post alone.",
        "Ground beyond the land and without data counts as clear of obstacles on approach and departure.",
        "Wires and obstacles between posts are unknown, as are wind, dust and the bearing strength of soil.",
    ],
}];
