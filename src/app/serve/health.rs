//! `/health`: whether the service answers, and of what.

use crate::app::serve::datasets::{GroundState, Served};
use crate::app::serve::json;
use crate::app::serve::question::Service;
use crate::app::serve::reply::{BodyFormat, Reply};

/// The page: status, version, and every dataset with its system, its extent (of the raster as read, out to its outer
/// edges, in that system) and whether its ground in meters is `ready`, `awaited`, or why it has none.
pub fn page(service: &Service) -> Reply {
    let mut body = Vec::with_capacity(1024);
    json::raw(&mut body, "{\"status\":\"OK\",\"version\":");
    json::string(&mut body, env!("CARGO_PKG_VERSION"));
    json::raw(&mut body, ",\"datasets\":[");
    for (index, served) in service.datasets.all().iter().enumerate() {
        json::raw(&mut body, if index == 0 { "" } else { "," });
        write(served, &mut body);
    }
    json::raw(&mut body, "]}");
    Reply { form: BodyFormat::Json, body }
}

fn write(served: &Served, out: &mut Vec<u8>) {
    json::raw(out, "{\"name\":");
    out.extend_from_slice(&served.name_json);
    let source = served.data.source();
    json::raw(out, ",\"crs\":");
    match &source.crs {
        Some(crs) => json::string(out, crs.name()),
        None => json::raw(out, "null"),
    }
    let extent = source.extent();
    let sides = [
        (",\"extent\":{\"min_x\":", extent.min.x),
        (",\"min_y\":", extent.min.y),
        (",\"max_x\":", extent.max.x),
        (",\"max_y\":", extent.max.y),
    ];
    for (name, value) in sides {
        json::raw(out, name);
        json::number(out, value);
    }
    json::raw(out, "},\"columns\":");
    json::whole(out, source.width.into());
    json::raw(out, ",\"rows\":");
    json::whole(out, source.height.into());
    json::raw(out, ",\"ground\":");
    match served.ground() {
        GroundState::Ready => json::raw(out, "\"ready\""),
        GroundState::Awaited => json::raw(out, "\"awaited\""),
        GroundState::None(reason) => json::string(out, &format!("none: {reason}")),
    }
    json::raw(out, "}");
}
