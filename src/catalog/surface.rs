//! Kinds about the form of the ground.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield};
use crate::parameter::AnalysisParameter;

/// The two ways of taking a slope from neighbors.
const METHOD: AnalysisParameter = AnalysisParameter::word(
    "method",
    &["horn", "zevenbergen-thorne"],
    "horn",
    "How the slope follows from neighbors: `horn` from eight with weights 1-2-1, `zevenbergen-thorne` from four.",
);

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[AnalysisKind {
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
    limits: &["Ground between posts may be steeper: coarse elevation models flatten slopes."],
}];
