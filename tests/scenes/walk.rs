//! A walk hands a renderer what a picture of the same camera shows, and stays sound wherever it goes.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{Mat4, Vec3};
use sandtable::draw::color::Srgba;
use sandtable::draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable::draw::patches::{DrapedPiece, GroundChanges, PatchId};
use sandtable::mesh::sink::{MeshSink, VertexId};
use sandtable::pipeline::scene_file::open_scene;
use sandtable::pipeline::walk::Walk;
use sandtable::pipeline::walk::frame::WalkOptions;
use sandtable::render::{RenderBackend, render};
use sandtable::scene::SceneModel;
use sandtable::scene::picture::{build_draw_list, camera};
use sandtable::view::camera::Camera;

/// What a renderer keeps of the changes it was handed.
#[derive(Default)]
struct Held {
    vertices: BTreeMap<PatchId, Vec<[f32; 3]>>,
    triangles: BTreeMap<PatchId, Arc<Vec<[u16; 3]>>>,
    drapes: BTreeMap<PatchId, Vec<DrapedPiece>>,
    shown: std::collections::BTreeSet<PatchId>,
}

impl Held {
    fn take(&mut self, changes: GroundChanges) {
        for patch in changes.vertices {
            self.vertices.insert(patch.patch, patch.positions);
        }
        for patch in changes.hidden {
            assert!(self.shown.remove(&patch), "{patch:?} was hidden before");
        }
        for patch in changes.triangles {
            self.triangles.insert(patch.patch, patch.triangles);
            self.shown.insert(patch.patch);
        }
        for patch in changes.dropped {
            assert!(!self.shown.contains(&patch) && self.vertices.remove(&patch).is_some(), "{patch:?}");
        }
        for patch in changes.drapes {
            assert!(self.shown.contains(&patch.patch), "what lies on a patch that is not shown");
            self.drapes.insert(patch.patch, patch.pieces);
        }
    }

    /// What a renderer shows of `list` and the patches in view.
    fn list(&self, mut list: DrawList) -> DrawList {
        let standing = std::mem::take(&mut list.items);
        let mut draped = Vec::new();
        for patch in &self.shown {
            let mut mesh = DrawMesh::default();
            for &position in &self.vertices[patch] {
                mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE });
            }
            for corners in self.triangles[patch].iter() {
                mesh.triangle(corners.map(|index| VertexId::new(index.into())));
            }
            add(&mut list, mesh, MaterialId(0), DepthLayer::Ground, FeatureId::GROUND);
            draped.extend(self.drapes.get(patch).into_iter().flatten().cloned());
        }
        draped.sort_by_key(|piece| piece.layer);
        for DrapedPiece { mesh, material, layer, feature } in draped {
            add(&mut list, mesh, material, layer, feature);
        }
        list.items.extend(standing);
        list
    }
}

fn add(list: &mut DrawList, mesh: DrawMesh, material: MaterialId, layer: DepthLayer, feature: FeatureId) {
    let triangles = 0..mesh.triangles.len() as u32;
    let mesh = list.add_mesh(mesh);
    list.items.push(DrawItem { mesh, triangles, material, world_from_mesh: Mat4::IDENTITY, layer, feature });
}

fn scene(name: &str) -> Arc<SceneModel> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    Arc::new(open_scene(&path, &[], &|_| {}).expect("the demonstration is sound"))
}

/// The share of pixels whose features differ, and the mean difference of colors in 255ths.
fn difference(walked: &DrawList, camera: &Camera, scene: &SceneModel, name: &str) -> (f64, f64) {
    let drawn = build_draw_list(scene, camera, &|_| ()).list;
    let [a, b] = [walked, &drawn].map(|list| render(list, camera, RenderBackend::Cpu).expect("a sound list"));
    if let Some(folder) = std::env::var_os("SANDTABLE_LOOK") {
        for (picture, of) in [(&a, "walk"), (&b, "picture")] {
            let png = sandtable::export::encode_png(&picture.pixels);
            std::fs::write(Path::new(&folder).join(format!("{name}-{of}.png")), png).expect("writable");
        }
    }
    let count = a.features.len() as f64;
    let features = a.features.iter().zip(&b.features).filter(|(a, b)| a != b).count() as f64 / count;
    let apart =
        |(a, b): (&Srgba, &Srgba)| (0..3).map(|at| f64::from(a.0[at].abs_diff(b.0[at]))).sum::<f64>() / 3.0;
    let colors = a.pixels.data().iter().zip(b.pixels.data()).map(apart).sum::<f64>() / count;
    (features, colors)
}

#[test]
fn a_walk_shows_what_a_picture_of_its_camera_shows() {
    for name in ["jacksboro.toml"] {
        let scene = scene(name);
        for view in &scene.cameras {
            let Ok(camera) = camera(&scene, view, (640, 360)) else { continue };
            let options =
                WalkOptions { to_sun: Some(scene.sunlight.to_sun(Some(&camera))), ..WalkOptions::default() };
            let mut walk = Walk::new(Arc::clone(&scene), options);
            let mut held = Held::default();
            let frame = walk.update(&camera).expect("in memory");
            held.take(frame.changes);
            walk.check();
            let list = held.list(walk.static_list(&camera, &|_| ()));
            list.check().expect("a sound list");
            let (features, colors) = difference(&list, &camera, &scene, &format!("{name}-{}", view.name));
            println!("{name} {}: {features:.4} of features, {colors:.2} of colors", view.name);
            assert!(features < 0.02 && colors < 3.0, "{name} {}: {features} {colors}", view.name);
        }
    }
}

#[test]
fn after_a_flight_a_renderer_holds_what_a_walk_that_begins_there_hands_it() {
    let scene = scene("jacksboro.toml");
    let placed = |at: usize| camera(&scene, &scene.cameras[at], (960, 540)).expect("a sound camera");
    let (first, last) = (placed(0), placed(scene.cameras.len() - 1));
    let options = WalkOptions { kept_patches: 40, ..WalkOptions::default() };
    let mut walk = Walk::new(Arc::clone(&scene), options);
    let mut held = Held::default();
    for frame in 0..40 {
        let part = frame as f32 / 80.0;
        let eye = first.eye().lerp(last.eye(), part);
        let forward = first.forward().lerp(last.forward(), part).normalize_or(Vec3::Y);
        let camera = Camera::new(eye, eye + forward, 0.7, (960, 540), first.planes()).expect("sound");
        let frame_out = walk.update(&camera).expect("in memory");
        held.take(frame_out.changes);
        if frame % 13 != 0 {
            continue;
        }
        walk.check();
        let mut anew = Walk::new(Arc::clone(&scene), options);
        let mut fresh = Held::default();
        fresh.take(anew.update(&camera).expect("in memory").changes);
        assert_eq!(held.shown, fresh.shown, "frame {frame}");
        for patch in &held.shown {
            assert_eq!(held.vertices[patch], fresh.vertices[patch]);
            let sorted = |held: &Held| {
                let mut triangles = held.triangles[patch].to_vec();
                triangles.iter_mut().for_each(|corners| corners.sort_unstable());
                triangles.sort_unstable();
                triangles
            };
            assert_eq!(sorted(&held), sorted(&fresh), "frame {frame}, {patch:?}");
            let features = |held: &Held| -> Vec<(FeatureId, MaterialId)> {
                let pieces = held.drapes.get(patch).into_iter().flatten();
                pieces.map(|piece| (piece.feature, piece.material)).collect()
            };
            assert_eq!(features(&held).is_empty(), features(&fresh).is_empty(), "frame {frame}, {patch:?}");
        }
    }
}
