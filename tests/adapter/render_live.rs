//! Frames of a scene that stays on the device, against the picture of the whole scene.
//!
//! Without an adapter the tests say so; with `SANDTABLE_REQUIRE_GPU` set they fail instead.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Vec2, Vec3};
use sandtable_draw::ground_levels::coarser_levels;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId};
use sandtable_draw::patches::{
    DrapedPiece, GroundChanges, GroundMapPatch, PatchDrapes, PatchId, PatchTriangles, PatchVertices,
};
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::live::{
    KeptPatches, LiveDetail, LiveOptions, LiveQuality, LiveRenderer, LiveShadows, UploadedBytes,
};
use sandtable_gpu::render_on;
use sandtable_gpu::shadow_maps::ShadowMaker;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_view::camera::Camera;

use crate::adapters::gpus;
use crate::common::synthetic::{HOUSE, LAKE, ROAD, camera, ground_of, scene};

/// Posts along a side of the scene's ground and of a patch of it, and patches along a side.
const POSTS: usize = 65;
const PATCH_POSTS: usize = 33;
const PATCHES: usize = 2;

/// The size of the pictures; 64 pixels in a row make copies without padding.
pub const SIZE: (u32, u32) = (640, 480);

/// Which patch holds a place in the plan.
fn patch_at(at: Vec2) -> usize {
    let side = (PATCH_POSTS - 1) as f32 * 10.0;
    let [x, y] = [at.x, at.y].map(|along| ((along / side) as usize).min(PATCHES - 1));
    y * PATCHES + x
}

/// The ground and the drapes of a list by patches, as if all were shown for the first time.
pub fn changes(list: &DrawList) -> GroundChanges {
    let mut changes = GroundChanges::default();
    let ground = &list.meshes[list.items[0].mesh.0 as usize];
    for patch in 0..PATCHES * PATCHES {
        let step = PATCH_POSTS - 1;
        let [first_x, first_y] = [patch % PATCHES * step, patch / PATCHES * step];
        let row = |y: usize| {
            (0..PATCH_POSTS).map(move |x| ground.vertices[(first_y + y) * POSTS + first_x + x].position)
        };
        let id = PatchId(patch as u32);
        changes
            .vertices
            .push(PatchVertices { patch: id, positions: (0..PATCH_POSTS).flat_map(row).collect() });
        changes.triangles.push(PatchTriangles { patch: id, triangles: Arc::new(patch_triangles()) });
        let draped = list.items.iter().filter(|item| matches!(item.layer, DepthLayer::Draped(_)));
        let pieces = draped.map(|item| piece(list, item, patch)).collect();
        changes.drapes.push(PatchDrapes { patch: id, pieces });
    }
    changes
}

fn patch_triangles() -> Vec<[u16; 3]> {
    let mut triangles = Vec::new();
    for y in 0..PATCH_POSTS - 1 {
        for x in 0..PATCH_POSTS - 1 {
            let id = |east: usize, north: usize| ((y + north) * PATCH_POSTS + x + east) as u16;
            triangles.extend([[id(0, 0), id(1, 0), id(1, 1)], [id(0, 0), id(1, 1), id(0, 1)]]);
        }
    }
    triangles
}

/// Those triangles of an item whose middle lies in a patch.
fn piece(list: &DrawList, item: &DrawItem, patch: usize) -> DrapedPiece {
    let whole = &list.meshes[item.mesh.0 as usize];
    let mut mesh = DrawMesh::default();
    for corners in &whole.triangles {
        let corners: [DrawVertex; 3] = corners.map(|id| whole.vertices[id.index()]);
        let middle = corners.iter().map(|corner| Vec3::from(corner.position)).sum::<Vec3>() / 3.0;
        if patch_at(middle.truncate()) == patch {
            let ids: [VertexId; 3] = corners.map(|corner| mesh.vertex(corner));
            mesh.triangle(ids);
        }
    }
    DrapedPiece { mesh: Arc::new(mesh), material: item.material, layer: item.layer, feature: item.feature }
}

/// A texture to draw frames to, and the bytes of one.
pub struct Window {
    texture: wgpu::Texture,
}

