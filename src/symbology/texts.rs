//! Text fields round a frame: MIL-STD-2525D, 5.3.7 and figure 14.
//!
//! ```text
//!               C
//!      W   ┌───────────┐  F AS        rows of the sides, the third level with the frame's middle;
//!    X Y   │           │  G           the left side ends at the frame, the right side begins there
//!  V AD AE │    AA     │  H AF
//!      T   │           │  M
//!      Z   └───────────┘  J K L N P
//!               AH
//! ```
//!
//! So it is of units. Where other sets have a field elsewhere, [`placed_for`] sets it there: of what flies and swims all fields
//! are on the right, but for the special designator and the guarded unit.

use crate::code::SymbolCode;
use crate::country;
use crate::fields::SymbolSet;

/// Size of the text round a frame, in units of the symbol's box: five rows are little higher than a frame.
pub const TEXT_SIZE: f32 = 36.0;
/// From one row of text to the next, in sizes of the text.
pub const ROW_PITCH: f32 = 1.08;
/// Between frame and text, in units.
pub const TEXT_GAP: f32 = 9.0;

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
    /// L.
    SignatureEquipment,
    /// N.
    Hostile,
    /// AS, AC.
    Country,
    /// AD.
    PlatformType,
    /// AE.
    TeardownTime,
    /// AF.
    CommonIdentifier,
    /// AH.
    HeadquartersElement,
    /// AI.
    InstallationComposition,
    /// AQ.
    GuardedUnit,
    /// AR.
    SpecialDesignator,
    /// AO: what the bar says.
    EngagementBar,
    /// AO: what the bar's color says.
    Engagement,
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
    /// Below all, centered.
    Below,
    /// In the engagement bar, which is part of the symbol.
    Bar,
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
pub const TEXT_FIELDS: [SymbolTextField; 27] = [
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
    row(SymbolText::SignatureEquipment, "L", "signature_equipment", TextPlace::Right(4)),
    row(SymbolText::Hostile, "N", "hostile", TextPlace::Right(4)),
    row(SymbolText::Iff, "P", "iff", TextPlace::Right(4)),
    row(SymbolText::Country, "AS", "country", TextPlace::Right(0)),
    row(SymbolText::PlatformType, "AD", "platform_type", TextPlace::Left(2)),
    row(SymbolText::TeardownTime, "AE", "teardown_time", TextPlace::Left(2)),
    row(SymbolText::CommonIdentifier, "AF", "common_identifier", TextPlace::Right(2)),
    row(SymbolText::HeadquartersElement, "AH", "headquarters_element", TextPlace::Below),
    row(SymbolText::InstallationComposition, "AI", "installation_composition", TextPlace::Left(2)),
    row(SymbolText::GuardedUnit, "AQ", "guarded_unit", TextPlace::Left(0)),
    row(SymbolText::SpecialDesignator, "AR", "special_designator", TextPlace::Left(0)),
    row(SymbolText::EngagementBar, "AO", "engagement_bar", TextPlace::Bar),
    row(SymbolText::Engagement, "AO", "engagement", TextPlace::Bar),
];

/// Where equipment and installations have fields that units have elsewhere.
const EQUIPMENT: &[(SymbolText, TextPlace)] =
    &[(SymbolText::CommonIdentifier, TextPlace::Left(2)), (SymbolText::TeardownTime, TextPlace::Right(2))];

const DISMOUNTED: &[(SymbolText, TextPlace)] =
    &[(SymbolText::Quantity, TextPlace::Below), (SymbolText::CommonIdentifier, TextPlace::Left(2))];

const AIR: &[(SymbolText, TextPlace)] = &[
    (SymbolText::UniqueDesignation, TextPlace::Right(0)),
    (SymbolText::Iff, TextPlace::Right(1)),
    (SymbolText::Type, TextPlace::Right(2)),
    (SymbolText::Speed, TextPlace::Right(3)),
    (SymbolText::Altitude, TextPlace::Right(3)),
    (SymbolText::StaffComments, TextPlace::Right(4)),
    (SymbolText::AdditionalInformation, TextPlace::Right(4)),
];

const SEA: &[(SymbolText, TextPlace)] = &[
    (SymbolText::UniqueDesignation, TextPlace::Right(0)),
    (SymbolText::Type, TextPlace::Right(1)),
    (SymbolText::Iff, TextPlace::Right(2)),
    (SymbolText::StaffComments, TextPlace::Right(3)),
    (SymbolText::AdditionalInformation, TextPlace::Right(3)),
    (SymbolText::Location, TextPlace::Right(4)),
    (SymbolText::Speed, TextPlace::Right(4)),
];

