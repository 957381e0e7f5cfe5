//! Pictures draped over the ground: where they lie, what shows beside them, and what is refused.

use std::io::Cursor;

use glam::{DVec2, Vec2};
use image::{ImageFormat, Rgba, RgbaImage};
use sandtable_description::parse::parse_bytes;
use sandtable_draw::color::Srgba;
use sandtable_geom::crs::Crs;
use sandtable_picture::{build_draw_list, camera};
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;

use crate::common::scratch::Scratch;

/// Red in the north, green in the south-west, blue in the south-east; a hole in its middle.
fn png() -> Vec<u8> {
    let image = RgbaImage::from_fn(40, 40, |x, y| match (x, y) {
        (16..24, 16..24) => Rgba([0; 4]),
        (_, 0..20) => Rgba([255, 0, 0, 255]),
        (0..20, _) => Rgba([0, 255, 0, 255]),
        _ => Rgba([0, 0, 255, 255]),
    });
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).expect("memory");
    bytes.into_inner()
}

/// Ground of 1000 m by 1000 m from (400000, 4000000) with a picture of pixels of 25 m whose north-west corner lies at
/// `corner`.
fn scene(corner: [f64; 2], prj: Option<&str>, keys: &str) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    let grid = "ncols 21\nnrows 21\nxllcenter 400000\nyllcenter 4000000\ncellsize 50\n".to_owned();
    scratch.write("s/level.asc", grid + &"50 ".repeat(21 * 20) + &"60 ".repeat(21));
    scratch.write("s/photo.png", png());
    let [x, y] = [corner[0] + 12.5, corner[1] - 12.5];
    scratch.write("s/photo.pgw", format!("25\n0\n0\n-25\n{x}\n{y}\n"));
    prj.into_iter().for_each(|prj| drop(scratch.write("s/photo.prj", prj)));
    let text = format!(
        "[terrain]\ndem = \"level.asc\"\ncrs = \"EPSG:32616\"\n[style.imagery]\nfile = \"photo.png\"\n{keys}"
    );
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&scratch.at("s/scene.toml"), &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

#[test]
fn a_picture_lies_where_its_world_file_says_and_the_ramp_shows_through_its_holes() {
    let scene = scene([400_000.0, 4_000_900.0], Some("EPSG:32616"), "").expect("sound");
    let imagery = scene.imagery.as_deref().expect("a picture");
    assert!(imagery.is_shaded);
    let seen = |x: f32, y: f32| imagery.at(Vec2::new(x, y));
    for (x, y, color) in
        [(100.0, 800.0, [255, 0, 0]), (100.0, 100.0, [0, 255, 0]), (900.0, 100.0, [0, 0, 255])]
    {
        let [red, green, blue] = color;
        assert_eq!((seen(x, y).color, seen(x, y).share), (Srgba::opaque(red, green, blue).linear(), 1.0));
    }
    assert_eq!([seen(500.0, 400.0).share, seen(100.0, 950.0).share], [0.0, 0.0], "a hole, and beyond");
    let camera = camera(&scene, &scene.cameras[0], (64, 64)).expect("sound");
    let list = build_draw_list(&scene, &camera, &|_| ()).list;
    let map = list.ground.expect("there");
    assert!(map.imagery.is_some());
    assert_eq!(map.check(), Ok(()));
}

#[test]
fn a_picture_in_another_zone_is_brought_to_the_scenes_system() {
    // The middle of the ground, (400500, 4000500) in zone 16, in zone 15.
    let zone = |code: u32| Crs::from_epsg(code).expect("known");
    let middle = zone(32616).transform(&zone(32615), DVec2::new(400_500.0, 4_000_500.0)).expect("near");
    let scene = scene([middle.x - 500.0, middle.y + 500.0], Some("EPSG:32615"), "").expect("sound");
    let imagery = scene.imagery.as_deref().expect("a picture");
    let red = |x: f32, y: f32| imagery.at(Vec2::new(x, y)).color == Srgba::opaque(255, 0, 0).linear();
    assert!(red(500.0, 800.0) && !red(500.0, 200.0));
    assert_eq!(imagery.at(Vec2::new(500.0, 500.0)).share, 0.0, "the hole in its middle");
}

#[test]
fn what_has_no_system_or_shows_none_of_the_ground_is_an_error_at_its_place() {
    let refused = |corner, prj, keys| scene(corner, prj, keys).err().expect("refused");
    let unknown = refused([400_000.0, 4_000_900.0], None, "");
    assert!(unknown.contains("names no coordinate system") && unknown.contains("crs"), "{unknown}");
    let far = refused([900_000.0, 4_000_900.0], Some("EPSG:32616"), "");
    assert!(far.contains("shows none of the ground"), "{far}");
    let key = scene([400_000.0, 4_000_900.0], None, "crs = \"EPSG:32616\"\nshade = false\n").expect("stated");
    assert!(!key.imagery.as_deref().expect("a picture").is_shaded);
}
