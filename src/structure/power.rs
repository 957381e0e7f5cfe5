//! Power lines: pylons along a line and wires that hang between them.
//!
//! A wire hangs as a parabola, which a taut wire's catenary is within a thousandth of the span:
//!
//! ```text
//!  z(t) = (1 − t)·z₀ + t·z₁ − 4·sag·t·(1 − t)      t from 0 at one pylon to 1 at the next
//! ```
//!
//! It hangs as deep as the scene says, less where it would come too near the ground; where even a straight wire would,
//! one pylon more stands at the worst place.

use glam::DVec3;

use crate::faces::Faces;
use crate::fence::PostPosition;
use crate::power_beam::beam;
use sandtable_draw::color::Srgba;
use sandtable_geom::profile::Profile;
use sandtable_terrain::support_surface::{SupportSurface, ground_runs};
use sandtable_terrain::triangle_surface::TriangleSurface;

const STEEL: Srgba = Srgba::opaque(138, 144, 150);
const WOOD: Srgba = Srgba::opaque(122, 98, 74);
const WIRE: Srgba = Srgba::opaque(70, 72, 76);

/// Up to this height a line runs on wooden poles, above it on lattice towers.
pub const TALLEST_POLE_M: f64 = 15.0;

/// Least height of a wire above the ground as a share of the pylon's: six meters under a pylon of thirty.
const CLEARANCE: f64 = 0.2;
/// Where the lowest wires are fastened, as a share of the pylon's height.
const LOWEST_WIRE: f64 = 0.68;
/// Half a wire's thickness as a share of the pylon's height: several times that of real ones, which nobody would see.
const WIRE_HALF: f32 = 0.0028;
/// Straight pieces of a wire in a span: the parabola is off by less than a hundredth of its sag.
const WIRE_PIECES: u32 = 10;
/// Places along a span where a wire's clearance is looked at, beside those where the ground bends.
const LOOKS: u32 = 16;
/// How often a span may be halved, and so on, to keep its wires off the ground.
const MOST_SPLITS: u32 = 6;

/// Pylons and the wires between them.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerLine {
    /// The pylons, in the order of the line.
    pub pylons: Vec<PostPosition>,
    /// From the ground to its top, meters.
    pub height_m: f64,
    /// Between the outermost wires, meters.
    pub width_m: f64,
    /// How deep a wire hangs, as a share of its span.
    pub sag: f64,
}

/// A pylon's wires: where each is fastened, meters across the line (left is positive) and up.
fn fastenings(line: &PowerLine) -> Vec<(f64, f64)> {
    let (height, half) = (line.height_m, line.width_m / 2.0);
    if height <= TALLEST_POLE_M {
        vec![(-half, 0.9 * height), (half, 0.9 * height), (0.0, height)]
    } else {
        let (lower, upper) = (LOWEST_WIRE * height, 0.82 * height);
        vec![(-half, lower), (half, lower), (-0.7 * half, upper), (0.7 * half, upper), (0.0, height)]
    }
}

impl PowerLine {
    /// Adds the pylons that have ground under them, and the wires between neighbors that have, to `faces`.
    pub fn build(&self, under: SupportSurface<'_>, faces: &mut Faces) {
        let feet: Vec<Option<f64>> = self.pylons.iter().map(|stand| under.z(stand.at)).collect();
        for (stand, foot) in self.pylons.iter().zip(&feet) {
            if let Some(z) = *foot {
                self.pylon(stand, z, under, faces);
            }
        }
        for (pair, feet) in self.pylons.windows(2).zip(feet.windows(2)) {
            if let [Some(from), Some(to)] = *feet {
                let ground = ground_runs(under.displayed, pair[0].at, pair[1].at);
                self.wires([pair[0], pair[1]], [from, to], &ground, faces);
            }
        }
    }

