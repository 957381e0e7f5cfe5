//! Yu and Zhang: the constrained nested error criterion, dynamic terrain, the delay.

use std::collections::BTreeSet;

use glam::{DVec2, Vec3};
use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
use sandtable_earthworks::brush::{BrushChanges, Crater, TireTrack};
use sandtable_raster::warp::to_metric;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::block::BlockSource;
use sandtable_roam::block::WholeGround;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::dynamic::{DynamicOptions, DynamicTerrain, ErrorMeasure, Radius};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::midpoint::midpoint_error_at;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::measure::height_difference;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_roam::refine::deferred::Deferred;
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_roam::roughness::Roughness;
use sandtable_roam::shown::PatchList;
use sandtable_roam::spheres::{OwnRadius, SphereMap};
use sandtable_terrain::lattice::{Lattice, Post};

use crate::common::data::data;
use crate::papers::{World, camera, leaves, same};

const TOLERANCE_PX: f32 = 3.0;

/// r = λ · d · δ / τ.
fn own_radii(world: &World) -> Vec<f32> {
    let reach = camera(Vec3::ZERO, Vec3::Y).pixels_per_meter(1.0) / TOLERANCE_PX;
    world.errors.values().iter().map(|error_m| error_m * reach).collect()
}

#[test]
fn on_the_error_sphere_s_surface_an_error_spans_the_tolerance() {
    let world = World::hills(65, 65, 64);
    let own = own_radii(&world);
    let camera = camera(Vec3::ZERO, Vec3::Y * 10.0);
    for vertex in world.vertices() {
        let (index, error_m) = (world.layout.index(vertex), world.errors.at(&world.layout, vertex));
        if own[index] <= camera.planes().0 {
            continue;
        }
        let across = |off: f32| camera.project(Vec3::new(0.0, own[index], off)).map(|seen| seen.pixel.y);
        let (Some(low), Some(high)) = (across(-error_m * 0.5), across(error_m * 0.5)) else {
            panic!("{vertex:?} before the eye at {} m", own[index]);
        };
        assert!((low - high - TOLERANCE_PX).abs() < 1e-2, "{vertex:?}: {} px", low - high);
    }
}

#[test]
fn a_sphere_is_its_own_or_holds_those_of_its_children() {
    let world = World::hills(97, 65, 32);
    let (own, ground) = (own_radii(&world), world.ground());
    let map = SphereMap::nested(ground, own.clone());
    for vertex in world.vertices() {
        let center = ground.position(vertex);
        let below = vertex
            .children()
            .filter(|&child| world.layout.contains(child) && map.at(&world.layout, child) > 0.0)
            .map(|child| center.distance(ground.position(child)) + map.at(&world.layout, child))
            .fold(0f32, f32::max);
        let expected = own[world.layout.index(vertex)].max(below);
        let found = map.at(&world.layout, vertex);
        assert!((found - expected).abs() <= expected * 2e-6, "{vertex:?}: {found} against {expected}");
    }
}

#[test]
fn an_eye_inside_spheres_leaves_no_t_junction_without_any_forced_split() {
    let world = World::hills(97, 130, 32);
    let map = SphereMap::nested(world.ground(), own_radii(&world));
    for eye in [Vec3::new(300.0, 500.0, 60.0), Vec3::new(-400.0, 90.0, 300.0), Vec3::new(960.0, 1290.0, 5.0)]
    {
        let criterion = Spheres::new(world.ground(), &map, eye);
        let wanted: Vec<Vertex> =
            world.vertices().into_iter().filter(|&vertex| criterion.wants(vertex)).collect();
        for vertex in &wanted {
            for parent in vertex.parents().into_iter().filter(|&parent| world.layout.contains(parent)) {
                let there = world.layout.is_corner(parent) || criterion.wants(parent);
                assert!(there, "{vertex:?} without its parent {parent:?}");
            }
        }
        let mut directly = ActiveSet::new(world.layout);
        wanted.iter().for_each(|&vertex| directly.activate(vertex));
        assert_eq!(directly.count(), wanted.len(), "nothing was forced");
        assert!(directly == rebuild(&world.layout, &criterion, world.layout.patches()), "as by splits");
    }
}

