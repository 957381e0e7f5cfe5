//! What hides what: drapes, ridges, solids, holes, transparency.

use glam::{DVec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, FeatureId};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_draw::pixels::Pixels;
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

use crate::render_cpu::landscape::{
    BOX, FOREST, ROAD, box_mesh, draped_material, draped_strip, ground_map, ground_material, ground_mesh,
    item,
};
use crate::render_cpu::{count, depth, feature, looking, northward, plain_light, shot, wall};

const RED: Srgba = Srgba::opaque(255, 0, 0);
const GREEN: Srgba = Srgba::opaque(0, 255, 0);
const BLUE: Srgba = Srgba::opaque(0, 0, 255);

/// Ground of `height`, and strips beside each other at an angle that cover its inner part.
fn draped_all_over(half_m: f32, height: impl Fn(f32, f32) -> f32) -> DrawList {
    let ground = ground_mesh(40, half_m, &height);
    let mut list =
        DrawList { ground: Some(ground_map(81, half_m, false, height).into()), ..DrawList::default() };
    let half = f64::from(half_m);
    let along = DVec2::new(0.8, 0.6);
    let width = half / 10.0;
    let strips: Vec<_> = (-8..8)
        .map(|strip| {
            let middle = along.perp() * (f64::from(strip) + 0.5) * width;
            draped_strip(&ground, &[middle - along * half, middle + along * half], width / 2.0)
        })
        .collect();
    item(&mut list, ground, ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    for strip in strips {
        item(&mut list, strip, draped_material(RED), DepthLayer::Draped(1), ROAD);
    }
    list
}

/// The pixels that show ground well inside the area that [`draped_all_over`] covers.
fn bare_pixels(picture: &Rendering, camera: &Camera, middle: Vec3, half_m: f32) -> usize {
    let (width, height) = camera.size();
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    pixels
        .filter(|&(x, y)| feature(picture, x, y) == FeatureId::GROUND)
        .filter(|&(x, y)| {
            let ray = camera.ray_through(glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5));
            let world = camera.eye() + ray * depth(picture, x, y);
            (world - middle).truncate().length() < 0.7 * half_m
        })
        .count()
}

#[test]
fn a_drape_wins_over_its_slope_from_every_side_and_distance() {
    let hills = |x: f32, y: f32| 40.0 * libm::sinf(x / 130.0) * libm::cosf(y / 170.0) + 0.1 * x;
    let list = draped_all_over(500.0, hills);
    let on = |x: f32, y: f32, rise: f32| Vec3::new(x, y, hills(x, y) + rise);
    for (eye, target) in [
        (on(0.0, 0.0, 1.7), on(30.0, 300.0, 0.0)),
        (on(-200.0, 100.0, 0.6), on(200.0, 110.0, 0.0)),
        (on(100.0, -340.0, 3.0), on(0.0, 0.0, 0.0)),
        (Vec3::new(0.0, -900.0, 60.0), Vec3::ZERO),
        (Vec3::new(700.0, 700.0, 900.0), Vec3::ZERO),
        (Vec3::new(0.0, 0.0, 3_000.0), Vec3::ZERO),
    ] {
        let camera = looking(eye, target, (320, 200));
        let picture = shot(&list, &camera);
        assert!(count(&picture, ROAD) > 3_000, "hardly anything is in view from {eye}");
        assert_eq!(bare_pixels(&picture, &camera, Vec3::ZERO, 500.0), 0, "from {eye}");
    }
}

#[test]
fn a_drape_wins_over_its_slope_ten_kilometers_away() {
    let hills = |x: f32, y: f32| 300.0 * libm::sinf(x / 1900.0) * libm::cosf(y / 1300.0);
    let list = draped_all_over(4_000.0, hills);
    for eye in [Vec3::new(0.0, -10_000.0, 600.0), Vec3::new(9_000.0, 5_000.0, 2_500.0)] {
        let camera = Camera::new(eye, Vec3::ZERO, 0.3, (320, 200), (1.0, 60_000.0)).expect("sound");
        let picture = shot(&list, &camera);
        assert!(count(&picture, ROAD) > 3_000, "hardly anything is in view from {eye}");
        assert_eq!(bare_pixels(&picture, &camera, Vec3::ZERO, 4_000.0), 0, "from {eye}");
    }
}

#[test]
fn a_drape_wins_close_up_where_coordinates_are_coarse() {
    // 20 km from the origin, f32 coordinates are 2 mm apart, far more than the tolerance at arm's length.
    let hills = |x: f32, y: f32| 8.0 * libm::sinf(x / 23.0) * libm::cosf(y / 31.0);
    let mut list = draped_all_over(100.0, hills);
    let there = Vec3::new(19_000.3, -21_000.7, 1_234.5);
    for vertex in list.meshes.iter_mut().flat_map(|mesh| &mut mesh.vertices) {
        vertex.position = (Vec3::from(vertex.position) + there).into();
    }
    for (x, y) in [(0.0, 0.0), (30.0, -20.0), (-11.0, 17.0)] {
        let eye = there + Vec3::new(x, y, hills(x, y) + 1.5);
        let camera = looking(eye, there + Vec3::new(x + 5.0, y + 30.0, hills(x, y)), (320, 200));
        let picture = shot(&list, &camera);
        assert!(count(&picture, ROAD) > 3_000);
        assert_eq!(bare_pixels(&picture, &camera, there, 100.0), 0, "at {x}, {y}");
    }
}

