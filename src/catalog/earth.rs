//! Kinds about earth that is moved.

use crate::kind::{AnalysisFamily, AnalysisKind, AnalysisReach, AnalysisYield};
use crate::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};

/// The kinds.
pub(crate) const KINDS: &[AnalysisKind] = &[AnalysisKind {
    name: "cut-fill",
    family: AnalysisFamily::Earth,
    title: "Cut and fill",
    summary: "How much higher the ground is than another one, and the volumes of earth cut and filled.",
    parameters: &[
        AnalysisParameter::plain(
            "against",
            ParameterForm::Ground,
            ParameterDefault::Required,
            "The ground before: an elevation file, or `source`, the elevation before the scene's earthworks.",
        ),
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
}];
