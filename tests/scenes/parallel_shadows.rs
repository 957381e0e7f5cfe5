//! Shadows of what stands on the ground, by every projection: where they fall, and as dark as in perspective.

use glam::{Vec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_picture::{build_draw_list, camera};
use sandtable_render::cpu::{RenderQuality, render};
use sandtable_render::picture::Rendering;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

use crate::common::scratch::Scratch;

/// The tower's height in meters; the sun stands 40° high.
const HEIGHT_M: f32 = 60.0;

/// Half of its side in meters.
const HALF_M: f32 = 20.0;

/// The grain of natural ground changes its light by less than a tenth.
const GRAIN: f32 = 0.1;

/// The middle of the tower in the world, whose origin is the south-west post.
const MIDDLE: Vec3 = Vec3::new(500.0, 500.0, 100.0);

const PROJECTIONS: [&str; 5] = [
    "",
    "projection = \"plan\"\n",
    "projection = \"orthographic\"\n",
    "projection = \"orthographic\"\nazimuth = 130\npitch = 15\n",
    "projection = \"oblique\"\nazimuth = 40\n",
];

/// Level ground of a square kilometer and a tower on it.
fn scene(camera: &str) -> SceneModel {
    let folder = Scratch::new();
    let row = "100 ".repeat(101);
    let grid = "ncols 101\nnrows 101\nxllcenter 0\nyllcenter 0\ncellsize 10\n".to_owned();
    folder.write("flat.asc", grid + &[row.as_str(); 101].join("\n"));
    let tower = format!("points = [[480, 480], [520, 480], [520, 520], [480, 520]]\nheight = {HEIGHT_M}\n");
    // Level ground is a lake where nothing forbids it.
    let text = format!(
        "[terrain]\ndem = \"flat.asc\"\ninfer_water = false\n[[building]]\n{tower}[[camera]]\nname = \"a\"\n{camera}"
    );
    let path = folder.write("scene.toml", &text);
    let document = parse_bytes("scene.toml", text.as_bytes()).expect("a scene file");
    let assets = Assets::new(&path, &[]).expect("the folder is there");
    build(&document, &assets, &|_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// A picture, how it was seen, and the unit vector toward its sun.
struct Drawn {
    picture: Rendering,
    camera: Camera,
    to_sun: Vec3,
}

impl Drawn {
    fn new(keys: &str, size: (u32, u32)) -> Self {
        let scene = scene(keys);
        let camera = camera(&scene, &scene.cameras[0], size).expect("sound");
        let list = build_draw_list(&scene, &camera, &|_| ()).list;
        let picture = render(&list, &camera, &RenderQuality::default()).expect("sound");
        Self { picture, camera, to_sun: list.lighting.to_sun }
    }

    /// How light the ground is at a place, 0 to 1; `None` where the tower hides it.
    fn light(&self, at: Vec3) -> Option<f32> {
        let seen = self.camera.project(at).expect("in view");
        let (width, height) = self.camera.size();
        let inside = seen.pixel.cmpge(Vec2::ZERO).all()
            && seen.pixel.cmplt(Vec2::new(width as f32, height as f32)).all();
        let index = seen.pixel.y as usize * width as usize + seen.pixel.x as usize;
        let is_ground = inside && (self.picture.depth_m[index] - seen.depth_m).abs() < 3.0;
        is_ground.then(|| self.picture.pixels.data()[index].linear().element_sum() / 3.0)
    }

    /// The unit vector along which shadows fall on level ground.
    fn along(&self) -> Vec3 {
        -self.to_sun.truncate().normalize().extend(0.0)
    }

    /// The length of the tower's shadow in meters.
    fn length_m(&self) -> f32 {
        HEIGHT_M * self.to_sun.truncate().length() / self.to_sun.z
    }
}

#[test]
fn a_tower_casts_a_shadow_of_its_length_by_every_projection() {
    let perspective = Drawn::new(PROJECTIONS[0], (900, 700));
    let darkness = |drawn: &Drawn, at: Vec3| Some(drawn.light(at)? / drawn.light(MIDDLE + Vec3::X * 300.0)?);
    let shadow = |drawn: &Drawn, share: f32| {
        // Past the wall that is the farthest in the shadow's direction.
        let from = HALF_M * std::f32::consts::SQRT_2;
        MIDDLE + drawn.along() * (from + share * drawn.length_m())
    };
    let of_perspective = darkness(&perspective, shadow(&perspective, 0.5)).expect("in view");
    assert!(of_perspective < 0.6, "{of_perspective}");
    for keys in &PROJECTIONS[1..] {
        for size in [(900, 700), (3000, 2400)] {
            let drawn = Drawn::new(keys, size);
            let mut seen = 0;
            for share in [0.2, 0.5, 0.8] {
                let Some(own) = darkness(&drawn, shadow(&drawn, share)) else { continue };
                assert!((own - of_perspective).abs() < GRAIN, "{keys}: {own}, not {of_perspective}");
                seen += 1;
            }
            assert!(seen > 0, "{keys}");
            for beyond in [1.5, 2.5] {
                let Some(own) = darkness(&drawn, shadow(&drawn, beyond)) else { continue };
                assert!((own - 1.0).abs() < GRAIN, "{keys}: {own} beyond its end");
            }
        }
    }
}

#[test]
fn the_ground_at_a_foot_is_darker_than_in_the_open_by_every_projection() {
    let mut seen = 0;
    // From low down a pixel spans more ground than the shade reaches.
    for keys in PROJECTIONS.into_iter().filter(|keys| !keys.contains("pitch")) {
        let drawn = Drawn::new(keys, (900, 700));
        let open = drawn.light(MIDDLE + Vec3::X * 300.0).expect("in view");
        // On the lit side, beside the walls and away from them.
        let [near, off] = [1.0f32, 30.0].map(|away_m| {
            let sides = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y];
            let lit = sides.into_iter().filter(|side| side.dot(drawn.to_sun) > 0.2);
            let lights = lit.filter_map(|side| drawn.light(MIDDLE + side * (HALF_M + away_m)));
            lights.fold(f32::MAX, f32::min)
        });
        // The tower may hide its lit walls.
        seen += usize::from(near < f32::MAX);
        assert!(near == f32::MAX || near < 0.9 * open, "{keys}: {near} at the foot, {open} in the open");
        assert!((off / open - 1.0).abs() < GRAIN || off == f32::MAX, "{keys}: {off} of {open}");
    }
    assert!(seen >= 3, "{seen}");
}

/// A part of a plan shows what the whole shows there, with the shadow of what stands outside of it.
#[test]
fn a_part_of_a_plan_has_the_shadows_of_what_stands_beside_it() {
    let whole = Drawn::new("projection = \"plan\"\nscale = 5000\n", (1200, 1200));
    let along = whole.along();
    let at = MIDDLE + along * (0.7 * whole.length_m());
    let corner = |by: f32| {
        let place = at + Vec3::new(by, by, 0.0);
        format!("[{}, {}]", place.x, place.y)
    };
    // The tower itself is out of view.
    let keys = format!("projection = \"plan\"\nscale = 500\nshows = [{}, {}]\n", corner(-8.0), corner(8.0));
    let part = Drawn::new(&keys, (120, 120));
    assert!(part.camera.project(MIDDLE).is_some_and(|seen| seen.pixel.min_element() < 0.0));
    let [of_whole, of_part] = [&whole, &part].map(|drawn| drawn.light(at).expect("in view"));
    assert!((of_whole - of_part).abs() < GRAIN * of_whole, "{of_whole} {of_part}");
    let open = whole.light(MIDDLE + Vec3::X * 300.0).expect("in view");
    assert!(of_part < 0.6 * open, "{of_part} of {open}");
}
