//! Labels: selection, order and drawing.
//!
//! Names at places and names along lines take their turns in one order of importance. Repetitions of a name along its
//! line come after all names; a name that finds no place along its line is tried at a place then. The numbers of
//! contour lines come last.

use crate::annotation::{Annotations, LineLabel, PictureLabel};
use crate::composer::Composer;
use crate::contour_label::draw_contours;
use crate::drawing::Drawing;
use crate::line_label::PreparedLine;
use crate::pixel_box::PixelBox;
use crate::place::{LabelCandidate, LabelField, LabelPlacer, LabelRequest};
use crate::point_label::PreparedLabel;
use crate::report::{AnnotationReport, LabelMove, LabelOutcome, SheetBox};
use crate::sheet::Sheet;
use sandtable_description::words::LabelKind;
use sandtable_draw::pixels::Pixels;

/// More labels are not tried: no picture has room for them, and the time grows with their number.
const MOST_LABELS: usize = 4096;

/// Draws the labels that are visible and find a free place beside `furniture` on the picture `ground`; reports the outcome of each.
pub fn draw_labels(
    annotations: &Annotations,
    ground: &Pixels,
    furniture: &[PixelBox],
    composer: &mut Composer,
    report: &mut AnnotationReport,
) -> Drawing {
    let (labels, lines) = (&annotations.labels, &annotations.line_labels);
    let sheet = composer.sheet;
    let field = field(furniture, &sheet);
    let mut placer = LabelPlacer::new(&field);
    let mut sheet_names = SheetNames {
        names: Vec::new(),
        outcomes: vec![LabelOutcome::CrowdedOut; labels.len() + lines.len()],
    };
    let turns: Vec<LabelTurn<'_>> = by_importance(labels, lines);
    for turn in &turns {
        if sheet_names.names.len() < MOST_LABELS {
            match PreparedName::new(turn, composer) {
                Ok(name) => sheet_names.names.push(NumberedName {
                    number: turn.number,
                    name,
                    drawn: Vec::new(),
                    was_along: matches!(turn.source, LabelSource::Line(_)),
                }),
                Err(outcome) => sheet_names.outcomes[turn.number] = outcome,
            }
        }
    }
    sheet_names.place_first(&mut placer);
    sheet_names.place_repetitions(&mut placer);
    sheet_names.place_fallbacks(&mut placer, composer);
    let numbers = annotations
        .contours
        .as_ref()
        .map(|marks| draw_contours(marks, &mut placer, ground, composer, &mut report.boxes));
    let mut drawing = numbers.unwrap_or_default();
    drawing.append(sheet_names.draw(ground, &sheet));
    report.add_texts(&drawing.texts);
    report.boxes.extend(furniture.iter().map(SheetBox::of_furniture));
    report.boxes.extend(sheet_names.names.iter().flat_map(NumberedName::boxes));
    let texts = labels.iter().map(|label| &label.text).chain(lines.iter().map(|line| &line.text));
    texts.zip(&sheet_names.outcomes).for_each(|(text, outcome)| outcome.report(text, report));
    drawing
}

/// The field of labels: inside half of the margin, off the furniture.
fn field(furniture: &[PixelBox], sheet: &Sheet) -> LabelField {
    LabelField {
        bounds: sheet.bounds().grown(-(sheet.margin() * 0.4).round()),
        taken: furniture.iter().map(|taken| taken.grown(sheet.px(6.0))).collect(),
        leader_gap: sheet.px(5.0),
    }
}

/// A label in the order of importance.
struct LabelTurn<'a> {
    /// Among the labels at places, or behind them among those along lines.
    number: usize,
    source: LabelSource<'a>,
}

