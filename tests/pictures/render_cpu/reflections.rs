//! Relief in water: upside down under its shore, the sky before it, and nothing from above.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawList;
use sandtable_render::picture::Rendering;
use sandtable_view::camera::Camera;

use crate::common::mountain_lake::{LEVEL_M, low_over_water, mountain_lake};
use crate::render_cpu::{looking, shot};

/// The lake as a map of level ground shows it: nothing stands beside it that it could mirror.
fn without_relief() -> DrawList {
    let mut list = mountain_lake(0.0);
    let map = Arc::make_mut(list.ground.as_mut().expect("there is ground"));
    map.posts.iter_mut().for_each(|post| post.height_m = LEVEL_M);
    list
}

/// The middle color of a row of pixels near the middle of the picture: ripples tilt single ones.
fn row(picture: &Rendering, y: u32) -> [f32; 3] {
    let middle = picture.pixels.width() / 2;
    let colors: Vec<[u8; 4]> = (middle - 30..middle + 30).map(|x| picture.pixels.at(x, y).0).collect();
    std::array::from_fn(|channel| {
        colors.iter().map(|color| f32::from(color[channel])).sum::<f32>() / colors.len() as f32
    })
}

/// The row of pixels of a level camera that looks down by the angle whose tangent is `fall`.
fn row_at(camera: &Camera, fall: f32) -> u32 {
    let (width, height) = camera.size();
    let at = |y: u32| camera.ray_through(Vec2::new(width as f32 / 2.0, y as f32 + 0.5));
    (0..height).find(|&y| -at(y).z / at(y).y > fall).expect("in the picture")
}

#[test]
fn a_slope_beside_water_is_mirrored_upside_down_and_the_sky_before_it() {
    let camera = low_over_water((400, 300));
    let (seen, level) = (shot(&mountain_lake(0.0), &camera), shot(&without_relief(), &camera));
    // The mirrored ray of a place `d` meters off rises by 20 / d, so low ground is seen near the shore, high ground nearer.
    let [low, high, above] = [0.042, 0.085, 0.2].map(|fall| row_at(&camera, fall));
    let change = |y: u32| {
        let (seen, level) = (row(&seen, y), row(&level, y));
        [0, 1, 2].map(|channel| seen[channel] - level[channel])
    };
    let [red, green, blue] = change(low);
    assert!(red > green + 3.0 && blue < -20.0, "low ground: {:?}", change(low));
    let [red, green, blue] = change(high);
    assert!(green > red + 5.0 && blue < -10.0, "high ground: {:?}", change(high));
    assert_eq!(row(&seen, above), row(&level, above), "the sky");
}

#[test]
fn from_above_water_mirrors_no_relief() {
    let eye = Vec3::new(0.0, -1100.0, 400.0);
    let camera = looking(eye, Vec3::new(0.0, -1000.0, 10.0), (200, 150));
    let (seen, level) = (shot(&mountain_lake(0.0), &camera), shot(&without_relief(), &camera));
    assert!(seen.pixels == level.pixels);
    let Srgba([red, _, blue, _]) = seen.pixels.at(100, 75);
    assert!(blue > red + 40, "water fills the picture");
}

#[test]
fn a_mirrored_crest_is_as_smooth_along_the_shore_as_the_crest() {
    let camera = low_over_water((600, 300));
    let list = mountain_lake(0.3);
    let (seen, level) = (shot(&list, &camera), shot(&without_relief(), &camera));
    // The row in each column where relief gives way to the sky, from below.
    let changes = |x: u32, y: u32| {
        let [seen, level] = [&seen, &level].map(|picture| picture.pixels.at(x, y).0[2]);
        level.abs_diff(seen) > 6
    };
    let ends: Vec<u32> = (100..500).filter_map(|x| (0..300).rev().find(|&y| changes(x, y))).collect();
    assert_eq!(ends.len(), 400);
    let (low, high) = (ends.iter().min().expect("some"), ends.iter().max().expect("some"));
    assert!(high - low > 5, "the crest is uneven: {low}..{high}");
    let leaps = ends.windows(2).filter(|pair| pair[0].abs_diff(pair[1]) > 12).count();
    assert!(leaps < 20, "{leaps} of 399: {ends:?}");
}
