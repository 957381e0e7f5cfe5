//! Labels: which are drawn, how each kind looks, and where they stand.

use glam::Vec2;

use crate::annotate::annotation::{LabelClass, PictureLabel};
use crate::annotate::drawing::{Drawing, polygon};
use crate::annotate::paragraph::{Paragraph, fitted, written_lines};
use crate::annotate::pixel_box::{PixelBox, PixelSegment};
use crate::annotate::place::{LabelCandidate, LabelField, Request, check, place};
use crate::annotate::positions::{Alignment, LabelMetrics, LabelPosition, Preference, positions, spot};
use crate::annotate::report::AnnotationReport;
use crate::annotate::sheet::{HALO, INK, PAPER, SOFT_INK, Sheet, WATER_INK};
use crate::annotate::text::{TextLine, TextStyle, Typesetter, halos, write};
use crate::draw::color::Srgba;

/// More labels than this are not even tried: no picture holds as many, and trying takes time by the square.
const MOST_LABELS: usize = 4096;
/// Lines of a label that are drawn; more would hide what they name.
const MOST_LINES: usize = 4;
/// No line of a label is wider than this share of the picture.
const WIDEST_SHARE: f32 = 0.33;
/// The longest leader line, as a share of the picture's height.
const LONGEST_LEADER_SHARE: f32 = 0.26;
/// From baseline to baseline, in ems of the lower line.
const LEADING: f32 = 1.16;
/// Tangent of the lean of water names, about 12 degrees.
const WATER_SLANT: f32 = 0.21;

/// Draws the labels that are visible and find room beside `furniture`; says in `report` what became of each.
pub fn draw_labels(
    labels: &[PictureLabel],
    furniture: &[PixelBox],
    sheet: &Sheet,
    setter: &mut Typesetter,
    report: &mut AnnotationReport,
) -> Drawing {
    let mut fates = vec![Fate::CrowdedOut; labels.len()];
    let mut prepared: Vec<PreparedLabel<'_>> = Vec::new();
    for (number, label) in by_importance(labels) {
        if !sheet.bounds().contains(label.anchor_px) {
            fates[number] = Fate::Outside;
        } else if !label.visible {
            fates[number] = Fate::Hidden;
        } else if prepared.len() < MOST_LABELS {
            match prepare(number, label, sheet, setter) {
                Ok(label) => prepared.push(label),
                Err(fate) => fates[number] = fate,
            }
        }
    }
    let requests: Vec<Request> = prepared.iter().map(|label| label.request.clone()).collect();
    let field = field(furniture, sheet);
    let choices = place(&requests, &field);
    debug_assert_eq!(check(&requests, &choices, &field), Ok(()));
    for (label, _) in prepared.iter().zip(&choices).filter(|(_, choice)| choice.is_some()) {
        fates[label.number] =
            Fate::Placed { missing: label.block.missing(), shortened: label.block.shortened };
    }
    tell(labels, &fates, report);
    draw_chosen(&prepared, &choices, sheet)
}

/// What becomes of a label.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Placed { missing: usize, shortened: bool },
    Hidden,
    Outside,
    CrowdedOut,
    Empty,
}

fn tell(labels: &[PictureLabel], fates: &[Fate], report: &mut AnnotationReport) {
    for (label, fate) in labels.iter().zip(fates) {
        let text = label.text.clone();
        match *fate {
            Fate::Placed { missing, shortened } => {
                report.set(&text, missing, shortened);
                report.placed.push(text);
            }
            Fate::Hidden => report.hidden.push(text),
            Fate::Outside => report.outside.push(text),
            Fate::CrowdedOut => report.crowded_out.push(text),
            Fate::Empty => report.empty += 1,
        }
    }
}

/// The field of labels: inside the margin's half, off the furniture.
fn field(furniture: &[PixelBox], sheet: &Sheet) -> LabelField {
    let air = sheet.px(6.0);
    LabelField {
        bounds: sheet.bounds().grown(-(sheet.margin() * 0.4).round()),
        taken: furniture.iter().map(|taken| taken.grown(air)).collect(),
        leader_room: sheet.px(5.0),
    }
}

