//! What annotating did, so that nothing is left out in silence.

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
}

/// What was drawn, and what was not and why. Texts are as given, in the order of the annotations.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AnnotationReport {
    /// Labels drawn.
    pub placed: Vec<String>,
    /// Labels not drawn because terrain or something on it stands before their place.
    pub hidden: Vec<String>,
    /// Labels not drawn because their place is outside the picture, or too close to its border.
    pub outside: Vec<String>,
    /// Labels not drawn because no position near their place was free.
    pub crowded_out: Vec<String>,
    /// Labels with no text to draw; how many.
    pub empty: usize,
    /// Texts drawn with an ellipsis because they were too long.
    pub shortened: Vec<String>,
    /// Furniture asked for and not drawn: too large for the picture, or its figures make no sense.
    pub left_out: Vec<FurnitureKind>,
    /// Texts drawn with boxes in place of characters that the embedded fonts lack.
    pub missing_glyphs: Vec<MissingGlyphs>,
}

/// A drawn text that holds characters the embedded fonts lack.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingGlyphs {
    /// The text as given.
    pub text: String,
    /// How many boxes were drawn.
    pub count: usize,
}

impl AnnotationReport {
    /// How many boxes were drawn in place of characters, in all texts.
    pub fn missing_glyph_count(&self) -> usize {
        self.missing_glyphs.iter().map(|missing| missing.count).sum()
    }

    /// Records what setting `text` came to.
    pub(super) fn set(&mut self, text: &str, missing: usize, shortened: bool) {
        if missing > 0 {
            self.missing_glyphs.push(MissingGlyphs { text: text.to_owned(), count: missing });
        }
        if shortened {
            self.shortened.push(text.to_owned());
        }
    }

    /// Adds what `other` says about texts: of furniture that was drawn after all.
    pub(super) fn take_texts(&mut self, other: Self) {
        self.missing_glyphs.extend(other.missing_glyphs);
        self.shortened.extend(other.shortened);
    }
}
