//! What every method does: it follows a camera and says what it shows.

use crate::app::lod::method::{Emit, Method, Refine};
use crate::app::lod::prepared::Prepared;
use crate::app::lod::rebuild::Rebuilding;
use crate::roam::shown::PatchList;
use crate::view::camera::Camera;

/// A method at work.
pub trait Follow {
    /// What a camera needs once for the whole flight; not timed.
    fn prepare(&mut self, camera: &Camera);

    /// Brings triangles and index lists up to date. This is what is timed.
    fn update(&mut self, camera: &Camera);

    /// The lists of what is shown, after an update.
    fn shown(&self) -> Vec<PatchList>;

    /// What is sent of them.
    fn sending(&self) -> Sending;
}

/// Which lists are sent anew for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sending {
    /// All that are shown: nothing is known to be what it was.
    Everything,
    /// Those that are not what they were.
    Changed,
}

/// The method, ready to follow.
pub fn follower<'a>(method: Method, terrain: &'a Prepared) -> Box<dyn Follow + 'a> {
    match method {
        Method::Refining { emit: Emit::Bintree, rule, refine: Refine::Rebuild } => {
            Box::new(Rebuilding::new(rule, terrain))
        }
    }
}