    fn wires(
        &self,
        [from, to]: [PostPosition; 2],
        [from_z, to_z]: [f64; 2],
        ground: &[Profile],
        faces: &mut Faces,
    ) {
        let half = self.height_m as f32 * WIRE_HALF;
        for (aside, up) in fastenings(self) {
            let ends = (from.beside(aside, from_z + up), to.beside(aside, to_z + up));
            let wanted = self.sag * ends.0.distance(ends.1);
            let sag_m = sag(ends, wanted, ground, self.height_m * CLEARANCE);
            for piece in 0..WIRE_PIECES {
                let at = |step: u32| hanging(ends, sag_m, f64::from(step) / f64::from(WIRE_PIECES)).as_vec3();
                beam(faces, (at(piece), at(piece + 1)), (half, half), WIRE);
            }
        }
    }

    fn pylon(&self, stand: &PostPosition, z: f64, under: SupportSurface<'_>, faces: &mut Faces) {
        if self.height_m <= TALLEST_POLE_M {
            self.pole(stand, z, faces);
        } else {
            self.tower(stand, z, under, faces);
        }
    }

    fn pole(&self, stand: &PostPosition, z: f64, faces: &mut Faces) {
        let height = self.height_m as f32;
        let place = |aside: f64, up: f64| stand.beside(aside, z + up).as_vec3();
        let (foot, top) = (place(0.0, -0.1 * self.height_m), place(0.0, self.height_m));
        beam(faces, (foot, top), (height * 0.014, height * 0.009), WOOD);
        let half = self.width_m / 2.0;
        let arm = (place(-half, 0.89 * self.height_m), place(half, 0.89 * self.height_m));
        beam(faces, arm, (height * 0.008, height * 0.008), WOOD);
    }

    /// Four legs, each down to the ground where it stands, braced, and two arms.
    fn tower(&self, stand: &PostPosition, z: f64, under: SupportSurface<'_>, faces: &mut Faces) {
        let height = self.height_m;
        let thick = height as f32 * 0.009;
        let plan = |corner: usize, half: f64| {
            let (a, b) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][corner % 4];
            stand.at + (stand.along * a + stand.along.perp() * b) * half
        };
        let at = |corner: usize, level: (f64, f64)| {
            plan(corner, level.1 * height).extend(z + level.0 * height).as_vec3()
        };
        for corner in 0..4 {
            let foot = plan(corner, LEVELS[0].1 * height);
            let foot_z = under.z(foot).unwrap_or(z) - 0.01 * height;
            // The leg's line goes on down, or ends sooner, where the ground under it lies lower or higher.
            let foot = foot.extend(foot_z).as_vec3();
            beam(faces, (foot, at(corner, LEVELS[1])), (thick * 1.3, thick), STEEL);
            for levels in LEVELS[1..].windows(2) {
                beam(faces, (at(corner, levels[0]), at(corner, levels[1])), (thick, thick * 0.8), STEEL);
            }
            for levels in LEVELS.windows(2) {
                for (from, to) in [(corner, corner + 1), (corner + 1, corner)] {
                    let brace = (at(from, levels[0]), at(to, levels[1]));
                    beam(faces, brace, (thick * 0.5, thick * 0.5), STEEL);
                }
            }
        }
        for (reach, up) in [(0.5, LOWEST_WIRE + 0.03), (0.35, 0.85)] {
            self.arm(stand, z, (reach * self.width_m, up * height), faces);
        }
    }

    /// An arm to either side: a tie and a strut that meet at its end, and what the wire hangs from.
    fn arm(&self, stand: &PostPosition, z: f64, (reach, up): (f64, f64), faces: &mut Faces) {
        let thick = self.height_m as f32 * 0.006;
        let place = |aside: f64, up: f64| stand.beside(aside, z + up).as_vec3();
        for side in [-1.0, 1.0] {
            let end = place(side * reach, up);
            beam(faces, (place(0.0, up), end), (thick * 1.4, thick), STEEL);
            beam(faces, (place(0.0, up + 0.06 * self.height_m), end), (thick, thick), STEEL);
            let hung = place(side * reach, up - 0.03 * self.height_m);
            beam(faces, (end, hung), (thick, thick), WIRE);
        }
    }
}

