//! The restricted quadtree on the same graph.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use glam::Vec3;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::anisotropic::Anisotropic;
use sandtable_roam::criterion::screen::ScreenError;
use sandtable_roam::culling::patches_in_view;
use sandtable_roam::emit::{bintree, quadtree};
use sandtable_roam::errors::ErrorMap;
use sandtable_roam::errors::midpoint::midpoint_error_at;
use sandtable_roam::graph::{Vertex, VertexKind};
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::quadtree::{Address, NodeSide, NodeSquare, QuadNode, SIDES};
use sandtable_roam::refine::rebuild::rebuild;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

use crate::papers::{World, camera, leaves, same};

/// All nodes of a patch.
fn nodes((east, north): (i32, i32), patch: i32) -> Vec<(QuadNode, NodeSquare)> {
    let (mut found, mut stack) = (Vec::new(), vec![QuadNode { east, north, address: Address::ROOT }]);
    while let Some(node) = stack.pop() {
        if let Some(square) = node.square(patch) {
            found.push((node, square));
            stack.extend((0..4).filter_map(|digit| node.child(digit)));
        }
    }
    found
}

#[test]
fn blocks_of_32_cells_cover_a_terrain_that_is_not_square() {
    let layout = PatchLayout::new(4097, 2049, 32).expect("sound");
    assert_eq!((layout.patch_count(), layout.columns(), layout.rows()), (128 * 64, 4097, 2049));
}

#[test]
fn an_edge_vertex_depends_on_two_centers_and_a_center_on_two_corners() {
    for (x, y) in (1..64).flat_map(|x| (1..64).map(move |y| (x, y))) {
        let vertex = Vertex::new(x, y);
        let (step, [one, other]) = (vertex.step(), vertex.parents());
        if step == 32 {
            continue;
        }
        match vertex.kind() {
            VertexKind::Center => {
                let [from, to] = vertex.hypotenuse();
                assert_eq!(one.middle(other), vertex, "two corners of one diagonal");
                let (across, along) = ((other.x - one.x, other.y - one.y), (to.x - from.x, to.y - from.y));
                assert_eq!(across.0 * along.0 + across.1 * along.1, 0, "perpendicular to the other");
                // The parent square's center is the one end of the hypotenuse that is a center itself.
                let side = 4 * step;
                let parent = Vertex::new(x / side * side + side / 2, y / side * side + side / 2);
                let (dx, dy) = (parent.x - x, parent.y - y);
                assert_eq!(across.0 * dx + across.1 * dy, 0, "{vertex:?}: the line to the parent's center");
            }
            _ => {
                let centers = [one, other].map(|parent| (parent.kind(), parent.step()));
                assert_eq!(centers, [(VertexKind::Center, step); 2], "{vertex:?}");
            }
        }
    }
}

#[test]
fn restrictions_are_applied_until_nothing_more_is_activated() {
    let mut active = ActiveSet::new(PatchLayout::new(129, 65, 32).expect("sound"));
    for (x, y) in [(1, 1), (77, 33), (128, 64), (63, 20)] {
        active.activate(Vertex::new(x, y));
        active.check();
    }
}

#[test]
fn a_node_stores_five_vertices_and_each_has_an_error_of_its_own() {
    let world = World::hills(65, 65, 32);
    let own = |vertex| midpoint_error_at(&world.lattice, &world.layout, vertex);
    let off = |vertex: Vertex, (dx, dy): (i32, i32)| {
        let [one, other] = [vertex.moved(dx, dy), vertex.moved(-dx, -dy)].map(|end| world.height(end));
        (world.height(vertex) - (one + other) / 2.0).abs()
    };
    let (mut nodes_seen, mut larger) = (0, 0);
    for (node, square) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().flat_map(|at| nodes(at, 32)) {
        let half = square.side / 2;
        let [center, west, south, east, north] = square.vertices();
        for (vertex, along) in [(west, (0, half)), (east, (0, half)), (south, (half, 0)), (north, (half, 0))]
        {
            assert!(same(own(vertex), off(vertex, along)), "{node}: edge vertex {vertex:?}");
        }
        // The paper takes the larger of both diagonals. On the vertex graph a center is the middle of one of them, the
        // hypotenuse of the triangles it splits; no triangle ever has the other, and its error is not counted.
        let diagonals = [off(center, (half, half)), off(center, (half, -half))];
        let rises = center.hypotenuse().contains(&square.corner);
        assert!(same(own(center), diagonals[usize::from(!rises)]), "{node}: center");
        assert!(own(center) <= diagonals[0].max(diagonals[1]) * 1.0001 + 1e-5, "{node}: center");
        larger += usize::from(own(center) < diagonals[0].max(diagonals[1]) * 0.99);
        nodes_seen += 1;
    }
    assert_eq!(nodes_seen, 4 * (1 + 4 + 16 + 64 + 256));
    assert!(larger > 100, "the diagonal that no triangle has would count more in {larger} nodes");
}

