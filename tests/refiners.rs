//! Every refiner with every criterion, on terrains of any shape and along any way: what each promises of its mesh.

#[path = "refiners/criteria.rs"]
mod criteria;
#[path = "refiners/terrain.rs"]
mod terrain;

use proptest::prelude::*;
use sandtable::roam::active::ActiveSet;
use sandtable::roam::bintree::Triangle;
use sandtable::roam::criterion::Criterion;
use sandtable::roam::graph::Vertex;
use sandtable::roam::layout::Layout;
use sandtable::roam::refine::changes::Changes;
use sandtable::roam::refine::coherent::{Coherent, Hidden};
use sandtable::roam::refine::queues::{Goal, Queues};
use sandtable::roam::refine::rebuild::rebuild;
use terrain::{MONOTONE, Terrain, flights, terrains};

const CRITERIA: usize = 8;

/// What an update must report of the step from one mesh to the next.
fn changes_between(terrain: &Terrain, before: &ActiveSet, after: &ActiveSet) -> Changes {
    let layout = &terrain.layout;
    let mut changes = Changes::default();
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
fn covers(told: &Changes, step: &Changes) -> bool {
    let net = |changes: &Changes| changes.splits as i64 - changes.merges as i64;
    net(told) == net(step)
        && told.splits >= step.splits
        && step.dirty.iter().all(|patch| told.dirty.contains(patch))
}

/// The patches whose square holds the vertex.
fn patches_at(layout: &Layout, vertex: Vertex) -> impl Iterator<Item = usize> {
    let side = layout.patch();
    let holds = move |corner: &Vertex| {
        (corner.x..=corner.x + side).contains(&vertex.x) && (corner.y..=corner.y + side).contains(&vertex.y)
    };
    layout.patches().enumerate().filter(move |(_, corner)| holds(corner)).map(|(place, _)| place)
}

fn leaves(active: &ActiveSet, patches: &[Vertex]) -> usize {
    let mut stack: Vec<Triangle> =
        patches.iter().flat_map(|&corner| Triangle::roots(corner, active.layout().patch())).collect();
    let mut leaves = 0;
    while let Some(triangle) = stack.pop() {
        if triangle.is_finest() || !active.is_active(triangle.split_vertex()) {
            leaves += 1;
        } else {
            stack.extend(triangle.split());
        }
    }
    leaves
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
            prop_assert_eq!(refiner.check(), Ok(()));
            prop_assert_eq!(changes, changes_between(&terrain, &before, &anew));
            prop_assert_eq!(refiner.update(&criterion, &patches), Changes::default(), "at rest");
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
            prop_assert_eq!(refiner.check(), Ok(()));
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
    fn queues_without_a_budget_give_the_mesh_of_a_rebuild_where_the_criterion_is_monotone(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(), most in 0usize..2,
    ) {
        let goal = [Goal::Tolerance, Goal::ToleranceWithin(1 << 20)][most];
        let mut refiner = Queues::new(terrain.layout, goal);
        for (frame, camera) in flight.iter().enumerate() {
            let mut criteria = terrain.criteria(camera, frame as u32);
            let (name, criterion) = criteria.swap_remove(which);
            prop_assert_eq!(name, MONOTONE[which]);
            let patches = terrain.in_view(camera);
            let before = refiner.active().clone();
            let changes = refiner.update(&criterion, &patches);
            let anew = rebuild(&terrain.layout, &criterion, patches.iter().copied());
            prop_assert_eq!(refiner.active(), &anew, "{} in frame {}", name, frame);
            prop_assert_eq!(refiner.check(), Ok(()));
            prop_assert!(covers(&changes, &changes_between(&terrain, &before, &anew)));
            prop_assert_eq!(refiner.triangles(), leaves(&anew, &patches));
        }
    }

    #[test]
    fn the_budget_of_1997_is_never_exceeded_whatever_the_criterion(
        terrain in terrains(), flight in flights(), which in 0..CRITERIA,
        budget in 0usize..900, capped in 0usize..2,
    ) {
        let goal = [Goal::Budget(budget), Goal::ToleranceWithin(budget)][capped];
        let mut refiner = Queues::new(terrain.layout, goal);
        let mut again = Queues::new(terrain.layout, goal);
        for (frame, camera) in flight.iter().enumerate() {
            let (name, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            let before = refiner.active().clone();
            let changes = refiner.update(&criterion, &patches);
            prop_assert_eq!(refiner.check(), Ok(()), "{}", name);
            prop_assert_eq!(refiner.triangles(), leaves(refiner.active(), &patches));
            let roots = 2 * patches.len();
            prop_assert!(refiner.triangles() <= budget.max(roots), "{}: {}", name, refiner.triangles());
            prop_assert!(covers(&changes, &changes_between(&terrain, &before, refiner.active())));
            prop_assert_eq!(again.update(&criterion, &patches), changes, "the same way, the same bits");
            prop_assert_eq!(again.active(), refiner.active());
        }
    }

    #[test]
    fn a_budget_that_the_view_cannot_use_splits_all_that_shows_and_nothing_else(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(),
    ) {
        let mut refiner = Queues::new(terrain.layout, Goal::Budget(1 << 20));
        for (frame, camera) in flight.iter().enumerate() {
            let (_, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            refiner.update(&criterion, &patches);
            let all = rebuild(&terrain.layout, &terrain::Any(Box::new(Showing(&criterion))), patches.clone());
            prop_assert_eq!(refiner.active(), &all);
            prop_assert_eq!(refiner.update(&criterion, &patches), Changes::default(), "at rest");
        }
    }

    #[test]
    fn no_split_that_has_room_promises_more_than_a_diamond_that_stays(
        terrain in terrains(), flight in flights(), which in 0..MONOTONE.len(), budget in 40usize..900,
    ) {
        let mut refiner = Queues::new(terrain.layout, Goal::Budget(budget));
        for (frame, camera) in flight.iter().enumerate() {
            let (_, criterion) = terrain.criteria(camera, frame as u32).swap_remove(which);
            let patches = terrain.in_view(camera);
            refiner.update(&criterion, &patches);
            if refiner.triangles() + 4 > budget {
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
                ready && !active.is_active(vertex) && criterion.excess(vertex) > 0.0
            });
            prop_assert_eq!(open, None, "{} of {} triangles", refiner.triangles(), budget);
        }
    }
}

/// Wants whatever has any excess.
struct Showing<'a>(&'a terrain::Any<'a>);

impl Criterion for Showing<'_> {
    fn excess(&self, vertex: Vertex) -> f32 {
        if self.0.excess(vertex) > 0.0 { 2.0 } else { 0.0 }
    }
}
