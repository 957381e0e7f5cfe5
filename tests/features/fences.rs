//! What stands along lines: on the displayed ground for any camera and level of detail, and no more than a scene holds.

use std::path::Path;
use std::sync::LazyLock;

use glam::{DVec2, Vec3};
use proptest::prelude::*;
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::polyline::Polyline;
use sandtable_picture::display;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_structure::bands::{BandSize, hedge, parapets, rails, wall};
use sandtable_structure::draped_solid::DrapedSolid;
use sandtable_structure::fence::stands;
use sandtable_structure::fence_band::{FenceBand, check_feet};
use sandtable_structure::power::check_wires;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_terrain::support_surface::SupportSurface;
use sandtable_view::camera::Camera;

use crate::common::scratch::Scratch;

const ROOT: &str = env!("SANDTABLE_ROOT");

/// The gallery's scene of lines at several tolerances.
static SCENES: LazyLock<Vec<SceneModel>> = LazyLock::new(|| {
    let path = Path::new(ROOT).join("scenes/lines.toml");
    let load = |tolerance_px: f32| {
        let mut scene = open_scene(&path, &[], &|_| {}).expect("sound");
        scene.tolerance_px = tolerance_px;
        scene
    };
    [0.5, 5.0, 40.0, 300.0].map(load).into()
});

fn seen(scene: &SceneModel, eye: (f32, f32, f32), target: (f32, f32)) -> Option<DisplayedTerrain> {
    let target = Vec3::new(target.0, target.1, 80.0);
    let camera = Camera::new(Vec3::new(eye.0, eye.1, eye.2), target, 0.8, (800, 600), (0.5, 9000.0)).ok()?;
    Some(display(scene, &camera))
}

fn finest(scene: &SceneModel) -> FullResolution<'_> {
    FullResolution { lattice: scene.ground().lattice() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_feet_of_walls_hedges_rails_and_parapets_lie_on_the_displayed_ground(
        eye in (-500f32..1800.0, -500f32..1800.0, 150f32..2500.0),
        target in (0f32..1280.0, 0f32..1280.0),
        tolerance in 0usize..4,
        points in proptest::collection::vec((-50.0..1330.0f64, -50.0..1330.0f64), 2..6),
        width_m in 0.2..12.0f64,
    ) {
        let scene = &SCENES[tolerance];
        let displayed = seen(scene, eye, target);
        prop_assume!(displayed.is_some());
        let displayed = displayed.expect("checked");
        let line = Polyline::new(points.into_iter().map(DVec2::from), 0.0);
        prop_assume!(line.is_some());
        let along = Alignment::on_ground(line.expect("checked"), width_m);
        let bands: Vec<FenceBand> = [wall(&along, BandSize { height_m: 3.0, every_m: 4.0 }), hedge(&along, BandSize { height_m: 3.0, every_m: 3.0 })]
            .into_iter()
            .chain(rails(&along, 2.0))
            .chain(parapets(&along, BandSize { height_m: 2.0, every_m: 5.0 }))
            .collect();
        for band in &bands {
            let off = check_feet(band, &displayed);
            prop_assert!(off < 2e-3, "{off} m");
        }
    }

    #[test]
    fn the_gallery_s_lines_stand_on_the_displayed_ground_and_its_wires_keep_off_it(
        eye in (-500f32..1800.0, -500f32..1800.0, 150f32..2500.0),
        target in (0f32..1280.0, 0f32..1280.0),
        tolerance in 0usize..4,
    ) {
        let scene = &SCENES[tolerance];
        let displayed = seen(scene, eye, target);
        prop_assume!(displayed.is_some());
        let displayed = displayed.expect("checked");
        for standing in &scene.uprights {
            match &standing.upright {
                DrapedSolid::Band(band) => prop_assert!(check_feet(band, &displayed) < 2e-3),
                DrapedSolid::PowerLine(line) => {
                    let lacks = check_wires(line, SupportSurface { displayed: &displayed, ground: &finest(scene) });
                    prop_assert!(lacks < 1e-6, "{lacks} m too near the ground");
                }
                _ => {}
            }
        }
    }
}

#[test]
fn posts_and_obstacles_stand_on_the_displayed_ground_and_reach_into_it() {
    for scene in SCENES.iter() {
        let displayed = seen(scene, (150.0, 150.0, 300.0), (262.0, 455.0)).expect("sound");
        for standing in &scene.uprights {
            let (first, height_m) = match &standing.upright {
                DrapedSolid::Posts(posts) => (posts.stands[0], posts.height_m),
                DrapedSolid::Obstacles(belt) => (belt.stands[0].0, belt.height_m),
                _ => continue,
            };
            let mesh =
                standing.upright.mesh(SupportSurface { displayed: &displayed, ground: &finest(scene) });
            let near = |position: &[f32; 3]| {
                (DVec2::new(f64::from(position[0]), f64::from(position[1])) - first.at).length()
                    < 1.2 * height_m
            };
            let zs =
                mesh.vertices.iter().map(|vertex| vertex.position).filter(near).map(|at| f64::from(at[2]));
            let (low, high) =
                zs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
            let ground =
                SupportSurface { displayed: &displayed, ground: &finest(scene) }.z(first.at).expect("ground");
            assert!(
                low < ground && (high - ground - height_m).abs() < 0.1 * height_m,
                "{low} {high} {ground}"
            );
        }
    }
}

