//! A tunnel's portal: a wall with a dark mouth where the road enters the hill, a roof behind it until the hill has
//! risen over it, and wing walls in front.
//!
//! ```text
//!     ╔═══════════════════════╗ ─ coping
//!     ║      ╭─────────╮      ║
//!     ║    ╭╯ ▓▓▓▓▓▓▓▓▓ ╰╮    ║      the mouth: dark, set back by the reveal;
//!    ╱║    │ ▓▓▓▓▓▓▓▓▓▓▓ │    ║╲     an upright part, an elliptic arch on it
//!  ╱  ║    │ ▓▓▓▓▓▓▓▓▓▓▓ │    ║  ╲
//! ────╨────┴─────────────┴────╨────  the road's elevation
//! ```
//!
//! Nothing is drawn of the way between two portals: it is out of sight.

use glam::{DVec2, Vec3};

use crate::bridge::{FOUNDED_M, GroundHeight, magnified};
use crate::faces::Faces;
use crate::pier::lowest;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;

/// The height of a mouth six meters wide, in meters: 4.5 m for traffic and the curve of the arch.
const MOUTH_M: f64 = 6.0;
/// How much higher a mouth is for each meter that its road is wider.
const MOUTH_PER_M: f64 = 0.25;
/// How far the upright part of a mouth reaches, as a part of its height.
const SPRINGING: f64 = 0.5;
/// Into how many parts the arch is cut.
const ARCH_PARTS: u32 = 16;
/// How many times its own height the roof may reach back into the hill: on a gentler slope it ends in the open.
const LONGEST_ROOF: f64 = 2.5;

/// How far a mouth may be moved out of the hill, as a part of its wall's height.
const FARTHEST_OUT: f64 = 1.5;
/// How high ground may stand in a mouth, as a part of its height: rounding, and what a road's edge hides.
const GROUND_IN_MOUTH: f64 = 0.02;

const STONE: Srgba = Srgba::opaque(206, 196, 178);
const DRESSED: Srgba = Srgba::opaque(234, 227, 212);
const ROOF: Srgba = Srgba::opaque(158, 154, 132);
const SHADE: Srgba = Srgba::opaque(74, 70, 66);
const DARK: Srgba = Srgba::opaque(22, 21, 22);

/// The position and size of a portal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// The middle of its mouth in world coordinates.
    pub at: DVec2,
    /// The road's elevation there in meters, as it is drawn.
    pub level_m: f64,
    /// The direction out of the tunnel, of length 1.
    pub outward: DVec2,
    /// The carriageway's width in meters, above 0.
    pub width_m: f64,
}

impl Portal {
    /// The height of its wall in meters.
    pub fn height_m(&self) -> f64 {
        self.mouth_m() + 1.6 * magnified(self.width_m)
    }

    fn mouth_m(&self) -> f64 {
        MOUTH_M + MOUTH_PER_M * (self.width_m - 6.0).max(0.0)
    }

    /// Half the width of the mouth, and of the wall round it.
    fn halves_m(&self) -> (f64, f64) {
        let mouth = self.width_m / 2.0 + 0.6;
        (mouth, mouth + 1.4 * magnified(self.width_m))
    }

    /// The portal moved outward, at most `farthest_m`, to where no ground stands in its mouth nor before it: on a slope that
    /// falls across the road the hill does not end in one line. Where some stands everywhere, where it is lowest.
    pub fn out_of_the_hill(self, farthest_m: f64, ground: &GroundHeight<'_>) -> Self {
        let (half, _) = self.halves_m();
        let (reveal, allowed_m) = (0.8 * magnified(self.width_m), GROUND_IN_MOUTH * self.mouth_m());
        let standing_m = |out: f64| {
            let places = [-1.0, -0.5, 0.0, 0.5, 1.0].into_iter().flat_map(|part| {
                [-reveal, 0.0, 2.0 * reveal, 4.0 * reveal].map(|from| (part * half, out + from))
            });
            let above = places.filter_map(|(right, out)| {
                let at = self.at + self.outward.perp() * right + self.outward * out;
                ground(at).map(|height_m| height_m - self.level_m)
            });
            above.fold(0.0, f64::max).max(allowed_m)
        };
        let farthest_m = farthest_m.min(FARTHEST_OUT * self.height_m());
        let outs = (0..=30).map(|step| farthest_m * f64::from(step) / 30.0);
        let best = outs.map(|out| (standing_m(out), out)).min_by(|a, b| a.0.total_cmp(&b.0));
        let out = best.map_or(0.0, |(_, out)| out);
        Self { at: self.at + self.outward * out, ..self }
    }

