//! Strokes that thin out: the hachures of rock.

use glam::Vec2;
use tiny_skia::PathBuilder;

use crate::annotation::TaperedStroke;
use crate::drawing::Drawing;
use sandtable_draw::color::Srgba;

/// The ink of rock: a warm black, as Swiss maps print it, through which a little of the shade shows.
const ROCK_INK: Srgba = Srgba([0x36, 0x2f, 0x2b, 0xdc]);

/// All strokes as one filled path: where two cross, their ink is not darker.
pub fn draw_rock(strokes: &[TaperedStroke]) -> Drawing {
    let mut path = PathBuilder::new();
    for outline in strokes.iter().map(outline) {
        let Some((first, rest)) = outline.split_first() else { continue };
        path.move_to(first.x, first.y);
        rest.iter().for_each(|at| path.line_to(at.x, at.y));
        path.close();
    }
    let mut drawing = Drawing::default();
    if let Some(path) = path.finish() {
        drawing.fill(path, ROCK_INK);
    }
    drawing
}

/// The outline of a stroke, with ends cut straight; empty for fewer than two places or widths that are no numbers.
fn outline(stroke: &TaperedStroke) -> Vec<Vec2> {
    let path = &stroke.path_px;
    let [from, to] = stroke.width_px;
    if path.len() < 2 || !(from + to).is_finite() || !path.iter().all(|at| at.is_finite()) {
        return Vec::new();
    }
    let legs = (path.len() - 1) as f32;
    let side = |sign: f32| {
        path.iter().enumerate().map(move |(number, at)| {
            let (before, after) = (path[number.saturating_sub(1)], path[(number + 1).min(path.len() - 1)]);
            let width = from + (to - from) * number as f32 / legs;
            *at + (after - before).normalize_or_zero().perp() * (width * 0.5 * sign)
        })
    };
    side(1.0).chain(side(-1.0).rev()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_is_as_wide_at_its_ends_as_it_says_and_odd_ones_are_nothing() {
        let path_px = vec![Vec2::ZERO, Vec2::new(0.0, 10.0), Vec2::new(0.0, 20.0)];
        let stroke = TaperedStroke { path_px, width_px: [4.0, 1.0] };
        let outline = outline(&stroke);
        assert_eq!(outline[0].distance(outline[5]), 4.0);
        assert_eq!(outline[2].distance(outline[3]), 1.0);
        let odd = TaperedStroke { width_px: [f32::NAN, 1.0], ..stroke.clone() };
        let short = TaperedStroke { path_px: vec![Vec2::ZERO], ..stroke };
        assert!(draw_rock(&[odd, short]).marks.is_empty());
    }
}
