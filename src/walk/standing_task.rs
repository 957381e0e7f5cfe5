//! Makes the list of solids and models on another thread, while the walk goes on.
//!
//! A task holds a snapshot of all that the list depends on. What is edited meanwhile is added when the walk takes the list
//! over.

use std::sync::Arc;

use glam::Vec3;

use crate::Walk;
use crate::relief_map::ReliefEdits;
use sandtable_draw::list::DrawList;
use sandtable_picture::models::PlacementMoves;
use sandtable_picture::standing::{self, WalkedGround};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;
use sandtable_view::camera::Camera;

/// The inputs of a list of [`Walk::static_list`].
#[derive(Clone)]
pub struct StandingTask {
    scene: Arc<SceneModel>,
    moves: PlacementMoves,
    lattice: Arc<Lattice>,
    elevations: Arc<Lattice>,
    to_sun: Vec3,
    head: Arc<DrawList>,
    edits: ReliefEdits,
    /// How many additions the materials are of.
    additions: u32,
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
            additions: self.laid.additions(),
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
        if task.additions == self.laid.additions() {
            self.laid.lay_added();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec2;

    use super::*;
    use crate::frame::WalkOptions;
    use sandtable_editing::viewing::open_to_view;
    use sandtable_picture as picture;
    use sandtable_terrain::sight::line::SightEnd;
    use sandtable_terrain::sight::viewshed::ViewshedOptions;

    #[test]
    fn a_tint_is_laid_with_the_list_that_has_its_texture_and_taken_away() {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
        let scene = Arc::new(editor.source().build(&|_| ()).expect("sound"));
        let mut walk = Walk::new(Arc::clone(&scene), WalkOptions::default());
        let camera = picture::camera(&scene, &scene.cameras[0], (640, 400)).expect("sound");
        let before = walk.standing_task(walk.to_sun());
        let task = walk.viewshed_task(ViewshedOptions::new(SightEnd {
            at: DVec2::new(749_000.0, 4_017_500.0),
            above_m: 2.0,
        }));
        let tint = task.tint(&task.seen().expect("ground")).expect("seen");
        walk.lay_tint(tint);
        let tinted = |walk: &mut Walk, list: &DrawList| {
            let mut pieces = Vec::new();
            for _ in 0..200 {
                let frame = walk.update(&camera).expect("in memory");
                pieces.extend(frame.changes.drapes.into_iter().flat_map(|patch| patch.pieces));
                if frame.statistics.waiting_patches == 0 {
                    break;
                }
            }
            let is_tint = |index: usize| {
                let material = list.materials.get(index);
                material.is_some_and(|material| material.name == "tint" && material.texture.is_some())
            };
            pieces.iter().filter(|piece| is_tint(piece.material.0 as usize)).count()
        };
        let old = before.list(&camera, &|_| ());
        walk.take_standing(&before, &old);
        assert_eq!(tinted(&mut walk, &old), 0, "a list without the texture shows no tint");
        let after = walk.standing_task(walk.to_sun());
        let list = after.list(&camera, &|_| ());
        walk.take_standing(&after, &list);
        assert!(tinted(&mut walk, &list) > 0, "patches in view are tinted");
        walk.check();
        walk.clear_tint();
        walk.forget_handed();
        assert_eq!(tinted(&mut walk, &list), 0, "taken away");
    }
}
