//! Making the nested spheres anew for another size of the picture, in an update or on another thread.

use crate::pipeline::walk::Walk;
use crate::roam::dynamic::SphereTask;
use crate::roam::spheres::SphereMap;
use crate::view::camera::Camera;

/// Spheres that reach farther than a picture needs, by up to this factor, are kept: they show more triangles, and making
/// them anew for every size that a window has while it is resized would take longer.
const MOST_REACH: f32 = 1.25;

/// Spheres that are made anew because a picture needs larger ones reach by this factor farther than it needs.
const SPARE_REACH: f32 = 1.1;

impl Walk {
    /// The task of making the spheres anew for the picture of a camera; `None` where they are as large as it needs, and not
    /// much larger.
    pub fn reach_task(&self, camera: &Camera) -> Option<SphereTask> {
        let (needed, terrain) = (self.vantage(camera).reach, self.mesh.source());
        let held = terrain.reach();
        if (needed..=needed * MOST_REACH).contains(&held) {
            return None;
        }
        let reach = if needed > held { needed * SPARE_REACH } else { needed };
        Some(terrain.sphere_task(reach))
    }

    /// Takes over the spheres that a task has made: the next update shows the ground by them. After an edit since then they
    /// are of no use, and [`Walk::reach_task`] has another task.
    pub fn take_reach(&mut self, task: &SphereTask, spheres: SphereMap) {
        if self.mesh.source_mut().take_spheres(task, spheres) {
            self.mesh.restart();
            self.shown.relist_all();
            self.laid.forget_cuts(|_| true);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use glam::DVec2;

    use crate::earthworks::brush::set_heights;
    use crate::pipeline::viewing::open_to_view;
    use crate::pipeline::walk::Walk;
    use crate::pipeline::walk::frame::{ReachRenewal, WalkOptions};
    use crate::scene::picture;
    use crate::terrain::lattice::Post;
    use crate::terrain::post_rect::PostRect;

    #[test]
    fn spheres_of_a_task_show_the_ground_that_an_update_would() {
        let editor = open_to_view(Path::new("scenes/road.toml"), &[]).expect("readable");
        let scene = Arc::new(editor.source().build(&|_| ()).expect("sound"));
        let by_task = WalkOptions { renewal: ReachRenewal::ByTask, ..WalkOptions::default() };
        let mut walks =
            [WalkOptions::default(), by_task].map(|options| Walk::new(Arc::clone(&scene), options));
        let camera =
            |height: u32| picture::camera(&scene, &scene.cameras[0], (height * 2, height)).expect("sound");
        let triangles = |walk: &mut Walk, height: u32| {
            walk.update(&camera(height)).expect("in memory").statistics.triangles
        };
        let small = triangles(&mut walks[1], 300);
        let [at_once, by_task] = &mut walks;
        let large = triangles(at_once, 2400);
        assert!(large > small && triangles(by_task, 2400) < large, "{small} and {large} triangles");
        let task = by_task.reach_task(&camera(2400)).expect("too small");
        by_task.take_reach(&task, task.spheres());
        assert_eq!(triangles(by_task, 2400), large);
        assert!(by_task.reach_task(&camera(2400)).is_none());
        // An edit between the task and its end makes it useless.
        let task = by_task.reach_task(&camera(300)).expect("too large");
        let spheres = task.spheres();
        let post = Post { column: 40, row: 40 };
        let height = by_task.elevations().height(post) + 30.0;
        let edited =
            by_task.edit(|lattice| set_heights(lattice, PostRect { first: post, last: post }, &[height]));
        assert!(edited.expect("in memory").is_some());
        by_task.take_reach(&task, spheres);
        assert!(by_task.reach_task(&camera(300)).is_some());
        triangles(by_task, 2400);
        by_task.check();
        assert!(by_task.ground_z(DVec2::splat(500.0)).is_some());
    }
}
