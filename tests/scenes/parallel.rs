//! Plans, orthographic and oblique pictures: what lies where on them, to a hundredth of a pixel.

use glam::{DVec2, Vec2, Vec3};
use sandtable_description::parse::parse_bytes;
use sandtable_picture::{build_draw_list, camera, display};
use sandtable_render::RenderBackend;
use sandtable_scene::assets::Assets;
use sandtable_scene::build::build;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::picture::{PictureSize, render_view};
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// Pixels per meter at 1:10,000 and 96 dots per inch.
const PX_PER_M: f32 = 96.0 / 0.0254 / 10_000.0;

/// Hills of 200 × 160 posts, 20 m apart, with `text` after the terrain; or the message that refuses it.
fn scene(test: &str, text: &str) -> Result<SceneModel, String> {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("parallel").join(test);
    std::fs::create_dir_all(&folder).expect("a folder");
    let height = |column: u32, row: u32| {
        let (x, y) = (f64::from(column) * 0.11, f64::from(row) * 0.13);
        300.0 + 90.0 * libm::sin(x) * libm::cos(y) + 25.0 * libm::sin(3.1 * x + y)
    };
    let heights: Vec<String> =
        (0..160).flat_map(|row| (0..200).map(move |column| format!("{:.2}", height(column, row)))).collect();
    let grid = "ncols 200\nnrows 160\nxllcorner 500000\nyllcorner 4600000\ncellsize 20\n";
    std::fs::write(folder.join("hill.asc"), grid.to_owned() + &heights.join(" ")).expect("a file");
    let text = format!("crs = \"EPSG:32616\"\n[terrain]\ndem = \"hill.asc\"\n{text}");
    let document = parse_bytes("scene.toml", text.as_bytes()).map_err(|error| error.to_string())?;
    let assets = Assets::new(&folder.join("scene.toml"), &[]).map_err(|error| error.to_string())?;
    build(&document, &assets, &|_| ()).map_err(|error| error.to_string())
}

fn with_camera(test: &str, keys: &str) -> (SceneModel, Camera) {
    let road = "[[road]]\npoints = [[500300, 4600300], [501800, 4601500], [503500, 4602000]]\nwidth = 12\n";
    let scene = scene(test, &format!("{road}[[camera]]\nname = \"map\"\n{keys}\n")).expect("sound");
    let camera = camera(&scene, &scene.cameras[0], (1200, 900)).expect("sound");
    (scene, camera)
}

fn pixel(camera: &Camera, at: Vec3) -> Vec2 {
    camera.project(at).expect("parallel rays see all").pixel
}

/// Places over the whole block.
fn places() -> impl Iterator<Item = Vec3> {
    (0..12).flat_map(|x| (0..10).map(move |y| Vec3::new(x as f32 * 330.0, y as f32 * 320.0, 300.0)))
}

#[test]
fn a_plan_is_true_to_its_scale_and_heights_do_not_move_it() {
    let (_, camera) = with_camera("plan", "projection = \"plan\"\nscale = 10000");
    for at in places() {
        for way in [Vec3::X, Vec3::Y, Vec3::new(0.6, -0.8, 0.0)] {
            let apart = (pixel(&camera, at + way * 1000.0) - pixel(&camera, at)).length();
            assert!((apart - 1000.0 * PX_PER_M).abs() < 0.01, "{apart} px for 1 km along {way}");
        }
        for height in [-500.0, 200.0, 3000.0] {
            let moved = (pixel(&camera, at + Vec3::Z * height) - pixel(&camera, at)).length();
            assert!(moved < 1e-3, "{height} m of height move {moved} px");
        }
    }
    let north = pixel(&camera, Vec3::Y * 1000.0) - pixel(&camera, Vec3::ZERO);
    assert!(north.x.abs() < 0.01 && north.y < 0.0, "north is up, not {north}");
    assert!((camera.scale_denominator().expect("a map") - 10_000.0).abs() < 0.01);
}

#[test]
fn straight_lines_of_the_map_stay_straight_and_parallel() {
    for projection in ["plan", "orthographic", "oblique"] {
        let keys = format!("projection = \"{projection}\"\nscale = 10000\nazimuth = 25");
        let (_, camera) = with_camera(&format!("rays-{projection}"), &keys);
        let way = Vec3::new(700.0, 400.0, 0.0);
        let step = pixel(&camera, way) - pixel(&camera, Vec3::ZERO);
        for at in places() {
            let [start, middle, end] = [0.0, 0.5, 1.0].map(|part| pixel(&camera, at + way * part));
            assert!(((start + end) / 2.0 - middle).length() < 0.01, "{projection}: bent at {at}");
            assert!((end - start - step).length() < 0.01, "{projection}: turned at {at}");
        }
    }
}

