//! What surfaces look like: textures in perspective, contours, haze, borders, depths.

use glam::{Vec2, Vec3};
use sandtable_draw::color::{Srgba, linear_from_srgb};
use sandtable_draw::ground::Contours;
use sandtable_draw::list::{DepthLayer, DrawList, FeatureId};
use sandtable_draw::material::{Material, TextureWrap};
use sandtable_draw::pixels::Pixels;
use sandtable_view::camera::Camera;

use crate::render_cpu::landscape::{BOX, ground_map, ground_material, ground_mesh, item};
use crate::render_cpu::{count, depth, feature, looking, northward, plain_light, quad, shot, wall};

/// A floor 40 m wide and 80 m deep, 2 m below an eye that looks north.
fn floor() -> sandtable_draw::list::DrawMesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, -2.0);
    quad([corner(-20.0, 0.0), corner(20.0, 0.0), corner(20.0, 80.0), corner(-20.0, 80.0)], Srgba::WHITE)
}

/// Where the ray of a pixel's center meets the floor.
fn on_floor(camera: &Camera, x: u32, y: u32) -> Option<Vec3> {
    let ray = camera.ray_through(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
    let reach = -2.0 / ray.z;
    (ray.z < 0.0).then(|| camera.eye() + ray * reach)
}

#[test]
fn texture_coordinates_are_correct_in_perspective() {
    let mut list = DrawList::default();
    plain_light(&mut list);
    let ramp = Pixels::from_fn(256, 256, |x, y| Srgba::opaque(x as u8, y as u8, 128));
    let texture = Some(list.add_texture(ramp));
    item(&mut list, floor(), Material { texture, ..Material::default() }, DepthLayer::Solid, BOX);
    let camera = northward((200, 150));
    let picture = shot(&list, &camera);
    let mut checked = 0;
    for (x, y) in (0..200).step_by(9).flat_map(|x| (80..150).step_by(7).map(move |y| (x, y))) {
        let Some(world) = on_floor(&camera, x, y).filter(|p| p.x.abs() < 18.0 && p.y < 60.0) else {
            continue;
        };
        let uv = Vec2::new(world.x / 40.0 + 0.5, 1.0 - world.y / 80.0);
        let Srgba([red, green, ..]) = picture.pixels.at(x, y);
        let expected = uv * 256.0 - 0.5;
        assert!((f32::from(red) - expected.x).abs() < 3.0, "({x}, {y}): {red} for {}", expected.x);
        assert!((f32::from(green) - expected.y).abs() < 3.0, "({x}, {y}): {green} for {}", expected.y);
        checked += 1;
    }
    assert!(checked > 100);
}

#[test]
fn each_axis_of_a_texture_goes_on_beyond_its_border_in_its_own_way() {
    use TextureWrap::{Clamp, Mirror, Repeat};
    // Where a wall reads a texture of 64 steps from black to full: to the left of it, on it, to the right and farther.
    let places = [-0.25f32, 0.25, 0.75, 1.25, 1.75, 2.25];
    for (wrap, expected) in [
        (Repeat, [0.75f32, 0.25, 0.75, 0.25, 0.75, 0.25]),
        (Mirror, [0.25, 0.25, 0.75, 0.75, 0.25, 0.25]),
        (Clamp, [0.0, 0.25, 0.75, 1.0, 1.0, 1.0]),
    ] {
        for axis in [0, 1] {
            let mut list = DrawList::default();
            plain_light(&mut list);
            let ramp = Pixels::from_fn(64, 64, |x, y| Srgba::opaque([x, y][axis] as u8 * 4, 0, 0));
            let mut texture_wrap = [Repeat; 2];
            texture_wrap[axis] = wrap;
            let material =
                Material { texture: Some(list.add_texture(ramp)), texture_wrap, ..Material::default() };
            // Coordinates from -0.5 to 2.5 over the wall.
            let mut mesh = wall(10.0, [-3.0, 3.0], [-3.0, 3.0], Srgba::WHITE);
            mesh.vertices.iter_mut().for_each(|vertex| vertex.uv = vertex.uv.map(|at| at * 3.0 - 0.5));
            item(&mut list, mesh, material, DepthLayer::Solid, BOX);
            let camera = northward((300, 300));
            let picture = shot(&list, &camera);
            for (place, share) in places.into_iter().zip(expected) {
                let across = (place + 0.5) * 2.0 - 3.0;
                // V runs downward.
                let world =
                    if axis == 0 { Vec3::new(across, 10.0, 0.9) } else { Vec3::new(0.9, 10.0, -across) };
                let seen = (0..300 * 300).map(|at| (at % 300, at / 300)).min_by(|&a, &b| {
                    let off = |(x, y): (u32, u32)| {
                        let ray = camera.ray_through(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
                        (ray * (10.0 / ray.y)).distance_squared(world)
                    };
                    off(a).total_cmp(&off(b))
                });
                let (x, y) = seen.expect("pixels");
                let red = f32::from(picture.pixels.at(x, y).0[0]) / 252.0;
                assert!(
                    (red - share).abs() < 0.04,
                    "{wrap:?} along axis {axis} at {place}: {red} for {share}"
                );
            }
        }
    }
}

#[test]
fn a_floor_that_runs_beneath_and_behind_the_eye_is_whole() {
    let mut list = DrawList::default();
    let corner = |x: f32, y: f32| Vec3::new(x, y, -2.0);
    let side = 40_000.0;
    let mesh = quad(
        [corner(-side, -side), corner(side, -side), corner(side, side), corner(-side, side)],
        Srgba::WHITE,
    );
    item(&mut list, mesh, Material::default(), DepthLayer::Solid, BOX);
    let camera = looking(Vec3::ZERO, Vec3::new(0.3, 1.0, -0.2), (200, 150));
    let picture = shot(&list, &camera);
    for (x, y) in (0..200).flat_map(|x| (0..150).map(move |y| (x, y))) {
        let Some(world) = on_floor(&camera, x, y) else { continue };
        let expected = world.dot(camera.forward());
        if expected > 1_000.0 || world.truncate().abs().max_element() > 0.9 * side {
            continue;
        }
        assert_eq!(feature(&picture, x, y), BOX, "({x}, {y})");
        assert!((depth(&picture, x, y) / expected - 1.0).abs() < 1e-4, "({x}, {y}) at {expected} m");
    }
}

#[test]
fn the_far_plane_and_the_near_plane_cut() {
    for (y, seen) in [(0.4, FeatureId::NONE), (0.6, BOX), (99.0, BOX), (101.0, FeatureId::NONE)] {
        let mut list = DrawList::default();
        item(
            &mut list,
            wall(y, [-500.0, 500.0], [-500.0, 500.0], Srgba::WHITE),
            Material::default(),
            DepthLayer::Solid,
            BOX,
        );
        let camera = Camera::new(Vec3::ZERO, Vec3::Y, 0.8, (40, 30), (0.5, 100.0)).expect("sound");
        let picture = shot(&list, &camera);
        assert_eq!(count(&picture, seen), 40 * 30, "at {y} m");
    }
}

#[test]
fn a_border_pixel_shows_the_share_that_is_covered() {
    let mut list = DrawList::default();
    plain_light(&mut list);
    list.lighting.haze.color = Vec3::ZERO;
    list.lighting.zenith = Vec3::ZERO;
    // 100 px a meter at 10 m: the wall's right border lies at pixel 50 + 3/8 in every row.
    let tan = 50.0 / 100.0 / 10.0;
    let camera =
        Camera::new(Vec3::ZERO, Vec3::Y, 2.0 * libm::atanf(tan), (100, 100), (1.0, 100.0)).expect("sound");
    item(
        &mut list,
        wall(10.0, [-9.0, 0.003_75], [-9.0, 9.0], Srgba::WHITE),
        Material::default(),
        DepthLayer::Solid,
        BOX,
    );
    let picture = shot(&list, &camera);
    let share = |x: u32| linear_from_srgb(picture.pixels.at(x, 50).0[0]);
    assert_eq!((share(49), share(51)), (1.0, 0.0));
    assert!((share(50) - 0.375).abs() < 0.01, "{}", share(50));
}

#[test]
fn haze_thickens_with_the_true_distance() {
    let mut list = DrawList::default();
    plain_light(&mut list);
    list.lighting.haze.distance_m = 15.0;
    item(
        &mut list,
        wall(10.0, [-9.0, 9.0], [-9.0, 9.0], Srgba::opaque(200, 40, 40)),
        Material::default(),
        DepthLayer::Solid,
        BOX,
    );
    let camera = northward((120, 90));
    let picture = shot(&list, &camera);
    for (x, y) in [(60, 45), (0, 0), (119, 40)] {
        let ray = camera.ray_through(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        let albedo = Srgba::opaque(200, 40, 40).linear();
        let expected = Srgba::from_linear(list.lighting.add_haze(albedo, ray.length() * 10.0));
        let seen = picture.pixels.at(x, y);
        assert!(seen.0.iter().zip(expected.0).all(|(a, b)| a.abs_diff(b) <= 1), "{seen:?}, {expected:?}");
    }
}

#[test]
fn contours_keep_their_width_from_near_to_far() {
    let slope = |_: f32, y: f32| 0.25 * y;
    let mut list =
        DrawList { ground: Some(ground_map(101, 500.0, false, slope).into()), ..DrawList::default() };
    plain_light(&mut list);
    let map = std::sync::Arc::make_mut(list.ground.as_mut().expect("just put there"));
    map.ramp = sandtable_draw::ground::ColorRamp::new(vec![(0.0, Srgba::WHITE)]).expect("one stop");
    map.contours = Some(Contours {
        interval_m: 10.0,
        major_every: 1_000_000,
        color: Srgba::opaque(0, 0, 0),
        width_px: 1.5,
        lit: None,
    });
    item(&mut list, ground_mesh(20, 500.0, slope), ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    let camera = looking(Vec3::new(0.0, -420.0, -80.0), Vec3::new(0.0, 0.0, 20.0), (64, 900));
    let picture = shot(&list, &camera);
    // Down one column, the dark of each line adds up to its width; the slope is shaded alike everywhere.
    let ground = (0..900).filter(|&y| feature(&picture, 32, y) == FeatureId::GROUND);
    let light = |y: u32| linear_from_srgb(picture.pixels.at(32, y).0[0]);
    let bare = ground.map(light).fold(0.0, f32::max);
    let dark = |y: u32| 1.0 - light(y) / bare;
    let mut widths = Vec::new();
    let mut sum = 0.0;
    for y in (0..900).filter(|&y| feature(&picture, 32, y) == FeatureId::GROUND) {
        sum += dark(y);
        if dark(y) == 0.0 && sum > 0.0 {
            widths.push(std::mem::take(&mut sum));
        }
    }
    assert!(widths.len() > 8, "{widths:?}");
    // The farthest lines are close together and fade on purpose; the border may cut the first and the last.
    let clear = &widths[widths.len() / 2..widths.len() - 1];
    assert!(clear.iter().all(|width| (width - 1.5).abs() < 0.2), "{widths:?}");
}

#[test]
fn a_lake_at_the_height_of_a_line_is_not_all_line() {
    let flat = |_: f32, _: f32| 20.0;
    let mut list = DrawList { ground: Some(ground_map(11, 100.0, true, flat).into()), ..DrawList::default() };
    plain_light(&mut list);
    item(&mut list, ground_mesh(4, 100.0, flat), ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    let picture = shot(&list, &looking(Vec3::new(0.0, -50.0, 60.0), Vec3::new(0.0, 0.0, 20.0), (60, 40)));
    let ramp = list.ground.as_ref().expect("there").ramp.linear_at(20.0);
    assert_eq!(picture.pixels.at(30, 20), Srgba::from_linear(ramp));
}

#[test]
fn depths_and_features_are_those_at_the_pixel_s_center() {
    let mut list = DrawList::default();
    let tilted = quad(
        [
            Vec3::new(-3.0, 8.0, -3.0),
            Vec3::new(3.0, 8.0, -3.0),
            Vec3::new(3.0, 14.0, 3.0),
            Vec3::new(-3.0, 14.0, 3.0),
        ],
        Srgba::WHITE,
    );
    item(&mut list, tilted, Material::default(), DepthLayer::Solid, FeatureId(77));
    let camera = northward((90, 70));
    let picture = shot(&list, &camera);
    for (x, y) in [(45, 35), (30, 30), (50, 44)] {
        // The plane is y = z + 11.
        let ray = camera.ray_through(Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
        assert_eq!(feature(&picture, x, y), FeatureId(77));
        assert!((depth(&picture, x, y) - 11.0 / (ray.y - ray.z)).abs() < 1e-4);
    }
    assert_eq!(depth(&picture, 1, 1), f32::INFINITY);
}
