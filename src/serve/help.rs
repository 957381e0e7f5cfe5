//! `/help`, and `/` for programs that want no page: the queries, as plain text.

use std::fmt::Write;

use axum::response::{IntoResponse, Response};

use crate::api::{ApiAddress, ApiMethods, ApiNeed, addresses};
use crate::service::Service;

/// Its path.
pub const PATH: &str = "/help";

/// The columns before the second one of an address and of a parameter.
const WIDTH: usize = 34;

pub fn page(service: &Service) -> Response {
    let first = &service.datasets.at(0).name;
    let mut text = format!(
        "sandtable {}: heights over HTTP\n\nDatasets: {}\n\n",
        env!("CARGO_PKG_VERSION"),
        service.datasets.names()
    );
    addresses().for_each(|address| describe(address, service, &mut text));
    let _ = write!(
        text,
        "\nA POST takes the same parameters as a form, in parts or not, or as a JSON object. Heights and distances are meters. At most {} \
         locations\nare answered at a time. A refusal is JSON with status and error.\n\n\
         Example: {}?locations=46.2,-122.19\n",
        service.limits.max_points,
        service.prefix.before(&format!("/v1/{first}"))
    );
    text.into_response()
}

fn describe(address: &ApiAddress, service: &Service, text: &mut String) {
    let methods = match address.methods {
        ApiMethods::Get => "GET",
        ApiMethods::GetOrPost => "GET or POST",
    };
    let _ = writeln!(
        text,
        "{:<WIDTH$}  {}",
        format!("{methods} {}", service.prefix.before(&address.path)),
        address.summary
    );
    for parameter in address.parameters.iter() {
        let form = format!("{}={}", parameter.name, parameter.value.form(&service.limits));
        let default = match parameter.need {
            ApiNeed::Required => "required".to_owned(),
            ApiNeed::Optional(default) => format!("default: {default}"),
        };
        let _ = writeln!(text, "    {form:<WIDTH$}  {} [{default}]", parameter.text);
    }
}
