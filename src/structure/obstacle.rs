//! Obstacle belts: staggered rows of concrete teeth and steel hedgehogs.
//!
//! ```text
//!   ▲   ▲   ▲   ▲      a row of teeth
//!     ✳   ✳   ✳        a row of hedgehogs, half a spacing on
//!   ▲   ▲   ▲   ▲
//!  ─────────────────► the line runs along the middle
//! ```

use glam::Vec3;

use crate::faces::Faces;
use crate::fence::{PostPosition, spans};
use crate::power_beam::{beam, square};
use sandtable_draw::color::Srgba;
use sandtable_earthworks::alignment::Alignment;
use sandtable_terrain::support_surface::SupportSurface;

const CONCRETE: Srgba = Srgba::opaque(184, 180, 170);
const STEEL: Srgba = Srgba::opaque(112, 84, 68);

/// The angle that each of three beams at right angles to each other makes with the upright, as cosine and sine.
const TO_UPRIGHT: (f32, f32) = (0.577_350_3, 0.816_496_6);

/// The kind of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A blunt pyramid of concrete.
    Tooth,
    /// Three steel beams crossed at right angles.
    Hedgehog,
}

/// Obstacles of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacles {
    /// Where each stands.
    pub stands: Vec<(PostPosition, Obstacle)>,
    /// Above the ground, meters.
    pub height_m: f64,
}

impl Obstacles {
    /// Adds the obstacles that have ground under them to `faces`.
    pub fn build(&self, under: SupportSurface<'_>, faces: &mut Faces) {
        for (stand, obstacle) in &self.stands {
            let Some(z) = under.z(stand.at) else { continue };
            let at = stand.at.extend(z).as_vec3();
            let along = Vec3::new(stand.along.x as f32, stand.along.y as f32, 0.0);
            match obstacle {
                Obstacle::Tooth => tooth(faces, at, along, self.height_m as f32),
                Obstacle::Hedgehog => hedgehog(faces, at, along, self.height_m as f32),
            }
        }
    }
}

fn tooth(faces: &mut Faces, at: Vec3, along: Vec3, height_m: f32) {
    // Its sides go on into the ground, so that it stands on any slope.
    let dug_m = 0.6 * height_m;
    let half = |up_m: f32| 0.55 * height_m - (up_m * 0.4);
    let ends = (at - Vec3::Z * dug_m, at + Vec3::Z * height_m);
    square(faces, ends, (half(-dug_m), half(height_m)), along, CONCRETE);
}

fn hedgehog(faces: &mut Faces, at: Vec3, along: Vec3, height_m: f32) {
    let (cosine, sine) = TO_UPRIGHT;
    // Half a beam: its upper end is as high as the obstacle, its lower end a little in the ground.
    let half = height_m / 2.0 / cosine * 1.08;
    let middle = at + Vec3::Z * (height_m * 0.46);
    let across = Vec3::Z.cross(along);
    for (turn_cos, turn_sin) in [(1.0, 0.0), (-0.5, 0.866_025_4), (-0.5, -0.866_025_4)] {
        let level = along * turn_cos + across * turn_sin;
        let way = (level * sine + Vec3::Z * cosine) * half;
        beam(faces, (middle - way, middle + way), (height_m * 0.07, height_m * 0.07), STEEL);
    }
}

/// The number of rows of a belt of `width_m`.
pub fn rows(width_m: f64, spacing_m: f64) -> u32 {
    (width_m / spacing_m).floor().min(f64::from(u32::MAX - 1)) as u32 + 1
}

/// The positions of the obstacles of a belt: along every leg of an alignment in rows across its width, every other row
/// moved on by half a spacing.
pub fn belt(alignment: &Alignment, spacing_m: f64) -> Vec<(PostPosition, Obstacle)> {
    let rows = rows(alignment.width.widest_m(), spacing_m);
    let mut stands = Vec::new();
    for [from, to] in alignment.line.legs() {
        let Some(along) = (to - from).try_normalize() else { continue };
        let count = spans(from.distance(to), spacing_m);
        for row in 0..rows {
            let aside_m = (f64::from(row) - f64::from(rows - 1) / 2.0) * spacing_m;
            let (shift, obstacle) =
                if row % 2 == 0 { (0.25, Obstacle::Tooth) } else { (0.75, Obstacle::Hedgehog) };
            stands.extend((0..count).map(|index| {
                let at = from.lerp(to, (f64::from(index) + shift) / f64::from(count));
                (PostPosition { at: at + along.perp() * aside_m, along }, obstacle)
            }));
        }
    }
    stands
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use sandtable_geom::polyline::Polyline;

    #[test]
    fn rows_lie_across_the_width_and_every_other_is_moved_on() {
        let line = Polyline::new([DVec2::ZERO, DVec2::X * 12.0], 0.0);
        let stands = belt(&Alignment::on_ground(line.expect("a line"), 6.0), 3.0);
        assert_eq!(stands.len(), 3 * 4);
        let of = |y: f64| -> Vec<f64> {
            stands.iter().filter(|(stand, _)| stand.at.y == y).map(|(stand, _)| stand.at.x).collect()
        };
        assert_eq!(of(-3.0), [0.75, 3.75, 6.75, 9.75]);
        assert_eq!(of(0.0), [2.25, 5.25, 8.25, 11.25]);
        assert_eq!(of(3.0), of(-3.0));
    }

    #[test]
    fn a_hedgehog_is_as_high_as_it_is_said_to_be_and_touches_the_ground() {
        let mut faces = Faces::default();
        hedgehog(&mut faces, Vec3::ZERO, Vec3::X, 2.0);
        let heights: Vec<f32> = faces.into_mesh().vertices.iter().map(|vertex| vertex.position[2]).collect();
        let (low, high) = heights.iter().fold((9.0f32, -9.0f32), |(low, high), &z| (low.min(z), high.max(z)));
        assert!((-0.4..0.0).contains(&low) && (1.9..2.25).contains(&high), "{low} to {high}");
    }
}
