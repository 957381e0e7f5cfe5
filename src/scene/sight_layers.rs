//! Sight as a layer of the scene: viewsheds, lines of sight, and ranges, placed. What they show is computed when a picture
//! first needs it, by the same functions as the commands' answers.

use std::sync::OnceLock;

use glam::DVec2;

use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::stated::Stated;
use crate::description::words::{GraphicSide, RangeExtent, ViewshedTint};
use crate::draw::list::FeatureId;
use crate::geom::crs::Crs;
use crate::scene::FeatureKind;
use crate::scene::builder::SceneBuilder;
use crate::scene::feature_origin::FeatureOrigin;
use crate::scene::world_frame::WorldFrame;
use crate::symbology::graphic::check::MOST_RANGES;
use crate::terrain::lattice::Lattice;
use crate::terrain::sight::line::SightEnd;
use crate::terrain::sight::viewshed::{PostVisibility, Sector, Viewshed, ViewshedOptions, viewshed};

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

/// What observers see.
pub struct SceneViewshed {
    /// Its name for the legend; may be empty.
    pub name: String,
    /// One for each observer, in map coordinates.
    pub observers: Vec<ViewshedOptions>,
    /// Which ground is tinted.
    pub tint: ViewshedTint,
    /// The feature it is.
    pub feature: FeatureId,
    seen: OnceLock<Option<Viewshed>>,
}

/// Lines of sight from an observer.
pub struct SceneSight {
    /// Its name for the legend; may be empty.
    pub name: String,
    /// The observer, in map coordinates.
    pub observer: SightEnd,
    /// What is looked at.
    pub targets: Vec<SightEnd>,
    /// The feature it is.
    pub feature: FeatureId,
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
}

impl SightLayers {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.viewsheds.is_empty() && self.sights.is_empty() && self.ranges.is_empty()
    }
}

impl SceneViewshed {
    fn new(name: String, observers: Vec<ViewshedOptions>, tint: ViewshedTint, feature: FeatureId) -> Self {
        Self { name, observers, tint, feature, seen: OnceLock::new() }
    }

    /// What is in sight of one of the observers at least, computed on first use; `None` without observers on the ground.
    pub fn seen(&self, lattice: &Lattice) -> Option<&Viewshed> {
        self.seen.get_or_init(|| self.compute(lattice)).as_ref()
    }

    fn compute(&self, lattice: &Lattice) -> Option<Viewshed> {
        let mut observers = self.observers.iter().filter_map(|options| viewshed(lattice, options).ok());
        let mut seen = observers.next()?;
        for other in observers {
            for (post, other) in seen.posts.iter_mut().zip(other.posts) {
                *post = either(*post, other);
            }
        }
        Some(seen)
    }
}

/// What two observers see of a post together.
fn either(one: PostVisibility, other: PostVisibility) -> PostVisibility {
    use PostVisibility::{Beyond, Hidden, NoData, Visible};
    match (one, other) {
        (Visible, _) | (_, Visible) => Visible,
        (Hidden, _) | (_, Hidden) => Hidden,
        (NoData, _) | (_, NoData) => NoData,
        (Beyond, Beyond) => Beyond,
    }
}

/// Places the document's layers of sight.
///
/// # Errors
/// An observer or a target lies off the ground, or there are more than a picture can show.
pub fn lay(
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
    collected: &mut SceneBuilder,
) -> Result<SightLayers, Diagnostic> {
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
        layers.viewsheds.push(SceneViewshed::new(name, observers, table.tint, feature));
    }
    for table in &document.sights {
        let observer = place(frame, lattice, &table.observer, table.crs.as_ref())?;
        let targets = places(frame, lattice, &table.targets, table.crs.as_ref(), MOST_TARGETS)?;
        let name = table.name.clone().unwrap_or_default();
        layers.sights.push(SceneSight {
            feature: collected.add(
                FeatureKind::Sight,
                name.clone(),
                FeatureOrigin::stated(table.observer.span()),
            ),
            name,
            observer: end(frame, observer, table.observer_height),
            targets: targets.into_iter().map(|at| end(frame, at, table.target_height)).collect(),
        });
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
        layers.ranges.push(SceneRange {
            name,
            at,
            distances_m,
            sector,
            side: table.side,
            fill: table.fill,
            sight,
            feature,
        });
    }
    Ok(layers)
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
