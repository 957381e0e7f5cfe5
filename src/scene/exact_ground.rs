//! The ground for printed heights and visibility where pictures show means of samples: all samples, read where they are
//! needed.
//!
//! ```text
//!  means of samples ──► the picture: ground, light, what lies and stands on it
//!  all samples ───────► numbers: heights on labels, the highest post near a summit of the means
//!               └─────► sight: the ground within a range, around a line
//! ```
//!
//! Where nothing shapes the ground these have the bits that `height`, `los` and `viewshed` read of the file. Where lakes, roads,
//! pads or earthworks do, parts of it are built as nested grounds are; each reads the sources of the features again, so that
//! heights in numbers have few of them.

use std::cell::{OnceCell, RefCell};

use glam::{DVec2, Vec2};

use crate::all_samples::{AllSamples, PartTooLarge};
use crate::assets::Assets;
use crate::finer_elevation::part_document;
use crate::planned_pictures::depends_on_samples;
use crate::scene_findings::SceneFindings;
use crate::shaped_ground::part_ground;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_description::feature_value::FeatureValue;
use sandtable_description::features::FenceTable;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::words::{BaseRule, FenceKind, Footing, ProfileMode};
use sandtable_geom::rect::Rect;
use sandtable_raster::windows::Windows;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::prominence::{ProminentSummit, summits};
use sandtable_terrain::query::windowed::LatticePartError;
use sandtable_terrain::query::{Interpolation, ground_height};

/// Parts that are built with their features for heights in numbers: about as many as a picture near the ground has nested
/// grounds, whose sources are read as often.
const MOST_SHAPED_PARTS: usize = 8;

/// The side of such a part, in cells of the means: a town's labels share one, and it is read in a few milliseconds.
const SHAPED_PART_CELLS: f64 = 64.0;

/// How far from a summit of the means the highest sample is looked for, in cells of the means: within the squares beside it.
const SUMMIT_CELLS: f64 = 1.5;

/// Whether the heights of the ground may be other than those of the elevation.
fn shapes_ground(document: &Document) -> bool {
    let may_be_dug = |fence: &FenceTable| match &fence.kind {
        Some(FeatureValue::Fixed(kind)) => *kind == FenceKind::Trench,
        Some(FeatureValue::Computed { .. }) => true,
        None => fence.source.file.is_some(),
    };
    !(document.coasts.is_empty()
        && document.lakes.is_empty()
        && document.rivers.is_empty()
        && document.earthworks.is_empty())
        || document.roads.iter().any(|road| road.profile != ProfileMode::Drape)
        || document.buildings.iter().any(|building| building.base == Some(BaseRule::Pad))
        || document.fences.iter().any(may_be_dug)
        || document.models.iter().any(|model| *model.footing == Footing::Pad)
}

/// A part of the ground that cannot be had.
pub(super) enum ExactPartError {
    /// It is too large.
    TooLarge(PartTooLarge),
    /// It cannot be read or built.
    Failed(Diagnostic),
}

/// The height of a summit or another place in numbers.
pub(super) struct ExactSpot {
    /// World X and Y.
    pub at: Vec2,
    /// Meters.
    pub elevation_m: f32,
}

/// The ground that numbers and sight are of.
pub(super) struct ExactGround<'a> {
    /// Its place in the world.
    pub frame: &'a WorldFrame<'a>,
    /// The ground of the picture.
    pub lattice: &'a Lattice,
    /// Where that is of means.
    exact: Option<RefCell<ExactSource<'a>>>,
    summits: OnceCell<Vec<ProminentSummit>>,
}

struct ExactSource<'a> {
    samples: AllSamples,
    shaped: Option<ShapedParts<'a>>,
}

/// Parts of a ground that features shape.
struct ShapedParts<'a> {
    assets: &'a Assets,
    parts: Vec<Lattice>,
    /// Places whose heights are those of the elevation, since more parts would be needed.
    unshaped: usize,
}

impl<'a> ExactGround<'a> {
    /// The ground of a picture; `all_samples` are those of which its heights are means, if they are.
    ///
    /// # Errors
    /// The samples cannot be brought to the scene's system.
    pub fn new(
        frame: &'a WorldFrame<'a>,
        lattice: &'a Lattice,
        assets: &'a Assets,
        all_samples: Option<Box<dyn Windows + Send>>,
    ) -> Result<Self, Diagnostic> {
        let document = frame.document;
        let needed = all_samples.filter(|_| depends_on_samples(document));
        let source = |windows| {
            let shaped = ShapedParts { assets, parts: Vec::new(), unshaped: 0 };
            let samples = AllSamples::new(windows, document, frame.crs)?;
            let shaped = shapes_ground(document).then_some(shaped);
            Ok(RefCell::new(ExactSource { samples, shaped }))
        };
        Ok(Self { frame, lattice, exact: needed.map(source).transpose()?, summits: OnceCell::new() })
    }