    /// The distance behind the mouth at which the hill has risen to the part `share` of the wall's height; `None` where
    /// it has not within what the roof may reach.
    pub fn covered_after_m(&self, share: f64, ground: &GroundHeight<'_>) -> Option<f64> {
        let wanted = share * self.height_m();
        let longest = LONGEST_ROOF * self.height_m();
        let across = self.outward.perp() * self.halves_m().1;
        (1..=40).map(|step| longest * f64::from(step) / 40.0).find(|&back| {
            let middle = self.at - self.outward * back;
            let places = [middle - across, middle, middle + across];
            places.into_iter().all(|at| ground(at).is_some_and(|height| height - self.level_m >= wanted))
        })
    }

    /// A point in the world: so far to the right seen from outside, outward, and above the road.
    fn point(&self, right: f64, out: f64, above: f64) -> Vec3 {
        let plan = self.at + self.outward.perp() * right + self.outward * out;
        plan.as_vec2().extend((self.level_m + above) as f32)
    }

    /// The portal's solids in world space, on the ground as it is drawn.
    pub fn build(&self, ground: &GroundHeight<'_>) -> DrawMesh {
        let back = self.covered_after_m(1.0, ground).unwrap_or(LONGEST_ROOF * self.height_m());
        let foot = self.foot(ground, back);
        let mut faces = Faces::default();
        self.front(foot, &mut faces);
        self.roof(foot, back, ground, &mut faces);
        for side in [-1.0, 1.0] {
            self.wing(side, ground, &mut faces);
        }
        faces.into_mesh()
    }

    /// How far below the road all is founded, as a height above the road: negative.
    fn foot(&self, ground: &GroundHeight<'_>, back: f64) -> f64 {
        let (_, wall) = self.halves_m();
        let corners = [(-wall, 0.0), (wall, 0.0), (-wall, -back), (wall, -back)];
        let places = corners.map(|(right, out)| self.at + self.outward.perp() * right + self.outward * out);
        let low_m = lowest(ground, places).unwrap_or(self.level_m);
        (low_m - self.level_m).min(0.0) - FOUNDED_M
    }

    /// The mouth's outline from the right foot over the arch to the left, counter-clockwise seen from outside.
    fn mouth(&self) -> Vec<(f64, f64)> {
        let (half, height) = (self.halves_m().0, self.mouth_m());
        let springing = SPRINGING * height;
        let arch = (0..=ARCH_PARTS).map(|part| {
            let turn = std::f64::consts::PI * f64::from(part) / f64::from(ARCH_PARTS);
            (half * libm::cos(turn), springing + (height - springing) * libm::sin(turn))
        });
        std::iter::once((half, 0.0)).chain(arch).chain([(-half, 0.0)]).collect()
    }

