//! Features over ground without data.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::table_sources::table_sources;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_vector::feature::Geometry;

/// A smaller share of a table over voids is its ragged border.
const LEAST_SHARE: f64 = 0.01;
/// The places of one table that are looked at are at most about this many.
const MOST_PLACES: usize = 200_000;

/// How many places of a table lie over voids.
struct VoidShare {
    span: Range<usize>,
    noun: &'static str,
    over: usize,
    all: usize,
}

/// Finds tables of which a part lies over ground without data.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let lattice = &*context.scene.lattice;
    if lattice.heights().iter().all(|height| !height.is_nan()) {
        return;
    }
    let (ground, extent) = (FullResolution { lattice }, lattice.extent());
    let mut shares: BTreeMap<usize, VoidShare> = BTreeMap::new();
    for table in table_sources(context.document) {
        let places = places(context, &table.source, lattice.cell().min_element());
        let within: Vec<DVec2> = places.into_iter().filter(|at| extent.contains(*at)).collect();
        let over = within.iter().filter(|at| ground.displayed_z(**at).is_none()).count();
        let span = table.source.span();
        shares.insert(span.start, VoidShare { span, noun: table.noun, over, all: within.len() });
    }
    for VoidShare { span, noun, over, all } in shares.into_values() {
        let share = over as f64 / all.max(1) as f64;
        if share >= LEAST_SHARE {
            let message = format!("{:.0} % of the {noun} lie over ground without data", share * 100.0);
            let finding = context.finding(FindingCode::OverVoid, span, message);
            sink.add(
                finding.with_help(
                    "fill the voids with `fill_voids = true` under [terrain], or take another model",
                ),
            );
        }
    }
}

/// Places along the lines, the outlines and at the points of a source, in world coordinates, a cell apart.
fn places(context: &LintContext<'_>, source: &FeatureSource, cell_m: f64) -> Vec<DVec2> {
    let mut places: Vec<DVec2> = Vec::new();
    let Ok((crs, shapes)) = context.sources.geometries(source) else { return places };
    let world =
        |at: DVec2| crs.transform(&context.scene.crs, at).ok().map(|at| at - context.scene.lattice.origin());
    for shape in &shapes {
        let lines: Vec<Vec<DVec2>> = match shape {
            Geometry::Points(points) => points.iter().map(|&at| vec![at]).collect(),
            Geometry::Lines(lines) => lines.clone(),
            Geometry::Polygons(polygons) => polygons.iter().map(|polygon| polygon.exterior.clone()).collect(),
        };
        for line in lines {
            let line: Vec<DVec2> = line.into_iter().filter_map(world).collect();
            places.extend(line.first());
            for ends in line.windows(2) {
                let steps = (ends[0].distance(ends[1]) / cell_m).ceil().clamp(1.0, 10_000.0) as usize;
                places.extend((1..=steps).map(|step| ends[0].lerp(ends[1], step as f64 / steps as f64)));
            }
            if places.len() > MOST_PLACES {
                return places;
            }
        }
    }
    places
}
