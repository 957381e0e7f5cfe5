//! Measures of single features: typed rows, a struct per table.
//!
//! A new table is a block in `report!`. The name and the unit of a column
//! come from its field: `lowest_shore: f64, "m"` is `lowest shore [m]` in text, `lowest_shore_m` in JSON and CSV.

/// One table for output: a row for each feature.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportTable {
    /// Its title, such as `conformed roads`.
    pub name: String,
    /// Its columns.
    pub columns: &'static [ReportColumn],
    /// A cell for each column.
    pub rows: Vec<Vec<ReportCell>>,
}

/// A column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReportColumn {
    /// The name as a word, such as `deepest_cut`.
    name: &'static str,
    /// The unit, such as `m3`; empty for names and counts.
    unit: &'static str,
}

impl ReportColumn {
    /// The heading of the column in text, such as `deepest cut [m]`.
    pub fn heading(&self) -> String {
        let name = self.name.replace('_', " ");
        if self.unit.is_empty() { name } else { format!("{name} [{}]", self.unit) }
    }

    /// The name of the column in JSON and CSV, such as `deepest_cut_m`.
    pub fn key(&self) -> String {
        let name = self.name.replace(' ', "_");
        if self.unit.is_empty() { name } else { format!("{name}_{}", self.unit).replace('%', "percent") }
    }
}

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum ReportCell {
    /// A name; may be empty.
    Text(String),
    /// A measure in the column's unit.
    Number(f64),
    /// A count.
    Count(usize),
    /// No value.
    Empty,
}

macro_rules! cells {
    ($($value:ty => $cell:expr;)+) => {$(
        impl From<$value> for ReportCell {
            fn from(value: $value) -> Self {
                $cell(value.into())
            }
        }
    )+};
}

cells! {
    String => Self::Text;
    &'static str => Self::Text;
    f64 => Self::Number;
    usize => Self::Count;
}