#[test]
fn in_an_oblique_picture_the_ground_is_a_plan_and_heights_go_straight_up_at_scale() {
    let (_, camera) = with_camera("oblique", "projection = \"oblique\"\nscale = 10000\nazimuth = 40");
    for at in places() {
        for way in [Vec3::X, Vec3::Y, Vec3::new(0.6, -0.8, 0.0)] {
            let apart = (pixel(&camera, at + way * 1000.0) - pixel(&camera, at)).length();
            assert!((apart - 1000.0 * PX_PER_M).abs() < 0.01, "{apart} px for 1 km along {way}");
        }
        let raised = pixel(&camera, at + Vec3::Z * 200.0) - pixel(&camera, at);
        assert!((raised + Vec2::Y * 200.0 * PX_PER_M).length() < 0.01, "200 m of height are {raised}");
    }
}

#[test]
fn an_orthographic_picture_foreshortens_the_ground_by_its_pitch_everywhere() {
    let keys = "projection = \"orthographic\"\nscale = 10000\npitch = 30";
    let (_, camera) = with_camera("orthographic", keys);
    for at in places() {
        let across = pixel(&camera, at + Vec3::X * 1000.0) - pixel(&camera, at);
        let ahead = pixel(&camera, at + Vec3::Y * 1000.0) - pixel(&camera, at);
        assert!((across - Vec2::X * 1000.0 * PX_PER_M).length() < 0.01, "{across}");
        assert!((ahead + Vec2::Y * 500.0 * PX_PER_M).length() < 0.01, "{ahead}");
    }
}

#[test]
fn without_a_scale_all_of_the_ground_fits_at_a_round_one() {
    for projection in ["plan", "orthographic", "oblique"] {
        let (scene, camera) =
            with_camera(&format!("fitted-{projection}"), &format!("projection = \"{projection}\""));
        let denominator = camera.scale_denominator().expect("a map");
        let unit = 10f64.powi(denominator.log10().floor() as i32 - 1);
        assert!(((denominator / unit).round() * unit - denominator).abs() < 1e-3 * unit, "1:{denominator}");
        let [mut low, mut high] = [Vec2::INFINITY, Vec2::NEG_INFINITY];
        for post in scene.lattice.posts() {
            let at = scene.lattice.position(post).extend(scene.lattice.height(post));
            low = low.min(pixel(&camera, at));
            high = high.max(pixel(&camera, at));
        }
        assert!(low.min_element() >= 0.0 && high.x <= 1200.0 && high.y <= 900.0, "{low} {high}");
        let filled = (high - low) / Vec2::new(1200.0, 900.0);
        assert!(filled.max_element() > 0.78, "{projection} fills {filled}");
    }
}

/// The size that the picture of a camera with `keys` has where the command line states none.
fn own_size(test: &str, keys: &str) -> (SceneModel, PictureSize) {
    let (scene, _) = with_camera(test, keys);
    let size = PictureSize::of(&scene, &scene.cameras[0]);
    (scene, size)
}

#[test]
fn a_fitted_plan_whose_size_nothing_states_has_the_shape_of_what_it_shows() {
    let shown = [
        ("tall", [500_200.0, 4_600_100.0], [501_400.0, 4_602_500.0]),
        ("square", [500_200.0, 4_600_100.0], [502_200.0, 4_602_100.0]),
        ("wide", [500_200.0, 4_600_100.0], [503_800.0, 4_602_000.0]),
        ("strip", [500_200.0, 4_600_100.0], [500_500.0, 4_602_900.0]),
    ];
    for (name, low, high) in shown {
        let keys = format!("projection = \"plan\"\nshows = [{low:?}, {high:?}]");
        let (scene, PictureSize { width, height }) = own_size(&format!("shaped-{name}"), &keys);
        let pixels = f64::from(width) * f64::from(height);
        assert!((pixels / (1920.0 * 1080.0) - 1.0).abs() < 1e-3, "{name}: {width} × {height}");
        let camera = camera(&scene, &scene.cameras[0], (width, height)).expect("sound");
        let corner = |[x, y]: [f64; 2]| {
            let at = DVec2::new(x, y) - scene.lattice.map_extent().min;
            pixel(&camera, at.as_vec2().extend(300.0))
        };
        let filled = (corner(high) - corner(low)).abs() / Vec2::new(width as f32, height as f32);
        // A twentieth is free for title and scale bar, and a round scale takes a tenth at most.
        let [across, down] = filled.to_array();
        assert!(down > 0.8, "{name}: {filled}");
        assert!(across > 0.8 || name == "strip", "{name}: {filled}");
        assert!(name != "strip" || height < width * 2 + 3, "no page is longer: {width} × {height}");
    }
}

#[test]
fn a_stated_paper_or_scale_and_a_perspective_have_a_size_of_their_own() {
    let shows = "shows = [[500200, 4600100], [501400, 4602500]]";
    let size = |test: &str, keys: &str| {
        let PictureSize { width, height } = own_size(test, &format!("{keys}\n{shows}")).1;
        (width, height)
    };
    assert_eq!(size("sized-view", ""), (1920, 1080));
    assert_eq!(size("sized-scale", "projection = \"plan\"\nscale = 10000"), (1920, 1080));
    assert_eq!(size("sized-paper", "projection = \"plan\"\npaper = \"A4\"\ndpi = 100"), (1169, 827));
}

