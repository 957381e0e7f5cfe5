//! Coordinate systems that fit their data badly.

use std::collections::BTreeSet;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::table_sources::table_sources;
use sandtable_geom::crs::Crs;
use sandtable_geom::datum_shift::DatumShift;
use sandtable_scene::overridden_crs::OverriddenCrs;

/// Degrees from the central meridian of a UTM zone at which lengths are off by 0.1 %, as in no zone; zones are 3° wide on
/// either side, and neighbors overlap by some tenths.
const ZONE_REACH_DEG: f64 = 4.5;

/// Finds files whose system is overridden, scenes without a system, or far out of their zone, and data that are moved from
/// datum to datum by parameters.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    overridden(context, sink);
    let (scene, document) = (context.scene, context.document);
    let dem = document.terrain.dem.span().unwrap_or_default();
    let Ok(place) = scene.crs.transform(&Crs::wgs84(), scene.lattice.map_extent().center()) else {
        let message = "neither the elevation file nor the scene names a coordinate system that has a place on Earth: \
                       coordinates are meters in a plane";
        sink.add(
            context.finding(FindingCode::NoSystem, dem, message).with_help("state `crs` under [terrain]"),
        );
        return;
    };
    let fitting = Crs::utm_or_ups_at(place.x, place.y);
    let meridian = zone_meridian_deg(&scene.crs);
    let off_deg =
        meridian.map_or(0.0, |meridian| ((place.x - meridian + 540.0).rem_euclid(360.0) - 180.0).abs());
    if off_deg > ZONE_REACH_DEG {
        let name = scene.crs.name();
        let message = format!(
            "the scene lies {off_deg:.1}° from the central meridian of {name}, which is 3° wide on either side"
        );
        let help = format!(
            "if the coordinates are right, the zone that fits is {}: say crs = \"{0}\"",
            fitting.name()
        );
        sink.add(context.finding(FindingCode::FarFromZone, dem.clone(), message).with_help(help));
    }
    let own = scene.heights.snapshot().source_header().crs.clone();
    let mut told = BTreeSet::new();
    let stated = table_sources(document).into_iter().filter_map(|table| {
        let (crs, _) =
            context.sources.features(&table.source).ok().filter(|_| table.source.file.is_some())?;
        Some((crs, table.source.span(), table.noun))
    });
    for (crs, span, what) in own.map(|own| (own, dem, "the elevation model")).into_iter().chain(stated) {
        let Ok(DatumShift::ByWgs84 { to_wgs84, from_wgs84 }) = crs.datum_shift_to(&scene.crs) else {
            continue;
        };
        if !told.insert((crs.name().to_owned(), span.start)) {
            continue;
        }
        let shift = DatumShift::ByWgs84 { to_wgs84, from_wgs84 };
        let message = format!(
            "{what} are moved from {} to {} by parameters ({shift}), which are good to some meters",
            crs.name(),
            scene.crs.name()
        );
        let help = "where meters count, transform the data with a shift grid first, for example with ogr2ogr or gdalwarp";
        sink.add(context.finding(FindingCode::DatumShifted, span, message).with_help(help));
    }
}

/// Finds vector files whose own system the scene overrides.
fn overridden(context: &LintContext<'_>, sink: &mut FindingSink) {
    for table in table_sources(context.document) {
        let source = &*table.source;
        let (Some(file), Some(stated)) = (&source.file, &source.crs) else { continue };
        // What cannot be read was an error of building the scene.
        let Ok((_, shapes)) = context.sources.geometries(source) else { continue };
        let at = shapes.iter().find_map(|shape| shape.vertices().next().copied());
        let (Some(own), Some(at)) = (context.sources.overridden_crs(source), at) else { continue };
        let systems = OverriddenCrs { file, own: &own, stated };
        sink.add_all(systems.finding(at, context.document, source.span()));
    }
}

/// The central meridian of a UTM zone in degrees; `None` of another system.
fn zone_meridian_deg(crs: &Crs) -> Option<f64> {
    let text = crs.proj_text();
    let zone = text.split_whitespace().find_map(|word| word.strip_prefix("+zone="))?;
    let zone: u32 = zone.parse().ok().filter(|zone| (1..=60).contains(zone) && text.contains("+proj=utm"))?;
    Some(f64::from(zone) * 6.0 - 183.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meridian_of_a_zone_is_known_whatever_its_datum() {
        let meridian = |code| zone_meridian_deg(&Crs::from_epsg(code).expect("a system"));
        assert_eq!(
            [32616, 32756, 25832, 26912, 3857].map(meridian),
            [Some(-87.0), Some(153.0), Some(9.0), Some(-111.0), None]
        );
    }
}
