//! What the panel shows of an analysis: its legend, figures and tables, made once.

use std::collections::BTreeMap;

use sandtable_analysis::outcome::{Figure, Hatching, OutcomeTable, ValueClass, with_unit};
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
    /// The classes of its raster that the land has, with what is drawn of their looks.
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
            classes: drawn_classes(analysis),
            lines: legend_lines(analysis),
            figures: outcome.figures.clone(),
            features: outcome.features.len(),
            tables: outcome.tables.iter().map(ListedTable::new).collect(),
            notes: outcome.notes.clone(),
        }
    }
}

/// The classes of an analysis without the tints, or without the hatching, that are not drawn. Hatching without a tint keeps its
/// color.
fn drawn_classes(analysis: &SceneAnalysis) -> Vec<ValueClass> {
    let (is_tinted, is_hatched) = (analysis.tinted_raster().is_some(), analysis.hatched_raster().is_some());
    let mut classes = legend_classes(analysis);
    for ValueClass { look, .. } in &mut classes {
        if !is_tinted {
            look.tint[3] = 0;
        }
        if !is_hatched {
            look.hatching = Hatching::None;
        }
    }
    classes
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
    use glam::DVec2;
    use sandtable_analysis::outcome::{Outcome, OutcomeRaster, PostValues, PropertyValue, TableColumn};
    use sandtable_description::words::AnalysisDraw;
    use sandtable_terrain::lattice::Lattice;
    use std::sync::Arc;

    #[test]
    fn figures_have_no_needless_zeros() {
        let text = |value: f64, unit: &'static str| figure_text(&Figure::new("area", value, unit));
        assert_eq!([text(12.5, "km²"), text(100.0, ""), text(0.0004, "m")], ["12.5 km²", "100", "0 m"]);
    }

    #[test]
    fn classes_look_as_they_are_drawn() {
        let looks = |draw: AnalysisDraw| {
            let raster = OutcomeRaster {
                name: "obstacles",
                unit: "",
                values: PostValues::Codes(vec![1; 4]),
                classes: vec![ValueClass::new(1.0, "restricted", [200, 10, 20, 90], Hatching::Single)],
            };
            let analysis = SceneAnalysis {
                name: "Overlay".to_owned(),
                kind: sandtable_catalog::kind("obstacles").expect("a kind"),
                number: 0,
                draw,
                color: None,
                feature: FeatureId(2),
                ground: Arc::new(Lattice::new(DVec2::ZERO, DVec2::ONE, 2, vec![0.0; 4]).expect("sound")),
                outcome: Outcome { raster: Some(raster), ..Outcome::default() },
            };
            let classes = AnalysisListing::new(&analysis).classes;
            classes.iter().map(|class| (class.look.tint, class.look.hatching)).collect::<Vec<_>>()
        };
        assert_eq!(looks(AnalysisDraw::All), [([200, 10, 20, 90], Hatching::Single)]);
        assert_eq!(looks(AnalysisDraw::Tints), [([200, 10, 20, 90], Hatching::None)]);
        assert_eq!(looks(AnalysisDraw::Hatching), [([200, 10, 20, 0], Hatching::Single)]);
        assert_eq!(looks(AnalysisDraw::Features), []);
        assert_eq!(looks(AnalysisDraw::Nothing), []);
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
