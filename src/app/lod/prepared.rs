//! What methods share: the ground and what is known of it before the flight.

use std::sync::OnceLock;

use crate::app::lod::method::Rule;
use crate::roam::criterion::Criterion;
use crate::roam::criterion::screen::ScreenError;
use crate::roam::criterion::spheres::Spheres;
use crate::roam::culling::PatchHeights;
use crate::roam::errors::ErrorMap;
use crate::roam::ground::Ground;
use crate::roam::layout::{DEFAULT_PATCH, Layout};
use crate::roam::spheres::SphereMap;
use crate::terrain::lattice::Lattice;
use crate::view::camera::Camera;

/// The ground, its errors, and what else some methods ask for, made when it is first asked for.
pub struct Prepared {
    /// The heights.
    pub lattice: Lattice,
    /// The patches over them.
    pub layout: Layout,
    /// The exact errors of their vertices.
    pub errors: ErrorMap,
    /// The drawn heights' range per patch.
    pub heights: PatchHeights,
    /// How many pixels an error may show.
    pub tolerance_px: f32,
    spheres: OnceLock<SphereMap>,
}

/// Something that is done with a criterion, whichever it is: a closure generic over its argument.
pub trait WithCriterion {
    /// What comes of it.
    type Out;

    /// Does it.
    fn call(self, criterion: &impl Criterion) -> Self::Out;
}

impl Prepared {
    /// Measures the ground.
    ///
    /// # Errors
    /// A sentence where patches cannot be laid over it.
    pub fn new(lattice: Lattice, tolerance_px: f32) -> Result<Self, String> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let layout = Layout::new(columns, rows, DEFAULT_PATCH).ok_or_else(|| {
            format!("patches of {DEFAULT_PATCH} cells cannot be laid over {columns} × {rows} posts: too many vertices")
        })?;
        let errors = ErrorMap::exact(&lattice, &layout);
        let ground = Ground { lattice: &lattice, layout: &layout, exaggeration: 1.0 };
        let heights = PatchHeights::new(ground);
        Ok(Self { layout, errors, heights, tolerance_px, spheres: OnceLock::new(), lattice })
    }

    /// Sets another tolerance; what was made for the last one is made anew.
    pub fn set_tolerance_px(&mut self, tolerance_px: f32) {
        self.tolerance_px = tolerance_px;
        self.spheres = OnceLock::new();
    }

    /// What refinement reads; heights are drawn as they are.
    pub fn ground(&self) -> Ground<'_> {
        Ground { lattice: &self.lattice, layout: &self.layout, exaggeration: 1.0 }
    }

    /// Calls `with` with the criterion for `camera`.
    pub fn with_criterion<W: WithCriterion>(&self, rule: Rule, camera: &Camera, with: W) -> W::Out {
        let ground = self.ground();
        match rule {
            Rule::Screen => {
                with.call(&ScreenError::new(ground, &self.errors, &self.heights, camera, self.tolerance_px))
            }
            Rule::Spheres => with.call(&Spheres::new(ground, self.spheres(camera), camera.eye())),
        }
    }

    /// The nested spheres for the lens of `camera`, which all cameras of a flight have in common: own radii are the
    /// distances at which an error spans the tolerance in the middle of the picture.
    pub fn spheres(&self, camera: &Camera) -> &SphereMap {
        self.spheres.get_or_init(|| {
            let reach = camera.pixels_per_metre(1.0) / self.tolerance_px;
            let own = self.errors.values().iter().map(|error_m| error_m * reach).collect();
            SphereMap::nested(self.ground(), own)
        })
    }
}
