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

impl From<String> for ReportCell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<&'static str> for ReportCell {
    fn from(text: &'static str) -> Self {
        Self::Text(text.into())
    }
}

impl From<f64> for ReportCell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<usize> for ReportCell {
    fn from(count: usize) -> Self {
        Self::Count(count)
    }
}

impl<T: Into<Self>> From<Option<T>> for ReportCell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Declares the tables of the report and the struct of each one's rows.
macro_rules! report {
    ($(
        $(#[$table_attribute:meta])*
        $table:ident: $row:ident {
            $($(#[$attribute:meta])* $field:ident $(as $name:literal)?: $type:ty $(, $unit:literal)?;)+
        }
    )+) => {
        $(
            $(#[$table_attribute])*
            #[derive(Clone, Debug, PartialEq)]
            pub struct $row {
                $($(#[$attribute])* pub $field: $type,)+
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
        /// The lake; may be empty, as in all rows.
        name: String;
        /// Elevation of the water.
        level: f64, "m";
        /// The rule of the level, or `given`.
        rule: &'static str;
        /// Lowest ground along the shore.
        lowest_shore: Option<f64>, "m";
        /// Highest ground along the shore.
        highest_shore: Option<f64>, "m";
        /// Area of the water, on the elevation model or off, without islands.
        area: f64, "m2";
        /// Earth cut.
        cut: f64, "m3";
        /// Earth filled.
        fill: f64, "m3";
    }

    /// Rivers whose water falls.
    rivers: RiverRow {
        /// The river.
        name: String;
        /// Length of the centerline.
        length: f64, "m";
        /// Elevation of the water at its source.
        from: Option<f64>, "m";
        /// Elevation of the water at its mouth.
        to: Option<f64>, "m";
        /// Deepest cut.
        deepest_cut: f64, "m";
        /// Earth cut.
        cut: f64, "m3";
        /// Earth filled.
        fill: f64, "m3";
        /// Places where the ground rises downstream by more than may be cut.
        climbs: usize;
        /// Greatest rise of the ground at one of them.
        greatest_climb: Option<f64>, "m";
    }

    /// Roads that the ground follows.
    conformed_roads: ConformedRoadRow {
        /// The road.
        name: String;
        /// Length of the centerline.
        length: f64, "m";
        /// Steepest grade along it.
        highest_grade: f64, "%";
        /// Earth cut.
        cut: f64, "m3";
        /// Earth filled.
        fill: f64, "m3";
        /// Height of its highest embankment.
        highest_fill: f64, "m";
        /// Depth of its deepest cutting.
        deepest_cut: f64, "m";
        /// Stretches on bridges.
        bridges: usize;
        /// Stretches in tunnels.
        tunnels: usize;
    }

    /// Ground leveled under buildings.
    building_pads: BuildingPadRow {
        /// The building.
        name: String;
        /// Elevation of the pad.
        level: f64, "m";
        /// Earth cut.
        cut: f64, "m3";
        /// Earth filled.
        fill: f64, "m3";
    }

    /// Trenches dug.
    trenches: TrenchRow {
        /// The trench.
        name: String;
        /// Length on the elevation model.
        length: f64, "m";
        /// Earth cut.
        cut: f64, "m3";
    }

    /// Bridges and tunnels.
    bridges_and_tunnels: SpanRow {
        /// The road or the bridge.
        name: String;
        /// `bridge`, `tunnel` or `underpass`.
        kind: &'static str;
        /// Why it is one: `tag`, `rule` or `table`.
        by: &'static str;
        /// Length of the centerline.
        length: f64, "m";
        /// Greatest height of the carriageway above the ground.
        greatest_height_above_ground: f64, "m";
        /// Greatest depth of the carriageway below the ground.
        greatest_depth_below_ground: f64, "m";
        /// Steepest grade along it.
        steepest_grade: f64, "%";
        /// Piers of a bridge.
        piers: Option<usize>;
        /// Portals of a tunnel.
        portals: Option<usize>;
        /// Lowest clearance over what passes below.
        lowest_clearance: Option<f64>, "m";
    }

    /// Models that stand at one place. A gap is the height of a corner of the model's foot above the ground under it,
    /// negative where it is buried; over the finest ground.
    models: ModelRow {
        /// The model.
        name: String;
        /// Elevation of the ground that it stands on; of a model at a stated elevation none.
        anchor: Option<f64>, "m";
        /// Gap at the front left corner.
        gap_front_left: Option<f64>, "m";
        /// Gap at the front right corner.
        gap_front_right: Option<f64>, "m";
        /// Gap at the back right corner.
        gap_back_right: Option<f64>, "m";
        /// Gap at the back left corner.
        gap_back_left: Option<f64>, "m";
        /// Lean.
        tilt: f64, "deg";
        /// Height of its plinth.
        plinth: Option<f64>, "m";
        /// Earth cut for its pad.
        cut: Option<f64>, "m3";
        /// Earth filled for its pad.
        fill: Option<f64>, "m3";
    }

    /// Tables of models with instances.
    instances: InstancesRow {
        /// The table, or its file.
        name: String;
        /// Models.
        models: usize;
        /// Points off the ground.
        off_the_ground: usize;
        /// Points without one of the variants.
        of_no_variant: usize;
        /// Least gap at any corner.
        least_gap: Option<f64>, "m";
        /// Greatest gap at any corner.
        greatest_gap: Option<f64>, "m";
        /// Greatest lean.
        greatest_tilt: Option<f64>, "deg";
        /// Height of the highest plinth.
        highest_plinth: Option<f64>, "m";
        /// Earth cut for pads.
        cut: Option<f64>, "m3";
        /// Earth filled for pads.
        fill: Option<f64>, "m3";
    }

    /// Models scattered over areas.
    scattered: ScatterRow {
        /// The table.
        name: String;
        /// Models.
        models: usize;
        /// Areas.
        areas: usize;
        /// Points without a model because of the slope.
        by_slope: usize;
        /// Points without a model because of the elevation.
        by_elevation: usize;
        /// Points without a model because of roads, water and buildings.
        by_obstacles as "by roads, water and buildings": usize;
        /// Points off the ground.
        off_the_ground: usize;
    }
}
