//! Places the viewsheds, lines of sight and ranges of a document, and tells every observer and target that has no place;
//! where the picture's ground holds means of samples, computes
//! visibility here, on all samples within reach.

use glam::DVec2;

use crate::all_samples::PartTooLarge;
use crate::builder::SceneBuilder;
use crate::exact_ground::{ExactGround, ExactPartError};
use crate::feature::FeatureKind;
use crate::feature_origin::FeatureOrigin;
use crate::seen_ground::{SceneSight, SceneViewshed, SightedLine};
use crate::sight_layers::{SceneRange, SightLayers};
use crate::world_frame::WorldFrame;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::graphics::{RangeTable, SightTable, ViewshedTable};
use sandtable_description::stated::Stated;
use sandtable_description::words::{RangeExtent, ViewshedTint};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;
use sandtable_geom::rect::Rect;
use sandtable_symbology::graphic::check::MOST_RANGES;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{Sector, ViewshedOptions};

/// More observers of a viewshed take longer than anybody waits for a picture.
const MOST_OBSERVERS: usize = 64;

/// More lines of sight of one observer cannot be told from each other.
const MOST_TARGETS: usize = 256;

/// Places the document's layers of sight. `collected` keeps an error where an observer or a target lies off the ground, or
/// there are more than a picture can show.
pub(super) fn lay(exact: &ExactGround<'_>, collected: &mut SceneBuilder) -> SightLayers {
    let document = exact.frame.document;
    let mut layers = SightLayers::default();
    for table in &document.viewsheds {
        let layer = viewshed(table, exact, collected);
        layers.viewsheds.extend(collected.errors.keep(layer).flatten());
    }
    for table in &document.sights {
        let layer = sight(table, exact, collected);
        layers.sights.extend(collected.errors.keep(layer).flatten());
    }
    for table in &document.ranges {
        let layer = range(table, exact, collected);
        layers.ranges.extend(collected.errors.keep(layer).flatten());
    }
    layers
}

fn sector(azimuths: Option<[f64; 2]>) -> Sector {
    azimuths.map_or(Sector::ALL, |[from, to]| Sector::between(from, to))
}

/// A viewshed; `None` where `collected` has the errors of its observers.
fn viewshed(
    table: &ViewshedTable,
    exact: &ExactGround<'_>,
    collected: &mut SceneBuilder,
) -> Result<Option<SceneViewshed>, Diagnostic> {
    let frame = exact.frame;
    let document = frame.document;
    check_count(document, &table.observers, MOST_OBSERVERS)?;
    let Some(observers) = places(exact, &table.observers, table.crs.as_ref(), collected) else {
        return Ok(None);
    };
    let options = |at: &DVec2| ViewshedOptions {
        target_above_m: table.target_height,
        range_m: table.range.unwrap_or(f64::INFINITY),
        sector: sector(table.azimuths),
        ..ViewshedOptions::new(end(frame, *at, table.observer_height))
    };
    let name = table.name.clone().unwrap_or_default();
    let feature =
        collected.add(FeatureKind::Sight, name.clone(), FeatureOrigin::stated(table.observers.span()));
    let observers = observers.iter().map(options).collect();
    let layer = SceneViewshed::new(name, observers, table.tint, feature);
    let help = if table.range.is_some() { "state a smaller `range`" } else { "state `range`, in meters" };
    let part =
        find_viewshed(&layer, exact).map_err(|error| failed(document, &table.observers, error, help))?;
    if let Some(part) = part.filter(|_| table.range.is_none()) {
        let (columns, rows) = (part.held().width(), part.held().height());
        let message = format!(
            "this viewshed has no `range`, and took all {columns} x {rows} samples of the elevation model"
        );
        let span = table.observers.span().unwrap_or_default();
        collected.findings.add_with_help(FindingCode::RangeMissing, span, message, help);
    }
    Ok(Some(layer))
}

/// Lines of sight; `None` where `collected` has the errors of their ends.
fn sight(
    table: &SightTable,
    exact: &ExactGround<'_>,
    collected: &mut SceneBuilder,
) -> Result<Option<SceneSight>, Diagnostic> {
    let (frame, crs) = (exact.frame, table.crs.as_ref());
    check_count(frame.document, &table.targets, MOST_TARGETS)?;
    let observer = collected.errors.keep(place(exact, &table.observer, crs));
    let targets = places(exact, &table.targets, crs, collected);
    let Some((observer, targets)) = observer.zip(targets) else { return Ok(None) };
    let name = table.name.clone().unwrap_or_default();
    let origin = FeatureOrigin::stated(table.observer.span());
    let mut layer = SceneSight {
        feature: collected.add(FeatureKind::Sight, name.clone(), origin),
        name,
        observer: end(frame, observer, table.observer_height),
        targets: targets.into_iter().map(|at| end(frame, at, table.target_height)).collect(),
        found: None,
    };
    let help = "look less far";
    find_sight(&mut layer, exact).map_err(|error| failed(frame.document, &table.targets, error, help))?;
    Ok(Some(layer))
}