#[derive(Clone, Copy)]
enum LabelSource<'a> {
    Point(&'a PictureLabel),
    Line(&'a LineLabel),
}

impl LabelSource<'_> {
    fn rank(&self) -> f64 {
        match self {
            Self::Point(label) => label.rank,
            Self::Line(label) => label.rank,
        }
    }

    fn kind_order(&self) -> u8 {
        let kind = match self {
            Self::Point(label) => label.kind,
            Self::Line(label) => label.kind,
        };
        match kind {
            LabelKind::Summit => 0,
            LabelKind::Place => 1,
            LabelKind::Area => 2,
            LabelKind::Water => 3,
            LabelKind::Road => 4,
            LabelKind::Point => 5,
        }
    }

    /// Names along lines come after names at places that are like them in all else.
    fn depth_m(&self) -> f32 {
        match self {
            Self::Point(label) => label.depth_m,
            Self::Line(_) => f32::INFINITY,
        }
    }

    fn text(&self) -> &str {
        match self {
            Self::Point(label) => &label.text,
            Self::Line(label) => &label.text,
        }
    }
}

/// Rank first, then kind, then the nearer, then by text; equal labels keep the input's order.
fn by_importance<'a>(labels: &'a [PictureLabel], lines: &'a [LineLabel]) -> Vec<LabelTurn<'a>> {
    let sources = labels.iter().map(LabelSource::Point).chain(lines.iter().map(LabelSource::Line));
    let mut order: Vec<_> =
        sources.enumerate().map(|(number, source)| LabelTurn { number, source }).collect();
    order.sort_by(|LabelTurn { source: a, .. }, LabelTurn { source: b, .. }| {
        let by_rank = a.rank().total_cmp(&b.rank()).then(a.kind_order().cmp(&b.kind_order()));
        by_rank.then(a.depth_m().total_cmp(&b.depth_m())).then_with(|| a.text().cmp(b.text()))
    });
    order
}

/// A label with its text set.
enum PreparedName<'a> {
    Point(Box<PreparedLabel<'a>>),
    Line(PreparedLine<'a>),
}

impl<'a> PreparedName<'a> {
    fn new(turn: &LabelTurn<'a>, composer: &mut Composer) -> Result<Self, LabelOutcome> {
        match turn.source {
            LabelSource::Point(label) => Self::at_place(label, composer).map(Self::point),
            LabelSource::Line(label) => {
                let line = PreparedLine::new(label, composer).ok_or(LabelOutcome::Empty)?;
                match &label.fallback {
                    _ if line.count() > 0 => Ok(Self::Line(line)),
                    Some(fallback) => Self::off_line(fallback, composer),
                    None if label.path_px.is_empty() => Err(LabelOutcome::Hidden),
                    None => Err(LabelOutcome::CrowdedOut),
                }
            }
        }
    }

    fn point(label: PreparedLabel<'a>) -> Self {
        Self::Point(Box::new(label))
    }

    /// The name of a line or an area that finds no place along it.
    fn off_line(fallback: &'a PictureLabel, composer: &mut Composer) -> Result<Self, LabelOutcome> {
        Self::at_place(fallback, composer).map(|label| Self::point(label.without_symbol()))
    }

    fn at_place(label: &'a PictureLabel, composer: &mut Composer) -> Result<PreparedLabel<'a>, LabelOutcome> {
        if !composer.sheet.bounds().contains(label.anchor_px) {
            return Err(LabelOutcome::Outside);
        }
        if !label.visible {
            return Err(LabelOutcome::Hidden);
        }
        PreparedLabel::new(label, composer)
    }

    fn first_request(&self) -> LabelRequest {
        match self {
            Self::Point(label) => label.request(),
            Self::Line(line) => line.request(0),
        }
    }
}

/// A name with what is drawn of it.
struct NumberedName<'a> {
    /// As in [`LabelTurn`].
    number: usize,
    name: PreparedName<'a>,
    drawn: Vec<DrawnName>,
    /// Whether it was wished along a line.
    was_along: bool,
}

impl NumberedName<'_> {
    /// The boxes of what is drawn of it.
    fn boxes(&self) -> Vec<SheetBox> {
        let boxes = |drawn: &DrawnName| match &self.name {
            PreparedName::Point(label) => SheetBox::of(&label.label.text, &label.positions[drawn.choice]),
            PreparedName::Line(line) => {
                SheetBox::of(&line.label.text, line.candidate(drawn.occurrence, drawn.choice))
            }
        };
        self.drawn.iter().flat_map(boxes).collect()
    }

    /// How what was drawn departs from what was wished.
    fn moved(&self) -> Option<LabelMove> {
        match &self.name {
            PreparedName::Point(_) if self.was_along => Some(LabelMove::OffLine),
            PreparedName::Point(label) => {
                let position = &label.positions[self.drawn.first()?.choice];
                (position.leader.is_some() && label.label.top_px.is_none()).then_some(LabelMove::Led)
            }
            PreparedName::Line(_) => None,
        }
    }
}

