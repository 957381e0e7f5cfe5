//! The GPU renderer against the formulas of the draw list's contract, on every adapter there is.
//!
//! Without one the tests say so; with `SANDTABLE_REQUIRE_GPU` set they fail instead.

use crate::adapters::gpus;
use crate::common::synthetic::{
    BOARD_HEIGHT_M, BOARD_WIDTH_M, BOX, FENCE, FENCE_COLOR, HOUSE, LAKE, LAKE_COLOR, LAKE_Y, MASKED, PANE,
    PANE_COLOR, ROAD, ROAD_COLOR, ROAD_X, camera, ground_of, height_at, material_of, scene,
    scene_with_contours,
};
use glam::{Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::lighting::{ReliefPoint, ReliefShading};
use sandtable_draw::list::{DepthLayer, DrawList, FeatureId};
use sandtable_draw::pixels::Pixels;
use sandtable_gpu::adapter::Gpu;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::picture_renderer::PictureRenderer;
use sandtable_gpu::{render, render_on};
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

/// Eight-bit steps by which a driver's rounding may differ from ours.
const TOLERANCE: i32 = 2;

fn drawn(gpu: &Gpu, list: &DrawList, camera: &Camera) -> Rendering {
    render_on(gpu, list, camera).unwrap_or_else(|error| panic!("{error}"))
}

/// What a picture shows at the pixel on which `world` falls.
struct Seen {
    color: Srgba,
    feature: FeatureId,
    depth_m: f32,
    /// The point of the surface that the pixel's center shows.
    world: Vec3,
}

fn seen(picture: &Rendering, camera: &Camera, world: Vec3) -> Seen {
    let pixel = camera.project(world).expect("before the camera").pixel.floor();
    let index = pixel.y as usize * camera.size().0 as usize + pixel.x as usize;
    let depth_m = picture.depth_m[index];
    Seen {
        color: picture.pixels.at(pixel.x as u32, pixel.y as u32),
        feature: picture.features[index],
        depth_m,
        world: camera.eye() + camera.ray_through(pixel + 0.5) * depth_m,
    }
}

fn on_ground(x: f32, y: f32) -> Vec3 {
    Vec2::new(x, y).extend(height_at(Vec2::new(x, y)))
}

/// The middle of a board that stands at `foot`, moved sideways by a share of its width.
fn on_board(foot: Vec2, share: f32) -> Vec3 {
    (foot + Vec2::X * BOARD_WIDTH_M * share).extend(height_at(foot) - 5.0 + BOARD_HEIGHT_M * 0.5)
}

fn assert_color(seen: &Seen, linear: Vec3, what: &str, gpu: &Gpu) {
    let expected = Srgba::from_linear(linear);
    let off = (0..3).map(|channel| i32::from(seen.color.0[channel]) - i32::from(expected.0[channel]));
    let worst = off.map(i32::abs).max().unwrap_or(0);
    assert!(worst <= TOLERANCE, "{what} on {}: {:?}, by the formula {:?}", gpu.name(), seen.color, expected);
}

/// The lit ground or drape at `world` before haze.
fn ground_light(list: &DrawList, world: Vec3, albedo: Option<Vec3>) -> Vec3 {
    let map = list.ground.as_ref().expect("the scene has a ground map");
    let post = map.sample(world.truncate());
    let albedo = albedo.unwrap_or_else(|| map.ramp.linear_at(post.height_m));
    let relief = ReliefShading {
        shade_gain: map.shade_gain,
        detail: map.detail,
        ..ReliefShading::new(list.lighting.to_sun)
    };
    let point = ReliefPoint {
        normal: map.shaded_normal(&post),
        form: map.shaded_normal(&post),
        sun_visibility: post.sun_visibility,
        sky_visibility: post.sky_visibility,
        elevation: map.ramp.elevation(post.height_m),
    };
    relief.shade(albedo, &point)
}

#[test]
fn ground_drapes_and_sky_show_what_the_formulas_say() {
    let (list, camera) = (scene(), camera(640, 480));
    for gpu in gpus() {
        let picture = drawn(gpu, &list, &camera);
        let road_y = 100.0;
        let lake_y = (LAKE_Y.0 + LAKE_Y.1) * 0.5;
        let road_x = (ROAD_X.0 + ROAD_X.1) * 0.5;
        let over = |light: Vec3, below: Vec3, alpha: f32| below.lerp(light, alpha);
        for (at, feature) in [
            (on_ground(420.0, 120.0), FeatureId::GROUND),
            (on_ground(580.0, 150.0), FeatureId::GROUND),
            (on_ground(250.0, 60.0), FeatureId::GROUND),
            (on_ground(road_x, road_y), ROAD),
            (on_ground(road_x, lake_y), ROAD),
            (on_ground(260.0, lake_y), LAKE),
        ] {
            let seen = seen(&picture, &camera, at);
            assert_eq!(seen.feature, feature, "at {at} on {}", gpu.name());
            let true_depth = camera.project(at).expect("before the camera").depth_m;
            assert!((seen.depth_m - true_depth).abs() < 3.0, "{} m, not {true_depth} m", seen.depth_m);
            let haze = |light: Vec3| list.lighting.add_haze(light, seen.world.distance(camera.eye()));
            let bare = haze(ground_light(&list, seen.world, None));
            let painted = |color: Srgba| haze(ground_light(&list, seen.world, Some(color.linear())));
            let expected = match feature {
                ROAD => painted(ROAD_COLOR),
                LAKE => over(painted(LAKE_COLOR), bare, LAKE_COLOR.alpha()),
                _ => bare,
            };
            assert_color(&seen, expected, &format!("{feature:?}"), gpu);
        }
        assert_sky(&picture, &list, &camera, gpu);
    }
}

fn assert_sky(picture: &Rendering, list: &DrawList, camera: &Camera, gpu: &Gpu) {
    assert_eq!(picture.features[5], FeatureId::NONE);
    assert_eq!(picture.depth_m[5], f32::INFINITY);
    let expected = list.lighting.sky_color(camera.ray_through(Vec2::new(5.5, 0.5)));
    let seen = Seen {
        color: picture.pixels.at(5, 0),
        feature: FeatureId::NONE,
        depth_m: f32::INFINITY,
        world: Vec3::ZERO,
    };
    assert_color(&seen, expected, "sky", gpu);
}

#[test]
fn a_drape_covers_its_whole_band_and_nothing_else() {
    let (list, camera) = (scene(), camera(640, 480));
    for gpu in gpus() {
        let picture = drawn(gpu, &list, &camera);
        let mut wrong = 0;
        let mut road = 0;
        for (index, (&feature, &depth_m)) in picture.features.iter().zip(&picture.depth_m).enumerate() {
            let pixel = Vec2::new((index % 640) as f32, (index / 640) as f32) + 0.5;
            let world = camera.eye() + camera.ray_through(pixel) * depth_m;
            let margin = 0.05;
            let inside = world.x > ROAD_X.0 + margin && world.x < ROAD_X.1 - margin;
            let outside = world.x < ROAD_X.0 - margin || world.x > ROAD_X.1 + margin;
            road += usize::from(feature == ROAD);
            wrong += usize::from(match feature {
                ROAD => outside,
                FeatureId::GROUND | LAKE => inside,
                _ => false,
            });
        }
        assert!(road > 3000, "{road} pixels of road");
        assert_eq!(wrong, 0, "of {road} pixels of road on {}", gpu.name());
    }
}

#[test]
fn a_textured_box_stands_before_the_ground() {
    let (list, camera) = (scene(), camera(640, 480));
    for gpu in gpus() {
        let picture = drawn(gpu, &list, &camera);
        let top = BOX.0.extend(height_at(BOX.0) - 5.0 + BOX.2);
        let seen = seen(&picture, &camera, top);
        assert_eq!(seen.feature, HOUSE);
        assert!((seen.world.z - top.z).abs() < 0.05, "{} m, not {} m", seen.world.z, top.z);
        let light = |texel: Srgba| {
            let lit = list.lighting.shade(texel.linear(), Vec3::Z);
            Srgba::from_linear(list.lighting.add_haze(lit, seen.world.distance(camera.eye())))
        };
        let (dark, bright) = (light(Srgba::opaque(190, 120, 90)), light(Srgba::opaque(210, 200, 180)));
        let blue = seen.color.0[2];
        assert!(
            blue + 2 >= dark.0[2] && blue <= bright.0[2] + 2,
            "{:?} between {dark:?} and {bright:?}",
            seen.color
        );
    }
}

#[test]
fn a_mask_leaves_holes_and_a_pane_lets_light_through() {
    let (list, camera) = (scene(), camera(640, 480));
    for gpu in gpus() {
        let picture = drawn(gpu, &list, &camera);
        let post = seen(&picture, &camera, on_board(FENCE, -0.375));
        let hole = seen(&picture, &camera, on_board(FENCE, -0.125));
        assert_eq!(post.feature, MASKED);
        assert_ne!(hole.feature, MASKED);
        assert!(hole.depth_m > post.depth_m);
        let lit = list.lighting.shade(FENCE_COLOR.linear(), Vec3::NEG_Y);
        let expected = list.lighting.add_haze(lit, post.world.distance(camera.eye()));
        assert_color(&post, expected, "fence", gpu);

        let pane = on_board(PANE, 0.1);
        let behind = seen(&picture, &camera, pane);
        assert_eq!(behind.feature, FeatureId::GROUND, "a clear pane shows what lies behind it");
        let below = list
            .lighting
            .add_haze(ground_light(&list, behind.world, None), behind.world.distance(camera.eye()));
        let lit = list.lighting.shade(PANE_COLOR.linear(), Vec3::NEG_Y);
        let own = list.lighting.add_haze(lit, pane.distance(camera.eye()));
        assert_color(&behind, below.lerp(own, PANE_COLOR.alpha()), "pane", gpu);
    }
}

#[test]
fn a_one_sided_board_has_no_back_and_a_two_sided_one_turns_its_normal() {
    let mut list = scene();
    let eye = on_board(FENCE, 0.0) + Vec3::new(0.0, 150.0, 60.0);
    let camera = Camera::new(eye, on_board(FENCE, 0.0), 0.8, (320, 240), (1.0, 5000.0)).expect("sound");
    for gpu in gpus() {
        material_of(&mut list, MASKED).two_sided = true;
        let post = seen(&drawn(gpu, &list, &camera), &camera, on_board(FENCE, -0.375));
        assert_eq!(post.feature, MASKED);
        let lit = list.lighting.shade(FENCE_COLOR.linear(), Vec3::Y);
        let expected = list.lighting.add_haze(lit, post.world.distance(camera.eye()));
        assert_color(&post, expected, "the fence's back", gpu);
        material_of(&mut list, MASKED).two_sided = false;
        let picture = drawn(gpu, &list, &camera);
        assert!(!picture.features.contains(&MASKED));
    }
}

#[test]
fn contours_darken_the_ground_along_their_heights_only() {
    let camera = camera(640, 480);
    let plain = scene();
    let lined = scene_with_contours();
    for gpu in gpus() {
        let (before, after) = (drawn(gpu, &plain, &camera), drawn(gpu, &lined, &camera));
        let (mut on_line, mut off_line, mut changed_off) = (0, 0, 0);
        for index in 0..before.features.len() {
            if before.features[index] != FeatureId::GROUND || before.depth_m[index] > 500.0 {
                continue;
            }
            let pixel = Vec2::new((index % 640) as f32, (index / 640) as f32) + 0.5;
            let world = camera.eye() + camera.ray_through(pixel) * before.depth_m[index];
            let height = plain.ground.as_ref().expect("there").sample(world.truncate()).height_m;
            let from_line = (height / 5.0 - (height / 5.0).round()).abs() * 5.0;
            let changed = before.pixels.data()[index] != after.pixels.data()[index];
            on_line += usize::from(changed && from_line < 0.4);
            off_line += usize::from(from_line > 2.0);
            changed_off += usize::from(changed && from_line > 2.0);
        }
        assert!(on_line > 1000, "{on_line} pixels of line on {}", gpu.name());
        assert!(changed_off * 100 < off_line, "{changed_off} of {off_line} pixels changed off the lines");
    }
}

#[test]
fn drawing_twice_gives_the_same_bytes() {
    let (list, camera) = (scene(), camera(320, 240));
    for gpu in gpus() {
        let (first, second) = (drawn(gpu, &list, &camera), drawn(gpu, &list, &camera));
        assert_eq!(first.pixels, second.pixels);
        assert_eq!(first.features, second.features);
    }
}

#[test]
fn an_empty_list_is_sky_and_solids_need_no_ground_map() {
    let camera = camera(65, 33);
    for gpu in gpus() {
        let picture = drawn(gpu, &DrawList::default(), &camera);
        assert!(picture.features.iter().all(|&feature| feature == FeatureId::NONE));
        let mut list = scene();
        list.items.retain(|item| item.layer == DepthLayer::Solid);
        list.ground = None;
        let picture = drawn(gpu, &list, &camera);
        assert!(picture.features.contains(&HOUSE));
    }
}

#[test]
fn what_does_not_fit_is_refused_in_a_sentence() {
    let list = scene();
    let wide = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (16384, 1), (1.0, 10.0)).expect("sound");
    for gpu in gpus() {
        assert_eq!(drawn(gpu, &DrawList::default(), &wide).pixels.width(), 16384, "in tiles if need be");
        let mut unsound = list.clone();
        unsound.items.reverse();
        assert!(unsound.items[0].layer > DepthLayer::Ground);
        let error = render_on(gpu, &unsound, &camera(32, 32)).expect_err("layers fall");
        assert!(matches!(error, GpuError::List(_)), "{error}");
        let mut groundless = list.clone();
        groundless.ground = None;
        let error = render_on(gpu, &groundless, &camera(32, 32)).expect_err("no ground map");
        assert!(error.to_string().contains("item 0"), "{error}");
        let mut holed = list.clone();
        ground_of(&mut holed).posts.pop();
        let error = render_on(gpu, &holed, &camera(32, 32)).expect_err("a post is missing");
        assert!(error.to_string().contains("65×65"), "{error}");
    }
}

