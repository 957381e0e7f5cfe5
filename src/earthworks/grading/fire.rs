//! The batters, burning outward from the formation to the daylight line.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::grading::GradingWorks;
use crate::grading::formation::{Formation, LegId, world};
use crate::grading::strip::GradingStrip;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;

/// A post that the fire has come to.
#[derive(Clone, Copy, PartialEq)]
struct Front {
    out_m: f64,
    index: usize,
    leg: LegId,
}

impl Eq for Front {}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Front {
    fn cmp(&self, other: &Self) -> Ordering {
        let order = self.out_m.total_cmp(&other.out_m);
        order.then(self.index.cmp(&other.index)).then(self.leg.cmp(&other.leg))
    }
}

/// Sets every post between the formation and the daylight line to the batter of the carriageway that is nearest.
pub(in crate::grading) fn batter(
    strips: &[GradingStrip],
    mut formation: Formation,
    works: &mut GradingWorks<'_>,
) {
    let mut front = BinaryHeap::new();
    for post in std::mem::take(&mut formation.posts) {
        spread(strips, &formation, works.lattice, post, &mut front);
    }
    while let Some(Reverse(Front { index, leg, .. })) = front.pop() {
        let post = works.lattice.post_at(index);
        if formation.owner(index).is_some() || works.lattice.is_pinned(post) {
            continue;
        }
        let (strip, at) = (formation.legs.place(leg), world(works.lattice, post));
        let beside = strips[strip.0].beside(strip.1, at);
        if strips[strip.0].is_behind_wall(&beside) {
            continue;
        }
        let (lowest, highest) = strips[strip.0].batters(&beside);
        let ground = f64::from(works.lattice.height(post));
        // Daylight, and where there is no ground to meet.
        if ground.is_nan() || (lowest..=highest).contains(&ground) {
            continue;
        }
        works.set(post, ground.clamp(lowest, highest), strip.0);
        formation.take(index, leg);
        spread(strips, &formation, works.lattice, post, &mut front);
    }
}

/// Brings the fire from a post to its neighbors that belong to no leg.
fn spread(
    strips: &[GradingStrip],
    formation: &Formation,
    lattice: &Lattice,
    post: Post,
    front: &mut BinaryHeap<Reverse<Front>>,
) {
    let Some(from) = formation.owner(lattice.index(post)) else { return };
    for next in (PostRect { first: post, last: post }).grown((1, 1), lattice).posts() {
        let index = lattice.index(next);
        if formation.owner(index).is_some() {
            continue;
        }
        let at = world(lattice, next);
        let out = |leg: LegId| Front { out_m: formation.legs.beside(strips, leg, at).out_m, index, leg };
        if let Some(nearest) = formation.legs.near(from).map(out).min() {
            front.push(Reverse(nearest));
        }
    }
}