impl Window {
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        let texture = gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("window"),
            size: wgpu::Extent3d { width: SIZE.0, height: SIZE.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Self { texture }
    }

    pub fn frame(&self, renderer: &mut LiveRenderer, camera: &Camera) -> Vec<[u8; 4]> {
        self.frame_with(renderer, camera, &LiveOptions::default())
    }

    fn frame_with(
        &self,
        renderer: &mut LiveRenderer,
        camera: &Camera,
        options: &LiveOptions,
    ) -> Vec<[u8; 4]> {
        let gpu = renderer.gpu().clone();
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        self.record(renderer, &mut encoder, (camera, options));
        gpu.queue().submit([encoder.finish()]);
        self.pixels(&gpu)
    }

    fn record(
        &self,
        renderer: &mut LiveRenderer,
        encoder: &mut wgpu::CommandEncoder,
        (camera, options): (&Camera, &LiveOptions),
    ) {
        let view = self.texture.create_view(&Default::default());
        renderer.draw(encoder, &view, SIZE, camera, options).unwrap_or_else(|error| panic!("{error}"));
    }

    fn pixels(&self, gpu: &Gpu) -> Vec<[u8; 4]> {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let size = u64::from(SIZE.0 * SIZE.1 * 4);
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("copy of a frame"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIZE.0 * 4), rows_per_image: None };
        let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
        encoder.copy_texture_to_buffer(self.texture.as_image_copy(), to, self.texture.size());
        gpu.queue().submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: None };
        gpu.device().poll(wait).expect("drawn");
        let mapped = buffer.get_mapped_range(..).expect("mapped");
        mapped.as_chunks().0.to_vec()
    }
}

/// A renderer of the best quality with the scene loaded and all its ground shown.
fn loaded(gpu: &Gpu, list: &DrawList, format: wgpu::TextureFormat) -> LiveRenderer {
    loaded_with(gpu, list, format, 4)
}

/// The same with so many samples per pixel.
fn loaded_with(gpu: &Gpu, list: &DrawList, format: wgpu::TextureFormat, samples: u32) -> LiveRenderer {
    let quality = LiveQuality { samples, anisotropy: 16 };
    let mut renderer =
        LiveRenderer::with_quality(gpu, format, quality).unwrap_or_else(|error| panic!("{error}"));
    renderer.load(list).unwrap_or_else(|error| panic!("{error}"));
    renderer.update(&changes(list)).unwrap_or_else(|error| panic!("{error}"));
    renderer
}

/// A camera that sees the scene from another side than most.
fn from_aside() -> Camera {
    Camera::new(Vec3::new(900.0, -200.0, 500.0), Vec3::new(320.0, 320.0, 0.0), 0.85, SIZE, (1.0, 5000.0))
        .expect("sound")
}

/// The share of pixels of which a channel differs by more than two steps.
fn share_apart<'a>(
    one: impl IntoIterator<Item = &'a [u8; 4]>,
    other: impl IntoIterator<Item = &'a [u8; 4]>,
) -> f64 {
    let apart = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).any(|channel| a[channel].abs_diff(b[channel]) > 2);
    one.into_iter().zip(other).filter(|&pair| apart(pair)).count() as f64 / f64::from(SIZE.0 * SIZE.1)
}

pub const WINDOW: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

#[test]
fn a_frame_is_the_picture_of_the_same_scene() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let picture = render_on(gpu, &list, &camera).unwrap_or_else(|error| panic!("{error}"));
        let picture: Vec<[u8; 4]> = picture.pixels.data().iter().map(|color| color.0).collect();
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let bare = share_apart(&window.frame(&mut renderer, &camera), &picture);
        let shadows = LiveShadows::new(&list, &camera).unwrap_or_else(|error| panic!("{error}"));
        renderer.set_shadows(&shadows).unwrap_or_else(|error| panic!("{error}"));
        let apart = share_apart(&window.frame(&mut renderer, &camera), &picture);
        assert!(apart < 1e-3, "{apart} of the pixels differ on {}", gpu.name());
        assert!(bare > 0.01, "without its shadows a frame differs, {bare} on {}", gpu.name());
    }
}

