//! The codes of findings: what each means, why it matters, and what to do.
//!
//! To add one, add its row: `Variant = "code", Severity, "what it means, why it matters, what to do"`. A code never changes
//! and is never used again for something else: scripts compare it. `sandtable explain CODE` prints the text, and
//! `scenes/FINDINGS.md` lists all.

use crate::description::finding::Severity;

/// Declares the codes.
macro_rules! finding_codes {
    ($($variant:ident = $code:literal, $severity:ident, $text:literal;)+) => {
        /// What a finding is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingCode {
            $(
                #[doc = $text]
                $variant,
            )+
        }

        /// Code, severity and text, in the order of the variants.
        const ROWS: &[(FindingCode, &str, Severity, &str)] =
            &[$((FindingCode::$variant, $code, Severity::$severity, $text),)+];
    };
}

finding_codes! {
    // The scene file.
    Syntax = "syntax", Error,
        "The text is not TOML: a quote, a bracket or a value is missing, or a key is given twice. Nothing of the scene is read \
         until it is mended. The carets stand where reading stopped; the mistake may be before them.";
    UnknownKey = "unknown-key", Error,
        "A table has a key that tables of its kind do not know, most often a slip of the pen. A key without effect would leave \
         the picture other than its author thinks. Write the key that is proposed, or look it up in `scenes/README.md`.";
    MissingKey = "missing-key", Error,
        "A table lacks a key that it needs. Add the key.";
    WrongType = "wrong-type", Error,
        "A value has another type than its key: a text in place of a number, a table in place of a list. Lengths are numbers \
         in meters, without a unit: `6`, not `\"6 m\"`.";
    WrongValue = "wrong-value", Error,
        "A value, or what it names, cannot be used: it lies out of its range, contradicts another, or is not where the scene \
         needs it. The message states what was found and what is allowed.";
    NoEffect = "no-effect", Error,
        "A key has no effect beside the others of its table. Remove it, or state what it needs.";
    DuplicateName = "duplicate-name", Error,
        "Two cameras, phases or flights have the same name, so that the second could not be asked for. Rename one.";
    UnknownName = "unknown-name", Error,
        "A style or a phase is named that the scene does not have. Add it, or write the name that is meant.";

    // Files.
    MissingFile = "missing-file", Error,
        "A file that the scene names is not there. Paths are relative to the file that states them.";
    FileOutside = "file-outside", Error,
        "A path leads out of the folder above the scene's own. A scene from elsewhere must not read what it likes. Where the \
         scene is to be trusted, allow the folder with `--allow`.";
    UnreadableFile = "unreadable-file", Error,
        "A file cannot be read: it is broken, cut short, too large, a folder, or of a kind that is not read here.";
    WrongFormat = "wrong-format", Error,
        "A file is not what its name says, such as an HTML page saved as `.tif`. Most often a download went wrong. Fetch it \
         again, or name it for what it is.";

    // Coordinate systems.
    CrsUnknown = "crs-unknown", Error,
        "A coordinate system is not known here. Write `EPSG:n`, a proj string, or the WKT of a `.prj` file.";
    CrsInDegrees = "crs-in-degrees", Error,
        "The scene's own system must be in meters: heights are, and slopes and distances are computed from both. Name a metric \
         system, such as the UTM zone, or leave `crs` out, which takes the UTM zone of the model's center.";
    CrsMissing = "crs-missing", Error,
        "A file names no coordinate system, and its place cannot be told without. State it with the key `crs` of its table.";
    CrsMismatch = "crs-mismatch", Error,
        "Coordinates cannot be brought from their system to the scene's: they lie outside what one of the two covers, or are \
         not in the system that is stated for them. State the right one with the key `crs`.";
    NoPlaceOnEarth = "no-place-on-earth", Warning,
        "The scene names no coordinate system, so that a grid, magnetic north or the sun of a date cannot be computed. State \
         `crs` under `[terrain]`.";

    // The elevation model.
    UndeclaredNoData = "undeclared-nodata", Warning,
        "A value occurs in the elevation model as no ground does: far apart from all others, or round and repeated. It most \
         likely means no data, but the file does not say so, and it is drawn as ground. State it as `nodata`.";
    VoidsFilled = "voids-filled", Note,
        "Samples without data were filled by a membrane from their rims, so that the ground has no holes. Heights there are \
         guesses. `fill_voids` under `[terrain]` switches it.";
    TilesDiffer = "tiles-differ", Error,
        "Several elevation files are not tiles of one raster: their cells, systems or vertical datums differ. Bring them to one \
         with `sandtable dem convert`.";
    TilesJoined = "tiles-joined", Note,
        "Several files were joined to one elevation model.";
    BorderCut = "border-cut", Note,
        "The elevation model was warped to the scene's system, and the wedges without data along its border were cut off. \
         `extent` under `[terrain]` names another part.";
    PostsAdded = "posts-added", Note,
        "More posts were put between those of the elevation model, for what is finer than its cells. The ground stays as it was.";
    TooFine = "too-fine", Note,
        "Something is finer than the elevation model shows: a trench narrower than two cells, a road or a shore between two \
         posts. It is drawn as well as the posts allow. A model of a smaller area, or one with smaller cells, shows it.";

    // Features and the terrain.
    LeftOut = "left-out", Note,
        "Features were left out, for the reason that the message states: most often they lie off the elevation model, since \
         files hold more than a scene shows.";
    EmptyShape = "empty-shape", Warning,
        "An outline encloses no area: it has fewer than three places, or runs back over itself. It is left out. Mend it.";
    ShapeMended = "shape-mended", Note,
        "An outline crosses itself and was taken apart into pieces that do not.";
    DefaultTaken = "default-taken", Note,
        "A key's expression gives no value within its range for some features, and its default was taken.";
    TooMany = "too-many", Warning,
        "There are more than a picture can show; the rest was left out. Select fewer with `where`.";
    Tangled = "tangled", Warning,
        "Roads that the ground follows cross each other so often that not every crossing was searched for: they meet at their \
         vertices only. Give crossing roads a vertex in common, or select fewer.";
    RiverUphill = "river-uphill", Warning,
        "The ground rises along a river by more than its bed may be cut, so that water could not flow there. Either the line \
         does not follow the valley of the elevation model, or it is drawn from mouth to source, or the cells are too wide. \
         Move the line, or raise `max_cut`.";
    LakeLevel = "lake-level", Note,
        "The level at which a lake lies, and the earth that was moved for it.";
    LakesShareCells = "lakes-share-cells", Note,
        "Two lakes lie so near to each other that they share cells of the elevation model. The lower level holds there.";
    EarthMoved = "earth-moved", Note,
        "How much earth was cut and filled.";
    NoEarthMoved = "no-earth-moved", Warning,
        "An earthwork moved no earth: it lies off the elevation model, between its posts, or under water.";
    PadRefused = "pad-refused", Warning,
        "A building stands without the level ground that its `base` asks for, because the ground there is shaped for something \
         else already: a lake, a road, or another building.";
    RoofReplaced = "roof-replaced", Note,
        "A building has another roof than asked for, because its footprint does not take that one.";
    PylonsAdded = "pylons-added", Note,
        "Pylons were added to keep the wires of a power line off the ground.";
    Scattered = "scattered", Note,
        "How many models were strewn over areas.";
    Crowded = "crowded", Note,
        "Fewer models stand than `density` asks for, because `spacing` leaves no place for more.";
    UnknownVariant = "unknown-variant", Warning,
        "Points name a variant that the table does not have; the model of `file` stands there. Add the variant, or mend the \
         property.";
    ModelRead = "model-read", Warning,
        "A model file was read with a loss that the message states: a texture that is not there, faces that were left out.";
    SymbolIncomplete = "symbol-incomplete", Warning,
        "A part of a military symbol is not drawn, because its code is not in the tables. The frame shows all the same.";
    CameraUnderground = "camera-underground", Warning,
        "The eye of a camera is under the ground, so that its picture shows the ground from below. Raise `eye_height` or \
         `eye_elevation`.";

    // What the scene states and nothing uses.
    UnusedStyle = "unused-style", Warning,
        "No table names this style, so its keys have no effect. Add `style = \"NAME\"` to the tables that it is meant for, or \
         remove it.";
}