/// A tower's levels from the ground up: height and half width as shares of the whole height.
const LEVELS: [(f64, f64); 5] = [(0.0, 0.1), (0.25, 0.066), (0.46, 0.042), (0.66, 0.026), (1.0, 0.006)];

/// A point of a wire.
fn hanging((from, to): (DVec3, DVec3), sag_m: f64, part: f64) -> DVec3 {
    from.lerp(to, part) - DVec3::Z * (4.0 * sag_m * part * (1.0 - part))
}

/// The sag of a wire: `wanted_m`, or less over the ground beneath the line, at least 0.
fn sag(ends: (DVec3, DVec3), wanted_m: f64, ground: &[Profile], clearance_m: f64) -> f64 {
    let over = |part: f64, z: f64| {
        let room = hanging(ends, 0.0, part).z - z - clearance_m;
        room / (4.0 * part * (1.0 - part))
    };
    looks(ground).map(|(part, z)| over(part, z)).fold(wanted_m, f64::min).max(0.0)
}

/// Where a span's clearance is looked at: where the ground under it bends, and evenly between, with its height.
fn looks(ground: &[Profile]) -> impl Iterator<Item = (f64, f64)> + '_ {
    ground.iter().flat_map(|run| {
        let [first, last] = run.span();
        let bends = run.stations().iter().copied().zip(run.values().iter().copied());
        let even = (1..LOOKS).map(|step| f64::from(step) / f64::from(LOOKS));
        let even = even.filter(move |part| (first..=last).contains(part)).map(|part| (part, run.at(part)));
        bends.chain(even).filter(|(part, _)| (0.02..=0.98).contains(part))
    })
}

/// Pylons along a line on a ground: `stands`, and one more wherever a straight wire would come too near the ground
/// between two of them. Returns how many were added.
pub fn clear(
    stands: &[PostPosition],
    height_m: f64,
    ground: &dyn TriangleSurface,
) -> (Vec<PostPosition>, usize) {
    let mut pylons: Vec<PostPosition> = stands.first().copied().into_iter().collect();
    for pair in stands.windows(2) {
        split([pair[0], pair[1]], height_m, ground, MOST_SPLITS, &mut pylons);
    }
    let added = pylons.len() - stands.len();
    (pylons, added)
}

/// Adds the pylons after the first of a span to `pylons`, the last included.
fn split(
    span: [PostPosition; 2],
    height_m: f64,
    ground: &dyn TriangleSurface,
    splits: u32,
    pylons: &mut Vec<PostPosition>,
) {
    if let Some(part) = worst(span, height_m, ground).filter(|_| splits > 0) {
        let [from, to] = span;
        let at = from.at.lerp(to.at, part);
        let middle = PostPosition { at, along: (to.at - from.at).normalize_or(from.along) };
        split([from, middle], height_m, ground, splits - 1, pylons);
        split([middle, to], height_m, ground, splits - 1, pylons);
    } else {
        pylons.push(span[1]);
    }
}

/// Where the lowest wire of a span, drawn straight, comes too near to the ground and a pylon would help.
fn worst([from, to]: [PostPosition; 2], height_m: f64, ground: &dyn TriangleSurface) -> Option<f64> {
    let foot = |stand: PostPosition| ground.displayed_z(stand.at);
    let up = DVec3::Z * LOWEST_WIRE.min(0.9) * height_m;
    let ends = (from.at.extend(foot(from)?) + up, to.at.extend(foot(to)?) + up);
    let found = ground_runs(ground, from.at, to.at);
    let clearance = |(part, z): (f64, f64)| (hanging(ends, 0.0, part).z - z, part);
    let least = looks(&found)
        .filter(|(part, _)| (0.2..=0.8).contains(part))
        .map(clearance)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let too_near = least.0 < CLEARANCE * height_m && from.at.distance(to.at) > 2.0 * height_m;
    too_near.then_some(least.1)
}

