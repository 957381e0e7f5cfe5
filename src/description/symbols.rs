//! The scene file's table of military symbols.

use std::collections::BTreeMap;

use crate::bounds::Bounds::{self, Above, Within};
use crate::declaration::{KeyDeclaration, Presence};
use crate::feature_source::FeatureSource;
use crate::feature_value::{DefaultedValue, FeatureValue};
use crate::key;
use crate::reader::TableReader;
use crate::selection::Selection;
use crate::stated::Stated;
use crate::table::Table;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

table! {
    /// `[[symbol]]`.
    struct SymbolTable {
        /// The symbol code: 20 or 30 digits (MIL-STD-2525D and E, APP-6D), or 15 letters (2525C). With `file`: an expression,
        /// such as `sidc`. So are the texts below.
        sidc: Stated<String> = key::filled_text(), required;
        /// Where it is.
        at: Option<Stated<Position>> = key::point(), otherwise "by `file`";
        /// Instead of `at`: a vector file whose features are symbols: points where they are, lines at the middle of their
        /// longest piece, polygons at a point inside.
        file: Option<Stated<String>> = key::file(), otherwise "by `at`";
        /// With `file`: the layer of a file that holds several.
        layer: Option<Stated<String>> = key::filled_text(), otherwise "the file's only layer";
        /// With `file`: the features that are symbols, as in other tables.
        selection as "where": Option<Stated<Selection>> = key::selection(), otherwise "all features";
        /// Coordinate system of `at`, or of a file that names none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`, or what the file names";
        /// Of a table (CSV, spreadsheet) as `file`, the columns by what they hold: `position`, `lon`, `lat`, `x`, `y`, `zone`, `z` or
        /// `shape`, or the name of a property.
        columns: Option<Stated<BTreeMap<String, String>>> = key::named_texts(), otherwise "by the names of the columns";
        /// Height of the frame of a friendly unit in a picture 1080 pixels high; in smaller pictures symbols shrink less than
        /// the picture.
        size: f64 = key::number(Within(12.0, 200.0), "px"), default 38;
        /// Instead of `size`: height of that frame on the ground, so that near symbols are larger, from 16 to 120 pixels.
        extent: Option<f64> = key::number(Above(0.0, 1e6), "m"), otherwise "by `size`";
        /// The lower, the more important: more important symbols take their places first, and are larger where room is scarce.
        rank: DefaultedValue<f64> = key::feature_number(Within(-1e9, 1e9), ""), default 0;
        /// Field Q: the direction of movement, as an arrow from the place.
        direction: Option<Stated<FeatureValue<f64>>> = key::feature_number(Bounds::DIRECTION, "°"), otherwise "no arrow";
        /// Field C: how many, over the frame.
        quantity: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field F: `(+)`, `(-)` or `(±)`.
        reinforced: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field G: comments of the staff, right.
        staff_comments: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field H: what else is to be said, right.
        additional_information: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field M: the number or title of the higher formation, lower right.
        higher_formation: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field J: reliability and credibility, such as `B2`.
        evaluation_rating: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field K: how fit for combat it is, right.
        combat_effectiveness: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field P: identification modes.
        iff: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field T: what the unit is called, lower left.
        unique_designation: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field V: the type of equipment.
        kind as "type": Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field W: date and time.
        dtg: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field X: altitude or depth, left.
        altitude: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field Y: where it is, in words or a grid reference, left.
        location: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field Z: how fast it moves, left.
        speed: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AA: the name of a special headquarters, in the frame.
        special_headquarters: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field L: `!` for detectable electronic signatures.
        signature_equipment: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field N: `ENY` for equipment of the enemy.
        hostile: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AS: the country; that of a code of 30 digits without one stated.
        country: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AD: the type of platform, such as `ELNOT` or `CENOT`.
        platform_type: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AE: how long it takes to take the equipment down, in minutes.
        teardown_time: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AF: what the equipment is commonly called, such as `HAWK`.
        common_identifier: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AH: what element of the headquarters it is, below the frame.
        headquarters_element: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AI: what parts the installation has.
        installation_composition: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AQ: the ship that is guarded.
        guarded_unit: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AR: a special track, such as `NRT` or `SIG`.
        special_designator: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// Field AO: what the bar over the symbol says, such as `A:PTRIOT-02`.
        engagement_bar: Option<Stated<String>> = key::filled_text(), otherwise "none";
        /// The color of the engagement bar: `target`, `non-target` or `expired`; else that of the frame.
        engagement: Option<Stated<String>> = key::filled_text(), otherwise "none";
    }
    check(reader) {
        reader.exclude("file", "at");
        reader.need_either("at", "file", "add `at = [x, y]`, or `file = \"name.geojson\"` for a symbol a feature");
        if reader.key_span("extent").is_some() {
            reader.without_effect(&["size"], "on a symbol with an `extent`", "remove one of them");
        }
        if reader.key_span("file").is_some() {
            for key in TEXT_KEYS {
                reader.need_expression(key);
            }
        } else {
            reader.without_effect(&["layer", "where", "columns"], "on a symbol without a `file`", "name a `file`, or remove it");
        }
    }
}

/// The keys that are texts, or with a file expressions.
const TEXT_KEYS: [&str; 28] = [
    "sidc",
    "quantity",
    "reinforced",
    "staff_comments",
    "additional_information",
    "higher_formation",
    "evaluation_rating",
    "combat_effectiveness",
    "iff",
    "unique_designation",
    "type",
    "dtg",
    "altitude",
    "location",
    "speed",
    "special_headquarters",
    "signature_equipment",
    "hostile",
    "country",
    "platform_type",
    "teardown_time",
    "common_identifier",
    "headquarters_element",
    "installation_composition",
    "guarded_unit",
    "special_designator",
    "engagement_bar",
    "engagement",
];

impl SymbolTable {
    /// The features that are symbols; `None` for a symbol at one place.
    pub fn source(&self) -> Option<FeatureSource> {
        FeatureSource::of_file(&self.file, &self.layer, &self.selection, &self.crs, &self.columns)
    }

    /// The fields of text with their texts or expressions, as the table of text fields has their keys.
    pub fn texts(&self) -> [(&'static str, &Option<Stated<String>>); 27] {
        [
            ("quantity", &self.quantity),
            ("reinforced", &self.reinforced),
            ("staff_comments", &self.staff_comments),
            ("additional_information", &self.additional_information),
            ("higher_formation", &self.higher_formation),
            ("evaluation_rating", &self.evaluation_rating),
            ("combat_effectiveness", &self.combat_effectiveness),
            ("iff", &self.iff),
            ("unique_designation", &self.unique_designation),
            ("type", &self.kind),
            ("dtg", &self.dtg),
            ("altitude", &self.altitude),
            ("location", &self.location),
            ("speed", &self.speed),
            ("special_headquarters", &self.special_headquarters),
            ("signature_equipment", &self.signature_equipment),
            ("hostile", &self.hostile),
            ("country", &self.country),
            ("platform_type", &self.platform_type),
            ("teardown_time", &self.teardown_time),
            ("common_identifier", &self.common_identifier),
            ("headquarters_element", &self.headquarters_element),
            ("installation_composition", &self.installation_composition),
            ("guarded_unit", &self.guarded_unit),
            ("special_designator", &self.special_designator),
            ("engagement_bar", &self.engagement_bar),
            ("engagement", &self.engagement),
        ]
    }
}