/// An occurrence of a name, and the candidate chosen for it.
#[derive(Clone, Copy)]
struct DrawnName {
    occurrence: usize,
    choice: usize,
}

/// All names of a sheet, in the order of importance.
struct SheetNames<'a> {
    names: Vec<NumberedName<'a>>,
    /// By the numbers of labels.
    outcomes: Vec<LabelOutcome>,
}

impl<'a> SheetNames<'a> {
    fn place_first(&mut self, placer: &mut LabelPlacer<'_>) {
        let requests: Vec<LabelRequest> = self.names.iter().map(|name| name.name.first_request()).collect();
        for (name, choice) in self.names.iter_mut().zip(placer.place(&requests)) {
            name.drawn.extend(choice.map(|choice| DrawnName { occurrence: 0, choice }));
        }
    }

    fn place_repetitions(&mut self, placer: &mut LabelPlacer<'_>) {
        for name in &mut self.names {
            if let PreparedName::Line(line) = &name.name {
                let requests: Vec<_> = (1..line.count()).map(|occurrence| line.request(occurrence)).collect();
                for (index, choice) in placer.place(&requests).into_iter().enumerate() {
                    name.drawn.extend(choice.map(|choice| DrawnName { occurrence: index + 1, choice }));
                }
            }
        }
    }

    /// Names along lines that found no place on them become names at places.
    fn place_fallbacks(&mut self, placer: &mut LabelPlacer<'_>, composer: &mut Composer) {
        for name in self.names.iter_mut().filter(|name| name.drawn.is_empty()) {
            let PreparedName::Line(PreparedLine {
                label: LineLabel { fallback: Some(fallback), .. }, ..
            }) = &name.name
            else {
                continue;
            };
            if let Ok(prepared) = PreparedName::off_line(fallback, composer) {
                let choice = placer.place(&[prepared.first_request()])[0];
                name.drawn.extend(choice.map(|choice| DrawnName { occurrence: 0, choice }));
                name.name = prepared;
            }
        }
    }

