//! What is draped lies exactly on what is displayed: random terrains, ribbons, cameras and tolerances.

use std::sync::Arc;

use glam::{DAffine2, DVec2, Vec3};
use proptest::prelude::*;
use sandtable_earthworks::alignment::Alignment;
use sandtable_earthworks::leveling;
use sandtable_geom::crs::Crs;
use sandtable_geom::polyline::Polyline;
use sandtable_mesh::check;
use sandtable_mesh::trimesh::TriMesh;
use sandtable_raster::answer::Answer;
use sandtable_raster::raster::{Raster, Samples};
use sandtable_ribbon::area;
use sandtable_ribbon::drape::{check_clearance, drape};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::stroke::{StrokeOptions, StrokePath, stroke};
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_roam::measured_ground::MeasuredGround;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::service::HeightService;
use sandtable_terrain::query::{Interpolation, Surface};
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

const COLUMNS: u32 = 120;
const ROWS: u32 = 90;
const CELL_M: f64 = 30.0;

/// What refinement needs of one lattice.
struct World {
    lattice: Lattice,
    ground: MeasuredGround,
}

impl World {
    fn new(lattice: Lattice) -> Self {
        let ground = MeasuredGround::new(lattice.stretched(1.5), 32).expect("sound");
        Self { lattice, ground }
    }

    fn seen_by(&self, camera: &Camera, tolerance_px: f32) -> DisplayedTerrain {
        let displayed = self.ground.displayed_to(camera, tolerance_px);
        displayed.active().check();
        displayed
    }
}

/// Hills at three scales, without pattern along the rows.
fn hills() -> Lattice {
    let height = |index: u32| {
        let (x, y) = (f64::from(index % COLUMNS), f64::from(index / COLUMNS));
        let wave = |fx: f64, fy: f64, phase: f64| libm::sin(x * fx + y * fy + phase);
        (400.0 + 90.0 * wave(0.05, 0.03, 0.2) + 40.0 * wave(-0.11, 0.17, 1.0) + 9.0 * wave(0.7, 0.9, 2.0))
            as f32
    };
    let heights = (0..COLUMNS * ROWS).map(height).collect();
    Lattice::new(DVec2::new(5e5, 4e6), DVec2::splat(CELL_M), COLUMNS, heights).expect("sound")
}

fn camera(eye: (f32, f32, f32), target: (f32, f32)) -> Option<Camera> {
    let target = Vec3::new(target.0, target.1, 550.0);
    Camera::new(Vec3::new(eye.0, eye.1, eye.2), target, 0.8, (800, 600), (0.5, 20_000.0)).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1200))]

    #[test]
    fn clearance_is_zero_for_any_camera_and_level_of_detail(
        eye in (-500f32..4000.0, -500f32..3200.0, 620f32..3000.0),
        target in (0f32..3570.0, 0f32..2670.0),
        tolerance_px in 0.3f32..40.0,
        points in proptest::collection::vec((-100.0..3700.0f64, -100.0..2800.0f64), 2..7),
        width_m in 2.0..60.0f64,
    ) {
        static WORLD: std::sync::LazyLock<World> = std::sync::LazyLock::new(|| World::new(hills()));
        let camera = camera(eye, target);
        let line = Polyline::new(points.into_iter().map(DVec2::from), 0.01);
        prop_assume!(camera.is_some() && line.is_some());
        let terrain = WORLD.seen_by(&camera.expect("checked"), tolerance_px);
        let mut plan = PlanMesh::default();
        let alignment = Alignment::on_ground(line.expect("checked"), width_m);
        stroke(&StrokePath::alone(&alignment), &StrokeOptions::default(), &mut plan);
        let clearance = check_clearance(&drape(&plan, &terrain), &terrain);
        prop_assert!(clearance < 2e-3, "{clearance} m");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_camera_sees_a_conforming_mesh_within_its_tolerance(
        eye in (-500f32..4000.0, -500f32..3200.0, 620f32..3000.0),
        target in (0f32..3570.0, 0f32..2670.0),
        tolerance_px in 0.3f32..40.0,
    ) {
        static WORLD: std::sync::LazyLock<World> = std::sync::LazyLock::new(|| World::new(hills()));
        let camera = camera(eye, target);
        prop_assume!(camera.is_some());
        let camera = camera.expect("checked");
        let terrain = WORLD.seen_by(&camera, tolerance_px);
        let mut mesh = TriMesh::default();
        terrain.emit(&mut mesh);
        prop_assert_eq!(check::check(&mesh).err(), None);
        for post in WORLD.lattice.posts().step_by(7) {
            let plan = WORLD.lattice.position(post);
            let ground = plan.extend(WORLD.lattice.height(post) * 1.5);
            let Some(z) = terrain.displayed_z(plan.as_dvec2()) else { continue };
            let (Some(true_px), Some(shown_px)) = (camera.project(ground), camera.project(plan.extend(z as f32)))
            else { continue };
            let (width, height) = camera.size();
            let in_picture = (0.0..width as f32).contains(&true_px.pixel.x)
                && (0.0..height as f32).contains(&true_px.pixel.y)
                && true_px.depth_m > 30.0;
            let off = true_px.pixel.distance(shown_px.pixel);
            prop_assert!(!in_picture || off <= tolerance_px * 1.01, "{off} px at {post:?}");
        }
    }
}

