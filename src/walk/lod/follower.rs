//! The interface of every method: follow a camera, return the triangles shown.

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
