//! Rebuilds the ground for another size of the picture, in an update or on another thread: its nested spheres, the
//! triangles that they show, and the draped features cut to these.
//!
//! A ground that was exchanged for another is as good as before: who draws pictures of two sizes by turns keeps both grounds.

use glam::{DVec2, Vec3};

use crate::Walk;
use sandtable_picture::sheet_cuts::{SheetCuts, SheetParts};
use sandtable_roam::block::BlockSource;
use sandtable_roam::graph::Vertex;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::deferred::surface::DeferredSurface;
use sandtable_roam::sphere_task::{SphereTask, TaskGround};
use sandtable_view::camera::Camera;

/// Spheres that reach farther than a picture needs, by up to this factor, are kept: they show more triangles, and making
/// them anew for every size that a window has while it is resized would take longer.
const MOST_REACH: f32 = 1.25;

/// Spheres that are made anew because a picture needs larger ones reach by this factor farther than it needs.
const SPARE_REACH: f32 = 1.1;

/// The inputs for the ground of another picture. While it is kept, the next edit copies heights and errors.
pub struct ReachTask {
    spheres: SphereTask,
    eye: Vec3,
    visible: Vec<Vertex>,
    cell: DVec2,
    laid: SheetParts,
}

/// The ground for another picture; after [`Walk::take_reach`] the old ground, to be dropped where no frame waits for it.
pub struct ReachedGround {
    mesh: Deferred<TaskGround>,
    laid: SheetCuts,
}

impl ReachTask {
    /// Makes the ground, as it was seen last when the task was made.
    pub fn ground(self) -> ReachedGround {
        let ground = self.spheres.ground();
        let mut mesh = Deferred::new(ground, self.cell.min_element())
            .expect("the walk's own patches have 16-bit indices");
        // A patch that cannot be read is an error of the walk's next update, which lists it again.
        let is_listed = mesh.update(self.eye, &self.visible).is_ok();
        let listed = self.visible.iter().filter(|_| is_listed);
        let patches = listed.map(|&corner| mesh.source().layout().patch_index(corner)).collect();
        let laid = self.laid.cut(patches, &DeferredSurface::new(&mesh, self.cell));
        ReachedGround { mesh, laid }
    }
}

impl Walk {
    /// The task of making the ground anew for the picture of a camera; `None` where its spheres are as large as that needs,
    /// and not much larger.
    pub fn reach_task(&self, camera: &Camera) -> Option<ReachTask> {
        if self.suits(camera) {
            return None;
        }
        let terrain = self.mesh.source();
        let (needed, held) = (self.vantage(camera).reach, terrain.reach());
        let reach = if needed > held { needed * SPARE_REACH } else { needed };
        Some(ReachTask {
            spheres: terrain.sphere_task(reach),
            eye: self.mesh.eye(),
            visible: self.mesh.visible().to_vec(),
            cell: terrain.lattice().cell(),
            laid: self.laid.parts(),
        })
    }

    /// Whether the ground is as fine as the picture of a camera needs, and not much finer.
    pub fn suits(&self, camera: &Camera) -> bool {
        self.is_of_reach(camera, self.mesh.source().reach())
    }

    /// The same of a ground that [`Walk::take_reach`] would take over.
    pub fn would_suit(&self, ground: &ReachedGround, camera: &Camera) -> bool {
        let source = ground.mesh.source();
        source.edits() == self.mesh.source().edits() && self.is_of_reach(camera, source.reach())
    }

    fn is_of_reach(&self, camera: &Camera, reach: f32) -> bool {
        let needed = self.vantage(camera).reach;
        (needed..=needed * MOST_REACH).contains(&reach)
    }

    /// Takes over the ground that a task has made, and returns the one before, which can be taken over again: the next update
    /// shows the new one. After an edit since the task was begun it is of no use, and [`Walk::reach_task`] has another task.
    pub fn take_reach(&mut self, mut made: ReachedGround) -> ReachedGround {
        if self.mesh.source_mut().exchange_spheres(made.mesh.source_mut()) {
            self.mesh.exchange(&mut made.mesh);
            self.shown.relist_all();
            self.laid.exchange_cuts(&mut made.laid);
        }
        made
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use glam::DVec2;

    use crate::Walk;
    use crate::frame::{ReachRenewal, WalkOptions};
    use sandtable_earthworks::brush::set_heights;
    use sandtable_editing::viewing::open_to_view;
    use sandtable_picture as picture;
    use sandtable_terrain::lattice::Post;
    use sandtable_terrain::post_rect::PostRect;

    #[test]
    fn spheres_of_a_task_show_the_ground_that_an_update_would() {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
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
        by_task.take_reach(task.ground());
        let made = by_task.update(&camera(2400)).expect("in memory");
        assert_eq!(made.statistics.triangles, large);
        by_task.check();
        assert!(by_task.reach_task(&camera(2400)).is_none());
        // The ground of a small picture and that of a large one by turns.
        let task = by_task.reach_task(&camera(300)).expect("too large");
        let mut aside = by_task.take_reach(task.ground());
        for (height, other) in [(300, 2400), (2400, 300), (300, 2400), (2400, 300)] {
            let held = by_task.update(&camera(height)).expect("in memory").statistics.triangles;
            assert_eq!(held == large, height == 2400, "{held} triangles for a picture {height} pixels high");
            by_task.check();
            assert!(by_task.suits(&camera(height)) && by_task.would_suit(&aside, &camera(other)));
            aside = by_task.take_reach(aside);
        }
        aside = by_task.take_reach(aside);
        // An edit between the task and its end makes it useless.
        let task = by_task.reach_task(&camera(300)).expect("too large");
        let ground = task.ground();
        let post = Post { column: 40, row: 40 };
        let height = by_task.elevations().height(post) + 30.0;
        let edited =
            by_task.edit(|lattice| set_heights(lattice, PostRect { first: post, last: post }, &[height]));
        assert!(edited.expect("in memory").is_some());
        assert!(!by_task.would_suit(&aside, &camera(300)), "it is of before the edit");
        by_task.take_reach(ground);
        assert!(by_task.reach_task(&camera(300)).is_some());
        triangles(by_task, 2400);
        by_task.check();
        assert!(by_task.ground_z(DVec2::splat(500.0)).is_some());
    }

    #[test]
    fn lines_of_graphics_and_analyses_lie_on_the_ground_of_a_task() {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/obstacles.toml")), &[])
            .expect("readable");
        let scene = Arc::new(editor.source().build(&|_| ()).expect("sound"));
        let options = WalkOptions { renewal: ReachRenewal::ByTask, ..WalkOptions::default() };
        let mut walk = Walk::new(Arc::clone(&scene), options);
        let camera =
            |height: u32| picture::camera(&scene, &scene.cameras[0], (height * 2, height)).expect("sound");
        walk.update(&camera(300)).expect("in memory");
        for height in [2400, 300] {
            let task = walk.reach_task(&camera(height)).expect("of another size");
            walk.take_reach(task.ground());
            walk.update(&camera(height)).expect("in memory");
            walk.check();
        }
    }
}
