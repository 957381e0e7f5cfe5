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
use crate::placed_figure::PlacedFigure;
use crate::text::TextStyle;
use sandtable_draw::color::Srgba;
use sandtable_geom::rect::Rect;

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
/// Lines that leave the picture more nearly along its border than this have no number there: sine of the angle.
const SHALLOWEST: f32 = 0.2;
/// The end of a line that tells in which direction it leaves, in pixels.
const END_PX: f32 = 8.0;
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
    /// Which it is, as the caller counts lines.
    pub line: usize,
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

    /// Away from the picture.
    fn outward(self) -> Vec2 {
        match self {
            Self::Bottom => Vec2::Y,
            Self::Left => Vec2::NEG_X,
            Self::Top => Vec2::NEG_Y,
            Self::Right => Vec2::X,
        }
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
/// `taken` and off each other. The first of each axis on a side has its number in full. A line that leaves nothing, round a
/// pole, has its number on it. `placed` gets the numbers.
pub(crate) fn draw_figures(
    grid: &PictureGrid,
    taken: &[PixelBox],
    place: FigurePlace,
    composer: &mut Composer,
    placed: &mut Vec<PlacedFigure>,
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
            for (end, way) in line.runs.iter().flat_map(|run| run_ends(run)) {
                let Some(side) = PictureSide::of(end, sheet.size) else { continue };
                let is_first = !begun.contains(&(side, line.axis));
                let full = Some(&line.full).filter(|_| is_first);
                for figure in full.into_iter().chain([&line.figure]) {
                    let Some((drawing, at)) = number(figure, &way, (side, place), composer) else { continue };
                    let own = PlacedFigure::new((Some(line.line), figure), at, &drawing);
                    if keep(drawing, &mut drawn) {
                        placed.push(own);
                        if *figure == line.full {
                            begun.push((side, line.axis));
                        }
                        break;
                    }
                }
            }
            for ring in line.runs.iter().filter(|run| run.len() > 3 && run.first() == run.last()) {
                for at in ring_places(ring) {
                    let drawing = number_at(&line.full, at, composer);
                    let own = PlacedFigure::new((Some(line.line), &line.full), (at, Vec2::ZERO), &drawing);
                    if sheet.bounds().holds(&drawing.bounds()) && keep(drawing, &mut drawn) {
                        placed.push(own);
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

/// The ends of a run, each with the way from it along the run.
fn run_ends(run: &[Vec2]) -> Vec<(Vec2, Vec<Vec2>)> {
    let ways = [run.to_vec(), run.iter().rev().copied().collect::<Vec<Vec2>>()];
    ways.into_iter().filter_map(|way| Some((*way.first()?, way))).collect()
}

/// The lowest, leftmost, highest and rightmost place of a ring.
fn ring_places(ring: &[Vec2]) -> impl Iterator<Item = Vec2> + '_ {
    let sides = [Vec2::Y, Vec2::NEG_X, Vec2::NEG_Y, Vec2::X];
    sides.into_iter().filter_map(|side| {
        ring.iter().copied().reduce(|best, at| if at.dot(side) > best.dot(side) { at } else { best })
    })
}

/// A number, the place of the line that it belongs to, and the direction from there to the number. `way` is the line from
/// its end: inside the border the number stands on it, outside where it would go on. `None` where it would be beside the
/// line.
fn number(
    figure: &CoordinateFigure,
    way: &[Vec2],
    (side, place): (PictureSide, FigurePlace),
    composer: &mut Composer,
) -> Option<(Drawing, (Vec2, Vec2))> {
    let sheet = composer.sheet;
    let half = figure.set(composer).size * 0.5;
    let inset = half + sheet.px(INSET);
    let (end, back) = (*way.first()?, end_direction(way)?);
    let away = side.outward();
    let steepness = -back.dot(away);
    if steepness < SHALLOWEST {
        return None;
    }
    if place == FigurePlace::Inside {
        let within = PixelBox { min: inset, max: sheet.size - inset };
        let at = first_within(way, &within)?;
        return Some((number_at(figure, at, composer), (at, Vec2::ZERO)));
    }
    let depth = inset.dot(away.abs());
    // Along the line, but never beyond the line's end.
    let aside = (-back - away * steepness) * (depth / steepness);
    let center = end + away * depth + aside.clamp(-half, half);
    Some((number_at(figure, center, composer), (end, -back)))
}

/// The direction from a line's end along it, of length 1.
fn end_direction(way: &[Vec2]) -> Option<Vec2> {
    let end = *way.first()?;
    let far = way.iter().find(|at| at.distance(end) >= END_PX).or(way.last())?;
    (*far - end).try_normalize()
}

/// The first place of a line within a box.
fn first_within(way: &[Vec2], within: &PixelBox) -> Option<Vec2> {
    let rect = Rect { min: within.min.as_dvec2(), max: within.max.as_dvec2() };
    let mut pieces = way.windows(2).map(|pair| rect.clip_line(pair[0].as_dvec2(), pair[1].as_dvec2()));
    let (first, _) = pieces.find_map(|piece| piece)?;
    Some(first.as_vec2())
}

/// A number with its middle at a place.
fn number_at(figure: &CoordinateFigure, center: Vec2, composer: &mut Composer) -> Drawing {
    let sheet = composer.sheet;
    let set = figure.set(composer);
    let half = set.size * 0.5;
    let mut drawing = Drawing::default();
    set.write_haloed((center + Vec2::new(-half.x, half.y)).round(), sheet.px(2.2).max(1.4), &mut drawing);
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(
        grid: &PictureGrid,
        taken: &[PixelBox],
        place: FigurePlace,
        composer: &mut Composer,
    ) -> Vec<Drawing> {
        let mut placed = Vec::new();
        let drawn = draw_figures(grid, taken, place, composer, &mut placed);
        assert_eq!(placed.len(), drawn.len());
        assert!(placed.iter().all(|figure| figure.off_px() < 2.0), "{placed:?}");
        drawn
    }

    #[test]
    fn the_number_of_a_slanting_line_stands_on_it_or_where_it_would_go_on() {
        let mut composer = Composer::new(1920, 1080);
        for slant in [-3.0, -1.0, -0.3, 0.4, 1.0, 3.0] {
            let (end, along) = (Vec2::new(960.0, 1080.0), Vec2::new(slant, -1.0).normalize());
            let grid =
                PictureGrid { lines: vec![line(end, end + along * 300.0, "49")], ..PictureGrid::default() };
            for place in [FigurePlace::Inside, FigurePlace::Outside] {
                let drawn = draw(&grid, &[], place, &mut composer);
                let center = drawn[0].bounds().center();
                let aside = (center - end).perp_dot(along).abs();
                let half = drawn[0].bounds().size() * 0.5;
                let reach = half.x * along.y.abs() + half.y * along.x.abs();
                assert!(aside < reach, "{slant}: {aside} of {reach}");
                assert_eq!(center.y < 1080.0, place == FigurePlace::Inside);
            }
        }
        let along_the_border = line(Vec2::new(960.0, 1080.0), Vec2::new(1500.0, 1040.0), "49");
        let grid = PictureGrid { lines: vec![along_the_border], ..PictureGrid::default() };
        assert!(draw(&grid, &[], FigurePlace::Outside, &mut composer).is_empty());
    }

    #[test]
    fn a_ring_has_its_number_on_it() {
        let mut composer = Composer::new(1920, 1080);
        let at = |n: i32| Vec2::new(960.0, 540.0) + Vec2::from_angle(n as f32 * 0.1) * 300.0;
        let mut run: Vec<Vec2> = (0..63).map(at).collect();
        run.push(run[0]);
        let ring = GridLine { runs: vec![run], ..line(Vec2::ZERO, Vec2::ONE, "88°N") };
        let grid = PictureGrid { lines: vec![ring], ..PictureGrid::default() };
        let drawn = draw(&grid, &[], FigurePlace::Inside, &mut composer);
        assert_eq!(drawn.len(), 1);
        let off = drawn[0].bounds().center().distance(Vec2::new(960.0, 540.0)) - 300.0;
        assert!(off.abs() < 4.0, "{off} px beside the ring");
    }

    fn line(from: Vec2, to: Vec2, text: &str) -> GridLine {
        let figure = |after: &str| CoordinateFigure::Plain(format!("{text}{after}"));
        GridLine {
            line: 0,
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
        let drawn = draw(&grid, &[], FigurePlace::Inside, &mut composer);
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
        assert_eq!(draw(&grid, &[], FigurePlace::Inside, &mut composer).len(), 1);
        let panel = PixelBox::at(Vec2::new(300.0, 1000.0), Vec2::splat(200.0));
        assert!(draw(&grid, &[panel], FigurePlace::Inside, &mut composer).is_empty());
    }

    #[test]
    fn where_a_number_in_full_finds_no_place_its_digits_stand() {
        let mut composer = Composer::new(1920, 1080);
        let level = line(Vec2::new(0.0, 500.0), Vec2::new(900.0, 500.0), "40 18");
        let grid = PictureGrid { lines: vec![level], ..PictureGrid::default() };
        let drawn = draw(&grid, &[], FigurePlace::Outside, &mut composer);
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