/// The largest depth in meters by which a wire of `line` comes nearer to the displayed ground than it may, where it need
/// not; 0 where all hang as they should. What a straight wire would lack is not counted.
pub fn check_wires(line: &PowerLine, under: SupportSurface<'_>) -> f64 {
    let clearance_m = line.height_m * CLEARANCE;
    let mut most: f64 = 0.0;
    for pair in line.pylons.windows(2) {
        let (Some(from_z), Some(to_z)) = (under.z(pair[0].at), under.z(pair[1].at)) else { continue };
        let ground = ground_runs(under.displayed, pair[0].at, pair[1].at);
        for (_, up) in fastenings(line) {
            let ends = (pair[0].at.extend(from_z + up), pair[1].at.extend(to_z + up));
            let sag_m = sag(ends, line.sag * ends.0.distance(ends.1), &ground, clearance_m);
            for (part, z) in looks(&ground) {
                let lacks =
                    clearance_m.min(hanging(ends, 0.0, part).z - z) - (hanging(ends, sag_m, part).z - z);
                most = most.max(lacks);
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_terrain::full_resolution::FullResolution;
    use sandtable_terrain::lattice::Lattice;

    /// A ridge of `height_m` across the middle of a kilometer of level ground.
    fn ridge(height_m: f32) -> Lattice {
        let height = |index: u32| if index % 101 == 50 { height_m } else { 0.0 };
        Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 101, (0..101 * 11).map(height).collect())
            .expect("sound")
    }

    fn stand(x: f64) -> PostPosition {
        PostPosition { at: DVec2::new(x, 50.0), along: DVec2::X }
    }

    fn line(pylons: Vec<PostPosition>) -> PowerLine {
        PowerLine { pylons, height_m: 30.0, width_m: 10.0, sag: 0.05 }
    }

    #[test]
    fn a_wire_hangs_less_deep_over_a_ridge_and_keeps_its_clearance() {
        let lattice = ridge(10.0);
        let ground = FullResolution { lattice: &lattice };
        let under = SupportSurface { displayed: &ground, ground: &ground };
        let found = ground_runs(&ground, DVec2::new(350.0, 50.0), DVec2::new(650.0, 50.0));
        let ends = (DVec3::new(350.0, 50.0, 20.4), DVec3::new(650.0, 50.0, 20.4));
        let sag_m = sag(ends, 15.0, &found, 6.0);
        assert!((sag_m - 4.4).abs() < 1e-6, "{sag_m}");
        assert!(check_wires(&line(vec![stand(350.0), stand(650.0)]), under) < 1e-9);
    }

    #[test]
    fn a_pylon_more_stands_on_a_ridge_that_no_wire_would_clear() {
        let lattice = ridge(25.0);
        let ground = FullResolution { lattice: &lattice };
        let (pylons, added) = clear(&[stand(350.0), stand(650.0)], 30.0, &ground);
        assert_eq!(added, 1);
        assert!(pylons[1].at.distance(DVec2::new(500.0, 50.0)) < 1e-3, "{pylons:?}");
        assert_eq!(clear(&[stand(0.0), stand(300.0)], 30.0, &ground).1, 0);
    }

    #[test]
    fn a_pylon_s_feet_reach_the_ground_and_its_top_is_as_high_as_it_is_said_to_be() {
        let lattice = ridge(0.0);
        let ground = FullResolution { lattice: &lattice };
        for height_m in [12.0, 40.0] {
            let mut faces = Faces::default();
            let line = PowerLine { height_m, ..line(vec![stand(300.0)]) };
            line.build(SupportSurface { displayed: &ground, ground: &ground }, &mut faces);
            let mesh = faces.into_mesh();
            let heights = mesh.vertices.iter().map(|vertex| f64::from(vertex.position[2]));
            let (low, high) =
                heights.fold((9e9, -9e9), |(low, high), z| (f64::min(low, z), f64::max(high, z)));
            assert!(low < 0.0 && (high - height_m).abs() < 0.02 * height_m, "{low} to {high}");
        }
    }
}
