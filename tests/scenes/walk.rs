//! A walk hands a renderer what a picture of the same camera shows, and stays sound wherever it goes.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::{DVec2, Mat4, Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable_draw::patches::{DrapedPiece, GroundChanges, PatchId};
use sandtable_earthworks::brush::{Crater, Trench};
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_picture::{build_draw_list, camera};
use sandtable_render::{RenderBackend, render};
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::PictureSize;
use sandtable_sheet::picture_buffers::pick;
use sandtable_view::camera::Camera;
use sandtable_walk::Walk;
use sandtable_walk::frame::WalkOptions;
use sandtable_walk::pick::{StandingIndex, pixel_ray};

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
            add(&mut list, Arc::unwrap_or_clone(mesh), material, layer, feature);
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
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(name);
    Arc::new(open_scene(&path, &[], &|_| {}).expect("the demonstration is sound"))
}

/// The share of pixels whose features differ, and the mean difference of colors in 255ths.
fn difference(walked: &DrawList, camera: &Camera, scene: &SceneModel, name: &str) -> (f64, f64) {
    let drawn = build_draw_list(scene, camera, &|_| ()).list;
    let [a, b] =
        [walked, &drawn].map(|list| render(list, camera, RenderBackend::Cpu, &|_| ()).expect("a sound list"));
    if let Some(folder) = std::env::var_os("SANDTABLE_LOOK") {
        for (picture, of) in [(&a, "walk"), (&b, "picture")] {
            let png = sandtable_files::png::encode_png(&picture.pixels);
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
    for (name, views) in [("jacksboro.toml", 9), ("operation.toml", 1), ("sight.toml", 1), ("lake.toml", 1)] {
        let scene = scene(name);
        for view in scene.cameras.iter().take(views) {
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
    for frame in 0..27 {
        let part = frame as f32 / 54.0;
        let eye = first.eye().lerp(last.eye(), part);
        let forward = first.forward().lerp(last.forward(), part).normalize_or(Vec3::Y);
        let camera = Camera::new(eye, eye + forward, 0.7, (960, 540), first.planes()).expect("sound");
        held.take(walk.update(&camera).expect("in memory").changes);
        if frame % 13 != 12 {
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

#[test]
fn a_crater_shows_in_the_next_frame_and_is_gone_when_it_is_taken_back() {
    let scene = scene("jacksboro.toml");
    let camera = camera(&scene, &scene.cameras[0], (960, 540)).expect("a sound camera");
    let mut walk = Walk::new(Arc::clone(&scene), WalkOptions::default());
    let mut held = Held::default();
    held.take(walk.update(&camera).expect("in memory").changes);
    let list = walk.static_list(&camera, &|_| ());
    let (columns, posts) = list.ground.map(|map| (map.columns, map.posts.clone())).expect("a map");
    let before = held.vertices.clone();
    for (pixel, depth_m) in [((480.0, 400.0), 9.0), ((300.0, 330.0), 4.0), ((700.0, 500.0), 15.0)] {
        let at = walk.pick_ground(pixel_ray(&camera, Vec2::from(pixel))).expect("ground below the cursor");
        let plan = at.truncate();
        let ground_z = walk.ground_z(plan).expect("ground");
        let crater = Crater { center: plan, radius_m: 60.0, depth_m, rim_m: 1.0 };
        let dug = walk.edit(|lattice| crater.apply(lattice)).expect("in memory").expect("a crater");
        let trench = Trench {
            line: vec![plan, plan + DVec2::new(400.0, 90.0)],
            bottom_m: 20.0,
            top_m: 40.0,
            depth_m: 3.0,
        };
        let cut = walk.edit(|lattice| trench.apply(lattice)).expect("in memory").expect("a trench");
        assert!(dug.volumes.cut_m3 > 1000.0 && cut.number == dug.number + 1);
        let frame = walk.update(&camera).expect("in memory");
        let shown: Vec<PatchId> = frame.changes.vertices.iter().map(|patch| patch.patch).collect();
        let in_view = dug.patches.iter().filter(|patch| held.shown.contains(patch));
        assert!(in_view.clone().count() > 0 && in_view.clone().all(|patch| shown.contains(patch)));
        assert!(frame.statistics.bytes() < 4_000_000, "{:?}", frame.statistics);
        held.take(frame.changes);
        walk.check();
        let sunk_m = ground_z - walk.ground_z(plan).expect("ground");
        assert!(sunk_m > 0.35 * depth_m, "{sunk_m} m of {depth_m} m, between posts");
        for edit in [cut, dug] {
            walk.take_back(&edit.pieces).expect("in memory").expect("a change back");
        }
        let frame = walk.update(&camera).expect("in memory");
        let last = frame.changes.map.last().expect("the map was changed back");
        for (row, line) in last.posts.chunks_exact(last.columns as usize).enumerate() {
            let start = (last.first[1] as usize + row) * columns as usize + last.first[0] as usize;
            let apart = |(now, then): (&sandtable_draw::ground::GroundPost, _)| {
                let then: &sandtable_draw::ground::GroundPost = then;
                (now.height_m - then.height_m).abs()
            };
            let most = line.iter().zip(&posts[start..]).map(apart).fold(0.0, f32::max);
            assert!(most < 2.0, "the map is {most} m off");
        }
        held.take(frame.changes);
        walk.check();
        assert_eq!(walk.ground_z(plan), Some(ground_z));
    }
    assert!(
        held.vertices.iter().all(|(patch, positions)| before.get(patch).is_none_or(|then| then == positions))
    );
}

#[test]
fn a_ray_finds_what_the_buffers_of_a_picture_show() {
    let scene = scene("jacksboro.toml");
    let view = &scene.cameras[0];
    let size = PictureSize { width: 640, height: 360 };
    let pixels: Vec<[u32; 2]> = (0..12).flat_map(|x| (2..8).map(move |y| [x * 50 + 20, y * 44])).collect();
    let places = pick(&scene, view, size, &pixels, &|_| ()).expect("a picture");
    let camera = camera(&scene, view, (640, 360)).expect("a sound camera");
    let mut walk = Walk::new(Arc::clone(&scene), WalkOptions::default());
    walk.update(&camera).expect("in memory");
    let standing = StandingIndex::new(Arc::new(walk.static_list(&camera, &|_| ())));
    let (mut same, mut near) = (0, 0);
    for (&[column, row], place) in pixels.iter().zip(&places) {
        let ray = pixel_ray(&camera, Vec2::new(column as f32 + 0.5, row as f32 + 0.5));
        let found = walk.pick(ray, Some(&standing));
        assert_eq!(found.is_some(), place.is_some(), "{column}, {row}");
        let Some((found, place)) = found.zip(place.as_ref()) else { continue };
        same += usize::from(found.place.feature == place.feature);
        near += usize::from(found.place.at.distance(place.at) < 0.02 * place.distance_m);
        assert!(found.mgrs.is_some() && found.slope_deg.is_some_and(|slope| slope < 89.0));
    }
    let met = places.iter().flatten().count();
    assert!(met > 30 && same * 100 >= met * 90 && near * 100 >= met * 90, "{same}, {near} of {met}");
}