#[test]
fn the_ground_is_as_fine_as_the_scale_shows_it() {
    let triangles = |scale: u32| {
        let keys = format!(
            "projection = \"oblique\"\nscale = {scale}\nshows = [[500500, 4600500], [501000, 4601000]]"
        );
        let (mut scene, camera) = with_camera(&format!("detail{scale}"), &keys);
        scene.tolerance_px = 0.5;
        let displayed = display(&scene, &camera);
        let ground = FullResolution { lattice: scene.ground().lattice() };
        let allowed_m = 0.5 / f64::from(camera.pixels_per_meter(1.0)) + 1e-3;
        for step in 0..40 {
            let at = DVec2::new(510.0, 505.0) + f64::from(step) * DVec2::new(11.3, 12.1);
            let off = displayed.displayed_z(at).expect("in view") - ground.displayed_z(at).expect("ground");
            assert!(off.abs() <= allowed_m, "{off} m off at 1:{scale}, {allowed_m} m are half a pixel");
        }
        build_draw_list(&scene, &camera, &|_| ()).ground_triangles
    };
    // Both show the same ground: at the smaller scale the picture holds all of the block.
    let (fine, coarse) = (triangles(20_000), triangles(400_000));
    assert!(coarse * 4 < fine, "{coarse} at 1:400 000, {fine} at 1:20 000");
}

#[test]
fn one_and_four_threads_draw_the_same_bytes() {
    for projection in ["plan", "orthographic", "oblique"] {
        let (scene, _) =
            with_camera(&format!("threads-{projection}"), &format!("projection = \"{projection}\""));
        let size = PictureSize { width: 320, height: 240 };
        let drawn = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let view = &scene.cameras[0];
            let draw = || render_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
            pool.install(draw).pixels
        };
        assert!(drawn(1) == drawn(4), "{projection}");
    }
}

#[test]
fn keys_that_have_no_effect_are_refused() {
    let refused = |keys: &str| {
        scene("refused", &format!("[[camera]]\nname = \"map\"\n{keys}\n")).err().expect("refused")
    };
    assert!(refused("scale = 25000").contains("`scale` has no effect in perspective"));
    assert!(refused("projection = \"plan\"\npitch = 40").contains("`pitch` has no effect on a plan"));
    let eye = refused("projection = \"oblique\"\neye = [500100, 4600100]\nlook_at = [500200, 4600100]");
    assert!(eye.contains("`eye` has no effect on a camera that is not in perspective"), "{eye}");
    assert!(refused("projection = \"plan\"\nscale = 0.5").contains("scale"));
}

#[test]
fn keys_of_a_panorama_that_do_not_go_together_are_refused() {
    let keys = |keys: &str| {
        let keys = format!("[[camera]]\nname = \"round\"\nprojection = \"panorama\"\n{keys}\n");
        scene("panorama", &keys).err().unwrap_or_default()
    };
    let eye = "eye = [502000, 4601500]";
    assert_eq!(keys(eye), "", "the whole circle");
    assert_eq!(keys(&format!("{eye}\nfrom = -20\nto = 30")), "", "past north");
    for (stated, message) in [
        ("", "a panorama needs an `eye`"),
        ("eye = [502000, 4601500]\nto = 30", "`to` without `from`"),
        ("eye = [502000, 4601500]\nfrom = 30\nto = 35", "the panorama reaches over 5° of the horizon"),
        ("eye = [502000, 4601500]\nazimuth = 30", "`azimuth` has no effect on a panorama"),
        ("eye = [502000, 4601500]\nlook_at = [502000, 4602500]", "`look_at` has no effect on a panorama"),
        ("eye = [102000, 4601500]", "lies off the elevation model"),
        ("eye = [502000, 4601500]\n[furniture]\nlayout = \"margin\"", "a panorama has no margin"),
    ] {
        let found = keys(stated);
        assert!(found.contains(message), "{stated}: {found}");
    }
}

#[test]
fn the_block_stands_on_a_table_where_its_edge_is_seen_from_outside() {
    let has_table = |keys: &str| {
        let (scene, camera) = with_camera("table", keys);
        let list = build_draw_list(&scene, &camera, &|_| ()).list;
        list.materials.iter().any(|material| material.name == "table")
    };
    assert!(has_table("azimuth = 20"));
    assert!(has_table("projection = \"oblique\""));
    assert!(!has_table("projection = \"plan\""));
    let inside = "eye = [502000, 4601500]\neye_height = 100\nlook_at = [502000, 4602500]";
    assert!(!has_table(inside), "the horizon is in view");
}