const SUBSURFACE: &[(SymbolText, TextPlace)] = &[
    (SymbolText::UniqueDesignation, TextPlace::Right(0)),
    (SymbolText::Type, TextPlace::Right(1)),
    (SymbolText::Altitude, TextPlace::Right(2)),
    (SymbolText::StaffComments, TextPlace::Right(3)),
    (SymbolText::AdditionalInformation, TextPlace::Right(4)),
];

/// The fields of a set that are elsewhere than those of units.
fn moved(set: SymbolSet) -> &'static [(SymbolText, TextPlace)] {
    match set {
        SymbolSet::Air
        | SymbolSet::AirMissile
        | SymbolSet::Space
        | SymbolSet::SpaceMissile
        | SymbolSet::SignalsSpace
        | SymbolSet::SignalsAir => AIR,
        SymbolSet::SeaSurface | SymbolSet::SignalsSurface => SEA,
        SymbolSet::Subsurface | SymbolSet::MineWarfare | SymbolSet::SignalsSubsurface => SUBSURFACE,
        SymbolSet::LandEquipment | SymbolSet::LandInstallation | SymbolSet::SignalsLand => EQUIPMENT,
        SymbolSet::Dismounted => DISMOUNTED,
        _ => &[],
    }
}

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

/// Sorts the texts of the fields of a symbol into lines, each where the symbol's set has it; empty texts are left out. The
/// country is that of the code where no text states another.
pub fn placed_for<'a>(code: &SymbolCode, text: impl Fn(SymbolText) -> Option<&'a str>) -> Vec<SymbolNote> {
    let moved = moved(code.set);
    let text = |field| match text(field) {
        None if field == SymbolText::Country => country::letters(code.country),
        text => text,
    };
    let others = TEXT_FIELDS.iter().map(|row| (row.field, row.place));
    let others = others.filter(|row| !moved.iter().any(|moved| moved.0 == row.0));
    lines(moved.iter().copied().chain(others), text)
}

/// Sorts the texts of fields into lines as units have them; empty texts are left out.
pub fn placed<'a>(text: impl Fn(SymbolText) -> Option<&'a str>) -> Vec<SymbolNote> {
    lines(TEXT_FIELDS.iter().map(|row| (row.field, row.place)), text)
}

fn lines<'a>(
    fields: impl Iterator<Item = (SymbolText, TextPlace)>,
    text: impl Fn(SymbolText) -> Option<&'a str>,
) -> Vec<SymbolNote> {
    let mut lines: Vec<SymbolNote> = Vec::new();
    for (field, place) in fields.filter(|row| row.1 != TextPlace::Bar) {
        let Some(text) = text(field).map(str::trim).filter(|text| !text.is_empty()) else { continue };
        match lines.iter_mut().find(|line| line.place == place) {
            Some(line) => {
                line.text.push(' ');
                line.text.push_str(text);
            }
            None => lines.push(SymbolNote { text: text.to_owned(), place }),
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

    #[test]
    fn aircraft_have_their_name_on_the_right_and_the_country_comes_from_the_code() {
        let code = |text: &str| SymbolCode::parse(text).expect("a code");
        let text = |field| (field == SymbolText::UniqueDesignation).then_some("VIPER 1");
        let places = |text: &str, note: Vec<SymbolNote>| {
            note.into_iter().map(|line| (line.text, line.place)).collect::<Vec<_>>()
                == [(
                    "VIPER 1".to_owned(),
                    if text == "01" { TextPlace::Right(0) } else { TextPlace::Left(3) },
                )]
        };
        assert!(places("01", placed_for(&code("10030100001101000000"), text)));
        assert!(places("10", placed_for(&code("10031000001211000000"), text)));
        let lines = placed_for(&code("130320000012080200000000000276"), |_| None);
        assert_eq!(lines, [SymbolNote { text: "DEU".to_owned(), place: TextPlace::Right(0) }]);
    }

    #[test]
    fn every_field_has_a_place_in_every_set_and_no_key_is_there_twice() {
        for row in &TEXT_FIELDS {
            assert_eq!(TEXT_FIELDS.iter().filter(|other| other.key == row.key).count(), 1, "{}", row.key);
            for set in ["01", "05", "10", "15", "20", "27", "30", "35", "40", "60"] {
                let code = SymbolCode::parse(&format!("1003{set}00000000000000")).expect("a code");
                let lines = placed_for(&code, |field| (field == row.field).then_some("A"));
                assert_eq!(lines.len(), usize::from(row.place != TextPlace::Bar), "{} in {set}", row.key);
            }
        }
    }
}