#[test]
fn the_object_space_error_is_the_midpoint_s_height_less_the_mean_of_the_ends() {
    let world = World::hills(65, 49, 16);
    for vertex in world.vertices() {
        let [b, c] = vertex.hypotenuse().map(|end| world.height(end));
        let delta = (world.height(vertex) - (b + c) / 2.0).abs();
        let found = midpoint_error_at(&world.lattice, &world.layout, vertex);
        assert!(same(found, delta), "{vertex:?}: {found} against {delta}");
    }
}

#[test]
fn the_sphere_s_radius_is_the_screen_error_solved_for_the_distance() {
    let world = World::hills(65, 49, 16);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    // λ · d: pixels that a meter spans at a distance of one meter.
    let lambda_d = camera(Vec3::ZERO, Vec3::Y).pixels_per_meter(1.0);
    let own = OwnRadius::Plain { errors: &errors, reach: lambda_d / TOLERANCE_PX };
    for vertex in world.vertices().into_iter().filter(|&vertex| errors.at(&world.layout, vertex) > 0.0) {
        let (radius, delta) = (own.at(world.ground(), vertex), errors.at(&world.layout, vertex));
        let tau = |distance: f32| lambda_d * delta / distance;
        assert!(same(tau(radius), TOLERANCE_PX), "{vertex:?}: {} px", tau(radius));
        assert!(tau(radius * 0.99) > TOLERANCE_PX && tau(radius * 1.01) < TOLERANCE_PX);
    }
}

#[test]
fn roughness_is_the_mean_square_rise_in_the_window_and_k_grows_with_it() {
    // Level in the west, hills in the east.
    let world = World::new((65, 33), 32, |x, y| {
        (x - 24.0).max(0.0) * 0.4 * libm::sinf(x * 0.9) * libm::cosf(y * 0.8)
    });
    let roughness = Roughness::new(&world.lattice, (1, 1));
    let (mut level, mut hilly) = (0, 0);
    for post in world.lattice.posts() {
        let (column, row) = (i64::from(post.column), i64::from(post.row));
        let window = (-1..=1).flat_map(|x| (-1..=1).map(move |y| (column + x, row + y)));
        let inside: Vec<f64> = window
            .filter(|&(x, y)| (0..65).contains(&x) && (0..33).contains(&y))
            .map(|(x, y)| f64::from(world.lattice.height(Post { column: x as u32, row: y as u32 })))
            .collect();
        let z = f64::from(world.lattice.height(post));
        let f = inside.iter().map(|z_i| (z - z_i).powi(2)).sum::<f64>() / inside.len() as f64;
        assert!(same(roughness.at(post), f as f32), "{post:?}: {} against {f}", roughness.at(post));
        let k = roughness.factor(post);
        assert!((k - (1.0 - 1.0 / (f + 1.0))).abs() < 1e-5, "{post:?}: {k}");
        assert!(k > 0.0 && k < 1.0, "{post:?}: {k}");
        level += usize::from(k < 1e-5);
        hilly += usize::from(k > 0.9);
    }
    assert!(level >= 23 * 33 && hilly > 300, "{level} level posts, {hilly} hilly ones");
}

#[test]
fn the_constrained_radius_is_k_times_the_plain_one_and_is_nested_the_same_way() {
    let world = World::hills(97, 65, 32);
    let (ground, reach) = (world.ground(), 60.0);
    let roughness = Roughness::new(&world.lattice, (1, 1));
    let own = OwnRadius::Constrained { reach, roughness: &roughness };
    let map = SphereMap::constrained(ground, reach, &roughness);
    for vertex in world.vertices() {
        let k = roughness.factor(world.layout.post(vertex)) as f32;
        let plain = reach * midpoint_error_at(&world.lattice, &world.layout, vertex);
        assert!(same(own.at(ground, vertex), k * plain), "{vertex:?}: {k} of {plain}");
        let below = vertex
            .children()
            .filter(|&child| world.layout.contains(child) && map.at(&world.layout, child) > 0.0)
            .map(|child| {
                ground.position(vertex).distance(ground.position(child)) + map.at(&world.layout, child)
            });
        let nested = below.fold(k * plain, f32::max);
        assert!(same(map.at(&world.layout, vertex), nested), "{vertex:?}");
    }
    map.check(ground);
    let criterion = Spheres::new(ground, &map, Vec3::new(400.0, 300.0, 90.0));
    let mut directly = ActiveSet::new(world.layout);
    let wanted: Vec<Vertex> =
        world.vertices().into_iter().filter(|&vertex| criterion.wants(vertex)).collect();
    wanted.iter().for_each(|&vertex| directly.activate(vertex));
    assert!(wanted.len() > 100);
    assert_eq!(directly.count(), wanted.len(), "no split is ever forced");
}

