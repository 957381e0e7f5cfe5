//! The ground that methods share: its measures, and the criteria that read them.

use std::sync::OnceLock;

use crate::lod::method::{CriterionKind, SphereRule};
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::anisotropic::Anisotropic;
use sandtable_roam::criterion::block::BlockRelief;
use sandtable_roam::criterion::midpoint::Midpoint;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::layout::DEFAULT_PATCH;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_roam::roughness::Roughness;
use sandtable_roam::spheres::{SphereMap, reach};
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;

/// The reach of a window of local roughness in posts: 3 × 3 posts.
const HALF_WINDOW: (u32, u32) = (1, 1);

/// The ground of a flight, and the spheres of its cameras' lens, made at first use.
pub struct LodGround {
    /// The ground, true to scale.
    pub measured: MeasuredGround,
    /// The most pixels that an error may span.
    pub tolerance_px: f32,
    /// By [`SphereRule`].
    spheres: [OnceLock<SphereMap>; 3],
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

impl LodGround {
    /// Lays patches over the ground and measures them.
    ///
    /// # Errors
    /// The ground has too many posts.
    pub fn new(lattice: Lattice, tolerance_px: f32) -> Result<Self, TooManyPosts> {
        let (columns, rows) = (lattice.columns(), lattice.rows());
        let measured = MeasuredGround::new(lattice, DEFAULT_PATCH).ok_or(TooManyPosts { columns, rows })?;
        measured.measure_patches();
        Ok(Self { measured, tolerance_px, spheres: Default::default() })
    }

    /// Makes the measures that a criterion needs.
    pub fn prepare(&self, criterion: CriterionKind, camera: &Camera) {
        self.with_criterion(criterion, camera, Ignore);
    }

    /// Calls `with` with the criterion for `camera`.
    pub fn with_criterion<W: WithCriterion>(&self, kind: CriterionKind, camera: &Camera, with: W) -> W::Out {
        let (measured, tolerance_px) = (&self.measured, self.tolerance_px);
        let ground = measured.patched();
        match kind {
            CriterionKind::Screen => with.call(&measured.screen_error(camera, tolerance_px)),
            CriterionKind::Variance => {
                with.call(&Midpoint::by_land_width(ground, measured.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Roughness => {
                with.call(&Midpoint::new(ground, measured.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Anisotropic => {
                with.call(&Anisotropic::new(ground, measured.midpoint(), camera, tolerance_px))
            }
            CriterionKind::Block => {
                with.call(&BlockRelief::new(ground, measured.relief(), camera, tolerance_px))
            }
            CriterionKind::Spheres(rule) => {
                with.call(&Spheres::new(ground, self.spheres(rule, camera), camera.eye()))
            }
        }
    }

    /// The nested spheres for the lens of `camera`, which all cameras of a flight share. Their own radii are the
    /// distances at which an error spans the tolerance at the picture's center; of bounding spheres, at its corners.
    pub fn spheres(&self, rule: SphereRule, camera: &Camera) -> &SphereMap {
        let (measured, ground) = (&self.measured, self.measured.patched());
        let center = camera.pixels_per_meter(1.0) / self.tolerance_px;
        self.spheres[rule as usize].get_or_init(|| match rule {
            SphereRule::Plain => SphereMap::plain(ground, measured.midpoint(), center),
            SphereRule::Constrained => {
                SphereMap::constrained(ground, center, &Roughness::new(measured.lattice(), HALF_WINDOW))
            }
            SphereRule::Bounding => {
                SphereMap::bounding(ground, measured.exact(), reach(camera, self.tolerance_px))
            }
        })
    }
}
