//! The sheets of an atlas as items of a catalog: footprints that other programs search (SpatioTemporal Asset Catalog 1.0.0).

use glam::DVec2;
use serde_json::{Value, json};

use crate::atlas::index::IndexedSheet;
use crate::atlas::plan::sheet_rect;
use crate::record::ShardState;
use crate::shard::SheetNeighbors;
use sandtable_geom::crs::Crs;
use sandtable_geom::rect::Rect;

/// The sheets as a GeoJSON collection of items; `crs` is the system of the scene.
pub fn items(title: &str, scale: f64, crs: &Crs, sheets: &[IndexedSheet]) -> Value {
    let items: Vec<Value> = sheets.iter().map(|sheet| item((title, scale), crs, sheet, sheets)).collect();
    json!({ "type": "FeatureCollection", "features": items })
}

fn item((title, scale): (&str, f64), crs: &Crs, sheet: &IndexedSheet, sheets: &[IndexedSheet]) -> Value {
    let IndexedSheet { shard, state, href } = sheet;
    let footprint = sheet_rect(shard).and_then(|rect| footprint(crs, &rect));
    let sides = shard.neighbors.iter().flat_map(SheetNeighbors::sides);
    let links: Vec<Value> = sides
        .filter_map(|(side, id)| {
            let IndexedSheet { shard, href, .. } = sheets.get(id)?;
            Some(json!({ "rel": side, "href": href, "title": shard.name }))
        })
        .collect();
    let mut item = json!({
        "type": "Feature",
        "stac_version": "1.0.0",
        "id": shard.name,
        "geometry": footprint.as_ref().map(|corners| {
            let ring: Vec<[f64; 2]> = corners.iter().chain(&corners[..1]).map(DVec2::to_array).collect();
            json!({ "type": "Polygon", "coordinates": [ring] })
        }),
        "properties": {
            "datetime": null,
            "title": format!("{title} · Sheet {}", shard.name),
            "sandtable:shard": shard.id,
            "sandtable:status": match state {
                ShardState::Done => "done",
                ShardState::Missing => "missing",
                ShardState::Stale => "stale",
            },
            "sandtable:scale": scale,
            "proj:code": crs.epsg().map(|code| format!("EPSG:{code}")),
            "proj:bbox": shard.window,
        },
        "assets": { "sheet": { "href": href, "type": "image/png", "roles": ["data"] } },
        "links": links,
    });
    if let Some(corners) = footprint {
        let Rect { min, max } = Rect::around(corners);
        item["bbox"] = json!([min.x, min.y, max.x, max.y]);
    }
    item
}

/// The corners of a rectangle in longitude and latitude, counterclockwise; `None` where they have none.
fn footprint(crs: &Crs, rect: &Rect) -> Option<[DVec2; 4]> {
    let Rect { min, max } = *rect;
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)];
    let placed = corners.map(|corner| crs.transform(&Crs::wgs84(), corner).unwrap_or(DVec2::NAN));
    placed.iter().all(|corner| corner.is_finite()).then_some(placed)
}
