//! The interface of every method: follow a camera, return the triangles shown.

use crate::lod::deferred::DeferredFollower;
use crate::lod::full::FullFollower;
use crate::lod::geomipmap::GeomipmapFollower;
use crate::lod::lod_ground::LodGround;
use crate::lod::method::LodMethod;
use crate::lod::refining::RefiningFollower;
use sandtable_roam::shown::PatchList;
use sandtable_view::camera::Camera;

/// A method at work.
pub trait LodFollower {
    /// Makes what the cameras of a flight need, once; not timed.
    fn prepare(&mut self, _: &Camera) {}

    /// Brings triangles and index lists up to date. This is what is timed.
    fn update(&mut self, camera: &Camera);

    /// Bytes of the index lists that the last update wrote.
    fn sent_bytes(&self) -> usize;

    /// The lists of the patches in view, after an update; lists that were not written are the same as before.
    fn shown(&mut self) -> Vec<PatchList>;
}

impl LodMethod {
    /// The method at work on `ground`. `budget` is the most triangles, for a method that keeps a budget.
    pub fn follower(self, ground: &LodGround, budget: Option<usize>) -> Box<dyn LodFollower + '_> {
        match self {
            Self::Full => Box::new(FullFollower::new(&ground.measured)),
            Self::Geomipmap => Box::new(GeomipmapFollower::new(ground)),
            Self::Refining { lists, criterion, refiner } => {
                Box::new(RefiningFollower::new(ground, lists, criterion, refiner, budget))
            }
            Self::Deferred { spheres } => Box::new(DeferredFollower::new(ground, spheres)),
        }
    }
}