#[test]
fn shadows_that_the_adapter_draws_for_a_frame_are_those_of_the_picture() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let picture = render_on(gpu, &list, &camera).unwrap_or_else(|error| panic!("{error}"));
        let picture: Vec<[u8; 4]> = picture.pixels.data().iter().map(|color| color.0).collect();
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        for maker in [ShadowMaker::Processor, ShadowMaker::Adapter, ShadowMaker::Adapter] {
            let prepared = renderer.loader().cast_shadows_by(maker, &list, &camera);
            let shown = prepared.and_then(|prepared| renderer.show_shadows(prepared));
            shown.unwrap_or_else(|error| panic!("{maker:?}: {error}"));
            let apart = share_apart(&window.frame(&mut renderer, &camera), &picture);
            assert!(apart < 1e-3, "{apart} of the pixels differ on {} by {maker:?}", gpu.name());
        }
    }
}

#[test]
fn with_one_sample_a_pixel_surfaces_look_as_in_the_picture() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let picture = render_on(gpu, &list, &camera).unwrap_or_else(|error| panic!("{error}"));
        let mut renderer = loaded_with(gpu, &list, WINDOW, 1);
        let shadows = LiveShadows::new(&list, &camera).unwrap_or_else(|error| panic!("{error}"));
        renderer.set_shadows(&shadows).unwrap_or_else(|error| panic!("{error}"));
        let frame = Window::new(gpu, WINDOW).frame(&mut renderer, &camera);
        // Where all around is of one feature and the depth has no step: not at the edges of the surfaces.
        let columns = SIZE.0 as usize;
        let is_inside = |index: &usize| {
            let sides = [index.saturating_sub(1), index + 1, index.saturating_sub(columns), index + columns];
            let (feature, depth_m) = (picture.features[*index], picture.depth_m[*index]);
            sides.into_iter().filter(|&at| at < picture.features.len()).all(|at| {
                picture.features[at] == feature && (picture.depth_m[at] / depth_m - 1.0).abs() < 0.02
            })
        };
        for feature in [FeatureId::GROUND, HOUSE, LAKE, ROAD] {
            let inside: Vec<usize> = (0..picture.features.len())
                .filter(|&index| picture.features[index] == feature)
                .filter(is_inside)
                .collect();
            let colors = inside.iter().map(|&index| picture.pixels.data()[index].0).collect::<Vec<_>>();
            let apart = share_apart(inside.iter().map(|&index| &frame[index]), &colors);
            let share = apart * f64::from(SIZE.0 * SIZE.1) / inside.len() as f64;
            assert!(share < 0.02, "{share} of {} pixels of {feature:?} on {}", inside.len(), gpu.name());
            assert!(inside.len() > 200, "{} pixels of {feature:?}", inside.len());
        }
    }
}

#[test]
fn a_window_that_does_not_encode_colors_shows_the_same() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    let swapped = |[blue, green, red, alpha]: &[u8; 4]| [*red, *green, *blue, *alpha];
    for gpu in gpus() {
        let frame = |format| {
            let mut renderer = loaded(gpu, &list, format);
            Window::new(gpu, format).frame(&mut renderer, &camera)
        };
        let plain: Vec<_> = frame(wgpu::TextureFormat::Bgra8Unorm).iter().map(swapped).collect();
        assert_eq!(share_apart(&plain, &frame(WINDOW)), 0.0, "on {}", gpu.name());
    }
}