#[test]
fn the_constraint_saves_triangles_on_flat_ground_and_hardly_any_on_rough() {
    let world = World::new((257, 129), 32, |x, y| {
        let height_m = if x > 140.0 { 9.0 } else { 0.25 };
        height_m * libm::sinf(x * 0.8) * libm::cosf(y * 0.7)
    });
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let roughness = Roughness::new(&world.lattice, (1, 1));
    let shown = |map: &SphereMap| {
        let criterion = Spheres::new(world.ground(), map, Vec3::new(1280.0, 640.0, 100.0));
        let leaves = leaves(&rebuild(&world.layout, &criterion, world.layout.patches()));
        let flat = leaves.iter().filter(|leaf| leaf.apex.x < 128).count();
        let rough = leaves.iter().filter(|leaf| leaf.apex.x > 160).count();
        (flat, rough)
    };
    let plain = shown(&SphereMap::plain(world.ground(), &errors, 1500.0));
    let constrained = shown(&SphereMap::constrained(world.ground(), 1500.0, &roughness));
    assert!(constrained.0 * 2 < plain.0, "on flat ground {} of {}", constrained.0, plain.0);
    assert!(constrained.1 * 10 >= plain.1 * 9, "on rough ground {} of {}", constrained.1, plain.1);
}

/// The triangles that two eyes see together, and the mean of |mesh − terrain| over all posts.
fn cost(lattice: &Lattice, layout: &PatchLayout, map: &SphereMap) -> (usize, f64) {
    let ground = PatchedGround { lattice, layout };
    let (far, top) = (lattice.extent().max.as_vec2(), lattice.height_range().1);
    let (mut triangles, mut off_m) = (0, 0.0);
    for share in [glam::Vec2::new(0.2, 0.3), glam::Vec2::new(0.75, 0.6)] {
        let eye = (far * share).extend(top + 100.0);
        let active = rebuild(layout, &Spheres::new(ground, map, eye), layout.patches());
        let lists: Vec<PatchList> =
            layout.patches().map(|corner| PatchList::bintree(ground, &active, corner)).collect();
        triangles += lists.iter().map(|list| list.triangles.len()).sum::<usize>();
        off_m += height_difference(lattice, layout, &lists, |_, _| Some(0.0))
            .mean_m()
            .expect("posts were measured")
            / 2.0;
    }
    (triangles, off_m)
}

#[test]
fn the_crater_is_shown_by_fewer_triangles_with_about_the_same_height_difference() {
    let Some(path) = data("scenes/crater_lake_bt/crater.bt") else { return };
    let companions = |name: &str| std::fs::read(name).ok();
    let hints = DemHints { companions: &companions, ..DemHints::default() };
    let bytes = std::fs::read(&path).expect("readable");
    let raster = read(&path.to_string_lossy(), &bytes, &hints).expect("readable");
    let lattice = Lattice::from_raster(&to_metric(&raster, None).expect("it has a place")).expect("ground");
    let layout = PatchLayout::new(lattice.columns(), lattice.rows(), 64).expect("sound");
    let ground = PatchedGround { lattice: &lattice, layout: &layout };
    let errors = ErrorMap::midpoint(&lattice, &layout);
    let roughness = Roughness::new(&lattice, (1, 1));
    let plain = cost(&lattice, &layout, &SphereMap::plain(ground, &errors, 150.0));
    let constrained = cost(&lattice, &layout, &SphereMap::constrained(ground, 150.0, &roughness));
    assert!(constrained.0 * 100 < plain.0 * 98, "{constrained:?} against {plain:?}");
    assert!(constrained.1 < plain.1 * 1.1, "{constrained:?} against {plain:?}");
    // Where the constrained spheres reach as far as the same difference takes, they save nothing: crater walls need
    // more for it than k leaves out on the flats.
    let further = cost(&lattice, &layout, &SphereMap::constrained(ground, 165.0, &roughness));
    assert!(further.1 < plain.1 && further.0 * 100 < plain.0 * 115, "{further:?} against {plain:?}");
}

const OPTIONS: DynamicOptions = DynamicOptions {
    patch: 32,
    measure: ErrorMeasure::Midpoint,
    radius: Radius::Constrained((1, 1)),
    reach: 30.0,
};

