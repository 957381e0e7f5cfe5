//! Kinds of analysis and what one gives as JSON: the catalog, and the figures, tables and notes of an outcome.

use serde_json::{Map, Value, json};

use super::outcome::json_value;
use sandtable_analysis::outcome::{Figure, Outcome, OutcomeTable, PropertyValue};
use sandtable_catalog::kind::{AnalysisKind, AnalysisReach, AnalysisYield};
use sandtable_catalog::kinds;
use sandtable_catalog::parameter::{AnalysisParameter, ParameterDefault, ParameterForm};
use sandtable_query::analysis::WrittenArgument;

/// Every kind with its parameters, in the catalog's order.
pub fn catalog_json() -> Value {
    kinds().map(kind_json).collect()
}

fn kind_json(kind: &AnalysisKind) -> Value {
    let gives = match kind.yields {
        AnalysisYield::Raster => "raster",
        AnalysisYield::Features => "features",
        AnalysisYield::Both => "raster and features",
        AnalysisYield::Table => "table",
    };
    json!({
        "name": kind.name,
        "family": format!("{:?}", kind.family).to_lowercase(),
        "title": kind.title,
        "summary": kind.summary,
        "gives": gives,
        "parts": kind.reach != AnalysisReach::Whole,
        "layers": kind.layers.iter().map(|layer| layer.noun()).collect::<Vec<_>>(),
        "parameters": kind.all_parameters().map(parameter_json).collect::<Vec<_>>(),
        "source": kind.source,
        "limits": kind.limits,
    })
}

fn parameter_json(parameter: &AnalysisParameter) -> Value {
    let mut object = json!({
        "name": parameter.name,
        "doc": parameter.doc,
        "required": parameter.default == ParameterDefault::Required,
    });
    if !parameter.unit.is_empty() {
        object["unit"] = parameter.unit.into();
    }
    match parameter.default {
        ParameterDefault::Required => {}
        ParameterDefault::Value(text) => object["default"] = text.into(),
        ParameterDefault::Otherwise(text) => object["otherwise"] = text.into(),
    }
    let form = match parameter.form {
        ParameterForm::Number { .. } => "number",
        ParameterForm::Numbers { .. } => "numbers",
        ParameterForm::Word(_) => "word",
        ParameterForm::Points { .. } => "points",
        ParameterForm::Line => "line",
        ParameterForm::Area => "area",
        ParameterForm::Vehicle => "vehicle",
        ParameterForm::Ground => "ground",
        ParameterForm::Extent => "extent",
    };
    object["form"] = form.into();
    match parameter.form {
        ParameterForm::Number { least, greatest } | ParameterForm::Numbers { least, greatest } => {
            object["least"] = least.into();
            object["greatest"] = greatest.into();
        }
        ParameterForm::Word(words) => object["words"] = words.into(),
        ParameterForm::Points { least } => object["least"] = least.into(),
        _ => {}
    }
    object
}

/// An outcome without its raster and features: its kind, arguments, figures, tables and notes.
pub fn outcome_json(kind: &AnalysisKind, arguments: &[WrittenArgument], outcome: &Outcome) -> Value {
    let figures: Vec<Value> = outcome
        .figures
        .iter()
        .map(|Figure { name, value, unit }| json!({ "name": name, "value": value, "unit": unit }))
        .collect();
    json!({
        "kind": kind.name,
        "source": kind.source,
        "limits": kind.limits,
        "arguments": arguments.iter().map(|argument| (argument.name.clone(), Value::from(argument.text.as_str()))).collect::<Map<_, _>>(),
        "figures": figures,
        "tables": outcome.tables.iter().map(table_json).collect::<Vec<_>>(),
        "features": outcome.features.len(),
        "notes": outcome.notes,
    })
}

fn table_json(table: &OutcomeTable) -> Value {
    let object = |row: &Vec<PropertyValue>| -> Map<String, Value> {
        table
            .columns
            .iter()
            .zip(row)
            .map(|(column, cell)| (column.name.to_owned(), json_value(cell)))
            .collect()
    };
    json!({ "title": table.title, "rows": table.rows.iter().map(object).collect::<Vec<_>>() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_catalog_states_forms_ranges_words_and_defaults() {
        let catalog = catalog_json();
        let kinds = catalog.as_array().expect("a list");
        assert_eq!(kinds.len(), sandtable_catalog::kinds().count());
        let slope = kinds.iter().find(|kind| kind["name"] == "slope").expect("a kind");
        assert_eq!((&slope["gives"], &slope["parts"]), (&json!("raster"), &json!(true)));
        let unit =
            slope["parameters"].as_array().and_then(|all| all.iter().find(|one| one["name"] == "unit"));
        let unit = unit.expect("a parameter");
        assert_eq!((&unit["default"], &unit["words"]), (&json!("percent"), &json!(["percent", "degrees"])));
        for kind in kinds {
            let last = kind["parameters"].as_array().and_then(|all| all.last()).expect("a parameter");
            assert_eq!(last["name"], "extent");
        }
    }
}
