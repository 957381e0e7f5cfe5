//! Sight as a layer of the scene: viewsheds, lines of sight, and ranges, placed. What they show is found by the same functions as
//! the commands' answers; see [`crate::seen_ground`].

use std::borrow::Cow;

use glam::DVec2;

use crate::all_samples::PartTooLarge;
use crate::builder::SceneBuilder;
use crate::exact_ground::{ExactGround, ExactPartError};
use crate::feature::FeatureKind;
use crate::feature_origin::FeatureOrigin;
use crate::seen_ground::{SceneSight, SceneViewshed};
use crate::world_frame::WorldFrame;
use sandtable_base::limits::RASTER_SAMPLES;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::stated::Stated;
use sandtable_description::words::{GraphicSide, RangeExtent, ViewshedTint};
use sandtable_draw::list::FeatureId;
use sandtable_geom::crs::Crs;
use sandtable_symbology::graphic::check::MOST_RANGES;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::line::{Sight, SightEnd, line_of_sight};
use sandtable_terrain::sight::viewshed::{Sector, ViewshedOptions};

/// More observers of a viewshed take longer than anybody waits for a picture.
const MOST_OBSERVERS: usize = 64;

/// More lines of sight of one observer cannot be told from each other.
const MOST_TARGETS: usize = 256;

/// The layers of sight of a scene.
#[derive(Default)]
pub struct SightLayers {
    /// What observers see.
    pub viewsheds: Vec<SceneViewshed>,
    /// Lines of sight.
    pub sights: Vec<SceneSight>,
    /// Rings and fans.
    pub ranges: Vec<SceneRange>,
}

/// Rings and fans about a place.
pub struct SceneRange {
    /// Its name on the picture; may be empty.
    pub name: String,
    /// World X and Y.
    pub at: DVec2,
    /// Rising distances in meters.
    pub distances_m: Vec<f64>,
    /// The sector.
    pub sector: Sector,
    /// Whose it is.
    pub side: GraphicSide,
    /// Whether the ground within it is filled.
    pub fill: RangeExtent,
    /// What is in sight within it; for `fill = "seen"`.
    pub sight: SceneViewshed,
    /// The feature it is.
    pub feature: FeatureId,
    /// Whether the ground of each piece of each ring is in sight, where that was found beforehand.
    found: Option<Vec<Vec<bool>>>,
}

/// Pieces of a whole ring whose sight is tried one by one.
const RING_PIECES: f64 = 180.0;

impl SceneRange {
    /// The azimuths of places round the sector, its borders among them.
    pub fn azimuths_deg(&self) -> Vec<f64> {
        let steps = (RING_PIECES * self.sector.width_deg / 360.0).ceil().max(1.0);
        let step_deg = self.sector.width_deg / steps;
        (0..=steps as u32).map(|step| self.sector.from_deg + f64::from(step) * step_deg).collect()
    }

    /// The places round the sector at a distance, world X and Y.
    pub fn ring(&self, radius_m: f64) -> Vec<DVec2> {
        self.azimuths_deg().into_iter().map(|azimuth| self.at + heading(azimuth) * radius_m).collect()
    }

    /// Whether the ground of each piece of each ring is in sight, on `lattice` unless it was found before; of a range that is not
    /// of what is seen, all is.
    pub fn pieces_seen(&self, lattice: &Lattice) -> Cow<'_, [Vec<bool>]> {
        match &self.found {
            Some(found) => Cow::Borrowed(found),
            None => Cow::Owned(self.seen_on(lattice, lattice.origin())),
        }
    }

    /// [`SceneRange::pieces_seen`] on ground in the frame of the map; `origin` is that of world space.
    fn seen_on(&self, lattice: &Lattice, origin: DVec2) -> Vec<Vec<bool>> {
        let is_seen = |at: DVec2| {
            let Some(options) = self.sight.observers.first() else { return false };
            let target = SightEnd { at: at + origin, above_m: options.target_above_m };
            self.fill != RangeExtent::Seen
                || line_of_sight(lattice, options.observer, target, options.curvature) == Sight::Clear
        };
        let pieces = |radius_m: &f64| {
            self.ring(*radius_m).windows(2).map(|pair| is_seen(pair[0].midpoint(pair[1]))).collect()
        };
        self.distances_m.iter().map(pieces).collect()
    }
}

