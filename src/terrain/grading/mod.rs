//! Grading: the ground made to follow roads, with batters to the daylight line, and the earth that moves.
//!
//! ```text
//!            batter  shoulder  carriageway  shoulder  batter
//!                  ╲   ┌──────────┴──────────┐   ╱‾‾‾‾‾‾‾‾‾‾‾  ground
//!   ground  ‾‾‾‾‾‾‾‾╲  │                     │  ╱
//!                    ╲_│_____formation_______│_╱   cut: 1 up for `cut_slope` out
//!
//!                      │_____formation_______│
//!   ground  ________  ╱                       ╲    fill: 1 down for `fill_slope` out
//!                   ╲╱                         ╲______________
//!              daylight line
//! ```
//!
//! **The formation.** The ground between posts is the plane of three of them, so it follows the road under the whole
//! carriageway only where all corners of every triangle that the carriageway touches do. None is further from it than a
//! cell's diagonal: all posts that near take the level of the road beside them. Whatever the lattice, a straight road of
//! even grade lies in its ground to the rounding of f32; elsewhere it is off by what its curves bend within a cell.
//!
//! **The batters** burn outward from the formation like a grass fire: post by post, the nearest to a carriageway first,
//! each from the road that it is nearest to. A post where the batter comes to daylight stays as it is and carries the
//! fire no further, so that nothing beyond the daylight line is touched, and each changed post costs the same whatever
//! the road's length.
//!
//! Batters end at ground that is level for another reason, a lake's shore, as at a quay; the formation goes through.

pub mod fire;
pub mod formation;
pub mod strip;

use crate::terrain::earthwork::Volumes;
use crate::terrain::grading::fire::batter;
use crate::terrain::grading::formation::Formation;
use crate::terrain::grading::strip::Strip;
use crate::terrain::lattice::{Lattice, Post};

/// Grades the lattice for strips of road: the earth moved for each, in their order.
///
/// Every post that is set is pinned. A post that two strips reach belongs to the nearer carriageway.
pub fn grade(lattice: &mut Lattice, strips: &[Strip]) -> Vec<Volumes> {
    let formation = Formation::of(lattice, strips);
    let mut works = Works { lattice, volumes: vec![Volumes::default(); strips.len()] };
    formation.lay(strips, &mut works);
    batter(strips, formation, &mut works);
    works.volumes
}

/// The ground under way, and the earth moved so far.
struct Works<'a> {
    lattice: &'a mut Lattice,
    volumes: Vec<Volumes>,
}

impl Works<'_> {
    /// Sets a post for a strip.
    fn set(&mut self, post: Post, level_m: f64, strip: usize) {
        let rise = level_m - f64::from(self.lattice.height(post));
        let moved_m3 = rise * self.lattice.cell().x * self.lattice.cell().y;
        // Where there was no ground nothing is measured.
        if rise > 0.0 {
            self.volumes[strip].fill_m3 += moved_m3;
        } else if rise < 0.0 {
            self.volumes[strip].cut_m3 -= moved_m3;
        }
        self.lattice.pin(post, level_m as f32);
    }
}
