//! The report of annotating a picture.

use crate::annotate::drawing::DrawnText;

/// A piece of furniture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FurnitureKind {
    /// Title and subtitle.
    Title,
    /// The north arrow.
    NorthArrow,
    /// The scale bar.
    ScaleBar,
    /// The elevation legend.
    Legend,
    /// The credit line.
    Credit,
    /// The legend of classes.
    Classes,
    /// The diagram of the three norths.
    Norths,
    /// The whole model in plan.
    Locator,
}

/// The labels and pieces of furniture that were drawn, and the others by reason. Texts are as given, in the order of
/// the annotations.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AnnotationReport {
    /// Labels drawn.
    pub placed: Vec<String>,
    /// Labels not drawn because terrain or something on it hides their place.
    pub hidden: Vec<String>,
    /// Labels not drawn because their place is outside the picture, or too close to its border.
    pub outside: Vec<String>,
    /// Labels not drawn because no position near their place was free.
    pub crowded_out: Vec<String>,
    /// The number of labels without visible text.
    pub empty: usize,
    /// Texts drawn with an ellipsis because they were too long.
    pub shortened: Vec<String>,
    /// Furniture not drawn: too large for the picture, or without sensible values.
    pub left_out: Vec<FurnitureKind>,
    /// Texts drawn with boxes in place of characters that the embedded fonts lack.
    pub missing_glyphs: Vec<MissingGlyphs>,
}

/// What becomes of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::annotate) enum LabelOutcome {
    Placed,
    Hidden,
    Outside,
    CrowdedOut,
    Empty,
}

impl LabelOutcome {
    pub(in crate::annotate) fn report(self, text: &str, report: &mut AnnotationReport) {
        match self {
            Self::Placed => report.placed.push(text.to_owned()),
            Self::Hidden => report.hidden.push(text.to_owned()),
            Self::Outside => report.outside.push(text.to_owned()),
            Self::CrowdedOut => report.crowded_out.push(text.to_owned()),
            Self::Empty => report.empty += 1,
        }
    }
}

/// A drawn text with characters that the embedded fonts lack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingGlyphs {
    /// The text as given.
    pub text: String,
    /// The number of boxes drawn.
    pub count: usize,
}

impl AnnotationReport {
    pub(in crate::annotate) fn add_texts(&mut self, texts: &[DrawnText]) {
        for DrawnText { text, missing, shortened } in texts {
            if *missing > 0 {
                self.missing_glyphs.push(MissingGlyphs { text: text.clone(), count: *missing });
            }
            if *shortened {
                self.shortened.push(text.clone());
            }
        }
    }
}
