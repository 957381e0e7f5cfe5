//! The source of a feature's coordinates: the keys that inline points and files have in every table.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::declaration::{KeyDeclaration, Presence};
use crate::key;
use crate::reader::TableReader;
use crate::selection::Selection;
use crate::stated::Stated;
use crate::table::Table;
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

table! {
    /// Where the coordinates of a feature come from: inline `points`, or a `file`. The keys stand in the feature's own table.
    struct FeatureSource [const LEAST: usize] {
        /// Inline coordinates, each in ±10⁹. The last point of a ring may repeat its first.
        points: Option<Stated<Vec<Position>>> = key::points(LEAST), otherwise "by `file`", unless ["file"];
        /// A vector file, or its address: GeoJSON, shapefile, GeoPackage, FlatGeobuf, GPX, KML, CityJSON, LandXML, DXF or OpenStreetMap,
        /// or a table: CSV, TSV, xlsx or ods; or a GeoTIFF of land cover, ESA WorldCover or CORINE, of which each patch is a polygon with
        /// the properties `class`, `name` and, but water, `cover`.
        file: Option<Stated<String>> = key::file(), otherwise "by `points`", unless ["points"];
        /// With `file`: the layer of a file that holds several.
        layer: Option<Stated<String>> = key::filled_text(), otherwise "the file's only layer", unless ["points"];
        /// With `file`: the features that are taken, by the values of their properties,
        /// such as `{ highway = ["primary", "trunk"] }`, or by an expression that holds for them.
        selection as "where": Option<Stated<Selection>> = key::selection(), otherwise "all features", unless ["points"];
        /// Coordinate system of `points`, or of a file that names none or a wrong one.
        crs: Option<Crs> = key::crs(), otherwise "the scene's `points_crs`, or what the file names";
        /// With a table (CSV, spreadsheet) as `file`: the columns by what they hold, `position`, `lon`, `lat`, `x`, `y`, `zone`, `z` or
        /// `shape`, or the name of a property, such as `{ position = "Grid" }`.
        columns: Option<Stated<BTreeMap<String, String>>> = key::named_texts(), otherwise "by the names of the columns", unless ["points"];
    }
    check(reader) {
        reader.exclude("file", "points");
        reader.need_either("points", "file", "add `points = [[x, y], ...]` or `file = \"name.geojson\"`");
        if reader.key_span("file").is_none() && reader.key_span("points").is_some() {
            reader.without_effect(&["layer", "where", "columns"], "on inline `points`", "name a `file`, or remove it");
        }
    }
}

impl FeatureSource {
    /// The features of a table whose own keys name a file; `None` where it names none.
    pub fn of_file(
        file: &Option<Stated<String>>,
        layer: &Option<Stated<String>>,
        selection: &Option<Stated<Selection>>,
        crs: &Option<Crs>,
        columns: &Option<Stated<BTreeMap<String, String>>>,
    ) -> Option<Self> {
        let (layer, selection, crs) = (layer.clone(), selection.clone(), crs.clone());
        let columns = columns.clone();
        let of = |file: &Stated<String>| Self {
            points: None,
            file: Some(file.clone()),
            layer,
            selection,
            crs,
            columns,
        };
        file.as_ref().map(of)
    }

    /// The bytes of the scene file that state the coordinates or the file's name, for messages.
    pub fn span(&self) -> Range<usize> {
        let points = self.points.as_ref().and_then(Stated::span);
        points.or_else(|| self.file.as_ref().and_then(Stated::span)).unwrap_or_default()
    }
}
