//! The derived features as GeoJSON text (RFC 7946): one feature a line, six decimals of a degree, which is
//! a tenth of a meter.

use glam::DVec2;

use super::ground::Ground;
use super::lakes::Lakes;
use super::network::Road;
use super::streams::Stream;

/// `streams.geojson`.
pub fn streams(ground: &Ground, streams: &[Stream]) -> String {
    collection(streams.iter().map(|stream| {
        let name = stream.name.map(|name| format!(", \"name\": \"{name}\"")).unwrap_or_default();
        let properties =
            format!("\"order\": {}, \"drainage_km2\": {:.1}{name}", stream.order, stream.area_km2);
        feature(&properties, "LineString", &coordinates(ground, &stream.points))
    }))
}

/// `lake.geojson`.
pub fn lakes(ground: &Ground, lakes: &Lakes) -> String {
    collection(lakes.lakes.iter().map(|lake| {
        let closed = |ring: &Vec<DVec2>| ring.iter().chain(ring.first()).copied().collect::<Vec<_>>();
        let rings: Vec<String> = lake.rings.iter().map(|ring| coordinates(ground, &closed(ring))).collect();
        let properties = format!(
            "\"name\": \"{}\", \"level_m\": {}, \"area_km2\": {:.2}",
            lake.name,
            lake.level,
            lake.area / 1e6
        );
        feature(&properties, "Polygon", &format!("[{}]", rings.join(",")))
    }))
}

/// `roads.geojson`.
pub fn roads(ground: &Ground, roads: &[Road]) -> String {
    collection(roads.iter().map(|road| {
        let properties = format!(
            "\"name\": \"{}\", \"class\": \"{}\", \"surface\": \"{}\"",
            road.name, road.class, road.surface
        );
        feature(&properties, "LineString", &coordinates(ground, &road.points))
    }))
}

fn collection(features: impl Iterator<Item = String>) -> String {
    let features: Vec<String> = features.collect();
    format!("{{\"type\": \"FeatureCollection\", \"features\": [\n{}\n]}}\n", features.join(",\n"))
}

fn feature(properties: &str, kind: &str, coordinates: &str) -> String {
    format!(
        "{{\"type\": \"Feature\", \"properties\": {{{properties}}}, \
         \"geometry\": {{\"type\": \"{kind}\", \"coordinates\": {coordinates}}}}}"
    )
}

fn coordinates(ground: &Ground, points: &[DVec2]) -> String {
    let places = points.iter().map(|&at| ground.lon_lat(at));
    let texts: Vec<String> = places.map(|place| format!("[{:.6},{:.6}]", place.x, place.y)).collect();
    format!("[{}]", texts.join(","))
}