/// A label with its text set, ready to be placed.
struct PreparedLabel<'a> {
    number: usize,
    label: &'a PictureLabel,
    look: LabelStyle,
    block: Paragraph,
    /// The stance's boxes of the text, one for each alignment.
    texts: [PixelBox; 3],
    positions: Vec<LabelPosition>,
    request: Request,
}

/// Kind first, then the nearer, then by text; the input's order decides between equals.
fn by_importance(labels: &[PictureLabel]) -> Vec<(usize, &PictureLabel)> {
    let mut order: Vec<_> = labels.iter().enumerate().collect();
    order.sort_by(|(_, a), (_, b)| {
        a.kind.cmp(&b.kind).then(a.depth_m.total_cmp(&b.depth_m)).then_with(|| a.text.cmp(&b.text))
    });
    order
}

/// Sets the label's text and lists its positions.
///
/// # Errors
/// Its fate, where nothing would show: it is empty, or the picture is too narrow for a few letters.
fn prepare<'a>(
    number: usize,
    label: &'a PictureLabel,
    sheet: &Sheet,
    setter: &mut Typesetter,
) -> Result<PreparedLabel<'a>, Fate> {
    let look = LabelStyle::of(label.kind, sheet);
    let block = set_lines(&label.text, &look, sheet, setter);
    if block.lines.is_empty() {
        return Err(if block.shortened { Fate::CrowdedOut } else { Fate::Empty });
    }
    // Air around the text, so that no two labels read as one.
    let air = sheet.px(2.0);
    let texts = [Alignment::Left, Alignment::Center, Alignment::Right]
        .map(|alignment| block_box(&block.lines, alignment, look.halo).grown(air));
    if texts.iter().any(|text| text.size().cmple(Vec2::ZERO).any() || !text.size().is_finite()) {
        return Err(Fate::Empty);
    }
    let stance = stance(label, texts, &look, sheet);
    let positions = positions(&stance);
    let candidates = positions.iter().map(|position| position.candidate).collect();
    let request = Request { candidates, spot: Some(spot(&stance)) };
    Ok(PreparedLabel { number, label, look, block, texts, positions, request })
}

fn stance(label: &PictureLabel, texts: [PixelBox; 3], look: &LabelStyle, sheet: &Sheet) -> LabelMetrics {
    let longest = sheet.size.y * LONGEST_LEADER_SHARE;
    let preference = match label.kind {
        LabelClass::Water => Preference::OnPlace,
        _ => Preference::Above,
    };
    LabelMetrics {
        anchor: pixel_center(label.anchor_px),
        reach: reach(label, look.leader, longest),
        texts,
        symbol: Vec2::splat(look.symbol + look.halo),
        gap: sheet.px(1.0),
        longest,
        preference,
    }
}

/// The middle of the pixel that holds `point`: symbols and upright lines that stand there are crisp.
fn pixel_center(point: Vec2) -> Vec2 {
    point.floor() + 0.5
}

/// From the anchor to the wished end of the leader: as given, but upward and of a sensible length.
fn reach(label: &PictureLabel, usual: f32, longest: f32) -> Vec2 {
    let wished = label.top_px.map(|top| top - label.anchor_px).filter(|reach| reach.is_finite());
    match wished {
        // Leaning more than 45° it would no longer be read as a line upward.
        Some(reach) if reach.y < 0.0 && reach.x.abs() <= -reach.y => reach.clamp_length(usual, longest),
        _ => Vec2::new(0.0, -usual),
    }
}

fn set_lines(text: &str, look: &LabelStyle, sheet: &Sheet, setter: &mut Typesetter) -> Paragraph {
    let (written, dropped) = written_lines(text, MOST_LINES);
    let widest = sheet.size.x * WIDEST_SHARE;
    let faces = std::iter::once(look.name).chain(std::iter::repeat(look.note));
    let set = |(text, face): (&String, TextStyle)| fitted(setter, text, face, widest);
    let lines: Vec<TextLine> = written.iter().zip(faces).filter_map(set).collect();
    let shortened = dropped || lines.len() < written.len() || lines.iter().any(|line| line.shortened);
    Paragraph { lines, shortened }
}

