//! Every refiner with every criterion, on terrains of any shape and along any way: what each promises of its mesh.

mod criteria;
mod terrain;

use std::collections::BTreeSet;

use glam::Vec3;
use proptest::prelude::*;
use sandtable_roam::active::ActiveSet;
use sandtable_roam::bintree::Triangle;
use sandtable_roam::criterion::Criterion;
use sandtable_roam::criterion::spheres::Spheres;
use sandtable_roam::emit::bintree;
use sandtable_roam::emit::world::drawn_posts;
use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::refine::changes::RefinementChanges;
use sandtable_roam::refine::coherent::{Coherent, Hidden};
use sandtable_roam::refine::queues::{Goal, MOST_LEAVES, Queues};
use sandtable_roam::refine::rebuild::{rebuild, rebuild_by_parts};
use terrain::{MONOTONE, Terrain, flights, terrains};

const CRITERIA: usize = 8;

/// What an update must report of the step from one mesh to the next.
fn changes_between(terrain: &Terrain, before: &ActiveSet, after: &ActiveSet) -> RefinementChanges {
    let layout = &terrain.layout;
    let mut changes = RefinementChanges::default();
    for vertex in terrain.vertices().filter(|&vertex| before.is_active(vertex) != after.is_active(vertex)) {
        if after.is_active(vertex) {
            changes.splits += 1;
        } else {
            changes.merges += 1;
        }
        changes.dirty.extend(patches_at(layout, vertex));
    }
    changes.dirty.sort_unstable();
    changes.dirty.dedup();
    changes
}

/// Whether a report tells of a step and, at most, of changes that were taken back on the way.
fn covers(told: &RefinementChanges, step: &RefinementChanges) -> bool {
    let net = |changes: &RefinementChanges| changes.splits as i64 - changes.merges as i64;
    net(told) == net(step)
        && told.splits >= step.splits
        && step.dirty.iter().all(|patch| told.dirty.contains(patch))
}

/// The patches whose square holds the vertex.
fn patches_at(layout: &PatchLayout, vertex: Vertex) -> impl Iterator<Item = usize> {
    let side = layout.patch();
    let holds = move |corner: &Vertex| {
        (corner.x..=corner.x + side).contains(&vertex.x) && (corner.y..=corner.y + side).contains(&vertex.y)
    };
    layout.patches().enumerate().filter(move |(_, corner)| holds(corner)).map(|(place, _)| place)
}

/// How many triangles the bits draw, and how many leaves there are.
fn triangles(terrain: &Terrain, active: &ActiveSet, patches: &[Vertex]) -> (usize, usize) {
    let (mut drawn, mut leaves) = (0, 0);
    bintree::triangles(active, patches.iter().copied(), |corners| {
        leaves += 1;
        drawn += usize::from(drawn_posts(terrain.ground(), corners).is_some());
    });
    (drawn, leaves)
}

