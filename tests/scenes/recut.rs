//! What lies on the ground is cut again only in patches that changed, and still lies exactly on what is displayed.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use sandtable_draw::list::DrawMesh;
use sandtable_picture::{camera, recut};
use sandtable_ribbon::drape::drape;
use sandtable_ribbon::patches::{Drapes, StalePatch};
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::graph::Vertex;
use sandtable_roam::refine::coherent::Coherent;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_view::camera::Camera;

/// f32 world coordinates in a scene of ten kilometers, times the slope of a mountain side.
const ROUNDING_M: f64 = 5e-3;

/// A walk that keeps what it cut.
struct Walk<'a> {
    scene: &'a SceneModel,
    coherent: Coherent,
    seen: BTreeSet<usize>,
    drapes: Drapes,
}

impl Walk<'_> {
    /// One frame; returns what is displayed and how many patches were cut again.
    fn frame(&mut self, camera: &Camera) -> (DisplayedTerrain, usize) {
        let ground = self.scene.ground();
        let visible = ground.in_view(camera);
        let changes = self.coherent.update(&ground.screen_error(camera, 2.0), &visible);
        let seen: BTreeSet<usize> =
            visible.iter().map(|&corner: &Vertex| ground.layout().patch_index(corner)).collect();
        let came_or_went = seen.symmetric_difference(&self.seen).copied();
        let stale: BTreeSet<usize> = changes.dirty.iter().copied().chain(came_or_went).collect();
        let stale: Vec<StalePatch> = stale.into_iter().map(StalePatch::whole).collect();
        let active = self.coherent.active().clone();
        let displayed = DisplayedTerrain::new(Arc::clone(ground.lattice()), active, visible);
        self.drapes.recut(&stale, &displayed);
        self.seen = seen;
        (displayed, stale.len())
    }
}

fn plan_area(mesh: &DrawMesh) -> f64 {
    let corner = |id: sandtable_mesh::sink::VertexId| {
        Vec3::from(mesh.vertices[id.index()].position).truncate().as_dvec2()
    };
    mesh.triangles
        .iter()
        .map(|&[a, b, c]| (corner(b) - corner(a)).perp_dot(corner(c) - corner(a)) / 2.0)
        .sum()
}

#[test]
fn after_every_frame_of_a_flight_the_drapes_are_what_cutting_all_anew_would_give() {
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes/jacksboro.toml");
    let scene = open_scene(&path, &[], &|_| {}).expect("the demonstration is sound");
    let mut walk = Walk {
        scene: &scene,
        coherent: Coherent::new(*scene.ground().layout()),
        seen: BTreeSet::new(),
        drapes: recut::drapes(&scene),
    };
    let placed = |view: &SceneView| {
        let camera = camera(&scene, view, (960, 540)).expect("a sound camera");
        (camera.eye(), camera.eye() + camera.forward() * 20_000.0)
    };
    let (first, last) = (placed(&scene.cameras[0]), placed(scene.cameras.last().expect("several")));
    let mut recuts = Vec::new();
    for frame in 0..24 {
        let part = frame as f32 / 160.0;
        let aim = ViewAim::At { eye: first.0.lerp(last.0, part), target: first.1.lerp(last.1, part) };
        let view = SceneView { aim, ..scene.cameras[0].clone() };
        let camera = camera(&scene, &view, (960, 540)).expect("a sound camera");
        let (displayed, cut) = walk.frame(&camera);
        recuts.push(cut);
        if frame % 6 != 5 {
            continue;
        }
        let clearance = walk.drapes.check(&displayed);
        assert!(clearance < ROUNDING_M, "frame {frame}: {clearance} m");
        let mut kept = vec![0.0; scene.ribbons.len()];
        for patch in 0..scene.ground().layout().patch_count() {
            walk.drapes.in_patch(patch).for_each(|(ribbon, mesh)| kept[ribbon] += plan_area(mesh));
        }
        for (ribbon, kept) in scene.ribbons.iter().zip(kept) {
            let anew = plan_area(&drape(&ribbon.plan, &displayed));
            assert!(
                (kept - anew).abs() <= 1e-4 * anew + 0.5,
                "frame {frame}: {kept} m² kept, {anew} m² anew"
            );
        }
    }
    let occupied = walk.drapes.occupied();
    println!("patches cut a frame: {recuts:?} of {occupied} that hold something");
    assert!(
        recuts[1..].iter().all(|&cut| cut < occupied),
        "a step of a flight changes some patches, not all"
    );
}
