//! The last ground map of a scene, and what it depends on.

use std::sync::{Arc, Mutex, PoisonError};

use glam::Vec3;

use sandtable_draw::ground::GroundMap;

/// The inputs that a scene's ground map depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundMapKey {
    /// 0 for every post, each further level for every second post of the one before, smoothed, and each level below 0 for twice
    /// as many posts a side, [between those of the model](GroundMap::with_halved_cells).
    pub level: i32,
    /// Unit vector toward the sun.
    pub to_sun: Vec3,
}

/// The ground map that was made last: pictures of one view after the other share it.
#[derive(Debug, Default)]
pub struct GroundMapCache(Mutex<Option<(GroundMapKey, Arc<GroundMap>)>>);

impl GroundMapCache {
    /// The map of a key, made by `make` unless it is the last.
    pub(super) fn get(&self, key: GroundMapKey, make: impl FnOnce() -> GroundMap) -> Arc<GroundMap> {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*last {
            Some((of, map)) if *of == key => Arc::clone(map),
            _ => {
                // The one before is dropped first.
                *last = None;
                let map = Arc::new(make());
                *last = Some((key, Arc::clone(&map)));
                map
            }
        }
    }

    /// Whether the map that was made last is that of a key.
    pub(super) fn has(&self, key: GroundMapKey) -> bool {
        let last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        last.as_ref().is_some_and(|(of, _)| *of == key)
    }

    /// Whether no map has been made.
    pub(super) fn is_empty(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_none()
    }
}