/// The direction of an azimuth.
pub fn heading(azimuth_deg: f64) -> DVec2 {
    let angle = azimuth_deg.to_radians();
    DVec2::new(libm::sin(angle), libm::cos(angle))
}

impl SightLayers {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.viewsheds.is_empty() && self.sights.is_empty() && self.ranges.is_empty()
    }
}

/// Places the document's layers of sight.
///
/// # Errors
/// An observer or a target lies off the ground, or there are more than a picture can show.
pub(super) fn lay(exact: &ExactGround<'_>, collected: &mut SceneBuilder) -> Result<SightLayers, Diagnostic> {
    let (frame, lattice) = (exact.frame, exact.lattice);
    let document = frame.document;
    let mut layers = SightLayers::default();
    let sector =
        |azimuths: Option<[f64; 2]>| azimuths.map_or(Sector::ALL, |[from, to]| Sector::between(from, to));
    for table in &document.viewsheds {
        let observers = places(frame, lattice, &table.observers, table.crs.as_ref(), MOST_OBSERVERS)?;
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
        let part = layer.find(exact).map_err(|error| failed(document, &table.observers, error, help))?;
        if let Some(part) = part.filter(|_| table.range.is_none()) {
            let (columns, rows) = (part.held().width(), part.held().height());
            let message = format!(
                "this viewshed has no `range`, and took all {columns} x {rows} samples of the elevation model"
            );
            let span = table.observers.span().unwrap_or_default();
            collected.findings.add_with_help(FindingCode::RangeMissing, span, message, help);
        }
        layers.viewsheds.push(layer);
    }
    for table in &document.sights {
        let observer = place(frame, lattice, &table.observer, table.crs.as_ref())?;
        let targets = places(frame, lattice, &table.targets, table.crs.as_ref(), MOST_TARGETS)?;
        let name = table.name.clone().unwrap_or_default();
        let mut layer = SceneSight {
            feature: collected.add(
                FeatureKind::Sight,
                name.clone(),
                FeatureOrigin::stated(table.observer.span()),
            ),
            name,
            observer: end(frame, observer, table.observer_height),
            targets: targets.into_iter().map(|at| end(frame, at, table.target_height)).collect(),
            found: None,
        };
        let help = "look less far";
        layer.find(exact).map_err(|error| failed(document, &table.targets, error, help))?;
        layers.sights.push(layer);
    }
    for table in &document.ranges {
        let at = place(frame, lattice, &table.at, table.crs.as_ref())?;
        let distances_m = distances(document, &table.distances)?;
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
            let part = layer.sight.find(exact).map_err(|error| failed(document, &table.at, error, help))?;
            layer.found = part.map(|part| layer.seen_on(&part, frame.origin));
        }
        layers.ranges.push(layer);
    }
    Ok(layers)
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
fn place(
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    at: &Stated<[f64; 2]>,
    crs: Option<&Crs>,
) -> Result<DVec2, Diagnostic> {
    let world = frame.point(at, crs)?;
    frame.on_ground(lattice, at, world)?;
    Ok(world)
}

/// Places on the ground, at most `most`.
fn places(
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    stated: &Stated<Vec<[f64; 2]>>,
    crs: Option<&Crs>,
    most: usize,
) -> Result<Vec<DVec2>, Diagnostic> {
    if stated.len() > most {
        let message = format!("{} places are more than the {most} allowed here", stated.len());
        return Err(frame.document.error(stated, message).with_help("state fewer, or use several tables"));
    }
    let span = stated.span().unwrap_or_default();
    stated.iter().map(|&at| place(frame, lattice, &Stated::new(at, span.clone()), crs)).collect()
}

fn distances(document: &Document, stated: &Stated<Vec<f64>>) -> Result<Vec<f64>, Diagnostic> {
    if !(1..=MOST_RANGES).contains(&stated.len()) {
        let message = format!("a range has 1 to {MOST_RANGES} distances, and {} are stated", stated.len());
        return Err(document.error(stated, message).with_help("write distances = [1000, 2000]"));
    }
    if let Some(pair) = stated.windows(2).find(|pair| pair[0] >= pair[1]) {
        let message = format!("distances are to rise, and {} follows {}", pair[1], pair[0]);
        return Err(document.error(stated, message).with_help("sort them from the smallest to the largest"));
    }
    Ok(stated.to_vec())
}