    /// The same with the summits of the picture's ground, where they are known.
    pub fn with_summits(self, summits: Option<Vec<ProminentSummit>>) -> Self {
        Self { summits: summits.map(OnceCell::from).unwrap_or_default(), ..self }
    }

    /// The summits of the picture's ground, the most prominent first, found on first use.
    pub fn summits(&self) -> &[ProminentSummit] {
        self.summits.get_or_init(|| summits(self.lattice))
    }

    /// Whether the heights of the picture's ground are means of samples.
    pub fn is_of_means(&self) -> bool {
        self.exact.is_some()
    }

    /// The elevation of the ground at a world position, meters. `drawn_z` is the picture's there, which counts where no sample
    /// holds data.
    ///
    /// # Errors
    /// The samples cannot be read.
    pub fn elevation_m(&self, world: DVec2, drawn_z: f32) -> Result<f32, Diagnostic> {
        let drawn_m = self.frame.scale.elevation_m(drawn_z);
        let Some(exact) = &self.exact else { return Ok(drawn_m) };
        let ExactSource { samples, shaped } = &mut *exact.borrow_mut();
        let at = self.frame.origin + world;
        let shaped = shaped.as_mut().map(|shaped| self.shaped_height(shaped, at)).transpose()?.flatten();
        let height = match shaped {
            Some(height) => Some(height),
            None => samples.height(at).map_err(|error| self.failed(error))?.height_m(),
        };
        Ok(height.map_or(drawn_m, |height| height as f32))
    }

    /// The highest place near a summit of the picture's ground at a world position.
    ///
    /// # Errors
    /// The samples cannot be read.
    pub fn summit(&self, summit: ExactSpot) -> Result<ExactSpot, Diagnostic> {
        let Some(exact) = &self.exact else { return Ok(summit) };
        let around = self.lattice.cell() * SUMMIT_CELLS;
        let at = self.frame.origin + summit.at.as_dvec2();
        let rect = Rect { min: at - around, max: at + around };
        let highest = exact.borrow_mut().samples.highest(&rect).map_err(|error| self.failed(error))?;
        Ok(highest.map_or(summit, |post| ExactSpot {
            at: (post.at - self.frame.origin).as_vec2(),
            elevation_m: post.height_m,
        }))
    }

    /// The ground around a rectangle of map coordinates, in the frame of the map; `None` where the picture's has all samples.
    ///
    /// # Errors
    /// It is too large, or cannot be read or built.
    pub fn part(&self, rect: &Rect) -> Result<Option<Lattice>, ExactPartError> {
        let Some(exact) = &self.exact else { return Ok(None) };
        let ExactSource { samples, shaped } = &mut *exact.borrow_mut();
        let posts = samples.posts_around(rect).map_err(ExactPartError::TooLarge)?;
        let part = match shaped {
            Some(shaped) => self.shaped_part(shaped.assets, &samples.map_rect(posts)),
            None => samples.part(posts).map_err(|error| self.failed(error)),
        };
        part.map(Some).map_err(ExactPartError::Failed)
    }

    /// Reports how many printed heights ignore the features that shape the ground.
    pub fn report(&self, findings: &mut SceneFindings) {
        let Some(exact) = &self.exact else { return };
        let unshaped = exact.borrow().shaped.as_ref().map_or(0, |shaped| shaped.unshaped);
        if unshaped > 0 {
            let message = format!(
                "{unshaped} printed heights are those of the elevation model, without what the scene digs, fills and levels \
                 there: too many places far apart have one"
            );
            let span = self.frame.document.terrain.dem.span().unwrap_or_default();
            findings.add(FindingCode::HeightsUnshaped, span, message);
        }
    }

    /// The height of the shaped ground at map coordinates; `None` where it has no data, and where no more parts are built.
    fn shaped_height(&self, shaped: &mut ShapedParts<'_>, at: DVec2) -> Result<Option<f64>, Diagnostic> {
        let height_m = |part: &Lattice| ground_height(part, Interpolation::Planar, at).height_m();
        if let Some(height_m) = shaped.parts.iter().find_map(height_m) {
            return Ok(Some(height_m));
        }
        if shaped.parts.len() == MOST_SHAPED_PARTS {
            shaped.unshaped += 1;
            return Ok(None);
        }
        let half = self.lattice.cell() * SHAPED_PART_CELLS / 2.0;
        let part = self.shaped_part(shaped.assets, &Rect { min: at - half, max: at + half })?;
        let found = height_m(&part);
        shaped.parts.push(part);
        Ok(found)
    }

    /// The ground around a rectangle of map coordinates with what shapes it.
    fn shaped_part(&self, assets: &Assets, rect: &Rect) -> Result<Lattice, Diagnostic> {
        let rect = rect.intersection(&self.lattice.map_extent());
        let world = Rect { min: rect.min - self.frame.origin, max: rect.max - self.frame.origin };
        part_ground(&part_document(self.frame, &world)?, assets)
    }

    fn failed(&self, error: LatticePartError) -> Diagnostic {
        self.frame.document.error(&self.frame.document.terrain.dem, error)
    }
}
