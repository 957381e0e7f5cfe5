//! Puts a method to work: the follower of each.

use crate::lod::deferred::DeferredFollower;
use crate::lod::follower::LodFollower;
use crate::lod::full::FullFollower;
use crate::lod::geomipmap::GeomipmapFollower;
use crate::lod::lod_ground::LodGround;
use crate::lod::method::LodMethod;
use crate::lod::refining::RefiningFollower;

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
