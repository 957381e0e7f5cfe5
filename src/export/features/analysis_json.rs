//! Kinds of analysis and what one gives as JSON: the catalog, and the figures, tables and notes of an outcome.

use serde_json::{Map, Value, json};

use super::outcome::json_value;
use sandtable_analysis::outcome::{Figure, Outcome, OutcomeTable, PropertyValue, ValueClass};
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

/// The classes of a raster's values, rising: the least value, the name, the color and its opacity, 0 to 1.
pub fn classes_json(classes: &[ValueClass]) -> Value {
    let class = |class: &ValueClass| {
        let [red, green, blue, opacity] = class.look.tint;
        json!({
            // As written in decimals: the value as f64 has digits that nobody stated.
            "from": class.from.to_string().parse::<f64>().ok().filter(|from| from.is_finite()),
            "label": class.label,
            "color": format!("#{red:02x}{green:02x}{blue:02x}"),
            "opacity": (f64::from(opacity) / 255.0 * 1000.0).round() / 1000.0,
        })
    };
    classes.iter().map(class).collect()
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
    use sandtable_analysis::outcome::Hatching;

    #[test]
    fn classes_state_their_least_value_name_color_and_opacity() {
        let class = ValueClass::new(0.3, "steep", [255, 0, 16, 128], Hatching::None);
        let below = ValueClass::new(f32::NEG_INFINITY, "below", [0; 4], Hatching::None);
        let expected = json!([
            { "from": null, "label": "below", "color": "#000000", "opacity": 0.0 },
            { "from": 0.3, "label": "steep", "color": "#ff0010", "opacity": 0.502 },
        ]);
        assert_eq!(classes_json(&[below, class]), expected);
    }

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
