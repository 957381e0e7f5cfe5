//! The report of annotating a picture.

use glam::Vec2;

use crate::drawing::DrawnText;
use crate::pixel_box::PixelBox;
use crate::place::LabelCandidate;
use crate::placed_figure::PlacedFigure;

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
    /// A table.
    Table,
    /// The whole model in plan.
    Locator,
}

/// The labels and pieces of furniture that were drawn, and the others by reason. Texts are as given, in the order of
/// the annotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnnotationReport {
    /// Labels drawn.
    pub placed: Vec<String>,
    /// The boxes that the drawn texts and symbols cover on the picture, with their halos.
    pub boxes: Vec<SheetBox>,
    /// The numbers of the grid that are drawn; on a sheet with a margin some are beside the picture.
    pub figures: Vec<PlacedFigure>,
    /// Labels drawn away from their preferred position, with the reason; they are among those placed.
    pub moved: Vec<MovedLabel>,
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
    /// Military symbols.
    pub symbols: SymbolReport,
    /// Furniture not drawn: too large for the picture, or without sensible values.
    pub left_out: Vec<FurnitureKind>,
    /// Texts drawn with boxes in place of characters that the embedded fonts lack.
    pub missing_glyphs: Vec<MissingGlyphs>,
}

/// An upright box on the picture: pixels from its upper left corner, X right and Y down.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetBox {
    /// The label whose text, letter or symbol it holds; `None` for furniture.
    pub text: Option<String>,
    /// Its upper left corner.
    pub min: Vec2,
    /// Its lower right corner.
    pub max: Vec2,
}

impl SheetBox {
    /// The boxes of a label's text, letters and symbol.
    pub(crate) fn of(text: &str, candidate: &LabelCandidate) -> Vec<Self> {
        let one = |area: &PixelBox| Self { text: Some(text.to_owned()), min: area.min, max: area.max };
        candidate.boxes().map(one).collect()
    }

    pub(crate) fn of_furniture(area: &PixelBox) -> Self {
        Self { text: None, min: area.min, max: area.max }
    }
}

/// A label drawn away from its preferred position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MovedLabel {
    /// The text as given.
    pub text: String,
    /// Where it is drawn, and why.
    pub to: LabelMove,
}

/// The position of a label that is not drawn at its preferred one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LabelMove {
    /// At the end of a leader line: none of the eight positions beside its place is free.
    Led,
    /// At one place: its line, or its area, is too short, too bent or too crowded for the letters.
    OffLine,
}

/// The outcome of placing military symbols, by their names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SymbolReport {
    /// Drawn.
    pub placed: Vec<String>,
    /// Drawn with a dashed staff and a hollow foot, because terrain hides their place.
    pub hidden: Vec<String>,
    /// Drawn without their text, because there was no room for it.
    pub without_text: Vec<String>,
    /// Not drawn because their place is outside the picture.
    pub outside: Vec<String>,
    /// Drawn smaller than they are asked for, because there was no room.
    pub reduced: Vec<String>,
    /// Not drawn themselves: numbered at their place and listed with their grid reference.
    pub listed: Vec<String>,
    /// Neither drawn nor listed: counted at their place.
    pub counted: Vec<String>,
    /// Left out: not even a number has room.
    pub crowded_out: Vec<String>,
}

impl SymbolReport {
    /// Adds the outcomes of more symbols.
    pub(crate) fn append(&mut self, other: Self) {
        let Self { placed, hidden, without_text, outside, reduced, listed, counted, crowded_out } = other;
        self.placed.extend(placed);
        self.hidden.extend(hidden);
        self.without_text.extend(without_text);
        self.outside.extend(outside);
        self.reduced.extend(reduced);
        self.listed.extend(listed);
        self.counted.extend(counted);
        self.crowded_out.extend(crowded_out);
    }
}

/// What becomes of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LabelOutcome {
    Placed(Option<LabelMove>),
    Hidden,
    Outside,
    CrowdedOut,
    Empty,
}

impl LabelOutcome {
    pub(crate) fn report(self, text: &str, report: &mut AnnotationReport) {
        match self {
            Self::Placed(moved) => {
                report.placed.push(text.to_owned());
                report.moved.extend(moved.map(|to| MovedLabel { text: text.to_owned(), to }));
            }
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
    pub(crate) fn add_texts(&mut self, texts: &[DrawnText]) {
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
