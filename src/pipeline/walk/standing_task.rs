//! Making the list of what stands on another thread, while the walk goes on.
//!
//! A task holds a snapshot of all that the list depends on. What is edited meanwhile is added when the walk takes the list
//! over.

use std::sync::Arc;

use glam::Vec3;

use crate::draw::list::DrawList;
use crate::pipeline::walk::Walk;
use crate::pipeline::walk::relief_map::ReliefEdits;
use crate::scene::SceneModel;
use crate::scene::picture::models::PlacementMoves;
use crate::scene::picture::standing::{self, WalkedGround};
use crate::terrain::lattice::Lattice;
use crate::view::camera::Camera;

/// What a list of [`Walk::static_list`] is made of.
#[derive(Clone)]
pub struct StandingTask {
    scene: Arc<SceneModel>,
    moves: PlacementMoves,
    lattice: Arc<Lattice>,
    elevations: Arc<Lattice>,
    to_sun: Vec3,
    head: Arc<DrawList>,
    edits: ReliefEdits,
}

impl StandingTask {
    /// The list, as [`Walk::static_list`] makes it.
    pub fn list(&self, camera: &Camera, progress: &dyn Fn(&'static str)) -> DrawList {
        let walked = WalkedGround { moves: &self.moves, lattice: &self.lattice, to_sun: self.to_sun };
        let mut list = standing::standing(&self.scene, walked, camera, &self.head, progress);
        if let Some(map) = &mut list.ground {
            self.edits.apply(map, &self.elevations);
        }
        list
    }
}

impl Walk {
    /// The task of making the list of [`Walk::static_list`], lit by a sun in the direction of the unit vector `to_sun`. While
    /// it is kept, the next edit copies the heights.
    pub fn standing_task(&self, to_sun: Vec3) -> StandingTask {
        StandingTask {
            scene: Arc::clone(&self.scene),
            moves: self.moves.clone(),
            lattice: Arc::clone(self.lattice()),
            elevations: Arc::clone(self.elevations()),
            to_sun,
            head: Arc::clone(self.laid.head()),
            edits: self.map.edits().clone(),
        }
    }

    /// Takes over the list that a task has made: the next update hands over what was edited since, and the sun is the
    /// task's.
    pub fn take_standing(&mut self, task: &StandingTask, list: &DrawList) {
        self.set_sun(task.to_sun);
        if let Some(map) = &list.ground {
            let elevations = Arc::clone(self.elevations());
            self.map.take_over(map, &task.edits, &elevations);
        }
    }
}