fn dynamic() -> DynamicTerrain {
    DynamicTerrain::new(World::hills(129, 129, 32).lattice, OPTIONS).expect("sound")
}

fn crater(lattice: &mut Lattice) -> BrushChanges {
    Crater { center: DVec2::new(523.0, 617.0), radius_m: 45.0, depth_m: 9.0, rim_m: 2.0 }.apply(lattice)
}

fn tire_track(lattice: &mut Lattice) -> BrushChanges {
    let line = vec![DVec2::new(690.0, 40.0), DVec2::new(880.0, 95.0), DVec2::new(940.0, 410.0)];
    TireTrack { line, gauge_m: 20.0, rut_m: 14.0, depth_m: 0.3 }.apply(lattice)
}

#[test]
fn after_a_crater_and_a_tire_track_errors_and_spheres_are_those_computed_anew() {
    let mut terrain = dynamic();
    for brush in [crater as fn(&mut Lattice) -> BrushChanges, tire_track, crater] {
        terrain.edit(brush).expect("it digs");
        let anew = DynamicTerrain::new((**terrain.lattice()).clone(), OPTIONS).expect("sound");
        assert!(terrain.errors() == anew.errors() && terrain.spheres() == anew.spheres());
        terrain.spheres().check(terrain.ground());
    }
}

#[test]
fn recomputation_climbs_from_deformed_vertices_until_no_sphere_changes() {
    let mut terrain = dynamic();
    for brush in [crater as fn(&mut Lattice) -> BrushChanges, tire_track] {
        let before = terrain.clone();
        let edit = terrain.edit(brush).expect("it digs");
        let layout = *terrain.layout();
        let changed: BTreeSet<Vertex> = edit.vertices.iter().copied().collect();
        let deformed = |vertex: Vertex| {
            let post = layout.post(vertex);
            before.lattice().height(post) != terrain.lattice().height(post)
        };
        let mut stopped = 0;
        for &vertex in &changed {
            let [from, to] = vertex.hypotenuse();
            let window = (-1..=1).flat_map(|x| (-1..=1).map(move |y| vertex.moved(x, y)));
            let own = window.chain([from, to]).filter(|&near| layout.contains(near)).any(deformed);
            let below = vertex.children().any(|child| changed.contains(&child));
            assert!(own || below, "{vertex:?} changed, and nothing that it depends on");
            let above = vertex.parents().into_iter().filter(|&parent| layout.contains(parent));
            stopped += above.filter(|parent| !changed.contains(parent)).count();
        }
        assert!(changed.len() * 20 < layout.vertex_count(), "{} vertices changed", changed.len());
        assert!(stopped > 20, "{stopped} ancestors are as they were");
        assert!(changed.iter().any(|&vertex| !deformed(vertex)), "ancestors that were not deformed");
    }
}

#[test]
fn the_constraint_saves_triangles_on_deformed_ground_too() {
    let eye = Vec3::new(600.0, 600.0, 80.0);
    let shown = |radius: Radius| {
        let plain = World::new((129, 129), 32, |x, y| 0.25 * libm::sinf(x * 0.8) * libm::cosf(y * 0.7));
        let options = DynamicOptions { radius, reach: 600.0, ..OPTIONS };
        let mut terrain = DynamicTerrain::new(plain.lattice, options).expect("sound");
        terrain.edit(|lattice| crater(lattice).and(tire_track(lattice))).expect("it digs");
        let criterion = Spheres::new(terrain.ground(), terrain.spheres(), eye);
        let layout = terrain.layout();
        let active = rebuild(layout, &criterion, layout.patches());
        let crater = |leaf: &&Triangle| (leaf.apex.x - 52).abs() < 4 && (leaf.apex.y - 62).abs() < 4;
        let all = leaves(&active);
        (all.len(), all.iter().filter(crater).count())
    };
    let (plain, constrained) = (shown(Radius::Plain), shown(Radius::Constrained((1, 1))));
    assert!(constrained.0 * 3 < plain.0 * 2, "{} triangles of {}", constrained.0, plain.0);
    assert!(constrained.1 * 10 >= plain.1 * 9, "{} of {} in the crater", constrained.1, plain.1);
}

/// All that a mesh following an eye is made of.
struct Walk<'a> {
    ground: PatchedGround<'a>,
    spheres: &'a SphereMap,
    patches: Vec<Vertex>,
    mesh: Deferred<WholeGround<'a>>,
}

