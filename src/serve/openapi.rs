//! `/openapi.json`: the queries as an OpenAPI document (OpenAPI Specification 3.1.0), for programs that make clients.

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde_json::{Map, Value, json};

use crate::api::{ApiAddress, ApiMethods, ApiNeed, ApiParameter, ApiValue, HEIGHTS, addresses};
use crate::parameters::BODY_TYPES;
use crate::ready;
use crate::service::Service;

/// The part of a path that is a parameter, in the table and in the document.
const DATASET: (&str, &str) = ("DATASET", "{dataset}");

pub fn page(service: &Service) -> Response {
    Json(document(service)).into_response()
}

fn document(service: &Service) -> Value {
    let paths: Map<String, Value> = addresses()
        .map(|address| (address.path.replace(DATASET.0, DATASET.1), path_item(address, service)))
        .collect();
    let mut document = json!({
        "openapi": "3.1.0",
        "info": {
            "title": "sandtable",
            "summary": "Heights, profiles, lines of sight, viewsheds and terrain analyses over HTTP",
            "version": env!("CARGO_PKG_VERSION"),
        },
        "paths": paths,
        "components": {"schemas": {"Refusal": {
            "type": "object",
            "required": ["status", "error"],
            "properties": {
                "status": {"enum": ["INVALID_REQUEST", "SERVER_ERROR"]},
                "error": {"type": "string", "description": "what was found, and what to do"},
            },
        }}},
    });
    if !service.prefix.as_str().is_empty() {
        document["servers"] = json!([{"url": service.prefix.as_str()}]);
    }
    document
}

fn path_item(address: &ApiAddress, service: &Service) -> Value {
    let in_query = address.parameters.iter().map(|parameter| {
        json!({
            "name": parameter.name,
            "in": "query",
            "required": parameter.need == ApiNeed::Required,
            "description": described(parameter),
            "schema": schema(parameter, service),
        })
    });
    let in_path = in_path(address, service);
    let mut item = json!({"get": {
        "summary": address.summary,
        "parameters": in_path.iter().cloned().chain(in_query).collect::<Vec<_>>(),
        "responses": responses(address),
    }});
    if address.methods == ApiMethods::GetOrPost {
        item["post"] = json!({
            "summary": address.summary,
            "parameters": in_path,
            "requestBody": {"required": true, "content": content(&body(address, service))},
            "responses": responses(address),
        });
    }
    item
}

/// The parameters that are parts of the path.
fn in_path(address: &ApiAddress, service: &Service) -> Vec<Value> {
    let names: Vec<&str> = service.datasets.all().iter().map(|served| served.name.as_str()).collect();
    let part = |name: &str, description: &str, schema: Value| json!({"name": name, "in": "path", "required": true, "description": description, "schema": schema});
    let dataset = address.path.contains(DATASET.0).then(|| {
        let description = match address.path == HEIGHTS.path {
            true => "the name of a dataset, or several with commas between",
            false => "the name of a dataset",
        };
        part("dataset", description, json!({"type": "string", "examples": names}))
    });
    let of_tiles = [
        ("z", "the level, 0 the coarsest"),
        ("x", "the column, from the west"),
        ("y", "the row, from the north"),
    ];
    let of_tile = of_tiles.into_iter().filter(|(name, _)| address.path.contains(&format!("{{{name}}}")));
    let numbers = of_tile.map(|(name, text)| part(name, text, json!({"type": "integer", "minimum": 0})));
    dataset.into_iter().chain(numbers).collect()
}

/// The schema of a body, in each form that it may have.
fn content(schema: &Value) -> Value {
    BODY_TYPES
        .iter()
        .map(|name| ((*name).to_owned(), json!({"schema": schema})))
        .collect::<Map<_, _>>()
        .into()
}

fn body(address: &ApiAddress, service: &Service) -> Value {
    let properties: Map<String, Value> = address
        .parameters
        .iter()
        .map(|parameter| {
            let mut schema = schema(parameter, service);
            schema["description"] = described(parameter).into();
            (parameter.name.to_owned(), schema)
        })
        .collect();
    let required = address.parameters.iter().filter(|parameter| parameter.need == ApiNeed::Required);
    let required: Vec<&str> = required.map(|parameter| parameter.name).collect();
    json!({"type": "object", "properties": properties, "required": required})
}

fn described(parameter: &ApiParameter) -> String {
    match parameter.need {
        ApiNeed::Required => parameter.text.to_string(),
        ApiNeed::Optional(default) => format!("{}; default: {default}", parameter.text),
    }
}

fn schema(parameter: &ApiParameter, service: &Service) -> Value {
    match parameter.value {
        ApiValue::Text(form) => json!({"type": "string", "examples": [form]}),
        ApiValue::Number(least, most) => json!({"type": "number", "minimum": least, "maximum": most}),
        ApiValue::Count => json!({"type": "integer", "minimum": 2, "maximum": service.limits.max_points}),
        ApiValue::Words(words) => json!({"type": "string", "enum": words()}),
        ApiValue::Listed(words) => json!({"type": "string", "enum": words}),
    }
}

fn responses(address: &ApiAddress) -> Value {
    let refusal = |what: &str| {
        let schema = json!({"$ref": "#/components/schemas/Refusal"});
        json!({"description": what, "content": {"application/json": {"schema": schema}}})
    };
    let content: Map<String, Value> =
        address.answers().into_iter().map(|answer| (answer.to_owned(), json!({}))).collect();
    let mut responses = json!({"200": {"description": address.summary, "content": content}});
    if address.methods == ApiMethods::GetOrPost {
        responses["400"] = refusal("the request is wrong");
        responses["404"] = refusal("there is no such dataset");
        responses["503"] = refusal("the client asks for too much at once, or the answer took too long");
    }
    if address.path == ready::PATH {
        responses["503"] = refusal("the datasets are being prepared, or the service ends");
    }
    responses
}