/// The vertices whose triangles in these patches, or what these can be split into, have something to draw.
fn showing(terrain: &Terrain, patches: &[Vertex]) -> BTreeSet<Vertex> {
    let mut found = BTreeSet::new();
    for root in patches.iter().flat_map(|&corner| Triangle::roots(corner, terrain.layout.patch())) {
        let mut stack = vec![vec![root]];
        while let Some(way) = stack.pop() {
            let triangle = way[way.len() - 1];
            if drawn_posts(terrain.ground(), triangle.corners()).is_some() {
                let splits = way.iter().filter(|triangle| !triangle.is_finest());
                found.extend(splits.map(Triangle::split_vertex));
            }
            if !triangle.is_finest() {
                stack.extend(triangle.split().map(|half| [way.as_slice(), &[half]].concat()));
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn forced_splits_and_merges_give_the_mesh_of_a_rebuild_after_every_frame(
        terrain in terrains(), flight in flights(), which in 0..CRITERIA,
    ) {
        let mut refiner = Coherent::new(terrain.layout);
        for (frame, camera) in flight.iter().enumerate() {
            let (name, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            let before = refiner.active().clone();
            let changes = refiner.update(&criterion, &patches);
            let anew = rebuild(&terrain.layout, &criterion, patches.iter().copied());
            prop_assert_eq!(refiner.active(), &anew, "{} in frame {}", name, frame);
            prop_assert_eq!(&rebuild_by_parts(&terrain.layout, &criterion, &patches), &anew, "on all threads");
            refiner.check();
            prop_assert_eq!(changes, changes_between(&terrain, &before, &anew));
            prop_assert_eq!(refiner.update(&criterion, &patches), RefinementChanges::default(), "at rest");
        }
    }

    #[test]
    fn hidden_patches_that_are_kept_are_adjusted_when_they_are_seen_again(
        terrain in terrains(), flight in flights(), which in 0..CRITERIA,
    ) {
        let mut refiner = Coherent::with_hidden(terrain.layout, Hidden::Keep);
        let all: Vec<Vertex> = terrain.layout.patches().collect();
        for (frame, camera) in flight.iter().enumerate() {
            let (name, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            refiner.update(&criterion, &patches);
            refiner.check();
            let anew = rebuild(&terrain.layout, &criterion, patches.iter().copied());
            let finer = |vertex: &Vertex| anew.is_active(*vertex) && !refiner.active().is_active(*vertex);
            prop_assert_eq!(terrain.vertices().find(finer), None, "{} in frame {}", name, frame);
        }
        let camera = flight.last().expect("two frames at least");
        let (_, criterion) = terrain.criteria(camera, 0).swap_remove(which);
        refiner.update(&criterion, &all);
        prop_assert_eq!(refiner.active(), &rebuild(&terrain.layout, &criterion, all));
    }

    #[test]
    fn queues_without_a_budget_give_a_rebuild_s_mesh_for_monotone_criteria(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(), most in 0usize..2,
    ) {
        let goal = [Goal::Tolerance, Goal::ToleranceWithin(1 << 20)][most];
        let mut refiner = Queues::new(terrain.ground(), goal);
        for (frame, camera) in flight.iter().enumerate() {
            let mut criteria = terrain.criteria(camera, frame as u32);
            let (name, criterion) = criteria.swap_remove(which);
            prop_assert_eq!(name, MONOTONE[which]);
            let patches = terrain.in_view(camera);
            let before = refiner.active().clone();
            let changes = refiner.update(&criterion, &patches);
            let anew = rebuild(&terrain.layout, &criterion, patches.iter().copied());
            prop_assert_eq!(refiner.active(), &anew, "{} in frame {}", name, frame);
            refiner.check();
            prop_assert!(covers(&changes, &changes_between(&terrain, &before, &anew)));
            prop_assert_eq!((refiner.triangles(), refiner.leaves()), triangles(&terrain, &anew, &patches));
        }
    }

    #[test]
    fn the_queues_never_draw_more_triangles_than_their_budget(
        terrain in terrains(), flight in flights(), which in 0..CRITERIA,
        budget in 0usize..900, capped in 0usize..2,
    ) {
        let goal = [Goal::Budget(budget), Goal::ToleranceWithin(budget)][capped];
        let mut refiner = Queues::new(terrain.ground(), goal);
        let mut again = Queues::new(terrain.ground(), goal);
        for (frame, camera) in flight.iter().enumerate() {
            let (name, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            let before = refiner.active().clone();
            let changes = refiner.update(&criterion, &patches);
            refiner.check();
            let (drawn, leaves) = triangles(&terrain, refiner.active(), &patches);
            prop_assert_eq!((refiner.triangles(), refiner.leaves()), (drawn, leaves));
            let roots = 2 * patches.len();
            prop_assert!(drawn <= budget.max(roots), "{}: {}", name, drawn);
            prop_assert!(leaves <= MOST_LEAVES * budget + roots, "{}: {}", name, leaves);
            prop_assert!(covers(&changes, &changes_between(&terrain, &before, refiner.active())));
            prop_assert_eq!(again.update(&criterion, &patches), changes, "the same way, the same bits");
            prop_assert_eq!(again.active(), refiner.active());
        }
    }

    #[test]
    fn a_budget_that_the_view_cannot_use_splits_all_that_shows_and_nothing_else(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(),
    ) {
        let mut refiner = Queues::new(terrain.ground(), Goal::Budget(1 << 20));
        for (frame, camera) in flight.iter().enumerate() {
            let (_, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            let showing = showing(&terrain, &patches);
            refiner.update(&criterion, &patches);
            let wanted = terrain::Any(Box::new(Showing(&criterion, &showing)));
            let all = rebuild(&terrain.layout, &wanted, patches.clone());
            prop_assert_eq!(refiner.active(), &all);
            prop_assert_eq!(refiner.update(&criterion, &patches), RefinementChanges::default(), "at rest");
        }
    }

    #[test]
    fn no_split_that_has_room_promises_more_than_a_diamond_that_stays(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(), budget in 40usize..900,
    ) {
        let mut refiner = Queues::new(terrain.ground(), Goal::Budget(budget));
        for (frame, camera) in flight.iter().enumerate() {
            let (_, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            let showing = showing(&terrain, &patches);
            refiner.update(&criterion, &patches);
            if refiner.triangles() + 4 > budget || refiner.leaves() + 64 > MOST_LEAVES * budget {
                continue;
            }
            // Room for four more: every split of a pair of leaves has been made.
            let active = refiner.active();
            let open = terrain.vertices().find(|&vertex| {
                let ready = vertex.parents().into_iter().all(|parent| {
                    terrain.layout.contains(parent) && active.is_active(parent) && {
                        let patch = terrain.layout.patch_holding(vertex, parent);
                        patches.iter().any(|&corner| terrain.layout.patch_index(corner) == patch)
                    }
                });
                ready && showing.contains(&vertex) && !active.is_active(vertex) && criterion.excess(vertex) > 0.0
            });
            prop_assert_eq!(open, None, "{} of {} triangles", refiner.triangles(), budget);
        }
    }
}

/// Wants whatever has any excess and something to draw.
struct Showing<'a>(&'a terrain::Any<'a>, &'a BTreeSet<Vertex>);

impl Criterion for Showing<'_> {
    fn excess(&self, vertex: Vertex) -> f32 {
        if self.1.contains(&vertex) && self.0.excess(vertex) > 0.0 { 2.0 } else { 0.0 }
    }
}

/// Hilly ground in the middle of a raster turned by 27°: no data beyond its slanted edges, and a lake of none.
fn turned() -> Terrain {
    let heights = (0..200u32).flat_map(|y| (0..180u32).map(move |x| (x as f32, y as f32))).map(|(x, y)| {
        let (dx, dy) = (x - 90.0, y - 100.0);
        let (along, across) = (dx * 0.9 + dy * 0.45, dy * 0.9 - dx * 0.45);
        let inside = along.abs() < 70.0 && across.abs() < 60.0 && libm::hypotf(dx, dy - 20.0) > 12.0;
        let z =
            libm::sinf(x * 0.13) * 20.0 + libm::cosf(y * 0.09) * 30.0 + libm::sinf(x * 1.7 + y * 2.3) * 2.0;
        if inside { z } else { f32::NAN }
    });
    Terrain::new(180, 64, heights.collect())
}

#[test]
fn a_small_budget_is_used_to_within_a_few_triangles_even_among_holes() {
    let terrain = turned();
    let patches: Vec<Vertex> = terrain.layout.patches().collect();
    for budget in [1000, 3000, 8000, 20_000] {
        let mut refiner = Queues::new(terrain.ground(), Goal::Budget(budget));
        for step in 0..6u8 {
            let eye = Vec3::new(100.0 + 60.0 * f32::from(step), 300.0 + 40.0 * f32::from(step), 60.0);
            refiner.update(&Spheres::new(terrain.ground(), &terrain.spheres, eye), &patches);
            refiner.check();
            let (drawn, leaves) = triangles(&terrain, refiner.active(), &patches);
            assert!(drawn <= budget && drawn * 100 >= budget * 98, "{drawn} of {budget} in step {step}");
            assert!(leaves > drawn + 500, "{leaves} leaves, {drawn} drawn: hardly a hole");
        }
    }
}