/// Where the lines' baselines start: the first at y = 0, all aligned to x = 0.
fn baselines(lines: &[TextLine], alignment: Alignment) -> Vec<(&TextLine, Vec2)> {
    let mut y = 0.0;
    let place = |(number, line): (usize, &'_ TextLine)| {
        if number > 0 {
            y += (line.style.size_px * LEADING).round();
        }
        let share = match alignment {
            Alignment::Left => 0.0,
            Alignment::Center => 0.5,
            Alignment::Right => 1.0,
        };
        Vec2::new((-line.advance * share).round(), y)
    };
    let starts: Vec<Vec2> = lines.iter().enumerate().map(place).collect();
    lines.iter().zip(starts).collect()
}

fn block_box(lines: &[TextLine], alignment: Alignment, halo: f32) -> PixelBox {
    baselines(lines, alignment)
        .into_iter()
        .map(|(line, at)| line.ink(halo).moved(at))
        .fold(PixelBox::EMPTY, PixelBox::union)
}

/// Writes the lines around the origin, moved by `by`: all halos first, for the name's must not eat into the
/// height below it.
fn draw_lines(label: &PreparedLabel<'_>, alignment: Alignment, by: Vec2, drawing: &mut Drawing) {
    let mut lines = baselines(&label.block.lines, alignment);
    lines.iter_mut().for_each(|(_, at)| *at += by);
    halos(drawing, &lines, label.look.halo);
    let (name, notes) = lines.split_at(1.min(lines.len()));
    write(drawing, name, label.look.ink);
    write(drawing, notes, label.look.note_ink);
}

