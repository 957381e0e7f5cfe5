//! The lines of a coordinate grid on the ground, with their numbers where they leave the picture.
//!
//! The caller has projected the lines and cut what hides them. They are drawn under labels and furniture: thin, with a
//! light edge, so that they show on dark ground as on light, and do not hide what they cross.

use glam::Vec2;
use tiny_skia::PathBuilder;

use crate::composer::Composer;
use crate::drawing::Drawing;
use crate::figure::CoordinateFigure;
use crate::halo::Halo;
use crate::pixel_box::PixelBox;
use crate::text::TextStyle;
use sandtable_draw::color::Srgba;

/// Widths of ordinary lines and of index lines, in design pixels.
const WIDTHS: [f32; 2] = [0.9, 1.7];
/// How much wider the light edge is than the line, in design pixels.
const EDGE: f32 = 1.6;
/// The line and its edge: what they cross shows through.
const LINE: Srgba = Srgba([0x1e, 0x23, 0x27, 0xb4]);
const LINE_EDGE: Srgba = Srgba([0xfd, 0xfc, 0xf9, 0x50]);

/// How near to the border of the picture a line ends that leaves it, in pixels.
const AT_BORDER: f32 = 1.5;
/// From the border of the picture to a number, in design pixels.
const INSET: f32 = 6.0;
/// How far beside the picture numbers may reach, in design pixels: to the next part of a page.
const BESIDE: f32 = 44.0;
/// The size of the letters of a square, in design pixels.
const SQUARE: f32 = 34.0;
const SQUARE_INK: Srgba = Srgba([0x1e, 0x23, 0x27, 0xc0]);

/// A grid on a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PictureGrid {
    /// The lines, each axis in rising order.
    pub lines: Vec<GridLine>,
    /// The letters of 100 km squares, where a picture shows several.
    pub squares: Vec<SquareName>,
    /// What the grid is, for the scale bar's panel.
    pub note: Option<String>,
}

/// A line of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridLine {
    /// The coordinate that is constant along it.
    pub axis: GridAxis,
    /// The parts that show: pixels from the picture's upper left corner, Y down.
    pub runs: Vec<Vec<Vec2>>,
    /// Whether it is one of the few that are drawn heavier.
    pub is_index: bool,
    /// Its number.
    pub figure: CoordinateFigure,
    /// Its full number, shown on the first line of each side.
    pub full: CoordinateFigure,
}

/// The coordinate that is constant along a line of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GridAxis {
    /// Easting or longitude.
    East,
    /// Northing or latitude.
    North,
}

/// The letters of a 100 km square at a place in it.
#[derive(Clone, Debug, PartialEq)]
pub struct SquareName {
    /// The place: pixels from the picture's upper left corner, Y down.
    pub at_px: Vec2,
    /// The letters.
    pub letters: String,
}

/// The lines of a grid: first what lies below, ordinary lines, then index lines.
pub(crate) fn draw_lines(grid: &PictureGrid, composer: &Composer) -> Drawing {
    let sheet = composer.sheet;
    let mut drawing = Drawing::default();
    for (is_index, width) in [(false, WIDTHS[0]), (true, WIDTHS[1])] {
        let mut path = PathBuilder::new();
        for run in grid.lines.iter().filter(|line| line.is_index == is_index).flat_map(|line| &line.runs) {
            if let [first, rest @ ..] = run.as_slice()
                && !rest.is_empty()
            {
                path.move_to(first.x, first.y);
                rest.iter().for_each(|at| path.line_to(at.x, at.y));
            }
        }
        if let Some(path) = path.finish() {
            let width = sheet.px(width).max(0.7);
            drawing.stroke(&path, width + sheet.px(EDGE).max(1.0), LINE_EDGE);
            drawing.stroke(&path, width, LINE);
        }
    }
    drawing
}

/// A side of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum PictureSide {
    Bottom,
    Left,
    Top,
    Right,
}

impl PictureSide {
    fn of(at: Vec2, size: Vec2) -> Option<Self> {
        let reach = [
            (Self::Bottom, size.y - at.y),
            (Self::Left, at.x),
            (Self::Top, at.y),
            (Self::Right, size.x - at.x),
        ];
        reach.into_iter().find(|(_, off)| *off <= AT_BORDER).map(|(side, _)| side)
    }
}

/// Where the numbers of lines stand that leave the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FigurePlace {
    /// On the picture, inside its border.
    Inside,
    /// Beside the picture, on the margin.
    Outside,
}