    /// The wall round the mouth, the reveal and the dark.
    fn front(&self, foot: f64, faces: &mut Faces) {
        let (half, wall) = self.halves_m();
        let top = self.height_m();
        let reveal = -0.8 * magnified(self.width_m);
        for (left, right) in [(-wall, -half), (half, wall)] {
            let corners = [(left, foot), (right, foot), (right, top), (left, top)];
            faces.polygon(&corners.map(|(x, z)| self.point(x, 0.0, z)), STONE);
        }
        let mouth = self.mouth();
        for pair in mouth.windows(2) {
            let [(x0, z0), (x1, z1)] = [pair[0], pair[1]];
            faces.polygon(
                &[(x0, z0), (x0, top), (x1, top), (x1, z1)].map(|(x, z)| self.point(x, 0.0, z)),
                STONE,
            );
            let inner = [
                self.point(x0, 0.0, z0),
                self.point(x1, 0.0, z1),
                self.point(x1, reveal, z1),
                self.point(x0, reveal, z0),
            ];
            faces.polygon(&inner, SHADE);
        }
        let below = [(-half, foot), (half, foot)];
        // Without the left foot, which lies on the way back to the first corner.
        let above = &mouth[..mouth.len() - 1];
        let dark = below.iter().chain(above).map(|&(x, z)| self.point(x, reveal, z));
        faces.polygon(&dark.collect::<Vec<_>>(), DARK);
        self.voussoirs(faces);
        self.coping(faces);
    }