impl<'a> Walk<'a> {
    fn new(ground: PatchedGround<'a>, spheres: &'a SphereMap) -> Self {
        let mesh = Deferred::new(WholeGround { ground, spheres }, 10.0).expect("small patches");
        Self { ground, spheres, patches: ground.layout.patches().collect(), mesh }
    }

    /// Moves the eye; returns how many vertices were looked at and how many changed.
    fn go(&mut self, eye: Vec3) -> (usize, usize) {
        self.mesh.update(eye, &self.patches).expect("in memory");
        self.mesh.check();
        let criterion = Spheres::new(self.ground, self.spheres, eye);
        let built = rebuild(self.ground.layout, &criterion, self.ground.layout.patches());
        assert!(self.mesh.active_set() == built, "at {eye}");
        (self.mesh.examined(), self.mesh.changes().splits + self.mesh.changes().merges)
    }
}

#[test]
fn no_vertex_is_looked_at_before_the_eye_can_have_reached_its_sphere_s_surface() {
    let world = World::hills(129, 129, 32);
    let spheres = SphereMap::plain(world.ground(), &world.errors, 40.0);
    let start = Vec3::new(500.0, 420.0, 60.0);
    let is_shared = |vertex: &Vertex| vertex.x % 32 == 0 || vertex.y % 32 == 0;
    for step_m in [0.01, 0.3, 2.0, 9.0] {
        let mut walk = Walk::new(world.ground(), &spheres);
        walk.go(start);
        // The wheel hands out up to a sixteenth of the way early, and counts in ticks of less than a meter.
        let reached_m = step_m * 16.0 / 15.0 + 1.5;
        let reached = |vertex: &Vertex| {
            let radius = spheres.at(&world.layout, *vertex);
            radius > 0.0 && (world.ground().position(*vertex).distance(start) - radius).abs() < reached_m
        };
        let near = world.vertices().into_iter().filter(reached);
        // Each patch looks at the vertices on its own border.
        let near: usize = near.map(|vertex| 1 + usize::from(is_shared(&vertex))).sum();
        let (examined, changed) = walk.go(start + Vec3::new(step_m, 0.0, 0.0));
        // A vertex that changes has up to four children, or two parents, that can change only now; in each patch.
        assert!(examined <= near + 8 * changed, "{examined} of {near} near, {changed} changed in {step_m} m");
        let all = world.vertices().len();
        assert!((near + 8 * changed) * 5 < all, "{near} of {all} could have been reached in {step_m} m");
    }
}

#[test]
fn the_delay_saves_most_of_the_looks_and_shows_the_same_mesh_in_every_frame() {
    let world = World::hills(129, 129, 32);
    let spheres = SphereMap::plain(world.ground(), &world.errors, 40.0);
    let mut walk = Walk::new(world.ground(), &spheres);
    let at = |frame: u16| Vec3::new(200.0 + f32::from(frame), 420.0 + 0.4 * f32::from(frame), 60.0);
    walk.go(at(0));
    let (mut examined, mut without_delay) = (0, 0);
    for frame in 1..200 {
        examined += walk.go(at(frame)).0;
        without_delay += walk.mesh.active_set().count();
    }
    assert!(examined * 5 < without_delay, "{examined} looks, {without_delay} active vertices");
}

#[test]
fn deformed_vertices_are_looked_at_at_once_whatever_their_delay() {
    let before = dynamic();
    let mut after = before.clone();
    let edit = after.edit(crater).expect("it digs");
    let eye = Vec3::new(530.0, 600.0, 45.0);
    let mut walk = Walk::new(before.ground(), before.spheres());
    walk.go(eye);
    assert_eq!(walk.go(eye), (0, 0), "an eye at rest looks at nothing");
    (walk.ground, walk.spheres) = (after.ground(), after.spheres());
    *walk.mesh.source_mut() = WholeGround { ground: after.ground(), spheres: after.spheres() };
    walk.mesh.edit(&edit.patches).expect("in memory");
    let (examined, changed) = walk.go(eye);
    assert!(changed > 0, "the crater is shown at once");
    let most = 2 * edit.vertices.len() + 8 * changed;
    assert!(examined <= most, "{examined} looks for {} vertices of the edit", edit.vertices.len());
    assert_eq!(walk.go(eye), (0, 0));
}