#[test]
fn hostile_numbers_leave_the_rest_of_the_picture_alone() {
    let (mut list, camera) = (scene(), camera(160, 120));
    let mut broken = list.meshes[3].clone();
    broken.vertices[0].position = [f32::NAN; 3];
    broken.vertices[1].position = [f32::INFINITY, 0.0, 3e38];
    broken.vertices[2].normal = [0.0; 3];
    broken.vertices[3].uv = [f32::NAN, 1e30];
    let mesh = list.add_mesh(broken);
    let mut item = list.items[3].clone();
    item.mesh = mesh;
    list.items.push(item);
    let empty = list.add_texture(Pixels::filled(0, 7, Srgba::WHITE));
    material_of(&mut list, MASKED).texture = Some(empty);
    for gpu in gpus() {
        let picture = drawn(gpu, &list, &camera);
        assert!(picture.features.contains(&ROAD) && picture.features.contains(&FeatureId::GROUND));
        assert!(picture.features.contains(&MASKED), "a texture without texels is white");
    }
}

#[test]
fn a_renderer_that_stays_draws_each_picture_as_a_new_one_does() {
    let (mut other, small) = (scene_with_contours(), camera(160, 120));
    other.lighting.sun *= 0.5;
    let lists = [scene(), other];
    for gpu in gpus() {
        let mut renderer = PictureRenderer::new(gpu).unwrap_or_else(|error| panic!("{error}"));
        for (list, camera) in [(0, small), (0, camera(96, 200)), (1, small), (1, small), (0, small)] {
            let kept = renderer.render(&lists[list], &camera, &|_| ());
            let kept = kept.unwrap_or_else(|error| panic!("{error}"));
            let fresh = drawn(gpu, &lists[list], &camera);
            assert!(kept.pixels == fresh.pixels && kept.features == fresh.features);
            assert!(kept.depth_m == fresh.depth_m);
        }
    }
}

