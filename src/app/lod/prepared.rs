//! What methods share: the ground and what is known of it before the flight.

use std::sync::OnceLock;

use crate::app::lod::method::{CriterionKind, SphereRule};
use crate::roam::criterion::Criterion;
use crate::roam::criterion::anisotropic::Anisotropic;
use crate::roam::criterion::block::BlockRelief;
use crate::roam::criterion::midpoint::Midpoint;
use crate::roam::criterion::screen::ScreenError;
use crate::roam::criterion::spheres::Spheres;
use crate::roam::culling::PatchHeights;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::layout::{DEFAULT_PATCH, PatchLayout};
use crate::roam::patched_ground::PatchedGround;
use crate::roam::roughness::Roughness;
use crate::roam::spheres::{SphereMap, reach};
use crate::terrain::lattice::Lattice;
use crate::view::camera::Camera;

/// How many posts a window of local roughness reaches: 3 × 3 posts.
const HALF_WINDOW: (u32, u32) = (1, 1);

/// The ground, and what some methods ask for, made when it is first asked for.
pub struct PreparedGround {
    /// The heights.
    pub lattice: Lattice,
    /// The patches over them.
    pub layout: PatchLayout,
    /// The drawn heights' range per patch.
    pub heights: PatchHeights,
    /// How many pixels an error may show.
    pub tolerance_px: f32,
    whole: Vec<bool>,
    exact: OnceLock<ErrorMap>,
    midpoint: OnceLock<ErrorMap>,
    relief: OnceLock<ErrorMap>,
    plain: OnceLock<SphereMap>,
    constrained: OnceLock<SphereMap>,
    bounding: OnceLock<SphereMap>,
}

/// Something that is done with a criterion, whichever it is: a closure generic over its argument.
pub trait WithCriterion {
    /// What comes of it.
    type Out;

    /// Does it.
    fn call(self, criterion: &impl Criterion) -> Self::Out;
}

/// Nothing is done: the criterion has only to be there.
struct Nothing;

impl WithCriterion for Nothing {
    type Out = ();

    fn call(self, _: &impl Criterion) {}
}

impl PreparedGround {
    /// Lays patches over the ground.
    ///
    /// # Errors
    /// A sentence where that cannot be done.
    pub fn new(lattice: Lattice, tolerance_px: f32) -> Result<Self, String> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let layout = PatchLayout::new(columns, rows, DEFAULT_PATCH).ok_or_else(|| {
            format!("patches of {DEFAULT_PATCH} cells cannot be laid over {columns} × {rows} posts: too many vertices")
        })?;
        let ground = PatchedGround { lattice: &lattice, layout: &layout };
        Ok(Self {
            heights: PatchHeights::new(ground),
            whole: layout.patches().map(|corner| ground.is_whole(corner)).collect(),
            tolerance_px,
            exact: OnceLock::new(),
            midpoint: OnceLock::new(),
            relief: OnceLock::new(),
            plain: OnceLock::new(),
            constrained: OnceLock::new(),
            bounding: OnceLock::new(),
            layout,
            lattice,
        })
    }

    /// What refinement reads; heights are drawn as they are.
    pub fn ground(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// Whether the patch with south-west corner `corner` lies within the borders and has data at every post, so that
    /// all its triangles are drawn.
    pub fn is_whole(&self, corner: Vertex) -> bool {
        self.whole[self.layout.patch_index(corner)]
    }

    /// Makes all that the criterion asks for.
    pub fn make(&self, rule: CriterionKind, camera: &Camera) {
        self.with_criterion(rule, camera, Nothing);
    }

    /// Calls `with` with the criterion for `camera`.
    pub fn with_criterion<W: WithCriterion>(&self, rule: CriterionKind, camera: &Camera, with: W) -> W::Out {
        let (ground, tolerance_px) = (self.ground(), self.tolerance_px);
        let spheres = |which| Spheres::new(ground, self.spheres(which, camera), camera.eye());
        match rule {
            CriterionKind::Screen => {
                with.call(&ScreenError::new(ground, self.exact(), &self.heights, camera, tolerance_px))
            }
            CriterionKind::Variance => {
                with.call(&Midpoint::by_land_width(ground, self.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Roughness => {
                with.call(&Midpoint::new(ground, self.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Anisotropic => {
                with.call(&Anisotropic::new(ground, self.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Block => with.call(&BlockRelief::new(ground, self.relief(), camera, tolerance_px)),
            CriterionKind::Spheres => with.call(&spheres(SphereRule::Plain)),
            CriterionKind::Constrained => with.call(&spheres(SphereRule::Constrained)),
            CriterionKind::Bounding => with.call(&spheres(SphereRule::Bounding)),
        }
    }

    /// The nested spheres for the lens of `camera`, which all cameras of a flight have in common. Own radii are the
    /// distances at which an error spans the tolerance in the middle of the picture; those that bound it, at the
    /// picture's corners.
    pub fn spheres(&self, which: SphereRule, camera: &Camera) -> &SphereMap {
        let ground = self.ground();
        let middle = camera.pixels_per_meter(1.0) / self.tolerance_px;
        match which {
            SphereRule::Plain => self.plain.get_or_init(|| SphereMap::plain(ground, self.midpoint(), middle)),
            SphereRule::Constrained => self.constrained.get_or_init(|| {
                SphereMap::constrained(ground, middle, &Roughness::new(&self.lattice, HALF_WINDOW))
            }),
            SphereRule::Bounding => self
                .bounding
                .get_or_init(|| SphereMap::bounding(ground, self.exact(), reach(camera, self.tolerance_px))),
        }
    }

    fn exact(&self) -> &ErrorMap {
        self.exact.get_or_init(|| ErrorMap::exact(&self.lattice, &self.layout))
    }

    fn midpoint(&self) -> &ErrorMap {
        self.midpoint.get_or_init(|| ErrorMap::midpoint(&self.lattice, &self.layout))
    }

    fn relief(&self) -> &ErrorMap {
        self.relief.get_or_init(|| ErrorMap::relief(&self.lattice, &self.layout))
    }
}