#[test]
fn a_wall_holds_what_its_length_width_and_height_make() {
    let scene = &SCENES[0];
    let displayed = seen(scene, (150.0, 150.0, 300.0), (262.0, 455.0)).expect("sound");
    for quarter in 0..4 {
        let turn = |x: f64, y: f64| {
            (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp()) + DVec2::new(262.0, 455.0)
        };
        let points = [turn(-30.0, 0.0), turn(0.0, 0.0), turn(0.0, 25.0)];
        let along = Alignment::on_ground(Polyline::new(points, 0.0).expect("a line"), 2.0);
        let mesh = DrapedSolid::Band(wall(&along, BandSize { height_m: 3.0, every_m: 50.0 }))
            .mesh(SupportSurface { displayed: &displayed, ground: &finest(scene) });
        let at = |position: [f32; 3]| Vec3::from(position).as_dvec3() - DVec2::new(262.0, 455.0).extend(0.0);
        // Between ground and top every upright prism is as high as the wall: the sides and the top tell its volume.
        let top: f64 = mesh
            .triangles
            .iter()
            .map(|triangle| triangle.map(|id| at(mesh.vertices[id.index()].position).truncate()))
            .map(|[a, b, c]| ((b - a).perp_dot(c - a) / 2.0).max(0.0))
            .sum();
        assert!((top - 55.0 * 2.0).abs() < 0.1, "{top} m² of coping");
    }
}

/// The message about a scene of the hills with `tables`, or the scene.
fn built(tables: &str) -> Result<SceneModel, String> {
    let scratch = Scratch::new();
    std::fs::copy(Path::new(ROOT).join("assets/jacksboro/hills.png"), scratch.at("hills.png"))
        .expect("copied");
    let ground = "[terrain]\ndem = \"hills.png\"\nheight_scale = 0.1\ncell = 10\n";
    let path = scratch.write("scene.toml", format!("{ground}{tables}"));
    open_scene(&path, &[], &|_| {}).map_err(|failure| format!("{failure:?}"))
}

#[test]
fn a_million_posts_are_refused_before_they_are_made() {
    let ring: Vec<String> =
        (0..300).map(|index| format!("[{}, {}]", 100 + index % 2 * 1000, index * 4)).collect();
    let text = format!("[[fence]]\nspacing = 0.1\npoints = [{}]\n", ring.join(", "));
    let message = built(&text).err().expect("refused");
    assert!(message.contains("300000 pieces") && message.contains("spacing"), "{message}");
}

#[test]
fn a_line_from_far_off_costs_what_lies_on_the_model() {
    for kind in ["fence", "wall", "hedge", "power-line", "trench", "obstacles", "boundary"] {
        let text = format!("[[fence]]\nkind = \"{kind}\"\npoints = [[-900000000, 600], [900000000, 640]]\n");
        let scene = built(&text).unwrap_or_else(|message| panic!("{kind}: {message}"));
        assert!(scene.uprights.len() + scene.ribbons.len() > 0, "{kind}");
    }
}

#[test]
fn a_trench_is_dug_where_the_cells_are_fine_enough_and_tells_its_volume() {
    let line = "points = [[200, 500], [320, 520]]\nkind = \"trench\"\nheight = 3\n";
    let coarse = built(&format!("[[fence]]\n{line}width = 4\n")).expect("sound");
    assert!(coarse.notes().iter().any(|note| note.contains("not dug")), "{:?}", coarse.notes());
    assert!(coarse.report.trenches.is_empty());
    let fine = built(&format!("[[fence]]\n{line}width = 40\n")).expect("sound");
    let cut = fine.report.trenches[0].cut;
    // Depth times the mean of top and bottom width times length, and rounded ends.
    assert!((3.0 * 31.0 * 121.0..3.0 * 31.0 * 175.0).contains(&cut), "{cut}");
}

#[test]
fn pylons_stand_no_further_apart_than_the_spacing() {
    let line = [DVec2::ZERO, DVec2::new(1000.0, 0.0), DVec2::new(1000.0, 450.0)];
    let pylons = stands(&Polyline::new(line, 0.0).expect("a line"), 300.0);
    assert!(pylons.windows(2).all(|pair| pair[0].at.distance(pair[1].at) <= 300.0));
    assert_eq!(pylons.len(), 4 + 2 + 1);
}
