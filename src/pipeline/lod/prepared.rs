//! What methods share: the ground, and the measures of it that their criteria need.

use std::sync::OnceLock;

use crate::pipeline::lod::method::{CriterionKind, SphereRule};
use crate::roam::criterion::Criterion;
use crate::roam::criterion::anisotropic::Anisotropic;
use crate::roam::criterion::block::BlockRelief;
use crate::roam::criterion::midpoint::Midpoint;
use crate::roam::criterion::screen::ScreenError;
use crate::roam::criterion::spheres::Spheres;
use crate::roam::culling::PatchHeights;
use crate::roam::emit::world::drawn_posts;
use crate::roam::errors::ErrorMap;
use crate::roam::graph::Vertex;
use crate::roam::layout::{DEFAULT_PATCH, PatchLayout};
use crate::roam::patched_ground::PatchedGround;
use crate::roam::roughness::Roughness;
use crate::roam::shown::{LocalTriangle, local};
use crate::roam::spheres::{SphereMap, reach};
use crate::terrain::lattice::Lattice;
use crate::view::camera::Camera;

/// The reach of a window of local roughness in posts: 3 × 3 posts.
const HALF_WINDOW: (u32, u32) = (1, 1);

/// The ground, and measures of it that are made at first use.
pub struct PreparedGround {
    /// The heights.
    pub lattice: Lattice,
    /// The patches over them.
    pub layout: PatchLayout,
    /// The range of drawn heights in each patch.
    pub heights: PatchHeights,
    /// The most pixels that an error may span.
    pub tolerance_px: f32,
    whole: Vec<bool>,
    exact: OnceLock<ErrorMap>,
    midpoint: OnceLock<ErrorMap>,
    relief: OnceLock<ErrorMap>,
    plain: OnceLock<SphereMap>,
    constrained: OnceLock<SphereMap>,
    bounding: OnceLock<SphereMap>,
}

/// Ground with too many vertices for patches of the default size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("patches of {DEFAULT_PATCH} cells cannot be laid over {columns} × {rows} posts: too many vertices")]
pub struct TooManyPosts {
    columns: u32,
    rows: u32,
}

/// A closure that is generic over its criterion.
pub trait WithCriterion {
    /// What it returns.
    type Out;

    /// Calls it.
    fn call(self, criterion: &impl Criterion) -> Self::Out;
}

/// Does nothing with a criterion.
struct Ignore;

impl WithCriterion for Ignore {
    type Out = ();

    fn call(self, _: &impl Criterion) {}
}

impl PreparedGround {
    /// Lays patches over the ground.
    ///
    /// # Errors
    /// The ground has too many posts.
    pub fn new(lattice: Lattice, tolerance_px: f32) -> Result<Self, TooManyPosts> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let layout = PatchLayout::new(columns, rows, DEFAULT_PATCH).ok_or(TooManyPosts { columns, rows })?;
        let patched = PatchedGround { lattice: &lattice, layout: &layout };
        Ok(Self {
            heights: PatchHeights::new(patched),
            whole: layout.patches().map(|corner| patched.is_whole(corner)).collect(),
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

    /// The ground with its patches, true to scale.
    pub fn patched(&self) -> PatchedGround<'_> {
        PatchedGround { lattice: &self.lattice, layout: &self.layout }
    }

    /// Whether the patch with south-west corner `corner` lies within the border and has data at every post, so that all
    /// its triangles are drawn.
    pub fn is_whole(&self, corner: Vertex) -> bool {
        self.whole[self.layout.patch_index(corner)]
    }

    /// A function from a triangle in the patch with south-west corner `corner` to its indices there; `None` for one
    /// that is beyond the border or over no data.
    pub fn drawn_in(&self, corner: Vertex) -> impl Fn([Vertex; 3]) -> Option<LocalTriangle> + '_ {
        let (patched, is_whole) = (self.patched(), self.is_whole(corner));
        move |corners| {
            let is_drawn = is_whole || drawn_posts(patched, corners).is_some();
            is_drawn.then(|| corners.map(|vertex| local(&self.layout, corner, vertex)))
        }
    }

    /// Makes the measures that a criterion needs.
    pub fn prepare(&self, criterion: CriterionKind, camera: &Camera) {
        self.with_criterion(criterion, camera, Ignore);
    }

    /// Calls `with` with the criterion for `camera`.
    pub fn with_criterion<W: WithCriterion>(&self, kind: CriterionKind, camera: &Camera, with: W) -> W::Out {
        let (ground, tolerance_px) = (self.patched(), self.tolerance_px);
        match kind {
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
            CriterionKind::Spheres(rule) => {
                with.call(&Spheres::new(ground, self.spheres(rule, camera), camera.eye()))
            }
        }
    }

    /// The nested spheres for the lens of `camera`, which all cameras of a flight share. Their own radii are the
    /// distances at which an error spans the tolerance at the picture's center; of bounding spheres, at its corners.
    pub fn spheres(&self, rule: SphereRule, camera: &Camera) -> &SphereMap {
        let ground = self.patched();
        let center = camera.pixels_per_meter(1.0) / self.tolerance_px;
        match rule {
            SphereRule::Plain => self.plain.get_or_init(|| SphereMap::plain(ground, self.midpoint(), center)),
            SphereRule::Constrained => self.constrained.get_or_init(|| {
                SphereMap::constrained(ground, center, &Roughness::new(&self.lattice, HALF_WINDOW))
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
