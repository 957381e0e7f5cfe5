//! Writes a layer as GeoJSON that [`read`](crate::read::read) reads as the same layer: with the `crs` member of GeoJSON 2008,
//! and numbers in as many digits as tell them apart.

use glam::DVec2;
use serde_json::{Value, json};

use crate::feature::{Feature, Geometry, Polygon, VectorLayer};

/// The layer as the text of a GeoJSON file.
///
/// ```
/// use sandtable_vector::geojson::write::geojson_text;
/// use sandtable_vector::hints::VectorHints;
/// use sandtable_vector::read::read;
/// let text = br#"{"type":"Feature","geometry":{"type":"Point","coordinates":[1.5,2.0]},"properties":{"ele":3}}"#;
/// let layer = read("a.geojson", text, &VectorHints::default())?;
/// let again = read("b.geojson", geojson_text(&layer).as_bytes(), &VectorHints::default())?;
/// assert_eq!(again.features, layer.features);
/// # Ok::<(), sandtable_vector::error::VectorError>(())
/// ```
pub fn geojson_text(layer: &VectorLayer) -> String {
    let features: Vec<Value> = layer.features.iter().map(feature).collect();
    let crs = json!({ "type": "name", "properties": { "name": layer.crs.name() } });
    let collection = json!({ "type": "FeatureCollection", "crs": crs, "features": features });
    format!("{collection}\n")
}

fn feature(feature: &Feature) -> Value {
    let elevations = feature.elevations.as_deref().unwrap_or_default();
    let mut positions = Positions { elevations };
    let (kind, mut parts) = match &feature.geometry {
        Geometry::Points(points) => ("Point", positions.line(points)),
        Geometry::Lines(lines) => {
            ("LineString", lines.iter().map(|line| positions.line(line).into()).collect())
        }
        Geometry::Polygons(polygons) => {
            ("Polygon", polygons.iter().map(|polygon| positions.polygon(polygon)).collect())
        }
    };
    let geometry = match parts.len() {
        1 => json!({ "type": kind, "coordinates": parts.remove(0) }),
        _ => json!({ "type": format!("Multi{kind}"), "coordinates": parts }),
    };
    json!({ "type": "Feature", "geometry": geometry, "properties": feature.properties })
}

/// The elevations of the vertices that are still to be written.
struct Positions<'a> {
    elevations: &'a [f64],
}

impl Positions<'_> {
    fn line(&mut self, vertices: &[DVec2]) -> Vec<Value> {
        vertices.iter().map(|vertex| self.position(*vertex)).collect()
    }

    /// A polygon's rings, each closed by its first vertex.
    fn polygon(&mut self, polygon: &Polygon) -> Value {
        let closed = |ring: &Vec<DVec2>| {
            let mut ring = self.line(ring);
            ring.extend(ring.first().cloned());
            Value::Array(ring)
        };
        polygon.rings().map(closed).collect()
    }

    fn position(&mut self, at: DVec2) -> Value {
        let elevation = self.elevations.split_off_first().filter(|elevation| elevation.is_finite());
        match elevation {
            Some(elevation) => json!([at.x, at.y, elevation]),
            None => json!([at.x, at.y]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::Properties;
    use crate::hints::VectorHints;
    use crate::read::read;
    use sandtable_geom::crs::Crs;

    #[test]
    fn a_written_layer_reads_as_it_was() {
        let ring = |x: f64| vec![DVec2::new(x, 0.1), DVec2::new(x + 9.0, 0.2), DVec2::new(x, 9.3)];
        let polygon = |x: f64, holes: Vec<Vec<DVec2>>| Polygon { exterior: ring(x), holes };
        let feature = |geometry, elevations| {
            let properties: Properties =
                [("width".to_owned(), json!(3.25)), ("name".to_owned(), json!("Ö \"x\""))].into();
            Feature { geometry, elevations, properties }
        };
        let holed = vec![polygon(1e6 / 3.0, vec![ring(2.0), ring(5.0)]), polygon(700.0, Vec::new())];
        let features = vec![
            feature(Geometry::Points(vec![DVec2::new(0.1, 0.2)]), Some(vec![0.3])),
            feature(Geometry::Points(ring(4.0)), None),
            feature(Geometry::Lines(vec![ring(4.0), ring(8.0)]), Some(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
            feature(Geometry::Polygons(holed), Some((0..12).map(f64::from).collect())),
        ];
        let crs = Crs::parse("EPSG:32616").expect("known");
        let layer = VectorLayer { features, crs, notes: Vec::new(), faults: Vec::new() };
        let read =
            read("a.geojson", geojson_text(&layer).as_bytes(), &VectorHints::default()).expect("sound");
        assert_eq!((read.features, read.crs), (layer.features, layer.crs));
    }
}