impl FindingCode {
    /// Every code, in the order of the page that lists them.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().map(|row| row.0)
    }

    /// The code that a word names.
    pub fn from_word(word: &str) -> Option<Self> {
        ROWS.iter().find(|row| row.1 == word).map(|row| row.0)
    }

    /// Its word, such as `unknown-key`.
    pub fn word(self) -> &'static str {
        ROWS[self as usize].1
    }

    /// How much its findings matter.
    pub fn severity(self) -> Severity {
        ROWS[self as usize].2
    }

    /// What it means, why it matters and what to do, in sentences.
    pub fn text(self) -> &'static str {
        ROWS[self as usize].3
    }

    /// `warning[unused-style]`.
    pub fn head(self) -> String {
        format!("{}[{}]", self.severity().word(), self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn codes_are_unique_words_in_lower_case_with_hyphens() {
        let words: BTreeSet<&str> = FindingCode::all().map(FindingCode::word).collect();
        assert_eq!(words.len(), ROWS.len());
        for word in words {
            assert!(word.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-'), "{word}");
            assert_eq!(FindingCode::from_word(word).map(FindingCode::word), Some(word));
        }
    }

    #[test]
    fn every_code_explains_itself_in_sentences() {
        for code in FindingCode::all() {
            let text = code.text();
            assert!(
                text.len() >= 40 && text.ends_with('.') && !text.contains("  "),
                "{}: {text}",
                code.word()
            );
        }
    }
}