    /// A ring of dressed stone round the mouth, standing out a little.
    fn voussoirs(&self, faces: &mut Faces) {
        let by = magnified(self.width_m);
        let (thick, out) = (0.6 * by, 0.15 * by);
        let (half, height) = (self.halves_m().0, self.mouth_m());
        let grown = |(x, z): (f64, f64)| (x * (1.0 + thick / half), z * (1.0 + thick / height));
        for pair in self.mouth().windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let [outer_from, outer_to] = [grown(from), grown(to)];
            let at = |(x, z): (f64, f64), out: f64| self.point(x, out, z);
            faces.polygon(&[at(from, out), at(outer_from, out), at(outer_to, out), at(to, out)], DRESSED);
            faces.polygon(&[at(from, 0.0), at(from, out), at(to, out), at(to, 0.0)], DRESSED);
            let edge = [at(outer_from, out), at(outer_from, 0.0), at(outer_to, 0.0), at(outer_to, out)];
            faces.polygon(&edge, DRESSED);
        }
    }

    /// The band on top of the wall.
    fn coping(&self, faces: &mut Faces) {
        let by = magnified(self.width_m);
        let (wall, top) = (self.halves_m().1 + 0.3 * by, self.height_m());
        self.block((-wall, wall), (-0.6 * by, 0.3 * by), [top - 0.1 * by, top + 0.5 * by], DRESSED, faces);
    }

    /// What keeps the hill off the wall's back: its roof and sides, as far as they may show.
    fn roof(&self, foot: f64, back: f64, ground: &GroundHeight<'_>, faces: &mut Faces) {
        let (wall, top) = (self.halves_m().1, self.height_m());
        let back = back.max(0.8 * magnified(self.width_m));
        // On a gentle slope the roof comes down to the ground behind, as a bank does that was heaped over it.
        let corners = [-wall, wall].map(|right| self.at + self.outward.perp() * right - self.outward * back);
        let risen_m = lowest(ground, corners).map_or(0.0, |height| height - self.level_m);
        let end = risen_m.clamp(0.0, top);
        let ring = [(-wall, 0.0, top), (-wall, -back, end), (wall, -back, end), (wall, 0.0, top)];
        for pair in ring.windows(2) {
            let [(x0, y0, z0), (x1, y1, z1)] = [pair[0], pair[1]];
            let corners = [(x1, y1, foot), (x0, y0, foot), (x0, y0, z0), (x1, y1, z1)];
            faces.polygon(&corners.map(|(x, y, z)| self.point(x, y, z)), STONE);
        }
        let lid = [ring[0], ring[3], ring[2], ring[1]];
        faces.polygon(&lid.map(|(x, y, z)| self.point(x, y, z)), ROOF);
    }

    /// The wall that holds the slope on the left (−1) or right (1) as seen from outside; its top falls outward.
    fn wing(&self, side: f64, ground: &GroundHeight<'_>, faces: &mut Faces) {
        let by = magnified(self.width_m);
        let (_, wall) = self.halves_m();
        let (length, thick) = (0.9 * self.height_m(), 0.5 * by);
        let (inner, flare) = (side * (wall - thick), side * 0.55 * length);
        let above = |right: f64, out: f64| {
            let at = self.at + self.outward.perp() * right + self.outward * out;
            ground(at).unwrap_or(self.level_m) - self.level_m
        };
        let near = [(inner, 0.0), (inner + side * thick, 0.0)];
        let far = near.map(|(right, out)| (right + flare, out + length));
        let low = far.map(|(right, out)| above(right, out)).into_iter().fold(f64::INFINITY, f64::min);
        // Where the ground falls away from the portal, as beside a bridge, there is no slope to hold.
        if low < -0.4 * self.height_m() {
            return;
        }
        let tops = [0.75 * self.height_m(), (low + 0.6 * by).min(0.7 * self.height_m())];
        let foot = low.min(above(near[1].0, 0.0)).min(0.0) - FOUNDED_M;
        // Counter-clockwise from above, beginning at the portal.
        let ring =
            if side > 0.0 { [near[1], near[0], far[0], far[1]] } else { [near[0], near[1], far[1], far[0]] };
        let top = |index: usize| if index < 2 { tops[0] } else { tops[1] };
        let corner = |index: usize, z: f64| self.point(ring[index].0, ring[index].1, z);
        for index in 0..4 {
            let next = (index + 1) % 4;
            let wall = [
                corner(index, foot),
                corner(next, foot),
                corner(next, top(next).max(foot)),
                corner(index, top(index).max(foot)),
            ];
            faces.polygon(&wall, STONE);
        }
        faces.polygon(&[0, 1, 2, 3].map(|index| corner(index, top(index).max(foot))), DRESSED);
    }

    /// A closed block: from left to right, from back to front, from bottom to top.
    fn block(
        &self,
        (left, right): (f64, f64),
        (back, front): (f64, f64),
        [low, high]: [f64; 2],
        color: Srgba,
        faces: &mut Faces,
    ) {
        // Counter-clockwise from above, where right lies to the left of outward.
        let ring = [(left, front), (right, front), (right, back), (left, back)];
        for index in 0..4 {
            let [(x0, y0), (x1, y1)] = [ring[index], ring[(index + 1) % 4]];
            let corners = [(x0, y0, low), (x1, y1, low), (x1, y1, high), (x0, y0, high)];
            faces.polygon(&corners.map(|(x, y, z)| self.point(x, y, z)), color);
        }
        faces.polygon(&ring.map(|(x, y)| self.point(x, y, high)), color);
        let bottom = [ring[3], ring[2], ring[1], ring[0]];
        faces.polygon(&bottom.map(|(x, y)| self.point(x, y, low)), color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mouth_on_a_slope_across_the_road_stands_where_no_ground_does() {
        for quarter in 0..4 {
            let turned = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
            let outward = turned(DVec2::Y);
            let portal = Portal { at: DVec2::ZERO, level_m: 100.0, outward, width_m: 8.0 };
            // A hill that falls by half along the road, and by a quarter across it.
            let ground = |at: DVec2| Some(100.0 - 0.5 * at.dot(outward) + 0.25 * at.dot(outward.perp()));
            let (half, _) = portal.halves_m();
            let highest = |portal: &Portal| {
                let corners = [-half, half].map(|right| portal.at + outward.perp() * right);
                corners.into_iter().filter_map(ground).fold(f64::MIN, f64::max)
            };
            assert!(highest(&portal) > 101.0);
            let moved = portal.out_of_the_hill(30.0, &ground);
            assert!(highest(&moved) <= 100.0 + GROUND_IN_MOUTH * moved.mouth_m(), "{}", highest(&moved));
            assert!((moved.at - portal.at).length() < 4.0, "no farther than it must: {}", moved.at);
            // On a road that turns away at once it stays.
            assert_eq!(portal.out_of_the_hill(0.0, &ground), portal);
        }
    }

    #[test]
    fn a_mouth_before_a_cliff_stays() {
        let portal = Portal { at: DVec2::ZERO, level_m: 5.0, outward: DVec2::X, width_m: 8.0 };
        let ground = |at: DVec2| Some(if at.x < -1.0 { 40.0 } else { 5.0 });
        assert_eq!(portal.out_of_the_hill(30.0, &ground), portal);
    }
}
