//! 004: the digital terrain model.

use std::sync::Arc;

use glam::{DVec2, Vec3};
use sandtable::draw::list::DrawMesh;
use sandtable::geom::polyline::Polyline;
use sandtable::ribbon::drape::{check_clearance, drape};
use sandtable::ribbon::plan::PlanMesh;
use sandtable::ribbon::stroke::{StrokeOptions, stroke};
use sandtable::roam::criterion::screen::ScreenError;
use sandtable::roam::displayed::DisplayedTerrain;
use sandtable::roam::refine::rebuild::rebuild;
use sandtable::terrain::facets::Facets;
use sandtable::terrain::query::{Interpolation, ground_height};

use crate::{World, camera};

#[test]
fn paper_004_a_cell_is_read_as_a_constant_or_by_the_distances_to_the_four_around() {
    let world = World::new((3, 3), 2, |x, y| x * 10.0 + y * y * 7.0);
    let ask = |interpolation, x: f64, y: f64| {
        ground_height(&world.lattice, interpolation, DVec2::new(x, y)).height_m().expect("on the ground")
    };
    assert_eq!(ask(Interpolation::Nearest, 4.9, 0.0), 0.0);
    assert_eq!(ask(Interpolation::Nearest, 5.1, 0.0), 10.0, "the surface jumps between cells");
    let at = DVec2::new(3.0, 4.0);
    let corners = [(0.0, 0.0, 0.0), (10.0, 0.0, 10.0), (0.0, 10.0, 7.0), (10.0, 10.0, 17.0)];
    let weighted = corners.map(|(x, y, z)| (1.0 / at.distance(DVec2::new(x, y)), z));
    let (weights, sum) = weighted.iter().fold((0.0, 0.0), |(w, s), (weight, z)| (w + weight, s + weight * z));
    let found = ask(Interpolation::DistanceWeighted4, at.x, at.y);
    assert!((found - sum / weights).abs() < 1e-9, "{found} against {}", sum / weights);
    assert_eq!(ask(Interpolation::DistanceWeighted4, 10.0, 10.0), 17.0, "a post is itself");
}

#[test]
fn paper_004_features_get_their_elevation_from_the_ground_that_roam_built() {
    let world = World::hills(97, 97, 32);
    let camera = camera(Vec3::new(100.0, 100.0, 120.0), Vec3::new(600.0, 600.0, 0.0));
    let criterion = ScreenError::new(world.ground(), &world.errors, &world.heights, &camera, 4.0);
    let active = rebuild(&world.layout, &criterion, world.layout.patches());
    let patches = world.layout.patches().collect();
    let displayed = DisplayedTerrain::new(Arc::new(world.lattice.clone()), active, 1.0, patches);

    let line =
        Polyline::new(vec![DVec2::new(50.0, 80.0), DVec2::new(400.0, 300.0), DVec2::new(900.0, 820.0)], 0.01)
            .expect("a line");
    let mut plan = PlanMesh::default();
    stroke(&line, &StrokeOptions { width_m: 12.0, ..StrokeOptions::default() }, &mut plan);
    assert!(!plan.triangles.is_empty(), "triangles from centreline and width");
    let mut draped = DrawMesh::default();
    drape(&plan, &displayed, &mut draped);
    assert!(draped.triangles.len() > plan.triangles.len(), "cut by the ground");
    assert!(check_clearance(&draped, &displayed) < 1e-3, "it lies on the ground that is shown");
    let model = displayed.displayed_z(DVec2::new(444.0, 333.0)).expect("on the ground");
    assert!(model.abs() < 60.0, "a model's foot stands at {model} m");
}
