//! Coordinates where lines end: at the edge of a block of terrain, and where the ground does. A tick goes on from the line,
//! and its number stands at the tick's end.

use glam::Vec2;

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::figure::CoordinateFigure;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::placed_figure::PlacedFigure;
use crate::sheet::INK;

/// The length of a tick, and the gap between it and the number, in design pixels.
const TICK: f32 = 8.0;
const GAP: f32 = 4.0;

/// A coordinate at the edge of the block.
#[derive(Clone, Debug, PartialEq)]
pub struct RimMark {
    /// The line that ends here, as the caller counts lines; `None` for a coordinate that no line has.
    pub line: Option<usize>,
    /// The place on the edge: pixels from the picture's upper left corner, Y down.
    pub at_px: Vec2,
    /// The direction in which the line would go on from there; marks without one are left out.
    pub outward: Vec2,
    /// The coordinate.
    pub figure: CoordinateFigure,
    /// The full coordinate, and a number for the row of marks that it is one of: the first mark of a row that has space for
    /// the full coordinate shows it.
    pub full: Option<(CoordinateFigure, usize)>,
}

/// Draws the marks that fit: inside the margin, off the furniture in `taken`, and off each other, the first before the
/// later. Returns one drawing per mark that is drawn; `placed` gets their numbers.
pub(crate) fn draw_marks(
    marks: &[RimMark],
    taken: &[PixelBox],
    composer: &mut Composer,
    placed: &mut Vec<PlacedFigure>,
) -> Vec<Drawing> {
    let mut drawn: Vec<Drawing> = Vec::new();
    let mut covered: Vec<PixelBox> = Vec::new();
    let sheet = composer.sheet;
    let within = sheet.bounds().grown(-sheet.px(3.0));
    let mut begun: Vec<usize> = Vec::new();
    for mark in marks {
        let full = mark.full.as_ref().filter(|(_, edge)| !begun.contains(edge));
        let figures =
            full.map(|(figure, edge)| (figure, Some(*edge))).into_iter().chain([(&mark.figure, None)]);
        for (figure, edge) in figures {
            let Some((tick, number, outward)) = draw(mark, figure, composer) else { continue };
            let own = PlacedFigure::new((mark.line, figure), (mark.at_px, outward), &number);
            // A slanting tick and its number are no box together: others stand between them.
            let parts = [tick.bounds(), number.bounds()];
            let spaced = [parts[0], parts[1].grown(sheet.px(6.0))];
            let mut drawing = tick;
            drawing.append(number);
            let bounds = drawing.bounds();
            let is_free = |other: &PixelBox| spaced.iter().all(|own| !own.overlaps(other));
            if within.holds(&bounds) && taken.iter().all(is_free) && covered.iter().all(is_free) {
                drawn.push(drawing);
                covered.extend(parts);
                placed.push(own);
                begun.extend(edge);
                break;
            }
        }
    }
    drawn
}

/// The tick, the number, and the direction from the mark's place to it.
fn draw(
    mark: &RimMark,
    figure: &CoordinateFigure,
    composer: &mut Composer,
) -> Option<(Drawing, Drawing, Vec2)> {
    let sheet = composer.sheet;
    let outward = mark.outward.try_normalize().filter(|_| mark.at_px.is_finite())?;
    let figure = figure.set(composer);
    let end = mark.at_px + outward * sheet.px(TICK);
    let half = figure.size * 0.5;
    let center = end + outward * (outward.abs().dot(half) + sheet.px(GAP));
    let (mut tick, mut number) = (Drawing::default(), Drawing::default());
    tick.line(PixelSegment { from: mark.at_px, to: end }, sheet.hairline(), INK);
    figure.write_haloed((center + Vec2::new(-half.x, half.y)).round(), sheet.px(1.5), &mut number);
    Some((tick, number, outward))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(marks: &[RimMark], taken: &[PixelBox], composer: &mut Composer) -> Vec<Drawing> {
        draw_marks(marks, taken, composer, &mut Vec::new())
    }

    fn mark(x: f32, y: f32, outward: Vec2) -> RimMark {
        let figure = "345 000 E".to_owned().into();
        RimMark { line: None, at_px: Vec2::new(x, y), outward, figure, full: None }
    }

    #[test]
    fn a_mark_stands_outside_the_edge_and_reads_away_from_it() {
        let mut composer = Composer::new(1920, 1080);
        for outward in [Vec2::Y, Vec2::NEG_X, Vec2::new(0.5, 0.8)] {
            let mut placed = Vec::new();
            let drawings = draw_marks(&[mark(900.0, 500.0, outward)], &[], &mut composer, &mut placed);
            assert!(placed.len() == 1 && placed[0].off_px() < 1.0, "{placed:?}");
            let toward = (drawings[0].bounds().center() - Vec2::new(900.0, 500.0)).normalize();
            assert!(toward.dot(outward.normalize()) > 0.9, "{outward}: {toward}");
        }
    }

    #[test]
    fn the_first_mark_on_an_edge_is_in_full_where_there_is_a_place_for_it() {
        let mut composer = Composer::new(1920, 1080);
        let numbered = |x: f32| RimMark {
            figure: "45".to_owned().into(),
            full: Some(("345 000 m E".to_owned().into(), 0)),
            ..mark(x, 500.0, Vec2::Y)
        };
        let drawn = draw(&[numbered(20.0), numbered(500.0), numbered(900.0)], &[], &mut composer);
        let widths: Vec<f32> = drawn.iter().map(|drawing| drawing.bounds().size().x).collect();
        assert!((widths[0] - widths[2]).abs() < 0.1 && widths[1] > 2.0 * widths[0], "{widths:?}");
    }

    #[test]
    fn marks_that_meet_furniture_each_other_or_the_border_are_left_out() {
        let mut composer = Composer::new(1920, 1080);
        let marks = [
            mark(900.0, 500.0, Vec2::Y),
            mark(910.0, 500.0, Vec2::Y),
            mark(1200.0, 500.0, Vec2::Y),
            mark(1915.0, 500.0, Vec2::X),
            mark(300.0, 500.0, Vec2::ZERO),
            mark(f32::NAN, 500.0, Vec2::Y),
        ];
        let panel = PixelBox::at(Vec2::new(1150.0, 480.0), Vec2::splat(100.0));
        assert_eq!(draw(&marks, &[panel], &mut composer).len(), 1);
    }
}
