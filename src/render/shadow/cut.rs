//! Cuts outlines at a line (Sutherland and Hodgman 1974).

use std::ops::{Add, Mul, Sub};

/// The part of an outline where `inside` is not negative; it is linear along the sides.
pub fn cut_at<P>(outline: &[P], inside: impl Fn(P) -> f32) -> Vec<P>
where
    P: Copy + Add<Output = P> + Sub<Output = P> + Mul<f32, Output = P>,
{
    let mut kept = Vec::with_capacity(outline.len() + 1);
    for (index, &here) in outline.iter().enumerate() {
        let next = outline[(index + 1) % outline.len()];
        let (from, to) = (inside(here), inside(next));
        if from >= 0.0 {
            kept.push(here);
        }
        if (from >= 0.0) != (to >= 0.0) {
            kept.push(here + (next - here) * (from / (from - to)));
        }
    }
    kept
}