#[test]
fn what_changes_is_sent_and_nothing_else() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let before = window.frame(&mut renderer, &camera);
        let nothing = renderer.update(&GroundChanges::default()).expect("nothing can fail");
        assert_eq!(nothing, UploadedBytes::default());

        let all = changes(&list);
        let half = Arc::new(all.triangles[3].triangles.iter().step_by(2).copied().collect::<Vec<_>>());
        let count = half.len() as u64;
        let triangles = vec![PatchTriangles { patch: PatchId(3), triangles: half }];
        let sent = renderer.update(&GroundChanges { triangles, ..Default::default() }).expect("it fits");
        assert_eq!(sent, UploadedBytes { triangles: count * 6, ..Default::default() });
        let holed = share_apart(&window.frame(&mut renderer, &camera), &before);
        assert!(holed > 0.01, "holes are seen in {holed} of the pixels on {}", gpu.name());

        let hidden = vec![PatchId(3)];
        renderer.update(&GroundChanges { hidden, ..Default::default() }).expect("it fits");
        let hole = share_apart(&window.frame(&mut renderer, &camera), &before);
        assert!(hole > holed, "nothing of the patch is seen on {}", gpu.name());
        let triangles = vec![all.triangles[3].clone()];
        renderer.update(&GroundChanges { triangles, ..Default::default() }).expect("it fits");
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0, "all is back");

        let dropped = (0..4).map(PatchId).collect();
        renderer.update(&GroundChanges { dropped, ..Default::default() }).expect("it fits");
        let bare = share_apart(&window.frame(&mut renderer, &camera), &before);
        assert!(bare > hole, "there is no ground on {}", gpu.name());
        renderer.update(&all).expect("it fits");
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0, "all is back again");
    }
}

#[test]
fn what_lies_is_sent_anew_only_where_it_was_cut_again() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let all = changes(&list);
        renderer.update(&all).expect("it fits");
        let before = window.frame(&mut renderer, &camera);
        let again = renderer.update(&GroundChanges { drapes: all.drapes.clone(), ..Default::default() });
        assert_eq!(again.expect("it fits"), UploadedBytes::default(), "the same meshes");
        let cut_again = |patch: &PatchDrapes| PatchDrapes {
            pieces: patch
                .pieces
                .iter()
                .map(|piece| DrapedPiece { mesh: Arc::new((*piece.mesh).clone()), ..piece.clone() })
                .collect(),
            ..patch.clone()
        };
        let patch = all.drapes.iter().find(|patch| !patch.pieces.is_empty()).expect("something lies");
        let drapes = vec![cut_again(patch)];
        let sent = renderer.update(&GroundChanges { drapes, ..Default::default() }).expect("it fits");
        assert!(sent.drapes > 0 && sent.total() == sent.drapes, "{sent:?}");
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0, "on {}", gpu.name());
    }
}

#[test]
fn a_changed_ground_map_shows_as_one_loaded_anew() {
    let (mut list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let before = window.frame(&mut renderer, &camera);
        let map = ground_of(&mut list);
        let (first, columns, rows) = ([40, 7], 9, 30);
        let mut posts = Vec::new();
        for row in first[1]..first[1] + rows {
            for column in first[0]..first[0] + columns {
                let post = &mut map.posts[(row * map.columns + column) as usize];
                (post.slope_east, post.slope_north) = (post.slope_east + 0.8, -0.4);
                posts.push(*post);
            }
        }
        let change = GroundMapPatch { first, columns, posts };
        let sent = renderer.update(&GroundChanges { map: vec![change.clone()], ..Default::default() });
        let sent = sent.expect("it lies on the map");
        assert!(sent.map >= 16 * u64::from(columns * rows) && sent.map == sent.total(), "{sent:?}");
        assert!(sent.map < 3 * 16 * u64::from(columns * rows), "{sent:?}");
        let after = window.frame(&mut renderer, &camera);
        assert!(share_apart(&after, &before) > 0.005, "the change is seen on {}", gpu.name());
        let anew = window.frame(&mut loaded(gpu, &list, WINDOW), &camera);
        assert_eq!(share_apart(&after, &anew), 0.0, "on {}", gpu.name());
        let beside = GroundMapPatch { first: [60, 60], ..change };
        let error = renderer.update(&GroundChanges { map: vec![beside], ..Default::default() });
        assert!(error.is_err(), "it lies beside the map");
        list = scene();
    }
}