#[test]
fn addresses_in_base_4_tell_the_parent_the_children_and_the_neighbors() {
    let patch = 32;
    let all: BTreeMap<String, NodeSquare> =
        nodes((0, 0), patch).into_iter().map(|(node, square)| (node.address.to_string(), square)).collect();
    for (digits, square) in &all {
        let address = Address::parse(digits).expect("digits from 0 to 3");
        let up = digits.len().checked_sub(1).map(|last| digits[..last].to_string());
        assert_eq!(address.parent().map(|parent| parent.to_string()), up, "the parent drops a digit");
        for digit in 0..4 {
            let child = address.child(digit).expect("not the deepest").to_string();
            assert_eq!(child, format!("{digits}{digit}"), "a child appends one");
            if let Some(below) = all.get(&child) {
                let (dx, dy) = ((digit & 1) as i32, (digit >> 1) as i32);
                let corner = square.corner.moved(dx * below.side, dy * below.side);
                assert_eq!(*below, NodeSquare { corner, side: square.side / 2 });
            }
        }
        for side in SIDES {
            let node = QuadNode { east: 0, north: 0, address };
            let (dx, dy) = side.step();
            let beyond =
                NodeSquare { corner: square.corner.moved(dx * square.side, dy * square.side), ..*square };
            assert_eq!(node.neighbor(side).square(patch), Some(beyond), "{digits} {side:?}");
        }
    }
    let by_hand = QuadNode { east: 0, north: 0, address: Address::parse("021").expect("digits") };
    assert_eq!(by_hand.neighbor(NodeSide::East).to_string(), "0,0:030");
    assert_eq!(by_hand.neighbor(NodeSide::North).to_string(), "0,0:023");
}

#[test]
fn the_screen_space_error_knows_the_viewing_direction() {
    let world = World::hills(33, 33, 32);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let (near_m, tolerance_px) = (4.0, 2.5);
    for eye in [Vec3::new(-60.0, 40.0, 90.0), Vec3::new(150.0, 170.0, 55.0), Vec3::new(400.0, 10.0, 700.0)] {
        let camera = Camera::new(eye, Vec3::new(160.0, 160.0, 0.0), 0.8, (1024, 768), (near_m, 9000.0));
        let camera = camera.expect("sound");
        // λ: pixels a meter spans on the near plane, which is n away.
        let lambda_n = camera.pixels_per_meter(near_m) * near_m;
        let criterion = Anisotropic::new(world.ground(), &errors, &camera, tolerance_px);
        for vertex in world.vertices() {
            let (delta, v) = (errors.at(&world.layout, vertex), world.ground().position(vertex));
            let level = (v.x - eye.x).powi(2) + (v.y - eye.y).powi(2);
            let squared = lambda_n.powi(2) * delta.powi(2) * level / (level + (v.z - eye.z).powi(2)).powi(2);
            let found_px = criterion.excess(vertex) * tolerance_px;
            assert!(same(found_px, squared.sqrt()), "{vertex:?}: {found_px} against {}", squared.sqrt());
            if (squared.sqrt() / tolerance_px - 1.0).abs() > 1e-3 {
                assert_eq!(criterion.wants(vertex), squared.sqrt() > tolerance_px, "dropped at or below τ");
            }
        }
    }
}

#[test]
fn looking_straight_down_at_a_bump_shrinks_it_to_nothing() {
    let world = World::new((17, 17), 16, |x, y| if (x, y) == (8.0, 8.0) { 5.0 } else { 0.0 });
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let bump = Vertex::new(8, 8);
    let top = world.ground().position(bump);
    let excess_px = |offset: Vec3| {
        let camera = camera(top + offset, top);
        Anisotropic::new(world.ground(), &errors, &camera, 1.0).excess(bump)
    };
    assert_eq!(excess_px(Vec3::Z * 50.0), 0.0);
    let tilts = [0.1f32, 0.5, 1.0, 1.5]
        .map(|tilt| excess_px(Vec3::new(50.0 * libm::sinf(tilt), 0.0, 50.0 * libm::cosf(tilt))));
    assert!(tilts[0] > 0.0 && tilts.windows(2).all(|pair| pair[0] < pair[1]), "{tilts:?}");
}