    /// Symbols and leaders first, then names along lines, all other texts over them.
    fn draw(&mut self, ground: &Pixels, sheet: &Sheet) -> Drawing {
        let mut drawing = Drawing::default();
        let points = |name: &'_ NumberedName<'a>| -> Option<LabelCandidate> {
            let PreparedName::Point(label) = &name.name else { return None };
            name.drawn.first().map(|drawn| label.positions[drawn.choice].clone())
        };
        for name in &self.names {
            if let (PreparedName::Point(label), Some(position)) = (&name.name, points(name)) {
                label.draw_symbol(&position, ground, sheet, &mut drawing);
            }
        }
        for name in &self.names {
            if let PreparedName::Line(line) = &name.name {
                name.drawn
                    .iter()
                    .for_each(|drawn| line.draw(drawn.occurrence, drawn.choice, ground, sheet, &mut drawing));
            }
        }
        for name in &self.names {
            if let (PreparedName::Point(label), Some(position)) = (&name.name, points(name)) {
                label.draw_text(&position, ground, &mut drawing);
            }
        }
        // In the order of the input.
        let mut in_order: Vec<&NumberedName<'a>> =
            self.names.iter().filter(|name| !name.drawn.is_empty()).collect();
        in_order.sort_by_key(|name| name.number);
        for name in in_order {
            self.outcomes[name.number] = LabelOutcome::Placed(name.moved());
            match &name.name {
                PreparedName::Point(label) => {
                    drawing.record_text(&label.label.text, label.block.missing(), label.block.shortened);
                }
                PreparedName::Line(line) => drawing.record_text(&line.label.text, line.missing, false),
            }
        }
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotation::samples::label;
    use sandtable_draw::color::Srgba;

    fn draw(labels: &[PictureLabel]) -> (Drawing, AnnotationReport) {
        let mut report = AnnotationReport::default();
        let annotations = Annotations { labels: labels.to_vec(), ..Annotations::default() };
        let ground = Pixels::filled(1920, 1080, Srgba::opaque(120, 150, 100));
        let mut composer = Composer::new(1920, 1080);
        let drawing = draw_labels(&annotations, &ground, &[], &mut composer, &mut report);
        (drawing, report)
    }

    #[test]
    fn every_label_ends_in_exactly_one_list() {
        let labels = [
            label("seen", 400.0, 500.0),
            label("the same spot", 400.0, 500.0),
            PictureLabel { visible: false, ..label("behind the ridge", 800.0, 500.0) },
            label("off the sheet", -10.0, 500.0),
            label("nowhere", f32::NAN, 500.0),
            label(" \n ", 900.0, 500.0),
        ];
        let (_, report) = draw(&labels);
        assert_eq!(report.placed, ["seen"]);
        assert_eq!(report.crowded_out, ["the same spot"]);
        assert_eq!(report.hidden, ["behind the ridge"]);
        assert_eq!(report.outside, ["off the sheet", "nowhere"]);
        assert_eq!(report.empty, 1);
    }

    #[test]
    fn lower_ranks_go_first_then_summits_before_places_and_near_before_far() {
        let far = PictureLabel { depth_m: 9000.0, ..label("far", 400.0, 500.0) };
        let near = PictureLabel { depth_m: 900.0, ..label("near", 402.0, 500.0) };
        let summit = PictureLabel { kind: LabelKind::Summit, depth_m: 99e3, ..label("summit", 404.0, 500.0) };
        assert_eq!(draw(&[far.clone(), near.clone()]).1.placed, ["near"]);
        assert_eq!(draw(&[far.clone(), near.clone(), summit.clone()]).1.placed, ["summit"]);
        let [near, summit] = [near, summit].map(|label| PictureLabel { rank: 1.0, ..label });
        assert_eq!(draw(&[near, summit, far]).1.placed, ["far"], "whatever is of a lower rank");
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut labels: Vec<_> =
            (0..40).map(|n| label(&format!("No {n}"), 300.0 + 37.0 * (n % 9) as f32, 500.0)).collect();
        let forth = draw(&labels).0.marks;
        labels.reverse();
        assert_eq!(draw(&labels).0.marks, forth);
    }

    #[test]
    fn what_is_drawn_stays_inside_the_picture() {
        let labels: Vec<_> =
            (0..60).map(|n| label("At the border", 33.0 * n as f32, 18.5 * n as f32)).collect();
        let bounds = draw(&labels).0.bounds();
        assert!(Sheet::new(1920, 1080).bounds().holds(&bounds), "{bounds:?}");
    }

    #[test]
    fn a_label_as_long_as_a_book_is_cut_and_says_so() {
        let (drawing, report) = draw(&[label(&"word ".repeat(5000), 900.0, 500.0)]);
        assert_eq!((report.placed.len(), report.shortened.len()), (1, 1));
        assert!(drawing.bounds().size().x < 1920.0 * 0.4);
    }
}
