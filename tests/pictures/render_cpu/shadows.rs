//! Shadows of solids: they begin at the foot, their edges are soft, what is lit is evenly lit.

use glam::{Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::lighting::ReliefShading;
use sandtable_draw::list::{DepthLayer, DrawList, FeatureId};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_draw::pixels::Pixels;
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

use crate::render_cpu::landscape::{BOX, ground_map, ground_material, ground_mesh, item};
use crate::render_cpu::{feature, looking, quad, shot};

const ROOF: FeatureId = FeatureId(20);
const SIZE: (u32, u32) = (480, 360);
/// Half the side of the box, its height and its turn.
const HALF_M: f32 = 10.0;
const HEIGHT_M: f32 = 12.0;
const TURN_RAD: f32 = 0.3;

fn toward_sun(azimuth_deg: f32, altitude_deg: f32) -> Vec3 {
    let (azimuth, altitude) = (azimuth_deg.to_radians(), altitude_deg.to_radians());
    let level = libm::cosf(altitude);
    Vec3::new(level * libm::sinf(azimuth), level * libm::cosf(azimuth), libm::sinf(altitude))
}

/// The outward normal of a side of the box.
fn outward(side: usize) -> Vec2 {
    let turn = TURN_RAD + side as f32 * std::f32::consts::FRAC_PI_2;
    Vec2::new(libm::cosf(turn), libm::sinf(turn))
}

/// A plain of 400 m with `height`, under a sun.
fn plain(to_sun: Vec3, height: fn(f32, f32) -> f32) -> DrawList {
    let mut list = DrawList::default();
    list.lighting.to_sun = to_sun;
    let mut map = ground_map(101, 200.0, false, height);
    map.ramp =
        sandtable_draw::ground::ColorRamp::new(vec![(0.0, Srgba::opaque(180, 170, 150))]).expect("one stop");
    list.ground = Some(map.into());
    item(&mut list, ground_mesh(40, 200.0, height), ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    list
}

/// Adds a box whose walls are [`BOX`] and whose roof is [`ROOF`], founded 3 m under the plain.
fn add_box(list: &mut DrawList, center: Vec2) {
    for side in 0..4 {
        let (out, along) = (outward(side), outward(side).perp());
        let foot = |turn: f32, z: f32| (center + (out + along * turn) * HALF_M).extend(z);
        let corners = [foot(-1.0, -3.0), foot(1.0, -3.0), foot(1.0, HEIGHT_M), foot(-1.0, HEIGHT_M)];
        item(list, quad(corners, Srgba::WHITE), Material::default(), DepthLayer::Solid, BOX);
    }
    let corner = |side: usize| (center + (outward(side) + outward(side).perp()) * HALF_M).extend(HEIGHT_M);
    let roof = quad([0, 1, 2, 3].map(corner), Srgba::WHITE);
    item(list, roof, Material::default(), DepthLayer::Solid, ROOF);
}

fn gray(picture: &Rendering, x: u32, y: u32) -> f32 {
    picture.pixels.at(x, y).linear().element_sum() / 3.0
}

/// The light of the ground at a place; `None` where something hides it.
fn ground_at(picture: &Rendering, camera: &Camera, at: Vec2) -> Option<f32> {
    let seen = camera.project(at.extend(0.0)).expect("before the eye").pixel;
    let (x, y) = (seen.x as u32, seen.y as u32);
    let around = [(0, 0), (1, 0), (0, 1)].map(|(right, down)| feature(picture, x + right, y + down));
    (around == [FeatureId::GROUND; 3]).then(|| gray(picture, x, y))
}

/// From above, a little aside, so that the ground at a foot is seen.
fn above(side: Vec2) -> Camera {
    looking((side * 60.0).extend(130.0), Vec3::ZERO, SIZE)
}

#[test]
fn a_shadow_begins_at_the_foot_and_the_side_toward_the_sun_is_lit() {
    for (azimuth, altitude) in [(315.0, 45.0), (315.0, 25.0), (200.0, 65.0), (100.0, 35.0), (20.0, 15.0)] {
        let to_sun = toward_sun(azimuth, altitude);
        let mut list = plain(to_sun, |_, _| 0.0);
        add_box(&mut list, Vec2::ZERO);
        // Ground at the lower end of the ramp without the sun, by the formula of the shading.
        let lost = ReliefShading::LOW_CONTRAST * ReliefShading::SHARES[0] * to_sun.z;
        let shaded = ReliefShading::soft(1.0 - ReliefShading::GAIN * lost);
        let (mut behind, mut before) = (0, 0);
        for side in 0..4 {
            let camera = above(outward(side));
            let picture = shot(&list, &camera);
            let open = ground_at(&picture, &camera, -to_sun.truncate().perp() * 45.0).expect("bare");
            let facing = outward(side).dot(to_sun.truncate().normalize());
            let length_m = HEIGHT_M * to_sun.truncate().length() / to_sun.z * -facing;
            // Farther away the sun shines past the wall's end.
            let past_m = HALF_M * -facing / (1.0 - facing * facing).sqrt();
            for step in 0..40 {
                let away_m = 0.1 + step as f32 * 0.2;
                let at = outward(side) * (HALF_M + away_m);
                let Some(light) = ground_at(&picture, &camera, at) else { continue };
                let what = format!("sun {azimuth}° {altitude}°, side {side}, {away_m} m away");
                if facing < -0.3 && away_m < 0.8 * length_m.min(past_m) {
                    assert!(light < (shaded + 0.03) * open, "{what}: {light} of {open}");
                    behind += 1;
                } else if facing > 0.3 && away_m > 4.0 {
                    assert!((light - open).abs() < 0.01 * open, "{what}: {light} of {open}");
                    before += 1;
                }
            }
        }
        assert!(behind > 10 && before > 10, "{behind} and {before} places at {azimuth}° {altitude}°");
    }
}

/// Whether the pixels around one show the same feature.
fn is_inside(picture: &Rendering, x: u32, y: u32) -> bool {
    let own = feature(picture, x, y);
    (0..25).all(|index| feature(picture, x + index % 5 - 2, y + index / 5 - 2) == own)
}

#[test]
fn lit_roofs_and_walls_have_one_shade() {
    for (azimuth, altitude) in [(315.0, 45.0), (200.0, 65.0), (100.0, 35.0), (20.0, 15.0), (63.0, 8.0)] {
        let to_sun = toward_sun(azimuth, altitude);
        for side in 0..4 {
            // One side is looked at, from near enough that no other wall is in view.
            let eye = (outward(side) * 50.0).extend(30.0);
            let mut list = plain(to_sun, |_, _| 0.0);
            add_box(&mut list, Vec2::ZERO);
            let camera = looking(eye, Vec3::new(0.0, 0.0, 6.0), SIZE);
            let picture = shot(&list, &camera);
            for part in [ROOF, BOX] {
                let mut range = [f32::MAX, 0.0];
                for (x, y) in (2..SIZE.0 - 2).flat_map(|x| (2..SIZE.1 - 2).map(move |y| (x, y))) {
                    let depth_m = picture.depth_m[(y * SIZE.0 + x) as usize];
                    let at = eye + camera.ray_through(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)) * depth_m;
                    // The foot is darker by contact.
                    if feature(&picture, x, y) == part && at.z > 4.0 && is_inside(&picture, x, y) {
                        let light = gray(&picture, x, y);
                        range = [range[0].min(light), range[1].max(light)];
                    }
                }
                let what = format!("sun {azimuth}° {altitude}°, side {side}, feature {}", part.0);
                assert!(range[0] > 0.0 && range[1] < f32::MAX, "{what} is seen");
                assert!(range[1] - range[0] < 0.012, "{what}: {range:?}");
            }
        }
    }
}

#[test]
fn the_edge_of_a_shadow_is_soft_and_broader_far_from_what_casts_it() {
    let to_sun = toward_sun(270.0, 30.0);
    let mut list = plain(to_sun, |_, _| 0.0);
    add_box(&mut list, Vec2::ZERO);
    // A mast whose shadow's end is far from its top.
    let corner = |y: f32, z: f32| Vec3::new(0.0, y + 60.0, z);
    let mast =
        quad([corner(-4.0, 0.0), corner(4.0, 0.0), corner(4.0, 60.0), corner(-4.0, 60.0)], Srgba::WHITE);
    item(&mut list, mast, Material { two_sided: true, ..Material::default() }, DepthLayer::Solid, BOX);
    let camera = looking(Vec3::new(60.0, 30.0, 160.0), Vec3::new(60.0, 30.1, 0.0), (640, 480));
    let picture = shot(&list, &camera);
    let steps = |y: f32, from: f32, to: f32| {
        let mut grays: Vec<u32> = Vec::new();
        let lights = (0..((to - from) * 10.0) as u32)
            .filter_map(|step| ground_at(&picture, &camera, Vec2::new(from + step as f32 * 0.1, y)));
        let lights: Vec<f32> = lights.collect();
        let (dark, open) = (lights[0], lights[lights.len() - 1]);
        assert!(dark < 0.75 * open, "{dark} of {open}");
        for light in lights.into_iter().filter(|light| (1.05 * dark..0.95 * open).contains(light)) {
            grays.push((light * 255.0) as u32);
        }
        grays.dedup();
        grays.len()
    };
    let near = steps(0.0, 24.0, 40.0);
    let far = steps(60.0, 90.0, 120.0);
    assert!(near >= 2, "{near} steps of gray at the box");
    assert!(far > near, "{far} steps of gray at the end of the mast's shadow, {near} at the box");
}

#[test]
fn a_hill_casts_on_what_stands_behind_it() {
    let ridge = |x: f32, _: f32| (40.0 - (x + 60.0).abs() * 2.0).max(0.0);
    let roof = |height: fn(f32, f32) -> f32, azimuth: f32| {
        let mut list = plain(toward_sun(azimuth, 20.0), height);
        add_box(&mut list, Vec2::ZERO);
        let camera = looking(Vec3::new(0.0, -80.0, 80.0), Vec3::new(0.0, 0.0, HEIGHT_M), SIZE);
        let picture = shot(&list, &camera);
        assert_eq!(feature(&picture, SIZE.0 / 2, SIZE.1 / 2), ROOF);
        gray(&picture, SIZE.0 / 2, SIZE.1 / 2)
    };
    let open = roof(|_, _| 0.0, 270.0);
    assert!(roof(ridge, 270.0) < 0.7 * open, "the ridge is between");
    assert!((roof(ridge, 90.0) - open).abs() < 0.01 * open, "the ridge is behind");
}

#[test]
fn holes_of_a_mask_and_panes_let_the_sun_through() {
    let shadow = |alpha: u8, mode: AlphaMode| {
        let to_sun = toward_sun(180.0, 45.0);
        let mut list = plain(to_sun, |_, _| 0.0);
        let texture = list.add_texture(Pixels::filled(4, 4, Srgba([255, 255, 255, alpha])));
        let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let board = quad(
            [corner(-20.0, 0.0), corner(20.0, 0.0), corner(20.0, 20.0), corner(-20.0, 20.0)],
            Srgba::WHITE,
        );
        let material =
            Material { texture: Some(texture), alpha: mode, two_sided: true, ..Material::default() };
        item(&mut list, board, material, DepthLayer::Solid, BOX);
        let camera = looking(Vec3::new(0.0, 60.0, 90.0), Vec3::new(0.0, 10.0, 0.0), SIZE);
        let picture = shot(&list, &camera);
        ground_at(&picture, &camera, Vec2::new(0.0, 10.0)).expect("bare")
            / ground_at(&picture, &camera, Vec2::new(40.0, 10.0)).expect("bare")
    };
    assert!(shadow(255, AlphaMode::Opaque) < 0.75);
    assert!(shadow(255, AlphaMode::Mask(0.5)) < 0.75);
    assert!(shadow(0, AlphaMode::Mask(0.5)) > 0.99);
    assert!(shadow(120, AlphaMode::Blend) > 0.99);
}

#[test]
fn the_ground_is_darker_in_the_corner_of_a_wall_than_in_the_open_without_sun() {
    let mut list = plain(toward_sun(315.0, 45.0), |_, _| 0.0);
    list.lighting.to_sun = Vec3::new(0.0, 0.6, -0.8);
    add_box(&mut list, Vec2::ZERO);
    let camera = above(outward(0));
    let picture = shot(&list, &camera);
    let light = |away_m: f32| ground_at(&picture, &camera, outward(0) * (HALF_M + away_m)).expect("bare");
    assert!(light(0.7) < 0.95 * light(30.0), "{} of {}", light(0.7), light(30.0));
    assert!(light(0.7) > 0.6 * light(30.0), "subtle: {} of {}", light(0.7), light(30.0));
}

#[test]
fn shadows_are_the_same_bytes_for_every_number_of_threads() {
    let mut list = plain(toward_sun(315.0, 30.0), |x, y| 3.0 * libm::sinf(x / 30.0) * libm::cosf(y / 20.0));
    for index in 0..30u8 {
        let place = f32::from(index);
        add_box(&mut list, Vec2::new(libm::sinf(place * 2.4), libm::cosf(place * 2.4)) * place * 6.0);
    }
    let camera = looking(Vec3::new(100.0, -190.0, 70.0), Vec3::ZERO, SIZE);
    let [one, four] = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| shot(&list, &camera))
    });
    assert!(one.pixels == four.pixels);
}
