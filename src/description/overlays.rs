//! The scene file's table of overlays: files of units, tactical graphics and drawings.

use std::collections::BTreeMap;

use crate::bounds::Bounds::{Above, Within};
use crate::declaration::{KeyDeclaration, Presence};
use crate::feature_source::FeatureSource;
use crate::key;
use crate::reader::TableReader;
use crate::selection::Selection;
use crate::stated::Stated;
use crate::table::Table;
use sandtable_geom::crs::Crs;

table! {
    /// `[[overlay]]`: all that a file of units and graphics holds. Features with a symbol code become symbols and tactical
    /// graphics; the others are lines, areas and points with the style that the file gives them.
    struct OverlayTable {
        /// Name for messages and the legend.
        name: Option<String> = key::text(), otherwise "the file's name";
        /// A scenario or an overlay, or its address: ORBAT Mapper, MSDL, NVG, MilX, Cursor on Target, KML, GeoJSON, a table
        /// (CSV, xlsx, ods) or any other vector file.
        file: Stated<String> = key::file(), required;
        /// The layer of a file that holds several.
        layer: Option<Stated<String>> = key::filled_text(), otherwise "all, or the file's only layer";
        /// The features that are taken, as in other tables.
        selection as "where": Option<Stated<Selection>> = key::selection(), otherwise "all features";
        /// Coordinate system of a file that names none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "what the file names";
        /// Of a table (CSV, spreadsheet), the columns by what they hold: `position`, `lon`, `lat`, `x`, `y`, `zone`, `z` or `shape`, or
        /// the name of a property, such as `{ position = "Grid", sidc = "Code" }`.
        columns: Option<Stated<BTreeMap<String, String>>> = key::named_texts(), otherwise "by the names of the columns";
        /// The moment that is shown of a file whose things have states in time, such as `1982-05-21T12:00:00Z`.
        time: Option<Stated<String>> = key::filled_text(), otherwise "each thing as it is last";
        /// Height of the frame of a friendly unit in a picture 1080 pixels high.
        size: f64 = key::number(Within(12.0, 200.0), "px"), default 38;
        /// Instead of `size`: height of that frame on the ground, so that near symbols are larger, from 16 to 120 pixels.
        extent: Option<f64> = key::number(Above(0.0, 1e6), "m"), otherwise "by `size`";
        /// The lower, the more important: more important symbols take their places first, and are larger where room is scarce.
        rank: f64 = key::number(Within(-1e9, 1e9), ""), default 0;
    }
    check(reader) {
        if reader.key_span("extent").is_some() {
            reader.without_effect(&["size"], "on an overlay with an `extent`", "remove one of them");
        }
    }
}

impl OverlayTable {
    /// The features that are taken.
    pub fn source(&self) -> FeatureSource {
        FeatureSource {
            points: None,
            file: Some(self.file.clone()),
            layer: self.layer.clone(),
            selection: self.selection.clone(),
            crs: self.crs.clone(),
            columns: self.columns.clone(),
        }
    }
}