/// Symbols and leaders first, all texts over them.
fn draw_chosen(prepared: &[PreparedLabel<'_>], choices: &[Option<usize>], sheet: &Sheet) -> Drawing {
    let (mut drawing, mut texts) = (Drawing::default(), Drawing::default());
    for (label, choice) in prepared.iter().zip(choices) {
        let Some(LabelPosition { candidate, alignment }) = choice.map(|which| label.positions[which]) else {
            continue;
        };
        draw_leader(&candidate, &label.look, sheet, &mut drawing);
        if candidate.symbol.is_some() {
            label.look.draw_symbol(label.label, sheet, &mut drawing);
        }
        let by = candidate.text.min - label.texts[alignment as usize].min;
        draw_lines(label, alignment, by.round(), &mut texts);
    }
    drawing.append(&texts, Vec2::ZERO);
    drawing
}

fn draw_leader(candidate: &LabelCandidate, look: &LabelStyle, sheet: &Sheet, drawing: &mut Drawing) {
    let Some(line) = candidate.leader else { return };
    let width = sheet.px(1.2).max(0.9);
    let crisp = crisp(line);
    drawing.line(crisp, width + sheet.px(2.4).max(1.6), HALO);
    drawing.line(crisp, width, look.ink);
}

/// A line that is all but upright, made upright.
fn crisp(line: PixelSegment) -> PixelSegment {
    if (line.to.x - line.from.x).abs() > 0.6 {
        return line;
    }
    PixelSegment { from: line.from, to: Vec2::new(line.from.x, line.to.y) }
}

/// How a kind of label looks.
struct LabelStyle {
    name: TextStyle,
    note: TextStyle,
    ink: Srgba,
    note_ink: Srgba,
    halo: f32,
    /// Half the size of the symbol.
    symbol: f32,
    /// Usual length of the leader line.
    leader: f32,
}

impl LabelStyle {
    fn of(kind: LabelClass, sheet: &Sheet) -> Self {
        let (slant, tracking) = if kind == LabelClass::Water { (WATER_SLANT, 0.06) } else { (0.0, 0.0) };
        let (name, weight, symbol, leader) = match kind {
            LabelClass::Summit => (20.0, TextStyle::BOLD, 6.0, 44.0),
            LabelClass::Place => (19.0, TextStyle::BOLD, 4.5, 34.0),
            LabelClass::Water => (19.0, TextStyle::MEDIUM, 3.0, 34.0),
            LabelClass::Point => (16.5, TextStyle::MEDIUM, 3.2, 26.0),
        };
        let (ink, note_ink) = match kind {
            LabelClass::Water => (WATER_INK, WATER_INK),
            _ => (INK, SOFT_INK),
        };
        Self {
            name: TextStyle { size_px: sheet.type_px(name), slant, weight, tracking },
            note: TextStyle {
                size_px: sheet.type_px(name * 0.8),
                slant,
                weight: TextStyle::MEDIUM,
                tracking,
            },
            ink,
            note_ink,
            halo: sheet.px(2.2).max(1.5),
            symbol: sheet.px(symbol).max(2.6),
            leader: sheet.px(leader),
        }
    }

    fn draw_symbol(&self, label: &PictureLabel, sheet: &Sheet, drawing: &mut Drawing) {
        let (at, size, reach) = (pixel_center(label.anchor_px), self.symbol, self.halo * 0.8);
        match label.kind {
            LabelClass::Summit => {
                let corners = [(0.0, -1.0), (0.95, 0.72), (-0.95, 0.72)];
                let triangle = corners.map(|(x, y)| at + Vec2::new(x, y) * size);
                if let Some(path) = polygon(&triangle) {
                    drawing.haloed(path, self.ink, reach);
                }
            }
            LabelClass::Place => {
                drawing.disc(at, size + reach, HALO);
                drawing.disc(at, size, self.ink);
                drawing.disc(at, size - sheet.px(1.6).max(1.0), PAPER);
            }
            LabelClass::Water | LabelClass::Point => {
                drawing.disc(at, size + reach, HALO);
                drawing.disc(at, size, self.ink);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHEET: Sheet = Sheet { size: Vec2::new(1920.0, 1080.0), scale: 1.0 };

    fn label(text: &str, x: f32, y: f32) -> PictureLabel {
        let anchor_px = Vec2::new(x, y);
        let text = text.to_owned();
        PictureLabel {
            text,
            anchor_px,
            top_px: None,
            depth_m: 1000.0,
            visible: true,
            kind: LabelClass::Place,
        }
    }

    fn draw(labels: &[PictureLabel]) -> (Drawing, AnnotationReport) {
        let mut report = AnnotationReport::default();
        let drawing = draw_labels(labels, &[], &SHEET, &mut Typesetter::new(), &mut report);
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
    fn summits_go_before_places_and_the_near_before_the_far() {
        let far = PictureLabel { depth_m: 9000.0, ..label("far", 400.0, 500.0) };
        let near = PictureLabel { depth_m: 900.0, ..label("near", 402.0, 500.0) };
        let summit =
            PictureLabel { kind: LabelClass::Summit, depth_m: 99e3, ..label("summit", 404.0, 500.0) };
        assert_eq!(draw(&[far.clone(), near.clone()]).1.placed, ["near"]);
        assert_eq!(draw(&[far, near, summit]).1.placed, ["summit"]);
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut labels: Vec<_> =
            (0..40).map(|n| label(&format!("No {n}"), 300.0 + 37.0 * (n % 9) as f32, 500.0)).collect();
        let forth = draw(&labels).0;
        labels.reverse();
        assert_eq!(draw(&labels).0, forth);
    }

    #[test]
    fn a_leader_goes_up_whatever_the_top_says() {
        for top in [Vec2::new(400.0, 900.0), Vec2::new(900.0, 499.0), Vec2::NAN, Vec2::new(400.0, 500.0)] {
            let odd = PictureLabel { top_px: Some(top), ..label("odd", 400.0, 500.0) };
            assert_eq!(reach(&odd, 40.0, 250.0), Vec2::new(0.0, -40.0), "{top}");
        }
        let long = PictureLabel { top_px: Some(Vec2::new(400.0, -9000.0)), ..label("long", 400.0, 500.0) };
        assert!((reach(&long, 40.0, 250.0) - Vec2::new(0.0, -250.0)).length() < 0.01);
    }

    #[test]
    fn what_is_drawn_stays_inside_the_picture() {
        let labels: Vec<_> =
            (0..60).map(|n| label("At the border", 33.0 * n as f32, 18.5 * n as f32)).collect();
        let bounds = draw(&labels).0.bounds();
        assert!(SHEET.bounds().holds(&bounds), "{bounds:?}");
    }

    #[test]
    fn a_label_as_long_as_a_book_is_cut_and_says_so() {
        let (drawing, report) = draw(&[label(&"word ".repeat(5000), 900.0, 500.0)]);
        assert_eq!((report.placed.len(), report.shortened.len()), (1, 1));
        assert!(drawing.bounds().size().x < 1920.0 * 0.4);
    }
}