/// Rings and fans; `None` where `collected` has the errors of their place and distances.
fn range(
    table: &RangeTable,
    exact: &ExactGround<'_>,
    collected: &mut SceneBuilder,
) -> Result<Option<SceneRange>, Diagnostic> {
    let frame = exact.frame;
    let document = frame.document;
    let at = collected.errors.keep(place(exact, &table.at, table.crs.as_ref()));
    let distances_m = collected.errors.keep(distances(document, &table.distances));
    let Some((at, distances_m)) = at.zip(distances_m) else { return Ok(None) };
    let farthest_m = distances_m.last().copied().unwrap_or(0.0);
    let name = table.name.clone().unwrap_or_default();
    let feature = collected.add(FeatureKind::Sight, name.clone(), FeatureOrigin::stated(table.at.span()));
    let sector = sector(table.azimuths);
    let options = ViewshedOptions {
        target_above_m: table.target_height,
        range_m: farthest_m,
        sector,
        ..ViewshedOptions::new(end(frame, at, table.height))
    };
    let sight = SceneViewshed::new(String::new(), vec![options], ViewshedTint::Seen, feature);
    let mut layer = SceneRange {
        name,
        at,
        distances_m,
        sector,
        side: table.side,
        fill: table.fill,
        sight,
        feature,
        found: None,
    };
    if table.fill == RangeExtent::Seen {
        let help = "state smaller `distances`";
        let part =
            find_viewshed(&layer.sight, exact).map_err(|error| failed(document, &table.at, error, help))?;
        layer.found = part.map(|part| layer.seen_on(&part, frame.origin));
    }
    Ok(Some(layer))
}

/// Finds what is in sight on all samples where the picture's ground is of means of them, and gives the ground that this
/// took; `None` where it is not.
///
/// # Errors
/// The range is too large, or the samples cannot be read.
fn find_viewshed(layer: &SceneViewshed, exact: &ExactGround<'_>) -> Result<Option<Lattice>, ExactPartError> {
    let Some(reach) = layer.reach() else { return Ok(None) };
    let part = exact.part(&reach)?;
    if let Some(part) = &part {
        layer.seen(part);
    }
    Ok(part)
}

/// Finds what is in sight on all samples where the picture's ground is of means of them.
///
/// # Errors
/// A line is too long, or the samples cannot be read.
fn find_sight(layer: &mut SceneSight, exact: &ExactGround<'_>) -> Result<(), ExactPartError> {
    let mut found = Vec::new();
    for target in &layer.targets {
        let Some(part) = exact.part(&Rect::around([layer.observer.at, target.at]))? else { return Ok(()) };
        found.push(SightedLine::on(&part, layer.observer, *target));
    }
    layer.found = Some(found);
    Ok(())
}

/// The error about a layer whose ground cannot be had; `help` says how it needs less.
fn failed<T>(document: &Document, stated: &Stated<T>, error: ExactPartError, help: &str) -> Diagnostic {
    match error {
        ExactPartError::Failed(error) => error,
        ExactPartError::TooLarge(PartTooLarge { columns, rows }) => {
            let message = format!(
                "{columns} x {rows} samples of the elevation model are within reach of this, more than the {RASTER_SAMPLES} that are \
                 read at once"
            );
            document.error(stated, message).with_help(format!("{help}, or {RASTER_SAMPLES:#}"))
        }
    }
}

/// An end of a line of sight at a place in world space.
fn end(frame: &WorldFrame<'_>, world: DVec2, above_m: f64) -> SightEnd {
    SightEnd { at: world + frame.origin, above_m }
}

/// A place on the ground, world X and Y.
fn place(exact: &ExactGround<'_>, at: &Stated<Position>, crs: Option<&Crs>) -> Result<DVec2, Diagnostic> {
    let world = exact.frame.point(at, crs)?;
    exact.frame.on_ground(exact.lattice, at, world)?;
    Ok(world)
}

/// Checks that there are no more than `most` places.
fn check_count(
    document: &Document,
    stated: &Stated<Vec<Stated<Position>>>,
    most: usize,
) -> Result<(), Diagnostic> {
    if stated.len() <= most {
        return Ok(());
    }
    let message = format!("{} places are more than the {most} allowed here", stated.len());
    Err(document.error(stated, message).with_help("state fewer, or use several tables"))
}

/// Places on the ground; `None` where some of them have none, with an error for each of these in `collected`.
fn places(
    exact: &ExactGround<'_>,
    stated: &[Stated<Position>],
    crs: Option<&Crs>,
    collected: &mut SceneBuilder,
) -> Option<Vec<DVec2>> {
    let placed = stated.iter().filter_map(|at| collected.errors.keep(place(exact, at, crs)));
    let placed: Vec<DVec2> = placed.collect();
    (placed.len() == stated.len()).then_some(placed)
}

fn distances(document: &Document, stated: &Stated<Vec<f64>>) -> Result<Vec<f64>, Diagnostic> {
    if !(1..=MOST_RANGES).contains(&stated.len()) {
        let message = format!("a range has 1 to {MOST_RANGES} distances, and {} are stated", stated.len());
        return Err(document.error(stated, message).with_help("write distances = [1000, 2000]"));
    }
    if let Some(pair) = stated.windows(2).find(|pair| pair[0] >= pair[1]) {
        let message = format!("distances must rise, and {} follows {}", pair[1], pair[0]);
        return Err(document.error(stated, message).with_help("sort them from the smallest to the largest"));
    }
    Ok(stated.to_vec())
}