#[test]
fn a_scene_prepared_on_another_thread_shows_as_one_that_is_loaded() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let shadows = LiveShadows::new(&list, &camera).unwrap_or_else(|error| panic!("{error}"));
        renderer.set_shadows(&shadows).unwrap_or_else(|error| panic!("{error}"));
        let before = window.frame(&mut renderer, &camera);
        let loader = renderer.loader();
        let prepare = || {
            let prepared = loader.prepare(&list, &shadows).unwrap_or_else(|error| panic!("{error}"));
            let mut first = loader.prepare(&list, &shadows).unwrap_or_else(|error| panic!("{error}"));
            loader.update(&mut first, &changes(&list)).unwrap_or_else(|error| panic!("{error}"));
            (prepared, first)
        };
        let (kept, first) = std::thread::scope(|scope| scope.spawn(prepare).join().expect("prepared"));
        renderer.show(kept, KeptPatches::All);
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0, "the ground stays");
        renderer.show(first, KeptPatches::None);
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0, "it brings its ground");
        let bare = loader.prepare(&list, &shadows).unwrap_or_else(|error| panic!("{error}"));
        renderer.show(bare, KeptPatches::None);
        assert!(share_apart(&window.frame(&mut renderer, &camera), &before) > 0.05, "without ground");
    }
}

#[test]
fn a_window_of_finer_ground_over_a_coarse_map_shows_as_the_fine_map() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    let fine = list.ground.clone().expect("the scene has a ground map");
    let level = coarser_levels(&fine).next().expect("it has many posts");
    let mut coarse = list.clone();
    let map = ground_of(&mut coarse);
    (map.cell, map.columns, map.rows) = (fine.cell * 2.0, level.size.columns, level.size.rows);
    (map.posts, map.form_level) = (level.posts, fine.form_level.saturating_sub(1));
    let all = GroundWindow { first: [0, 0], columns: fine.columns, posts: fine.posts.clone() };
    let part = GroundWindow { first: [20, 0], columns: 30, posts: vec![fine.posts[0]; 30 * 25] };
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let wanted = window.frame(&mut renderer, &camera);
        let mut renderer = loaded(gpu, &coarse, WINDOW);
        let without = window.frame(&mut renderer, &camera);
        assert!(share_apart(&without, &wanted) > 0.02, "posts are seen on {}", gpu.name());
        let show = |renderer: &mut LiveRenderer, ground: &GroundWindow| {
            let prepared = renderer.loader().prepare_windows(&[Arc::new(ground.clone())]);
            let shown = prepared.and_then(|prepared| renderer.show_windows(prepared));
            shown.unwrap_or_else(|error| panic!("{error}"));
            window.frame(renderer, &camera)
        };
        let shown = show(&mut renderer, &all);
        let apart = share_apart(&shown, &wanted);
        assert!(apart < 1e-3, "{apart} of the pixels differ on {}", gpu.name());
        let shadows = LiveShadows::default();
        let other = renderer.loader().prepare(&coarse, &shadows).unwrap_or_else(|error| panic!("{error}"));
        renderer.show(other, KeptPatches::All);
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &shown), 0.0, "the window stays");
        let beside = share_apart(&show(&mut renderer, &part), &without);
        assert!(beside > 0.005 && beside < 0.6, "{beside} of the pixels are in the part");
        let broken = GroundWindow { columns: 7, ..part.clone() };
        assert!(renderer.loader().prepare_windows(&[Arc::new(broken)]).is_err(), "rows are not whole");
    }
}

#[test]
fn a_wireframe_darkens_lines_of_the_ground_and_goes_again() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let window = Window::new(gpu, WINDOW);
        let before = window.frame(&mut renderer, &camera);
        let lined = window.frame_with(
            &mut renderer,
            &camera,
            &LiveOptions { wireframe: true, ..LiveOptions::default() },
        );
        let darker = lined.iter().zip(&before).filter(|(a, b)| a[1].saturating_add(20) < b[1]).count();
        let lighter = lined.iter().zip(&before).filter(|(a, b)| a[1] > b[1].saturating_add(20)).count();
        assert!(darker > 20_000 && lighter < 100, "{darker} darker, {lighter} lighter on {}", gpu.name());
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0);
    }
}

