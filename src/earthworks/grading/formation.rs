//! The formation: which leg of which strip each post near a carriageway belongs to.

use glam::DVec2;

use crate::grading::GradingWorks;
use crate::grading::strip::{GradingStrip, StripOffset};
use sandtable_geom::rect::Rect;
use sandtable_terrain::lattice::{Lattice, Post};

/// A leg of a strip among all legs of all strips, counted from 1: 0 is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::grading) struct LegId(u32);

/// Where the legs are.
pub(in crate::grading) struct Legs {
    /// Strip and leg of each.
    all: Vec<(u32, u32)>,
}

impl Legs {
    fn of(strips: &[GradingStrip]) -> Self {
        let legs =
            |(index, strip): (u32, &GradingStrip)| (0..strip.legs() as u32).map(move |leg| (index, leg));
        Self { all: (0..).zip(strips).flat_map(legs).collect() }
    }

    fn ids(&self) -> impl Iterator<Item = LegId> + use<> {
        (1..=self.all.len() as u32).map(LegId)
    }

    /// The strip and which of its legs this is.
    pub fn place(&self, id: LegId) -> (usize, usize) {
        let (strip, leg) = self.all[id.0 as usize - 1];
        (strip as usize, leg as usize)
    }

    /// The position of a world point relative to a leg.
    pub fn beside(&self, strips: &[GradingStrip], id: LegId, at: DVec2) -> StripOffset {
        let (strip, leg) = self.place(id);
        strips[strip].beside(leg, at)
    }

    /// The leg itself and its neighbors in the strip.
    pub fn near(&self, id: LegId) -> impl Iterator<Item = LegId> + '_ {
        let (strip, _) = self.place(id);
        let is_same = move |&id: &LegId| {
            self.all.get((id.0 as usize).wrapping_sub(1)).is_some_and(|at| at.0 as usize == strip)
        };
        [id, LegId(id.0 - 1), LegId(id.0 + 1)].into_iter().filter(is_same)
    }
}

/// The posts of the formation.
pub(in crate::grading) struct Formation {
    /// The leg that each post belongs to, [`Lattice::index`] by index.
    owners: Vec<u32>,
    pub legs: Legs,
    /// The posts that belong to one, in the order of their indices.
    pub posts: Vec<Post>,
}

impl Formation {
    /// Gives every post within a cell's diagonal of a carriageway with its shoulders to the nearest of them.
    pub fn of(lattice: &Lattice, strips: &[GradingStrip]) -> Self {
        let legs = Legs::of(strips);
        let mut formation = Self { owners: vec![0; lattice.heights().len()], legs, posts: Vec::new() };
        for id in formation.legs.ids() {
            formation.claim(lattice, strips, id);
        }
        let owned = formation.owners.iter().enumerate().filter(|(_, owner)| **owner != 0);
        formation.posts = owned.map(|(index, _)| lattice.post_at(index)).collect();
        formation
    }

    fn claim(&mut self, lattice: &Lattice, strips: &[GradingStrip], id: LegId) {
        let (index, leg) = self.legs.place(id);
        let strip = &strips[index];
        let margin = lattice.cell().length();
        let reach = strip.reach_m() + strip.mouth_reach_m() + margin;
        let points = strip.alignment.line.points();
        let ends = [points[leg], points[leg + 1]];
        for post in posts_near(lattice, ends, reach) {
            let at = world(lattice, post);
            let beside = strip.beside(leg, at);
            if strip.out_of_level_m(&beside) > margin {
                continue;
            }
            let owner = &mut self.owners[lattice.index(post)];
            let is_nearer = |held: LegId| beside.out_m < self.legs.beside(strips, held, at).out_m;
            if *owner == 0 || is_nearer(LegId(*owner)) {
                *owner = id.0;
            }
        }
    }

    /// The leg that a post belongs to.
    pub fn owner(&self, index: usize) -> Option<LegId> {
        Some(LegId(self.owners[index])).filter(|id| id.0 != 0)
    }

    /// Gives a post that belongs to none to a leg.
    pub fn take(&mut self, index: usize, id: LegId) {
        self.owners[index] = id.0;
    }

    /// Sets every post of the formation to its level.
    pub fn lay(&self, strips: &[GradingStrip], works: &mut GradingWorks<'_>) {
        for &post in &self.posts {
            let Some(id) = self.owner(works.lattice.index(post)) else { continue };
            let beside = self.legs.beside(strips, id, world(works.lattice, post));
            let strip = self.legs.place(id).0;
            works.set(post, strips[strip].formation(&beside), strip);
        }
    }
}

/// World X and Y of a post, not rounded to f32.
pub(in crate::grading) fn world(lattice: &Lattice, post: Post) -> DVec2 {
    post.grid() * lattice.cell() + lattice.extent().min
}

/// The posts within `reach` of a leg, and some farther ones: row by row, beside the part of the leg near the row.
fn posts_near(lattice: &Lattice, [from, to]: [DVec2; 2], reach: f64) -> impl Iterator<Item = Post> {
    let bounds = Rect::around([from, to]).grown(reach);
    let rows = between(lattice.grid_at(bounds.min).y, lattice.grid_at(bounds.max).y, lattice.rows());
    let (cell, origin) = (lattice.cell(), lattice.extent().min);
    let columns = move |row: u32| {
        let y = origin.y + f64::from(row) * cell.y;
        let band =
            Rect { min: DVec2::new(f64::NEG_INFINITY, y - reach), max: DVec2::new(f64::INFINITY, y + reach) };
        let (first, last) = band.clip_line(from, to)?;
        let (low, high) = (first.x.min(last.x) - reach, first.x.max(last.x) + reach);
        Some(((low - origin.x) / cell.x, (high - origin.x) / cell.x))
    };
    let count = lattice.columns();
    rows.filter_map(move |row| columns(row).map(|columns| (row, columns)))
        .flat_map(move |(row, (low, high))| between(low, high, count).map(move |column| Post { column, row }))
}

/// The whole numbers from `low` to `high` that are below `count`.
fn between(low: f64, high: f64, count: u32) -> std::ops::Range<u32> {
    let first = low.ceil().clamp(0.0, f64::from(count)) as u32;
    let past = (high.floor() + 1.0).clamp(0.0, f64::from(count)) as u32;
    first..past.max(first)
}