#[test]
fn a_drape_does_not_shine_through_a_ridge() {
    // A ridge 30 m wide and 40 m high along the X axis, a road at its far foot.
    let ridge = |_: f32, y: f32| (40.0 - 40.0 * (y / 15.0).abs()).max(0.0);
    let ground = ground_mesh(80, 600.0, ridge);
    let line = [DVec2::new(-500.0, 20.0), DVec2::new(500.0, 20.0)];
    let road = draped_strip(&ground, &line, 3.0);
    let mut list =
        DrawList { ground: Some(ground_map(81, 600.0, false, ridge).into()), ..DrawList::default() };
    item(&mut list, ground, ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    item(&mut list, road, draped_material(RED), DepthLayer::Draped(1), ROAD);
    // Half as high as far, the eye looks at the ridge's top and at the road through it.
    let seen_from = |y: f32| {
        let eye = Vec3::new(0.0, y, 0.5 * y.abs());
        let angle = 300.0 / eye.length();
        let camera = Camera::new(eye, Vec3::ZERO, angle.clamp(0.02, 0.8), (300, 200), (1.0, 60_000.0));
        count(&shot(&list, &camera.expect("sound")), ROAD)
    };
    for y in [100.0, 1_000.0, 10_000.0] {
        assert_eq!(seen_from(-y), 0, "from {y} m before the ridge");
        assert!(seen_from(y) > 300, "from {y} m behind the ridge");
    }
}

#[test]
fn what_stands_or_lies_on_a_road_hides_it() {
    let flat = |_: f32, _: f32| 0.0;
    let ground = ground_mesh(10, 100.0, flat);
    let road = draped_strip(&ground, &[DVec2::new(-90.0, 0.0), DVec2::new(90.0, 0.0)], 10.0);
    let mut list =
        DrawList { ground: Some(ground_map(11, 100.0, false, flat).into()), ..DrawList::default() };
    item(&mut list, ground, ground_material(), DepthLayer::Ground, FeatureId::GROUND);
    item(&mut list, road, draped_material(RED), DepthLayer::Draped(1), ROAD);
    let house = box_mesh(Vec3::ZERO, Vec3::new(6.0, 6.0, 5.0));
    item(&mut list, house, Material::default(), DepthLayer::Solid, BOX);
    let plate = box_mesh(Vec3::new(20.0, 0.0, 0.0), Vec3::new(6.0, 6.0, 0.02));
    item(&mut list, plate, Material::default(), DepthLayer::Solid, BOX);
    let camera = looking(Vec3::new(10.0, -90.0, 30.0), Vec3::new(10.0, 0.0, 0.0), (400, 300));
    let picture = shot(&list, &camera);
    // Just above the foot of the wall, on the plate, and on the road between them.
    let things = [(0.0, -3.0, 0.2, BOX), (20.0, 0.0, 0.02, BOX), (11.0, 0.0, 0.0, ROAD)];
    for (x, y, z, expected) in things {
        let at = camera.project(Vec3::new(x, y, z)).expect("in view");
        assert_eq!(feature(&picture, at.pixel.x as u32, at.pixel.y as u32), expected, "at {x}, {y}, {z}");
    }
}

#[test]
fn a_later_drape_covers_an_earlier_one_and_transparent_ones_keep_to_that() {
    let flat = |_: f32, _: f32| 0.0;
    let ground = ground_mesh(10, 100.0, flat);
    let lower = draped_strip(&ground, &[DVec2::new(-90.0, 0.0), DVec2::new(90.0, 3.0)], 30.0);
    let upper = draped_strip(&ground, &[DVec2::new(0.0, -90.0), DVec2::new(7.0, 90.0)], 10.0);
    for alpha in [AlphaMode::Opaque, AlphaMode::Blend] {
        let mut list =
            DrawList { ground: Some(ground_map(11, 100.0, false, flat).into()), ..DrawList::default() };
        item(&mut list, ground.clone(), ground_material(), DepthLayer::Ground, FeatureId::GROUND);
        let under = Material { alpha, ..draped_material(Srgba([0, 255, 0, 200])) };
        item(&mut list, lower.clone(), under, DepthLayer::Draped(1), FOREST);
        item(&mut list, upper.clone(), draped_material(RED), DepthLayer::Draped(2), ROAD);
        let picture = shot(&list, &looking(Vec3::new(0.0, -80.0, 40.0), Vec3::ZERO, (200, 150)));
        assert_eq!(feature(&picture, 100, 75), ROAD);
        assert_eq!(picture.pixels.at(100, 75).0[1], 0, "green shows through");
        assert_eq!(feature(&picture, 60, 75), FOREST);
    }
}

#[test]
fn masked_holes_show_what_is_behind_them() {
    let mut list = DrawList::default();
    plain_light(&mut list);
    let holes = Pixels::from_fn(2, 1, |x, _| Srgba([255, 0, 0, if x == 0 { 255 } else { 0 }]));
    let texture = Some(list.add_texture(holes));
    let material = Material { texture, alpha: AlphaMode::Mask(0.5), ..Material::default() };
    item(&mut list, wall(10.0, [-2.0, 2.0], [-2.0, 2.0], Srgba::WHITE), material, DepthLayer::Solid, BOX);
    let behind = wall(20.0, [-9.0, 9.0], [-9.0, 9.0], BLUE);
    item(&mut list, behind, Material::default(), DepthLayer::Solid, ROAD);
    let picture = shot(&list, &northward((160, 120)));
    assert_eq!((feature(&picture, 66, 60), feature(&picture, 94, 60)), (BOX, ROAD));
    assert_eq!((picture.pixels.at(66, 60), picture.pixels.at(94, 60)), (RED, BLUE));
    // The texture repeats, so alpha passes ½ at a quarter, at three quarters: half the wall is left.
    let left = count(&picture, BOX) as f32;
    let side = 120.0 * 4.0 / (2.0 * libm::tanf(0.4) * 10.0);
    assert!((left / (side * side) - 0.5).abs() < 0.03, "{left} of {}", side * side);
}

#[test]
fn transparent_walls_blend_in_linear_light_and_by_depth_not_by_order() {
    let glass = |color: [u8; 3]| Material {
        base_color: Srgba([color[0], color[1], color[2], 128]),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let walls = [(12.0, [255, 0, 0]), (10.0, [0, 255, 0]), (8.0, [0, 0, 255])];
    let pictures = [[0, 1, 2], [2, 0, 1], [1, 2, 0]].map(|order| {
        let mut list = DrawList::default();
        plain_light(&mut list);
        let back = wall(20.0, [-20.0, 20.0], [-20.0, 20.0], Srgba::opaque(0, 0, 0));
        item(&mut list, back, Material::default(), DepthLayer::Solid, ROAD);
        for index in order {
            let (y, color) = walls[index];
            item(
                &mut list,
                wall(y, [-2.0, 2.0], [-2.0, 2.0], Srgba::WHITE),
                glass(color),
                DepthLayer::Solid,
                BOX,
            );
        }
        shot(&list, &northward((80, 60)))
    });
    assert!(pictures.iter().all(|picture| picture.pixels == pictures[0].pixels));
    let a = 128.0 / 255.0;
    let expected = Vec3::new(a * (1.0 - a) * (1.0 - a), a * (1.0 - a), a);
    let (seen, wanted) = (pictures[0].pixels.at(40, 30), Srgba::from_linear(expected));
    assert!(seen.0.iter().zip(wanted.0).all(|(a, b)| a.abs_diff(b) <= 1), "{seen:?} for {wanted:?}");
    assert_eq!(feature(&pictures[0], 40, 30), BOX);
    assert!((depth(&pictures[0], 40, 30) - 8.0).abs() < 1e-3);
}

#[test]
fn backs_are_left_out_unless_a_material_has_two_sides() {
    for (two_sided, seen) in [(false, FeatureId::NONE), (true, BOX)] {
        let mut list = DrawList::default();
        let away = wall(10.0, [2.0, -2.0], [-2.0, 2.0], GREEN);
        item(&mut list, away, Material { two_sided, ..Material::default() }, DepthLayer::Solid, BOX);
        list.lighting.to_sun = -Vec3::Y;
        let picture = shot(&list, &northward((80, 60)));
        assert_eq!(feature(&picture, 40, 30), seen);
        if two_sided {
            // Turned to the viewer, the normal also faces the sun behind the viewer.
            let lit = list.lighting.shade(GREEN.linear(), -Vec3::Y);
            assert_eq!(picture.pixels.at(40, 30), Srgba::from_linear(lit));
        }
    }
}

#[test]
fn more_transparent_layers_than_are_kept_still_show_the_nearest() {
    let mut list = DrawList::default();
    plain_light(&mut list);
    let veil =
        Material { base_color: Srgba([255, 255, 255, 255]), alpha: AlphaMode::Blend, ..Material::default() };
    for step in 0..100 {
        let color = if step == 99 { GREEN } else { RED };
        let mesh = wall(110.0 - step as f32, [-9.0, 9.0], [-9.0, 9.0], color);
        item(&mut list, mesh, veil.clone(), DepthLayer::Solid, BOX);
    }
    assert_eq!(shot(&list, &northward((80, 60))).pixels.at(40, 30), GREEN);
}