#[test]
fn a_frame_that_moves_is_nearly_the_one_at_rest_and_changes_nothing() {
    let (list, camera) = (scene(), camera(SIZE.0, SIZE.1));
    for gpu in gpus() {
        let mut renderer = loaded(gpu, &list, WINDOW);
        let shadows = LiveShadows::new(&list, &camera).unwrap_or_else(|error| panic!("{error}"));
        renderer.set_shadows(&shadows).unwrap_or_else(|error| panic!("{error}"));
        let window = Window::new(gpu, WINDOW);
        let before = window.frame(&mut renderer, &camera);
        let options = LiveOptions { detail: LiveDetail::Moving, ..LiveOptions::default() };
        let at_rest = renderer.pipelines();
        let mut moving = window.frame_with(&mut renderer, &camera, &options);
        assert_eq!((renderer.pipelines(), &moving), (at_rest, &before), "no frame waits for its pipelines");
        let begun = Instant::now();
        while gpu.is_software() && moving == before && begun.elapsed() < Duration::from_secs(60) {
            moving = window.frame_with(&mut renderer, &camera, &options);
        }
        let differences = moving.iter().flatten().zip(before.iter().flatten()).map(|(a, b)| a.abs_diff(*b));
        let mean = differences.map(f64::from).sum::<f64>() / (4 * moving.len()) as f64;
        let is_same = mean == 0.0;
        assert_eq!(is_same, !gpu.is_software(), "hardware draws all: {mean} on {}", gpu.name());
        assert!(mean < 3.0, "{mean} of 255 on {}", gpu.name());
        assert_eq!(share_apart(&window.frame(&mut renderer, &camera), &before), 0.0);
    }
}

#[test]
fn frames_of_one_submission_have_their_own_cameras_and_ground() {
    let list = scene();
    for gpu in gpus() {
        let [near, far] = [camera(SIZE.0, SIZE.1), from_aside()];
        let bare = GroundChanges {
            hidden: changes(&list).triangles[..4].iter().map(|patch| patch.patch).collect(),
            ..Default::default()
        };
        let windows = [Window::new(gpu, WINDOW), Window::new(gpu, WINDOW)];
        let options = LiveOptions::default();
        let mut renderer = loaded(gpu, &list, WINDOW);
        let mut alone = vec![windows[0].frame(&mut renderer, &near)];
        renderer.update(&bare).expect("it fits");
        alone.push(windows[1].frame(&mut renderer, &far));
        assert!(alone[0] != alone[1]);
        let mut renderer = loaded(gpu, &list, WINDOW);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        windows[0].record(&mut renderer, &mut encoder, (&near, &options));
        renderer.update(&bare).expect("it fits");
        windows[1].record(&mut renderer, &mut encoder, (&far, &options));
        gpu.queue().submit([encoder.finish()]);
        for (window, alone) in windows.iter().zip(&alone) {
            assert!(window.pixels(gpu) == *alone, "on {}", gpu.name());
        }
    }
}

#[test]
fn a_window_without_pixels_and_an_empty_scene_are_no_error() {
    let camera = camera(SIZE.0, SIZE.1);
    for gpu in gpus() {
        let mut renderer = LiveRenderer::new(gpu, WINDOW).unwrap_or_else(|error| panic!("{error}"));
        let view = Window::new(gpu, WINDOW).texture.create_view(&Default::default());
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut draw = |renderer: &mut LiveRenderer, size| {
            renderer.draw(&mut encoder, &view, size, &camera, &LiveOptions::default()).expect("no error")
        };
        assert_eq!(draw(&mut renderer, SIZE).calls, 0, "nothing is loaded");
        renderer.load(&DrawList::default()).expect("an empty list is sound");
        assert_eq!(draw(&mut renderer, (0, 480)).calls, 0);
        assert_eq!(draw(&mut renderer, SIZE).triangles, 0);
        let error = renderer.load(&DrawList { ground: None, ..scene() }).expect_err("there is no ground map");
        assert!(error.to_string().contains("ground map"), "{error}");
        let piece = changes(&scene()).drapes;
        let unknown = renderer.update(&GroundChanges { drapes: piece, ..Default::default() });
        assert!(unknown.is_err(), "the empty scene has no such material");
    }
}