impl<T: Into<Self>> From<Option<T>> for ReportCell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Declares the tables of the report and the struct of each one's rows: `column: type, "unit" => "what it holds"`.
macro_rules! report {
    ($(
        $(#[$table_attribute:meta])*
        $table:ident: $row:ident {
            $($field:ident $(as $name:literal)?: $type:ty $(, $unit:literal)? => $doc:literal;)+
        }
    )+) => {
        $(
            $(#[$table_attribute])*
            #[derive(Clone, Debug, PartialEq)]
            pub struct $row {
                $(#[doc = $doc] pub $field: $type,)+
            }

            impl $row {
                const COLUMNS: &'static [ReportColumn] =
                    &[$(ReportColumn { name: report!(@name $field $($name)?), unit: concat!($($unit)?) },)+];

                fn cells(&self) -> Vec<ReportCell> {
                    vec![$(self.$field.clone().into()),+]
                }
            }
        )+

        /// All tables of the report.
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct SceneReport {
            $($(#[$table_attribute])* pub $table: Vec<$row>,)+
        }

        impl SceneReport {
            /// The tables that have rows, for output.
            pub fn tables(&self) -> Vec<ReportTable> {
                let all = [$(ReportTable {
                    name: stringify!($table).replace('_', " "),
                    columns: $row::COLUMNS,
                    rows: self.$table.iter().map($row::cells).collect(),
                }),+];
                all.into_iter().filter(|table| !table.rows.is_empty()).collect()
            }
        }
    };
    (@name $field:ident) => { stringify!($field) };
    (@name $field:ident $name:literal) => { $name };
}

report! {
    /// Lakes.
    lakes: LakeRow {
        name: String => "The lake; may be empty, as in all rows.";
        level: f64, "m" => "Elevation of the water.";
        rule: &'static str => "How the level was found: the level rule, or `given`.";
        lowest_shore: Option<f64>, "m" => "Lowest ground along the shore.";
        median_shore: Option<f64>, "m" => "Ground along the shore with as much of the shore below it as above.";
        highest_shore: Option<f64>, "m" => "Highest ground along the shore.";
        area: f64, "m2" => "Area of the water, on the elevation model or off, without islands.";
        cut: f64, "m3" => "Earth cut.";
        fill: f64, "m3" => "Earth filled.";
    }

    /// Rivers whose water falls.
    rivers: RiverRow {
        name: String => "The river.";
        length: f64, "m" => "Length of the centerline.";
        from: Option<f64>, "m" => "Elevation of the water at its source.";
        to: Option<f64>, "m" => "Elevation of the water at its mouth.";
        deepest_cut: f64, "m" => "Deepest cut.";
        cut: f64, "m3" => "Earth cut.";
        fill: f64, "m3" => "Earth filled.";
        climbs: usize => "Places where the ground rises downstream by more than may be cut.";
        greatest_climb: Option<f64>, "m" => "Greatest rise of the ground at one of them.";
    }

    /// Roads that the ground follows.
    conformed_roads: ConformedRoadRow {
        name: String => "The road.";
        length: f64, "m" => "Length of the centerline.";
        highest_grade: f64, "%" => "Steepest grade along it.";
        cut: f64, "m3" => "Earth cut.";
        fill: f64, "m3" => "Earth filled.";
        highest_fill: f64, "m" => "Height of its highest embankment.";
        deepest_cut: f64, "m" => "Depth of its deepest cutting.";
        bridges: usize => "Stretches on bridges.";
        tunnels: usize => "Stretches in tunnels.";
    }

    /// Ground leveled under buildings.
    building_pads: BuildingPadRow {
        name: String => "The building.";
        level: f64, "m" => "Elevation of the pad.";
        cut: f64, "m3" => "Earth cut.";
        fill: f64, "m3" => "Earth filled.";
    }

    /// Trenches dug.
    trenches: TrenchRow {
        name: String => "The trench.";
        length: f64, "m" => "Length on the elevation model.";
        cut: f64, "m3" => "Earth cut.";
    }

    /// Earthworks of the scene file.
    earthworks: EarthworkRow {
        name: String => "The earthwork.";
        kind: &'static str => "`crater`, `trench`, `track`, `level` or `raise`.";
        area: f64, "m2" => "Area in which the ground changed.";
        cut: f64, "m3" => "Earth cut.";
        fill: f64, "m3" => "Earth filled.";
    }

    /// Bridges and tunnels.
    bridges_and_tunnels: SpanRow {
        name: String => "The road or the bridge.";
        kind: &'static str => "`bridge`, `tunnel` or `underpass`.";
        by: &'static str => "Why it is one: `tag`, `rule` or `table`.";
        length: f64, "m" => "Length of the centerline.";
        greatest_height_above_ground: f64, "m" => "Greatest height of the carriageway above the ground.";
        greatest_depth_below_ground: f64, "m" => "Greatest depth of the carriageway below the ground.";
        steepest_grade: f64, "%" => "Steepest grade along it.";
        piers: Option<usize> => "Piers of a bridge.";
        portals: Option<usize> => "Portals of a tunnel.";
        lowest_clearance: Option<f64>, "m" => "Lowest clearance over what passes below.";
    }

    /// Models that stand at one place. A gap is the height of a corner of the model's foot above the ground under it,
    /// negative where it is buried; over the finest ground.
    models: ModelRow {
        name: String => "The model.";
        anchor: Option<f64>, "m" => "Elevation of the ground that it stands on; of a model at a stated elevation none.";
        gap_front_left: Option<f64>, "m" => "Gap at the front left corner.";
        gap_front_right: Option<f64>, "m" => "Gap at the front right corner.";
        gap_back_right: Option<f64>, "m" => "Gap at the back right corner.";
        gap_back_left: Option<f64>, "m" => "Gap at the back left corner.";
        tilt: f64, "deg" => "Lean.";
        plinth: Option<f64>, "m" => "Height of its plinth.";
        cut: Option<f64>, "m3" => "Earth cut for its pad.";
        fill: Option<f64>, "m3" => "Earth filled for its pad.";
    }

    /// Tables of models with instances.
    instances: InstancesRow {
        name: String => "The table, or its file.";
        models: usize => "Models.";
        off_the_ground: usize => "Points off the ground.";
        of_no_variant: usize => "Points that name none of the variants.";
        least_gap: Option<f64>, "m" => "Least gap at any corner.";
        greatest_gap: Option<f64>, "m" => "Greatest gap at any corner.";
        greatest_tilt: Option<f64>, "deg" => "Greatest lean.";
        highest_plinth: Option<f64>, "m" => "Height of the highest plinth.";
        cut: Option<f64>, "m3" => "Earth cut for pads.";
        fill: Option<f64>, "m3" => "Earth filled for pads.";
    }

    /// Models scattered over areas.
    scattered: ScatterRow {
        name: String => "The table.";
        models: usize => "Models.";
        areas: usize => "Areas.";
        by_slope: usize => "Places left free for the slope of the ground.";
        by_elevation: usize => "Places left free for the elevation of the ground.";
        by_obstacles as "by roads, water and buildings": usize => "Places left free for roads, water and buildings.";
        off_the_ground: usize => "Places off the ground.";
    }
}
