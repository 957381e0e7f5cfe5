//! What every method does: it follows a camera and says what it shows.

use crate::app::lod::deferring::Deferring;
use crate::app::lod::full::Full;
use crate::app::lod::method::LodMethod;
use crate::app::lod::mipmapping::Mipmapping;
use crate::app::lod::prepared::PreparedGround;
use crate::app::lod::refining::Refining;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;

/// A method at work.
pub trait Follow {
    /// Makes, once for the whole flight, what its cameras need; not timed.
    fn prepare(&mut self, camera: &Camera);

    /// Brings triangles and index lists up to date. This is what is timed.
    fn update(&mut self, camera: &Camera);

    /// Bytes of the index lists that the last update wrote, which are sent.
    fn sent_bytes(&self) -> usize;

    /// The lists of what is shown, after an update; those that were not written are the same as before.
    fn shown(&mut self) -> Vec<PatchList>;
}

/// The method, ready to follow; `budget` is the most triangles of one that keeps a budget.
pub fn follower<'a>(
    method: LodMethod,
    terrain: &'a PreparedGround,
    budget: Option<usize>,
) -> Box<dyn Follow + 'a> {
    match method {
        LodMethod::Full => Box::new(Full::new(terrain)),
        LodMethod::Geomipmap => Box::new(Mipmapping::new(terrain)),
        LodMethod::Refining { lists, rule, refiner } => {
            Box::new(Refining::new(lists, rule, refiner, terrain, budget))
        }
        LodMethod::Deferred { spheres } => Box::new(Deferring::new(spheres, terrain)),
    }
}
