//! 000: equal square patches, forced splits.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use sandtable::roam::active::ActiveSet;
use sandtable::roam::bintree::Triangle;
use sandtable::roam::culling::patches_in_view;
use sandtable::roam::graph::Vertex;
use sandtable::roam::layout::Layout;
use sandtable::roam::refine::rebuild::rebuild;
use sandtable::view::frustum::Frustum;

use crate::{World, camera, leaves};

/// Doubled area in cells: it halves from level to level.
fn size(triangle: &Triangle) -> i32 {
    let [a, b, c] = triangle.corners();
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

#[test]
fn paper_000_patches_share_their_border_samples_and_hold_two_bintree_roots() {
    let layout = Layout::new(1025, 1025, 64).expect("sound");
    assert_eq!(layout.patch_count(), 16 * 16);
    let patches: BTreeSet<Vertex> = layout.patches().collect();
    for &corner in &patches {
        let roots = Triangle::roots(corner, 64);
        assert_eq!(roots.iter().map(size).sum::<i32>(), 2 * 64 * 64);
        let east = corner.moved(64, 0);
        if patches.contains(&east) {
            let corners = |corner| -> BTreeSet<Vertex> {
                Triangle::roots(corner, 64).iter().flat_map(Triangle::corners).collect()
            };
            let shared: Vec<Vertex> = corners(corner).intersection(&corners(east)).copied().collect();
            assert_eq!(shared, [east, east.moved(0, 64)], "the border between {corner:?} and {east:?}");
        }
    }
}

#[test]
fn paper_000_neighbours_are_as_fine_or_one_level_apart_the_base_neighbour_never_finer_by_more() {
    let world = World::hills(130, 97, 32);
    let mut active = ActiveSet::new(world.layout);
    for (x, y) in [(33, 41), (64, 31), (97, 5), (1, 90), (120, 90)] {
        active.activate(Vertex::new(x, y));
    }
    let leaves = leaves(&active);
    let mut beside: BTreeMap<[Vertex; 2], Vec<usize>> = BTreeMap::new();
    for (at, leaf) in leaves.iter().enumerate() {
        for (from, to) in [(leaf.apex, leaf.left), (leaf.left, leaf.right), (leaf.right, leaf.apex)] {
            beside.entry([from.min(to), from.max(to)]).or_default().push(at);
        }
    }
    for (edge, sharing) in beside.iter().filter(|(_, sharing)| sharing.len() == 2) {
        let [one, other] = [&leaves[sharing[0]], &leaves[sharing[1]]];
        for (leaf, neighbour) in [(one, other), (other, one)] {
            let base = BTreeSet::from([leaf.left, leaf.right]) == BTreeSet::from(*edge);
            let ratio = size(neighbour) as f32 / size(leaf) as f32;
            let allowed: &[f32] = if base { &[1.0, 2.0] } else { &[1.0, 0.5] };
            assert!(allowed.contains(&ratio), "{leaf:?} beside {neighbour:?}");
        }
    }
}

#[test]
fn paper_000_a_split_forces_coarser_base_neighbours_first_and_splits_alone_at_the_border() {
    let layout = Layout::new(65, 65, 64).expect("sound");
    let mut active = ActiveSet::new(layout);
    let border = Vertex::new(32, 0);
    active.activate(border);
    let parents = border.parents().map(|parent| layout.contains(parent));
    assert_eq!(
        parents.iter().filter(|&&inside| inside).count(),
        1,
        "there is no neighbour beyond the border"
    );
    assert_eq!(active.count(), 2, "the border vertex and the centre that is its parent");
    active.activate(Vertex::new(1, 1));
    active.check().expect("forced splits leave no parent out");
    assert!(active.count() > 6, "a deep split forces many: {}", active.count());
}

#[test]
fn paper_000_culled_patches_are_not_refined() {
    let world = World::hills(257, 257, 32);
    let (ground, camera) =
        (world.ground(), camera(Vec3::new(1280.0, 1280.0, 90.0), Vec3::new(2500.0, 1280.0, 0.0)));
    let seen = patches_in_view(ground, &world.heights, &Frustum::of(&camera));
    assert!(!seen.is_empty() && seen.len() < world.layout.patch_count() / 2, "{} patches", seen.len());
    assert!(seen.iter().all(|corner| corner.x >= 96), "what lies behind the eye is culled");
    let finest = sandtable::roam::criterion::flat::Flat::new(&world.layout, &world.errors, 0.0);
    let active = rebuild(&world.layout, &finest, seen.iter().copied());
    let inner = |corner: &Vertex| {
        let middle = corner.moved(15, 17);
        layout_neighbours(*corner).iter().all(|near| !seen.contains(near)) && active.is_active(middle)
    };
    let away: Vec<Vertex> = world.layout.patches().filter(|corner| !seen.contains(corner)).collect();
    assert!(!away.iter().any(inner), "patches away from what is seen stay coarse");
    assert!(seen.iter().all(|corner| active.is_active(corner.moved(15, 17))), "those in view are fine");
}

fn layout_neighbours(corner: Vertex) -> [Vertex; 8] {
    let steps = [(-32, -32), (0, -32), (32, -32), (-32, 0), (32, 0), (-32, 32), (0, 32), (32, 32)];
    steps.map(|(dx, dy)| corner.moved(dx, dy))
}
