//! A finer ground map of a part of the ground.

use std::sync::Arc;

use glam::Vec2;

use crate::ground::GroundMap;

/// A ground map in a world space of its own, which is shown in place of coarser ones where it has posts.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundInset {
    /// The map. Its large forms are those of the map around it.
    pub map: Arc<GroundMap>,
    /// The origin of its world space in that of the draw list.
    pub origin: Vec2,
}

impl GroundInset {
    /// Its least and its greatest corner in the world space of the draw list.
    pub fn corners(&self) -> [Vec2; 2] {
        let GroundMap { origin, cell, columns, rows, .. } = &*self.map;
        let first = self.origin + *origin;
        [first, first + *cell * Vec2::new((columns - 1) as f32, (rows - 1) as f32)]
    }
}
