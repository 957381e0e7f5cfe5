//! Curves of DXF as vertices: bulges, arcs, ellipses and splines.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

/// The angle of a chord: its middle lies 0.004 % of the radius off the arc.
const STEP: f64 = TAU / 360.0;

/// The most vertices of one curve.
const MOST_STEPS: f64 = 720.0;

/// Stretches of a spline for each of its control points.
const SPLINE_STEPS: usize = 8;

/// The highest degree of a spline that is read.
const MOST_DEGREE: usize = 16;

/// The vertices after the first of an arc about a center, from an angle over another.
pub(super) fn arc(center: DVec3, radius: f64, from: f64, sweep: f64) -> impl Iterator<Item = DVec3> {
    let steps = (sweep.abs() / STEP).ceil().clamp(1.0, MOST_STEPS);
    (0..=steps as usize).map(move |index| {
        let angle = from + sweep * index as f64 / steps;
        center + DVec3::new(libm::cos(angle), libm::sin(angle), 0.0) * radius
    })
}

/// The sweep, counter-clockwise, between two angles in degrees; all around where they are one.
pub(super) fn sweep_deg(from: f64, to: f64) -> f64 {
    let sweep = (to - from).to_radians().rem_euclid(TAU);
    if sweep < 1e-9 { TAU } else { sweep }
}

/// The vertices of an ellipse between two parameters.
pub(super) fn ellipse(center: DVec3, major: DVec3, minor: DVec3, from: f64, to: f64) -> Vec<DVec3> {
    let sweep = (to - from).rem_euclid(TAU);
    let sweep = if sweep < 1e-9 { TAU } else { sweep };
    let steps = (sweep / STEP).ceil().clamp(1.0, MOST_STEPS);
    let at = |index: usize| {
        let angle = from + sweep * index as f64 / steps;
        center + major * libm::cos(angle) + minor * libm::sin(angle)
    };
    (0..=steps as usize).map(at).collect()
}

/// Adds what lies between a vertex and the next where a bulge bends the line: the tangent of a quarter of the arc's angle,
/// positive to the left.
pub(super) fn bulge(from: DVec3, to: DVec3, bulge: f64, line: &mut Vec<DVec3>) {
    let chord = (to - from).truncate();
    if bulge == 0.0 || !bulge.is_finite() || chord == DVec2::ZERO {
        return;
    }
    let sweep = 4.0 * libm::atan(bulge);
    // From the middle of the chord to the center: half the chord over the tangent of half the sweep.
    let aside = chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let center = (from.truncate() + to.truncate()) / 2.0 + aside;
    let out = from.truncate() - center;
    let steps = (sweep.abs() / STEP).ceil().clamp(1.0, MOST_STEPS);
    for index in 1..steps as usize {
        let share = index as f64 / steps;
        let (sine, cosine) = (libm::sin(sweep * share), libm::cos(sweep * share));
        let at = center + DVec2::new(cosine, sine).rotate(out);
        line.push(at.extend(from.z + (to.z - from.z) * share));
    }
}

/// A spline of control points: their weights, all alike where there are none, and its knots.
#[derive(Clone, Debug, Default)]
pub(super) struct Spline {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub weights: Vec<f64>,
    pub control: Vec<DVec3>,
    /// The points that it was drawn through.
    pub fit: Vec<DVec3>,
}

impl Spline {
    /// Its vertices; its control points or the points that it was drawn through where knots do not fit.
    pub fn vertices(&self) -> Vec<DVec3> {
        let Self { degree, knots, control, fit, .. } = self;
        let is_sound = (1..=MOST_DEGREE).contains(degree)
            && control.len() > *degree
            && knots.len() == control.len() + degree + 1
            && knots.windows(2).all(|pair| pair[0] <= pair[1]);
        if !is_sound {
            return if fit.len() >= 2 { fit.clone() } else { control.clone() };
        }
        let (from, to) = (knots[*degree], knots[control.len()]);
        let steps = control.len() * SPLINE_STEPS;
        (0..=steps).map(|index| self.at(from + (to - from) * index as f64 / steps as f64)).collect()
    }

    /// The place at a parameter (de Boor 1972), by weights.
    fn at(&self, parameter: f64) -> DVec3 {
        let Self { degree, knots, control, .. } = self;
        let last = control.len() - 1;
        // The span that holds the parameter.
        let span = (knots.partition_point(|knot| *knot <= parameter) - 1).clamp(*degree, last);
        let weight = |index: usize| {
            let weight = self.weights.get(index).copied().filter(|weight| *weight > 0.0);
            weight.unwrap_or(1.0)
        };
        let mut points: Vec<(DVec3, f64)> = (0..=*degree)
            .map(|offset| span - degree + offset)
            .map(|index| (control[index] * weight(index), weight(index)))
            .collect();
        for round in 1..=*degree {
            for offset in (round..=*degree).rev() {
                let index = span - degree + offset;
                let (low, high) = (knots[index], knots[index + degree + 1 - round]);
                let share = if high > low { (parameter - low) / (high - low) } else { 0.0 };
                let (before, own) = (points[offset - 1], points[offset]);
                points[offset] = (before.0.lerp(own.0, share), before.1 + (own.1 - before.1) * share);
            }
        }
        let (point, weight) = points[*degree];
        point / weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bulge_of_one_is_half_a_circle_to_the_left() {
        let mut line = vec![DVec3::ZERO];
        bulge(DVec3::ZERO, DVec3::X * 10.0, 1.0, &mut line);
        let lowest = line.iter().map(|at| at.y).fold(0.0, f64::min);
        assert!((lowest + 5.0).abs() < 1e-9, "counter-clockwise runs below: {lowest}");
        assert!(line[1..].iter().all(|at| (at.distance(DVec3::X * 5.0) - 5.0).abs() < 1e-9));
    }

    #[test]
    fn a_rational_spline_of_a_quarter_circle_is_one() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let spline = Spline {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            weights: vec![1.0, half, 1.0],
            control: vec![DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y],
            fit: Vec::new(),
        };
        let vertices = spline.vertices();
        assert_eq!((vertices[0], vertices.len()), (DVec3::X, 25));
        assert!(vertices.iter().all(|at| (at.length() - 1.0).abs() < 1e-12), "{vertices:?}");
        assert!(vertices[24].distance(DVec3::Y) < 1e-12);
        let broken = Spline { knots: vec![0.0, 1.0], ..spline };
        assert_eq!(broken.vertices(), broken.control);
    }
}
