//! Text fields round a frame: MIL-STD-2525D, 5.3.7 and figure 14.
//!
//! ```text
//!               C
//!      W  ┌───────────┐  F          rows of the sides, the third level with the frame's middle;
//!    X Y  │           │  G          the left side ends at the frame, the right side begins there
//!      V  │    AA     │  H
//!      T  │           │  M
//!      Z  └───────────┘  J K P
//! ```

/// A field of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SymbolText {
    /// C.
    Quantity,
    /// F.
    Reinforced,
    /// G.
    StaffComments,
    /// H.
    AdditionalInformation,
    /// M.
    HigherFormation,
    /// J.
    EvaluationRating,
    /// K.
    CombatEffectiveness,
    /// P.
    Iff,
    /// W.
    Dtg,
    /// X.
    Altitude,
    /// Y.
    Location,
    /// V.
    Type,
    /// T.
    UniqueDesignation,
    /// Z.
    Speed,
    /// AA.
    SpecialHeadquarters,
}

/// The place of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextPlace {
    /// Over the frame, centered.
    Above,
    /// In the frame, centered.
    Inside,
    /// Left of the frame, in a row from 0 to 4.
    Left(u8),
    /// Right of it.
    Right(u8),
}

/// A field with its letter in the standard and its place.
#[derive(Clone, Copy, Debug)]
pub struct SymbolTextField {
    /// The field.
    pub field: SymbolText,
    /// The standard's letter.
    pub letter: &'static str,
    /// The key of a scene file.
    pub key: &'static str,
    /// Where it stands.
    pub place: TextPlace,
}

/// All fields, those of a row in their order.
pub const TEXT_FIELDS: [SymbolTextField; 15] = [
    row(SymbolText::Quantity, "C", "quantity", TextPlace::Above),
    row(SymbolText::SpecialHeadquarters, "AA", "special_headquarters", TextPlace::Inside),
    row(SymbolText::Dtg, "W", "dtg", TextPlace::Left(0)),
    row(SymbolText::Altitude, "X", "altitude", TextPlace::Left(1)),
    row(SymbolText::Location, "Y", "location", TextPlace::Left(1)),
    row(SymbolText::Type, "V", "type", TextPlace::Left(2)),
    row(SymbolText::UniqueDesignation, "T", "unique_designation", TextPlace::Left(3)),
    row(SymbolText::Speed, "Z", "speed", TextPlace::Left(4)),
    row(SymbolText::Reinforced, "F", "reinforced", TextPlace::Right(0)),
    row(SymbolText::StaffComments, "G", "staff_comments", TextPlace::Right(1)),
    row(SymbolText::AdditionalInformation, "H", "additional_information", TextPlace::Right(2)),
    row(SymbolText::HigherFormation, "M", "higher_formation", TextPlace::Right(3)),
    row(SymbolText::EvaluationRating, "J", "evaluation_rating", TextPlace::Right(4)),
    row(SymbolText::CombatEffectiveness, "K", "combat_effectiveness", TextPlace::Right(4)),
    row(SymbolText::Iff, "P", "iff", TextPlace::Right(4)),
];

const fn row(
    field: SymbolText,
    letter: &'static str,
    key: &'static str,
    place: TextPlace,
) -> SymbolTextField {
    SymbolTextField { field, letter, key, place }
}

/// A line of text at a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SymbolNote {
    /// What is written; fields of one row with spaces between.
    pub text: String,
    /// Where.
    pub place: TextPlace,
}

/// Sorts the texts of fields into lines; empty texts are left out.
pub fn placed<'a>(text: impl Fn(SymbolText) -> Option<&'a str>) -> Vec<SymbolNote> {
    let mut lines: Vec<SymbolNote> = Vec::new();
    for row in &TEXT_FIELDS {
        let Some(text) = text(row.field).map(str::trim).filter(|text| !text.is_empty()) else { continue };
        match lines.iter_mut().find(|line| line.place == row.place) {
            Some(line) => {
                line.text.push(' ');
                line.text.push_str(text);
            }
            None => lines.push(SymbolNote { text: text.to_owned(), place: row.place }),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_a_row_share_a_line_and_empty_ones_have_none() {
        let lines = placed(|field| match field {
            SymbolText::Altitude => Some("120 m"),
            SymbolText::Location => Some("16S GD 1 2"),
            SymbolText::Speed => Some(" "),
            _ => None,
        });
        let expected = SymbolNote { text: "120 m 16S GD 1 2".to_owned(), place: TextPlace::Left(1) };
        assert_eq!(lines, [expected]);
    }
}
