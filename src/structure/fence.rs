//! The posts of fences, and where things stand along a line.

use glam::{DVec2, DVec3, Vec3};

use crate::faces::Faces;
use crate::power_beam::square;
use sandtable_draw::color::Srgba;
use sandtable_geom::polyline::Polyline;
use sandtable_terrain::support_surface::SupportSurface;

const WOOD: Srgba = Srgba::opaque(150, 124, 92);

/// The position of something along a line, and the line's direction there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PostPosition {
    /// World X and Y, meters.
    pub at: DVec2,
    /// A unit vector along the line.
    pub along: DVec2,
}

impl PostPosition {
    /// The point `aside_m` to the left of the line there, at height `z`.
    pub fn beside(&self, aside_m: f64, z: f64) -> DVec3 {
        (self.at + self.along.perp() * aside_m).extend(z)
    }
}

/// Posts of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Posts {
    /// Where they stand.
    pub stands: Vec<PostPosition>,
    /// From side to side, meters.
    pub width_m: f64,
    /// Above the ground, meters.
    pub height_m: f64,
}

impl Posts {
    /// Adds the posts that have ground under them to `faces`.
    pub fn build(&self, under: SupportSurface<'_>, faces: &mut Faces) {
        // Dug in, so that no side ends above the ground on a slope.
        let dug_m = self.width_m.max(0.2 * self.height_m);
        let half = (self.width_m / 2.0) as f32;
        for stand in &self.stands {
            let Some(z) = under.z(stand.at) else { continue };
            let at = |up_m: f64| stand.at.extend(z + up_m).as_vec3();
            let along = Vec3::new(stand.along.x as f32, stand.along.y as f32, 0.0);
            square(faces, (at(-dug_m), at(self.height_m)), (half, half), along, WOOD);
        }
    }
}

/// The positions of posts along a line: at every vertex and, evenly in between, no more than `spacing_m` apart. Each
/// stands along the bisector of the line at it.
pub fn stands(line: &Polyline, spacing_m: f64) -> Vec<PostPosition> {
    let (points, round, mut stands) = (line.points(), line.is_closed(), Vec::new());
    let direction = |from: DVec2, to: DVec2| (to - from).normalize_or(DVec2::X);
    for (index, [from, to]) in line.legs().enumerate() {
        let along = direction(from, to);
        let before = match index {
            0 if round => direction(points[points.len() - 2], points[0]),
            0 => along,
            _ => direction(points[index - 1], from),
        };
        stands.push(PostPosition { at: from, along: (before + along).normalize_or(along) });
        let count = spans(from.distance(to), spacing_m);
        let between = (1..count).map(|step| from.lerp(to, f64::from(step) / f64::from(count)));
        stands.extend(between.map(|at| PostPosition { at, along }));
    }
    if let ([.., before, last], false) = (points, round) {
        stands.push(PostPosition { at: *last, along: direction(*before, *last) });
    }
    stands
}

/// The number of spans of up to `spacing_m` that a length takes; at least one.
pub fn spans(length_m: f64, spacing_m: f64) -> u32 {
    // A hair's breadth over a whole number is rounding, not a span.
    (length_m / spacing_m - 1e-9).ceil().clamp(1.0, f64::from(u32::MAX)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn posts_stand_at_vertices_and_no_further_apart_than_they_may() {
        let points = [DVec2::ZERO, DVec2::X * 10.0, DVec2::new(10.0, 7.0)];
        let stands = stands(&Polyline::new(points, 0.0).expect("a line"), 3.0);
        assert_eq!(stands.len(), 4 + 3 + 1);
        assert!(points.iter().all(|&point| stands.iter().any(|stand| stand.at == point)));
        assert!(stands.windows(2).all(|pair| pair[0].at.distance(pair[1].at) <= 3.0 + 1e-9));
        let corner = stands.iter().find(|stand| stand.at == points[1]).expect("a post at the corner");
        assert!((corner.along - DVec2::ONE.normalize()).length() < 1e-12);
    }

    #[test]
    fn a_fence_that_runs_round_has_one_post_where_it_begins() {
        let ring = [DVec2::ZERO, DVec2::X * 4.0, DVec2::splat(4.0), DVec2::Y * 4.0, DVec2::ZERO];
        assert_eq!(stands(&Polyline::new(ring, 0.0).expect("a line"), 2.0).len(), 8);
    }
}