#[test]
fn a_picture_in_tiles_is_the_one_drawn_at_once() {
    let (list, camera) = (scene_with_contours(), camera(301, 200));
    for gpu in gpus() {
        let whole = drawn(gpu, &list, &camera);
        let mut renderer = PictureRenderer::new(gpu).unwrap_or_else(|error| panic!("{error}"));
        for longest_px in [256, 128, 67] {
            renderer.limit_tiles(longest_px);
            let tiled = renderer.render(&list, &camera, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((tiled.pixels.width(), tiled.pixels.height()), camera.size());
            let features = tiled.features.iter().zip(&whole.features).filter(|(one, other)| one != other);
            let of_all = 1.0 / whole.features.len() as f64;
            let apart = features.count() as f64 * of_all;
            assert!(apart < 0.002, "{apart} of the features at {longest_px} on {}", gpu.name());
            let near = |&(one, other): &(&Srgba, &Srgba)| {
                one.0.iter().zip(other.0).all(|(one, other)| one.abs_diff(other) <= TOLERANCE as u8)
            };
            let colors = tiled.pixels.data().iter().zip(whole.pixels.data());
            let apart = colors.filter(|pair| !near(pair)).count() as f64 * of_all;
            assert!(apart < 0.01, "{apart} of the colors at {longest_px} on {}", gpu.name());
        }
    }
}

#[test]
fn without_an_adapter_the_error_names_the_way_out() {
    let error = Gpu::open(&[]).expect_err("nothing was tried");
    let text = error.to_string();
    assert!(text.contains("no GPU adapter") && text.contains("--backend cpu"), "{text}");
    match render(&scene(), &camera(64, 48), &|_| ()) {
        Ok(picture) => assert_eq!(picture.depth_m.len(), 64 * 48),
        Err(error) => assert!(error.to_string().contains("--backend cpu"), "{error}"),
    }
}
