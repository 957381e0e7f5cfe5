//! What the panel shows of an analysis: its legend, figures and tables, made once.

use std::collections::BTreeMap;

use sandtable_analysis::outcome::{Figure, OutcomeTable, ValueClass, with_unit};
use sandtable_base::message::numbers::trimmed;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_picture::analysis_look::{legend_classes, legend_lines};
use sandtable_scene::analyses::SceneAnalysis;

/// What the panel shows of an analysis.
#[derive(Clone, Debug)]
pub struct AnalysisListing {
    /// Its name in the legend.
    pub name: String,
    /// What it is.
    pub kind: &'static AnalysisKind,
    /// The feature that it is.
    pub feature: FeatureId,
    /// The classes of its raster that the land has.
    pub classes: Vec<ValueClass>,
    /// What its lines are.
    pub lines: BTreeMap<&'static str, Srgba>,
    /// Single numbers.
    pub figures: Vec<Figure>,
    /// The points, lines and areas.
    pub features: usize,
    /// Tables.
    pub tables: Vec<ListedTable>,
    /// What it left out or does not know, a sentence each.
    pub notes: Vec<String>,
}

/// A table as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListedTable {
    /// Its title.
    pub title: String,
    /// The headings of its columns.
    pub columns: Vec<String>,
    /// The cells of each row.
    pub rows: Vec<Vec<String>>,
}

impl AnalysisListing {
    /// What is shown of an analysis.
    pub fn new(analysis: &SceneAnalysis) -> Self {
        let outcome = &analysis.outcome;
        Self {
            name: analysis.name.clone(),
            kind: analysis.kind,
            feature: analysis.feature,
            classes: legend_classes(analysis),
            lines: legend_lines(analysis),
            figures: outcome.figures.clone(),
            features: outcome.features.len(),
            tables: outcome.tables.iter().map(ListedTable::new).collect(),
            notes: outcome.notes.clone(),
        }
    }
}

impl ListedTable {
    fn new(table: &OutcomeTable) -> Self {
        Self {
            title: table.title.clone(),
            columns: table.columns.iter().map(|column| with_unit(column.name, column.unit)).collect(),
            rows: table.written_rows().collect(),
        }
    }
}

/// A figure with its unit, with three decimals at most.
pub fn figure_text(figure: &Figure) -> String {
    format!("{} {}", trimmed(figure.value, 3), figure.unit).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_analysis::outcome::{PropertyValue, TableColumn};

    #[test]
    fn figures_have_no_needless_zeros() {
        let text = |value: f64, unit: &'static str| figure_text(&Figure::new("area", value, unit));
        assert_eq!([text(12.5, "km²"), text(100.0, ""), text(0.0004, "m")], ["12.5 km²", "100", "0 m"]);
    }

    #[test]
    fn tables_have_the_decimals_and_units_of_their_columns() {
        let table = OutcomeTable {
            title: "Legs".into(),
            columns: vec![TableColumn::new("to", "", 0), TableColumn::new("length", "km", 2)],
            rows: vec![vec![PropertyValue::Text("A".into()), PropertyValue::Number(1.234)]],
        };
        let listed = ListedTable::new(&table);
        assert_eq!(listed.columns, ["to", "length (km)"]);
        assert_eq!(listed.rows, [["A", "1.23"]]);
    }
}