/// Triangles, each from its lowest corner on.
fn set(triangles: &[[Vertex; 3]]) -> BTreeSet<[Vertex; 3]> {
    let from_lowest = |&[a, b, c]: &[Vertex; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    triangles.iter().filter_map(from_lowest).collect()
}

fn quadtree_of(active: &ActiveSet) -> Vec<[Vertex; 3]> {
    let mut found = Vec::new();
    quadtree::triangles(active, active.layout().patches(), |corners| found.push(corners));
    found
}

fn bintree_of(active: &ActiveSet) -> Vec<[Vertex; 3]> {
    let mut found = Vec::new();
    bintree::triangles(active, active.layout().patches(), |corners| found.push(corners));
    found
}

#[test]
fn six_patterns_and_their_quarter_turns_triangulate_every_state_of_a_node() {
    let quarter_turn = |triangles: &BTreeSet<[Vertex; 3]>| {
        let turned = |&corners: &[Vertex; 3]| corners.map(|at| Vertex::new(2 - at.y, at.x));
        set(&triangles.iter().map(turned).collect::<Vec<_>>())
    };
    let layout = PatchLayout::new(3, 3, 2).expect("sound");
    let edges = SIDES.map(|side| NodeSquare { corner: Vertex::new(0, 0), side: 2 }.edge(side));
    let mut patterns = BTreeSet::new();
    for state in 0..16 {
        let mut active = ActiveSet::new(layout);
        active.activate(Vertex::new(1, 1));
        let there: Vec<Vertex> = edges
            .into_iter()
            .enumerate()
            .filter(|(bit, _)| state >> bit & 1 == 1)
            .map(|(_, at)| at)
            .collect();
        there.iter().for_each(|&edge| active.activate(edge));
        let triangles = quadtree_of(&active);
        assert_eq!(triangles.len(), 4 + there.len(), "state {state:#06b}");
        assert_eq!(set(&triangles), set(&bintree_of(&active)), "state {state:#06b}");
        let first = set(&triangles);
        let turns = std::iter::successors(Some(first), |last| Some(quarter_turn(last))).take(4);
        patterns.extend(turns.min());
    }
    assert_eq!(patterns.len(), 6);
}

#[test]
fn the_quadtree_s_triangles_from_the_top_down_are_the_bintree_s() {
    let world = World::hills(129, 97, 32);
    let camera = camera(Vec3::new(200.0, 100.0, 120.0), Vec3::new(700.0, 600.0, 0.0));
    for tolerance_px in [1.0, 4.0, 30.0] {
        let criterion = Anisotropic::new(world.ground(), &world.errors, &camera, tolerance_px);
        let active = rebuild(&world.layout, &criterion, world.layout.patches());
        let (by_nodes, by_halves) = (quadtree_of(&active), bintree_of(&active));
        assert_eq!(by_nodes.len(), by_halves.len());
        assert_eq!(set(&by_nodes), set(&by_halves), "{tolerance_px} px");
    }
}

/// A criterion that writes down of which vertices it was asked.
struct Listening<C> {
    criterion: C,
    asked: Mutex<Vec<Vertex>>,
}

impl<C: Criterion> Criterion for Listening<C> {
    fn excess(&self, vertex: Vertex) -> f32 {
        self.asked.lock().expect("one thread").push(vertex);
        self.criterion.excess(vertex)
    }
}

#[test]
fn nodes_outside_the_frustum_are_not_visited() {
    let world = World::hills(257, 129, 32);
    let camera = camera(Vec3::new(1280.0, 640.0, 90.0), Vec3::new(2500.0, 900.0, 0.0));
    let frustum = Frustum::new(&camera);
    let in_view = |vertex| {
        let found = world.heights.diamond(world.ground(), vertex);
        found.is_some_and(|(min, max)| frustum.may_see(min, max))
    };
    let visited = |patches: Vec<Vertex>| {
        let criterion = ScreenError::new(world.ground(), &world.errors, &world.heights, &camera, 0.5);
        let listening = Listening { criterion, asked: Mutex::default() };
        rebuild(&world.layout, &listening, patches.iter().copied());
        let roots = patches.iter().flat_map(|&corner| Triangle::roots(corner, world.layout.patch()));
        let roots: BTreeSet<Vertex> = roots.map(|root| root.split_vertex()).collect();
        let asked = listening.asked.into_inner().expect("one thread");
        asked.into_iter().filter(|vertex| !roots.contains(vertex)).collect::<Vec<_>>()
    };
    let of_all = visited(world.layout.patches().collect());
    for vertex in &of_all {
        let from_above = vertex.parents().into_iter().any(|parent| {
            world.layout.contains(parent) && !world.layout.is_corner(parent) && in_view(parent)
        });
        assert!(from_above, "{vertex:?} was asked about below what is out of view");
    }
    let of_seen = visited(patches_in_view(world.ground(), &world.heights, &frustum));
    assert_eq!(of_all.len(), of_seen.len(), "patches out of view have no node that is visited");
    let vertices = world.vertices().len();
    assert!(of_seen.len() > 1000 && of_seen.len() < vertices, "{} of {vertices}", of_seen.len());
}

#[test]
fn a_tolerance_of_two_percent_takes_fewer_triangles_than_one_and_a_half() {
    let world = World::hills(513, 257, 32);
    let errors = ErrorMap::midpoint(&world.lattice, &world.layout);
    let camera = camera(Vec3::new(-300.0, -200.0, 400.0), Vec3::new(2000.0, 1200.0, 0.0));
    let seen = patches_in_view(world.ground(), &world.heights, &Frustum::new(&camera));
    let triangles = |share: f32| {
        let criterion = Anisotropic::new(world.ground(), &errors, &camera, share * 768.0);
        leaves(&rebuild(&world.layout, &criterion, seen.iter().copied())).len()
    };
    let (coarse, fine) = (triangles(0.020), triangles(0.015));
    let least = 2 * world.layout.patch_count();
    assert!(least < coarse && coarse * 10 < fine * 9, "{least} at least, {coarse} at 2.0 %, {fine} at 1.5 %");
}