#[test]
fn a_lake_is_perfectly_level_however_coarse_the_ground_around_it() {
    let mut lattice = hills();
    let shore: Vec<DVec2> =
        [(900.0, 800.0), (1700.0, 760.0), (2050.0, 1300.0), (1500.0, 1750.0), (980.0, 1500.0)]
            .map(DVec2::from)
            .into();
    leveling::level(&mut lattice, std::slice::from_ref(&shore), 371.25);
    let world = World::new(lattice);
    let mut plan = PlanMesh::default();
    area::fill(&shore, &[], 100.0, &mut plan);
    for tolerance_px in [0.5, 5.0, 500.0] {
        let camera = camera((1500.0, -3000.0, 2500.0), (1500.0, 1200.0)).expect("sound");
        let terrain = world.seen_by(&camera, tolerance_px);
        let lake = drape(&plan, &terrain);
        assert!(lake.triangles.len() >= plan.triangles.len());
        let levels: Vec<f32> = lake.vertices.iter().map(|vertex| vertex.position[2]).collect();
        assert!(levels.iter().all(|&z| z == 371.25 * 1.5), "tolerance {tolerance_px}");
        let area: f64 = lake
            .triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] =
                    triangle.map(|id| Vec3::from(lake.vertices[id.index()].position).as_dvec3().truncate());
                (b - a).perp_dot(c - a) / 2.0
            })
            .sum();
        assert!((area / plan.area_m2() - 1.0).abs() < 1e-4, "{area} of {}", plan.area_m2());
    }
}

#[test]
fn displayed_heights_lie_on_drawn_triangles_and_ground_heights_never_change() {
    let lattice = hills();
    let raster = Raster {
        driver: "AAIGrid",
        data_type: "Float32",
        width: COLUMNS,
        height: ROWS,
        samples: Samples::F32(lattice.heights().to_vec()),
        map_from_grid: DAffine2::IDENTITY,
        crs: None,
        georeferenced: false,
        ..Raster::without_place(1, 1)
    };
    let world = World::new(lattice);
    let service = HeightService::new(
        Arc::new(sandtable_terrain::query::source_raster::SourceRaster::from(Arc::new(raster))),
        Crs::local(),
        Arc::new(world.lattice.clone()),
    );
    let at: Vec<DVec2> = (0..4000)
        .map(|index| {
            world.lattice.origin() + DVec2::new(f64::from(index * 37 % 3570), f64::from(index * 53 % 2670))
        })
        .collect();
    let ask = |service: &HeightService, surface| {
        let mut answers = vec![Answer::NoData; at.len()];
        service.heights(surface, Interpolation::Planar, &at, &mut answers);
        answers
    };
    let ground = ask(&service, Surface::Ground);
    assert!(ask(&service, Surface::Displayed).iter().all(|answer| *answer == Answer::Outside));
    for tolerance_px in [0.5, 4.0, 60.0] {
        let camera = camera((1800.0, -2500.0, 1800.0), (1800.0, 1300.0)).expect("sound");
        let terrain = Arc::new(world.seen_by(&camera, tolerance_px));
        let showing = service.displaying(Arc::clone(&terrain) as Arc<dyn TriangleSurface>, 1.5);
        assert_eq!(ask(&showing, Surface::Ground), ground, "ground heights do not depend on what is drawn");
        for (&at, answer) in at.iter().zip(ask(&showing, Surface::Displayed)) {
            let drawn = terrain.displayed_z(at - world.lattice.origin()).map(|z| z / 1.5);
            assert_eq!(answer.height_m(), drawn);
        }
    }
}