/// The numbers of the lines where they leave the picture, and the letters of squares: those that find a place off
/// `taken` and off each other. The first of each axis on a side has its number in full.
pub(crate) fn draw_figures(
    grid: &PictureGrid,
    taken: &[PixelBox],
    place: FigurePlace,
    composer: &mut Composer,
) -> Vec<Drawing> {
    let sheet = composer.sheet;
    let beside = if place == FigurePlace::Outside { sheet.px(BESIDE) } else { 0.0 };
    let within = sheet.bounds().grown(beside);
    let mut drawn: Vec<Drawing> = Vec::new();
    let keep = |drawing: Drawing, drawn: &mut Vec<Drawing>| {
        let spaced = drawing.bounds().grown(sheet.px(6.0));
        let is_free = within.holds(&drawing.bounds())
            && !taken.iter().any(|other| other.overlaps(&spaced))
            && !drawn.iter().any(|other| other.bounds().overlaps(&spaced));
        if is_free {
            drawn.push(drawing);
        }
        is_free
    };
    let mut begun: Vec<(PictureSide, GridAxis)> = Vec::new();
    // Index lines first: where there is no place for all numbers, theirs stay.
    for is_index in [true, false] {
        for line in grid.lines.iter().filter(|line| line.is_index == is_index) {
            for &end in line.runs.iter().flat_map(|run| [run.first(), run.last()]).flatten() {
                let Some(side) = PictureSide::of(end, sheet.size) else { continue };
                let is_first = !begun.contains(&(side, line.axis));
                let full = Some(&line.full).filter(|_| is_first);
                for figure in full.into_iter().chain([&line.figure]) {
                    if keep(number(figure, end, (side, place), composer), &mut drawn) {
                        if *figure == line.full {
                            begun.push((side, line.axis));
                        }
                        break;
                    }
                }
            }
        }
    }
    for square in &grid.squares {
        let style = TextStyle { tracking: 0.12, ..composer.style(SQUARE, TextStyle::MEDIUM) };
        let letters = composer.line(&square.letters, style);
        let mut drawing = Drawing::default();
        let start = square.at_px + Vec2::new(-letters.advance, letters.style.cap_px()) * 0.5;
        drawing.draw_halo(&[(&letters, start.round())], Halo::paper(sheet.px(2.4)));
        drawing.write(&letters, start.round(), SQUARE_INK);
        keep(drawing, &mut drawn);
    }
    drawn
}

/// A number inside the border, its middle on the line's end.
fn number(
    figure: &CoordinateFigure,
    end: Vec2,
    (side, place): (PictureSide, FigurePlace),
    composer: &mut Composer,
) -> Drawing {
    let sheet = composer.sheet;
    let set = figure.set(composer);
    let half = set.size * 0.5;
    let inset = half + sheet.px(INSET);
    let inset = if place == FigurePlace::Outside { -inset } else { inset };
    let center = match side {
        PictureSide::Bottom => Vec2::new(end.x, sheet.size.y - inset.y),
        PictureSide::Top => Vec2::new(end.x, inset.y),
        PictureSide::Left => Vec2::new(inset.x, end.y),
        PictureSide::Right => Vec2::new(sheet.size.x - inset.x, end.y),
    };
    // A line that leaves near a corner keeps its number in the picture.
    let center = match place {
        FigurePlace::Inside => {
            center.clamp(inset.min(sheet.size * 0.5), (sheet.size - inset).max(sheet.size * 0.5))
        }
        FigurePlace::Outside => center,
    };
    let mut drawing = Drawing::default();
    set.write_haloed((center + Vec2::new(-half.x, half.y)).round(), sheet.px(2.2).max(1.4), &mut drawing);
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: Vec2, to: Vec2, text: &str) -> GridLine {
        let figure = |after: &str| CoordinateFigure::Plain(format!("{text}{after}"));
        GridLine {
            axis: GridAxis::East,
            runs: vec![vec![from, to]],
            is_index: false,
            figure: figure(""),
            full: figure(" 000 m E"),
        }
    }

    #[test]
    fn a_line_is_numbered_on_both_sides_that_it_leaves_by_and_the_first_in_full() {
        let mut composer = Composer::new(1920, 1080);
        let lines = [400.0, 800.0].map(|x| line(Vec2::new(x, 0.0), Vec2::new(x, 1080.0), "49"));
        let grid = PictureGrid { lines: lines.to_vec(), ..PictureGrid::default() };
        let drawn = draw_figures(&grid, &[], FigurePlace::Inside, &mut composer);
        assert_eq!(drawn.len(), 4);
        let width = |at: usize| drawn[at].bounds().size().x;
        assert!(width(0) > 2.0 * width(2) && width(1) > 2.0 * width(3));
        assert!(drawn.iter().all(|number| composer.sheet.bounds().holds(&number.bounds())));
    }

    #[test]
    fn numbers_keep_off_furniture_and_one_another_and_lines_that_end_inside_have_none() {
        let mut composer = Composer::new(1920, 1080);
        let crowded = [400.0, 405.0].map(|x| line(Vec2::new(x, 300.0), Vec2::new(x, 1080.0), "49"));
        let grid = PictureGrid { lines: crowded.to_vec(), ..PictureGrid::default() };
        assert_eq!(draw_figures(&grid, &[], FigurePlace::Inside, &mut composer).len(), 1);
        let panel = PixelBox::at(Vec2::new(300.0, 1000.0), Vec2::splat(200.0));
        assert!(draw_figures(&grid, &[panel], FigurePlace::Inside, &mut composer).is_empty());
    }

    #[test]
    fn where_a_number_in_full_finds_no_place_its_digits_stand() {
        let mut composer = Composer::new(1920, 1080);
        let level = line(Vec2::new(0.0, 500.0), Vec2::new(900.0, 500.0), "40 18");
        let grid = PictureGrid { lines: vec![level], ..PictureGrid::default() };
        let drawn = draw_figures(&grid, &[], FigurePlace::Outside, &mut composer);
        assert_eq!(drawn.len(), 1);
        assert!(drawn[0].bounds().max.x < 0.0 && drawn[0].bounds().min.x > -BESIDE);
    }

    #[test]
    fn lines_of_both_weights_are_drawn_and_broken_ones_left_out() {
        let mut lines = vec![line(Vec2::ZERO, Vec2::splat(90.0), "1")];
        lines.push(GridLine { is_index: true, ..lines[0].clone() });
        lines.push(GridLine { runs: vec![vec![Vec2::ONE], Vec::new()], ..lines[0].clone() });
        let grid = PictureGrid { lines, ..PictureGrid::default() };
        assert_eq!(draw_lines(&grid, &Composer::new(200, 200)).marks.len(), 4);
    }
}
